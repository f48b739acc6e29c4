//! Tables of values over a coordinate or the time, as an alternative to formulas.

use super::error::ScenarioError;
use super::geometry::input_path;
use super::table::{At, Choose as _, choices};
use crate::Error;
use crate::files::read_text;

choices! {
    /// Values from a file.
    pub enum FieldTable ["kind"] {
        /// Straight lines between the rows of a CSV file; before the first and after the last row the value of that row.
        Table = "table" {
            /// CSV file, relative to the scenario, with a header.
            file: At<String>,
            /// Name of the column with the values.
            column: At<String>,
            /// Coordinate or time over which the values are given, and name of the column with it.
            over: Variable = "t",
        },
    }
}

choices! {
    /// A coordinate or the time.
    #[derive(Copy, Eq)]
    pub enum Variable {
        /// First coordinate.
        X = "x",
        /// Second coordinate.
        Y = "y",
        /// Third coordinate.
        Z = "z",
        /// Time.
        Time = "t",
    }
}

impl FieldTable {
    /// Returns the variable, and its values with the values of the column, in ascending order.
    ///
    /// # Errors
    /// A file that cannot be read, columns that do not exist, rows that are not finite numbers in ascending order.
    pub(super) fn read(&self) -> Result<(Variable, Vec<[f64; 2]>), ScenarioError> {
        let Self::Table { file, column, over } = self;
        let path = input_path(file);
        let text = read_text(&path).map_err(|error| match error {
            Error::Read { .. } => file.at.invalid(format!("{error}, relative to the scenario")),
            error => file.at.invalid(error.to_string()),
        })?;
        let refused = |line: usize, problem: String| file.at.invalid(format!("{}:{line}: {problem}", path.display()));
        let is_row = |(_, line): &(usize, &str)| !line.is_empty() && !line.starts_with('#');
        // Spreadsheets write a byte order mark first.
        let lines = text.trim_start_matches('\u{feff}').lines().map(str::trim).enumerate();
        let mut lines = lines.map(|(k, line)| (k + 1, line)).filter(is_row);
        let (header_line, header) = lines.next().unwrap_or((1, ""));
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let place = |name: &str| {
            let found = names.iter().position(|known| *known == name);
            found.ok_or_else(|| refused(header_line, format!("there is no column `{name}`; the header is `{header}`")))
        };
        let places = [place(over.word())?, place(column)?];
        let mut rows: Vec<[f64; 2]> = Vec::new();
        for (line, row) in lines {
            let words: Vec<&str> = row.split(',').map(str::trim).collect();
            if words.len() != names.len() {
                let (found, all) = (words.len(), names.len());
                return Err(refused(line, format!("this row has {found} values, but the header names {all} columns")));
            }
            let number = |place: usize| match words[place].parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(refused(line, format!("`{}` is not a finite number; correct it", words[place]))),
            };
            let [at, value] = [number(places[0])?, number(places[1])?];
            if let Some([before, _]) = rows.last().filter(|[before, _]| *before >= at) {
                return Err(refused(
                    line,
                    format!(
                        "{} {at} is not after {before} of the row before; sort the rows, and give a jump two values that differ",
                        over.word()
                    ),
                ));
            }
            rows.push([at, value]);
        }
        if rows.is_empty() {
            Err(refused(header_line, "it has no rows; add some".to_owned()))
        } else {
            Ok((*over, rows))
        }
    }
}

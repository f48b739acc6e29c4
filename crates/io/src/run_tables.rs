//! The tables of a run, read back, and the differences between two runs.

use std::path::{Path, PathBuf};

use mesh::AXES;

use crate::Error;
use crate::history::{HistoryTable, TABLES, name_and_unit};
use crate::scenario::advice;

/// Prefix of the names of columns with wall-clock times.
const CLOCK: &str = "seconds_";
/// Columns with numbers of iterations and unknowns, which differ between solvers and machines.
const WORK: [&str; 4] = ["newton", "linear_iterations", "factorizations", "dofs"];
/// Prefix of the names of columns with energies of the ledger. They are round-off if no energy is lost.
const LEDGER: &str = "lost_";
/// Part of the names of columns with energies, which are the scale of the ledger. Energies of gravity depend on the
/// origin of the coordinates, and are left out.
const ENERGY: &str = "energy_";
const GRAVITY: &str = "energy_gravity";
/// End of the name of the column with the remainder of the forces on a body. It is round-off if they balance. The
/// columns with these forces begin like it.
const REMAINDER: &str = "remainder";

/// The tables of a run.
#[derive(Clone, Debug)]
pub struct RunTables {
    tables: Vec<HistoryTable>,
}

/// Difference of a column between two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Name of the column.
    pub column: String,
    /// Largest absolute difference, at the times of the first run.
    pub largest: f64,
    /// Largest absolute value in either run. For columns of the ledger, at least the largest energy without gravity;
    /// for the remainder of the forces on a body, at least the largest of these forces; for a component of a vector,
    /// the largest of all components.
    pub scale: f64,
}

impl Difference {
    /// Returns `largest / scale`; zero for equal columns.
    pub fn relative(&self) -> f64 {
        if self.largest == 0.0 { 0.0 } else { self.largest / self.scale }
    }
}

impl RunTables {
    /// Reads the tables in a directory of results. Tables that the run did not write are left out.
    ///
    /// # Errors
    /// [`Error::NoResults`]: there is no `history.csv`. [`Error::Read`], [`Error::Damaged`].
    pub fn read(directory: &Path) -> Result<Self, Error> {
        let [history, others @ ..] = TABLES;
        let mut tables = vec![HistoryTable::read(&results_file(directory, history)?)?];
        if tables[0].n_rows() == 0 {
            let place = directory.join(history).display().to_string();
            return Err(Error::Damaged { place, problem: "the table has no rows".to_owned() });
        }
        for name in others {
            let path = directory.join(name);
            if path.is_file() {
                tables.push(HistoryTable::read(&path)?);
            }
        }
        Ok(Self { tables })
    }

    /// Returns the names of all columns but the time, with their units where the table states them.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.tables.iter().flat_map(|table| table.names().iter().skip(1)).map(String::as_str)
    }

    /// Returns times and values of a column, or `None` if there is no column of this name.
    pub fn column(&self, name: &str) -> Option<Vec<(f64, f64)>> {
        self.tables.iter().find_map(|table| {
            let times = table.column("time")?;
            Some(times.into_iter().zip(table.column(name)?).collect())
        })
    }

    /// Returns the name of a column with its unit, or without unit if no run states it. The directories are for errors.
    ///
    /// # Errors
    /// [`Error::OtherUnit`]: two runs have different units.
    pub fn heading<'a>(runs: &[(&Path, &'a Self)], column: &'a str) -> Result<&'a str, Error> {
        let bare = name_and_unit(column).0;
        let of_run = |run: &'a Self| run.tables.iter().find_map(|table| table.heading(bare));
        let mut stated = runs.iter().filter_map(|(directory, run)| {
            let heading = of_run(run)?;
            Some((*directory, heading, name_and_unit(heading).1?))
        });
        let Some((first, heading, unit)) = stated.next() else { return Ok(column) };
        match stated.find(|(_, _, other)| *other != unit) {
            None => Ok(heading),
            Some((second, _, other)) => Err(Error::OtherUnit {
                column: bare.to_owned(),
                units: [unit, other].map(str::to_owned),
                directories: [first, second].map(Path::to_owned),
            }),
        }
    }

    /// Returns the error about a column that the run in a directory does not have.
    pub fn no_column(&self, directory: &Path, column: &str) -> Error {
        let names: Vec<&str> = self.columns().collect();
        let bare: Vec<&str> = self.tables.iter().flat_map(|table| table.bare_names().skip(1)).collect();
        let (directory, column, advice) = (directory.to_owned(), column.to_owned(), advice(column, &bare));
        Error::NoColumn { directory, column, advice, known: names.join(", ") }
    }

    /// Returns the time of the last row of `history.csv`; zero without rows.
    pub fn end(&self) -> f64 {
        self.column("time").and_then(|times| Some(times.last()?.0)).unwrap_or(0.0)
    }

    /// Returns the differences of columns, the largest relative one first. If `columns` is empty, these are all columns
    /// that both runs have, without wall-clock times and numbers of iterations and unknowns.
    ///
    /// Values of the other run are interpolated linearly to the times of this run, within the times of both runs. The
    /// directories are for errors.
    ///
    /// # Errors
    /// [`Error::NothingCommon`]: the runs have no column or no time in common. [`Error::OtherUnit`]: they have
    /// different units. [`Error::NoColumn`].
    pub fn differences(
        &self,
        other: &Self,
        [first, second]: [&Path; 2],
        columns: &[String],
    ) -> Result<Vec<Difference>, Error> {
        let nothing = |what| Error::NothingCommon { first: first.to_owned(), second: second.to_owned(), what };
        let runs = [(first, self), (second, other)];
        for name in ["time"].into_iter().chain(self.columns()) {
            Self::heading(&runs, name)?;
        }
        let (times, others) = (self.column("time").unwrap_or_default(), other.column("time").unwrap_or_default());
        if !times.iter().any(|(time, _)| interpolated(&others, *time).is_some()) {
            return Err(nothing("time"));
        }
        for (directory, run) in runs {
            if let Some(name) = columns.iter().find(|name| run.column(name).is_none()) {
                return Err(run.no_column(directory, name));
            }
        }
        let compared = |name: &str| {
            let (own, others) = (self.column(name)?, other.column(name)?);
            let pairs = own.iter().filter_map(|(time, value)| Some((*value, interpolated(&others, *time)?)));
            let mut found = Difference { column: name.to_owned(), largest: 0.0, scale: 0.0 };
            for (a, b) in pairs {
                // A value is NaN outside of the fluid. If only one is, the difference is infinite.
                let distance = if a.is_nan() && b.is_nan() { 0.0 } else { (a - b).abs() };
                found.largest = if distance.is_nan() { f64::INFINITY } else { found.largest.max(distance) };
                found.scale = found.scale.max(a.abs()).max(b.abs());
            }
            Some(found)
        };
        let largest = |is_term: &dyn Fn(&str) -> bool| {
            self.columns()
                .filter(|column| is_term(column))
                .filter_map(compared)
                .map(|term| term.scale)
                .fold(0.0, f64::max)
        };
        let energy = largest(&|column| column.contains(ENERGY) && !column.contains(GRAVITY));
        let difference = |name: &str| {
            let found = compared(name)?;
            let of_terms = match name_and_unit(name).0.strip_suffix(REMAINDER) {
                _ if name.starts_with(LEDGER) => energy,
                Some(prefix) => largest(&|column| column.starts_with(prefix)),
                None => components(name).map_or(0.0, |prefix| largest(&|column| components(column) == Some(prefix))),
            };
            Some(Difference { scale: found.scale.max(of_terms), ..found })
        };
        let is_work = |name: &str| name.starts_with(CLOCK) || WORK.contains(&name_and_unit(name).0);
        let is_compared = |name: &&str| {
            if columns.is_empty() {
                !is_work(name)
            } else {
                columns.iter().any(|column| name_and_unit(column).0 == name_and_unit(name).0)
            }
        };
        let mut found: Vec<Difference> = self.columns().filter(is_compared).filter_map(difference).collect();
        if found.is_empty() {
            return Err(nothing("column"));
        }
        found.sort_by(|a, b| b.relative().total_cmp(&a.relative()));
        Ok(found)
    }
}

/// Returns the name of a vector without its component, if a column is one: `centre_` for `centre_y [m]`.
fn components(column: &str) -> Option<&str> {
    AXES.iter().find_map(|axis| name_and_unit(column).0.strip_suffix(axis)).filter(|name| name.ends_with('_'))
}

/// Returns the path of a file of results.
///
/// # Errors
/// [`Error::NoResults`]: it does not exist.
pub fn results_file(directory: &Path, file: &'static str) -> Result<PathBuf, Error> {
    let path = directory.join(file);
    if path.is_file() { Ok(path) } else { Err(Error::NoResults { directory: directory.to_owned(), file }) }
}

/// Returns the value of a column at a time, linear between its rows; `None` before the first and after the last row.
fn interpolated(rows: &[(f64, f64)], time: f64) -> Option<f64> {
    let after = rows.partition_point(|(t, _)| *t < time);
    let (t, value) = *rows.get(after)?;
    if t == time {
        return Some(value);
    }
    let (before, earlier) = *rows.get(after.checked_sub(1)?)?;
    Some(earlier + (value - earlier) * (time - before) / (t - before))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_interpolated_where_both_runs_go() {
        let rows = [(1.0, 10.0), (2.0, 20.0), (4.0, 0.0)];
        let at = |time: f64| interpolated(&rows, time);
        assert_eq!(
            (at(0.5), at(1.0), at(1.5), at(3.0), at(4.0), at(4.1)),
            (None, Some(10.0), Some(15.0), Some(10.0), Some(0.0), None)
        );
    }
}

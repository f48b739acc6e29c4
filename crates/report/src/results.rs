//! The files of a run, read back.

use std::path::Path;

use io::{HistoryTable, ScenarioFile, Summary, TABLES, read_text, results_file};

use crate::{Chart, Curve, Error, Frames};

/// The files of a run.
#[derive(Clone, Debug)]
pub struct Results {
    /// `summary.json`.
    pub summary: Summary,
    /// `history.csv`.
    pub history: HistoryTable,
    /// `diagnostics.csv`.
    pub diagnostics: HistoryTable,
    /// `frames.json`, if frames were recorded.
    pub frames: Option<Frames>,
    /// The text of `scenario.toml`.
    pub scenario: String,
    /// End of the run in the scenario; `None` if the scenario cannot be read.
    pub planned_end: Option<f64>,
}

impl Results {
    /// Reads the files of a run.
    ///
    /// # Errors
    /// [`Error::Results`], [`Error::Frames`]: files are missing or malformed.
    pub fn read(directory: &Path) -> Result<Self, Error> {
        let planned = ScenarioFile::read(&directory.join("scenario.toml"), &[]);
        Ok(Self {
            summary: Summary::read(&results_file(directory, "summary.json")?)?,
            history: HistoryTable::read(&directory.join(TABLES[0]))?,
            diagnostics: HistoryTable::read(&directory.join(TABLES[1]))?,
            frames: Frames::read(directory)?,
            scenario: read_text(&directory.join("scenario.toml"))?,
            planned_end: planned.ok().map(|file| file.scenario().time.end),
        })
    }

    /// Returns the prefix of the columns of a body: empty if it is the only one.
    pub fn prefix(&self, body: &str) -> String {
        if self.summary.bodies.len() == 1 { String::new() } else { format!("{body}_") }
    }

    /// Returns the prefix of the columns of the leading body; empty without a body.
    pub fn leading_prefix(&self) -> String {
        self.summary.leading.as_ref().map_or_else(String::new, |name| self.prefix(name))
    }

    /// Returns a column of a table over time; empty if no column has that name.
    pub fn curve(&self, label: &str, table: &HistoryTable, column: &str) -> Curve {
        let times = table.column("time").unwrap_or_default();
        Curve::new(label, times.into_iter().zip(table.column(column).unwrap_or_default()).collect())
    }

    /// Returns a chart over time, with the unit in its title.
    pub(crate) fn over_time(&self, title: &str, unit: &str, curves: Vec<Curve>) -> Chart {
        Chart::new(format!("{title} [{unit}]"), format!("time [{}]", self.summary.units.time), curves)
    }
}

//! Studies: the same case with one number changed, read from files that studies leave.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::html::{chart, escape, gallery, number, optional, table};
use crate::Error;
use crate::plot::{Curve, Panel};

/// The outcome of a study, one file in JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// Name of the study: `dt`, `h`, `contact`, `domain`, `stabilisation`.
    pub name: String,
    /// Headline.
    pub title: String,
    /// What was learned, in a sentence or two.
    #[serde(default)]
    pub note: String,
    /// What is varied, with its unit.
    pub parameter: String,
    /// The version of the code.
    #[serde(default)]
    pub commit: String,
    /// The machine.
    #[serde(default)]
    pub machine: String,
    /// The runs, grouped by series.
    pub runs: Vec<StudyRun>,
}

/// A run of a study.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StudyRun {
    /// The series that it belongs to: a profile, a case.
    pub series: String,
    /// Value of what is varied.
    pub value: f64,
    /// First contact, s.
    #[serde(default)]
    pub contact_time: Option<f64>,
    /// Release, s.
    #[serde(default)]
    pub release_time: Option<f64>,
    /// Highest smallest distance after the rebound, cm.
    #[serde(default)]
    pub max_height: Option<f64>,
    /// When, s.
    #[serde(default)]
    pub max_height_time: Option<f64>,
    /// Wall-clock time, s.
    #[serde(default)]
    pub wall_seconds: Option<f64>,
}

impl Study {
    /// All studies in a directory, by name; files that are no studies are left out. None if there is no directory.
    ///
    /// # Errors
    /// [`Error::Read`].
    pub fn read_all(directory: &Path) -> Result<Vec<Self>, Error> {
        let failed = |source| Error::Read { path: directory.to_owned(), source };
        if !directory.is_dir() {
            return Ok(Vec::new());
        }
        let mut studies: Vec<Self> = Vec::new();
        for entry in std::fs::read_dir(directory).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.extension().is_some_and(|extension| extension == "json") {
                let text = std::fs::read_to_string(&path).map_err(|source| Error::Read { path, source })?;
                studies.extend(serde_json::from_str::<Self>(&text));
            }
        }
        studies.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(studies)
    }

    /// The study as a part of a page.
    ///
    /// # Errors
    /// [`Error::Plot`].
    pub fn html(&self) -> Result<String, Error> {
        let mut series: Vec<&str> = Vec::new();
        for run in &self.runs {
            if !series.contains(&run.series.as_str()) {
                series.push(&run.series);
            }
        }
        let panel = |title: &str, value: &dyn Fn(&StudyRun) -> Option<f64>| {
            let curve = |(k, name): (usize, &&str)| {
                let runs = self.runs.iter().filter(|run| run.series == **name);
                let mut points: Vec<(f64, f64)> = runs.filter_map(|run| Some((run.value, value(run)?))).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                Curve { label: (*name).to_owned(), colour: k, points, dots: true }
            };
            let x_is_log = self.runs.iter().all(|run| run.value > 0.0);
            let curves = series.iter().enumerate().map(curve).collect();
            Panel { x_title: self.parameter.clone(), x_is_log, ..Panel::over_time(title, curves) }
        };
        let figures = [
            chart(&panel("first contact [s]", &|run| run.contact_time), "")?,
            chart(&panel("highest point after rebound [cm]", &|run| run.max_height), "")?,
        ];
        let row = |run: &StudyRun| {
            let mut row = vec![escape(&run.series), number(run.value)];
            row.extend([run.contact_time, run.release_time, run.max_height, run.max_height_time].map(optional));
            row.push(optional(run.wall_seconds.map(f64::round)));
            row
        };
        let head = ["series", &self.parameter, "contact [s]", "release [s]", "highest [cm]", "at [s]", "wall [s]"];
        let rows: Vec<Vec<String>> = self.runs.iter().map(row).collect();
        let origin = match (self.commit.as_str(), self.machine.as_str()) {
            ("", "") => String::new(),
            (commit, machine) => format!("<p class=\"muted\">{} {}</p>", escape(commit), escape(machine)),
        };
        let note = format!("<p>{}</p>", escape(&self.note));
        let title = format!("<h3>{}</h3>", escape(&self.title));
        Ok(title + &note + &gallery(&figures) + &table("", &head, &rows) + &origin)
    }
}

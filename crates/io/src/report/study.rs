//! Studies: the same case with one number changed, read from files that studies leave.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::html::{chart, escape, gallery, number, optional, table, verdict};
use crate::Error;
use crate::files::write_whole;
use crate::plot::{Curve, Panel};

/// The outcome of a study, one file in JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// Name of the study: `dt`, `h`, `contact`, `domain`, `stabilisation`.
    pub name: String,
    /// Headline.
    pub title: String,
    /// What was learned, as paragraphs of text.
    #[serde(default)]
    pub note: Vec<String>,
    /// What the series are.
    #[serde(default)]
    pub series: Vec<StudySeries>,
    /// The runs, grouped by series.
    pub runs: Vec<StudyRun>,
}

/// Runs of one scenario with one number changed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StudySeries {
    /// Its name.
    pub name: String,
    /// What is varied, with its unit; series that vary the same share their graphs.
    pub parameter: String,
    /// A lower bound of the contact time, s.
    #[serde(default)]
    pub bound: Option<f64>,
    /// The limit of the contact time as what is varied goes to zero, s.
    #[serde(default)]
    pub limit: Option<Limit>,
}

/// What a sequence of numbers tends to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// The limit.
    pub value: f64,
    /// Half of the width of the interval that should contain it.
    pub uncertainty: f64,
    /// Observed order; none where the differences do not shrink or change sign.
    pub order: Option<f64>,
    /// Whether the differences between the members of the sequence shrink.
    pub shrinks: bool,
}

/// A run of a study.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StudyRun {
    /// The series that it belongs to: a profile, a case.
    pub series: String,
    /// Value of what is varied.
    pub value: f64,
    /// Changes of the scenario.
    #[serde(default)]
    pub set: Vec<String>,
    /// Why the run stopped before its end.
    #[serde(default)]
    pub failure: Option<String>,
    /// First contact, s: the end of the first step in contact.
    #[serde(default)]
    pub contact_time: Option<f64>,
    /// When the distance passes the contact offset, s: the contact time to a fraction of a step.
    #[serde(default)]
    pub arrival_time: Option<f64>,
    /// Release, s.
    #[serde(default)]
    pub release_time: Option<f64>,
    /// Begin and end of each contact; no end if it lasts.
    #[serde(default)]
    pub contact_intervals: Vec<(f64, Option<f64>)>,
    /// Smallest distance at the end of the first approach, cm.
    #[serde(default)]
    pub closest: Option<f64>,
    /// When, s.
    #[serde(default)]
    pub closest_time: Option<f64>,
    /// Highest smallest distance after the rebound, cm.
    #[serde(default)]
    pub max_height: Option<f64>,
    /// When, s.
    #[serde(default)]
    pub max_height_time: Option<f64>,
    /// Background cells.
    #[serde(default)]
    pub cells: usize,
    /// Steps done.
    #[serde(default)]
    pub steps: usize,
    /// Wall-clock time, s.
    #[serde(default)]
    pub wall_seconds: Option<f64>,
    /// The version of the code.
    #[serde(default)]
    pub commit: String,
    /// The machine.
    #[serde(default)]
    pub machine: String,
}

impl Study {
    /// All studies in a directory, by name. None if there is no directory.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Json`].
    pub fn read_all(directory: &Path) -> Result<Vec<Self>, Error> {
        let failed = |source| Error::Read { path: directory.to_owned(), source };
        if !directory.is_dir() {
            return Ok(Vec::new());
        }
        let mut studies: Vec<Self> = Vec::new();
        for entry in std::fs::read_dir(directory).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.extension().is_some_and(|extension| extension == "json") {
                studies.extend(Self::read(&path)?);
            }
        }
        studies.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(studies)
    }

    /// The study in a file; none if there is no file.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Json`].
    pub fn read(path: &Path) -> Result<Option<Self>, Error> {
        if !path.is_file() {
            return Ok(None);
        }
        let text = std::fs::read_to_string(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
        Ok(Some(serde_json::from_str(&text)?))
    }

    /// Writes the study; the file is complete whenever it is visible.
    ///
    /// # Errors
    /// [`Error::Json`], [`Error::Write`].
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        write_whole(path, text.as_bytes())
    }

    /// The study as a part of a page.
    ///
    /// # Errors
    /// [`Error::Plot`].
    pub fn html(&self) -> Result<String, Error> {
        let mut html = format!("<h3>{}</h3>", escape(&self.title));
        html.extend(self.note.iter().map(|paragraph| format!("<p>{}</p>", escape(paragraph))));
        html += &self.limits();
        for series in self.series.chunk_by(|a, b| a.parameter == b.parameter) {
            html += &self.graphs(series)?;
        }
        Ok(html + &self.runs() + &self.origin())
    }

    /// Limits of series, beside their bounds.
    fn limits(&self) -> String {
        let row = |series: &StudySeries| {
            let limit = series.limit?;
            let order = limit.order.map_or("–".to_owned(), |order| format!("{order:.1}"));
            let holds = series.bound.map_or("–".to_owned(), |bound| {
                let mut times = self.members(series).map(|run| run.contact_time);
                verdict(times.all(|time| time.is_none_or(|time| time >= bound)))
            });
            Some(vec![
                escape(&series.name),
                series.bound.map_or("–".to_owned(), |bound| format!("{bound:.4}")),
                holds,
                format!("{:.4} ± {:.4}", limit.value, limit.uncertainty),
                order,
                verdict(limit.shrinks),
            ])
        };
        let rows: Vec<Vec<String>> = self.series.iter().filter_map(row).collect();
        if rows.is_empty() {
            return String::new();
        }
        let head = ["contact time", "bound [s]", "above it", "limit [s]", "observed order", "differences shrink"];
        table("", &head, &rows)
    }

    fn members<'a>(&'a self, series: &'a StudySeries) -> impl Iterator<Item = &'a StudyRun> {
        self.runs.iter().filter(|run| run.series == series.name)
    }

    /// Graphs over what some series vary.
    fn graphs(&self, series: &[StudySeries]) -> Result<String, Error> {
        let panel = |title: &str, value: &dyn Fn(&StudyRun) -> Option<f64>| {
            let curve = |(k, series): (usize, &StudySeries)| {
                let mut points: Vec<(f64, f64)> =
                    self.members(series).filter_map(|run| Some((run.value, value(run)?))).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                Curve { label: series.name.clone(), colour: k, points, dots: true }
            };
            let x_is_log = series.iter().all(|series| self.members(series).all(|run| run.value > 0.0));
            let curves: Vec<Curve> = series.iter().enumerate().map(curve).collect();
            let x_title = series[0].parameter.clone();
            Panel { x_title, x_is_log, ..Panel::over_time(title, curves) }
        };
        let panels = [
            panel("contact [s]", &|run| run.arrival_time.or(run.contact_time)),
            panel("highest point after rebound [cm]", &|run| run.max_height),
        ];
        let drawn = panels.iter().filter(|panel| panel.curves.iter().any(|curve| !curve.points.is_empty()));
        Ok(gallery(&drawn.map(|panel| chart(panel, "")).collect::<Result<Vec<_>, _>>()?))
    }

    /// All runs in a table.
    fn runs(&self) -> String {
        let time = |time: Option<f64>| time.map_or("–".to_owned(), |time| format!("{time:.4}"));
        let row = |run: &StudyRun| {
            let intervals = match (&run.failure, run.contact_intervals.as_slice()) {
                (Some(failure), _) => escape(failure),
                (None, []) => "none".to_owned(),
                (None, intervals) => {
                    let interval = |&(begin, end): &(f64, Option<f64>)| {
                        format!("{}–{}", number(begin), end.map_or("end".to_owned(), number))
                    };
                    let mut text = intervals.iter().take(MOST_INTERVALS).map(interval).collect::<Vec<_>>().join(", ");
                    if intervals.len() > MOST_INTERVALS {
                        text += &format!(", {} more", intervals.len() - MOST_INTERVALS);
                    }
                    text
                }
            };
            vec![
                escape(&run.series),
                number(run.value),
                time(run.arrival_time),
                intervals,
                optional(run.closest),
                optional(run.max_height),
                time(run.max_height_time),
                run.cells.to_string(),
                run.steps.to_string(),
                optional(run.wall_seconds.map(f64::round)),
            ]
        };
        let head = [
            "series",
            "value",
            "contact [s]",
            "in contact [s]",
            "closest on first approach [cm]",
            "highest [cm]",
            "at [s]",
            "cells",
            "steps",
            "wall [s]",
        ];
        table("", &head, &self.runs.iter().map(row).collect::<Vec<_>>())
    }

    /// Versions and machines that the runs are from.
    fn origin(&self) -> String {
        let mut origins: Vec<String> = Vec::new();
        for run in &self.runs {
            let origin = format!("{} {}", run.commit, run.machine);
            if !origin.trim().is_empty() && !origins.contains(&origin) {
                origins.push(origin);
            }
        }
        origins.iter().map(|origin| format!("<p class=\"muted\">{}</p>", escape(origin))).collect()
    }
}

/// Contacts that a row of the table lists.
const MOST_INTERVALS: usize = 4;

//! The section of a case.

use std::path::Path;

use cutwater::io::HistoryTable;
use cutwater::report::html::{duration, escape, gallery, number, optional, table, verdict};
use cutwater::report::{Chart, Curve, Results, Section, run_as_html};

use crate::case::Reference;
use crate::compare::Compared;
use crate::figures::CAPTIONS;
use crate::metrics::{Rebound, THICKNESS};
use crate::outcome::Failure;
use crate::units::cgs;

pub(crate) struct CaseResult {
    pub(crate) name: String,
    pub(crate) reference: Reference,
    pub(crate) results: Results,
    pub(super) comparisons: Vec<Compared>,
    /// The figures of the paper, as elements of the page.
    pub(super) figures: Vec<String>,
    pub(super) thickness: Option<HistoryTable>,
}

impl CaseResult {
    pub(super) fn read(name: &str, reference: Reference, directory: &Path) -> Result<Self, Failure> {
        let figure = |(file, caption): &(&str, &str)| {
            let svg = std::fs::read_to_string(directory.join(file)).ok()?;
            Some(format!("<figure class=\"drawing\">{svg}<figcaption>{caption}</figcaption></figure>"))
        };
        let thickness = directory.join(THICKNESS);
        Ok(Self {
            name: name.to_owned(),
            results: Results::read(directory)?,
            comparisons: crate::compare::read(directory)?,
            figures: CAPTIONS.iter().filter_map(figure).collect(),
            thickness: thickness.is_file().then(|| HistoryTable::read(&thickness)).transpose()?,
            reference,
        })
    }

    pub(super) fn row(&self) -> Vec<String> {
        let summary = &self.results.summary;
        let rebound = Rebound::new(&self.results);
        let passed = self.comparisons.iter().filter(|comparison| comparison.passes()).count();
        let all = self.comparisons.len();
        let verdict = match all {
            0 => "<span class=\"muted\">not compared</span>".to_owned(),
            _ => format!("{} {passed} of {all}", verdict(passed == all)),
        };
        vec![
            format!("<a href=\"#{}\">{}</a>", escape(&self.name), escape(&self.reference.title)),
            optional(summary.contact_time),
            optional(summary.release_time),
            optional(rebound.map(|rebound| rebound.height)),
            optional(rebound.map(|rebound| rebound.time)),
            duration(summary.wall_seconds),
            verdict,
        ]
    }

    pub(super) fn section(&self) -> Result<Section, Failure> {
        let marks = self.marks();
        let mut html = self.lead() + &self.compared() + &run_as_html(&self.results, &marks)?;
        if let Some(thickness) = &self.thickness {
            let times = thickness.column("time").unwrap_or_default();
            let curve = |name: &String| {
                let values = thickness.column(name).unwrap_or_default();
                Curve::new(name.as_str(), times.iter().copied().zip(values).collect())
            };
            let curves = thickness.names().iter().skip(1).map(curve).collect();
            let chart = Chart { marks, ..Chart::new(cgs("smallest thickness [<length>]"), "time [s]", curves) };
            html += &format!("<h3>Thickness</h3>{}", gallery(&[chart.html()?]));
        }
        if !self.figures.is_empty() {
            html += &format!("<h3>Figures of the paper</h3>{}", gallery(&self.figures));
        }
        Ok(Section::new(&self.name, &self.reference.title, html))
    }

    /// Returns the times that the paper states.
    pub(super) fn marks(&self) -> Vec<(String, f64)> {
        let times = self.reference.comparisons.iter().filter(|asked| asked.unit == "s");
        times.filter_map(|asked| Some((format!("paper: {}", asked.quantity), asked.paper?))).collect()
    }

    pub(super) fn lead(&self) -> String {
        let Reference { source, scenario, set, .. } = &self.reference;
        let changes = set.iter().map(|set| format!("<code>{}</code>", escape(set))).collect::<Vec<_>>();
        let changes = if changes.is_empty() { String::new() } else { format!(", with {}", changes.join(", ")) };
        format!("<p>{}. Scenario <code>{}</code>{changes}.</p>", escape(source), escape(scenario))
    }

    /// Returns the table of comparisons; empty if there is none.
    pub(super) fn compared(&self) -> String {
        if self.comparisons.is_empty() {
            return String::new();
        }
        let row = |c: &Compared| {
            let band = c.band.map_or("–".to_owned(), |[low, high]| {
                if low == high { number(low) } else { format!("{} to {}", number(low), number(high)) }
            });
            let [known, computed, deviation] = [c.known, c.computed, c.deviation].map(optional);
            vec![escape(&c.quantity), known, computed, deviation, band, verdict(c.passes())]
        };
        let head = ["quantity", "known", "computed", "deviation", "band", "verdict"];
        table("", &head, &self.comparisons.iter().map(row).collect::<Vec<_>>())
    }
}

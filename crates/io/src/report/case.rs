//! The results of a run as a part of a page.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::html::{chart, escape, figure, gallery, image, number, optional, table, verdict};
use super::ledger::Ledger;
use super::setting::setting;
use crate::Error;
use crate::history::HistoryTable;
use crate::plot::{Panel, body_chart, contact_chart, force_chart, thickness_chart};
use crate::scenario::ScenarioFile;
use crate::scenario::schema::{Body, Cip, Motion, Scenario};
use crate::summary::{Comparison, Summary};

/// Pictures of fields that a run leaves: file and caption.
const FIELDS: [(&str, &str); 5] = [
    (
        "vorticity.png",
        "Isolines of the vorticity and velocity vectors at the first contact (at the end, if there is none). Below: the \
         surroundings of the lowest point. Nothing is drawn from values outside of the fluid.",
    ),
    ("vorticity-second-contact.png", "The same at the first contact after the rebound."),
    (
        "displacement-contact.png",
        "Isolines of the vertical displacement of all bodies at the first contact (at the end, if there is none).",
    ),
    ("displacement.png", "Isolines of the vertical displacement at the largest violation of the contact offset."),
    ("flow.png", "Speed of the fluid at the first contact, with the mesh that the bodies cut."),
];

/// A directory of results.
pub struct CaseResult {
    /// Name, also of the anchor on the page.
    pub name: String,
    /// Headline.
    pub title: String,
    /// What the reader should know: HTML, under the headline.
    pub lead: String,
    /// The summary, with its comparisons.
    pub summary: Summary,
    scenario: Scenario,
    history: HistoryTable,
    diagnostics: HistoryTable,
    directory: PathBuf,
}

impl CaseResult {
    /// Reads what a run left in a directory.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Json`], [`Error::Scenario`]: files are missing or malformed.
    pub fn read(directory: &Path, name: &str, title: &str) -> Result<Self, Error> {
        Ok(Self {
            name: name.to_owned(),
            title: title.to_owned(),
            lead: String::new(),
            summary: Summary::read(&directory.join("summary.json"))?,
            scenario: ScenarioFile::read(&directory.join("scenario.toml"), &[])?.scenario().clone(),
            history: HistoryTable::read(&directory.join("history.csv"))?,
            diagnostics: HistoryTable::read(&directory.join("diagnostics.csv"))?,
            directory: directory.to_owned(),
        })
    }

    /// The scenario that was run.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The history of the run.
    pub fn history(&self) -> &HistoryTable {
        &self.history
    }

    /// Prefix of the columns of the leading body: the slave of the first contact, else the first body that is moved by
    /// forces, else the first body.
    pub fn prefix(&self) -> String {
        let slave = self.scenario.contacts.first().map(|contact| contact.body.as_str());
        let moved = || {
            let is_moved = |body: &&Body| matches!(body.motion, None | Some(Motion::Free { .. }));
            self.scenario.bodies.iter().find(is_moved)
        };
        let leading = slave.or_else(|| moved().or(self.scenario.bodies.first()).map(|body| body.name.as_str()));
        leading.map_or_else(String::new, |name| self.prefix_of(name))
    }

    fn prefix_of(&self, name: &str) -> String {
        if self.scenario.bodies.len() == 1 { String::new() } else { format!("{name}_") }
    }

    /// Number of comparisons that are as asked, and of all.
    pub(super) fn passed(&self) -> (usize, usize) {
        let all = &self.summary.comparisons;
        (all.iter().filter(|comparison| passes(comparison)).count(), all.len())
    }

    /// The row of the summary table.
    pub(super) fn row(&self) -> Vec<String> {
        let (passed, all) = self.passed();
        let Summary { contact_time, release_time, max_height, max_height_time, wall_seconds, .. } = &self.summary;
        let mut row = vec![format!("<a href=\"#{}\">{}</a>", escape(&self.name), escape(&self.title))];
        row.extend([contact_time, release_time, max_height, max_height_time].map(|value| optional(*value)));
        row.push(duration(*wall_seconds));
        row.push(if all == 0 {
            "<span class=\"muted\">not compared</span>".to_owned()
        } else {
            format!("{} {passed} of {all}", verdict(passed == all))
        });
        row
    }

    /// The part of the page.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Plot`].
    pub(super) fn html(&self) -> Result<String, Error> {
        let mut html = self.lead.clone();
        html += &gallery(&[figure(&setting(&self.scenario), "The setting."), format!("<div>{}</div>", self.facts())]);
        html += &self.animation()?;
        html += &self.comparisons();
        html += "<h3>Histories</h3>";
        let prefix = self.prefix();
        let marks = &self.scenario.output.marks;
        let bodies = &self.scenario.bodies;
        let mut panels = if bodies.is_empty() { Vec::new() } else { body_chart(&self.history, &prefix, marks).panels };
        let moved = bodies.iter().filter(|body| body.motion.is_some());
        let moved: Vec<_> = moved.map(|body| (body.name.clone(), self.prefix_of(&body.name))).collect();
        panels.extend(force_chart(&self.history, &moved).into_iter().flat_map(|chart| chart.panels));
        panels.extend(thickness_chart(&self.diagnostics, marks).into_iter().flat_map(|chart| chart.panels));
        html += &legend(&panels);
        html += &charts(panels)?;
        let offset = self.scenario.contacts.first().map(|contact| contact.offset);
        if let Some(contact) = contact_chart(&self.history, &self.summary, &prefix, marks, offset) {
            html += "<h3>The first contact</h3><p>The dashed line is the contact offset.</p>";
            html += &charts(contact.panels)?;
        }
        let fields: Result<Vec<_>, Error> = FIELDS.iter().map(|(file, text)| self.field(file, text)).collect();
        let fields: Vec<String> = fields?.into_iter().flatten().collect();
        if !fields.is_empty() {
            html += "<h3>Fields</h3>";
            html += &gallery(&fields);
        }
        html += &self.balances()?;
        Ok(html)
    }

    fn field(&self, file: &str, caption: &str) -> Result<Option<String>, Error> {
        Ok(image(&self.directory.join(file), caption)?.map(|picture| figure(&picture, caption)))
    }

    /// Sizes, parameters, run times.
    fn facts(&self) -> String {
        let Summary { cells, dofs, steps, dt, newton_iterations, factorizations, peak_rss_bytes, .. } = self.summary;
        let cip = match self.scenario.fluid.cip {
            Cip::Paper { gamma_1 } => format!("paper, γ₁ = {gamma_1}"),
            Cip::Consistent { gamma_u } => format!("consistent, γ_u = {gamma_u}"),
        };
        let seconds = &self.summary.seconds;
        let stages = [
            ("cut", seconds.cut),
            ("space", seconds.space),
            ("assembly", seconds.assembly),
            ("linear solver", seconds.linear),
            ("output", seconds.output),
        ];
        let stages = stages.map(|(name, seconds)| format!("{name} {}", duration(seconds))).join(", ");
        let contacts = self.scenario.contacts.iter().map(|c| format!("ε = {} cm, s = {} cm", c.offset, c.size));
        let half = if self.summary.half_domain { " (of one half; so are forces and energies)" } else { "" };
        let rows = [
            ("source", escape(self.scenario.source.as_deref().unwrap_or("–"))),
            ("time step, end", format!("{} s, {} s ({steps} steps)", number(dt), number(self.scenario.time.end))),
            ("background cells", format!("{cells}{half}")),
            ("unknowns, at most", dofs.to_string()),
            ("interior penalty of the velocity", cip),
            ("contact", contacts.collect::<Vec<_>>().join("; ")),
            ("Newton iterations, factorisations", format!("{newton_iterations}, {factorizations}")),
            ("wall time", format!("{}: {stages}", duration(self.summary.wall_seconds))),
            ("memory", peak_rss_bytes.map_or("–".to_owned(), |bytes| format!("{} MB", bytes / 1_000_000))),
            ("energy never grew", if self.summary.energy_monotone { "yes" } else { "no" }.to_owned()),
        ];
        let rows: Vec<Vec<String>> = rows.into_iter().map(|(what, value)| vec![what.to_owned(), value]).collect();
        table("", &["", ""], &rows)
    }

    fn comparisons(&self) -> String {
        if self.summary.comparisons.is_empty() {
            return String::new();
        }
        let row = |c: &Comparison| {
            let band = c.band.map_or("–".to_owned(), |[low, high]| {
                if low == high { number(low) } else { format!("{} to {}", number(low), number(high)) }
            });
            let numbers = [c.paper, c.computed, c.deviation].map(optional);
            let mut row = vec![escape(&c.quantity)];
            row.extend(numbers);
            row.extend([band, verdict(passes(c))]);
            row
        };
        let head = ["quantity", "known", "computed", "deviation", "band", "verdict"];
        let rows: Vec<_> = self.summary.comparisons.iter().map(row).collect();
        "<h3>Compared</h3>".to_owned() + &table("", &head, &rows)
    }

    /// The animation of the run; empty if no frames were recorded.
    fn animation(&self) -> Result<String, Error> {
        let path = self.directory.join("frames.json");
        if !path.is_file() {
            return Ok(String::new());
        }
        let frames = std::fs::read_to_string(&path).map_err(|source| Error::Read { path, source })?;
        let label = format!("Animation: bodies and speed of the fluid, {}", escape(&self.title));
        // Inside of a script, only "</" could end the text.
        let frames = frames.replace("</", "<\\/");
        Ok(format!(
            "<figure class=\"animation\"><canvas role=\"img\" aria-label=\"{label}\"></canvas>\
             <div class=\"controls\"><button type=\"button\" aria-label=\"Play or pause\">Play</button>\
             <input type=\"range\" min=\"0\" value=\"0\" aria-label=\"Time of the animation\">\
             <output></output></div>\
             <figcaption>The run as it was computed: bodies, and speed of the fluid on a coarse raster. \
             The bar shows the range of the speed.</figcaption>\
             <script type=\"application/json\">{frames}</script></figure>"
        ))
    }

    /// Energies, forces, volumes.
    fn balances(&self) -> Result<String, Error> {
        let prefixes: Vec<String> = self.scenario.bodies.iter().map(|body| self.prefix_of(&body.name)).collect();
        let prefix = self.prefix();
        let ledger = Ledger {
            history: &self.history,
            diagnostics: &self.diagnostics,
            summary: &self.summary,
            prefix: &prefix,
            prefixes: &prefixes,
        };
        let mut html = "<h3>Energy</h3>".to_owned();
        html += &ledger.energies()?;
        html += &ledger.contact().unwrap_or_default();
        html += "<h3>Forces and volumes</h3>";
        let mut parts: Vec<String> = ledger.forces()?.into_iter().collect();
        parts.push(format!("<div>{}</div>", ledger.volumes()));
        html += &gallery(&parts);
        Ok(html)
    }
}

/// Graphs beside each other. The names of events are in the legend above them.
fn charts(panels: Vec<Panel>) -> Result<String, Error> {
    let unnamed = panels.into_iter().map(|mut panel| {
        panel.events.iter_mut().for_each(|event| event.label.clear());
        chart(&panel, "")
    });
    Ok(gallery(&unnamed.collect::<Result<Vec<_>, Error>>()?))
}

/// The names of the events of the first panel.
fn legend(panels: &[Panel]) -> String {
    let Some(panel) = panels.first().filter(|panel| !panel.events.is_empty()) else { return String::new() };
    let mut html = "<p class=\"legend\">".to_owned();
    for event in &panel.events {
        let _ = write!(html, "<span class=\"key c{}\"></span>{} ", event.colour, escape(&event.label));
    }
    html + "</p>"
}

fn passes(comparison: &Comparison) -> bool {
    comparison.verdict == "pass"
}

/// A wall-clock time in words.
pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

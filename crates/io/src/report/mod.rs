//! One self-contained page that tells what runs came to: no file beside it, no network.

mod case;
pub mod html;
mod ledger;
mod setting;
mod study;

use std::fmt::Write;
use std::path::Path;

pub use case::CaseResult;
pub use study::{Limit, Study, StudyRun, StudySeries};

use crate::Error;
use crate::files::write_whole;
use html::{escape, table};

const STYLE: &str = include_str!("../../assets/report/page.css");
const SCRIPT: &str = include_str!("../../assets/report/page.js");

/// A page.
#[derive(Default)]
pub struct Report {
    /// Headline.
    pub title: String,
    /// What the page is about: HTML, under the headline.
    pub lead: String,
    /// The cases, in order.
    pub cases: Vec<CaseResult>,
    /// Everything after the cases.
    pub sections: Vec<Section>,
}

/// A part of a page.
pub struct Section {
    /// Name of its anchor.
    pub id: String,
    /// Headline.
    pub title: String,
    /// Content.
    pub html: String,
}

impl Report {
    /// Writes the page; it is complete when it appears.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Plot`], [`Error::Write`].
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        if let Some(directory) = path.parent() {
            crate::files::create_directory(directory)?;
        }
        write_whole(path, self.html()?.as_bytes())
    }

    /// The page.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Plot`].
    pub fn html(&self) -> Result<String, Error> {
        let mut sections = vec![Section { id: "summary".into(), title: "Summary".into(), html: self.summary() }];
        for case in &self.cases {
            sections.push(Section { id: case.name.clone(), title: case.title.clone(), html: case.html()? });
        }
        let all = || sections.iter().chain(&self.sections);
        let title = escape(&self.title);
        let mut page = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header><h1>{title}</h1>{}</header>\n\
             <nav aria-label=\"Contents\"><ul>",
            self.lead
        );
        let is_case = |id: &str| self.cases.iter().any(|case| case.name == id);
        for Section { id, title, .. } in all() {
            // Headlines of cases are long.
            let text = if is_case(id) { id.replace('-', " ") } else { title.clone() };
            let _ = write!(page, "<li><a href=\"#{}\">{}</a></li>", escape(id), escape(&text));
        }
        page += "</ul></nav>\n<main>\n";
        for Section { id, title, html } in all() {
            let _ = writeln!(page, "<section id=\"{}\"><h2>{}</h2>{html}</section>", escape(id), escape(title));
        }
        let _ = write!(page, "</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n");
        Ok(page)
    }

    /// The table of all cases.
    fn summary(&self) -> String {
        let rows: Vec<Vec<String>> = self.cases.iter().map(CaseResult::row).collect();
        let head = ["case", "contact [s]", "release [s]", "highest [cm]", "at [s]", "wall time", "verdict"];
        let seconds: f64 = self.cases.iter().map(|case| case.summary.wall_seconds).sum();
        let machine = escape(&machine());
        table("", &head, &rows) + &format!("<p class=\"muted\">{} in all. {machine}</p>", case::duration(seconds))
    }
}

/// The machine in words, where the system tells: processor, number of threads, memory.
pub fn machine() -> String {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let field = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.starts_with(name))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let processor = field(&read("/proc/cpuinfo"), "model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let memory = field(&read("/proc/meminfo"), "MemTotal")
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok())
        .map_or(String::new(), |kilobytes| format!(", {:.0} GB of memory", kilobytes / 1e6));
    format!("{processor}, {threads} threads{memory}, {}.", std::env::consts::OS)
}

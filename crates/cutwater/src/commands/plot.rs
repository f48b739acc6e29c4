//! `cutwater plot`

use std::path::Path;

use cutwater::io::{Error, RunTables};
use cutwater::report::{Chart, Curve, Page, Section};

use super::{Failure, print};
use crate::PlotArguments;

/// Writes a page with charts of columns of one or several runs.
pub(crate) fn plot(arguments: &PlotArguments) -> Result<(), Failure> {
    if arguments.out.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("html")) {
        return Err(Error::Page { path: arguments.out.clone() }.into());
    }
    let runs = arguments.directories.iter().map(|directory| Ok((directory, RunTables::read(directory)?)));
    let runs = runs.collect::<Result<Vec<_>, Error>>()?;
    let named: Vec<(&Path, &RunTables)> =
        runs.iter().map(|(directory, tables)| (directory.as_path(), tables)).collect();
    let time = RunTables::heading(&named, "time")?;
    let mut html = String::new();
    for column in &arguments.columns {
        let mut curves = Vec::new();
        for (directory, tables) in &runs {
            let points = tables.column(column).ok_or_else(|| tables.no_column(directory, column))?;
            curves.push(Curve::new(directory.display().to_string(), points));
        }
        html += &Chart::new(RunTables::heading(&named, column)?, time, curves).html()?;
    }
    let page = Page {
        title: "Columns of runs".to_owned(),
        lead: String::new(),
        sections: vec![Section::new("columns", "Columns", html)],
    };
    page.write(&arguments.out)?;
    print(&arguments.out.display().to_string())?;
    Ok(())
}

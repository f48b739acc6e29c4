//! The page of the book with all records, and the store that it is made of.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use cutwater::io::plot::panel_svg;

use super::Failure;
use super::record::{Record, Row, short};

/// Where the sources of this program are.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_owned)
}

/// Stores records beside those of checks that were not run now, and writes the page from all.
///
/// # Errors
/// A file cannot be read or written.
pub(super) fn update(records: &[Record], order: &[&str]) -> Result<(), Failure> {
    let store = root().join("validation/verification.json");
    let mut all: BTreeMap<String, Record> = match std::fs::read_to_string(&store) {
        Ok(text) => serde_json::from_str(&text)?,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => BTreeMap::new(),
        Err(error) => return Err(error.into()),
    };
    all.extend(records.iter().map(|record| (record.check.clone(), record.clone())));
    all.retain(|name, _| order.contains(&name.as_str()));
    std::fs::write(&store, serde_json::to_string_pretty(&all)? + "\n")?;
    let source = root().join("docs/src");
    let sorted: Vec<&Record> = order.iter().filter_map(|name| all.get(*name)).collect();
    std::fs::write(source.join("verification.md"), page(&sorted))?;
    for record in sorted {
        for (k, figure) in record.figures.iter().enumerate() {
            std::fs::write(source.join(picture(&record.check, k)), panel_svg(&figure.panel())?)?;
        }
    }
    Ok(())
}

fn picture(check: &str, k: usize) -> String {
    format!("images/verification-{check}-{k}.svg")
}

fn page(records: &[&Record]) -> String {
    let mut text = "# Verification\n\n\
        Every number in a table here is measured by `cargo xtask verify NAME`; `--document` stores what it measured and writes this \
        page. The long versions are `--full`. In rows with `at most` and `at least` the reference is the bound; a verdict `-` \
        is that of a number which is shown and not bounded. Times are wall-clock times where it was run.\n\n\
        | check | what | version | took | verdict |\n|---|---|---|---|---|\n"
        .to_owned();
    for record in records {
        let failed = record.rows.iter().filter(|row| !row.holds()).count();
        let verdict = if failed == 0 { "pass".to_owned() } else { format!("{failed} missed") };
        let version = if record.full { "full" } else { "quick" };
        let took = duration(record.seconds);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| [{0}](#{0}) | {1} | {version} | {took} | {verdict} |", record.check, record.about);
    }
    for record in records {
        let _ = write!(text, "\n## {}\n\n{}\n\n", record.check, record.about);
        text += "| quantity | computed | reference | tolerance | verdict |\n|---|---|---|---|---|\n";
        for row in &record.rows {
            let verdict = if row.holds() { row.verdict.clone() } else { "**missed**".to_owned() };
            let [computed, reference] = numbers(row);
            let quantity = row.quantity.replace('|', "\\|");
            let _ = writeln!(text, "| {quantity} | {computed} | {reference} | {} | {verdict} |", row.tolerance);
        }
        for note in &record.notes {
            let _ = write!(text, "\n{note}\n");
        }
        for (k, figure) in record.figures.iter().enumerate() {
            let _ = write!(text, "\n![{}]({})\n", figure.title, picture(&record.check, k));
        }
    }
    text
}

/// Computed number and reference as texts.
pub(super) fn numbers(row: &Row) -> [String; 2] {
    [row.computed.map_or("not finite".to_owned(), short), row.reference.map_or("-".to_owned(), short)]
}

/// A time to two digits; empty for zero, which is not known.
pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        0.0 => String::new(),
        s if s < 99.5 => format!("{} s", short_time(s)),
        s => format!("{} min", short_time(s / 60.0)),
    }
}

fn short_time(x: f64) -> String {
    if x < 9.95 { format!("{x:.1}") } else { format!("{x:.0}") }
}

//! Records as pages of the book: one Markdown file for each, with its charts.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cutwater::report::html::duration;

use super::missed::MISSED;
use super::record::RecordRow;
use super::{Failure, Record, short};
use crate::chart::svg;
use crate::report::{commit, git};

/// Folder of the pages of checks in `docs/src`.
pub(super) const FOLDER: &str = "verification";
/// Folder of the pages of cases.
pub(crate) const RESULTS: &str = "results";

/// Writes the page of a record into a folder of the book, and its charts. The page names the command that measured it
/// and the version of the code.
pub(crate) fn write(folder: &str, record: &Record, command: &str, version: &str) -> Result<(), Failure> {
    let source = source();
    let text = markdown(folder, record, command, version);
    std::fs::create_dir_all(source.join(folder))?;
    std::fs::write(source.join(folder).join(&record.check).with_extension("md"), text)?;
    for (k, figure) in record.figures.iter().enumerate() {
        let path = source.join("images").join(picture(folder, record, k));
        std::fs::write(path, svg(figure)?)?;
    }
    Ok(())
}

/// Returns the folder of the pages of the book.
pub(crate) fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src")
}

/// Paths in the root of the workspace on which results depend.
const CODE: [&str; 9] = [
    "crates",
    "validation/src",
    "validation/cases",
    "validation/reference",
    "benchmarks/src",
    "examples",
    "Cargo.toml",
    "Cargo.lock",
    "rust-toolchain.toml",
];

/// Returns the version of the code and its date at the first call, if git has them; else an empty text. It ends with
/// `-dirty` if the code has uncommitted changes. Pages that are written later change the tree, but not the code that
/// runs.
pub(crate) fn version() -> String {
    static VERSION: OnceLock<String> = OnceLock::new();
    let read = || {
        let (commit, date) = (git(&["describe", "--always"])?, git(&["log", "-1", "--format=%cs"])?);
        let mark = if differs_from("HEAD")? { "-dirty" } else { "" };
        Some(format!("{commit}{mark}, {date}"))
    };
    VERSION.get_or_init(|| read().unwrap_or_default()).clone()
}

/// Returns whether the code in the tree differs from that of a version; `None` if git does not have it.
fn differs_from(version: &str) -> Option<bool> {
    Some(!git(&[&["diff", "--name-only", version, "--"][..], &CODE].concat())?.is_empty())
}

/// Returns an error for uncommitted changes: a page names the version of the code that measured it.
///
/// # Errors
/// The tree has uncommitted changes.
pub(crate) fn require_clean_tree() -> Result<(), Failure> {
    version();
    match commit().filter(|version| version.ends_with("-dirty")) {
        Some(version) => {
            Err(format!("the tree has uncommitted changes ({version}): commit them before pages are written").into())
        }
        None => Ok(()),
    }
}

/// Returns a line for each page of checks and studies that was measured before the last change of the code. Pages with
/// versions that git does not have are left out.
pub(crate) fn older_than_the_code() -> Vec<String> {
    let mut lines = Vec::new();
    for folder in [FOLDER, RESULTS, "studies"] {
        let entries = std::fs::read_dir(source().join(folder)).into_iter().flatten().flatten();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        paths.sort();
        for path in paths {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let Some((_, after)) = text.split_once("measured with version ") else { continue };
            let ages = versions(after).filter_map(|version| Some((changes_after(version)?, version)));
            if let Some((changes, version)) = ages.max().filter(|(changes, _)| *changes > 0) {
                let name = path.file_stem().unwrap_or_default().to_string_lossy();
                lines.push(format!(
                    "{folder}/{name}: measured with version {version}, {changes} changes of the code ago"
                ));
            }
        }
    }
    lines
}

/// Returns the number of changes of the code since a version; `None` if git does not have it.
fn changes_after(version: &str) -> Option<usize> {
    git(&[&["rev-list", "--count", &format!("{version}..HEAD"), "--"][..], &CODE].concat())?.parse().ok()
}

/// Returns whether a text of [`version`] names a commit with the code that is in the tree.
pub(crate) fn is_current(text: &str) -> bool {
    let mut of_text = versions(text);
    let is_same = of_text.next().is_some_and(|version| differs_from(version) == Some(false));
    is_same && of_text.next().is_none() && !text.contains("-dirty")
}

/// Returns the versions that a page names after "measured with version": runs of a study may have several.
fn versions(text: &str) -> impl Iterator<Item = &str> {
    let list = text.split(" (").next().unwrap_or_default().split("; it took").next().unwrap_or_default();
    let is_version = |word: &&str| word.len() >= 7 && word.chars().all(|c| c.is_ascii_hexdigit());
    list.split(|c: char| !c.is_ascii_alphanumeric()).filter(is_version)
}

fn picture(folder: &str, record: &Record, k: usize) -> String {
    format!("{}-{}-{k}.svg", folder, record.check)
}

fn markdown(folder: &str, record: &Record, command: &str, version: &str) -> String {
    let is_missed = |row: &RecordRow| !row.holds() || row.verdict == MISSED;
    let failed = record.rows.iter().filter(|row| is_missed(row)).count();
    let verdict = match (record.rows.len(), failed) {
        (0, _) => String::new(),
        (_, 0) => "pass; ".to_owned(),
        (_, failed) => format!("**{failed} missed**; "),
    };
    let version = if version.is_empty() { String::new() } else { format!(", measured with version {version}") };
    let mut text = format!(
        "# {}\n\n{}\n\n{verdict}`{command}`{version}; it took {}.\n",
        record.check,
        record.about,
        duration(record.seconds)
    );
    // Writing to a string cannot fail.
    if !record.rows.is_empty() {
        text += "\n| quantity | computed | reference | tolerance | verdict |\n|---|---|---|---|---|\n";
    }
    for row in &record.rows {
        let verdict = if is_missed(row) { "**missed**".to_owned() } else { row.verdict.clone() };
        let [computed, reference] = numbers(row);
        let _ =
            writeln!(text, "| {} | {computed} | {reference} | {} | {verdict} |", cell(&row.quantity), row.tolerance);
    }
    for table in &record.tables {
        let line = |cells: &[String]| cells.iter().map(|text| cell(text)).collect::<Vec<_>>().join(" | ");
        let _ = write!(text, "\n| {} |\n|{}\n", line(&table.head), "---|".repeat(table.head.len()));
        table.rows.iter().for_each(|row| text += &format!("| {} |\n", line(row)));
    }
    for note in &record.notes {
        let _ = write!(text, "\n{note}\n");
    }
    for (k, figure) in record.figures.iter().enumerate() {
        let _ = write!(text, "\n![{}](../images/{})\n", figure.title, picture(folder, record, k));
    }
    text
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// Returns the computed number and reference as texts.
pub(super) fn numbers(row: &RecordRow) -> [String; 2] {
    [row.computed.map_or("not finite".to_owned(), short), row.reference.map_or("-".to_owned(), short)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::record::TextTable;

    #[test]
    fn a_page_has_all_parts_of_its_record() {
        let mut record = Record::new("x", "About x.", true);
        record.at_most("a | b", 2.0, 1.0);
        record.tables.push(TextTable { head: vec!["p".into(), "q".into()], rows: vec![vec!["1".into(), "2".into()]] });
        record.note("A note.");
        record.figure("f", "x", vec![("c", Vec::new())]);
        let text = markdown(FOLDER, &record, "run x", "abc, today");
        for part in [
            "# x\n\nAbout x.\n\n**1 missed**; `run x`, measured with version abc, today; it took 0.0 s.\n",
            "| a \\| b | 2 | 1 | at most | **missed** |",
            "| p | q |\n|---|---|\n| 1 | 2 |",
            "\nA note.\n",
            "![f](../images/verification-x-0.svg)",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
    }

    #[test]
    fn a_version_is_current_if_the_code_is_the_same() {
        let last = git(&[&["rev-list", "-2", "HEAD", "--"][..], &CODE].concat()).unwrap_or_default();
        let [changed, before] = last.lines().collect::<Vec<_>>()[..] else {
            return println!("skipped: no history of versions");
        };
        assert_eq!((changes_after(changed), changes_after(before)), (Some(0), Some(1)));
        let is_clean = !version().contains("-dirty");
        assert_eq!(is_current(&format!("{changed}, 2026-01-01")), is_clean);
        assert_eq!(is_current(&version()), is_clean);
        for other in
            [before, "", "fffffff", "not a version", &format!("{changed}-dirty"), &format!("{before}, {changed}")]
        {
            assert!(!is_current(other), "{other}");
        }
    }

    #[test]
    fn a_page_may_name_several_versions() {
        for (text, expected) in [
            ("abc1234, 2026-11-23; it took 3 s.", &["abc1234"][..]),
            ("abc1234, 2026-11-23; 0def567-dirty, 2026-11-20 (2 cores); it took 3 s.", &["abc1234", "0def567"]),
        ] {
            assert_eq!(versions(text).collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn the_book_links_to_the_page_of_every_check() {
        let read = |name: &str| std::fs::read_to_string(source().join(name)).unwrap_or_default();
        for check in &crate::verify::CHECKS {
            let link = format!("[{0}](verification/{0}.md)", check.name);
            assert_eq!(
                (read("verification.md").matches(&link).count(), read("SUMMARY.md").matches(&link).count()),
                (1, 1),
                "{link}"
            );
            assert!(
                read(&format!("verification/{}.md", check.name)).starts_with(&format!("# {}\n", check.name)),
                "{link}"
            );
        }
    }

    /// Checks that the book links to each page that cases and studies have written, and to no other.
    #[test]
    fn the_book_links_to_the_pages_of_cases_and_studies() {
        let summary = std::fs::read_to_string(source().join("SUMMARY.md")).unwrap_or_default();
        for folder in ["results", "studies"] {
            let entries = std::fs::read_dir(source().join(folder)).into_iter().flatten().flatten();
            let mut names: Vec<_> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
            names.sort();
            assert!(!names.is_empty(), "{folder}");
            for name in &names {
                assert_eq!(summary.matches(&format!("]({folder}/{name})")).count(), 1, "{folder}/{name}");
            }
            assert_eq!(summary.matches(&format!("]({folder}/")).count(), names.len(), "{folder}");
        }
    }
}

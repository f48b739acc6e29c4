//! Small rules: module sentences, sizes of files, numbers in terms, the list of crates; budgets.

use super::source::Source;
use super::tree::{Finding, SourceTree};

/// Largest number of lines of a file.
const FILE_LINES: usize = 600;
/// Largest number of characters of a line of a comment, that of code. Tables and examples have longer ones, and keys of
/// scenarios, whose sentences are one line each.
const COMMENT_WIDTH: usize = 120;
/// Largest numbers of lines of Rust below some folders (docs/adr/0022).
const BUDGETS: &[(&[&str], usize)] = &[
    (&["crates/cutwater/src/lib.rs", "crates/cutwater/src/main.rs"], 385),
    (&["crates/io/src"], 13_920),
    (&["crates/report/src"], 1590),
    (&["crates/solver/src"], 3_800),
    (&["validation"], 14_220),
    (&["xtask/src"], 2420),
    (&[""], 87_170),
];
/// Largest number of bytes of all JSON files under version control.
const JSON_BYTES: usize = 50_000;
/// Largest number of bytes of a file under version control.
const FILE_BYTES: usize = 600_000;
/// Largest number of lines of a time step.
const ADVANCE_LINES: usize = 40;
/// Prefixes of paths that are specific to one machine.
const MACHINE_PATHS: &[&str] = &["/home/", "/Users/", "/root/", "/work/"];
/// The page with the list of crates.
const ARCHITECTURE: &str = "docs/ARCHITECTURE.md";

/// Applies the rules.
pub(super) fn check(tree: &SourceTree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for source in &tree.rust {
        module_sentence(source, &mut findings);
        file_size(source, &mut findings);
        numbers_in_terms(source, &mut findings);
    }
    for source in tree.rust.iter().chain(&tree.other) {
        whitespace_and_paths(source, &mut findings);
    }
    budgets(tree, &mut findings);
    step_is_short(tree, &mut findings);
    architecture_lists_crates(tree, &mut findings);
    findings
}

fn module_sentence(source: &Source, findings: &mut Vec<Finding>) {
    if !source.text.starts_with("//! ") {
        findings.push(Finding::new(&source.path, 1, "begin the file with one `//!` sentence that names its subject"));
    }
}

fn file_size(source: &Source, findings: &mut Vec<Finding>) {
    let n = source.text.lines().count();
    if n > FILE_LINES {
        findings.push(Finding::new(
            &source.path,
            n,
            format!("{n} lines, at most {FILE_LINES}: split the file by subject"),
        ));
    }
}

/// Finds numbers in terms other than small integers and halves: penalty constants and material data must be named
/// fields.
fn numbers_in_terms(source: &Source, findings: &mut Vec<Finding>) {
    if !source.path.contains("/terms/") {
        return;
    }
    for (number, line) in source.code_lines() {
        for word in line.split(|c: char| !(c.is_alphanumeric() || c == '.' || c == '_')) {
            let is_float = word.starts_with(|c: char| c.is_ascii_digit()) && word.contains('.') && !word.contains("..");
            let value = word.trim_end_matches("_f64").parse::<f64>().ok().filter(|_| is_float);
            if value.is_some_and(|v| v > 10.0 || (2.0 * v).fract() != 0.0) {
                let advice = format!("{word} in a term: make it a field with the name of the paper");
                findings.push(Finding::new(&source.path, number, advice));
            }
        }
    }
}

fn whitespace_and_paths(source: &Source, findings: &mut Vec<Finding>) {
    for (number, line) in source.lines() {
        if line.ends_with([' ', '\t']) {
            findings.push(Finding::new(&source.path, number, "white space at the end of the line"));
        }
        let is_comment = source.path.ends_with(".rs") && line.trim_start().starts_with("//");
        let text = line.trim_start().trim_start_matches(['/', '!']);
        let is_free = text.starts_with("    ") || text.trim_start().starts_with('|');
        let may_be_long = is_free || source.path.starts_with("crates/io/src/scenario/");
        if is_comment && !may_be_long && line.chars().count() > COMMENT_WIDTH {
            findings.push(Finding::new(&source.path, number, format!("wrap comments at {COMMENT_WIDTH} characters")));
        }
        let lists_them = source.path.ends_with("tidy/hygiene.rs");
        let at =
            |path: &str| line.find(path).filter(|&k| !line[..k].ends_with(|c: char| c.is_alphanumeric() || c == '.'));
        if let Some(path) = MACHINE_PATHS.iter().find(|path| !lists_them && at(path).is_some()) {
            findings.push(Finding::new(&source.path, number, format!("a path of one machine: {path}...")));
        }
    }
    if !source.text.is_empty() && !source.text.ends_with('\n') {
        findings.push(Finding::new(&source.path, source.text.lines().count(), "no line break at the end of the file"));
    }
}

/// Finds budgets that are exceeded.
fn budgets(tree: &SourceTree, findings: &mut Vec<Finding>) {
    let mut check = |path: &str, n: usize, most: usize, unit: &str| {
        if n > most {
            findings.push(Finding::new(path, 1, format!("{n} {unit}, at most {most}")));
        }
    };
    for (folders, most) in BUDGETS {
        let of = tree.rust.iter().filter(|source| folders.iter().any(|folder| source.path.starts_with(folder)));
        check(folders[0], of.map(|source| source.text.lines().count()).sum(), *most, "lines of Rust");
    }
    let is_json = |path: &str| path.ends_with(".json");
    check(
        "Cargo.toml",
        tree.sizes.iter().filter(|(path, _)| is_json(path)).map(|(_, n)| n).sum(),
        JSON_BYTES,
        "bytes of JSON",
    );
    for (path, n) in &tree.sizes {
        check(path, *n, FILE_BYTES, "bytes");
    }
}

/// Checks the length of `advance`, an entry point for readers that must fit on a screen.
fn step_is_short(tree: &SourceTree, findings: &mut Vec<Finding>) {
    let path = "crates/solver/src/step.rs";
    let Some(step) = tree.rust.iter().find(|source| source.path == path) else {
        findings.push(Finding::new(path, 1, "the file is missing: docs/ARCHITECTURE.md refers to it"));
        return;
    };
    let first = step.lines().find(|(_, line)| line.starts_with("pub fn advance")).map_or(1, |(number, _)| number);
    let last = step.lines().find(|(number, line)| *number > first && *line == "}").map_or(first, |(number, _)| number);
    let n = last + 1 - first;
    if n > ADVANCE_LINES || n == 1 {
        let advice =
            format!("`advance` has {n} lines, at most {ADVANCE_LINES}: move details to the functions that it calls");
        findings.push(Finding::new(path, first, advice));
    }
}

/// Checks that the code map has a heading `### name` for each package of the workspace, and no other.
fn architecture_lists_crates(tree: &SourceTree, findings: &mut Vec<Finding>) {
    let Some(page) = tree.page(ARCHITECTURE) else {
        findings.push(Finding::new(ARCHITECTURE, 1, "the page is missing"));
        return;
    };
    let heading = |line: &str| line.strip_prefix("### `")?.split('`').next().map(str::to_owned);
    let listed: Vec<(usize, String)> = page.lines().filter_map(|(n, line)| Some((n, heading(line)?))).collect();
    for (name, ..) in tree.manifests() {
        if !listed.iter().any(|(_, listed)| listed == name) {
            findings.push(Finding::new(ARCHITECTURE, 1, format!("`{name}` has no heading in the code map")));
        }
    }
    for (number, name) in &listed {
        if !tree.manifests().any(|(package, ..)| package == name) {
            findings.push(Finding::new(ARCHITECTURE, *number, format!("`{name}` is not in the workspace")));
        }
    }
}

//! Small rules: module sentences, sizes of files, names, leftovers, numbers in terms, the list of crates.

use super::source::{Source, words};
use super::{Finding, Workspace};

/// Largest number of lines of a file.
const FILE_LINES: usize = 600;
/// Files that may be longer, each with a reason.
const LONG_FILES: [(&str, &str); 0] = [];
/// Largest number of lines of the facade's library and binary together.
const FACADE_LINES: usize = 150;
/// Largest number of lines of xtask.
const XTASK_LINES: usize = 1500;
/// Largest number of lines of a time step.
const ADVANCE_LINES: usize = 40;
/// Leftovers, put together here so that this file does not find itself.
const LEFTOVERS: [(&str, &str); 4] = [
    ("todo!", "do it, or write it to the tracker"),
    ("unimplemented!", "return an error that says so"),
    ("dbg!", "remove it"),
    ("#[ignore", "no test is ignored: make it fast, or move it to `cargo xtask verify`"),
];
/// Words that say nothing about what is inside.
const EMPTY_WORDS: [&str; 6] = ["utils", "util", "helpers", "common", "misc", "stuff"];
/// The empty words that name shared files of tests, as cargo's own book does.
const TEST_FOLDERS: [&str; 1] = ["/tests/common/mod.rs"];
/// Beginnings of paths that exist on one machine only.
const MACHINE_PATHS: [&str; 4] = ["/home/", "/Users/", "/root/", "/work/"];
/// The page with the list of crates.
const ARCHITECTURE: &str = "docs/ARCHITECTURE.md";

/// Applies all small rules.
pub(super) fn check(workspace: &Workspace) -> Vec<Finding> {
    let mut findings = Vec::new();
    for source in &workspace.rust {
        module_sentence(source, &mut findings);
        file_size(source, &mut findings);
        leftovers(source, &mut findings);
        names(source, &mut findings);
        numbers_in_terms(source, &mut findings);
    }
    for source in workspace.rust.iter().chain(&workspace.other) {
        whitespace_and_paths(source, &mut findings);
    }
    budget(workspace, &["crates/cutwater/src/lib.rs", "crates/cutwater/src/main.rs"], FACADE_LINES, &mut findings);
    budget(workspace, &["xtask/src/"], XTASK_LINES, &mut findings);
    step_is_short(workspace, &mut findings);
    architecture_lists_crates(workspace, &mut findings);
    findings
}

fn module_sentence(source: &Source, findings: &mut Vec<Finding>) {
    if !source.text.starts_with("//! ") {
        findings.push(Finding::new(&source.path, 1, "begin the file with one `//!` sentence that says what it is"));
    }
}

fn file_size(source: &Source, findings: &mut Vec<Finding>) {
    let n = source.text.lines().count();
    if n > FILE_LINES && !LONG_FILES.iter().any(|(path, _)| *path == source.path) {
        findings.push(Finding::new(
            &source.path,
            n,
            format!("{n} lines, at most {FILE_LINES}: split the file by subject"),
        ));
    }
}

fn leftovers(source: &Source, findings: &mut Vec<Finding>) {
    // Tests count too, so this looks at the text, not at the code; only whole lines of comment are left out.
    let lines = source.lines().filter(|(_, line)| !line.trim_start().starts_with("//"));
    for (number, line) in lines {
        for (leftover, advice) in LEFTOVERS {
            let is_named = line.contains(&format!("\"{leftover}"));
            if line.contains(leftover) && !is_named {
                findings.push(Finding::new(&source.path, number, format!("`{leftover}`: {advice}")));
            }
        }
    }
}

fn names(source: &Source, findings: &mut Vec<Finding>) {
    let stem = source.path.rsplit('/').next().unwrap_or_default().trim_end_matches(".rs");
    let folders = source.path.split('/').chain([stem]);
    if !TEST_FOLDERS.iter().any(|end| source.path.ends_with(end)) {
        for word in folders.filter(|folder| EMPTY_WORDS.contains(folder)) {
            findings.push(Finding::new(
                &source.path,
                1,
                format!("`{word}` says nothing: name the file for its subject"),
            ));
        }
    }
    for (number, line) in source.code_lines() {
        let names = ["fn ", "struct ", "enum ", "trait ", "mod "].iter().filter_map(|kind| {
            let offset = words(line, kind.trim()).next()?;
            let rest = line.get(offset + kind.len()..)?;
            rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()
        });
        for name in names {
            let is_second = ["2", "_new", "_old", "New", "Old"].iter().any(|end| name.ends_with(end));
            if is_second && name.len() > 3 {
                findings.push(Finding::new(&source.path, number, format!("`{name}`: replace the first one instead")));
            }
        }
    }
}

/// Penalty constants and material data are fields with names; only 0, 1, 2, 3, ... and halves may stand in a term.
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

fn budget(workspace: &Workspace, paths: &[&str], lines: usize, findings: &mut Vec<Finding>) {
    let of = workspace.rust.iter().filter(|source| paths.iter().any(|path| source.path.starts_with(path)));
    let n: usize = of.map(|source| source.text.lines().count()).sum();
    if n > lines {
        let advice = format!("{n} lines in {}, at most {lines}: move work to where it belongs", paths.join(" and "));
        findings.push(Finding::new(paths[0], 1, advice));
    }
}

/// `advance` is the page that everyone reads first.
fn step_is_short(workspace: &Workspace, findings: &mut Vec<Finding>) {
    let path = "crates/solver/src/step.rs";
    let Some(step) = workspace.rust.iter().find(|source| source.path == path) else {
        findings.push(Finding::new(path, 1, "the time step is gone: docs/ARCHITECTURE.md sends readers here"));
        return;
    };
    let first = step.lines().find(|(_, line)| line.starts_with("pub fn advance")).map_or(1, |(number, _)| number);
    let last = step.lines().find(|(number, line)| *number > first && *line == "}").map_or(first, |(number, _)| number);
    let n = last + 1 - first;
    if n > ADVANCE_LINES || n == 1 {
        let advice =
            format!("`advance` has {n} lines, at most {ADVANCE_LINES}: it only says what happens in which order");
        findings.push(Finding::new(path, first, advice));
    }
}

/// The code map has a headline `### name` for each package of the workspace, and no other.
fn architecture_lists_crates(workspace: &Workspace, findings: &mut Vec<Finding>) {
    let Some(page) = workspace.page(ARCHITECTURE) else {
        findings.push(Finding::new(ARCHITECTURE, 1, "the page is gone"));
        return;
    };
    let headline = |line: &str| line.strip_prefix("### `")?.split('`').next().map(str::to_owned);
    let listed: Vec<(usize, String)> = page.lines().filter_map(|(n, line)| Some((n, headline(line)?))).collect();
    for (name, ..) in workspace.manifests() {
        if !listed.iter().any(|(_, listed)| listed == name) {
            findings.push(Finding::new(ARCHITECTURE, 1, format!("`{name}` has no headline in the code map")));
        }
    }
    for (number, name) in &listed {
        if !workspace.manifests().any(|(package, ..)| package == name) {
            findings.push(Finding::new(ARCHITECTURE, *number, format!("`{name}` is not in the workspace")));
        }
    }
}

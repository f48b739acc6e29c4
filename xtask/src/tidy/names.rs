//! Names of files, functions and types.

use std::collections::BTreeMap;

use super::source::{Source, words};
use super::tree::{Finding, SourceTree};

/// Words in names of files that do not describe a subject.
const EMPTY_WORDS: &[&str] = &["utils", "util", "helpers", "common", "misc", "stuff", "kernel"];
/// Shared files of tests, named as in cargo's own book.
const TEST_FOLDERS: &[&str] = &["/tests/common/mod.rs"];
/// Endings that mark a second version.
const SECOND: &[&str] = &["2", "_new", "_old", "New", "Old"];
/// Type names that several crates, programs or commands may define, each with the same meaning: errors, and arguments
/// and results of commands.
const SHARED: &[&str] = &["Error", "Arguments", "Command", "Failure", "Outcome"];
/// Folder of the terms of a crate. Terms of several crates may have the same name, such as the inertia of fluid and
/// solid.
const TERMS: &str = "/terms/";

/// Checks all names.
pub(super) fn check(tree: &SourceTree) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut types: BTreeMap<&str, Vec<(&Source, usize)>> = BTreeMap::new();
    for source in &tree.rust {
        file_name(source, &mut findings);
        for (number, line) in source.code_lines() {
            let declared =
                ["fn", "struct", "enum", "trait", "type", "mod"].iter().filter_map(|kind| name_after(line, kind));
            for (kind, name) in declared {
                if name.len() > 3 && SECOND.iter().any(|end| name.ends_with(end)) {
                    let advice = format!("`{name}`: replace the first version instead");
                    findings.push(Finding::new(&source.path, number, advice));
                }
                // Declarations inside of macros are indented; `$Name` in the macro itself is not a declared name.
                // An indented `type` is an associated one, of a trait of the standard library or our own.
                let is_type = ["struct", "enum", "trait"].contains(&kind)
                    || kind == "type" && !line.starts_with(char::is_whitespace);
                if is_type && !name.is_empty() && source.is_src() {
                    types.entry(name).or_default().push((source, number));
                }
            }
        }
    }
    for (name, places) in types.iter().filter(|(name, _)| !SHARED.contains(*name)) {
        let is_term = |source: &Source| source.path.contains(TERMS);
        for (k, (source, number)) in places.iter().enumerate() {
            let is_other = |(other, _): &&(&Source, usize)| !(is_term(source) && is_term(other));
            if let Some((other, _)) = places[..k].iter().find(is_other) {
                let advice = format!("`{name}` is also a type in {}: one name, one meaning", other.path);
                findings.push(Finding::new(&source.path, *number, advice));
            }
        }
    }
    findings
}

/// Returns the name in a declaration of the given kind on a line.
fn name_after<'a, 'k>(line: &'a str, kind: &'k str) -> Option<(&'k str, &'a str)> {
    let rest = line[words(line, kind).next()? + kind.len()..].strip_prefix(' ')?;
    Some((kind, rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()?))
}

fn file_name(source: &Source, findings: &mut Vec<Finding>) {
    let path = source.path.trim_end_matches(".rs");
    let is_test_folder = TEST_FOLDERS.iter().any(|end| source.path.ends_with(end));
    let words = path.split(['/', '_']);
    for word in words.filter(|word| !is_test_folder && EMPTY_WORDS.contains(word)) {
        findings.push(Finding::new(&source.path, 1, format!("`{word}` has no content: name the file for its subject")));
    }
}

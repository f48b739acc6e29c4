//! Sources of formulas: every term has one, and the page from equations to files is made from them.

use super::source::Source;
use super::tree::{Finding, SourceTree};

/// The generated page.
pub(super) const PAGE: &str = "docs/src/reference/equations.md";

/// Folders and files of formulas in addition to `terms/`.
const LAWS: [&str; 3] = ["crates/contact/src/law/", "crates/solid-svk/src/material/", "crates/solver/src/collision.rs"];

/// Files in these folders without formulas: traits and checks.
const NOT_A_LAW: [&str; 2] = ["/mod.rs", "/check.rs"];

/// Equations that must have a file: the name in the `Source:` line, and a description.
const REQUIRED: [(&str, &str); 7] = [
    ("Eq. (4)", "the semi-discrete problem"),
    ("Eq. (6)", "the contact law"),
    ("Eq. (7)", "contact with a rigid obstacle"),
    ("Eq. (11)", "the fully discrete problem with contact"),
    ("Remark 2", "the offset of contact"),
    ("`s_h`", "the interior penalty"),
    ("two-body", "contact of two bodies"),
];

/// A formula with its source and its file.
struct TermFormula {
    title: String,
    formula: String,
    source: String,
    path: String,
}

/// Finds terms without source, equations without file, and a page that is out of date.
pub(super) fn check(tree: &SourceTree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for source in formula_files(tree) {
        if source.path.contains("/terms/") && !source.text.contains("/// Source: ") {
            let advice = "a term without `/// Source: ...`: name the equation, or author, year and DOI";
            findings.push(Finding::new(&source.path, 1, advice));
        }
    }
    let formulas = formulas(tree);
    for (equation, what) in REQUIRED {
        if !formulas.iter().any(|formula| formula.source.contains(equation)) {
            findings.push(Finding::new(PAGE, 1, format!("no file has a `Source:` with {equation}, {what}")));
        }
    }
    if !formulas.iter().any(|formula| formula.formula.contains("g_h(")) {
        findings.push(Finding::new(PAGE, 1, "no file has the formula of `g_h(u, v)`, the ghost penalty"));
    }
    if tree.page(PAGE).is_none_or(|source| source.text != page(tree)) {
        findings.push(Finding::new(PAGE, 1, "out of date: run `cargo xtask tidy --fix`"));
    }
    findings
}

/// Returns the text of the page.
pub(super) fn page(tree: &SourceTree) -> String {
    let mut page = String::from(
        "# From equations to files\n\n\
         Made by `cargo xtask tidy --fix` from the `Source:` lines of the code; do not edit.\n\n\
         *The paper* is Formaggia, Gatti, Zonca, MOX-Report 44/2019.\n\n\
         | formula | what | source | file |\n|---|---|---|---|\n",
    );
    for TermFormula { title, formula, source, path } in formulas(tree) {
        let cell = |text: &str| without_links(text).replace('|', "\\|");
        page += &format!("| {} | {} | {} | `{path}` |\n", cell(&formula), cell(&title), cell(&source));
    }
    page
}

/// Returns a text without the links of rustdoc, which have no meaning in the book. Their names stay.
fn without_links(text: &str) -> String {
    let mut parts = text.split("[`");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let Some((name, rest)) = part.split_once("`]") else {
            plain += &format!("[`{part}");
            continue;
        };
        let rest = match rest.strip_prefix('(').and_then(|path| path.split_once(')')) {
            Some((_, after)) => after,
            None => rest,
        };
        plain += &format!("`{name}`{rest}");
    }
    plain
}

fn formula_files(tree: &SourceTree) -> impl Iterator<Item = &Source> {
    tree.rust.iter().filter(|source| {
        let is_term = source.is_src() && source.path.contains("/terms/") && !source.path.ends_with("/mod.rs");
        let is_law = LAWS.iter().any(|folder| source.path.starts_with(folder));
        is_term || (is_law && !NOT_A_LAW.iter().any(|end| source.path.ends_with(end)))
    })
}

fn formulas(tree: &SourceTree) -> Vec<TermFormula> {
    formula_files(tree).flat_map(of_file).collect()
}

/// Returns the formulas of the doc comments with a source.
fn of_file(file: &Source) -> Vec<TermFormula> {
    let title = file.text.lines().next().and_then(|line| line.strip_prefix("//! ")).unwrap_or_default();
    let title = title.trim_end_matches('.').to_owned();
    let mut formulas = Vec::new();
    let mut comment: Vec<&str> = Vec::new();
    for line in file.text.lines() {
        match line.strip_prefix("///") {
            Some(text) => comment.push(text.trim()),
            None => {
                formulas.extend(of_comment(&comment, &title, &file.path));
                comment.clear();
            }
        }
    }
    formulas
}

fn of_comment(comment: &[&str], title: &str, path: &str) -> Option<TermFormula> {
    let first = comment.iter().position(|line| line.starts_with("Source: "))?;
    let sentence = |lines: &[&str]| lines.join(" ").trim_end_matches('.').to_owned();
    let end = |line: &&str| {
        line.is_empty() || ["Couples:", "Units", "Shapes:", "Conventions:", "With "].iter().any(|w| line.starts_with(w))
    };
    let last = comment[first..].iter().position(end).map_or(comment.len(), |n| first + n);
    let formula_end = comment.iter().position(|line| line.is_empty()).unwrap_or(first);
    Some(TermFormula {
        title: title.to_owned(),
        formula: sentence(&comment[..formula_end]),
        source: sentence(&comment[first..last]).trim_start_matches("Source: ").to_owned(),
        path: path.to_owned(),
    })
}

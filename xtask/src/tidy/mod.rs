//! `cargo xtask tidy`: checks of structure and wording that the compiler does not make. A test of this crate runs them.

mod allowed_words;
mod cycles;
mod dimensions;
mod equations;
mod hygiene;
mod layers;
mod names;
mod prose;
mod source;
mod third_party;
mod tree;

use std::fs;
use std::io;

use crate::process::Outcome;
use tree::{Finding, SourceTree};

/// Flags of the task.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Write the generated pages of the book before checking.
    #[arg(long)]
    fix: bool,
}

/// Returns the findings of all rules, in the order of files and lines. Each module begins with its rule.
fn findings(tree: &SourceTree) -> Vec<Finding> {
    let rules = [
        layers::check,
        third_party::check,
        dimensions::check,
        equations::check,
        hygiene::check,
        names::check,
        allowed_words::check,
        cycles::check,
        prose::check,
    ];
    let mut findings: Vec<Finding> = rules.iter().flat_map(|check| check(tree)).collect();
    findings.sort_by(|a, b| (&a.path, a.line).cmp(&(&b.path, b.line)));
    findings
}

/// Writes the pages of the book that are made from the code.
///
/// # Errors
/// A file cannot be read or written.
pub(crate) fn write_generated_pages() -> io::Result<()> {
    let tree = SourceTree::read()?;
    let path = tree.root.join(equations::PAGE);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, equations::page(&tree))
}

/// Runs the task.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    if arguments.fix {
        write_generated_pages()?;
    }
    let tree = SourceTree::read()?;
    let findings = findings(&tree);
    for Finding { path, line, advice } in &findings {
        println!("{path}:{line}: {advice}");
    }
    println!("tidy: {} Rust files, {} findings", tree.rust.len(), findings.len());
    Ok(findings.is_empty())
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::source::Source;
    use super::*;

    #[test]
    fn the_workspace_is_tidy() {
        let tree = SourceTree::read().expect("a workspace");
        let findings: Vec<String> =
            findings(&tree).into_iter().map(|f| format!("{}:{}: {}", f.path, f.line, f.advice)).collect();
        assert!(findings.is_empty(), "\n{}", findings.join("\n"));
    }

    /// Checks that a file with this text has a finding on this line.
    fn check_finds(path: &str, text: &str, line: usize, advice: &str) {
        let source = Source::new(path, text.to_owned());
        let tree = SourceTree { rust: vec![source], ..SourceTree::default() };
        let findings = findings(&tree);
        let found = findings.iter().any(|f| f.path == path && f.line == line && f.advice.contains(advice));
        assert!(found, "{path}: {text:?}: nothing about {advice:?} on line {line} in {findings:?}");
    }

    #[test]
    fn every_rule_finds_a_violation() {
        let term = "crates/fluid-ns/src/terms/a.rs";
        check_finds(term, "//! A.\n", 1, "a term without");
        check_finds(term, "//! A.\nconst A: f64 = 0.7;\n", 2, "0.7 in a term");
        check_finds("crates/mesh/src/a.rs", "fn a() {}\n", 1, "begin the file");
        check_finds("crates/mesh/src/a.rs", "//! A.\nfn solve2() {}\n", 2, "replace the first version");
        check_finds("crates/io/src/a.rs", "//! A.\npub trait A {}\nkeys! {\n    pub struct A {}\n}\n", 4, "one name");
        check_finds("crates/io/src/a.rs", "//! A.\nstruct A;\ntype A = f64;\n", 3, "one name");
        check_finds("crates/mesh/src/part_kernel.rs", "//! A.\n", 1, "has no content");
        check_finds("crates/mesh/src/utils.rs", "//! A.\n", 1, "has no content");
        check_finds("crates/mesh/src/a.rs", "//! A. \n", 1, "white space");
        check_finds("crates/mesh/src/a.rs", "//! A.\nfn a() { todo!() }\n", 2, "todo!");
        check_finds("crates/mesh/tests/a.rs", &format!("//! A.\n#[{}]\n", "ignore"), 2, "no test is ignored");
        check_finds("crates/mesh/src/a.rs", &format!("//! A.\n//  {}/a/b\n", "/home"), 2, "one machine");
        check_finds("crates/mesh/src/a.rs", &format!("//! A.\n{}", "\n".repeat(600)), 601, "split the file");
        check_finds("crates/solver/src/a.rs", "//! A.\nfn a(b: &RigidBody<2>) {}\n", 2, "dyn body::Body");
        check_finds("crates/solver/src/a.rs", "//! A.\nfn a() { b[D * i] / dt }\n", 2, "row function");
        check_finds("crates/solver/src/a.rs", "//! A.\nfn a() { b / dt }\n", 2, "time scheme");
        check_finds("crates/solver/src/a.rs", "//! A.\nfn a() { b / step.time.length }\n", 2, "time scheme");
        check_finds("crates/solver/src/a.rs", "//! A.\nfn a() { Coordinates::Axisymmetric }\n", 2, "radial axis");
        check_finds("crates/solver/src/a.rs", "//! A.\npub trait FilmTerm {}\n", 2, "new kind of term");
        check_finds(term, "//! A.\npub struct Point {}\n", 2, "`Point` is no term");
        check_finds("crates/solver/src/a.rs", "//! A.\nuse faer::Mat;\n", 2, "must not be used in this file");
        check_finds("crates/solver/src/a.rs", "//! A.\nfn a<const D: usize>() where [(); D]: {}\n", 2, "where-clause");
        check_finds("crates/solver/src/a.rs", "//! A.\nfn a() { b::<2>() }\n", 2, "literal dimension");
        let long = format!("//! A.\npub fn advance() {{\n{}}}\n", "    a();\n".repeat(40));
        check_finds("crates/solver/src/step.rs", &long, 2, "`advance` has 42 lines");
    }

    #[test]
    fn forbidden_dependencies_are_found() {
        let dependency = |name: &str, kind: Value| json!({ "name": name, "kind": kind });
        let packages = vec![
            json!({ "name": "contact", "manifest_path": "crates/contact/Cargo.toml", "dependencies":
                [dependency("solid-svk", json!("dev")), dependency("fluid-ns", Value::Null)] }),
            json!({ "name": "algebra", "manifest_path": "crates/algebra/Cargo.toml", "dependencies":
                [dependency("faer", Value::Null), dependency("nalgebra", Value::Null)] }),
            json!({ "name": "other", "manifest_path": "crates/other/Cargo.toml", "dependencies": [] }),
        ];
        let tree = SourceTree { packages, ..SourceTree::default() };
        let of = |findings: Vec<Finding>| findings.into_iter().map(|f| f.advice).collect::<Vec<_>>().join("\n");
        let layers = of(layers::check(&tree));
        assert!(
            layers.contains("`contact` must not use `fluid-ns`") && !layers.contains("`contact` must not use `solid")
        );
        assert!(layers.contains("`other` is not in"));
        let advice = of(third_party::check(&tree));
        assert!(advice.contains("`algebra` must not depend on `nalgebra`") && !advice.contains("`faer`"), "{advice}");
    }
}

//! `cargo xtask tidy`: the shape that the documents promise, checked. Also a test of this crate.

mod dimensions;
mod equations;
mod hygiene;
mod layers;
mod source;
mod third_party;

use std::fs;
use std::io;
use std::path::PathBuf;

use serde_json::Value;

use crate::process::{Outcome, cargo, root};
use source::Source;

/// Flags of the task.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Write the generated pages of the book before checking.
    #[arg(long)]
    fix: bool,
}

/// A broken rule: where, and what to do.
#[derive(Debug)]
pub(crate) struct Finding {
    path: String,
    line: usize,
    advice: String,
}

impl Finding {
    fn new(path: &str, line: usize, advice: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line, advice: advice.into() }
    }
}

/// What the rules look at.
pub(crate) struct Workspace {
    root: PathBuf,
    /// Rust files of all packages.
    rust: Vec<Source>,
    /// Pages, scripts, manifests and scenarios.
    other: Vec<Source>,
    /// Packages as `cargo metadata` sees them.
    packages: Vec<Value>,
}

impl Workspace {
    /// Reads the workspace.
    ///
    /// # Errors
    /// A file cannot be read, or cargo fails.
    fn read() -> io::Result<Self> {
        let root = root();
        let metadata = cargo(&["metadata", "--format-version", "1", "--no-deps"]).output()?;
        if !metadata.status.success() {
            return Err(io::Error::other(String::from_utf8_lossy(&metadata.stderr).into_owned()));
        }
        let metadata: Value = serde_json::from_slice(&metadata.stdout)?;
        let packages = metadata["packages"].as_array().cloned().unwrap_or_default();
        let mut rust = Vec::new();
        let mut other = Vec::new();
        for folder in ["crates", "xtask", "benchmarks", "validation"] {
            rust.extend(source::read(&root, folder, &["rs"])?);
            other.extend(source::read(&root, folder, &["toml", "md", "py"])?);
        }
        other.extend(source::read(&root, "docs", &["md", "toml"])?);
        for file in ["Cargo.toml", "README.md", ".ci/run"] {
            if let Ok(text) = fs::read_to_string(root.join(file)) {
                other.push(Source::new(file, text));
            }
        }
        Ok(Self { root, rust, other, packages })
    }

    /// A file that is not Rust.
    fn page(&self, path: &str) -> Option<&Source> {
        self.other.iter().find(|source| source.path == path)
    }

    /// The line of a manifest that names a dependency.
    fn manifest_line(&self, manifest: &str, dependency: &str) -> usize {
        let Some(source) = self.page(manifest) else { return 1 };
        source.lines().find(|(_, line)| line.starts_with(dependency)).map_or(1, |(number, _)| number)
    }

    /// Name, path of the manifest, and dependencies (name, kind) of each package.
    fn manifests(&self) -> impl Iterator<Item = (&str, String, Vec<(&str, &str)>)> {
        self.packages.iter().map(|package| {
            let name = package["name"].as_str().unwrap_or_default();
            let path = PathBuf::from(package["manifest_path"].as_str().unwrap_or_default());
            let path = path.strip_prefix(&self.root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            let dependencies = package["dependencies"].as_array().map_or(&[][..], Vec::as_slice);
            let dependencies = dependencies
                .iter()
                .map(|d| (d["name"].as_str().unwrap_or_default(), d["kind"].as_str().unwrap_or("normal")))
                .collect();
            (name, path, dependencies)
        })
    }
}

/// All findings of all rules.
fn findings(workspace: &Workspace) -> Vec<Finding> {
    let rules = [layers::check, third_party::check, dimensions::check, equations::check, hygiene::check];
    let mut findings: Vec<Finding> = rules.iter().flat_map(|check| check(workspace)).collect();
    findings.sort_by(|a, b| (&a.path, a.line).cmp(&(&b.path, b.line)));
    findings
}

/// Writes the pages of the book that are made from the code.
///
/// # Errors
/// A file cannot be read or written.
pub(crate) fn write_generated_pages() -> io::Result<()> {
    let workspace = Workspace::read()?;
    let path = workspace.root.join(equations::PAGE);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, equations::page(&workspace))
}

/// Runs the task.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    if arguments.fix {
        write_generated_pages()?;
    }
    let workspace = Workspace::read()?;
    let findings = findings(&workspace);
    for Finding { path, line, advice } in &findings {
        println!("{path}:{line}: {advice}");
    }
    match findings.len() {
        0 => println!("tidy: {} Rust files, nothing to say", workspace.rust.len()),
        n => println!("tidy: {n} findings"),
    }
    Ok(findings.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_workspace_is_tidy() {
        let workspace = Workspace::read().expect("a workspace");
        let findings: Vec<String> =
            findings(&workspace).into_iter().map(|f| format!("{}:{}: {}", f.path, f.line, f.advice)).collect();
        assert!(findings.is_empty(), "\n{}", findings.join("\n"));
    }

    /// Checks that a file with that text is found guilty on that line.
    fn check_finds(path: &str, text: &str, line: usize, advice: &str) {
        let source = Source::new(path, text.to_owned());
        let workspace = Workspace { root: PathBuf::new(), rust: vec![source], other: Vec::new(), packages: Vec::new() };
        let findings = findings(&workspace);
        let found = findings.iter().any(|f| f.path == path && f.line == line && f.advice.contains(advice));
        assert!(found, "{path}: {text:?}: nothing about {advice:?} on line {line} in {findings:?}");
    }

    #[test]
    fn every_rule_bites() {
        let term = "crates/fluid-ns/src/terms/a.rs";
        check_finds(term, "//! A.\n", 1, "a term without");
        check_finds(term, "//! A.\nconst A: f64 = 0.7;\n", 2, "0.7 in a term");
        check_finds("crates/mesh/src/a.rs", "fn a() {}\n", 1, "begin the file");
        check_finds("crates/mesh/src/a.rs", "//! A.\nfn solve2() {}\n", 2, "replace the first one");
        check_finds("crates/mesh/src/utils.rs", "//! A.\n", 1, "says nothing");
        check_finds("crates/mesh/src/a.rs", "//! A. \n", 1, "white space");
        check_finds("crates/mesh/src/a.rs", "//! A.\nfn a() { todo!() }\n", 2, "todo!");
        check_finds("crates/mesh/tests/a.rs", &format!("//! A.\n#[{}]\n", "ignore"), 2, "no test is ignored");
        check_finds("crates/mesh/src/a.rs", &format!("//! A.\n//  {}/a/b\n", "/home"), 2, "one machine");
        check_finds("crates/mesh/src/a.rs", &format!("//! A.\n{}", "\n".repeat(600)), 601, "split the file");
        check_finds("crates/solver/src/a.rs", "//! A.\nuse faer::Mat;\n", 2, "outside of its room");
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
        let workspace = Workspace { root: PathBuf::new(), rust: Vec::new(), other: Vec::new(), packages };
        let of = |findings: Vec<Finding>| findings.into_iter().map(|f| f.advice).collect::<Vec<_>>().join("\n");
        let layers = of(layers::check(&workspace));
        assert!(
            layers.contains("`contact` must not use `fluid-ns`") && !layers.contains("`contact` must not use `solid")
        );
        assert!(layers.contains("`other` is not in"));
        let rooms = of(third_party::check(&workspace));
        assert!(rooms.contains("`algebra` must not depend on `nalgebra`") && !rooms.contains("`faer`"), "{rooms}");
    }
}

//! The files and packages that the rules check, and the findings.

use std::fs;
use std::io;
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

use super::source::{self, Source};
use crate::process::{cargo, root};

/// A violation of a rule, with its place and advice.
#[derive(Debug)]
pub(crate) struct Finding {
    pub(super) path: String,
    pub(super) line: usize,
    pub(super) advice: String,
}

impl Finding {
    pub(super) fn new(path: &str, line: usize, advice: impl Into<String>) -> Self {
        Self { path: path.to_owned(), line, advice: advice.into() }
    }
}

/// The files and packages of the workspace.
#[derive(Default)]
pub(crate) struct SourceTree {
    pub(super) root: PathBuf,
    /// Rust files of all packages.
    pub(super) rust: Vec<Source>,
    /// Pages, scripts, manifests and scenarios.
    pub(super) other: Vec<Source>,
    /// Packages in the format of `cargo metadata`.
    pub(super) packages: Vec<Value>,
    /// Files under version control with their sizes in bytes.
    pub(super) sizes: Vec<(String, usize)>,
}

impl SourceTree {
    /// Reads the tree.
    ///
    /// # Errors
    /// A file cannot be read, or cargo fails.
    pub(super) fn read() -> io::Result<Self> {
        let root = root();
        let metadata = cargo(&["metadata", "--format-version", "1", "--no-deps"]).output()?;
        if !metadata.status.success() {
            return Err(io::Error::other(String::from_utf8_lossy(&metadata.stderr).into_owned()));
        }
        let metadata: Value = serde_json::from_slice(&metadata.stdout)?;
        let packages = metadata["packages"].as_array().cloned().unwrap_or_default();
        let mut rust = Vec::new();
        let mut other = Vec::new();
        for folder in ["crates", "xtask", "benchmarks", "validation", "fuzz", "examples"] {
            rust.extend(source::read(&root, folder, &["rs"])?);
            other.extend(source::read(&root, folder, &["toml", "md", "py", "html", "js"])?);
        }
        other.extend(source::read(&root, "docs", &["md", "toml"])?);
        for file in ["Cargo.toml", "README.md", "CONTRIBUTING.md", "CHANGELOG.md", ".ci/run"] {
            if let Ok(text) = fs::read_to_string(root.join(file)) {
                other.push(Source::new(file, text));
            }
        }
        let listed = Command::new("git").args(["ls-files"]).current_dir(&root).output()?;
        let size = |path: &str| fs::metadata(root.join(path)).map_or(0, |file| file.len() as usize);
        let sizes = String::from_utf8_lossy(&listed.stdout).lines().map(|path| (path.to_owned(), size(path))).collect();
        Ok(Self { root, rust, other, packages, sizes })
    }

    /// Returns the page, script, manifest or scenario with a path.
    pub(super) fn page(&self, path: &str) -> Option<&Source> {
        self.other.iter().find(|source| source.path == path)
    }

    /// Returns the line of a manifest that names a dependency.
    pub(super) fn manifest_line(&self, manifest: &str, dependency: &str) -> usize {
        let Some(source) = self.page(manifest) else { return 1 };
        source.lines().find(|(_, line)| line.starts_with(dependency)).map_or(1, |(number, _)| number)
    }

    /// Returns the name, path of the manifest, and dependencies (name, kind) of each package.
    pub(super) fn manifests(&self) -> impl Iterator<Item = (&str, String, Vec<(&str, &str)>)> {
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

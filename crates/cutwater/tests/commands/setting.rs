//! Start of the binary, files, and printed text, for the tests of commands.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Returns the command that starts the binary.
pub(crate) fn command() -> Command {
    Command::new(env!("CARGO_BIN_EXE_cutwater"))
}

/// Runs the binary with arguments.
pub(crate) fn cutwater(arguments: &[&str]) -> Output {
    command().args(arguments).output().expect("the binary starts")
}

/// Checks that a command succeeded, and returns what it printed.
#[track_caller]
pub(crate) fn succeeded(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout)
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Returns the scenario of the virtual barrier.
pub(crate) fn case() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/cases/virtual-barrier.toml")
}

/// Returns a path in the folder of a group of tests. Nothing is there.
pub(crate) fn fresh(group: &str, name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(group);
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(name);
    let _ = std::fs::remove_dir_all(&path).or_else(|_| std::fs::remove_file(&path));
    path
}

/// Returns the path of a new file with a content.
pub(crate) fn file(group: &str, name: &str, content: &str) -> String {
    let path = fresh(group, name);
    std::fs::write(&path, content).expect("a file");
    path.display().to_string()
}

//! Python environments below the target folder.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::process::{succeeds, target};

/// Returns the interpreter of the environment `name` with the given packages. Creates the environment if necessary, and
/// returns `None` if that fails. `probe` is a Python statement that succeeds if the packages are installed.
pub(crate) fn python_with(name: &str, packages: &[&str], probe: &str) -> std::io::Result<Option<PathBuf>> {
    let environment = target().join(name);
    let python = environment.join("bin/python");
    let is_ready = |python: &Path| {
        let status = Command::new(python).args(["-c", probe]).stderr(Stdio::null()).status();
        status.is_ok_and(|s| s.success())
    };
    if is_ready(&python) {
        return Ok(Some(python));
    }
    let made = Command::new("python3").args(["-m", "venv"]).arg(&environment).status().is_ok_and(|s| s.success());
    let mut install = Command::new(&python);
    let installed = made && succeeds(install.args(["-m", "pip", "install", "--quiet"]).args(packages))?;
    Ok((installed && is_ready(&python)).then_some(python))
}

//! Processes, and the folders in which they run.

use std::io;
use std::path::PathBuf;
use std::process::Command;

/// Outcome of a task: whether it succeeded, or the error that prevented it.
pub(crate) type Outcome = io::Result<bool>;

/// Returns the folder of the workspace.
pub(crate) fn root() -> PathBuf {
    // Cargo sets the variable at run time; the fallback is the folder at compile time.
    let xtask = std::env::var_os("CARGO_MANIFEST_DIR").map_or(env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
    xtask.parent().map_or(xtask.clone(), PathBuf::from)
}

/// Returns the folder of builds and results.
pub(crate) fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Returns a command that runs cargo in the workspace, with the executable that started this process.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root()).args(arguments);
    command
}

/// Runs a process to its end and returns whether it succeeded.
///
/// # Errors
/// The process cannot be started.
pub(crate) fn succeeds(command: &mut Command) -> Outcome {
    let status = command.status().map_err(|error| {
        let program = command.get_program().to_string_lossy().into_owned();
        io::Error::new(error.kind(), format!("cannot start {program}: {error}"))
    })?;
    Ok(status.success())
}

//! Processes: where the workspace is, and how to start something in it.

use std::io;
use std::path::PathBuf;
use std::process::Command;

/// Outcome of a task: whether all is well, or why it could not be done.
pub(crate) type Outcome = io::Result<bool>;

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    // Cargo says where the package is; without it, the place where it was built.
    let xtask = std::env::var_os("CARGO_MANIFEST_DIR").map_or(env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
    xtask.parent().map_or(xtask.clone(), PathBuf::from)
}

/// Where builds and results go.
pub(crate) fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// The cargo that started us, in the workspace.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root()).args(arguments);
    command
}

/// Runs a process to its end and says whether it succeeded.
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

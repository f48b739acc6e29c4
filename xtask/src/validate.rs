//! `cargo xtask validate`: starts the `validation` binary.

use std::ffi::OsString;

use crate::process::{Outcome, cargo, succeeds};

/// Arguments of the `validation` binary.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Arguments {
    /// Cases and flags; `--help` lists them.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Runs the task.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let mut command = cargo(&["run", "--release", "--quiet", "--package", "validation", "--", "validate"]);
    succeeds(command.args(&arguments.arguments))
}

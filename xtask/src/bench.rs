//! `cargo xtask bench`: starts criterion.

use crate::process::{Outcome, cargo, succeeds};

/// Flags of the task.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Group to run: cut, assembly, linear or time_step; all if not given.
    group: Option<String>,
    /// Only benchmarks whose id contains this, such as `2d/h02`.
    filter: Option<String>,
}

/// Runs the task.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let mut command = cargo(&["bench", "--package", "benchmarks"]);
    match &arguments.group {
        Some(group) => command.args(["--bench", group]),
        None => command.arg("--benches"),
    };
    if let Some(filter) = &arguments.filter {
        command.args(["--", filter]);
    }
    succeeds(&mut command)
}

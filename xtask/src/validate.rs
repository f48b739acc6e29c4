//! `cargo xtask validate`: starts the `validation` binary.

use std::path::PathBuf;

use crate::process::{Outcome, cargo, succeeds};

/// Flags of the task.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Cases to run, by the names of their files in validation/reference; all if none is given.
    #[arg(value_name = "CASE")]
    cases: Vec<String>,
    /// Use coarse meshes and compare with stored values: a regression test, no validation.
    #[arg(long)]
    quick: bool,
    /// Run studies instead of cases, by the names of their files in validation/studies, or "all"; their results are
    /// written as docs/src/studies/NAME.md.
    #[arg(long, value_name = "NAME")]
    study: Vec<String>,
    /// Repeat runs of a study that are stored.
    #[arg(long, requires = "study")]
    again: bool,
    /// Folder of the results: DIR/CASE/summary.json and the files of the run.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs the task.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let mut command = cargo(&["run", "--release", "--quiet", "--package", "validation", "--", "validate"]);
    command.args(&arguments.cases);
    if arguments.quick {
        command.arg("--quick");
    }
    for study in &arguments.study {
        command.args(["--study", study]);
    }
    if arguments.again {
        command.arg("--again");
    }
    if let Some(out) = &arguments.out {
        command.arg("--out").arg(std::path::absolute(out)?);
    }
    succeeds(&mut command)
}

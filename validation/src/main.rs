//! The falling balls of the paper against its numbers, and the code against what is known exactly.
#![allow(clippy::print_stdout, clippy::print_stderr)] // talks on the terminal

mod bounds;
mod case;
mod compare;
mod metrics;
mod report;
mod study;
mod table;
mod validate;
mod verify;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Whether all is well, or why it could not be said.
type Outcome = Result<bool, Box<dyn std::error::Error>>;

#[derive(Parser)]
#[command(about, disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    mode: Mode,
}

#[derive(Subcommand)]
enum Mode {
    /// Run cases and compare with their references.
    Validate {
        /// Cases to run, by the names of their references; all if none is given.
        cases: Vec<String>,
        /// Coarse meshes, compared with our own stored values: regression, not validation.
        #[arg(long)]
        quick: bool,
        /// Store what --quick computes as the values that it will be compared with.
        #[arg(long, requires = "quick")]
        regenerate: bool,
        /// Run studies in the place of cases: the names of their files in studies/, or "all".
        #[arg(long, value_name = "NAME", conflicts_with_all = ["cases", "quick", "regenerate"])]
        study: Vec<String>,
        /// Do the runs of a study again that an earlier call has done.
        #[arg(long, requires = "study")]
        again: bool,
        /// Where results go.
        #[arg(long, default_value = "target/validation")]
        out: PathBuf,
    },
    /// Write the report page again from the results of earlier runs.
    Report {
        /// Cases to show; all with results if none is given.
        cases: Vec<String>,
        /// Say that the results are those of --quick.
        #[arg(long)]
        quick: bool,
        /// Where results are.
        #[arg(long, default_value = "target/validation")]
        out: PathBuf,
    },
    /// Compare with what is known exactly.
    Verify {
        /// What to verify; everything if nothing is given.
        names: Vec<String>,
        /// The short version; this is the default.
        #[arg(long, conflicts_with = "full")]
        quick: bool,
        /// The long version.
        #[arg(long)]
        full: bool,
        /// Store what is measured, and write the page docs/src/verification.md from all that is stored.
        #[arg(long)]
        document: bool,
        /// Where results go.
        #[arg(long, default_value = "target/verification")]
        out: PathBuf,
    },
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().mode {
        Mode::Validate { study, again, out, .. } if !study.is_empty() => studies(study, again, &out),
        Mode::Validate { cases, quick, regenerate, out, .. } => {
            let effort = match (quick, regenerate) {
                (false, _) => validate::Effort::Paper,
                (true, false) => validate::Effort::Quick,
                (true, true) => validate::Effort::Regenerate,
            };
            validate::run(&cases, effort, &out).and_then(|passes| report::write(&cases, quick, &out).map(|()| passes))
        }
        Mode::Report { cases, quick, out } => report::write(&cases, quick, &out).map(|()| true),
        Mode::Verify { names, quick: _, full, document, out } => {
            verify::run(&verify::Request { names: &names, full, document, out: &out })
        }
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            let mut cause = error.source();
            while let Some(inner) = cause {
                eprintln!("  because: {inner}");
                cause = inner.source();
            }
            ExitCode::from(2)
        }
    }
}

/// Runs studies and writes the report page with them.
fn studies(mut names: Vec<String>, again: bool, out: &Path) -> Outcome {
    if names == ["all"] {
        names = study::names()?;
    }
    let all_finished = study::run(&names, again, out)?;
    report::write(&[], false, out)?;
    Ok(all_finished)
}

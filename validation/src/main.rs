//! The falling balls of the paper compared with its numbers, and the code compared with exact solutions.
#![allow(clippy::print_stdout, clippy::print_stderr)] // prints to the terminal

mod bounds;
mod case;
mod chart;
mod compare;
mod figures;
mod metrics;
mod outcome;
mod report;
mod results;
mod stored;
mod study;
mod table;
mod units;
mod validate;
mod verify;
mod workers;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use self::outcome::Outcome;
use self::validate::Fineness;

#[derive(Parser)]
#[command(about, disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run cases and compare with their references.
    Validate {
        /// Cases to run, by the names of their references; all if none is given.
        cases: Vec<String>,
        /// Use coarse meshes and compare with stored values: a regression test, not a validation.
        #[arg(long)]
        quick: bool,
        /// Store the values of --quick for later comparisons.
        #[arg(long, requires = "quick")]
        regenerate: bool,
        /// Write the results into the book: docs/src/results/NAME.md.
        #[arg(long, conflicts_with = "quick")]
        document: bool,
        /// Run studies instead of cases: the names of their files in studies/, or "all".
        #[arg(long, value_name = "NAME", conflicts_with_all = ["cases", "quick", "regenerate", "document"])]
        study: Vec<String>,
        /// Repeat runs of a study whose results are there.
        #[arg(long, requires = "study")]
        again: bool,
        /// Compare with experiments instead of the paper: spheres that sink and bounce. With --quick on coarse cells.
        #[arg(long, conflicts_with_all = ["cases", "regenerate", "study"])]
        measured: bool,
        /// Folder of the results.
        #[arg(long, default_value = "target/validation")]
        out: PathBuf,
    },
    /// Compare with exact solutions and published numbers.
    Verify {
        /// Checks to run; all if none is given.
        names: Vec<String>,
        /// The short version; this is the default.
        #[arg(long, conflicts_with = "full")]
        quick: bool,
        /// The long version.
        #[arg(long)]
        full: bool,
        /// Write what was measured into the book: docs/src/verification/NAME.md, with charts.
        #[arg(long)]
        document: bool,
        /// Folder of the results.
        #[arg(long, default_value = "target/verification")]
        out: PathBuf,
    },
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Validate { study, again, out, .. } if !study.is_empty() => studies(study, again, &out),
        Command::Validate { measured: true, quick, document, out, .. } => {
            verify::run(&verify::MEASURED.map(str::to_owned), !quick, document, &out)
        }
        Command::Validate { cases, quick, regenerate, document, out, .. } => {
            let fineness = match quick {
                true => Fineness::Quick { regenerates: regenerate },
                false => Fineness::Paper { writes_pages: document },
            };
            validate::run(&cases, fineness, &out).and_then(|passes| report::write(&cases, quick, &out).map(|()| passes))
        }
        Command::Verify { names, quick: _, full, document, out } => verify::run(&names, full, document, &out),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            outcome::causes(error.as_ref()).for_each(|cause| eprintln!("  because: {cause}"));
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

//! The command line: arguments only.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod commands;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

/// Elastic bodies moving, deforming and colliding inside an incompressible fluid.
#[derive(Parser)]
#[command(version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scenario and write its results.
    Run(RunArguments),
    /// Check a scenario: read it, build its meshes, print sizes; run nothing.
    Check(ScenarioArguments),
}

/// A scenario file with changes.
#[derive(Args)]
struct ScenarioArguments {
    /// Scenario file.
    file: PathBuf,
    /// Change a value, such as time.step=5e-4 or body.0.density=2; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
}

#[derive(Args)]
struct RunArguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Directory for the results [default: output.directory of the scenario, else results/NAME].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    /// Print the time per stage at the end.
    #[arg(long)]
    timings: bool,
}

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Run(arguments) => commands::run::run(&arguments),
        Command::Check(arguments) => commands::check::check(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}", commands::explain(&error));
            commands::exit_code(&error)
        }
    }
}

//! Development tasks: `cargo xtask NAME`. Links none of the libraries, so that it builds in seconds.
#![allow(clippy::print_stdout, clippy::print_stderr)] // a command-line program

mod bench;
mod docs;
mod package;
mod process;
mod python;
mod same;
mod tidy;
mod validate;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Development tasks of the workspace", disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Run the cases of the paper and compare the results with its numbers.
    Validate(validate::Arguments),
    /// Compare with exact solutions, read output files back, run the long property suites.
    Verify(verify::Arguments),
    /// Run the benchmarks: cut, assembly, linear, time_step.
    Bench(bench::Arguments),
    /// Compare two folders of results column by column.
    Same(same::Arguments),
    /// Check structure and wording of the code.
    Tidy(tidy::Arguments),
    /// Build the API documentation, the generated pages and the book.
    Docs(docs::Arguments),
    /// Make the archives of all library crates, as they would be published.
    Package(package::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().task {
        Task::Validate(arguments) => validate::run(&arguments),
        Task::Verify(arguments) => verify::run(&arguments),
        Task::Bench(arguments) => bench::run(&arguments),
        Task::Same(arguments) => same::run(&arguments),
        Task::Tidy(arguments) => tidy::run(&arguments),
        Task::Docs(arguments) => docs::run(&arguments),
        Task::Package(arguments) => package::run(&arguments),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

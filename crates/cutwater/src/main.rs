//! Arguments of the command line.

mod commands;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};

use commands::Failure;

/// Exit codes, for the help.
const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    a step failed, a file could not be written, or runs differ by more than a tolerance
  2    the input or the arguments cannot be used; the message states file, line, key and remedy
  130  a run was stopped by Ctrl-C or SIGTERM, with a checkpoint";

/// Elastic bodies moving, deforming and colliding inside an incompressible fluid.
#[derive(Parser)]
#[command(version, about, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Write a commented scenario to start from.
    New(NewArguments),
    /// Run a scenario and write its results.
    Run(RunArguments),
    /// Resume a run that was stopped, from its last checkpoint; the same as `run --resume`.
    Resume(ResumeArguments),
    /// Print the largest differences between the columns of two runs.
    Compare(CompareArguments),
    /// Write a page with charts of columns of one or several runs.
    #[cfg(feature = "report")]
    Plot(PlotArguments),
    /// Check a scenario: read it, build its meshes, print sizes; run nothing.
    Check(ScenarioArguments),
    /// Write the page of a run again, or the run as a picture in motion.
    #[cfg(feature = "report")]
    Report(ReportArguments),
    /// Cut a mesh of tetrahedra by closed surfaces; print volumes, areas and how well identities hold.
    Cut(CutArguments),
    /// Print the JSON Schema of scenarios, by which editors complete and check them.
    Schema,
    /// Print what a mesh file contains, or convert it.
    #[command(subcommand)]
    Mesh(MeshCommand),
}

#[derive(Subcommand)]
enum MeshCommand {
    /// Print counts, sizes, quality and groups.
    Info {
        /// Mesh, .msh, .vtu or .vtk, or surface, .stl or .obj.
        file: PathBuf,
    },
    /// Write a mesh in another format, by the extension of the name: .msh, .vtu, or .stl for a surface.
    Convert(ConvertArguments),
}

#[derive(Args)]
struct ConvertArguments {
    /// Mesh, .msh, .vtu or .vtk, or surface, .stl or .obj.
    from: PathBuf,
    /// The new file.
    to: PathBuf,
    /// Version of a .msh file.
    #[arg(long, value_enum, default_value = "4.1")]
    version: MeshVersion,
    /// Write a .msh file in binary.
    #[arg(long)]
    binary: bool,
}

/// Versions of the format of Gmsh.
#[derive(Clone, Copy, ValueEnum)]
enum MeshVersion {
    /// Version 2.2
    #[value(name = "2.2")]
    V22,
    /// Version 4.1
    #[value(name = "4.1")]
    V41,
}

#[derive(Args)]
struct NewArguments {
    /// The file; its name without `.toml` becomes that of the scenario.
    file: PathBuf,
    /// Subject of the scenario.
    #[arg(long, value_enum, default_value = "fall")]
    template: Template,
}

/// Scenarios to start from.
#[derive(Clone, Copy, ValueEnum)]
enum Template {
    /// An elastic ball that falls through a liquid and rebounds from the ground.
    Fall,
    /// Flow through a channel past a cylinder with an elastic flag.
    Flow,
    /// An elastic ball that hits a rigid plane in space, without a fluid.
    Impact,
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
struct ResumeArguments {
    /// Directory of the run.
    directory: PathBuf,
    /// Change time.end or a value of output; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Print warnings and errors only.
    #[arg(short, long)]
    quiet: bool,
    /// Print every step, and at the end the time of each part of the work.
    #[arg(short, long, conflicts_with = "quiet")]
    verbose: bool,
    /// Do not write report.html.
    #[cfg(feature = "report")]
    #[arg(long)]
    no_report: bool,
}

impl From<ResumeArguments> for RunArguments {
    fn from(given: ResumeArguments) -> Self {
        Self {
            sets: given.sets,
            resume: Some(given.directory),
            quiet: given.quiet,
            verbose: given.verbose,
            #[cfg(feature = "report")]
            no_report: given.no_report,
            ..Self::default()
        }
    }
}

/// Reads a number that is zero or positive.
fn zero_or_positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| "it must be a number, zero or positive".to_owned())
}

#[derive(Args)]
struct CompareArguments {
    /// Directory of results.
    first: PathBuf,
    /// Another one, whose values are interpolated to the times of the first.
    second: PathBuf,
    /// Largest relative difference, above which the exit code is 1. The difference of a column is relative to its
    /// largest absolute value in either run; that of a column `lost_*` to the largest kinetic, elastic or stored
    /// energy, and that of a `force_remainder` to the largest force on the body, if these are larger.
    #[arg(long, value_parser = zero_or_positive)]
    tolerance: Option<f64>,
    /// Name of a column of history.csv, diagnostics.csv or probes.csv that is compared; may be repeated. If left out,
    /// all columns are compared but those with counts of work (newton, linear_iterations, factorizations, dofs) and
    /// seconds.
    #[arg(long = "column", value_name = "NAME")]
    columns: Vec<String>,
}

#[cfg(feature = "report")]
#[derive(Args)]
struct PlotArguments {
    /// Directories of results.
    #[arg(required = true)]
    directories: Vec<PathBuf>,
    /// Name of a column of history.csv, diagnostics.csv or probes.csv; may be repeated.
    #[arg(long = "column", value_name = "NAME", required = true)]
    columns: Vec<String>,
    /// The page.
    #[arg(long, value_name = "FILE", default_value = "plot.html")]
    out: PathBuf,
}

#[derive(Args, Default)]
struct RunArguments {
    /// Scenario file.
    #[arg(required_unless_present = "resume")]
    file: Option<PathBuf>,
    /// Change a value, such as time.step=5e-4 or body.0.density=2; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Directory for the results [default: output.directory of the scenario, else results/NAME].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Resume the run in this directory, from its last checkpoint; `--set` may change time.end and output.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["file", "out"])]
    resume: Option<PathBuf>,
    /// Replace files in the directory that are not those of this scenario.
    #[arg(long, conflicts_with = "resume")]
    overwrite: bool,
    /// Print warnings and errors only.
    #[arg(short, long)]
    quiet: bool,
    /// Print every step, and at the end the time of each part of the work.
    #[arg(short, long, conflicts_with = "quiet")]
    verbose: bool,
    /// Print at the end the time of each part of the work.
    #[arg(long)]
    timings: bool,
    /// Do not write report.html.
    #[cfg(feature = "report")]
    #[arg(long)]
    no_report: bool,
}

#[cfg(feature = "report")]
#[derive(Args)]
struct ReportArguments {
    /// Directory of results.
    directory: PathBuf,
    /// Write an animated PNG instead of the page.
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

#[derive(Args)]
struct CutArguments {
    /// Closed surfaces, .stl or .obj, one body each.
    #[arg(required = true, value_name = "SURFACE")]
    surfaces: Vec<PathBuf>,
    /// Put a box of N x N x N cubes, six tetrahedra each, around them.
    #[arg(long, value_name = "N", required_unless_present = "background", conflicts_with = "background")]
    grid: Option<usize>,
    /// Cut this mesh of tetrahedra, .vtu or .vtk.
    #[arg(long, value_name = "MESH")]
    background: Option<PathBuf>,
    /// Turn the surfaces about their centre, at random.
    #[arg(long, value_name = "SEED")]
    rotate: Option<u64>,
    /// Shift the surfaces by up to half a cell, at random.
    #[arg(long, value_name = "SEED")]
    shift: Option<u64>,
    /// Reverse surfaces that are oriented inwards.
    #[arg(long)]
    flip: bool,
    /// Directory for fluid.vtu, body.vtu and interface.vtu.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::New(arguments) => commands::new::new(&arguments).map_err(Failure::from),
        Command::Run(arguments) => commands::run::run(&arguments),
        Command::Resume(arguments) => commands::run::run(&arguments.into()),
        Command::Compare(arguments) => commands::compare::compare(&arguments).map_err(Failure::from),
        #[cfg(feature = "report")]
        Command::Plot(arguments) => commands::plot::plot(&arguments),
        Command::Check(arguments) => commands::check::check(&arguments).map_err(Failure::from),
        #[cfg(feature = "report")]
        Command::Report(arguments) => commands::report::report(&arguments),
        Command::Cut(arguments) => commands::cut::cut(&arguments).map_err(Failure::from),
        Command::Schema => commands::schema::schema().map_err(Failure::from),
        Command::Mesh(command) => commands::mesh::mesh(&command).map_err(Failure::from),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            commands::warn(&error.explain());
            error.exit_code()
        }
    }
}

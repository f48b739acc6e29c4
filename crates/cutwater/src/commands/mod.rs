//! The commands, and how their errors are shown.

pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod cut;
pub(crate) mod mesh;
pub(crate) mod new;
#[cfg(feature = "report")]
pub(crate) mod plot;
#[cfg(feature = "report")]
pub(crate) mod report;
pub(crate) mod run;
pub(crate) mod schema;

use std::fmt::Write as _;
use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use cutwater::io::scenario::expected_cells;
use cutwater::io::{Error, ScenarioFile};
use cutwater::solver;
use cutwater::solver::algebra::{LinearError, NewtonError};

/// Exit code of a run that was interrupted: the one that shells use for SIGINT, 128 + 2.
pub(crate) const INTERRUPTED: u8 = 130;

/// Prints a line to the standard output. A pipe that its reader has closed is not an error.
///
/// # Errors
/// [`Error::Write`]: the line cannot be written for another reason.
pub(crate) fn print(line: &str) -> Result<(), Error> {
    match writeln!(std::io::stdout(), "{line}") {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => {
            Err(Error::Write { path: PathBuf::from("standard output"), source })
        }
        _ => Ok(()),
    }
}

/// Prints a line of progress or of a summary. A write error is ignored, because results are in files.
pub(crate) fn print_or_ignore(line: &str) {
    _ = print(line);
}

/// Returns the line that is printed before meshes are built, with the number of cells of the background, and that of
/// the body with most cells if it is large.
pub(crate) fn building(file: &ScenarioFile) -> String {
    const LARGE: f64 = 1e5;
    let [of_background, of_body] = expected_cells(file);
    let of_background = of_background.map(|n| format!(", about {n:.1e} cells in the background"));
    let of_body = of_body.filter(|n| *n > LARGE).map(|n| format!(", about {n:.1e} cells in a body"));
    format!("building meshes and the first cut{}{}", of_background.unwrap_or_default(), of_body.unwrap_or_default())
}

/// Prints a line to the standard error, if it is open.
pub(crate) fn warn(line: &str) {
    _ = writeln!(std::io::stderr(), "{line}");
}

/// Properties of a run on which the advice after a failure depends.
#[derive(Clone, Copy, Default)]
pub(crate) struct RunProperties {
    /// Whether the run has contacts.
    pub(crate) has_contacts: bool,
    /// Whether steps have neither inertia nor a fluid.
    pub(crate) is_static: bool,
    /// Whether a contact between bodies has an offset of zero.
    pub(crate) touches_without_offset: bool,
}

/// Cause of the failure of a command.
pub(crate) enum Failure {
    /// Input that cannot be run, or a run that failed.
    Run {
        /// The error.
        error: Error,
        /// Properties of the run, on which the advice depends.
        properties: RunProperties,
    },
    /// The page of a run cannot be written.
    #[cfg(feature = "report")]
    Report(cutwater::report::Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Run { error, properties: RunProperties::default() }
    }
}

#[cfg(feature = "report")]
impl From<cutwater::report::Error> for Failure {
    fn from(error: cutwater::report::Error) -> Self {
        // Errors about the files of a run come from `io` and have its exit codes.
        if let cutwater::report::Error::Results(error) = error { Self::from(error) } else { Self::Report(error) }
    }
}

impl Failure {
    /// Returns the exit code: 2 for input that cannot be run, 1 for a run that failed, 130 for one that was
    /// interrupted.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::Run {
                error:
                    Error::Read { .. }
                    | Error::NotUtf8 { .. }
                    | Error::Scenario(_)
                    | Error::Surface { .. }
                    | Error::MeshFile { .. }
                    | Error::MeshOutput { .. }
                    | Error::Page { .. }
                    | Error::Grid(_)
                    | Error::Cut { .. }
                    | Error::GridSize { .. }
                    | Error::NoColumn { .. }
                    | Error::NoResults { .. }
                    | Error::Damaged { .. }
                    | Error::NothingCommon { .. }
                    | Error::OtherUnit { .. }
                    | Error::NotDirectory { .. }
                    | Error::Checkpoint { .. }
                    | Error::NoCheckpoint { .. }
                    | Error::Unfinished { .. }
                    | Error::Directory { .. }
                    | Error::Input { .. }
                    | Error::Busy { .. },
                ..
            } => ExitCode::from(2),
            Self::Run { error: Error::Interrupted { .. }, .. } => ExitCode::from(INTERRUPTED),
            _ => ExitCode::FAILURE,
        }
    }

    /// Returns the error with its causes, and the history of residuals if Newton's method failed.
    pub(crate) fn explain(&self) -> String {
        match self {
            Self::Run { error: Error::Step(step), properties } => chain(step) + &advice(step, *properties),
            Self::Run { error: error @ Error::Interrupted { .. }, .. } => error.to_string(),
            Self::Run { error, .. } => chain(error),
            #[cfg(feature = "report")]
            Self::Report(error) => chain(error),
        }
    }
}

/// Formats an error with its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let mut text = format!("error: {error}");
    let mut cause = error.source();
    while let Some(inner) = cause {
        // Some messages already contain their cause.
        let inner_text = inner.to_string();
        if !text.contains(&inner_text) {
            text += &format!("\n  because: {inner_text}");
        }
        cause = inner.source();
    }
    text
}

/// Advice for a body that encloses a negative volume in a step.
const COLLAPSED: &str = "\n  not the mesh is wrong: in this step the body collapsed, or its given motion turned it inside out. Take shorter steps, a load that rises over several \
                         steps, or a stiffer material; `cutwater check` compares pressures with the stiffness";

/// Returns the keys of the scenario that may help, and the history of residuals if Newton's method failed.
fn advice(step: &solver::StepError, properties: RunProperties) -> String {
    let newton = match &step.source {
        solver::Error::Newton(newton) => newton,
        solver::Error::Multipliers { contact, .. } => {
            return format!(
                "\n  the parameter is `law.gamma_contact_0`, the tolerance `law.tolerance`, of contact {contact}, from 0{}",
                at_edges(properties)
            );
        }
        solver::Error::Cut(cutcell::Error::Inward { .. } | cutcell::Error::InwardPart { .. }) => {
            return COLLAPSED.to_owned();
        }
        _ => return String::new(),
    };
    let mut text = String::new();
    let is_singular = |source: &LinearError| {
        matches!(
            source,
            LinearError::Singular { .. }
                | LinearError::EmptyRow { .. }
                | LinearError::EmptyColumn { .. }
                | LinearError::StructurallySingular { .. }
        )
    };
    if properties.is_static && matches!(newton, NewtonError::Linear { source, .. } if is_singular(source)) {
        text += "\n  with quasi-static steps and without a fluid, nothing but supports and contacts in action determines where a body is: \
                 hold it by `body.boundary` (elastic) or `body.motion.held` (rigid), or give contact an `offset` above the gap at the start; \
                 otherwise try a smaller `time.step`";
    } else if step.source.smaller_step_may_succeed() {
        text += "\n  a step that fails is halved up to `time.most_halvings` times; try a smaller `time.step`, or more \
                 `solver.newton.max_iterations`";
    }
    let report = newton.report();
    text += stagnation(&report.residual_history, properties.has_contacts);
    text += at_edges(properties);
    if !report.residual_history.is_empty() {
        text += "\n  iteration   relative residual   relative correction";
    }
    for (k, residual) in report.residual_history.iter().enumerate() {
        let correction = k.checked_sub(1).and_then(|k| report.correction_history.get(k));
        let correction = correction.map_or_else(|| "-".to_owned(), |c| format!("{c:.3e}"));
        // Writing to a string cannot fail.
        let _ = write!(text, "\n  {k:9}   {residual:17.3e}   {correction:>19}");
    }
    text
}

/// Returns the advice for bodies that touch without an offset.
fn at_edges(properties: RunProperties) -> &'static str {
    if properties.touches_without_offset {
        "\n  if edges or corners touch, give contact between bodies an `offset` of a tenth of its `size`: with an offset of zero a point behind an edge \
         may be pushed out through either side"
    } else {
        ""
    }
}

/// Returns the advice if the residuals no longer fall.
fn stagnation(residuals: &[f64], has_contacts: bool) -> &'static str {
    match (stagnates(residuals), has_contacts) {
        (false, _) => "",
        (true, false) => {
            "\n  the residuals no longer fall; if the last ones are near the rounding of numbers, give a larger `solver.newton.tolerance`"
        }
        (true, true) => {
            "\n  the residuals no longer fall; if bodies touch, contact opens and closes in turn: use cells of similar size, a larger `offset`, or \
             the penalty law, and of two bodies make the other one the slave (`body` and `obstacle` in place of `pair`); give walls that meet in a corner \
             contacts of their own"
        }
    }
}

/// Returns whether the last residual is more than half of the residual two iterations before, as in a cycle of two
/// states.
fn stagnates(residuals: &[f64]) -> bool {
    matches!(residuals, [.., before, _, last] if residuals.len() > 3 && *last > 0.5 * before)
}

#[cfg(test)]
mod tests {
    use super::{RunProperties, at_edges, stagnates, stagnation};

    #[test]
    fn edges_need_an_offset() {
        let advice = |touches_without_offset| {
            at_edges(RunProperties { has_contacts: true, is_static: false, touches_without_offset })
        };
        assert!(advice(true).contains("a tenth of its `size`") && advice(false).is_empty());
    }

    #[test]
    fn residuals_stagnate_at_one_value_or_between_two() {
        assert!(stagnates(&[1.0, 3e-3, 3.1e-3, 2.9e-3]) && stagnates(&[1.0, 2.0, 1e-2, 3e-5, 1e-2]));
        assert!(stagnation(&[1.0, 3e-3, 3.1e-3, 2.9e-3], true).contains("contact opens and closes"));
        let without = stagnation(&[1.0, 3e-3, 3.1e-3, 2.9e-3], false);
        assert!(without.contains("solver.newton.tolerance") && !without.contains("contact"), "{without}");
        assert!(stagnation(&[1.0, 0.1, 1e-2, 1e-3], true).is_empty());
        assert!(!stagnates(&[1.0, 0.1, 1e-2, 1e-3]) && !stagnates(&[1.0, 5.0, 2.0]) && !stagnates(&[]));
    }
}

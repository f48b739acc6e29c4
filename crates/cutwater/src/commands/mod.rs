//! The commands, and how their errors are told.

pub(crate) mod check;
pub(crate) mod cut;
pub(crate) mod run;

use std::error::Error as _;
use std::fmt::Write;
use std::process::ExitCode;

use cutwater::io::Error;
use cutwater::solver::Stage;

/// 2 for input that cannot be run, 1 for a run that failed.
pub(crate) fn exit_code(error: &Error) -> ExitCode {
    match error {
        Error::Read { .. } | Error::NotUtf8 { .. } | Error::Scenario(_) => ExitCode::from(2),
        Error::Surface { .. } | Error::MeshFile { .. } | Error::Grid(_) | Error::Cut { .. } => ExitCode::from(2),
        Error::GridSize { .. } => ExitCode::from(2),
        _ => ExitCode::FAILURE,
    }
}

/// An error with its causes, and the history of residuals if Newton's method failed.
pub(crate) fn explain(error: &Error) -> String {
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
    if let Error::Step(step) = error
        && let Stage::Newton(newton) = &step.source
    {
        if step.source.asks_for_a_smaller_step() {
            text += "\n  a step that fails is halved up to `time.most_halvings` times; try a smaller `time.step`, or more \
                     `solver.newton.max_iterations`";
        }
        let report = newton.report();
        text += "\n  iteration   relative residual   relative correction";
        for (k, residual) in report.residual_history.iter().enumerate() {
            let correction = k.checked_sub(1).and_then(|k| report.correction_history.get(k));
            let correction = correction.map_or_else(|| "-".to_owned(), |c| format!("{c:.3e}"));
            // Writing to a string cannot fail.
            let _ = write!(text, "\n  {k:9}   {residual:17.3e}   {correction:>19}");
        }
    }
    text
}

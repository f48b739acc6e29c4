//! Checks of single values that their types cannot express.

use super::problem::{Problem, ScenarioError};
use super::schema::{Background, Cip, ContactLaw, Linear, Material, Motion, Preconditioner, Shape, Size};
use super::{GivenFluidCondition, ScenarioFile};
use crate::scenario::schema::FluidCondition;

/// Largest relative distance of the end time from a multiple of the step.
const DIVIDES: f64 = 1e-9;

/// Checks ranges of numbers, the time step, names and what is not available yet.
pub(super) fn check(file: &ScenarioFile) -> Result<(), ScenarioError> {
    let scenario = file.scenario();
    match scenario.dimension {
        2 => {}
        3 => {
            let what = "dimension = 3";
            return Err(file.error("dimension", Problem::NotAvailable { what, instead: "use dimension = 2" }));
        }
        found => return Err(file.error("dimension", Problem::Dimension { found })),
    }
    for (path, value, must) in numbers(file) {
        let holds = match must {
            POSITIVE => value > 0.0,
            _ => value >= 0.0,
        };
        if !holds {
            return Err(file.error(&path, Problem::Range { value, must }));
        }
    }
    time(file)?;
    alpha(file)?;
    names(file)?;
    bodies(file)?;
    linear(file)?;
    if scenario.solver.newton.max_iterations == 0 {
        return Err(file.error("solver.newton.max_iterations", Problem::Range { value: 0.0, must: "at least 1" }));
    }
    if scenario.time.most_halvings > MOST_HALVINGS {
        let value = scenario.time.most_halvings as f64;
        return Err(file.error("time.most_halvings", Problem::Range { value, must: "at most 20" }));
    }
    if scenario.output.compression > 9 {
        let value = f64::from(scenario.output.compression);
        return Err(file.error("output.compression", Problem::Range { value, must: "from 0 to 9" }));
    }
    Ok(())
}

/// Values of the iterative solver that do not fit its preconditioner, or cannot be.
fn linear(file: &ScenarioFile) -> Result<(), ScenarioError> {
    let Linear::Gmres { preconditioner, restart, blocks } = &file.scenario().solver.linear else { return Ok(()) };
    let given = [("solver.linear.restart", restart.is_some()), ("solver.linear.blocks", blocks.is_some())];
    if let (Preconditioner::LaggedLu, Some((key, _))) = (preconditioner, given.iter().find(|(_, is_given)| *is_given)) {
        return Err(file.error(key, Problem::NoEffect { with: "preconditioner = \"lagged-lu\"" }));
    }
    if *restart == Some(0) {
        return Err(file.error("solver.linear.restart", Problem::Range { value: 0.0, must: "at least 1" }));
    }
    Ok(())
}

const POSITIVE: &str = "positive";
const NOT_NEGATIVE: &str = "zero or positive";

/// All numbers with a range, with their paths.
fn numbers(file: &ScenarioFile) -> Vec<(String, f64, &'static str)> {
    let scenario = file.scenario();
    let mut all = Vec::new();
    let mut push = |path: &str, value: f64, must| all.push((path.to_owned(), value, must));
    push("time.step", scenario.time.step, POSITIVE);
    push("time.end", scenario.time.end, POSITIVE);
    push("fluid.density", scenario.fluid.density, POSITIVE);
    push("fluid.viscosity", scenario.fluid.viscosity, POSITIVE);
    push("fluid.gamma_ghost", scenario.fluid.gamma_ghost, NOT_NEGATIVE);
    push("fluid.gamma_pressure", scenario.fluid.gamma_pressure, POSITIVE);
    match scenario.fluid.cip {
        Cip::Paper { gamma_1 } => push("fluid.cip.gamma_1", gamma_1, NOT_NEGATIVE),
        Cip::Consistent { gamma_u } => push("fluid.cip.gamma_u", gamma_u, NOT_NEGATIVE),
    }
    let Background::GradedBox(graded) = &scenario.background;
    match &graded.size {
        Size::Uniform(h) => push("background.size", *h, POSITIVE),
        Size::Graded(size) => {
            push("background.size.fine", size.fine, POSITIVE);
            push("background.size.coarse", size.coarse, POSITIVE);
        }
    }
    for (side, condition) in &graded.boundary {
        if let FluidCondition::Given(GivenFluidCondition::Inflow { ramp: Some(ramp), .. }) = condition {
            push(&format!("background.boundary.{side}.ramp"), *ramp, POSITIVE);
        }
    }
    for (k, body) in scenario.bodies.iter().enumerate() {
        let path = |key: &str| format!("body.{k}.{key}");
        body.density.iter().for_each(|density| push(&path("density"), *density, POSITIVE));
        match &body.shape {
            Shape::Ball { radius, size, .. } | Shape::HalfBall { radius, size, .. } => {
                push(&path("shape.radius"), *radius, POSITIVE);
                push(&path("shape.size"), *size, POSITIVE);
            }
            Shape::Box { size, .. } => size.iter().for_each(|h| push(&path("shape.size"), *h, POSITIVE)),
        }
    }
    push("interface.gamma_sigma", scenario.interface.gamma_sigma, POSITIVE);
    for (k, contact) in scenario.contacts.iter().enumerate() {
        let ContactLaw::Penalty { gamma_contact_0 } = contact.law;
        push(&format!("contact.{k}.law.gamma_contact_0"), gamma_contact_0, POSITIVE);
        push(&format!("contact.{k}.size"), contact.size, POSITIVE);
        push(&format!("contact.{k}.offset"), contact.offset, NOT_NEGATIVE);
    }
    push("solver.newton.tolerance", scenario.solver.newton.tolerance, POSITIVE);
    all
}

/// A step a million times smaller is no remedy.
const MOST_HALVINGS: usize = 20;

/// More steps than any run can take: a slip in the exponent of step or end.
const MAX_STEPS: f64 = 1e9;

/// The step must divide the end time.
fn time(file: &ScenarioFile) -> Result<(), ScenarioError> {
    let (step, end) = (file.scenario().time.step, file.scenario().time.end);
    let n = (end / step).round();
    if n > MAX_STEPS {
        return Err(file.error("time.step", Problem::TooManySteps { step, end, limit: MAX_STEPS }));
    }
    if n >= 1.0 && (n * step - end).abs() <= DIVIDES * end {
        return Ok(());
    }
    let step_below = end / (end / step).ceil();
    let end_below = step * (end / step).floor().max(1.0);
    Err(file.error("time.step", Problem::Indivisible { step, end, step_below, end_below }))
}

/// Only the fluid's traction crosses the interface.
fn alpha(file: &ScenarioFile) -> Result<(), ScenarioError> {
    let scenario = file.scenario();
    let alpha = scenario.interface.alpha;
    if alpha == 1.0 {
        return Ok(());
    }
    let stiffness = scenario.bodies.iter().map(|body| {
        let Some(Material::SaintVenantKirchhoff { mu, lambda, young, .. }) = body.material else { return 0.0 };
        mu.zip(lambda).map_or(young.unwrap_or_default(), |(mu, lambda)| 2.0 * mu + lambda)
    });
    let need = scenario.time.step * stiffness.fold(0.0, f64::max);
    let have = scenario.interface.gamma_sigma * scenario.fluid.viscosity;
    Err(file.error("interface.alpha", Problem::Alpha { alpha, have, need }))
}

/// Bodies have what they need, and nothing that they do not look at.
fn bodies(file: &ScenarioFile) -> Result<(), ScenarioError> {
    for (k, body) in file.scenario().bodies.iter().enumerate() {
        let given = [
            ("material", body.material.is_some()),
            ("density", body.density.is_some()),
            ("gravity", body.gravity.is_some()),
            ("time_scheme", body.time_scheme.is_some()),
            ("boundary", !body.boundary.is_empty()),
            ("initial_displacement", body.initial_displacement.is_some()),
            ("initial_velocity", body.initial_velocity.is_some()),
        ];
        let all = given.map(|(key, _)| key);
        // What is needed, what may be given, and what others have no effect with.
        let (needed, allowed, with): (&[&str], &[&str], _) = match &body.motion {
            None => (&["material", "density", "gravity"], &all, "an elastic body"),
            Some(Motion::Free { .. }) => {
                (&["density", "gravity"], &["density", "gravity", "initial_velocity"], "a body that does not deform")
            }
            Some(_) => (&[], &[], "a motion that is given"),
        };
        for (key, is_given) in given {
            if !is_given && needed.contains(&key) {
                return Err(file.missing(&format!("body.{k}"), key));
            }
            if is_given && !allowed.contains(&key) {
                return Err(file.error(&format!("body.{k}.{key}"), Problem::NoEffect { with }));
            }
        }
    }
    Ok(())
}

/// Names are unique and can be parts of file names.
fn names(file: &ScenarioFile) -> Result<(), ScenarioError> {
    let scenario = file.scenario();
    let refuse = |path: &str, name: &str, why| Err(file.error(path, Problem::Name { name: name.to_owned(), why }));
    let is_plain = |name: &str| !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || "-_.".contains(c));
    if !is_plain(&scenario.name) || scenario.name.starts_with('.') {
        return refuse("name", &scenario.name, "no file name: use letters, digits, -, _ and dots inside");
    }
    for (k, body) in scenario.bodies.iter().enumerate() {
        let path = format!("body.{k}.name");
        if !is_plain(&body.name) {
            return refuse(&path, &body.name, "no column name: use letters, digits, -, _ and dots");
        }
        if scenario.bodies[..k].iter().any(|other| other.name == body.name) {
            return refuse(&path, &body.name, "taken by another body; give each its own");
        }
    }
    Ok(())
}

//! From the words of a scenario to the types of the solver, with the one switch from run-time to const dimension.

use algebra::NewtonSettings;
use cutcell::OverlayOptions;
use mesh::{BodyId, Vector};
use solver::{Body, Setup};

use super::bodies::{body, contact};
use super::fluid::{background, fluid};
use super::placement::{check_placement, respect_symmetry};
use super::problem::{Problem, ScenarioError, nearest};
use super::schema::{Background, FluidCondition};
use super::{PlainFluidCondition, ScenarioFile};

/// A scenario ready to run.
pub struct Case<const D: usize> {
    /// The problem.
    pub setup: Setup<D>,
    /// Number of steps.
    pub n_steps: usize,
    /// Whether a side of the background is a plane of symmetry: forces, masses and energies are those of a half.
    pub half_domain: bool,
    /// Lowest last coordinate of the background.
    pub bottom: f64,
}

/// Something to be done with a case of either dimension.
pub trait CaseVisitor {
    /// What comes out.
    type Output;

    /// Does it.
    fn visit<const D: usize>(self, case: Case<D>) -> Self::Output;
}

/// Lowers a scenario and hands the case to a visitor.
///
/// # Errors
/// [`ScenarioError`]: names that do not exist, meshes that cannot be made, bodies that overlap or lie outside.
pub fn lower<V: CaseVisitor>(file: &ScenarioFile, visitor: V) -> Result<V::Output, ScenarioError> {
    match file.scenario().dimension {
        2 => Ok(visitor.visit(case::<2>(file)?)),
        found => Err(file.error("dimension", Problem::Dimension { found })),
    }
}

/// The case of a scenario in dimension `D`.
///
/// # Errors
/// As [`lower`].
pub fn case<const D: usize>(file: &ScenarioFile) -> Result<Case<D>, ScenarioError> {
    let scenario = file.scenario();
    let background = background::<D>(file)?;
    let bodies =
        (0..scenario.bodies.len()).map(|k| body::<D>(file, k)).collect::<Result<Vec<Body<D>>, ScenarioError>>()?;
    let contacts =
        (0..scenario.contacts.len()).map(|k| contact(file, k, &bodies)).collect::<Result<Vec<_>, ScenarioError>>()?;
    let Background::GradedBox(graded) = &scenario.background;
    let symmetry = FluidCondition::Plain(PlainFluidCondition::Symmetry);
    let newton = &scenario.solver.newton;
    let mut setup = Setup {
        fluid: fluid(file, &background)?,
        background,
        bodies,
        contacts,
        gamma_sigma: scenario.interface.gamma_sigma,
        dt: scenario.time.step,
        most_halvings: scenario.time.most_halvings,
        newton: NewtonSettings { max_iterations: newton.max_iterations, ..NewtonSettings::new(newton.tolerance) },
        // The surfaces are those of meshes; in a run a body may come to fold onto itself.
        overlay: OverlayOptions::new().without_self_intersection_check(),
    };
    check_placement(file, &setup)?;
    respect_symmetry(file, &mut setup)?;
    Ok(Case {
        n_steps: file.n_steps(),
        half_domain: graded.boundary.values().any(|condition| *condition == symmetry),
        bottom: setup.background.vertices().iter().map(|x| x[D - 1]).fold(f64::INFINITY, f64::min),
        setup,
    })
}

/// A vector of the right length.
pub(super) fn vector<const D: usize>(
    file: &ScenarioFile,
    path: &str,
    values: &[f64],
) -> Result<Vector<D>, ScenarioError> {
    if values.len() == D {
        return Ok(Vector::from_column_slice(values));
    }
    Err(file.error(path, Problem::Components { found: values.len(), dimension: D }))
}

/// An error about a name that nothing has.
pub(super) fn unknown_name(
    file: &ScenarioFile,
    path: &str,
    what: &'static str,
    name: &str,
    known: &[String],
) -> ScenarioError {
    let nearest = nearest(name, known.iter().map(String::as_str));
    file.error(path, Problem::UnknownName { what, name: name.to_owned(), nearest, known: known.to_vec() })
}

/// Axis normal to the side of that name.
pub(super) fn side_axis<const D: usize>(name: &str) -> Option<usize> {
    match name {
        "left" | "right" => Some(0),
        "front" | "back" if D == 3 => Some(1),
        "bottom" | "top" => Some(D - 1),
        _ => None,
    }
}

/// The body of that name.
pub(super) fn body_id<const D: usize>(
    file: &ScenarioFile,
    path: &str,
    name: &str,
    bodies: &[Body<D>],
) -> Result<BodyId, ScenarioError> {
    bodies.iter().position(|body| body.name == name).map(BodyId::new).ok_or_else(|| {
        let known: Vec<String> = bodies.iter().map(|body| body.name.clone()).collect();
        unknown_name(file, path, "body", name, &known)
    })
}

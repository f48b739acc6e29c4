//! Builds the problem of dimension 2 or 3 from the values of a scenario.

use std::collections::BTreeSet;

use algebra::Workspace;
use mesh::Aabb;
use solver::{ApproachSteps, Setup};

use super::background::expected;
use super::balance::check_balance;
use super::body::body;
use super::contact::ContactBuilder;
use super::error::ScenarioError;
use super::file::{Scenario, ScenarioFile};
use super::fluid::fluid;
use super::geometry;
use super::key::{Quantity, missing};
use super::placement::{check_contacts, check_placement, check_repeated, check_surfaces};
use super::probe::{ProbeChoice, probes};
use super::symmetry::{check_axis, respect_symmetry, symmetry_planes};
use super::table::At;
use crate::history::{columns, name_and_unit};
use crate::probes::Probes;
use crate::summary::UnitLabels;

/// A scenario ready to run.
pub struct Case<const D: usize> {
    /// The problem.
    pub setup: Setup<D>,
    /// Workspace of the time steps, with the linear solver.
    pub workspace: Workspace,
    /// Name of the linear solver, and the reason for it.
    pub linear: String,
    /// Number of steps.
    pub n_steps: usize,
    /// Steps between two checkpoints; 0 for none.
    pub checkpoint_every: usize,
    /// Whether a body stands on a plane of symmetry. Forces, masses and energies are then those of one half.
    pub half_domain: bool,
    /// Smallest last coordinate of the background; zero without a fluid.
    pub bottom: f64,
    /// Probes of the output.
    pub probes: Probes<D>,
}

/// Operation on a case of either dimension.
pub trait CaseVisitor {
    /// Result.
    type Output;

    /// Carries out the operation.
    fn visit<const D: usize>(self, case: Case<D>) -> Self::Output;
}

/// Builds the case of a scenario and passes it to a visitor.
///
/// # Errors
/// [`ScenarioError`]: names that do not exist, meshes that cannot be generated, bodies that overlap or lie outside.
pub fn lower<V: CaseVisitor>(file: &ScenarioFile, visitor: V) -> Result<V::Output, ScenarioError> {
    match file.scenario().dimension {
        2 => Ok(visitor.visit(case::<2>(file)?)),
        _ => Ok(visitor.visit(case::<3>(file)?)),
    }
}

/// Estimates the numbers of cells without a mesh: those of the background, and those of the body that has most of them.
/// `None` where there is none, or its mesh is read from a file.
pub fn expected_cells(file: &ScenarioFile) -> [Option<f64>; 2] {
    fn of<const D: usize>(scenario: &Scenario) -> [Option<f64>; 2] {
        let bodies = scenario.bodies();
        let of_bodies = bodies.iter().filter_map(|given| Some(geometry::expected_cells::<D>(&given.shape)?.0));
        [
            scenario.background.as_ref().and_then(|background| expected::<D>(background, &bodies)),
            of_bodies.reduce(f64::max),
        ]
    }
    match file.scenario().dimension {
        2 => of::<2>(file.scenario()),
        _ => of::<3>(file.scenario()),
    }
}

/// Builds the case of a scenario in dimension `D`.
///
/// # Errors
/// As [`lower`]; the scenario has another dimension.
pub fn case<const D: usize>(file: &ScenarioFile) -> Result<Case<D>, ScenarioError> {
    let scenario = file.scenario();
    let root = file.location();
    if scenario.dimension != D {
        return Err(root.invalid(format!("the scenario has dimension {}, not {D}", scenario.dimension)));
    }
    let time = &scenario.time;
    let coordinates = scenario.coordinates()?;
    let absent = |key| missing(&root, Scenario::KEYS, key);
    let given = scenario.bodies();
    let fluid = match (&scenario.fluid, &scenario.background) {
        (Some(fluid_keys), Some(background)) => {
            let alpha = *scenario.interface.alpha;
            Some(fluid::<D>(fluid_keys, alpha, coordinates, background, &given, [0.0, time.end])?)
        }
        (Some(_), None) => return Err(absent("background")),
        (None, None) if scenario.body.is_empty() => {
            return Err(root.invalid("the scenario has neither a fluid nor a body; add [fluid] or [[body]]"));
        }
        (None, None) => None,
        (None, Some(_)) => return Err(absent("fluid")),
    };
    let mut built = given.iter().map(|given| body::<D>(given, time, coordinates)).collect::<Result<Vec<_>, _>>()?;
    if let Some(fluid) = &fluid {
        respect_symmetry(&scenario.contact, &given, fluid, &mut built)?;
    }
    let (mut contacts, mut of_contacts) = (Vec::new(), Vec::new());
    let builder = ContactBuilder::new(&built, fluid.as_ref(), time.end);
    for given in &scenario.contact {
        contacts.extend(builder.contacts(given)?);
        of_contacts.resize(contacts.len(), given);
    }
    let part_names: Vec<Vec<String>> = built.iter().map(|built| built.part_names.clone()).collect();
    let bodies = built.into_iter().map(|built| built.body).collect();
    let setup = Setup {
        fluid,
        bodies,
        contacts,
        scheme: time.scheme()?,
        dt: *time.step,
        most_halvings: time.most_halvings,
        approach: time.approach.as_ref().map(|of| ApproachSteps { fraction: of.fraction, smallest: *of.smallest }),
        newton: scenario.solver.newton.settings(),
    };
    let starts: Vec<_> = setup.bodies.iter().map(|body| body.initial()).collect();
    let positions = setup.positions(&starts);
    check_surfaces(&given, &setup, &positions)?;
    let mut bottom = 0.0;
    if let Some(fluid) = &setup.fluid {
        check_placement(&given, &setup, fluid, &positions)?;
        bottom = Aabb::of_points(fluid.background.vertices()).low[D - 1];
    }
    let half_domain = setup.fluid.as_ref().map(symmetry_planes).is_some_and(|mut planes| {
        planes.retain(|plane| coordinates.radial().is_none_or(|radial| plane.normal[radial] != 1.0));
        positions.iter().flatten().any(|x| planes.iter().any(|plane| plane.is_on_side(x)))
    });
    check_repeated(&of_contacts, &setup)?;
    check_contacts(&of_contacts, &setup, &positions, scenario.units.label(Quantity::LENGTH))?;
    if let (Some(fluid), Some(background)) = (&setup.fluid, &scenario.background) {
        check_axis(fluid, background)?;
    }
    check_balance(scenario, &given, &part_names, &setup, &positions)?;
    let probes = probes(&scenario.output.probes, &setup, &part_names, &scenario.units, scenario.dimension_of_whole())?;
    check_columns(file, &setup, &probes)?;
    let n_vertices = setup.fluid.as_ref().map(|fluid| fluid.background.n_vertices());
    let (linear, reason) = scenario.solver.linear(D, n_vertices.map_or(0, |n| (D + 1) * n));
    Ok(Case {
        workspace: linear.workspace(),
        linear: format!("{} ({reason})", linear.name()),
        n_steps: time.n_steps(),
        checkpoint_every: scenario.output.checkpoint_interval(),
        half_domain,
        bottom,
        probes,
        setup,
    })
}

/// Checks that no two columns of the tables of results have one name.
fn check_columns<const D: usize>(
    file: &ScenarioFile,
    setup: &Setup<D>,
    probes: &Probes<D>,
) -> Result<(), ScenarioError> {
    let scenario = file.scenario();
    let of_tables = columns(setup, &UnitLabels::new(&scenario.units, scenario.dimension_of_whole()));
    let mut names = BTreeSet::new();
    for column in of_tables.iter().map(String::as_str).chain(probes.names()) {
        let name = name_and_unit(column).0;
        if !names.insert(name) {
            let is_of = |(probe, _): &&(String, At<ProbeChoice>)| name.starts_with(&format!("{probe}_"));
            let probe = scenario.output.probes.0.iter().filter(is_of).max_by_key(|(probe, _)| probe.len());
            return Err(probe.map_or_else(|| file.location(), |(_, probe)| probe.at.clone()).invalid(format!(
                "two columns of the results would have the name `{name}`; give the probe, or one of the bodies, another name"
            )));
        }
    }
    Ok(())
}

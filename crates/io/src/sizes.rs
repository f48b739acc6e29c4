//! Summary of a scenario: sizes of its meshes, conditions and methods.

use std::sync::Arc;

use mesh::{Aabb, BodyId, Placed, Point, Vector};
use solver::body::{Body, BodyState};
use solver::{Contact, Setup, State, Step, StepError};

use crate::Error;
use crate::pressures::pressures;
use crate::scenario::{
    At, Background, BodyKeys, Case, CaseVisitor, Choose as _, ContactKeys, Quantity, Scenario, ScenarioFile, lower,
    rounded,
};
use crate::warnings::warnings;

/// Sizes of the problem of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizes {
    /// Cells of the background.
    pub background_cells: usize,
    /// Vertices of the background.
    pub background_vertices: usize,
    /// Extents of the background along the axes; empty without a fluid.
    pub background_extents: Vec<f64>,
    /// Name, number of cells and number of vertices of each body. Bodies that do not deform have no cells.
    pub bodies: Vec<(String, usize, usize)>,
    /// Extents of each body along the axes at the start.
    pub body_extents: Vec<Vec<f64>>,
    /// Roles in each contact, as sentences.
    pub contacts: Vec<String>,
    /// Mass, weight and buoyancy of each body with a mass, as sentences.
    pub weights: Vec<String>,
    /// Pressures of the sides of the background with a traction, as sentences.
    pub pressures: Vec<String>,
    /// Warnings about choices that are allowed but mostly mistakes, as sentences.
    pub warnings: Vec<String>,
    /// Cut cells at the start.
    pub cut_cells: usize,
    /// Unknowns of the first step.
    pub dofs: usize,
    /// Number of steps.
    pub n_steps: usize,
    /// Whether half of a symmetric problem is solved.
    pub half_domain: bool,
    /// Name of the linear solver, and the reason for it.
    pub linear: String,
    /// The summary as lines: sizes, conditions and methods, also the methods that the program has chosen.
    pub lines: Vec<String>,
}

/// Builds the meshes of a scenario and the first cut, and runs nothing.
///
/// # Errors
/// [`Error::Scenario`], [`Error::Step`].
pub fn sizes(file: &ScenarioFile) -> Result<Sizes, Error> {
    struct Measure<'f>(&'f Scenario);
    impl CaseVisitor for Measure<'_> {
        type Output = Result<Sizes, Error>;
        fn visit<const D: usize>(self, case: Case<D>) -> Result<Sizes, Error> {
            Sizes::new(self.0, &case, &State::initial(&case.setup)?)
        }
    }
    lower(file, Measure(file.scenario()))?
}

impl Sizes {
    /// Measures a case in the step that follows a state.
    pub(crate) fn new<const D: usize>(scenario: &Scenario, case: &Case<D>, state: &State<D>) -> Result<Self, Error> {
        let setup = &case.setup;
        let size = |body: &Arc<dyn Body<D>>, state: &BodyState<D>| {
            let cells = body.cells(state).map_or(0, |cells| cells.stress.len());
            (body.name().to_owned(), cells, body.reference().len())
        };
        let background = setup.fluid.as_ref().map(|fluid| &fluid.background);
        let step = Step::prepare(setup, state, state.step_time(setup, setup.dt))
            .map_err(|error| StepError::at(state.step + 1, state.time + setup.dt, error))?;
        let positions = setup.positions(&state.bodies);
        let extents = |points: &[Point<D>]| Aabb::of_points(points).extent().iter().copied().collect();
        let mut sizes = Self {
            background_extents: background.map_or(Vec::new(), |mesh| extents(mesh.vertices())),
            body_extents: positions.iter().map(|points| extents(points)).collect(),
            contacts: roles(setup),
            weights: weights(scenario, setup, state),
            pressures: pressures(scenario, case),
            warnings: warnings(scenario, case, state),
            background_cells: background.map_or(0, |mesh| mesh.n_cells()),
            background_vertices: background.map_or(0, |mesh| mesh.n_vertices()),
            bodies: setup.bodies.iter().zip(&state.bodies).map(|(body, state)| size(body, state)).collect(),
            cut_cells: state.fluid.as_ref().map_or(0, |fluid| fluid.cut.report().n_cut_cells),
            dofs: step.layout.len(),
            n_steps: case.n_steps,
            half_domain: case.half_domain,
            linear: case.linear.clone(),
            lines: Vec::new(),
        };
        sizes.lines = sizes.understood(scenario);
        Ok(sizes)
    }

    /// Describes the scenario, a line for each part.
    fn understood(&self, scenario: &Scenario) -> Vec<String> {
        let unit = |quantity| scenario.units.label(quantity);
        let (length, mass, time) = (unit(Quantity::LENGTH), unit(Quantity::MASS), unit(Quantity::TIME));
        let half = if self.half_domain { ", half of a symmetric problem" } else { "" };
        let coordinates = scenario.coordinates.as_ref().map_or("", |coordinates| coordinates.word());
        let coordinates = if coordinates.is_empty() { String::new() } else { format!(", {coordinates}") };
        let mut lines = vec![format!(
            "{}: dimension {}{coordinates}, units {length}, {mass}, {time}{half}",
            *scenario.name, scenario.dimension
        )];
        if let (Some(fluid), Some(background)) = (&scenario.fluid, &scenario.background) {
            lines.push(format!(
                "fluid: density {} {}, viscosity {} {}, convection {}, stabilisation {}",
                fluid.density,
                unit(Quantity::DENSITY),
                fluid.viscosity,
                unit(Quantity::VISCOSITY),
                fluid.convection.word(),
                fluid.stabilisation_name(),
            ));
            lines.push(format!(
                "background: {} {length}, {} cells, {} vertices, {} cells cut at the start; {}",
                product(&self.background_extents),
                self.background_cells,
                self.background_vertices,
                self.cut_cells,
                conditions(background),
            ));
        }
        let bodies = scenario.bodies();
        let sizes = self.bodies.iter().zip(&self.body_extents);
        lines.extend(sizes.zip(&bodies).map(|(((name, cells, vertices), extents), given)| {
            let (motion, extents) = (motion(given), product(extents));
            match cells {
                0 => format!("body {name}: {motion}, {extents} {length}, {vertices} vertices on its surface"),
                _ => {
                    let supports = supports(given);
                    let is_quadratic = given.order.as_deref().is_some_and(|order| *order > 1);
                    let each = if is_quadratic {
                        format!(" ({} in each element)", 1 << scenario.dimension)
                    } else {
                        String::new()
                    };
                    format!(
                        "body {name}: {motion}, {extents} {length}, {cells} cells{each}, {vertices} vertices{supports}"
                    )
                }
            }
        }));
        lines.extend_from_slice(&self.weights);
        lines.extend_from_slice(&self.pressures);
        lines.extend(scenario.contact.iter().map(|contact| contact_line(contact, &length)));
        lines.extend_from_slice(&self.contacts);
        lines.extend_from_slice(&self.warnings);
        let scheme = scenario.time.scheme.word();
        lines.push(format!(
            "steps: {} of {} {time}, to {} {time}; {scheme}; a step that fails is halved up to {} times",
            self.n_steps, *scenario.time.step, scenario.time.end, scenario.time.most_halvings,
        ));
        lines.push(format!("unknowns in the first step: {}", self.dofs));
        lines.push(format!("linear solver: {}", self.linear));
        let newton = &scenario.solver.newton;
        lines.push(format!(
            "Newton's method: relative tolerance {:e}, at most {} corrections per solve",
            newton.tolerance, newton.max_iterations
        ));
        let every = |n: usize| match n {
            0 => "none".to_owned(),
            1 => "after every step".to_owned(),
            n => format!("after every {n} steps"),
        };
        let minutes = scenario.output.checkpoint_minutes.filter(|minutes| *minutes > 0.0);
        let minutes = minutes.map_or(String::new(), |minutes| format!(", {minutes} minutes or more apart"));
        lines.push(format!(
            "fields in files: {}; checkpoints: {}{minutes}",
            every(scenario.output.vtk_every),
            every(scenario.output.checkpoint_interval())
        ));
        lines
    }
}

/// Returns extents as a product, with four significant digits.
fn product(extents: &[f64]) -> String {
    extents.iter().map(|extent| format!("{:?}", rounded(*extent))).collect::<Vec<_>>().join(" x ")
}

/// Describes mass, weight and buoyancy of the bodies at a state. The buoyancy is the body force of the fluid at the
/// centre of mass times the volume of the elements of an elastic body, or inside the surface of another one. Forces
/// that differ at the end of the run are given for this time, too.
fn weights<const D: usize>(scenario: &Scenario, setup: &Setup<D>, state: &State<D>) -> Vec<String> {
    let unit = |quantity| scenario.units.total_label(quantity, scenario.dimension_of_whole());
    let (mass, force) = (unit(Quantity::MASS), unit(Quantity::FORCE));
    let vector = |of: Vector<D>| of.iter().map(|component| rounded(*component)).collect::<Vec<_>>();
    let forces = |of: &dyn Fn(f64) -> Vector<D>| {
        let [start, end] = [state.time, scenario.time.end].map(|time| vector(of(time)));
        if start == end {
            return format!("{start:?} {force}");
        }
        let time = scenario.units.label(Quantity::TIME);
        let [from, to] = [state.time, scenario.time.end].map(rounded);
        format!("{start:?} {force} at t = {from} {time} and {end:?} {force} at t = {to} {time}")
    };
    let of_body = |(body, of): (&Arc<dyn Body<D>>, &BodyState<D>)| {
        let balance = body.balance(of)?;
        let positions = of.positions(body.reference());
        let inside = || Placed::new(body.surface(), &positions).enclosed().volume;
        let displaced = if body.deforms() { balance.volume } else { inside() };
        let buoyancy = match setup.fluid.as_ref().map(|fluid| fluid.body_force.as_ref()) {
            Some(Some(density)) => {
                let on_body = |time| -density(&balance.centre_of_mass, time) * displaced;
                format!(", buoyancy {}", forces(&on_body))
            }
            Some(None) => ", no buoyancy: the fluid has no `body_force`".to_owned(),
            None => String::new(),
        };
        let weight = forces(&|time| balance.body_force + body.variable_gravity(time) * balance.mass);
        Some(format!("body {}: mass {:e} {mass}, weight {weight}{buoyancy}", body.name(), rounded(balance.mass)))
    };
    shortened(setup.bodies.iter().zip(&state.bodies).filter_map(of_body).collect(), "weights")
}

/// Largest number of pairs without contact that are named.
const MOST_PARTS: usize = 6;
/// Largest number of lines about roles in contacts, and of lines about weights.
const MOST_LINES: usize = 20;

/// Describes the roles in each contact.
fn roles<const D: usize>(setup: &Setup<D>) -> Vec<String> {
    let name = |body: BodyId| setup.bodies[body.index()].name();
    let pair = |contact: &Contact<D>| {
        let master = contact.master().filter(|master| *master != contact.body())?;
        Some(format!("contact pair: slave {}, master {}", name(contact.body()), name(master)))
    };
    let mut lines = shortened(setup.contacts.iter().filter_map(pair).collect(), "contact pairs");
    lines.extend(without_contact(setup));
    lines
}

/// Describes which bodies pass through each other, and through the sides of the background, since no contact holds them
/// apart. Returns `None` if there are none.
fn without_contact<const D: usize>(setup: &Setup<D>) -> Option<String> {
    let bodies = &setup.bodies;
    let touch = |a: usize, b: Option<usize>| {
        let sides = |contact: &Contact<D>| (contact.body().index(), contact.master().map(BodyId::index));
        setup
            .contacts
            .iter()
            .map(sides)
            .any(|(slave, master)| (slave == a && master == b) || (b == Some(slave) && master == Some(a)))
    };
    let pairs = (0..bodies.len()).flat_map(|a| (a + 1..bodies.len()).map(move |b| (a, b)));
    let apart = pairs.filter(|&(a, b)| (bodies[a].is_movable() || bodies[b].is_movable()) && !touch(a, Some(b)));
    let mut parts: Vec<_> = apart.map(|(a, b)| format!("{} and {}", bodies[a].name(), bodies[b].name())).collect();
    if setup.fluid.is_some() {
        let movable = (0..bodies.len()).filter(|&a| bodies[a].is_movable() && !touch(a, None));
        parts.extend(movable.map(|a| format!("{} and the sides", bodies[a].name())));
    }
    let n_more = parts.len().saturating_sub(MOST_PARTS);
    parts.truncate(MOST_PARTS);
    let more = if n_more > 0 { format!(", and {n_more} more") } else { String::new() };
    (!parts.is_empty()).then(|| format!("no contact between {}{more}", parts.join(", ")))
}

/// Returns the first lines, and the number of the others.
fn shortened(mut lines: Vec<String>, of: &str) -> Vec<String> {
    let n_more = lines.len().saturating_sub(MOST_LINES);
    lines.truncate(MOST_LINES);
    if n_more > 0 {
        lines.push(format!("{of} that are not listed: {n_more}"));
    }
    lines
}

fn conditions(background: &At<Background>) -> String {
    let sides = background.boundary().0.iter();
    sides.map(|(name, condition)| format!("{name} {}", condition.word())).collect::<Vec<_>>().join(", ")
}

fn motion(body: &BodyKeys) -> String {
    match (&body.motion, &body.material) {
        (Some(motion), _) => format!("does not deform, motion {}", motion.word()),
        (None, Some(material)) => {
            format!("elastic, {}, elements of order {}", material.word(), body.order.as_deref().unwrap_or(&1))
        }
        (None, None) => "elastic".to_owned(),
    }
}

fn supports(body: &BodyKeys) -> String {
    body.conditions().map(|(name, condition)| format!(", {name} {}", condition.word())).collect()
}

fn contact_line(contact: &ContactKeys, length: &str) -> String {
    let between = match (&contact.body, &contact.obstacle, &contact.pair) {
        (Some(body), Some(obstacle), _) => format!("of {} with {}", **body, obstacle.word()),
        (_, _, Some(pair)) => {
            format!("of {}", pair.iter().map(|name| name.as_str()).collect::<Vec<_>>().join(" with "))
        }
        _ => "of all pairs of bodies".to_owned(),
    };
    format!(
        "contact {between}: {}, size {} {length}, offset {} {length}",
        contact.law.word(),
        contact.size,
        contact.offset
    )
}

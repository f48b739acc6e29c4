//! A scenario as it is understood: sizes of its meshes, conditions and methods.

use std::collections::BTreeMap;
use std::sync::Arc;

use contact::Positions;
use mesh::search::SurfaceIndex;
use mesh::{Aabb, BodyId, Placed, Point, Tag};
use solver::body::{Body, BodyState};
use solver::{Contact, FluidBoundary, Setup, State, Step, StepError};

use crate::Error;
use crate::scenario::{
    At, Background, BodyKeys, Case, CaseVisitor, Choose as _, ContactKeys, Quantity, Scenario, ScenarioFile, lower,
};

/// Sizes of the problem of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizes {
    /// Cells of the background.
    pub background_cells: usize,
    /// Vertices of the background.
    pub background_vertices: usize,
    /// Extents of the background along the axes; none without a fluid.
    pub background_extents: Vec<f64>,
    /// Name, cells and vertices of each body; no cells if only its surface is used, because it does not deform.
    pub bodies: Vec<(String, usize, usize)>,
    /// Extents of each body along the axes, where the run begins.
    pub body_extents: Vec<Vec<f64>>,
    /// Roles in each contact, and contacts that act from the first step, for people.
    pub contacts: Vec<String>,
    /// Bodies that reach through a wall of the background, for people.
    pub outside: Vec<String>,
    /// Cut cells at the start.
    pub cut_cells: usize,
    /// Unknowns of the first step.
    pub dofs: usize,
    /// Steps.
    pub n_steps: usize,
    /// Whether half of a symmetric problem is solved.
    pub half_domain: bool,
    /// Name of the linear solver, and the reason for it.
    pub linear: String,
    /// The scenario as it is understood, for people: sizes, conditions and methods, with those that were chosen for it.
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
            .map_err(|stage| StepError::at(state.step + 1, state.time + setup.dt, stage))?;
        let positions = setup.positions(&state.bodies);
        let extents = |points: &[Point<D>]| Aabb::of_points(points).extent().iter().copied().collect();
        let length = scenario.units.label(Quantity::LENGTH);
        let mut sizes = Self {
            background_extents: background.map_or(Vec::new(), |mesh| extents(mesh.vertices())),
            body_extents: positions.iter().map(|points| extents(points)).collect(),
            contacts: contacts(setup, &positions, &length),
            outside: outside(setup, &positions, &length),
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
                    format!("body {name}: {motion}, {extents} {length}, {cells} cells, {vertices} vertices{supports}")
                }
            }
        }));
        lines.extend(scenario.contact.iter().map(|contact| contact_line(contact, &length)));
        lines.extend_from_slice(&self.contacts);
        lines.extend_from_slice(&self.outside);
        let scheme = match &scenario.time.scheme {
            Some(scheme) => scheme.word().to_owned(),
            None => "implicit-euler (the default)".to_owned(),
        };
        lines.push(format!(
            "steps: {} of {} {time}, to {} {time}; {scheme}; a step that fails is halved up to {} times",
            self.n_steps, *scenario.time.step, scenario.time.end, scenario.time.most_halvings,
        ));
        lines.push(format!("unknowns in the first step: {}", self.dofs));
        lines.push(format!("linear solver: {}", self.linear));
        let newton = &scenario.solver.newton;
        lines.push(format!(
            "Newton's method: relative tolerance {:e}, at most {} corrections in a step",
            newton.tolerance, newton.max_iterations
        ));
        let every = |n: usize| if n == 0 { "never".to_owned() } else { format!("every {n} steps") };
        let minutes = scenario.output.checkpoint_minutes.filter(|minutes| *minutes > 0.0);
        let minutes = minutes.map_or(String::new(), |minutes| format!(", {minutes} minutes or more apart"));
        lines.push(format!(
            "fields are written {}, checkpoints {}{minutes}",
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

/// Rounds to four significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Describes bodies that reach through a side of the background on which the velocity is given. At planes of symmetry and
/// open sides this is how parts of bodies are described.
fn outside<const D: usize>(setup: &Setup<D>, positions: &[Vec<Point<D>>], length: &str) -> Vec<String> {
    let Some(fluid) = &setup.fluid else { return Vec::new() };
    let background = &fluid.background;
    let boundary = background.boundary();
    let surface = Placed::new(&boundary, background.vertices());
    let index = SurfaceIndex::new(&surface);
    let least = ROUND_OFF * Aabb::of_points(background.vertices()).extent().max();
    let is_wall = |side: Tag| {
        let condition = fluid.boundary.iter().find(|(tag, _)| *tag == side);
        matches!(condition, Some((_, FluidBoundary::NoSlip | FluidBoundary::Velocity(_))))
    };
    let mut lines = Vec::new();
    for (body, points) in setup.bodies.iter().zip(positions) {
        let mut farthest: BTreeMap<Tag, (f64, &Point<D>)> = BTreeMap::new();
        for x in points.iter().filter(|x| background.cell_index().locate(x).is_none()) {
            let Some(nearest) = index.closest(x) else { continue };
            let away = x - nearest.point;
            let distance = away.norm();
            if let Some(side) = boundary.tag(nearest.facet).filter(|side| distance > least && is_wall(*side)) {
                // Across the side: the nearest point may be its end.
                let across = away.dot(&surface.facet_normal(nearest.facet)).abs();
                let distance = if across > least { across } else { distance };
                let of_side = farthest.entry(side).or_insert((distance, x));
                *of_side = if distance > of_side.0 { (distance, x) } else { *of_side };
            }
        }
        lines.extend(farthest.iter().map(|(side, (distance, x))| {
            let place: Vec<f64> = x.iter().map(|x| rounded(*x)).collect();
            format!(
                "warning: body {} reaches {distance:.3e} {length} through side {} of the background, to {place:?}: the part outside is in no fluid",
                body.name(),
                background.tag_names()[side.index()]
            )
        }));
    }
    lines
}

/// Largest number of contacts whose roles are described.
const MOST_ROLES: usize = 20;

/// Largest part of the contact size by which a gap is below the offset through round-off.
const ROUND_OFF: f64 = 1e-6;

/// Describes the roles in each contact, and the contacts that act from the first step because a gap is below the offset.
fn contacts<const D: usize>(setup: &Setup<D>, positions: &[Vec<Point<D>>], length: &str) -> Vec<String> {
    let name = |body: BodyId| setup.bodies[body.index()].name();
    let (mut lines, mut warnings) = (Vec::new(), Vec::new());
    for contact in &setup.contacts {
        let slave = name(contact.body());
        let obstacle = contact.master().map_or("its obstacle at rest", name);
        if contact.master().is_some_and(|master| master != contact.body()) {
            lines.push(format!("contact pair: slave {slave}, master {obstacle}"));
        }
        let (offset, size) = (contact.form().law.offset(), contact.form().size());
        if let Some(gap) = smallest_gap(setup, contact, positions).filter(|gap| *gap < offset - ROUND_OFF * size) {
            warnings.push(format!(
                "warning: the smallest gap of {slave} to {obstacle} is {gap:.3e} {length}, below the offset {offset} {length}: this contact acts from the \
                 first step"
            ));
        }
    }
    let n_more = lines.len().saturating_sub(MOST_ROLES);
    lines.truncate(MOST_ROLES);
    if n_more > 0 {
        lines.push(format!("contact pairs that are not listed: {n_more}"));
    }
    lines.append(&mut warnings);
    lines
}

/// Returns the smallest gap of vertices that may come into contact; `None` for a body with itself, and for bodies whose
/// boxes are farther apart than the offset.
fn smallest_gap<const D: usize>(setup: &Setup<D>, contact: &Contact<D>, positions: &[Vec<Point<D>>]) -> Option<f64> {
    let slave = contact.body().index();
    let vertices = setup.bodies[slave].surface().vertices_of(contact.facets());
    let points: Vec<_> = vertices.iter().map(|vertex| positions[slave][vertex.index()]).collect();
    let master = contact.master().map_or(&[][..], |master| &positions[master.index()]);
    if points.is_empty() || contact.master() == Some(contact.body()) {
        return None;
    }
    let offset = contact.form().law.offset();
    if !master.is_empty() && Aabb::of_points(&points).distance(&Aabb::of_points(master)) > offset {
        return None;
    }
    contact.geometry().smallest_gap(&points, Positions::Fixed(master))
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
    let parts = body.boundary.iter().flat_map(|conditions| &conditions.0);
    parts.map(|(name, condition)| format!(", {name} {}", condition.word())).collect()
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

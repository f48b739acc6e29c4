//! Builds the problem of dimension 2 or 3 from the values of a scenario.

use algebra::time::ImplicitEuler;
use algebra::{BlockLayout, Workspace};
use contact::{DeformableObstacle, Obstacle, Positions};
use cutcell::{CutMesh, OverlayOptions};
use mesh::generate::HALF_BALL_PLANE;
use mesh::{Aabb, BodyId, Coordinates, FacetId, Placed, Point, unit_vector};
use solver::body::StepTime;
use solver::xfem_space::PartValues;
use solver::{ApproachSteps, Contact, FluidBoundary, FluidSetup, Setup};

use super::background::{Background, expected};
use super::body::{BodyCondition, BodyKeys, Built, body};
use super::condition::{SymmetryPlane, symmetry_planes, tagged_vertices};
use super::contact::{ContactBuilder, ContactKeys, ObstacleChoice};
use super::error::ScenarioError;
use super::file::{Scenario, ScenarioFile};
use super::fluid::{balance_times, fluid, unbalanced};
use super::geometry::Shape;
use super::key::{Quantity, missing};
use super::motion::{Held, MotionChoice};
use super::probe::probes;
use super::table::At;
use crate::probes::Probes;

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

/// Estimates the number of cells of the background without a mesh. Returns `None` if there is no background, or it is
/// read from a file.
pub fn expected_cells(file: &ScenarioFile) -> Option<f64> {
    let (scenario, bodies) = (file.scenario(), file.scenario().bodies());
    let background = scenario.background.as_ref()?;
    match scenario.dimension {
        2 => expected::<2>(background, &bodies),
        _ => expected::<3>(background, &bodies),
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
            let alpha = scenario.interface.alpha;
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
        respect_symmetry(scenario, &given, fluid, &mut built)?;
    }
    let (mut contacts, mut of_contacts) = (Vec::new(), Vec::new());
    let builder = ContactBuilder::new(&built, fluid.as_ref().map(|fluid| &fluid.background));
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
    let mut bottom = 0.0;
    if let Some(fluid) = &setup.fluid {
        check_placement(&given, &setup, fluid, &positions)?;
        bottom = Aabb::of_points(fluid.background.vertices()).low[D - 1];
    }
    let half_domain = setup.fluid.as_ref().map(symmetry_planes).is_some_and(|mut planes| {
        planes.retain(|plane| coordinates.radial().is_none_or(|radial| plane.normal[radial] != 1.0));
        positions.iter().flatten().any(|x| planes.iter().any(|plane| plane.contains(x)))
    });
    check_repeated(&of_contacts, &setup)?;
    check_contacts(&of_contacts, &setup, &positions, scenario.units.label(Quantity::LENGTH))?;
    if let (Some(fluid), Some(background)) = (&setup.fluid, &scenario.background) {
        check_axis(fluid, background)?;
    }
    check_balance(scenario, &given, &part_names, &setup, &positions)?;
    let n_vertices = setup.fluid.as_ref().map(|fluid| fluid.background.n_vertices());
    let (linear, reason) = scenario.solver.linear(D, n_vertices.map_or(0, |n| (D + 1) * n));
    Ok(Case {
        workspace: linear.workspace(),
        linear: format!("{} ({reason})", linear.name()),
        n_steps: time.n_steps(),
        checkpoint_every: scenario.output.checkpoint_interval(),
        half_domain,
        bottom,
        probes: probes(&scenario.output.probes, &setup, &part_names, &scenario.units, scenario.dimension_of_whole())?,
        setup,
    })
}

/// Relative difference of volumes that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// Part of an area or volume that is covered twice, relative to all of a body, up to which a surface is accepted.
const TWICE: f64 = 1e-6;

/// Returns the area or volume of a box, less round-off.
fn all_of_box<const D: usize>(domain: &Aabb<D>) -> f64 {
    (1.0 - ROUND_OFF) * domain.extent().product()
}

/// Checks that every body has a vertex in the domain, that no body covers the domain or a place twice, and that no two
/// bodies overlap.
fn check_placement<const D: usize>(
    given: &[At<BodyKeys>],
    setup: &Setup<D>,
    fluid: &FluidSetup<D>,
    positions: &[Vec<Point<D>>],
) -> Result<(), ScenarioError> {
    let background = &fluid.background;
    let at = |k: usize| &given[k].shape.at;
    let domain = Aabb::of_points(background.vertices());
    let surfaces = setup.surfaces(positions);
    let covered = |k: usize, surfaces: &[Placed<'_, D>]| {
        let cut = CutMesh::overlay(background, surfaces, &OverlayOptions::new());
        cut.map(|cut| cut.covered_volume(background)).map_err(|error| at(k).error(error))
    };
    let alone: Vec<f64> =
        (0..surfaces.len()).map(|k| covered(k, &surfaces[k..=k])).collect::<Result<_, ScenarioError>>()?;
    let all = (1.0 - ROUND_OFF) * background.volume();
    if let Some(k) = alone.iter().position(|covered| *covered > all) {
        let name = setup.bodies[k].name();
        return Err(at(k).invalid(format!(
            "body `{name}` covers the whole background, so that no fluid is left; make it smaller, move it, or enlarge the background; if a mesh \
             file has another unit of length, give it a `scale`"
        )));
    }
    for (k, (body, positions)) in setup.bodies.iter().zip(positions).enumerate() {
        if !positions.iter().any(|x| domain.contains(x)) {
            let name = body.name();
            let span = |Aabb { low, high }: Aabb<D>| format!("from {:?} to {:?}", low.as_slice(), high.as_slice());
            let (of_body, of_background) = (span(Aabb::of_points(positions)), span(domain));
            let message = format!(
                "no vertex of body `{name}` lies in the domain: the body extends {of_body}, the background {of_background}; move it, or enlarge the \
                 background; if a mesh file has another unit of length, give it a `scale`"
            );
            return Err(at(k).invalid(message));
        }
    }
    // In a box, all of a body between the corners is covered.
    let is_box = background.volume() > all_of_box(&domain);
    for (k, positions) in positions.iter().enumerate().filter(|_| is_box) {
        let planar = surfaces[k].boundary().clone().with_coordinates(Coordinates::Cartesian);
        let enclosed = Placed::new(&planar, positions).enclosed().volume;
        if positions.iter().all(|x| domain.contains(x)) && enclosed > (1.0 + TWICE) * alone[k] {
            let (name, covered) = (setup.bodies[k].name(), alone[k]);
            return Err(at(k).invalid(format!(
                "the surface of body `{name}` encloses {enclosed:.4e} (area or volume), but covers {covered:.4e}: parts of it overlap, or the same part \
                 is there twice; remove one of them, or unite the parts"
            )));
        }
    }
    for a in 0..surfaces.len() {
        for b in a + 1..surfaces.len() {
            if !Aabb::of_points(&positions[a]).overlaps(&Aabb::of_points(&positions[b])) {
                continue;
            }
            let overlap = alone[a] + alone[b] - covered(b, &[surfaces[a], surfaces[b]])?;
            if overlap > ROUND_OFF * alone[a].min(alone[b]) {
                let [a, b_name] = [a, b].map(|k| setup.bodies[k].name());
                return Err(at(b).invalid(format!(
                    "bodies `{a}` and `{b_name}` overlap at the start by {overlap:.3e} (area or volume); move one of them"
                )));
            }
        }
    }
    Ok(())
}

/// Checks that the sides on the axis of axisymmetric coordinates are planes of symmetry.
fn check_axis<const D: usize>(fluid: &FluidSetup<D>, given: &At<Background>) -> Result<(), ScenarioError> {
    let Some(radial) = fluid.background.coordinates().radial() else { return Ok(()) };
    for (tag, condition) in &fluid.boundary {
        let points = tagged_vertices(&fluid.background, *tag);
        let is_on_axis = points.iter().all(|x| x[radial] == 0.0);
        if is_on_axis && !matches!(condition, FluidBoundary::Symmetry { normal } if normal[radial] == 1.0) {
            let name = &fluid.background.tag_names()[tag.index()];
            return Err(given.boundary().at.invalid(format!(
                "side `{name}` lies on the axis of rotation, where nothing crosses; give it the condition \"symmetry\""
            )));
        }
    }
    Ok(())
}

/// Returns whether two obstacles at rest are equal, or walls with a part in common.
fn overlap(a: &ContactKeys, b: &ContactKeys) -> bool {
    let parts = |of: &ContactKeys| match of.obstacle.as_deref() {
        Some(ObstacleChoice::Wall { parts }) => parts.iter().map(|name| name.to_string()).collect(),
        _ => Vec::new(),
    };
    let of_b = parts(b);
    a.obstacle == b.obstacle || parts(a).iter().any(|name| of_b.contains(name))
}

/// Checks that no contact is stated twice. `of_contacts` has the table of each contact.
fn check_repeated<const D: usize>(of_contacts: &[&At<ContactKeys>], setup: &Setup<D>) -> Result<(), ScenarioError> {
    let all: Vec<_> = of_contacts.iter().zip(&setup.contacts).collect();
    for (k, (given, contact)) in all.iter().enumerate() {
        let is_same = |(other, found): &&(&&At<ContactKeys>, &Contact<D>)| {
            let bodies = |contact: &Contact<D>| contact.master().map(|master| [contact.body(), master]);
            match bodies(contact) {
                // Either body may be the slave.
                Some([slave, master]) => {
                    [[slave, master], [master, slave]].into_iter().any(|pair| bodies(found) == Some(pair))
                }
                None => found.master().is_none() && found.body() == contact.body() && overlap(given, other),
            }
        };
        if all[..k].iter().any(|other| is_same(&other)) {
            let name = |id: BodyId| setup.bodies[id.index()].name();
            let obstacle = contact.master().map_or("this obstacle".to_owned(), |master| format!("`{}`", name(master)));
            return Err(given.at.invalid(format!(
                "the contact of `{}` with {obstacle} is stated twice, so that its forces would act twice; take one out",
                name(contact.body())
            )));
        }
    }
    Ok(())
}

/// Largest depth behind an obstacle that is round-off, relative to the contact size.
const TOUCHING: f64 = 1e-6;

/// Checks that no body begins behind the obstacle of one of its contacts. `of_contacts` has the table of each contact.
fn check_contacts<const D: usize>(
    of_contacts: &[&At<ContactKeys>],
    setup: &Setup<D>,
    positions: &[Vec<Point<D>>],
    length: String,
) -> Result<(), ScenarioError> {
    let depth = |obstacle: &dyn Obstacle<D>, at: &[Point<D>], points: &[Point<D>]| {
        obstacle.smallest_gap(points, Positions::Fixed(at)).map_or(0.0, |gap| -gap)
    };
    let boxes: Vec<_> = positions.iter().map(Aabb::of_points).collect();
    for (given, contact) in of_contacts.iter().zip(&setup.contacts) {
        let slave = contact.body().index();
        let behind = |body: usize, points: &[Point<D>]| {
            let surface = setup.bodies[body].surface();
            let obstacle = DeformableObstacle::new(surface.clone(), surface.facets().collect());
            obstacle.map(|obstacle| depth(&obstacle, &positions[body], points)).map_err(|error| given.at.error(error))
        };
        let deepest = match contact.master().map(BodyId::index) {
            None => depth(contact.obstacle(), &[], &positions[slave]),
            // A body has gaps to itself only where it is deformed.
            Some(master) if master == slave => continue,
            Some(master) if !boxes[master].overlaps(&boxes[slave]) => continue,
            Some(master) => behind(master, &positions[slave])?.max(behind(slave, &positions[master])?),
        };
        if deepest > TOUCHING * given.size {
            let name = setup.bodies[slave].name();
            let place = given.obstacle.as_ref().map_or(&given.at, |obstacle| &obstacle.at);
            let obstacle = match (contact.master(), &given.obstacle) {
                (Some(master), None) => format!("the surface of `{}`", setup.bodies[master.index()].name()),
                _ => "this obstacle".to_owned(),
            };
            let side = match given.obstacle.as_deref() {
                Some(ObstacleChoice::RigidPlane { .. }) => ", or reverse `normal`, which points into the obstacle",
                Some(ObstacleChoice::Ball { hollow: false, .. } | ObstacleChoice::Shape { hollow: false, .. }) => {
                    ", or set `hollow` if the body is inside of a container; a line that crosses itself has no inside"
                }
                _ => "",
            };
            return Err(place.invalid(format!(
                "body `{name}` is {deepest:.3e} {length} behind {obstacle} at the start; move one of them{side}"
            )));
        }
    }
    Ok(())
}

/// Checks, in a domain without open sides, that the given velocities have no net inflow, and that bodies with a given
/// motion cover the same volume at all times. There is no check if other bodies may leave the domain, or if there is a
/// net inflow together with a given motion.
fn check_balance<const D: usize>(
    scenario: &Scenario,
    bodies: &[At<BodyKeys>],
    part_names: &[Vec<String>],
    setup: &Setup<D>,
    positions: &[Vec<Point<D>>],
) -> Result<(), ScenarioError> {
    let (Some(fluid), Some(given)) = (&setup.fluid, &scenario.background) else { return Ok(()) };
    let domain = Aabb::of_points(fluid.background.vertices());
    let radial = fluid.background.coordinates().radial();
    let is_above = |x: &Point<D>, k: usize| domain.low[k] < x[k] || radial == Some(k) && x[k] == 0.0;
    let is_inside = |x: &Point<D>| (0..D).all(|k| is_above(x, k) && x[k] < domain.high[k]);
    let keeps_volume = |k: usize| match bodies[k].motion.as_deref() {
        Some(MotionChoice::Fixed | MotionChoice::Free { .. }) => positions[k].iter().all(is_inside),
        Some(_) => false,
        None => {
            let conditions = || bodies[k].boundary.iter().flat_map(|boundary| &boundary.0);
            let is_held = |name: &str| {
                let holds = |condition: &BodyCondition| {
                    matches!(condition, BodyCondition::Clamped | BodyCondition::Symmetry { .. })
                };
                conditions().any(|(part, condition)| part == name && holds(condition))
            };
            let surface = setup.bodies[k].surface();
            let (held, loose): (Vec<_>, Vec<_>) = surface
                .facets()
                .partition(|facet| surface.tag(*facet).is_some_and(|tag| is_held(&part_names[k][tag.index()])));
            let held = surface.vertices_of(&held);
            let mut loose = surface.vertices_of(&loose).into_iter();
            !conditions().any(|(_, condition)| matches!(**condition, BodyCondition::Displacement { .. }))
                && loose.all(|v| held.binary_search(&v).is_ok() || is_inside(&positions[k][v.index()]))
        }
    };
    let is_given = |k: &usize| {
        bodies[*k].motion.as_deref().is_some_and(|of| !matches!(of, MotionChoice::Fixed | MotionChoice::Free { .. }))
    };
    let moved: Vec<usize> = (0..bodies.len()).filter(is_given).collect();
    let is_open = fluid.boundary.iter().any(|(_, condition)| condition.is_open());
    if is_open || !(0..bodies.len()).all(|k| is_given(&k) || keeps_volume(k)) {
        return Ok(());
    }
    let times = [0.0, scenario.time.end];
    let Some((time, net)) = unbalanced(fluid, times) else {
        return check_displaced(setup, fluid, &moved, times).map_err(|(time, more)| {
            let name = setup.bodies[moved[0]].name();
            let given = bodies[moved[0]].motion.as_ref().map_or(&given.boundary().at, |motion| &motion.at);
            given.invalid(format!(
                "no side is open, and at the time {time} the bodies with a given motion, such as `{name}`, cover {:.3e} {} of the domain (area or \
                 volume) than at the start, which the volume of the fluid does not allow; make a side `free`, or keep the bodies inside",
                more.abs(),
                if more > 0.0 { "more" } else { "less" }
            ))
        });
    };
    if !moved.is_empty() {
        return Ok(());
    }
    Err(given.boundary().at.invalid(format!(
        "no side is open, and at the time {time} the given velocities have a net inflow of {net:.3e} (volume per time); make a side `free`, or \
         change the velocities"
    )))
}

/// Largest change of the volume that bodies with a given motion cover, relative to the largest volume.
const LARGEST_CHANGE: f64 = 1e-2;

/// Checks that bodies with a given motion cover the same volume at all times.
///
/// # Errors
/// A time at which the volume differs from the volume at the start, and the difference.
fn check_displaced<const D: usize>(
    setup: &Setup<D>,
    fluid: &FluidSetup<D>,
    moved: &[usize],
    times: [f64; 2],
) -> Result<(), (f64, f64)> {
    let background = &fluid.background;
    if moved.is_empty() {
        return Ok(());
    }
    let radial = background.coordinates().radial();
    let fluid_volume = |cut: &CutMesh<D>| -> f64 {
        let parts = PartValues::new(background, cut);
        cut.all_parts().map(|part| parts.moments(part).volume()).sum()
    };
    // Volumes of the cut are areas of the half plane in axisymmetric coordinates. Those of the fluid have the weight.
    let whole =
        radial.and_then(|_| CutMesh::overlay(background, &[], &fluid.overlay).ok()).map(|cut| fluid_volume(&cut));
    if radial.is_some() && whole.is_none() {
        return Ok(());
    }
    let covered = |time: f64| {
        let step = StepTime::new(&ImplicitEuler, time, time.max(setup.dt), true);
        let of_body = |k: &usize| {
            let (body, mut layout) = (&setup.bodies[*k], BlockLayout::new());
            let positions =
                body.step(&body.initial(), &step, &mut layout).end(&layout, &[]).positions(body.reference());
            let surface = Placed::new(body.surface(), &positions);
            let cut = CutMesh::overlay(background, &[surface], &fluid.overlay).ok()?;
            Some(whole.map_or_else(|| cut.covered_volume(background), |whole| whole - fluid_volume(&cut)))
        };
        moved.iter().map(of_body).sum::<Option<f64>>()
    };
    // If a cut fails, there is no check here; the step returns the error.
    let volumes = balance_times(times).map(|time| Some((time, covered(time)?))).collect::<Option<Vec<(f64, f64)>>>();
    let volumes = volumes.unwrap_or_default();
    let largest = volumes.iter().map(|(_, volume)| *volume).fold(0.0, f64::max);
    let start = volumes.first().map_or(0.0, |(_, volume)| *volume);
    let changed = volumes.iter().find(|(_, volume)| (volume - start).abs() > LARGEST_CHANGE * largest);
    changed.map_or(Ok(()), |(time, volume)| Err((*time, volume - start)))
}

/// Removes facets on planes of symmetry from the contact facets of bodies that do not deform, and checks that free
/// bodies with such facets are held, and such facets of elastic bodies too, by a condition or a contact.
fn respect_symmetry<const D: usize>(
    scenario: &Scenario,
    bodies: &[At<BodyKeys>],
    fluid: &FluidSetup<D>,
    built: &mut [Built<D>],
) -> Result<(), ScenarioError> {
    let planes = symmetry_planes(fluid);
    let domain = Aabb::of_points(fluid.background.vertices());
    for given in bodies {
        let Shape::HalfBall { centre, mirrored: false, .. } = &*given.shape else { continue };
        let mut conditions = given.boundary.iter().flat_map(|boundary| &boundary.0);
        let is_symmetric = |(name, condition): &(String, At<BodyCondition>)| {
            name == HALF_BALL_PLANE && matches!(**condition, BodyCondition::Symmetry { .. })
        };
        let at = centre[0] + given.shift.as_ref().map_or(0.0, |shift| shift[0]);
        let on_diameter = unit_vector::<D>(0) * at;
        let is_on_plane = planes.iter().any(|plane| plane.normal[0] == 1.0 && plane.contains(&on_diameter));
        let is_inside = domain.low[0] <= at && at <= domain.high[0];
        let is_on_axis = fluid.background.coordinates().radial() == Some(0) && at == 0.0;
        if conditions.any(is_symmetric) && is_inside && !is_on_plane && !is_on_axis {
            return Err(given.shape.at.invalid(format!(
                "the diameter of this half ball is a line of symmetry at x = {at}, but no side of the background is one there; move it, or use a ball"
            )));
        }
    }
    for (given, Built { body, contact_facets, part_names }) in bodies.iter().zip(built) {
        let positions = body.initial().positions(body.reference());
        let on_plane = |facet: FacetId| {
            let vertices = body.surface().facet(facet);
            planes.iter().find(|plane| vertices.iter().all(|v| plane.contains(&positions[v.index()])))
        };
        let Some(motion) = &given.motion else {
            let is_moved = |facet: &FacetId| {
                let name = body.surface().tag(*facet).and_then(|tag| part_names.get(tag.index()));
                let mut conditions = given.boundary.iter().flat_map(|boundary| &boundary.0);
                conditions.any(|(part, of)| Some(part) == name && matches!(**of, BodyCondition::Displacement { .. }))
            };
            let is_loose = |facet: &&FacetId| {
                let at = body.surface().facet(**facet).iter().map(|v| positions[v.index()]);
                let side = planes.iter().find(|plane| at.clone().all(|x| plane.is_on_side(&x)));
                let is_stopped = |plane| scenario.contact.iter().any(|of| of.stops(&given.name, plane, fluid));
                side.is_some_and(|plane| !is_moved(facet) && !is_stopped(plane))
            };
            if contact_facets.iter().any(|facet| is_loose(&facet)) {
                return Err(given.shape.at.invalid(format!(
                    "a part of the surface of `{}` lies on a plane of symmetry of the background, through which nothing holds it; give the part the \
                     condition \"symmetry\" in `boundary`, or state a contact with the plane",
                    given.name.as_str()
                )));
            }
            continue;
        };
        contact_facets.retain(|facet| on_plane(*facet).is_none());
        // A body on the axis of rotation moves along the axis only.
        let is_axisymmetric = body.surface().coordinates().radial().is_some();
        let MotionChoice::Free { held, .. } = &**motion else { continue };
        if is_axisymmetric {
            continue;
        }
        let is_held = |what: Held| held.iter().any(|held| **held == what);
        let across = |plane: &SymmetryPlane<D>| {
            let axes = [Held::X, Held::Y, Held::Z].into_iter().zip(["\"x\"", "\"y\"", "\"z\""]);
            let axes = axes.zip(plane.normal.iter()).filter(|(_, n)| **n != 0.0).map(|(axis, _)| axis);
            axes.chain([(Held::Rotation, "\"rotation\"")]).collect::<Vec<_>>()
        };
        let is_loose = |plane: &&SymmetryPlane<D>| across(plane).iter().any(|(what, _)| !is_held(*what));
        if let Some(plane) = body.surface().facets().filter_map(on_plane).find(is_loose) {
            let (name, needed) =
                (body.name(), across(plane).into_iter().map(|(_, word)| word).collect::<Vec<_>>().join(", "));
            return Err(motion.at.invalid(format!(
                "body `{name}` stands on a plane of symmetry, which it must not leave; sliding along an oblique plane is not available: add held = [{needed}]"
            )));
        }
    }
    Ok(())
}

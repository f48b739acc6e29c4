//! Warnings about choices in a scenario that are allowed but mostly mistakes.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use contact::Positions;
use mesh::search::SurfaceIndex;
use mesh::{Aabb, BodyId, Placed, Point, Tag, Vector, equilateral_side, mean};
use solver::body::{Body, BodyState};
use solver::{Contact, FluidBoundary, Setup, State};

use crate::mesh_file::n_parts;
use crate::pressures::{large_pressures, pressure_lags, unbalanced_sides};
use crate::scenario::{
    BodyCondition, BodyKeys, Case, Choose as _, Quantity, Scenario, TimeSchemeChoice, parabolas_at_symmetry, rounded,
    rounded_down,
};

/// Largest round-off of a gap, divided by the contact size, and of positions, divided by the extent of the mesh.
const ROUND_OFF: f64 = 1e-6;

/// Largest relative difference of two equal forces.
const EQUAL: f64 = 1e-2;

/// Returns the warnings about a case in a state.
pub(crate) fn warnings<const D: usize>(scenario: &Scenario, case: &Case<D>, state: &State<D>) -> Vec<String> {
    let setup = &case.setup;
    let positions = setup.positions(&state.bodies);
    let length = scenario.units.label(Quantity::LENGTH);
    let mut lines = contacts_at_start(setup, &positions, &length);
    lines.extend(contacts_in_fluid(setup, &length));
    let reaching = outside(setup, &positions, &length).into_iter();
    lines.extend(reaching.map(|reach| format!("warning: {}: the part outside is in no fluid", reach.description)));
    lines.extend(small_bodies(setup, &positions));
    lines.extend(body_forces(setup, state, scenario.time.end));
    lines.extend(torn(setup, state));
    lines.extend(high_floor(setup));
    lines.extend(not_held(scenario, setup));
    lines.extend(parabolas(scenario, setup));
    lines.extend(turning(setup, state.time, &positions, &length));
    lines.extend(large_pressures(scenario, case));
    lines.extend(unbalanced_sides(scenario, setup));
    lines.extend(case.probes.warnings.iter().cloned());
    let deforms = setup.bodies.iter().any(|body| body.deforms());
    let can_turn = !case.half_domain && !scenario.is_axisymmetric();
    if pressure_lags(setup) && deforms && setup.fluid.is_some() && can_turn {
        lines.push(format!(
            "warning: with {} an elastic body that turns changes its area, and an ambient pressure turns it faster; generalised-alpha does neither",
            scenario.time.scheme.word()
        ));
    }
    lines
}

/// Returns warnings about elastic bodies of several parts that share no vertex.
fn torn<const D: usize>(setup: &Setup<D>, state: &State<D>) -> Vec<String> {
    let of_body = |(body, state): (&Arc<dyn Body<D>>, &BodyState<D>)| {
        let n_parts = n_parts(body.reference().len(), body.cells(state)?.cells());
        (n_parts > 1).then(|| {
            format!(
                "warning: body {} consists of {n_parts} parts that share no vertex, and move apart; if they belong together, merge the nodes between them \
                 in the mesh (Gmsh: `Coherence Mesh`)",
                body.name()
            )
        })
    };
    setup.bodies.iter().zip(&state.bodies).filter_map(of_body).collect()
}

/// Returns warnings about contacts that act from the first step because a gap is below the offset.
fn contacts_at_start<const D: usize>(setup: &Setup<D>, positions: &[Vec<Point<D>>], length: &str) -> Vec<String> {
    let name = |body: BodyId| setup.bodies[body.index()].name();
    let of_contact = |contact: &Contact<D>| {
        let (slave, obstacle) = (name(contact.body()), contact.master().map_or("its obstacle at rest", name));
        let (offset, size) = (contact.form().law.offset(), contact.form().size());
        let gap = smallest_gap(setup, contact, positions).filter(|gap| *gap < offset - ROUND_OFF * size)?;
        Some(format!(
            "warning: the smallest gap of {slave} to {obstacle} is {gap:.3e} {length}, below the offset {offset} {length}: this contact acts from the \
             first step"
        ))
    };
    setup.contacts.iter().filter_map(of_contact).collect()
}

/// Returns warnings about laws of contact in fluid with which a body does not come to rest under its weight.
fn contacts_in_fluid<const D: usize>(setup: &Setup<D>, length: &str) -> Vec<String> {
    let Some(fluid) = &setup.fluid else { return Vec::new() };
    let mut lines = Vec::new();
    for contact in &setup.contacts {
        let (slave, law) = (setup.bodies[contact.body().index()].name(), &contact.form().law);
        match fluid.film {
            None if law.offset() == 0.0 => lines.push(format!(
                "warning: contact of {slave} has the offset 0 in a fluid without `fluid.film`: between surfaces that touch cells hold a pressure or a \
                 suction that drains slowly; give an offset of a cell, or `fluid.film` with a roughness and an offset of this roughness"
            )),
            Some(film) if law.offset() < film.roughness => lines.push(format!(
                "warning: contact of {slave} has an offset {} {length} below the roughness {} {length} of the film: at rest a part of the weight stays \
                 on the film; give an offset of the roughness",
                law.offset(),
                film.roughness
            )),
            _ => {}
        }
    }
    lines.dedup();
    lines
}

/// Returns warnings about a body force of the fluid that is not its density times the gravity of a body, in the state
/// or at the end of the run.
fn body_forces<const D: usize>(setup: &Setup<D>, state: &State<D>, end: f64) -> Vec<String> {
    let Some((fluid, force)) = setup.fluid.as_ref().and_then(|fluid| Some((fluid, fluid.body_force.as_ref()?))) else {
        return Vec::new();
    };
    let of_body = |(body, of): (&Arc<dyn Body<D>>, &BodyState<D>)| {
        let balance = body.balance(of)?;
        let differs = |time: f64| {
            let gravity = balance.body_force / balance.mass + body.variable_gravity(time);
            let (found, usual) = (force(&balance.centre_of_mass, time), gravity * fluid.material.density);
            let differs = (found - usual).norm() > EQUAL * usual.norm() && gravity.norm() > 0.0;
            differs.then_some((time, found, usual))
        };
        let shown = |of: &Vector<D>| of.iter().map(|component| rounded(*component)).collect::<Vec<_>>();
        [state.time, end].into_iter().find_map(differs).map(|(time, found, usual)| {
            format!(
                "warning: at t = {} `fluid.body_force` is {:?} at body {}, and the density of the fluid times the gravity of the body is {:?}: `body_force` is a \
                 force per volume",
                rounded(time),
                shown(&found),
                body.name(),
                shown(&usual)
            )
        })
    };
    setup.bodies.iter().zip(&state.bodies).filter_map(of_body).collect()
}

/// Returns a warning about a floor of the pressure of films above zero, where it is mostly the absolute pressure of the
/// vapour.
fn high_floor<const D: usize>(setup: &Setup<D>) -> Option<String> {
    let floor = setup.fluid.as_ref()?.film?.floor.filter(|floor| *floor > 0.0)?;
    Some(format!(
        "warning: fluid.film.floor is {floor:e}, above zero: it is the pressure of the vapour minus that of the surroundings, negative if no given pressure \
         is absolute; a floor above the pressure of the fluid pushes bodies apart"
    ))
}

/// Returns warnings about bodies whose position is not determined: without inertia and fluid, only supports and
/// contacts hold them.
fn not_held<const D: usize>(scenario: &Scenario, setup: &Setup<D>) -> Vec<String> {
    if setup.fluid.is_some() || !matches!(*scenario.time.scheme, TimeSchemeChoice::QuasiStatic) {
        return Vec::new();
    }
    let holds = |condition: &BodyCondition| !matches!(condition, BodyCondition::Traction { .. });
    let is_held = |keys: &BodyKeys| keys.conditions().any(|(_, condition)| holds(condition));
    let all = scenario.bodies();
    let bodies = setup.bodies.iter().zip(&all).filter(|(body, keys)| body.is_movable() && !is_held(keys));
    let line = |(body, _): (&Arc<dyn Body<D>>, _)| {
        let advice =
            if body.deforms() { "clamp a part in `body.boundary`" } else { "hold its motions with `body.motion.held`" };
        format!(
            "warning: no part of body {} is held: with quasi-static and without a fluid only contact can hold it, and the matrix is singular without \
             it; {advice}, or choose another `time.scheme`",
            body.name()
        )
    };
    bodies.map(line).collect()
}

/// Returns warnings about parabolic inflows that end at a plane of symmetry, where their velocity is zero.
fn parabolas<const D: usize>(scenario: &Scenario, setup: &Setup<D>) -> Vec<String> {
    let (Some(fluid), Some(background)) = (&setup.fluid, &scenario.background) else { return Vec::new() };
    let line = |name: &str| {
        format!(
            "warning: the inflow through side {name} ends at a plane of symmetry, where its parabola is zero; for half of a channel use `velocity` with a \
             formula"
        )
    };
    parabolas_at_symmetry(background.boundary(), fluid).into_iter().map(line).collect()
}

/// Largest distance by which contact may place the surface of a turning body too far out, relative to the contact size.
const TOO_FAR_OUT: f64 = 0.1;

/// Returns warnings about bodies of given motion that turn too fast for their contacts. Generalised-α shifts points in
/// contact along their velocities, up to `|v - v̄|² Δt²/(2 r)` out of their circle. Free bodies are turned.
fn turning<const D: usize>(setup: &Setup<D>, time: f64, positions: &[Vec<Point<D>>], length: &str) -> Vec<String> {
    let (mut lines, mut named) = (Vec::new(), BTreeSet::new());
    if setup.scheme.weights(setup.dt, false).shifted[0].velocity == 0.0 {
        return lines;
    }
    for contact in &setup.contacts {
        for id in [Some(contact.body()), contact.master()].into_iter().flatten() {
            let (body, points) = (&setup.bodies[id.index()], &positions[id.index()]);
            let velocities: Option<Vec<_>> = points.iter().map(|x| body.given_velocity(x, time)).collect();
            let Some(velocities) = velocities else { continue };
            let [centre, drift] = [points, &velocities].map(|of| mean(of));
            let outward = |k: usize| {
                let (speed, radius) = ((velocities[k] - drift).norm(), (points[k] - centre).norm());
                if radius > 0.0 { (speed * setup.dt).powi(2) / (2.0 * radius) } else { 0.0 }
            };
            let (farthest, size) = ((0..points.len()).map(outward).fold(0.0, f64::max), contact.form().size());
            if farthest > TOO_FAR_OUT * size && named.insert(id) {
                lines.push(format!(
                    "warning: body {} turns so far in a step that contact places its surface up to {farthest:.1e} {length} too far out, and the contact \
                     size is {size} {length}; use steps of at most {:e}",
                    body.name(),
                    rounded_down(setup.dt * (TOO_FAR_OUT * size / farthest).sqrt())
                ));
            }
        }
    }
    lines
}

/// Smallest number of cells along the largest extent of a resolved body.
const LEAST_CELLS: f64 = 3.0;

/// Returns warnings about bodies whose largest extent is below [`LEAST_CELLS`] cells.
fn small_bodies<const D: usize>(setup: &Setup<D>, positions: &[Vec<Point<D>>]) -> Vec<String> {
    let Some(fluid) = &setup.fluid else { return Vec::new() };
    let of_body = |(body, points): (&Arc<dyn Body<D>>, &Vec<Point<D>>)| {
        let bounds = Aabb::of_points(points);
        let (cell, _) = fluid.background.cell_index().locate(&((bounds.low + bounds.high) * 0.5))?;
        let n_cells = bounds.extent().max() / equilateral_side::<D>(fluid.background.cell_volume(cell));
        (n_cells < LEAST_CELLS).then(|| {
            let name = body.name();
            format!("warning: body {name} is {n_cells:.1} cells long: its flow is not resolved; make the cells around it smaller")
        })
    };
    setup.bodies.iter().zip(positions).filter_map(of_body).collect()
}

/// A body that reaches through a side of the background with a prescribed velocity.
struct BeyondSide {
    body: usize,
    side: Tag,
    /// Largest distance from the side.
    distance: f64,
    /// Body, distance, side and place.
    description: String,
}

/// Describes bodies that reach through no-slip sides farther than at the start of the run, and by more than the size of
/// their contacts with obstacles at rest.
pub(crate) fn outside_walls<const D: usize>(setup: &Setup<D>, state: &State<D>, length: &str) -> Vec<String> {
    let Some(fluid) = &setup.fluid else { return Vec::new() };
    let initial: Vec<_> = setup.bodies.iter().map(|body| body.initial()).collect();
    let at_start = outside(setup, &setup.positions(&initial), length);
    let allowed = |reach: &BeyondSide| {
        let is_same = |other: &&BeyondSide| (other.body, other.side) == (reach.body, reach.side);
        let begun = at_start.iter().find(is_same).map_or(0.0, |other| other.distance);
        let is_own = |contact: &&Contact<D>| contact.body().index() == reach.body && contact.master().is_none();
        let sizes = setup.contacts.iter().filter(is_own).map(|contact| contact.form().size());
        begun + sizes.fold(ROUND_OFF * begun, f64::max)
    };
    let is_wall = |reach: &BeyondSide| {
        fluid.boundary.iter().any(|(tag, side)| *tag == reach.side && matches!(side, FluidBoundary::NoSlip))
    };
    let found = outside(setup, &setup.positions(&state.bodies), length).into_iter();
    found.filter(|reach| is_wall(reach) && reach.distance > allowed(reach)).map(|reach| reach.description).collect()
}

/// Returns the bodies that reach through a side of the background with a prescribed velocity. Bodies may reach through
/// planes of symmetry and open sides.
fn outside<const D: usize>(setup: &Setup<D>, positions: &[Vec<Point<D>>], length: &str) -> Vec<BeyondSide> {
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
    for (index_of_body, (body, points)) in setup.bodies.iter().zip(positions).enumerate() {
        let mut farthest: BTreeMap<Tag, (f64, &Point<D>)> = BTreeMap::new();
        for x in points.iter().filter(|x| background.cell_index().locate(x).is_none()) {
            let Some(nearest) = index.closest(x) else { continue };
            let away = x - nearest.point;
            let distance = away.norm();
            if let Some(side) = boundary.tag(nearest.facet).filter(|side| distance > least && is_wall(*side)) {
                // Distance normal to the side; the nearest point may be on the edge of the side.
                let across = away.dot(&surface.facet_normal(nearest.facet)).abs();
                let distance = if across > least { across } else { distance };
                let of_side = farthest.entry(side).or_insert((distance, x));
                *of_side = if distance > of_side.0 { (distance, x) } else { *of_side };
            }
        }
        lines.extend(farthest.iter().map(|(side, (distance, x))| {
            let place: Vec<f64> = x.iter().map(|x| rounded(*x)).collect();
            let (name, of_side) = (body.name(), &background.tag_names()[side.index()]);
            let description = format!(
                "body {name} reaches {distance:.3e} {length} through side {of_side} of the background, to {place:?}"
            );
            BeyondSide { body: index_of_body, side: *side, distance: *distance, description }
        }));
    }
    lines
}

/// Returns the smallest gap of the vertices of a contact. Returns `None` for contact of a body with itself, and for
/// bodies whose bounding boxes are farther apart than the offset.
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
    contact.obstacle().smallest_gap(&points, Positions::Fixed(master))
}

//! Checks that the volume of the fluid is kept in a domain without open sides.

use algebra::BlockLayout;
use algebra::time::ImplicitEuler;
use cutcell::CutMesh;
use mesh::{Aabb, FacetId, Placed, Point, Tag, Vector};
use solver::body::StepTime;
use solver::xfem_space::PartValues;
use solver::{FluidBoundary, FluidSetup, Setup};

use super::body::{BodyCondition, BodyKeys};
use super::condition::sampled;
use super::error::ScenarioError;
use super::file::Scenario;
use super::motion::MotionChoice;
use super::table::At;

/// Checks, in a domain without open sides, that the given velocities have no net inflow, and that bodies with a given
/// motion cover the same volume at some times of the run. There is no check if other bodies may leave the domain, or if there is a
/// net inflow together with a given motion.
pub(super) fn check_balance<const D: usize>(
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
            let conditions = || bodies[k].conditions();
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
            !conditions().any(|(_, condition)| matches!(condition, BodyCondition::Displacement { .. }))
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
                "no side is open, and at the time {time:.3e} the bodies with a given motion, such as `{name}`, cover {:.3e} {} of the domain (area or \
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
        "no side is open, and at the time {time:.3e} the given velocities have a net inflow of {net:.3e} (volume per time); make a side `free`, or \
         change the velocities"
    )))
}

/// Largest change of the volume that bodies with a given motion cover, relative to the largest volume.
const LARGEST_CHANGE: f64 = 1e-2;

/// Checks that bodies with a given motion cover the same volume at some times of the run.
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
    let volumes = sampled(times).map(|time| Some((time, covered(time)?))).collect::<Option<Vec<(f64, f64)>>>();
    let volumes = volumes.unwrap_or_default();
    let largest = volumes.iter().map(|(_, volume)| *volume).fold(0.0, f64::max);
    let start = volumes.first().map_or(0.0, |(_, volume)| *volume);
    let changed = volumes.iter().find(|(_, volume)| (volume - start).abs() > LARGEST_CHANGE * largest);
    changed.map_or(Ok(()), |(time, volume)| Err((*time, volume - start)))
}

/// Largest net flow through the boundary of a closed domain, relative to the largest integral of the speed over the
/// boundary. Profiles are interpolated on facets, with an error of second order in their size.
const LARGEST_NET_FLOW: f64 = 1e-2;

/// Returns a time and the net inflow at this time if no part of the boundary is open and the net inflow is not zero.
/// Velocities are those that the solver prescribes at vertices. At a vertex of several conditions a wall has precedence
/// over a given velocity.
fn unbalanced<const D: usize>(fluid: &FluidSetup<D>, times: [f64; 2]) -> Option<(f64, f64)> {
    if fluid.boundary.iter().any(|(_, condition)| condition.is_open()) {
        return None;
    }
    let background = &fluid.background;
    let surface = &background.boundary();
    let placed = Placed::new(surface, background.vertices());
    let on = |tag: Tag| surface.facets().filter(move |facet| surface.tag(*facet) == Some(tag));
    let at = |time: f64| {
        let mut nodal = vec![Vector::<D>::zeros(); background.n_vertices()];
        for (tag, condition) in &fluid.boundary {
            let FluidBoundary::Velocity(velocity) = condition else { continue };
            let vertices = on(*tag).flat_map(|facet| surface.facet(facet));
            vertices.for_each(|v| nodal[v.index()] = velocity(&background.vertex(*v), time));
        }
        for (tag, _) in fluid.boundary.iter().filter(|(_, condition)| matches!(condition, FluidBoundary::NoSlip)) {
            on(*tag).flat_map(|facet| surface.facet(facet)).for_each(|v| nodal[v.index()] = Vector::zeros());
        }
        let of_facet = |facet: FacetId| {
            let vertices = surface.facet(facet);
            let sum: Vector<D> = vertices.iter().map(|v| nodal[v.index()]).sum();
            let per_vertex = placed.weighted_measure(facet) / vertices.len() as f64;
            [-sum.dot(&placed.facet_normal(facet)) * per_vertex, sum.norm() * per_vertex]
        };
        surface.facets().map(of_facet).fold([0.0; 2], |sum, flow| [sum[0] + flow[0], sum[1] + flow[1]])
    };
    let flows: Vec<(f64, [f64; 2])> = sampled(times).map(|time| (time, at(time))).collect();
    let largest = flows.iter().map(|(_, [_, all])| *all).fold(0.0, f64::max);
    flows.into_iter().map(|(time, [net, _])| (time, net)).find(|(_, net)| net.abs() > LARGEST_NET_FLOW * largest)
}

//! Where bodies may stand.

use cutcell::CutMesh;
use mesh::{FacetId, Placed, Point};
use solver::{Body, BodyKind, FluidBoundary, Setup};

use super::ScenarioFile;
use super::problem::{Problem, ScenarioError};

/// Every body has a vertex in the domain, and no two bodies share space.
pub(super) fn check_placement<const D: usize>(file: &ScenarioFile, setup: &Setup<D>) -> Result<(), ScenarioError> {
    let positions: Vec<Vec<Point<D>>> = setup.bodies.iter().map(initial_positions).collect();
    let (low, high) = bounds(setup.background.vertices());
    for (k, (body, positions)) in setup.bodies.iter().zip(&positions).enumerate() {
        if !positions.iter().any(|x| (0..D).all(|a| low[a] <= x[a] && x[a] <= high[a])) {
            let problem = Problem::OutsideDomain { name: body.name.clone() };
            return Err(file.error(&format!("body.{k}.shape"), problem));
        }
    }
    let surfaces = setup.surfaces(&positions);
    let whole: f64 = setup.background.cells().map(|c| setup.background.cell_volume(c)).sum();
    let covered = |surfaces: &[Placed<'_, D>]| {
        CutMesh::overlay(&setup.background, surfaces, &setup.overlay).map(|cut| whole - cut.fluid_volume())
    };
    let path = |k: usize| format!("body.{k}.shape");
    let alone: Vec<f64> = (0..surfaces.len())
        .map(|k| covered(&surfaces[k..=k]).map_err(|e| file.error(&path(k), e)))
        .collect::<Result<_, _>>()?;
    for a in 0..surfaces.len() {
        for b in a + 1..surfaces.len() {
            if !boxes_meet(&positions[a], &positions[b]) {
                continue;
            }
            let both = covered(&[surfaces[a], surfaces[b]]).map_err(|e| file.error(&path(b), e))?;
            let overlap = alone[a] + alone[b] - both;
            // Volumes carry round-off of the whole domain.
            if overlap > (1e-9 * alone[a].min(alone[b])).max(1e-12 * whole) {
                let [a, b_name] = [a, b].map(|k| setup.bodies[k].name.clone());
                return Err(file.error(&path(b), Problem::Overlap { a, b: b_name, overlap }));
            }
        }
    }
    Ok(())
}

fn initial_positions<const D: usize>(body: &Body<D>) -> Vec<Point<D>> {
    let displacement = body.elastic().and_then(|elastic| elastic.initial_displacement.as_ref());
    let moved = |x: &Point<D>| match &body.kind {
        BodyKind::Prescribed(prescribed) => (prescribed.position)(x, 0.0),
        _ => displacement.map_or(*x, |d| x + d(x)),
    };
    body.reference().iter().map(moved).collect()
}

fn bounds<const D: usize>(points: &[Point<D>]) -> (Point<D>, Point<D>) {
    points
        .iter()
        .fold((Point::repeat(f64::INFINITY), Point::repeat(f64::NEG_INFINITY)), |(a, b), x| (a.inf(x), b.sup(x)))
}

fn boxes_meet<const D: usize>(a: &[Point<D>], b: &[Point<D>]) -> bool {
    let ((a_low, a_high), (b_low, b_high)) = (bounds(a), bounds(b));
    (0..D).all(|k| a_low[k] <= b_high[k] && b_low[k] <= a_high[k])
}

/// A body that does not deform may stand on a plane of symmetry with its half: its facets there touch nothing, and if it is
/// free it must be held.
pub(super) fn respect_symmetry<const D: usize>(file: &ScenarioFile, setup: &mut Setup<D>) -> Result<(), ScenarioError> {
    let (low, high) = bounds(setup.background.vertices());
    let room = (high - low).max() * ON_PLANE;
    let names = setup.background.tag_names();
    let planes = setup.fluid.boundary.iter().filter_map(|(tag, condition)| {
        let FluidBoundary::Symmetry { axis } = condition else { return None };
        let is_low = ["left", "front", "bottom"].contains(&names[tag.index()].as_str());
        Some((*axis, if is_low { low[*axis] } else { high[*axis] }))
    });
    let planes: Vec<(usize, f64)> = planes.collect();
    for (k, body) in setup.bodies.iter().enumerate().filter(|(_, body)| body.elastic().is_none()) {
        let positions = initial_positions(body);
        let on_plane = |facet: FacetId| {
            let is_on = |(axis, at): &&(usize, f64)| {
                body.boundary().facet(facet).iter().all(|v| (positions[v.index()][*axis] - at).abs() <= room)
            };
            planes.iter().find(is_on)
        };
        for contact in setup.contacts.iter_mut().filter(|contact| contact.body.index() == k) {
            contact.facets.retain(|facet| on_plane(*facet).is_none());
        }
        let Some(rigid) = body.rigid() else { continue };
        let free = body
            .boundary()
            .facets()
            .filter_map(on_plane)
            .find(|(axis, _)| !(rigid.held_axes[*axis] && rigid.holds_rotation));
        if let Some((axis, _)) = free {
            let problem = Problem::Unheld { name: body.name.clone(), axis: ["x", "y", "z"][*axis] };
            return Err(file.error(&format!("body.{k}.motion"), problem));
        }
    }
    Ok(())
}

/// Largest distance of a plane of symmetry from a vertex on it, over the size of the domain.
const ON_PLANE: f64 = 1e-9;

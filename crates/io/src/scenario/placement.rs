//! Checks that bodies are sound, apart from each other and from obstacles, and that contacts are stated once.

use contact::{DeformableObstacle, Obstacle, Positions};
use cutcell::{CutMesh, OverlayOptions};
use mesh::generate::structured_box;
use mesh::{Aabb, BodyId, Coordinates, Placed, Point, SimplexMesh, Vector};
use solver::{Contact, FluidSetup, Setup, State};

use super::body::BodyKeys;
use super::condition::tagged_vertices;
use super::contact::{ContactKeys, ObstacleChoice};
use super::error::ScenarioError;
use super::table::At;

/// Relative difference of volumes that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// Largest doubly enclosed area or volume of a body that is accepted, relative to the covered one.
const TWICE: f64 = 1e-6;

/// Largest number of cells along an axis of the mesh on which the surface of a body is checked.
const MOST_CELLS: usize = 16;

/// Checks that no surface crosses itself or encloses a region twice: a box around each body is cut by its surface, and
/// the covered volume is compared with the enclosed one.
pub(super) fn check_surfaces<const D: usize>(
    given: &[At<BodyKeys>],
    setup: &Setup<D>,
    positions: &[Vec<Point<D>>],
) -> Result<(), ScenarioError> {
    let all: Vec<_> = given.iter().zip(&setup.bodies).zip(positions).collect();
    // Copies follow their body.
    let is_copy = |k: usize| {
        k > 0
            && given[k].shape == given[k - 1].shape
            && given[k].initial_displacement == given[k - 1].initial_displacement
    };
    for ((given, body), positions) in all.into_iter().enumerate().filter(|(k, _)| !is_copy(*k)).map(|(_, body)| body) {
        let (at, name) = (&given.shape.at, body.name());
        let unsound = |error: cutcell::Error| {
            let error = error.to_string();
            at.invalid(format!("the surface of body `{name}` is unsound: {}", error.trim_start_matches("body 0: ")))
        };
        let planar = body.surface().clone().with_coordinates(Coordinates::Cartesian);
        let surface = Placed::new(&planar, positions);
        let bounds = Aabb::of_points(positions);
        let room = Vector::repeat(0.1 * bounds.extent().max());
        let [low, high] = [bounds.low - room, bounds.high + room].map(|corner| std::array::from_fn(|k| corner[k]));
        let n_cells = (planar.n_facets() as f64).powf(1.0 / (D - 1) as f64) as usize;
        let around = structured_box(low, high, [n_cells.clamp(2, MOST_CELLS); D]).map_err(|error| at.error(error))?;
        let cut = match CutMesh::overlay(&around, &[surface], &OverlayOptions::new()) {
            // Parts that share a vertex, or an edge in space, cut no fluid.
            Err(cutcell::Error::NonManifold { .. }) if setup.fluid.is_none() => continue,
            cut => cut.map_err(unsound)?,
        };
        let (enclosed, covered) = (surface.enclosed().volume, cut.covered_volume(&around));
        if (enclosed - covered).abs() > TWICE * covered {
            return Err(at.invalid(format!(
                "the surface of body `{name}` encloses {enclosed:.4e} (area or volume), but covers {covered:.4e}: parts of it overlap, or the same part \
                 is there twice; remove parts, or unite them"
            )));
        }
    }
    Ok(())
}

/// Checks that every movable body has a part in the domain, and others in the box around it, that no body covers the domain, and that no two bodies overlap.
pub(super) fn check_placement<const D: usize>(
    given: &[At<BodyKeys>],
    setup: &Setup<D>,
    fluid: &FluidSetup<D>,
    positions: &[Vec<Point<D>>],
) -> Result<(), ScenarioError> {
    let background = &fluid.background;
    let at = |k: usize| &given[k].shape.at;
    let domain = Aabb::of_points(background.vertices());
    let surfaces = setup.surfaces(positions);
    let covered =
        |k: usize, surfaces: &[Placed<'_, D>]| covered(background, surfaces).map_err(|error| at(k).error(error));
    let (alone, has_no_interface): (Vec<f64>, Vec<bool>) =
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
        // Prescribed bodies may enter later. A body that fills a part of the background has no interface.
        let is_beside = body.is_movable() && has_no_interface[k] && alone[k] <= ROUND_OFF * background.volume();
        if is_beside || !Aabb::of_points(positions).overlaps(&domain) {
            let name = body.name();
            let span = |Aabb { low, high }: Aabb<D>| format!("from {:?} to {:?}", low.as_slice(), high.as_slice());
            let (of_body, of_background) = (span(Aabb::of_points(positions)), span(domain));
            let message = format!(
                "body `{name}` is outside of the domain: the body extends {of_body}, the background {of_background}; \
                 move it, or enlarge the background; if a mesh file has another unit of length, give it a `scale`"
            );
            return Err(at(k).invalid(message));
        }
    }
    for a in 0..surfaces.len() {
        for b in a + 1..surfaces.len() {
            if !Aabb::of_points(&positions[a]).overlaps(&Aabb::of_points(&positions[b])) {
                continue;
            }
            let overlap = alone[a] + alone[b] - covered(b, &[surfaces[a], surfaces[b]])?.0;
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

/// Returns the volume of the background that surfaces cover, and whether they have no interface in it.
fn covered<const D: usize>(
    background: &SimplexMesh<D>,
    surfaces: &[Placed<'_, D>],
) -> Result<(f64, bool), cutcell::Error> {
    let cut = CutMesh::overlay(background, surfaces, &OverlayOptions::new().without_self_intersection_check())?;
    Ok((cut.covered_volume(background), cut.interface().is_empty()))
}

/// Describes pairs of bodies that overlap and have no contact with each other. A pair whose overlap cannot be computed
/// is left out.
pub(crate) fn overlapping<const D: usize>(setup: &Setup<D>, state: &State<D>) -> Vec<String> {
    let Some(fluid) = &setup.fluid else { return Vec::new() };
    let positions = setup.positions(&state.bodies);
    let (boxes, surfaces) = (positions.iter().map(Aabb::of_points).collect::<Vec<_>>(), setup.surfaces(&positions));
    let touch = |contact: &Contact<D>, pair: [usize; 2]| {
        let sides = [Some(contact.body()), contact.master()].map(|id| id.map(BodyId::index));
        pair.iter().all(|body| sides.contains(&Some(*body)))
    };
    let mut found = Vec::new();
    for pair in (0..boxes.len()).flat_map(|a| (a + 1..boxes.len()).map(move |b| [a, b])) {
        let [a, b] = pair;
        if !boxes[a].overlaps(&boxes[b]) || setup.contacts.iter().any(|contact| touch(contact, pair)) {
            continue;
        }
        let volume = |surfaces: &[Placed<'_, D>]| covered(&fluid.background, surfaces).map(|(volume, _)| volume);
        let volumes = [volume(&[surfaces[a]]), volume(&[surfaces[b]]), volume(&[surfaces[a], surfaces[b]])];
        if let [Ok(of_a), Ok(of_b), Ok(of_both)] = volumes
            && of_a + of_b - of_both > ROUND_OFF * of_a.min(of_b)
        {
            let [a, b] = pair.map(|body| setup.bodies[body].name());
            found.push(format!("bodies {a} and {b} overlap by {:.3e} (area or volume)", of_a + of_b - of_both));
        }
    }
    found
}

/// Largest difference of two planes that are the same: of normals of length one, and of distances from the origin
/// relative to the largest coordinate.
const SAME_PLANE: f64 = 1e-9;

/// Returns whether two obstacles at rest are equal, the same plane, walls with a part in common, or a plane and a wall
/// with a part on it.
fn overlap<const D: usize>(a: &ContactKeys, b: &ContactKeys, background: Option<&SimplexMesh<D>>) -> bool {
    let parts = |of: &ContactKeys| match of.obstacle.as_deref() {
        Some(ObstacleChoice::Wall { parts }) => parts.iter().map(|name| name.to_string()).collect(),
        _ => Vec::new(),
    };
    let plane = |of: &ContactKeys| match of.obstacle.as_deref() {
        Some(ObstacleChoice::RigidPlane { point, normal }) => {
            Some((point.vector(), normal.vector::<D>().try_normalize(0.0)?))
        }
        _ => None,
    };
    let is_on = |x: &Point<D>, (point, normal): &(Point<D>, Vector<D>)| {
        (x - point).dot(normal).abs() <= SAME_PLANE * x.amax().max(point.amax())
    };
    let is_wall_on = |names: &[String], plane: &(Point<D>, Vector<D>)| {
        let background =
            background.map(|background| (background, names.iter().filter_map(|name| background.tag(name))));
        background.is_some_and(|(background, mut tags)| {
            tags.any(|tag| tagged_vertices(background, tag).iter().all(|x| is_on(x, plane)))
        })
    };
    let (of_a, of_b) = (parts(a), parts(b));
    let planes = match (plane(a), plane(b)) {
        (Some(a), Some(b)) => is_on(&a.0, &b) && (a.1 - b.1).norm() <= SAME_PLANE,
        (Some(a), None) => is_wall_on(&of_b, &a),
        (None, Some(b)) => is_wall_on(&of_a, &b),
        (None, None) => false,
    };
    planes || a.obstacle == b.obstacle || of_a.iter().any(|name| of_b.contains(name))
}

/// Checks that no contact is stated twice. `of_contacts` has the table of each contact.
pub(super) fn check_repeated<const D: usize>(
    of_contacts: &[&At<ContactKeys>],
    setup: &Setup<D>,
) -> Result<(), ScenarioError> {
    let all: Vec<_> = of_contacts.iter().zip(&setup.contacts).collect();
    let background = setup.fluid.as_ref().map(|fluid| &fluid.background);
    for (k, (given, contact)) in all.iter().enumerate() {
        let is_same = |(other, found): &&(&&At<ContactKeys>, &Contact<D>)| {
            let bodies = |contact: &Contact<D>| contact.master().map(|master| [contact.body(), master]);
            match bodies(contact) {
                // Either body may be the slave.
                Some([slave, master]) => {
                    [[slave, master], [master, slave]].into_iter().any(|pair| bodies(found) == Some(pair))
                }
                None => found.master().is_none() && found.body() == contact.body() && overlap(given, other, background),
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

/// Depth of the points inside of a body that are compared with another one, relative to the contact size. All vertices
/// of a body may lie on the surface of another one that covers it.
const INSIDE: f64 = 1e-3;

/// Checks that no body begins behind the obstacle of one of its contacts. `of_contacts` has the table of each contact.
pub(super) fn check_contacts<const D: usize>(
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
        let behind = |body: usize, other: usize| {
            let surface = setup.bodies[body].surface();
            let of_other = Placed::new(setup.bodies[other].surface(), &positions[other]);
            let inside = |facet| of_other.facet_middle(facet) - INSIDE * given.size * of_other.facet_normal(facet);
            let points: Vec<_> =
                of_other.boundary().facets().map(inside).chain(positions[other].iter().copied()).collect();
            let obstacle = DeformableObstacle::new(surface.clone(), surface.facets().collect());
            obstacle.map(|obstacle| depth(&obstacle, &positions[body], &points)).map_err(|error| given.at.error(error))
        };
        let deepest = match contact.master().map(BodyId::index) {
            None => depth(contact.obstacle(), &[], &positions[slave]),
            // A body has gaps to itself only where it is deformed.
            Some(master) if master == slave => continue,
            Some(master) if !boxes[master].overlaps(&boxes[slave]) => continue,
            Some(master) => behind(master, slave)?.max(behind(slave, master)?),
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

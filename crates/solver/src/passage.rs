//! Check that no vertex passes through an obstacle in a step.

use contact::{Anchor, Positions, Projection};
use mesh::{FacetId, Placed, Point, Vector, VertexId, are_opposite};

use crate::Setup;
use crate::setup::Contact;

/// Largest number of points at which a path is tested.
const MOST_POINTS: usize = 64;
/// Gap at which a path enters the obstacle, as a fraction of the contact size.
const ENTERS: f64 = 1e-3;

/// Finds a vertex of the slave that passes through the obstacle: it begins in front of it, enters it, and its closest
/// side at the end faces the other way. Returns its motion relative to the obstacle. Contact would push such a vertex
/// out on the wrong side, or not act. Returns `None` if there is no such vertex, and for contact of a body with itself.
///
/// Motions up to the contact size are not tested: steps that resolve contact have such motions.
pub(crate) fn passage<const D: usize>(
    contact: &Contact<D>,
    setup: &Setup<D>,
    [start, end]: [&[Vec<Point<D>>]; 2],
    reach: f64,
) -> Option<f64> {
    if contact.master() == Some(contact.body()) {
        return None;
    }
    let body = contact.body().index();
    let (boundary, master) = (setup.bodies[body].surface(), contact.master().map(|id| id.index()));
    let size = contact.form().size();
    let moved = |body: usize, vertex: VertexId| end[body][vertex.index()] - start[body][vertex.index()];
    let largest = |body: usize| {
        let vertices = (0..start[body].len()).map(VertexId::new);
        vertices.map(|vertex| moved(body, vertex).norm()).fold(0.0, f64::max)
    };
    if largest(body) + master.map_or(0.0, largest) <= size {
        return None;
    }
    let opposite = master.map_or(&[][..], |master| &start[master]);
    let placed = Placed::new(boundary, &start[body]);
    let candidates = contact.obstacle().candidates(placed, contact.facets(), opposite, reach);
    let project = |x: &Point<D>, near: &[FacetId]| contact.obstacle().project(x, Positions::Fixed(opposite), near);
    contact.facets().iter().enumerate().find_map(|(index, &facet)| {
        let near = candidates.as_ref().map_or(&[][..], |of_facets| &of_facets[index]);
        boundary.facet(facet).iter().find_map(|&vertex| {
            let from = start[body][vertex.index()];
            let found = project(&from, near)?;
            let of_master = match (&found.anchor, master) {
                (Anchor::Facet { facet, shape, .. }, Some(master)) => {
                    let nodes = setup.bodies[master].surface().nodes(*facet).iter().zip(shape);
                    nodes.map(|(&node, share)| moved(master, node) * *share).sum()
                }
                _ => Vector::zeros(),
            };
            let path = moved(body, vertex) - of_master;
            passes(from, path, found, size, |x| project(x, near)).then(|| path.norm())
        })
    })
}

/// Returns whether a path that begins in front of the obstacle passes through it. The distance from each tested point
/// of the path to the next is that of the former from the obstacle, up to the point at which the path enters.
fn passes<const D: usize>(
    start: Point<D>,
    path: Vector<D>,
    at_start: Projection<D>,
    size: f64,
    project: impl Fn(&Point<D>) -> Option<Projection<D>>,
) -> bool {
    let length = path.norm();
    if length <= size {
        return false;
    }
    let (mut along, mut found) = (0.0, at_start);
    let at = |along: f64| start + path * (along / length);
    for point in 0..MOST_POINTS {
        let gap = found.gap(&at(along));
        if gap <= ENTERS * size {
            // A path that begins in the obstacle has entered it in an earlier step.
            if point == 0 && gap <= 0.0 || length - along <= size {
                return false;
            }
            return project(&at(length)).is_some_and(|end| are_opposite(&end.normal, &found.normal));
        }
        along += gap;
        if along >= length {
            return false;
        }
        let Some(next) = project(&at(along)) else { return false };
        found = next;
    }
    false
}

//! Checks that surfaces bound bodies.

use std::collections::HashMap;

use mesh::search::SurfaceIndex;
use mesh::{Aabb, BodyId, FacetId, Placed, VertexId};
use rayon::prelude::*;

use crate::exact::{HalfSpace, is_degenerate, pierces};
use crate::orientation::{check_orientation, in_space};
use crate::{Error, SurfaceVertex};

/// Largest ratio of the coordinates of a surface to those of the background. The relative accuracy of a facet decreases
/// in proportion.
pub const FARTHEST: f64 = 1e9;

/// Checks that a surface bounds a body.
///
/// # Errors
/// The surface is empty, open, non-manifold or oriented inwards, has facets that are turned against their neighbours or
/// vertices without a position, or has coordinates that are not finite or beyond a limit.
pub(crate) fn check_surface<const D: usize>(body: BodyId, surface: &Placed<'_, D>, limit: f64) -> Result<(), Error> {
    let boundary = surface.boundary();
    if boundary.n_facets() == 0 {
        return Err(Error::Empty { body });
    }
    let at = |facet: FacetId, vertex: VertexId| SurfaceVertex {
        body,
        facet,
        vertex,
        point: in_space(&surface.positions()[vertex.index()]),
    };
    // A rim is a facet without one of its vertices. The surface is closed if every rim occurs once in each direction.
    // For each rim: the sum of its directions, the number of its facets, and the first of them.
    let mut rims: HashMap<[VertexId; 2], (i32, u32, FacetId)> = HashMap::with_capacity(boundary.n_facets() * 2);
    for facet in boundary.facets() {
        let vertices = boundary.facet(facet);
        for &vertex in vertices {
            let n_positions = surface.positions().len();
            let missing = Error::MissingPosition { body, facet, vertex, n_positions };
            let x = surface.positions().get(vertex.index()).ok_or(missing)?;
            if x.iter().any(|c| !c.is_finite()) {
                return Err(Error::NotFinite { at: at(facet, vertex) });
            }
            if x.amax() > limit {
                return Err(Error::TooFar { at: at(facet, vertex), limit });
            }
        }
        for k in 0..D {
            let (key, sense) = match D {
                2 => ([vertices[k]; 2], if k == 0 { 1 } else { -1 }),
                _ => {
                    let (a, b) = (vertices[k], vertices[(k + 1) % D]);
                    if a < b { ([a, b], 1) } else { ([b, a], -1) }
                }
            };
            let rim = rims.entry(key).or_insert((0, 0, facet));
            rim.0 += sense;
            rim.1 += 1;
        }
    }
    let mut worst: Option<([VertexId; 2], (i32, u32, FacetId))> = None;
    for (key, rim) in rims {
        if (rim.0 != 0 || rim.1 != 2) && worst.is_none_or(|(k, _)| key < k) {
            worst = Some((key, rim));
        }
    }
    if let Some(([vertex, _], (_, count, facet))) = worst {
        let at = at(facet, vertex);
        return Err(match count {
            1 => Error::Open { at, twin: twin(surface, vertex) },
            2 => Error::Turned { at },
            _ => Error::NonManifold { at },
        });
    }
    check_orientation(body, surface)
}

/// Returns another vertex of a facet with the position of a vertex.
fn twin<const D: usize>(surface: &Placed<'_, D>, vertex: VertexId) -> Option<VertexId> {
    let (boundary, x) = (surface.boundary(), surface.positions());
    let vertices = boundary.facets().flat_map(|facet| boundary.facet(facet));
    vertices.copied().find(|other| *other != vertex && x[other.index()] == x[vertex.index()])
}

/// Depth up to which a surface may intersect itself, as a fraction of its size.
const DEPTH: f64 = 1e-9;

/// Checks that no side of a facet pierces another facet.
///
/// # Errors
/// [`Error::SelfIntersection`] for the first facet that is pierced.
pub(crate) fn check_self_intersections<const D: usize>(body: BodyId, surface: &Placed<'_, D>) -> Result<(), Error> {
    let boundary = surface.boundary();
    let index = SurfaceIndex::new(surface);
    let origin = surface.facet_points(FacetId(0))[0];
    let farthest =
        |facet: FacetId| surface.facet_points(facet)[..D].iter().fold(0.0, |r: f64, x| r.max((x - origin).amax()));
    let size = boundary.facets().map(farthest).fold(0.0, f64::max);
    (0..boundary.n_facets())
        .into_par_iter()
        .with_min_len(FACETS_PER_CHUNK)
        .map_init(Vec::new, |near, facet| piercing(surface, &index, FacetId::new(facet), DEPTH * size, near))
        .find_map_first(|found| found)
        .map_or(Ok(()), |(facet, other, point)| Err(Error::SelfIntersection { body, facet, other, point }))
}

/// Returns the facet, the first facet that pierces it by more than `depth`, and the location; `near` is a buffer.
fn piercing<const D: usize>(
    surface: &Placed<'_, D>,
    index: &SurfaceIndex<D>,
    facet: FacetId,
    depth: f64,
    near: &mut Vec<FacetId>,
) -> Option<(FacetId, FacetId, [f64; 3])> {
    let boundary = surface.boundary();
    let points = &surface.facet_points(facet)[..D];
    if is_degenerate(points) {
        return None;
    }
    let plane = HalfSpace::through(points);
    index.facets_overlapping(&Aabb::of_points(points), near);
    for &other in near.iter().filter(|&&other| other != facet) {
        let vertices = boundary.facet(other);
        // A segment has one side, a triangle three.
        for k in 0..if D > 2 { D } else { 1 } {
            let ends = [vertices[k], vertices[(k + 1) % D]];
            if ends.iter().any(|v| boundary.facet(facet).contains(v)) {
                continue;
            }
            let [a, b] = ends.map(|v| surface.positions()[v.index()]);
            let reach = plane.distance(&a).0.abs().min(plane.distance(&b).0.abs());
            if reach > depth && pierces(&a, &b, points) {
                return Some((facet, other, in_space(&((a + b) * 0.5))));
            }
        }
    }
    None
}

/// Smallest number of facets that a thread checks at once.
const FACETS_PER_CHUNK: usize = 128;

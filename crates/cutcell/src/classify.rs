//! Number of bodies around each vertex of the background.

use mesh::{Aabb, CellId, Point, SimplexMesh};

use crate::exact::{End, crossing};
use crate::surface::Facet;
use crate::touched::TouchedCells;

const UNKNOWN: i32 = i32::MIN;

/// Computes the number of bodies around each vertex of the background, exactly; vertices on a surface are shifted by an
/// infinitesimal.
///
/// For one vertex of each connected set of cells, counts crossings on a segment from a point outside all surfaces. For
/// the other vertices, follows edges of cells, on which the number changes only if facets touch the cell.
pub(crate) fn depths<const D: usize>(
    background: &SimplexMesh<D>,
    facets: &[Facet<D>],
    touched: &TouchedCells,
    depth: &mut Vec<i32>,
) {
    depth.clear();
    depth.resize(background.n_vertices(), UNKNOWN);
    let far = outside_of_everything(background, facets);
    // Neighbouring cells mostly have consecutive numbers, so that a few passes suffice.
    let mut waiting: Vec<CellId> = background.cells().collect();
    while let Some(&start) = waiting.first() {
        let first = background.cell(start)[0];
        if depth[first.index()] == UNKNOWN {
            let x = background.vertex(first);
            depth[first.index()] = facets.iter().map(|f| crossing(&far, End::Vertex(&x), f.points())).sum();
        }
        loop {
            let before = waiting.len();
            waiting.retain(|&cell| !spread(background, facets, touched, cell, depth));
            if waiting.len() == before || waiting.is_empty() {
                break;
            }
        }
    }
}

/// Computes the numbers of surrounding bodies at all vertices of a cell from a known number; returns whether one of the
/// numbers is known.
fn spread<const D: usize>(
    background: &SimplexMesh<D>,
    facets: &[Facet<D>],
    touched: &TouchedCells,
    cell: CellId,
    depth: &mut [i32],
) -> bool {
    let vertices = background.cell(cell);
    let Some(&known) = vertices.iter().find(|v| depth[v.index()] != UNKNOWN) else { return false };
    let from = background.vertex(known);
    for &vertex in vertices {
        if depth[vertex.index()] == UNKNOWN {
            let to = background.vertex(vertex);
            let change: i32 = touched.position(cell).map_or(0, |k| {
                touched.facets(k).iter().map(|&f| crossing(&from, End::Vertex(&to), facets[f as usize].points())).sum()
            });
            depth[vertex.index()] = depth[known.index()] + change;
        }
    }
    true
}

fn outside_of_everything<const D: usize>(background: &SimplexMesh<D>, facets: &[Facet<D>]) -> Point<D> {
    let of_background = Aabb::of_points(background.vertices());
    let bounds = facets.iter().fold(of_background, |bounds, facet| bounds.union(&facet.bounds));
    bounds.high + bounds.extent() + Point::repeat(1.0)
}

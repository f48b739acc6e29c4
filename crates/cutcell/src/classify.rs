//! How many bodies surround each vertex of the background.

use mesh::{CellId, Point, SimplexMesh, VertexId};

use crate::exact::{End, crossing};
use crate::surface::Facet;
use crate::touched::TouchedCells;

const UNKNOWN: i32 = i32::MIN;

/// Number of bodies around each vertex of the background, exact, with vertices on a surface shifted by an
/// infinitesimal.
///
/// One vertex of each connected set of cells is found by counting crossings on the way from a point outside of
/// everything; from there the number spreads along cell edges, which change it only where facets touch the cell.
pub(crate) fn depths<const D: usize>(
    background: &SimplexMesh<D>,
    facets: &[Facet<D>],
    touched: &TouchedCells,
    depth: &mut Vec<i32>,
) {
    depth.clear();
    depth.resize(background.n_vertices(), UNKNOWN);
    let far = outside_of_everything(background, facets);
    // Neighbouring cells mostly have neighbouring numbers: a few passes reach everything.
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

/// Gives all vertices of a cell their number from one that has it; returns whether there was one.
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
    let mut high = background.vertex(VertexId(0));
    let mut low = high;
    for x in background.vertices() {
        high = high.sup(x);
        low = low.inf(x);
    }
    for facet in facets {
        high = high.sup(&facet.high);
        low = low.inf(&facet.low);
    }
    high + (high - low) + Point::repeat(1.0)
}

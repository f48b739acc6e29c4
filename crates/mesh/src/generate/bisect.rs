//! Local refinement of bricks by bisection.

use std::collections::HashMap;

use super::size::affordable;
use crate::simplex::points_of;
use crate::{Error, MAX_CELL_VERTICES, Point, Simplex, SimplexMesh, VertexId};

/// A simplex with ordered vertices. The edge between the vertices 0 and `last` is bisected next.
#[derive(Clone, Copy)]
struct Ordered {
    vertices: [VertexId; MAX_CELL_VERTICES],
    last: usize,
}

/// Returns a mesh of bricks with cells bisected until none is too coarse. There are no tags in the result.
///
/// Bisects cells that are too coarse and cells with an edge that another cell has divided, until there are no such
/// cells. The result is therefore conforming. With the order of vertices of Kuhn's bricks the bisection ends, and the
/// descendants of a cell have a fixed number of shapes, however many there are (Maubach 1995, doi:10.1137/0916014).
pub(super) fn bisected<const D: usize>(
    bricks: &SimplexMesh<D>,
    is_too_coarse: impl Fn(&Simplex<D>) -> bool,
) -> Result<SimplexMesh<D>, Error> {
    let mut vertices = bricks.vertices().to_vec();
    let mut cells: Vec<Ordered> = bricks.cells().map(|cell| along_path(bricks.cell(cell))).collect();
    let mut middles = HashMap::new();
    loop {
        let mut finer = Vec::with_capacity(cells.len());
        for cell in &cells {
            let corners = &cell.vertices[..=D];
            let is_divided = || edges(corners).any(|edge| middles.contains_key(&edge));
            if is_too_coarse(&simplex(&vertices, corners)) || is_divided() {
                finer.extend(halves::<D>(cell, |[a, b]| {
                    *middles.entry(sorted([a, b])).or_insert_with(|| {
                        vertices.push(0.5 * (vertices[a.index()] + vertices[b.index()]));
                        VertexId::new(vertices.len() - 1)
                    })
                }));
            } else {
                finer.push(*cell);
            }
        }
        affordable(finer.len() as f64)?;
        let is_finished = finer.len() == cells.len();
        cells = finer;
        if is_finished {
            break;
        }
    }
    for cell in &mut cells {
        if simplex(&vertices, &cell.vertices[..=D]).volume() < 0.0 {
            cell.vertices.swap(D - 1, D);
        }
    }
    let cell_to_vertex = cells.iter().flat_map(|cell| cell.vertices[..=D].to_vec()).collect();
    SimplexMesh::new(vertices, cell_to_vertex)
}

/// Returns a simplex of a brick with its vertices in the order of Kuhn's path, which is the ascending order of ids.
fn along_path(cell: &[VertexId]) -> Ordered {
    let mut vertices = [cell[0]; MAX_CELL_VERTICES];
    vertices[..cell.len()].copy_from_slice(cell);
    vertices[..cell.len()].sort_unstable();
    Ordered { vertices, last: cell.len() - 1 }
}

/// Returns the halves of a simplex. `middle` maps an edge to its middle.
fn halves<const D: usize>(cell: &Ordered, middle: impl FnOnce([VertexId; 2]) -> VertexId) -> [Ordered; 2] {
    let Ordered { vertices, last } = *cell;
    let z = middle([vertices[0], vertices[last]]);
    let (mut lower, mut upper) = (vertices, vertices);
    lower[last] = z;
    upper.copy_within(1..=last, 0);
    upper[last] = z;
    let last = if last == 1 { D } else { last - 1 };
    [lower, upper].map(|vertices| Ordered { vertices, last })
}

fn edges(corners: &[VertexId]) -> impl Iterator<Item = [VertexId; 2]> {
    (0..corners.len()).flat_map(move |k| (0..k).map(move |l| sorted([corners[k], corners[l]])))
}

fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}

fn simplex<const D: usize>(vertices: &[Point<D>], corners: &[VertexId]) -> Simplex<D> {
    Simplex::new(&points_of::<D, MAX_CELL_VERTICES>(vertices, corners)[..=D])
}

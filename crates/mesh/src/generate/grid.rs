//! Boxes divided into bricks, and bricks into simplices.

use super::size::affordable;
use crate::{Error, ParameterError, Point, SimplexMesh, VertexId, positive, require};

/// Generates a box of `n[0] x n[1] (x n[2])` equal bricks, each divided by Kuhn's rule into 2 triangles or 6
/// tetrahedra.
///
/// All diagonals run from the lowest corner of a brick to its highest. Vertices are numbered with the first coordinate
/// fastest. Tags are those of [`super::graded_box`].
///
/// # Errors
/// [`Error::Parameter`]: a side without positive length, no bricks along an axis, or too many cells.
pub fn structured_box<const D: usize>(min: [f64; D], max: [f64; D], n: [usize; D]) -> Result<SimplexMesh<D>, Error> {
    check_sides(&min, &max)?;
    require(!n.contains(&0), "number of bricks along an axis", 0.0, "at least 1")?;
    affordable(n.iter().map(|&n| n as f64).product())?;
    brick_mesh(std::array::from_fn(|axis| evenly_divided(min[axis], max[axis], n[axis])))
}

/// Checks that every side of a box has positive, finite length.
pub(super) fn check_sides<const D: usize>(min: &[f64; D], max: &[f64; D]) -> Result<(), ParameterError> {
    for (a, b) in min.iter().zip(max) {
        positive("side of the box", b - a)?;
    }
    Ok(())
}

/// Generates the mesh of the bricks between the given coordinates along each axis.
pub(super) fn brick_mesh<const D: usize>(axes: [Vec<f64>; D]) -> Result<SimplexMesh<D>, Error> {
    let nodes: [usize; D] = std::array::from_fn(|axis| axes[axis].len());
    let bricks: [usize; D] = std::array::from_fn(|axis| nodes[axis] - 1);
    let mut stride = [1; D];
    for axis in 1..D {
        stride[axis] = stride[axis - 1] * nodes[axis - 1];
    }
    let vertices = (0..nodes.iter().product())
        .map(|index| {
            let at = multi_index(index, &nodes);
            Point::from_fn(|axis, _| axes[axis][at[axis]])
        })
        .collect();
    let paths = kuhn_paths::<D>();
    let mut cell_to_vertex = Vec::new();
    for index in 0..bricks.iter().product() {
        let at = multi_index(index, &bricks);
        let corner: usize = (0..D).map(|axis| at[axis] * stride[axis]).sum();
        for path in &paths {
            let offset = |corners: usize| (0..D).filter(|axis| corners >> axis & 1 == 1).map(|axis| stride[axis]).sum();
            cell_to_vertex.extend(path.iter().map(|&corners| {
                let offset: usize = offset(corners);
                VertexId::new(corner + offset)
            }));
        }
    }
    let min = std::array::from_fn(|axis| axes[axis][0]);
    let max = std::array::from_fn(|axis| axes[axis][nodes[axis] - 1]);
    Ok(with_side_tags(SimplexMesh::new(vertices, cell_to_vertex)?, min, max))
}

/// Returns the mesh with tags on the sides of the box; coordinates on a side must be exact.
pub(super) fn with_side_tags<const D: usize>(mesh: SimplexMesh<D>, min: [f64; D], max: [f64; D]) -> SimplexMesh<D> {
    mesh.with_boundary_tags(|points| {
        let on = |axis: usize, value: f64| points.iter().all(|x| x[axis] == value);
        (0..D).find_map(|axis| {
            let [low, high] = side_names::<D>(axis);
            if on(axis, min[axis]) {
                return Some(low);
            }
            on(axis, max[axis]).then_some(high)
        })
    })
}

/// Returns the names of the two sides of a box normal to an axis, the lower one first.
pub(super) fn side_names<const D: usize>(axis: usize) -> [&'static str; 2] {
    match (D, axis) {
        (_, 0) => ["left", "right"],
        (3, 1) => ["front", "back"],
        _ => ["bottom", "top"],
    }
}

fn evenly_divided(min: f64, max: f64, n: usize) -> Vec<f64> {
    let mut nodes: Vec<f64> = (0..=n).map(|i| min + (max - min) * (i as f64 / n as f64)).collect();
    nodes[n] = max;
    nodes
}

/// Returns the position of entry `index` in an array of the given shape, the first axis fastest.
fn multi_index<const D: usize>(mut index: usize, shape: &[usize; D]) -> [usize; D] {
    std::array::from_fn(|axis| {
        let at = index % shape[axis];
        index /= shape[axis];
        at
    })
}

/// Returns Kuhn's simplices of the unit cube, positively oriented: paths along edges from corner 0 to the opposite
/// corner. Bit `k` of a corner is its coordinate on axis `k`.
fn kuhn_paths<const D: usize>() -> Vec<Vec<usize>> {
    let mut paths = vec![vec![0_usize]];
    for _ in 0..D {
        paths = paths
            .iter()
            .flat_map(|path| {
                let last = path[path.len() - 1];
                (0..D)
                    .filter(move |axis| last >> axis & 1 == 0)
                    .map(move |axis| [path.as_slice(), &[last | 1 << axis]].concat())
            })
            .collect();
    }
    for path in &mut paths {
        let axes: Vec<u32> = path.windows(2).map(|pair| (pair[1] ^ pair[0]).trailing_zeros()).collect();
        let inversions = (0..D).map(|i| axes[i + 1..].iter().filter(|&&later| later < axes[i]).count()).sum::<usize>();
        if inversions % 2 == 1 {
            path.swap(D - 1, D);
        }
    }
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fills_the_box<const D: usize>(n: [usize; D]) {
        let min: [f64; D] = std::array::from_fn(|k| -0.3 * k as f64);
        let max: [f64; D] = std::array::from_fn(|k| 1.0 + k as f64);
        let mesh = structured_box(min, max, n).unwrap();
        let volume: f64 = mesh.cells().map(|c| mesh.cell_volume(c)).sum();
        let expected: f64 = min.iter().zip(&max).map(|(a, b)| b - a).product();
        assert!((volume - expected).abs() < 1e-13);
        let simplices: usize = (1..=D).product();
        assert_eq!(mesh.n_cells(), simplices * n.iter().product::<usize>());
        for axis in 0..D {
            let simplices = simplices / D;
            let across = simplices * n.iter().product::<usize>() / n[axis];
            for name in side_names::<D>(axis) {
                let tag = mesh.tag(name);
                assert!(tag.is_some());
                assert_eq!(mesh.facets().filter(|&f| mesh.facet_tag(f) == tag).count(), across);
            }
        }
        assert!(mesh.facets().all(|f| mesh.is_boundary(f) == mesh.facet_tag(f).is_some()));
    }

    #[test]
    fn bricks_fill_the_box_in_2d_and_3d() {
        fills_the_box::<2>([3, 5]);
        fills_the_box::<3>([2, 3, 4]);
    }

    #[test]
    fn invalid_boxes_are_errors() {
        assert!(structured_box([0.0, 0.0], [1.0, 0.0], [1, 1]).is_err());
        assert!(structured_box([0.0, f64::NAN], [1.0, 1.0], [1, 1]).is_err());
        assert!(structured_box([0.0, 0.0], [1.0, 1.0], [1, 0]).is_err());
        assert!(structured_box([0.0, 0.0], [1.0, 1.0], [1 << 40, 1 << 40]).is_err());
    }
}

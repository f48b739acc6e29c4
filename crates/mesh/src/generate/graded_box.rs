//! Boxes with cells that follow a size field.

use super::bisect::bisected;
use super::grid::{brick_mesh, check_sides, with_side_tags};
use super::region::Region;
use super::size::{MEAN_EDGE, Size, affordable, divided};
use super::triangulate::{Outline, filled};
use super::unit::Unit;
use crate::{Error, Point, SimplexMesh};

/// Generates a box with cells of the given size. Facets are tagged by side, and coordinates of vertices on a side are
/// exact.
///
/// In 2D, the mesh is an unstructured triangulation with angles of at least 25 degrees and the tags "left", "right"
/// (low and high `x`), "bottom", "top" (low and high `y`). In 3D, it consists of bricks divided into 6 tetrahedra each,
/// with the tags "left", "right", "front", "back" (low and high `y`), "bottom", "top"; bricks are graded along the axis
/// of a graded size, and have the finest size along the other axes.
///
/// Sizes are limited to the length of the shortest side. In 2D the mesh is the same in units that differ by a factor of
/// a hundred, such as those of cgs and SI.
///
/// # Errors
/// [`Error::Parameter`]: a side or a size that is not positive and finite, or too many cells.
pub fn graded_box<const D: usize>(min: [f64; D], max: [f64; D], size: &Size) -> Result<SimplexMesh<D>, Error> {
    refined_box(min, max, size, &[])
}

/// Generates a box as [`graded_box`] does, with finer cells near regions: the smallest of all sizes at a point is used.
///
/// In 2D, the triangulation follows the size everywhere, with angles of at least 25 degrees for a growth of up to 0.3
/// and of at least 20 degrees above it. In 3D, tetrahedra are bisected until their diameters are at most
/// those of the tetrahedra of a brick of the given size. Bisection gives tetrahedra of few shapes, whatever the ratio
/// of the sizes.
///
/// # Errors
/// [`Error::Parameter`]: as for [`graded_box`] and [`Region::check`].
pub fn refined_box<const D: usize>(
    min: [f64; D],
    max: [f64; D],
    size: &Size,
    regions: &[Region<D>],
) -> Result<SimplexMesh<D>, Error> {
    check_sides(&min, &max)?;
    size.check(D)?;
    for region in regions {
        region.check(min, max, size)?;
    }
    affordable(expected_cells(min, max, size, regions))?;
    let longest = min.iter().zip(&max).map(|(a, b)| b - a).fold(0.0, f64::max);
    let unit = Unit::of(longest);
    if D == 2 && !unit.is_caller_unit() {
        return in_unit(unit, min, max, size, regions);
    }
    let shortest = min.iter().zip(&max).map(|(a, b)| b - a).fold(f64::INFINITY, f64::min);
    let near = |x: &Point<D>| regions.iter().map(|region| region.at(x)).fold(f64::INFINITY, f64::min);
    match D {
        2 => triangulated(min, max, |x, y| {
            let there = Point::from_fn(|axis, _| [x, y][axis]);
            MEAN_EDGE * size.at(&there).min(shortest).min(near(&there))
        }),
        _ => {
            let mesh = bricks(min, max, size, shortest)?;
            if regions.is_empty() {
                return Ok(mesh);
            }
            let diagonal = (D as f64).sqrt();
            let mesh = bisected(&mesh, |cell| cell.diameter() > ROUND_OFF * diagonal * near(&cell.centroid()))?;
            Ok(with_side_tags(mesh, min, max))
        }
    }
}

/// Generates a box in another unit of length.
fn in_unit<const D: usize>(
    unit: Unit,
    min: [f64; D],
    max: [f64; D],
    size: &Size,
    regions: &[Region<D>],
) -> Result<SimplexMesh<D>, Error> {
    let [low, high] = [min, max].map(|corner| corner.map(|x| unit.of_length(x)));
    let regions: Vec<Region<D>> = regions.iter().map(|region| unit.of_region(region)).collect();
    let mesh = refined_box(low, high, &unit.of_size(size), &regions)?;
    let coordinate = |axis: usize, x: f64| match x {
        _ if x == low[axis] => min[axis],
        _ if x == high[axis] => max[axis],
        _ => unit.to_caller_unit(x),
    };
    mesh.mapped(|x| Point::from_fn(|axis, _| coordinate(axis, x[axis])))
}

/// Ratio of diameters that differ by round-off only.
const ROUND_OFF: f64 = 1.0 + 1e-9;

fn bricks<const D: usize>(min: [f64; D], max: [f64; D], size: &Size, most: f64) -> Result<SimplexMesh<D>, Error> {
    let mut axes: [Vec<f64>; D] = std::array::from_fn(|_| Vec::new());
    for (k, nodes) in axes.iter_mut().enumerate() {
        *nodes = divided(min[k], max[k], |x| {
            match *size {
                Size::Graded { axis, .. } if axis == k => size.along(|_| x),
                _ => size.finest(),
            }
            .min(most)
        })?;
    }
    affordable(brick_cells(&axes))?;
    brick_mesh(axes)
}

/// Returns the number of cells of a mesh of bricks, given the nodes along each axis.
fn brick_cells<const D: usize>(axes: &[Vec<f64>; D]) -> f64 {
    let in_brick: usize = (1..=D).product();
    axes.iter().map(|nodes| (nodes.len() - 1) as f64).product::<f64>() * in_brick as f64
}

/// Generates triangles with edges of mean length `h`.
fn triangulated<const D: usize>(
    min: [f64; D],
    max: [f64; D],
    h: impl Fn(f64, f64) -> f64,
) -> Result<SimplexMesh<D>, Error> {
    let [left, bottom, right, top] = [min[0], min[1], max[0], max[1]];
    let mut outline = Outline::default();
    outline.side(divided(left, right, |x| h(x, bottom))?.into_iter().map(|x| [x, bottom]));
    outline.side(divided(bottom, top, |y| h(right, y))?.into_iter().map(|y| [right, y]));
    outline.side(divided(left, right, |x| h(x, top))?.into_iter().rev().map(|x| [x, top]));
    outline.side(divided(bottom, top, |y| h(left, y))?.into_iter().rev().map(|y| [left, y]));
    Ok(with_side_tags(filled(outline, |[x, y]| h(x, y))?, min, max))
}

/// Estimates the number of cells of a [`refined_box`] by midpoint quadrature, without a mesh.
pub fn expected_cells<const D: usize>(min: [f64; D], max: [f64; D], size: &Size, regions: &[Region<D>]) -> f64 {
    expected_cells_where(min, max, size, regions, |_| true)
}

/// Estimates as [`expected_cells`] the number of cells in the part of a box where `is_inside` is true.
pub fn expected_cells_where<const D: usize>(
    min: [f64; D],
    max: [f64; D],
    size: &Size,
    regions: &[Region<D>],
    is_inside: impl Fn(&Point<D>) -> bool,
) -> f64 {
    // Number of samples along each axis, and of cells in a square or cube with the size of a cell as its side.
    let (samples, cells): (usize, f64) = match D {
        2 => (64, 4.0 / (3.0_f64.sqrt() * MEAN_EDGE.powi(2))),
        _ => (16, 6.0),
    };
    let shortest = min.iter().zip(&max).map(|(a, b)| b - a).fold(f64::INFINITY, f64::min);
    let step: [f64; D] = std::array::from_fn(|axis| (max[axis] - min[axis]) / samples as f64);
    let density = |k: usize| {
        let place = |axis: usize| (k / samples.pow(axis as u32) % samples) as f64 + 0.5;
        let x = Point::from_fn(|axis, _| min[axis] + place(axis) * step[axis]);
        if !is_inside(&x) {
            return 0.0;
        }
        let h = regions.iter().map(|region| region.at(&x)).fold(size.at(&x).min(shortest), f64::min);
        cells / h.powi(D as i32)
    };
    step.iter().product::<f64>() * (0..samples.pow(D as u32)).map(density).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::RegionShape;

    #[test]
    fn cells_of_bricks_are_counted() {
        let [x, y, z] = [3, 5, 6].map(|n: u32| (0..n).map(f64::from).collect::<Vec<_>>());
        let plane = [x.clone(), y.clone()];
        assert_eq!(brick_cells(&plane), brick_mesh(plane).unwrap().n_cells() as f64);
        let space = [x, y, z];
        assert_eq!(brick_cells(&space), brick_mesh(space).unwrap().n_cells() as f64);
    }

    #[test]
    fn the_number_of_cells_is_estimated() {
        let region = Region {
            shape: RegionShape::Segment { ends: [[1.0, 1.0].into(); 2], within: 0.3 },
            size: 0.03,
            growth: 0.3,
        };
        let size = Size::Graded { fine: 0.05, fine_until: 0.5, coarse: 0.2, coarse_from: 1.5, axis: 1 };
        let check = |found: usize, expected: f64| {
            assert!((found as f64 / expected - 1.0).abs() < 0.15, "{found} {expected}");
        };
        let mesh = refined_box([0.0, 0.0], [2.0, 2.0], &size, std::slice::from_ref(&region)).expect("a mesh");
        check(mesh.n_cells(), expected_cells([0.0, 0.0], [2.0, 2.0], &size, &[region]));
        let uniform = Size::uniform(0.1);
        let mesh = graded_box([0.0; 3], [1.0, 2.0, 0.5], &uniform).expect("a mesh");
        check(mesh.n_cells(), expected_cells([0.0; 3], [1.0, 2.0, 0.5], &uniform, &[]));
    }
}

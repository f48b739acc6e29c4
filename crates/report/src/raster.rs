//! Speed of the fluid on a raster of points, from the true polygons of the fluid.

use mesh::{Point, SimplexMesh, Vector};
use solver::FluidState;

/// Points in rows and columns of a rectangle, the first one half a step from its lower left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raster {
    /// Lower left corner of the rectangle.
    pub low: [f64; 2],
    /// Distances of columns and of rows.
    pub step: [f64; 2],
    /// Columns and rows.
    pub n: [usize; 2],
}

impl Raster {
    /// Creates a raster of a rectangle with about `longest` points along its longer side.
    pub(crate) fn new(low: [f64; 2], high: [f64; 2], longest: f64) -> Self {
        let step = (high[0] - low[0]).max(high[1] - low[1]) / longest;
        let n = [0, 1].map(|k| ((high[k] - low[k]) / step).round().max(1.0) as usize);
        Self { low, step: [0, 1].map(|k| (high[k] - low[k]) / n[k] as f64), n }
    }

    /// Returns the speed at the points that lie in the fluid, row by row from below. Dofs at vertices outside the fluid
    /// are extrapolations; they are used only to interpolate inside the fluid's polygons.
    pub(crate) fn speeds<const D: usize>(
        &self,
        background: &SimplexMesh<D>,
        fluid: &FluidState<D>,
    ) -> Vec<Option<f64>> {
        let mut found = vec![None; self.n[0] * self.n[1]];
        for (part, polygon) in io::vtk::fluid::fluid_polygons(background, &fluid.cut) {
            let simplex = background.simplex(fluid.cut.part_cell(part));
            let velocity = |x: &Point<D>| fluid.at(part, &simplex.barycentric(x).unwrap_or_default()).0;
            let corners: Vec<_> = polygon.iter().map(|x| ([x[0], x[1]], velocity(x))).collect();
            for k in 2..corners.len() {
                let triangle = [corners[0], corners[k - 1], corners[k]];
                self.for_each_point(triangle.map(|(x, _)| x), |at, shares| {
                    let u: Vector<D> = triangle.iter().zip(shares).map(|((_, u), share)| u * share).sum();
                    found[at] = Some(u.norm());
                });
            }
        }
        found
    }

    /// Visits the points inside a triangle, with their indices and barycentric coordinates.
    pub fn for_each_point(&self, corners: [[f64; 2]; 3], mut visit: impl FnMut(usize, [f64; 3])) {
        let range = |k: usize| {
            let at = |x: f64| (x - self.low[k]) / self.step[k] - 0.5;
            let low = corners.iter().map(|x| at(x[k])).fold(f64::INFINITY, f64::min).ceil().max(0.0);
            let high = corners.iter().map(|x| at(x[k])).fold(f64::NEG_INFINITY, f64::max).floor();
            (low as usize)..((high + 1.0).max(0.0) as usize).min(self.n[k])
        };
        for row in range(1) {
            for column in range(0) {
                let index = row * self.n[0] + column;
                if let Some(shares) = barycentric(corners, self.point(index)) {
                    visit(index, shares);
                }
            }
        }
    }

    /// Returns the point with an index.
    pub fn point(&self, index: usize) -> [f64; 2] {
        let at = |k: usize, i: usize| self.low[k] + (i as f64 + 0.5) * self.step[k];
        [at(0, index % self.n[0]), at(1, index / self.n[0])]
    }
}

/// Returns the barycentric coordinates of a point in a triangle; `None` outside.
fn barycentric([a, b, c]: [[f64; 2]; 3], x: [f64; 2]) -> Option<[f64; 3]> {
    let cross = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let area = cross(a, b, c);
    let l = [cross(x, b, c) / area, cross(x, c, a) / area, cross(x, a, b) / area];
    l.iter().all(|l| *l >= -1e-9).then_some(l)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_points_of_a_triangle_are_those_inside() {
        let raster = Raster::new([0.0, 0.0], [1.0, 1.0], 4.0);
        let mut seen = [false; 16];
        raster.for_each_point([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], |at, [a, b, c]| {
            let [x, y] = raster.point(at);
            assert!((b - x).abs() + (c - y).abs() + (a + b + c - 1.0).abs() < 1e-12);
            seen[at] = true;
        });
        for (at, seen) in seen.iter().enumerate() {
            let [x, y] = raster.point(at);
            assert_eq!(*seen, x + y <= 1.0 + 1e-9);
        }
    }
}

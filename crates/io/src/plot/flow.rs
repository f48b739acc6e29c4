//! Velocity and vorticity of the fluid on its true domain, for pictures.

use mesh::{Point, SimplexMesh, Vector};
use solver::FluidState;

use super::view::plane;
use crate::vtk::fluid::{curl, fluid_polygons};

/// The flow at a point of the fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FlowPoint {
    pub(super) x: [f64; 2],
    pub(super) velocity: [f64; 2],
    pub(super) vorticity: f64,
}

impl FlowPoint {
    pub(super) fn speed(&self) -> f64 {
        self.velocity[0].hypot(self.velocity[1])
    }
}

/// Triangles that fill the fluid domain. The polygons of cut cells end at the bodies, so no value is that of a node
/// outside the fluid: those are extrapolations.
pub(super) fn flow_triangles<const D: usize>(
    background: &SimplexMesh<D>,
    fluid: &FluidState<D>,
) -> Vec<[FlowPoint; 3]> {
    let vorticity = nodal_vorticity(background, fluid);
    let mut triangles = Vec::new();
    for (part, polygon) in fluid_polygons(background, &fluid.cut) {
        let simplex = background.simplex(fluid.cut.part_cell(part));
        let dofs = fluid.space.dofs(part);
        let flow = |x: &Point<D>| {
            let shape = simplex.barycentric(x).unwrap_or_default();
            let u: Vector<D> = dofs.iter().zip(shape).map(|(&k, n)| fluid.velocity[k as usize] * n).sum();
            let vorticity = dofs.iter().zip(shape).map(|(&k, n)| vorticity[k as usize] * n).sum();
            FlowPoint { x: plane(x), velocity: plane(&u), vorticity }
        };
        let corners: Vec<_> = polygon.iter().map(flow).collect();
        triangles.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]));
    }
    triangles
}

/// Means of the vorticity around each dof, weighted by the volume of fluid.
fn nodal_vorticity<const D: usize>(background: &SimplexMesh<D>, fluid: &FluidState<D>) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); fluid.space.len()];
    for part in fluid.cut.all_parts() {
        let weight = fluid.cut.part_volume(part);
        let value = curl(background, fluid, part, fluid.cut.part_cell(part))[2];
        for &dof in fluid.space.dofs(part) {
            let sum = &mut sums[dof as usize];
            *sum = (sum.0 + weight * value, sum.1 + weight);
        }
    }
    sums.into_iter().map(|(sum, weight)| if weight > 0.0 { sum / weight } else { 0.0 }).collect()
}

/// Points in rows and columns, `step` apart, the first half a step from the lower left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    pub(super) low: [f64; 2],
    pub(super) step: [f64; 2],
    pub(super) n: [usize; 2],
}

impl Lattice {
    /// Points about `step` apart in a rectangle.
    pub(super) fn new(low: [f64; 2], high: [f64; 2], step: f64) -> Self {
        let n = [0, 1].map(|k| ((high[k] - low[k]) / step).round().max(1.0) as usize);
        Self { low, step: [0, 1].map(|k| (high[k] - low[k]) / n[k] as f64), n }
    }

    /// The velocity at the points that lie in the fluid, row by row from below.
    pub(super) fn velocities(&self, triangles: &[[FlowPoint; 3]]) -> Vec<Option<[f64; 2]>> {
        let mut found = vec![None; self.n[0] * self.n[1]];
        for triangle in triangles {
            let corners = triangle.map(|corner| corner.x);
            let range = |k: usize| {
                let at = |x: f64| (x - self.low[k]) / self.step[k] - 0.5;
                let low = corners.iter().map(|x| at(x[k])).fold(f64::INFINITY, f64::min).ceil().max(0.0);
                let high = corners.iter().map(|x| at(x[k])).fold(f64::NEG_INFINITY, f64::max).floor();
                (low as usize)..((high + 1.0).max(0.0) as usize).min(self.n[k])
            };
            for row in range(1) {
                for column in range(0) {
                    let Some(l) = barycentric(corners, self.point(column, row)) else { continue };
                    let component = |k: usize| triangle.iter().zip(l).map(|(c, l)| c.velocity[k] * l).sum();
                    found[row * self.n[0] + column] = Some([component(0), component(1)]);
                }
            }
        }
        found
    }

    /// A point by column and row.
    pub(super) fn point(&self, column: usize, row: usize) -> [f64; 2] {
        let at = |k: usize, i: usize| self.low[k] + (i as f64 + 0.5) * self.step[k];
        [at(0, column), at(1, row)]
    }
}

/// Barycentric coordinates of a point in a triangle; none if it lies outside.
fn barycentric([a, b, c]: [[f64; 2]; 3], x: [f64; 2]) -> Option<[f64; 3]> {
    let cross = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let area = cross(a, b, c);
    let l = [cross(x, b, c) / area, cross(x, c, a) / area, cross(x, a, b) / area];
    l.iter().all(|l| *l >= -1e-9).then_some(l)
}

/// The segments of a level in triangles.
pub(super) fn level_segment(corners: [([f64; 2], f64); 3], level: f64) -> Option<[[f64; 2]; 2]> {
    let mut ends = Vec::with_capacity(2);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let ((a, va), (b, vb)) = (corners[i], corners[j]);
        let (va, vb) = (va - level, vb - level);
        if (va < 0.0) != (vb < 0.0) {
            let t = va / (va - vb);
            ends.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    <[[f64; 2]; 2]>::try_from(ends).ok()
}

/// The value that a fraction of all values do not exceed.
pub(super) fn quantile(values: &mut [f64], fraction: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = (values.len().saturating_sub(1) as f64 * fraction) as usize;
    values.get(at).copied().unwrap_or(0.0).max(1e-12)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_samples_a_linear_flow_and_nothing_outside() {
        let corner = |x: [f64; 2]| FlowPoint { x, velocity: [2.0 * x[0], x[1] - x[0]], vorticity: -1.0 };
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(corner);
        let lattice = Lattice::new([0.0, 0.0], [1.0, 1.0], 0.25);
        let found = lattice.velocities(&[triangle]);
        for row in 0..4 {
            for column in 0..4 {
                let [x, y] = lattice.point(column, row);
                let velocity = found[row * 4 + column];
                assert_eq!(velocity.is_some(), x + y <= 1.0 + 1e-9);
                assert!(velocity.is_none_or(|u| (u[0] - 2.0 * x).abs() + (u[1] - (y - x)).abs() < 1e-12));
            }
        }
    }

    #[test]
    fn a_level_crosses_a_triangle_on_two_edges() {
        let corners = [([0.0, 0.0], 0.0), ([1.0, 0.0], 1.0), ([0.0, 1.0], 0.0)];
        assert_eq!(level_segment(corners, 0.5), Some([[0.5, 0.0], [0.5, 0.5]]));
        assert_eq!(level_segment(corners, 2.0), None);
    }
}

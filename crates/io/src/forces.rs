//! What the fluid does to a body, and the space that the body takes.

use mesh::{Placed, Point, Vector};
use solver::StepView;

/// Force and torque of the fluid on a body in a step: sums over the pieces of the interface, on the geometry on which
/// the step was integrated.
///
/// Units (cgs, per unit depth in 2D): forces dyn/cm, torque dyn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidForce<const D: usize> {
    /// Integral of the mortar's traction, `∫ T^f n + γ_Σ μ/h (u - v)`: what the body feels in the discrete equations,
    /// and the residual of the fluid's equations tested with a rigid motion.
    pub total: Vector<D>,
    /// Integral of the fluid's traction `T^f n` alone; the difference vanishes under refinement.
    pub traction: Vector<D>,
    /// Torque of the mortar's traction about the centre of the body's area (3D: volume); in 2D only its third component is
    /// not zero.
    pub torque: [f64; 3],
}

impl<const D: usize> FluidForce<D> {
    /// The force on body `index`; `None` before the first step.
    pub fn new(view: &StepView<'_, D>, index: usize) -> Option<Self> {
        let report = view.report?;
        let fluid = &view.state.fluid;
        let boundary = view.setup.bodies[index].boundary();
        let (_, centre) = enclosed(&Placed::new(boundary, &fluid.positions[index]));
        let mut force = Self { total: Vector::zeros(), traction: Vector::zeros(), torque: [0.0; 3] };
        let pieces = fluid.cut.interface().iter().zip(&report.tractions);
        for (piece, traction) in pieces.filter(|(piece, _)| piece.body.index() == index) {
            force.total += traction.total() * piece.measure;
            force.traction += traction.fluid * piece.measure;
            for (sum, moment) in force.torque.iter_mut().zip(traction.moment(&centre)) {
                *sum += moment * piece.measure;
            }
        }
        Some(force)
    }
}

/// Area (3D: volume) inside of a closed surface, and its centre: sums over the pyramids between facets and a vertex.
pub(crate) fn enclosed<const D: usize>(surface: &Placed<'_, D>) -> (f64, Point<D>) {
    let apex = surface.positions().first().copied().unwrap_or_else(Point::zeros);
    let (mut volume, mut moment) = (0.0, Vector::<D>::zeros());
    for facet in surface.boundary().facets() {
        let corners = surface.facet_points(facet);
        // The scaled normal of a triangle has twice its area, that of a segment its length.
        let area = surface.facet_normal_scaled(facet) / (D - 1) as f64;
        let pyramid = area.dot(&(corners[0] - apex)) / D as f64;
        volume += pyramid;
        moment += (corners[..D].iter().sum::<Point<D>>() - apex * D as f64) * (pyramid / (D + 1) as f64);
    }
    (volume, apex + moment / volume)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::generate::structured_box;

    #[test]
    fn a_box_has_its_area_and_its_centre() {
        let mesh = structured_box::<2>([1.0, -2.0], [4.0, 0.0], [3, 2]).expect("a box");
        let (area, centre) = enclosed(&Placed::new(&mesh.boundary(), mesh.vertices()));
        assert!((area - 6.0).abs() < 1e-14 && (centre - Point::<2>::new(2.5, -1.0)).norm() < 1e-14);
        let mesh = structured_box::<3>([0.0, 0.0, 1.0], [1.0, 2.0, 4.0], [1, 2, 2]).expect("a box");
        let (volume, centre) = enclosed(&Placed::new(&mesh.boundary(), mesh.vertices()));
        assert!((volume - 6.0).abs() < 1e-14 && (centre - Point::<3>::new(0.5, 1.0, 2.5)).norm() < 1e-14);
    }
}

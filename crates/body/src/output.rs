//! Quantities of a body for reports and output files.

use mesh::{Point, Tensor, Vector, VertexId};
use nalgebra::Matrix3;

/// Energies, momenta and volume of a body in one configuration.
///
/// Per unit depth in the plane: energy per length, momentum per length, area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<const D: usize> {
    /// `1/2 ∫ ρ |v|²` with the consistent mass.
    pub kinetic_energy: f64,
    /// `∫ W(F)`.
    pub elastic_energy: f64,
    /// `-∫ ρ g·x`: potential of the body force, zero at the origin.
    pub potential_energy: f64,
    /// Mass.
    pub mass: f64,
    /// Centre of mass.
    pub centre_of_mass: Point<D>,
    /// `∫ ρ v`.
    pub momentum: Vector<D>,
    /// `∫ ρ a`; zero where accelerations are not known.
    pub momentum_rate: Vector<D>,
    /// `∫ ρ g`: the body force.
    pub body_force: Vector<D>,
    /// Volume: the integral of `det F` with the quadrature rule of the stress. Exact for linear elements, and in the
    /// plane.
    pub volume: f64,
    /// Smallest `det F` at the points where the stress is evaluated; a cell is inverted if it is not positive.
    pub smallest_volume_ratio: f64,
    /// Mean position of the vertices of the cell with the smallest `det F`.
    pub smallest_volume_at: Point<D>,
}

impl<const D: usize> Balance<D> {
    /// Returns the kinetic, elastic and potential energy together.
    pub fn energy(&self) -> f64 {
        self.kinetic_energy + self.elastic_energy + self.potential_energy
    }
}

/// Cells of a body with their stresses.
pub struct CellOutput<'a, const D: usize> {
    /// Vertices of the cells with stride `D + 1`, numbered as in [`crate::Body::reference`]. The linear parts of an
    /// element of order 2 are cells of their own.
    pub cell_to_vertex: &'a [VertexId],
    /// Stress in each cell.
    pub stress: Vec<CellStress<D>>,
}

impl<'a, const D: usize> CellOutput<'a, D> {
    /// Returns the vertices of each cell, `D + 1` of them.
    pub fn cells(&self) -> impl Iterator<Item = &'a [VertexId]> + use<'a, D> {
        self.cell_to_vertex.chunks_exact(D + 1)
    }
}

/// Cauchy stress in a cell. In 2D it is the stress of plane strain, which has a component normal to the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellStress<const D: usize> {
    /// Components in the plane in 2D, all components in 3D.
    pub cauchy: Tensor<D>,
    /// Stress normal to the plane in 2D; zero in 3D.
    pub out_of_plane: f64,
}

/// Number of dimensions of space. A body in the plane is a slice of a body in space.
const SPATIAL_DIMENSION: f64 = 3.0;

impl<const D: usize> CellStress<D> {
    /// Returns the pressure: minus a third of the trace of the spatial stress.
    pub fn pressure(&self) -> f64 {
        -(self.cauchy.trace() + self.out_of_plane) / SPATIAL_DIMENSION
    }

    /// Returns the spatial stress as nine components, row by row.
    pub fn spatial(&self) -> [f64; 9] {
        let n = SPATIAL_DIMENSION as usize;
        std::array::from_fn(|k| match (k / n, k % n) {
            (a, b) if a < D && b < D => self.cauchy[(a, b)],
            (a, b) if a == b => self.out_of_plane,
            _ => 0.0,
        })
    }

    /// Returns the principal stresses of the spatial stress, the largest tension first.
    pub fn principal(&self) -> [f64; 3] {
        let mut values: [f64; 3] = Matrix3::from_row_slice(&self.spatial()).symmetric_eigenvalues().into();
        values.sort_by(|a, b| b.total_cmp(a));
        values
    }

    /// Returns the von Mises stress `√(3/2 dev σ : dev σ)` of the spatial stress.
    pub fn von_mises(&self) -> f64 {
        let squares = self.cauchy.norm_squared() + self.out_of_plane.powi(2);
        (1.5 * (squares - SPATIAL_DIMENSION * self.pressure().powi(2)).max(0.0)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_stresses_of_a_turned_state() {
        // Tension 5 and pressure 1 along axes turned by 30 degrees, and 2 normal to the plane.
        let (sin, cos) = (0.5, 0.75_f64.sqrt());
        let turn = Tensor::<2>::new(cos, -sin, sin, cos);
        let cauchy = turn * Tensor::<2>::new(5.0, 0.0, 0.0, -1.0) * turn.transpose();
        let found = CellStress { cauchy, out_of_plane: 2.0 }.principal();
        assert!(
            found.iter().zip([5.0, 2.0, -1.0]).all(|(found, expected)| (found - expected).abs() < 1e-14),
            "{found:?}"
        );
    }
}

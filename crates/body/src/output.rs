//! Quantities of a body for reports and output files.

use mesh::{Point, Tensor, Vector, VertexId};

/// Energies, momenta and volume of a body in one configuration.
///
/// Units in the plane are per unit depth: energies energy/length, momentum mass/(length time)·length, volume area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance<const D: usize> {
    /// `1/2 (ρ v, v)` with the consistent mass.
    pub kinetic_energy: f64,
    /// `∫ W(F)`.
    pub elastic_energy: f64,
    /// `-(ρ g, x)`: potential of the body force, zero at the origin.
    pub potential_energy: f64,
    /// Mass.
    pub mass: f64,
    /// Centre of mass.
    pub centre_of_mass: Point<D>,
    /// `(ρ, v)`.
    pub momentum: Vector<D>,
    /// `(ρ, a)`; zero where accelerations are not known.
    pub momentum_rate: Vector<D>,
    /// `(ρ, g)`: the body force.
    pub body_force: Vector<D>,
    /// Volume: the integral of `det F` with the rule of the stress, exact for linear elements and in the plane.
    pub volume: f64,
    /// Smallest `det F` at the points where the stress is evaluated; a cell is inverted if it is not positive.
    pub smallest_volume_ratio: f64,
    /// Middle of the vertices of the cell with that ratio.
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
    /// Vertices of the cells, of stride `D + 1`, among those of [`crate::Body::reference`]. The parts of an element of higher order are cells.
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

/// Cauchy stress in a cell; in 2D of plane strain, with the stress normal to the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellStress<const D: usize> {
    /// Cauchy stress.
    pub cauchy: Tensor<D>,
    /// Stress normal to the plane in 2D; zero in 3D.
    pub out_of_plane: f64,
}

/// A body in the plane is a slice of a body in space.
const SPATIAL_DIMENSION: f64 = 3.0;

impl<const D: usize> CellStress<D> {
    /// Returns the pressure: minus a third of the trace of the spatial stress.
    pub fn pressure(&self) -> f64 {
        -(self.cauchy.trace() + self.out_of_plane) / SPATIAL_DIMENSION
    }

    /// Returns the von Mises stress `√(3/2 dev σ : dev σ)` of the spatial stress.
    pub fn von_mises(&self) -> f64 {
        let squares = self.cauchy.norm_squared() + self.out_of_plane.powi(2);
        (1.5 * (squares - SPATIAL_DIMENSION * self.pressure().powi(2)).max(0.0)).sqrt()
    }
}

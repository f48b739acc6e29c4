//! Energies, momentum, centre of mass and stresses of a body, for reports and output.

use mesh::{CellId, Point, Tensor, Vector};

use crate::kinematics::{cauchy_stress, deformation_gradient, gradient, volume_ratio};
use crate::{SolidForm, SolidMesh};

/// Energies, momenta and volume of a body in one configuration.
///
/// Units (cgs, per unit depth in 2D): energies erg/cm, momentum g/s, mass g/cm, volume cm².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyBalance<const D: usize> {
    /// `1/2 (ρ v, v)` with the consistent mass.
    pub kinetic_energy: f64,
    /// `∫ W(F)`.
    pub elastic_energy: f64,
    /// `-(ρ g, x)`: potential of the body force, zero at the origin.
    pub potential_energy: f64,
    /// Mass.
    pub mass: f64,
    /// Centre of mass of the deformed body.
    pub centre_of_mass: Point<D>,
    /// `(ρ, v)`.
    pub momentum: Vector<D>,
    /// Volume of the deformed body.
    pub volume: f64,
    /// Smallest `det F` of all cells; a cell is turned inside out when it is not positive.
    pub smallest_volume_ratio: f64,
}

impl<const D: usize> BodyBalance<D> {
    /// The balance of a body at given displacements and velocities, one of each per vertex.
    pub fn new(mesh: &SolidMesh<D>, form: &SolidForm<D>, displacement: &[Vector<D>], velocity: &[Vector<D>]) -> Self {
        debug_assert_eq!(displacement.len(), mesh.mesh().n_vertices());
        debug_assert_eq!(velocity.len(), mesh.mesh().n_vertices());
        let n = (D + 1) as f64;
        let mut balance = Self {
            kinetic_energy: 0.0,
            elastic_energy: 0.0,
            potential_energy: 0.0,
            mass: 0.0,
            centre_of_mass: Point::zeros(),
            momentum: Vector::zeros(),
            volume: 0.0,
            smallest_volume_ratio: f64::INFINITY,
        };
        for cell in mesh.mesh().cells() {
            let mass = form.inertia.density * mesh.volume(cell);
            let (mut sum_v, mut sum_x, mut sum_of_squares) = (Vector::<D>::zeros(), Vector::<D>::zeros(), 0.0);
            for v in mesh.mesh().cell(cell) {
                sum_v += velocity[v.index()];
                sum_of_squares += velocity[v.index()].norm_squared();
                sum_x += mesh.mesh().vertex(*v) + displacement[v.index()];
            }
            // Σ_ij m_ij v_i · v_j with m_ij = m (1 + δ_ij)/((D + 1)(D + 2)).
            balance.kinetic_energy += 0.5 * mass * (sum_v.norm_squared() + sum_of_squares) / (n * (n + 1.0));
            balance.momentum += sum_v * (mass / n);
            balance.centre_of_mass += sum_x * (mass / n);
            balance.mass += mass;
            let f = cell_deformation(mesh, cell, displacement);
            let ratio = volume_ratio(&f);
            balance.elastic_energy += mesh.volume(cell) * form.internal_work.material.energy_density(&f);
            balance.volume += mesh.volume(cell) * ratio;
            balance.smallest_volume_ratio = balance.smallest_volume_ratio.min(ratio);
        }
        balance.potential_energy = -form.body_force.acceleration.dot(&balance.centre_of_mass);
        balance.centre_of_mass /= balance.mass;
        balance
    }

    /// Kinetic, elastic and potential energy together.
    pub fn energy(&self) -> f64 {
        self.kinetic_energy + self.elastic_energy + self.potential_energy
    }
}

/// Cauchy stress in a cell; in 2D of plane strain, with the stress normal to the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellStress<const D: usize> {
    /// Cauchy stress, dyn/cm².
    pub cauchy: Tensor<D>,
    /// Stress normal to the plane in 2D; zero in 3D.
    pub out_of_plane: f64,
}

impl<const D: usize> CellStress<D> {
    /// Stress in a cell at given displacements of all vertices.
    pub fn new(mesh: &SolidMesh<D>, form: &SolidForm<D>, cell: CellId, displacement: &[Vector<D>]) -> Self {
        let material = &form.internal_work.material;
        let f = cell_deformation(mesh, cell, displacement);
        let out_of_plane = if D < SPATIAL_DIMENSION { material.out_of_plane_stress(&f) } else { 0.0 };
        Self { cauchy: cauchy_stress(&f, &material.first_piola(&f)), out_of_plane }
    }

    /// Pressure: minus a third of the trace of the stress in space.
    pub fn pressure(&self) -> f64 {
        -(self.cauchy.trace() + self.out_of_plane) / SPATIAL_DIMENSION as f64
    }

    /// Von Mises stress `√(3/2 dev σ : dev σ)` of the stress in space.
    pub fn von_mises(&self) -> f64 {
        let squares = self.cauchy.norm_squared() + self.out_of_plane.powi(2);
        (1.5 * (squares - SPATIAL_DIMENSION as f64 * self.pressure().powi(2)).max(0.0)).sqrt()
    }
}

/// A body in the plane is a slice of one in space.
const SPATIAL_DIMENSION: usize = 3;

fn cell_deformation<const D: usize>(mesh: &SolidMesh<D>, cell: CellId, displacement: &[Vector<D>]) -> Tensor<D> {
    let mut local = [Vector::zeros(); mesh::MAX_CELL_VERTICES];
    for (slot, v) in local.iter_mut().zip(mesh.mesh().cell(cell)) {
        *slot = displacement[v.index()];
    }
    deformation_gradient(&gradient(&local, mesh.gradients(cell)))
}

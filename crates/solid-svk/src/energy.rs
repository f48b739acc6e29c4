//! Balance and stresses of a body, for reports and output.

use body::{Balance, CellStress};
use mesh::{CellId, Point, Tensor, Vector, det};

use crate::kinematics::{cauchy_stress, deformation_gradient, gradient};
use crate::{SolidForm, SolidMesh};

/// Computes the balance of a body from one displacement and one velocity per vertex.
pub fn balance<const D: usize>(
    mesh: &SolidMesh<D>,
    form: &SolidForm<D>,
    displacement: &[Vector<D>],
    velocity: &[Vector<D>],
) -> Balance<D> {
    debug_assert_eq!(displacement.len(), mesh.mesh().n_vertices());
    debug_assert_eq!(velocity.len(), mesh.mesh().n_vertices());
    let n = (D + 1) as f64;
    let mut balance = Balance {
        kinetic_energy: 0.0,
        elastic_energy: 0.0,
        potential_energy: 0.0,
        mass: 0.0,
        centre_of_mass: Point::zeros(),
        momentum: Vector::zeros(),
        momentum_rate: Vector::zeros(),
        body_force: Vector::zeros(),
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
        let ratio = det(&f);
        balance.elastic_energy += mesh.volume(cell) * form.internal_work.material.energy_density(&f);
        balance.volume += mesh.volume(cell) * ratio;
        balance.smallest_volume_ratio = balance.smallest_volume_ratio.min(ratio);
    }
    balance.potential_energy = -form.body_force.acceleration.dot(&balance.centre_of_mass);
    balance.centre_of_mass /= balance.mass;
    balance.body_force = form.body_force.acceleration * balance.mass;
    balance
}

/// Computes the stress in a cell from the displacements of all vertices.
pub fn cell_stress<const D: usize>(
    mesh: &SolidMesh<D>,
    form: &SolidForm<D>,
    cell: CellId,
    displacement: &[Vector<D>],
) -> CellStress<D> {
    let material = &form.internal_work.material;
    let f = cell_deformation(mesh, cell, displacement);
    let out_of_plane = if D == 2 { material.out_of_plane_stress(&f) } else { 0.0 };
    CellStress { cauchy: cauchy_stress(&f, &material.first_piola(&f)), out_of_plane }
}

fn cell_deformation<const D: usize>(mesh: &SolidMesh<D>, cell: CellId, displacement: &[Vector<D>]) -> Tensor<D> {
    let mut local = [Vector::zeros(); mesh::MAX_CELL_VERTICES];
    for (slot, v) in local.iter_mut().zip(mesh.mesh().cell(cell)) {
        *slot = displacement[v.index()];
    }
    deformation_gradient(&gradient(&local, mesh.gradients(cell)))
}

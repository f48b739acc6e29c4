//! Balance and stresses of a body, for reports and output.

use body::{Balance, CellStress};
use mesh::{CellId, Point, Tensor, Vector, det};

use crate::kinematics::{cauchy_stress, deformation_gradient};
use crate::{SolidForm, SolidMesh};

/// Computes the balance of a body from one displacement and one velocity per node.
pub fn balance<const D: usize>(
    mesh: &SolidMesh<D>,
    form: &SolidForm<D>,
    displacement: &[Vector<D>],
    velocity: &[Vector<D>],
) -> Balance<D> {
    debug_assert_eq!(displacement.len(), mesh.nodes().len());
    debug_assert_eq!(velocity.len(), mesh.nodes().len());
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
        smallest_volume_at: Point::zeros(),
    };
    for cell in mesh.mesh().cells() {
        let (density, material) = (form.inertia.densities[mesh.group(cell)], form.material(mesh.group(cell)));
        let nodes = mesh.cell(cell);
        for (i, row) in nodes.iter().zip(mesh.mass(cell).chunks_exact(nodes.len())) {
            let mass = density * row.iter().sum::<f64>();
            let of_row: Vector<D> = nodes.iter().zip(row).map(|(j, m)| velocity[j.index()] * *m).sum();
            balance.kinetic_energy += 0.5 * density * velocity[i.index()].dot(&of_row);
            balance.momentum += velocity[i.index()] * mass;
            balance.centre_of_mass += (mesh.nodes()[i.index()] + displacement[i.index()]) * mass;
            balance.mass += mass;
        }
        for (weight, gradients) in mesh.points(cell) {
            let f = deformation(mesh, cell, gradients, displacement);
            let ratio = det(&f);
            balance.elastic_energy += weight * material.energy_density(&f);
            balance.volume += weight * ratio;
            // Not a number counts as inverted.
            if ratio < balance.smallest_volume_ratio || ratio.is_nan() {
                let vertices = &nodes[..=D];
                let positions = vertices.iter().map(|i| mesh.nodes()[i.index()] + displacement[i.index()]);
                balance.smallest_volume_at = positions.sum::<Vector<D>>() / vertices.len() as f64;
                balance.smallest_volume_ratio = ratio;
            }
        }
    }
    balance.potential_energy = -form.body_force.acceleration.dot(&balance.centre_of_mass);
    balance.centre_of_mass /= balance.mass;
    balance.body_force = form.body_force.acceleration * balance.mass;
    balance
}

/// Computes the stresses in the middles of all parts ([`SolidMesh::parts`]) from one displacement per node.
pub fn stresses<const D: usize>(
    mesh: &SolidMesh<D>,
    form: &SolidForm<D>,
    displacement: &[Vector<D>],
) -> Vec<CellStress<D>> {
    let in_part = |cell: CellId, part: usize| {
        let material = form.material(mesh.group(cell));
        let f = deformation(mesh, cell, &mesh.gradients_in_part(cell, part), displacement);
        let out_of_plane = if D == 2 { material.out_of_plane_stress(&f) } else { 0.0 };
        CellStress { cauchy: cauchy_stress(&f, &material.first_piola(&f)), out_of_plane }
    };
    let cells = mesh.mesh().cells();
    cells
        .flat_map(|cell| (0..mesh.n_parts_of_cell()).map(move |part| (cell, part)))
        .map(|(cell, part)| in_part(cell, part))
        .collect()
}

fn deformation<const D: usize>(
    mesh: &SolidMesh<D>,
    cell: CellId,
    gradients: &[Vector<D>],
    displacement: &[Vector<D>],
) -> Tensor<D> {
    let mut grad_d = Tensor::zeros();
    for (node, g) in mesh.cell(cell).iter().zip(gradients) {
        grad_d += displacement[node.index()] * g.transpose();
    }
    deformation_gradient(&grad_d)
}

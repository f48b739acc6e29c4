//! Balance and stresses of a body, for reports and output.

use body::{Balance, CellStress};
use mesh::{CellId, Point, Vector, VertexId};

use crate::{MAX_CELL_NODES, SolidForm, SolidMesh};

/// Computes the momentum of a body from one velocity per node, without the components that cancel over the whole body
/// ([`mesh::Coordinates::resultant`]). From accelerations it is the rate of the momentum.
pub fn momentum<const D: usize>(mesh: &SolidMesh<D>, form: &SolidForm<D>, velocity: &[Vector<D>]) -> Vector<D> {
    let mut momentum = Vector::zeros();
    for cell in mesh.mesh().cells() {
        let (density, nodes) = (form.inertia.densities[mesh.group(cell)], mesh.cell(cell));
        for (node, row) in nodes.iter().zip(mesh.mass(cell).chunks_exact(nodes.len())) {
            momentum += velocity[node.index()] * (density * row.iter().sum::<f64>());
        }
    }
    mesh.mesh().coordinates().resultant(momentum)
}

/// Computes the balance of a body from one displacement and one velocity per node. Its rate of momentum is zero.
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
        let of_cell = at_nodes(nodes, displacement);
        for point in mesh.points(cell) {
            let deformation = point.deformation(&of_cell[..nodes.len()]);
            let ratio = deformation.volume_ratio();
            balance.elastic_energy += point.weight * deformation.energy_density(material);
            balance.volume += point.weight * ratio;
            // NaN means an inverted cell.
            if ratio < balance.smallest_volume_ratio || ratio.is_nan() {
                let vertices = &nodes[..=D];
                let positions = vertices.iter().map(|i| mesh.nodes()[i.index()] + displacement[i.index()]);
                balance.smallest_volume_at = positions.sum::<Vector<D>>() / vertices.len() as f64;
                balance.smallest_volume_ratio = ratio;
            }
        }
    }
    let coordinates = mesh.mesh().coordinates();
    balance.momentum = coordinates.resultant(balance.momentum);
    balance.centre_of_mass = coordinates.resultant(balance.centre_of_mass);
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
        let nodes = mesh.cell(cell);
        let of_cell = at_nodes(nodes, displacement);
        let (cauchy, out_of_plane) = mesh.deformation_in_part(cell, part, &of_cell[..nodes.len()]).cauchy(material);
        CellStress { cauchy, out_of_plane }
    };
    let cells = mesh.mesh().cells();
    cells
        .flat_map(|cell| (0..mesh.n_parts_of_cell()).map(move |part| (cell, part)))
        .map(|(cell, part)| in_part(cell, part))
        .collect()
}

/// Returns the values of a field at the nodes of a cell; entries beyond them are zero.
fn at_nodes<const D: usize>(nodes: &[VertexId], values: &[Vector<D>]) -> [Vector<D>; MAX_CELL_NODES] {
    let mut local = [Vector::zeros(); MAX_CELL_NODES];
    local.iter_mut().zip(nodes).for_each(|(slot, node)| *slot = values[node.index()]);
    local
}

//! Redistribution of the mass of nodes that come into contact.

use mesh::{Point, Tensor, Vector, VertexId};

use crate::Order;
use crate::{Error, SolidMesh};

/// Smallest mass that a node may keep, relative to its lumped mass.
const SMALLEST_SHARE: f64 = 0.2;

/// Number of layers of cells over which the mass of a node is spread. Two layers suffice to keep the first moments.
/// With three, the correction takes less mass from the farthest nodes.
const REACH: usize = 3;

/// Share of a node in the mass of a group of cells, for unit density.
#[derive(Clone, Copy)]
struct Share {
    node: VertexId,
    group: usize,
    mass: f64,
    /// Index of the diagonal entry of the node in [`SolidMesh::masses_mut`], in one of its cells of the group.
    entry: usize,
}

impl<const D: usize> SolidMesh<D> {
    /// Moves the mass of the given nodes, such as those that may come into contact, to their neighbours. Returns the
    /// body, and whether the first moments of the mass are kept.
    ///
    /// Nodes in contact that have mass exchange their momentum in one step, and the pressure of contact oscillates.
    /// Nodes without mass follow their neighbours without inertia.
    ///
    /// The mass of such a node goes to the nodes of its group that have mass and are at most three cells away, in
    /// proportion to their masses `m_j`. Then the masses of all receivers of a group change by `m_j b·(X_j - X)`, with
    /// the centre `X` of these masses and `b` such that the first moments of the group are kept. This correction is
    /// omitted if a node would keep less than a fifth of its mass. The total mass is always kept.
    ///
    /// Cells whose nodes are all at most three cells away from a massless node have lumped masses. The others keep
    /// their consistent masses, with which waves are faster and closer to the exact speed.
    ///
    /// Source: Khenous, Laborde and Renard 2008, Mass redistribution method for finite element contact problems in
    /// elastodynamics, doi:10.1016/j.euromechsol.2008.01.001. The masses of this method are one solution of their
    /// conditions on mass and first moments.
    ///
    /// # Errors
    /// [`Error::MassOfOrder`]: elements of order 2, whose vertices have no positive lumped mass.
    /// [`Error::UnknownVertex`]: a node does not exist. [`Error::NoMassNear`]: a node has no neighbours with mass.
    pub fn without_mass_at(mut self, nodes: &[VertexId]) -> Result<(Self, bool), Error> {
        if self.order() != Order::Linear {
            return Err(Error::MassOfOrder);
        }
        let n_vertices = self.nodes().len();
        let mut is_massless = vec![false; n_vertices];
        for &vertex in nodes {
            *is_massless.get_mut(vertex.index()).ok_or(Error::UnknownVertex { vertex, n_vertices })? = true;
        }
        let neighbours = self.neighbours();
        let shares = self.lump(&within_reach(nodes.to_vec(), &neighbours));
        let mut changes = vec![0.0; shares.len()];
        for share in shares.iter().filter(|share| is_massless[share.node.index()]) {
            let near = near(share, &shares, &neighbours, |node: VertexId| !is_massless[node.index()]);
            let total: f64 = near.iter().map(|k| shares[*k].mass).sum();
            if near.is_empty() {
                return Err(Error::NoMassNear { vertex: share.node });
            }
            near.iter().for_each(|k| changes[*k] += share.mass * shares[*k].mass / total);
        }
        let mut keeps_moments = true;
        for group in 0..self.n_groups() {
            let corrections = self.corrections(group, &shares, &changes, &is_massless);
            let keeps_mass = |(k, correction): &(usize, f64)| {
                shares[*k].mass + changes[*k] + correction >= SMALLEST_SHARE * shares[*k].mass
            };
            match corrections.filter(|corrections| corrections.iter().all(keeps_mass)) {
                Some(corrections) => corrections.into_iter().for_each(|(k, correction)| changes[k] += correction),
                None => keeps_moments = false,
            }
        }
        self.change_masses(&shares, &changes, &is_massless);
        Ok((self, keeps_moments))
    }

    /// Returns index of the share and correction `m_j b·(X_j - X)` for each receiver of a group, with `b` such that the
    /// first moments are kept; `None` if the receivers do not span the space.
    fn corrections(
        &self,
        group: usize,
        shares: &[Share],
        changes: &[f64],
        is_massless: &[bool],
    ) -> Option<Vec<(usize, f64)>> {
        let of_group = || shares.iter().zip(changes).enumerate().filter(|(_, (share, _))| share.group == group);
        let at = |share: &Share| self.nodes()[share.node.index()];
        let receivers: Vec<(usize, Point<D>, f64)> = of_group()
            .filter(|(_, (_, change))| **change > 0.0)
            .map(|(k, (share, _))| (k, at(share), share.mass))
            .collect();
        if receivers.is_empty() {
            return Some(Vec::new());
        }
        let moved = |(_, (share, change)): (usize, (&Share, &f64))| {
            at(share) * (if is_massless[share.node.index()] { share.mass } else { -change })
        };
        // First moment of the masses that are removed minus that of the changes.
        let missing: Vector<D> = of_group().map(moved).sum();
        let total: f64 = receivers.iter().map(|(_, _, mass)| mass).sum();
        let centre: Point<D> = receivers.iter().map(|(_, x, mass)| x * (mass / total)).sum();
        let second = |(_, x, mass): &(usize, Point<D>, f64)| (x - centre) * (x - centre).transpose() * *mass;
        let slope = receivers.iter().map(second).sum::<Tensor<D>>().try_inverse()? * missing;
        Some(receivers.iter().map(|(k, x, mass)| (*k, mass * slope.dot(&(x - centre)))).collect())
    }

    /// Lumps the masses of the cells whose nodes are all in `within`, a sorted list. Returns the mass of each node in
    /// these cells, one entry per node and group, sorted by node, then group.
    fn lump(&mut self, within: &[VertexId]) -> Vec<Share> {
        let n = D + 1;
        let mut shares = Vec::new();
        for cell in self.mesh().cells() {
            if self.cell(cell).iter().any(|node| within.binary_search(node).is_err()) {
                continue;
            }
            let first = cell.index() * n * n;
            let rows: Vec<f64> = self.mass(cell).chunks_exact(n).map(|row| row.iter().sum()).collect();
            self.masses_mut()[first..first + n * n].fill(0.0);
            for (i, mass) in rows.into_iter().enumerate() {
                let entry = first + i * (n + 1);
                self.masses_mut()[entry] = mass;
                shares.push(Share { node: self.cell(cell)[i], group: self.group(cell), mass, entry });
            }
        }
        shares.sort_by_key(|share| (share.node, share.group, share.entry));
        shares.dedup_by(|next, kept| {
            let is_same = (next.node, next.group) == (kept.node, kept.group);
            kept.mass += if is_same { next.mass } else { 0.0 };
            is_same
        });
        shares
    }

    /// Returns for each node the nodes of its cells, the node itself included, sorted.
    fn neighbours(&self) -> Vec<Vec<VertexId>> {
        let mut neighbours = vec![Vec::new(); self.nodes().len()];
        for cell in self.mesh().cells() {
            for node in self.cell(cell) {
                neighbours[node.index()].extend_from_slice(self.cell(cell));
            }
        }
        for of_node in &mut neighbours {
            of_node.sort();
            of_node.dedup();
        }
        neighbours
    }

    /// Sets the mass of massless nodes to zero. Adds the change of each other node to the entry of its share.
    fn change_masses(&mut self, shares: &[Share], changes: &[f64], is_massless: &[bool]) {
        let n = D + 1;
        for cell in self.mesh().cells() {
            for i in 0..n {
                if is_massless[self.cell(cell)[i].index()] {
                    self.masses_mut()[cell.index() * n * n + i * (n + 1)] = 0.0;
                }
            }
        }
        shares.iter().zip(changes).for_each(|(share, change)| self.masses_mut()[share.entry] += change);
    }
}

/// Returns the indices in `shares` of the nodes that are at most [`REACH`] cells away from the node of `of`, have mass
/// in the same group, and fulfil a condition.
fn near(
    of: &Share,
    shares: &[Share],
    neighbours: &[Vec<VertexId>],
    condition: impl Fn(VertexId) -> bool,
) -> Vec<usize> {
    let nodes = within_reach(vec![of.node], neighbours);
    let of_node = |node: VertexId| shares.binary_search_by_key(&(node, of.group), |share| (share.node, share.group));
    nodes.into_iter().filter(|node| condition(*node)).filter_map(|node| of_node(node).ok()).collect()
}

/// Returns the nodes that are at most [`REACH`] cells away from any of the given nodes, sorted.
fn within_reach(mut nodes: Vec<VertexId>, neighbours: &[Vec<VertexId>]) -> Vec<VertexId> {
    for _ in 0..REACH {
        nodes = nodes.iter().flat_map(|node| &neighbours[node.index()]).copied().collect();
        nodes.sort();
        nodes.dedup();
    }
    nodes
}

#[cfg(test)]
mod tests {
    use mesh::generate::structured_box;

    use super::*;

    /// Returns the total mass, its first moments, and the mass of each node.
    fn moments<const D: usize>(solid: &SolidMesh<D>) -> (f64, Vector<D>, Vec<f64>) {
        let mut masses = vec![0.0; solid.nodes().len()];
        for cell in solid.mesh().cells() {
            for (node, row) in solid.cell(cell).iter().zip(solid.mass(cell).chunks_exact(D + 1)) {
                masses[node.index()] += row.iter().sum::<f64>();
            }
        }
        let first = solid.nodes().iter().zip(&masses).map(|(x, m)| x * *m).sum();
        (masses.iter().sum(), first, masses)
    }

    fn bottom_without_mass<const D: usize>(n: [usize; D]) {
        let mut corner = [1.0; D];
        corner[D - 1] = 0.7;
        let solid = SolidMesh::new(structured_box::<D>([0.0; D], corner, n).unwrap()).unwrap();
        let bottom: Vec<VertexId> =
            (0..solid.nodes().len()).map(VertexId::new).filter(|v| solid.nodes()[v.index()][D - 1] == 0.0).collect();
        let (mass, first, _) = moments(&solid);
        let (changed, keeps_moments) = solid.without_mass_at(&bottom).unwrap();
        let (mass_after, first_after, masses) = moments(&changed);
        assert!(keeps_moments);
        let before = SolidMesh::new(structured_box::<D>([0.0; D], corner, n).unwrap()).unwrap();
        for cell in changed.mesh().cells() {
            let height = |v: &VertexId| changed.nodes()[v.index()][D - 1] * n[D - 1] as f64 / 0.7;
            let layers = changed.cell(cell).iter().map(height).fold(0.0, f64::max).round() as usize;
            let off_diagonal = (1..=D).any(|k| changed.mass(cell)[k] != 0.0);
            assert_eq!(off_diagonal, layers > REACH, "masses are lumped near the floor only");
            assert!(layers <= REACH || changed.mass(cell) == before.mass(cell));
        }
        assert!((mass_after - mass).abs() < 1e-14 && (first_after - first).norm() < 1e-14, "{first_after} {first}");
        assert!(bottom.iter().all(|v| masses[v.index()] == 0.0));
        assert!((0..masses.len()).all(|k| masses[k] > 0.0 || bottom.contains(&VertexId::new(k))));
    }

    #[test]
    fn mass_and_moments_are_kept() {
        bottom_without_mass::<2>([5, 6]);
        bottom_without_mass::<3>([3, 2, 6]);
    }

    #[test]
    fn without_neighbours_the_error_names_the_node() {
        let block = || structured_box::<2>([0.0, 0.0], [1.0, 1.0], [1, 1]).unwrap();
        let all: Vec<VertexId> = (0..4).map(VertexId::new).collect();
        let error = SolidMesh::new(block()).unwrap().without_mass_at(&all).unwrap_err();
        assert!(matches!(error, Error::NoMassNear { .. }));
        let quadratic = SolidMesh::of_order(block(), Order::Quadratic).unwrap();
        assert_eq!(quadratic.without_mass_at(&[]).unwrap_err(), Error::MassOfOrder);
        let unknown = SolidMesh::new(block()).unwrap().without_mass_at(&[VertexId::new(4)]).unwrap_err();
        assert!(matches!(unknown, Error::UnknownVertex { .. }));
    }
}

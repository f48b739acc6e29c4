//! Pockets of fluid whose pressure is known up to a constant only.

use std::collections::BTreeMap;

use algebra::{BlockLayout, Constraints};
use cutcell::{InterfacePiece, PartId};
use solid_rigid::modes::{mode, n_modes};
use xfem_space::Classes;

use crate::setup::FluidBoundary;
use crate::{BodyUnknown, Motion, Setup, StepGeometry};

/// A connected set of parts that the fluid cannot leave, whose pressure is known up to a constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Pocket {
    /// The parts.
    pub parts: Vec<PartId>,
    /// The pressure dof that stands for the constant.
    pub dof: u32,
    /// Other such sets of parts, with the factor with which the constant goes on there: behind a free piston, to which only the
    /// difference of pressures matters.
    pub behind: Vec<(Vec<PartId>, f64)>,
}

/// The pockets of a step: wherever walls and bodies enclose the fluid and nothing knows the constant of its pressure.
///
/// An open boundary knows the constant, and an elastic body does, as it can change its volume. Rigid bodies know as many constants as
/// there are independent ways in which they can change volumes: constants `c` of the sets of parts are unknown if they do no work,
/// `Σ c_p (n, mode)_p = 0` for every free rigid velocity. A body that the fluid is all around knows none, a piston one of two.
pub fn pockets<const D: usize>(
    setup: &Setup<D>,
    geometry: &StepGeometry<D>,
    layout: &BlockLayout,
    bodies: &[Option<BodyUnknown<D>>],
    constraints: &Constraints,
) -> Vec<Pocket> {
    let cut = &geometry.cut;
    let mut classes = Classes::new(cut.n_parts());
    for face in cut.part_faces() {
        classes.merge(face.parts[0].0, face.parts[1].0);
    }
    let mut is_fixed = vec![false; cut.n_parts()];
    for piece in cut.boundary() {
        let tag = setup.background.facet_tag(piece.facet);
        let condition = setup.fluid.boundary.iter().find(|(t, _)| Some(*t) == tag).map(|(_, condition)| condition);
        if matches!(condition, None | Some(FluidBoundary::Open { .. })) {
            is_fixed[classes.lowest(piece.part.0) as usize] = true;
        }
    }
    for piece in cut.interface() {
        if gives_way(setup, piece, layout, bodies, constraints) {
            is_fixed[classes.lowest(piece.part.0) as usize] = true;
        }
    }
    let mut enclosed: Vec<(u32, Vec<PartId>)> = Vec::new();
    for part in cut.all_parts() {
        let root = classes.lowest(part.0);
        if is_fixed[root as usize] {
            continue;
        }
        match enclosed.iter_mut().find(|(r, _)| *r == root) {
            Some((_, parts)) => parts.push(part),
            None => enclosed.push((root, vec![part])),
        }
    }
    let number = |part: PartId| {
        let root = classes.lowest(part.0);
        enclosed.iter().position(|(r, _)| *r == root)
    };
    let flows = rigid_flows(geometry, layout, bodies, constraints, enclosed.len(), number);
    let unknown = null_vectors(flows, enclosed.len()).into_iter().map(|(own, others)| Pocket {
        parts: enclosed[own].1.clone(),
        dof: geometry.space.dofs(enclosed[own].1[0])[0],
        behind: others.into_iter().map(|(k, factor)| (enclosed[k].1.clone(), factor)).collect(),
    });
    unknown.collect()
}

/// What is no flow at all, relative to what would flow head-on: a cut is accepted with holes of a tenth of this.
const CLOSED: f64 = 1e-5;

/// Flows of the free rigid velocities out of enclosed sets of parts: one row for each velocity that has a flow somewhere.
fn rigid_flows<const D: usize>(
    geometry: &StepGeometry<D>,
    layout: &BlockLayout,
    bodies: &[Option<BodyUnknown<D>>],
    constraints: &Constraints,
    n_enclosed: usize,
    mut number: impl FnMut(PartId) -> Option<usize>,
) -> Vec<Vec<f64>> {
    let mut flows: BTreeMap<(usize, usize), Vec<[f64; 2]>> = BTreeMap::new();
    for (item, piece) in geometry.cut.interface().iter().enumerate() {
        let body = piece.body.index();
        let Some(BodyUnknown { motion: Motion::Rigid { step, unknowns }, .. }) = &bodies[body] else { continue };
        let Some(set) = number(piece.part) else { continue };
        let is_free = |m: &usize| constraints.get(layout.dof(*unknowns, *m)).is_none();
        for m in (0..n_modes(D)).filter(is_free) {
            let of_mode = flows.entry((body, m)).or_insert_with(|| vec![[0.0; 2]; n_enclosed]);
            let [flow, largest] = &mut of_mode[set];
            for at in geometry.pieces.points(item) {
                let velocity = mode(m, &(at.point - step.centre()));
                *flow += at.weight * velocity.dot(&piece.normal);
                *largest += at.weight * velocity.norm();
            }
        }
    }
    let cleaned = |[flow, largest]: [f64; 2]| if flow.abs() > CLOSED * largest { flow } else { 0.0 };
    let rows = flows.into_values().map(|row| row.into_iter().map(cleaned).collect::<Vec<_>>());
    rows.filter(|row| row.iter().any(|flow| *flow != 0.0)).collect()
}

/// A basis of the vectors with `n` entries that are orthogonal to all rows: for each the entry that is one and in no other vector, and
/// the others that are not zero.
fn null_vectors(mut rows: Vec<Vec<f64>>, n: usize) -> Vec<(usize, Vec<(usize, f64)>)> {
    for row in &mut rows {
        let largest = row.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        row.iter_mut().for_each(|x| *x /= largest);
    }
    // Gauss and Jordan: `pivots[k]` is the column of row k.
    let mut pivots: Vec<usize> = Vec::new();
    for column in 0..n {
        let first = pivots.len();
        let best = (first..rows.len()).max_by(|&i, &j| rows[i][column].abs().total_cmp(&rows[j][column].abs()));
        let Some(best) = best.filter(|&row| rows[row][column].abs() > CLOSED) else { continue };
        rows.swap(first, best);
        let pivot = rows[first][column];
        rows[first].iter_mut().for_each(|x| *x /= pivot);
        let source = rows[first].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != first) {
            let factor = row[column];
            row.iter_mut().zip(&source).for_each(|(x, s)| *x -= factor * s);
        }
        pivots.push(column);
    }
    let free = (0..n).filter(|column| !pivots.contains(column));
    let others = |column: usize| {
        let entries = pivots.iter().zip(&rows).map(|(&pivot, row)| (pivot, -row[column]));
        entries.filter(|(_, factor)| *factor != 0.0).collect()
    };
    free.map(|column| (column, others(column))).collect()
}

/// Whether some vertex of the facet behind a piece is free to move along the normal, by itself.
fn gives_way<const D: usize>(
    setup: &Setup<D>,
    piece: &InterfacePiece<D>,
    layout: &BlockLayout,
    bodies: &[Option<BodyUnknown<D>>],
    constraints: &Constraints,
) -> bool {
    let Some(BodyUnknown { field, motion: Motion::Elastic(_), .. }) = &bodies[piece.body.index()] else {
        return false;
    };
    let vertices = setup.bodies[piece.body.index()].boundary().facet(piece.facet);
    vertices.iter().any(|vertex| {
        (0..D).any(|a| {
            let is_free = constraints.get(layout.dof(*field, D * vertex.index() + a)).is_none();
            is_free && piece.normal[a].abs() > f64::EPSILON
        })
    })
}

impl Pocket {
    /// Shifts the pressure so that its mean over the pocket is zero.
    pub(crate) fn remove_mean<const D: usize>(&self, geometry: &StepGeometry<D>, pressure: &mut [f64]) {
        let (mut integral, mut volume) = (0.0, 0.0);
        for &part in &self.parts {
            let of_part = geometry.space.dofs(part);
            for q in geometry.parts.points(part) {
                let p: f64 = of_part.iter().zip(&q.shape).map(|(&dof, n)| pressure[dof as usize] * n).sum();
                integral += q.weight * p;
                volume += q.weight;
            }
        }
        if volume <= 0.0 {
            return;
        }
        let mut shift = |parts: &[PartId], by: f64| {
            let mut dofs: Vec<u32> = parts.iter().flat_map(|&part| geometry.space.dofs(part)).copied().collect();
            dofs.sort_unstable();
            dofs.dedup();
            dofs.iter().for_each(|&dof| pressure[dof as usize] -= by);
        };
        shift(&self.parts, integral / volume);
        for (parts, factor) in &self.behind {
            shift(parts, factor * integral / volume);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_that_do_no_work_are_found() {
        // A piston between two sets of parts: one constant, the same on both sides.
        assert_eq!(null_vectors(vec![vec![2.0, -2.0]], 2), [(1, vec![(0, 1.0)])]);
        // Two pistons in a row, the second one with a step; and a set that nothing moves.
        let found = null_vectors(vec![vec![1.0, -1.0, 0.0, 0.0], vec![0.0, 3.0, -1.5, 0.0]], 4);
        assert_eq!(found, [(2, vec![(0, 0.5), (1, 0.5)]), (3, vec![])]);
        // Two pistons side by side, and one against something that knows its pressure.
        assert_eq!(null_vectors(vec![vec![1.0, -1.0], vec![-2.0, 2.0]], 2), [(1, vec![(0, 1.0)])]);
        assert_eq!(null_vectors(vec![vec![1.0]], 1), []);
        assert_eq!(null_vectors(Vec::new(), 1), [(0, vec![])]);
    }
}

//! Enclosed regions of fluid whose pressure constant is undetermined.

use std::collections::BTreeMap;

use algebra::{Constraints, DofId};
use cutcell::PartId;
use fluid_ns::FluidGeometry;
use mesh::{Tag, Vector};
use xfem_space::regions;

use crate::InterfacePoints;

/// A region of fluid without open boundary whose pressure is determined only up to a constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Pocket {
    /// The parts of the region.
    pub parts: Vec<PartId>,
    /// A dof of the space in the region. Its pressure is set to zero during the solve.
    pub dof: u32,
    /// Parts of other regions whose pressure changes with the constant of this region, and the ratio of their change to
    /// that of the constant. Example: two regions that a free piston separates have one undetermined constant.
    pub coupled: Vec<(Vec<PartId>, f64)>,
}

/// Largest relative flux that is taken as zero: of `∫ N_k n_a` relative to `∫ N_k`, and of pivots in [`null_vectors`].
/// It is ten times the share of the interface that a cut may leave without facets (`solver/src/overlay.rs`).
const ZERO_FLUX: f64 = 1e-5;

/// Finds the pockets of a step.
///
/// An open boundary determines the constant of its region. Constants `c_p` of the other regions are undetermined if
/// they do no work on any free motion `v` of the bodies, `Σ_p c_p ∫_p v·n = 0`. A fully immersed body determines the
/// constant of the region around it only if the body can change its volume. A rigid piston between two regions
/// determines one of two constants.
///
/// `is_open` returns whether fluid may cross the boundary of the background with a tag.
pub fn pockets<const D: usize>(
    points: &InterfacePoints<'_, D>,
    constraints: &Constraints,
    is_open: impl Fn(Option<Tag>) -> bool,
) -> Vec<Pocket> {
    let FluidGeometry { background, cut, space, .. } = points.geometry;
    let mut classes = regions(cut);
    let mut is_known = vec![false; cut.n_parts()];
    for piece in cut.boundary().iter().filter(|piece| is_open(background.facet_tag(piece.facet))) {
        is_known[classes.lowest(piece.part.0) as usize] = true;
    }
    let mut enclosed: Vec<(u32, Vec<PartId>)> = Vec::new();
    for part in cut.all_parts() {
        let root = classes.lowest(part.0);
        if is_known[root as usize] {
            continue;
        }
        match enclosed.iter_mut().find(|(r, _)| *r == root) {
            Some((_, parts)) => parts.push(part),
            None => enclosed.push((root, vec![part])),
        }
    }
    if enclosed.is_empty() {
        return Vec::new();
    }
    let region_of = |part: PartId| {
        let root = classes.lowest(part.0);
        enclosed.iter().position(|(r, _)| *r == root)
    };
    let rows = fluxes(points, constraints, enclosed.len(), region_of);
    let undetermined = null_vectors(rows, enclosed.len()).into_iter().map(|(own, others)| Pocket {
        parts: enclosed[own].1.clone(),
        dof: space.dofs(enclosed[own].1[0])[0],
        coupled: others.into_iter().map(|(k, factor)| (enclosed[k].1.clone(), factor)).collect(),
    });
    undetermined.collect()
}

/// Returns for each free dof of the bodies the fluxes `∫ N_k n_a` into the regions, one entry per region. Fluxes of
/// tied dofs are added to those of their masters, with the factors of the tie. Fluxes of at most [`ZERO_FLUX`] times
/// `∫ N_k` are set to zero.
fn fluxes<const D: usize>(
    points: &InterfacePoints<'_, D>,
    constraints: &Constraints,
    n_regions: usize,
    mut region_of: impl FnMut(PartId) -> Option<usize>,
) -> impl Iterator<Item = Vec<f64>> {
    // For each dof and region: flux, and the sum of the integrals of the shape functions.
    let mut fluxes: BTreeMap<DofId, Vec<[f64; 2]>> = BTreeMap::new();
    let mut add = |dof: DofId, region: usize, [flux, size]: [f64; 2]| {
        let entry = &mut fluxes.entry(dof).or_insert_with(|| vec![[0.0; 2]; n_regions])[region];
        entry[0] += flux;
        entry[1] += size;
    };
    for (item, piece) in points.geometry.cut.interface().iter().enumerate() {
        let surface = points.surfaces[piece.body.index()];
        let (Some(field), Some(region)) = (surface.field(), region_of(piece.part)) else { continue };
        for (k, node) in surface.boundary.nodes(piece.facet).iter().enumerate() {
            let weight: f64 = points.values.points(item).iter().map(|at| at.weight * at.solid[k]).sum();
            let flux: Vector<D> = piece.normal * weight;
            for (dof, flux) in points.fields.layout.node(field, node.index()).zip(flux.iter()) {
                match constraints.tie_of(dof) {
                    Some(masters) => {
                        masters.iter().for_each(|(to, f)| add(*to, region, [f * flux, (f * weight).abs()]))
                    }
                    None => add(dof, region, [*flux, weight.abs()]),
                }
            }
        }
    }
    let is_free = |dof: &DofId| constraints.get(*dof).is_none();
    let rows: Vec<_> = fluxes.into_iter().filter(|(dof, _)| is_free(dof)).map(|(_, row)| row).collect();
    let cleaned = |[flux, size]: [f64; 2]| if flux.abs() > ZERO_FLUX * size { flux } else { 0.0 };
    rows.into_iter().map(move |row| row.into_iter().map(cleaned).collect())
}

/// Returns a basis of the vectors with `n` entries that are orthogonal to all rows. Each vector is `(k, entries)`:
/// entry `k` is one, and `entries` are the other non-zero ones. Entry `k` is zero in the other vectors.
fn null_vectors(rows: impl IntoIterator<Item = Vec<f64>>, n: usize) -> Vec<(usize, Vec<(usize, f64)>)> {
    // Gauss-Jordan elimination: pivot column and row. All other rows are zero in this column.
    let mut reduced: Vec<(usize, Vec<f64>)> = Vec::new();
    let subtract = |row: &mut [f64], column: usize, source: &[f64]| {
        let factor = row[column];
        row.iter_mut().zip(source).for_each(|(x, s)| *x -= factor * s);
    };
    for mut row in rows {
        let largest = row.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if largest == 0.0 || reduced.len() == n {
            continue;
        }
        row.iter_mut().for_each(|x| *x /= largest);
        reduced.iter().for_each(|(column, source)| subtract(&mut row, *column, source));
        let better = |best: usize, k: usize| if row[k].abs() > row[best].abs() { k } else { best };
        let pivot = (0..n).fold(0, better);
        if row[pivot].abs() <= ZERO_FLUX {
            continue;
        }
        let scale = row[pivot];
        row.iter_mut().for_each(|x| *x /= scale);
        reduced.iter_mut().for_each(|(_, other)| subtract(other, pivot, &row));
        reduced.push((pivot, row));
    }
    reduced.sort_by_key(|(pivot, _)| *pivot);
    let free = (0..n).filter(|column| reduced.iter().all(|(pivot, _)| pivot != column));
    let others = |column: usize| {
        let entries = reduced.iter().map(|(pivot, row)| (*pivot, -row[column]));
        entries.filter(|(_, factor)| *factor != 0.0).collect()
    };
    free.map(|column| (column, others(column))).collect()
}

impl Pocket {
    /// Subtracts the undetermined constant from the pressure, such that its mean over `parts` is zero. The pressure in
    /// the regions of `coupled` changes by this constant times their factors. `pressure` has one value per dof.
    pub fn remove_mean<const D: usize>(&self, geometry: FluidGeometry<'_, D>, pressure: &mut [f64]) {
        let (mut integral, mut volume) = (0.0, 0.0);
        for &part in &self.parts {
            let moments = geometry.parts.moments(part);
            let dofs = geometry.space.dofs(part).iter().enumerate();
            integral += dofs.map(|(i, &dof)| moments.of(i) * pressure[dof as usize]).sum::<f64>();
            volume += moments.volume();
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
        for (parts, factor) in &self.coupled {
            shift(parts, factor * integral / volume);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_without_work_are_found() {
        // A piston between two regions: one constant, the same on both sides.
        assert_eq!(null_vectors(vec![vec![2.0, -2.0]], 2), [(1, vec![(0, 1.0)])]);
        // Two pistons in a row, the second one with areas 3 and 1.5; and a region without moving walls.
        let found = null_vectors(vec![vec![1.0, -1.0, 0.0, 0.0], vec![0.0, 3.0, -1.5, 0.0]], 4);
        assert_eq!(found, [(2, vec![(0, 0.5), (1, 0.5)]), (3, vec![])]);
        // Two parallel pistons, and one next to a region of known pressure.
        assert_eq!(null_vectors(vec![vec![1.0, -1.0], vec![-2.0, 2.0]], 2), [(1, vec![(0, 1.0)])]);
        assert_eq!(null_vectors(vec![vec![1.0]], 1), []);
        assert_eq!(null_vectors(Vec::new(), 1), [(0, vec![])]);
        // More rows than regions.
        assert_eq!(null_vectors(vec![vec![1.0, 0.0], vec![1.0, 1.0], vec![0.3, 0.2]], 2), []);
    }
}

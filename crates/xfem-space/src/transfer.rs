//! Carrying the velocity from one space to the next.

use cutcell::CutMesh;
use mesh::{Point, SimplexMesh, Vector, VertexId};

use crate::XfemSpace;

/// A velocity on a space and the cut that it lives on.
#[derive(Clone, Copy)]
pub struct VelocityField<'a, const D: usize> {
    /// The cut.
    pub cut: &'a CutMesh<D>,
    /// The space on it.
    pub space: &'a XfemSpace<D>,
    /// One value per dof of the space.
    pub values: &'a [Vector<D>],
}

/// A velocity carried to another space.
#[derive(Clone, Debug)]
pub struct Transferred<const D: usize> {
    /// One value per dof of the new space.
    pub values: Vec<Vector<D>>,
    /// The old dof that each new dof took its value from; `None` for uncovered dofs.
    pub sources: Vec<Option<u32>>,
}

impl<const D: usize> Transferred<D> {
    /// Number of dofs that no old dof could serve.
    pub fn n_uncovered(&self) -> usize {
        self.sources.iter().filter(|source| source.is_none()).count()
    }
}

/// The history of a velocity on a new space of the same background.
///
/// A new dof takes the value of the old dof at the same vertex whose parts have the largest volume in common with its
/// own (ties go to the lowest dof); that value may be the natural extrapolation of an old cut cell. A dof without any
/// common volume is *uncovered* and takes the value of the closure, which stands for the velocity of the body that
/// was there. Velocity is continuous across the interface, so this is a first-order extension without extra unknowns.
///
/// Linear fields on a space that keeps its parts are carried over unchanged, bit for bit.
pub fn transfer<const D: usize>(
    background: &SimplexMesh<D>,
    old: VelocityField<'_, D>,
    cut: &CutMesh<D>,
    space: &XfemSpace<D>,
    uncovered: &dyn Fn(VertexId, &Point<D>) -> Vector<D>,
) -> Transferred<D> {
    // (new dof, old dof, common volume), one entry per cell and pair of parts.
    let mut common: Vec<(u32, u32, f64)> = Vec::with_capacity(cut.n_parts() * (D + 1));
    for part in cut.all_parts() {
        for old_part in old.cut.parts(cut.part_cell(part)) {
            let volume = cut.overlap_volume(background, part, old.cut, old_part);
            if volume > 0.0 {
                let pairs = space.dofs(part).iter().zip(old.space.dofs(old_part));
                common.extend(pairs.map(|(&dof, &old_dof)| (dof, old_dof, volume)));
            }
        }
    }
    // Stable, so that volumes are summed in the order of parts.
    common.sort_by_key(|&(dof, old_dof, _)| (dof, old_dof));
    let mut best: Vec<Option<(u32, f64)>> = vec![None; space.len()];
    for class in common.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let volume: f64 = class.iter().map(|entry| entry.2).sum();
        let slot = &mut best[class[0].0 as usize];
        if slot.is_none_or(|(_, largest)| volume > largest) {
            *slot = Some((class[0].1, volume));
        }
    }
    let sources: Vec<Option<u32>> = best.into_iter().map(|best| best.map(|(old_dof, _)| old_dof)).collect();
    let values = sources
        .iter()
        .enumerate()
        .map(|(dof, source)| match source {
            Some(old_dof) => old.values[*old_dof as usize],
            None => {
                let vertex = space.vertex(dof as u32);
                uncovered(vertex, &background.vertex(vertex))
            }
        })
        .collect();
    Transferred { values, sources }
}

//! Fields of one step on the space of the next.

use cutcell::CutMesh;
use mesh::{SimplexMesh, Vector};

use crate::XfemSpace;

/// For each dof of a space, the dof of an earlier space whose value it takes.
///
/// A dof takes the value of the earlier dof at the same vertex whose parts have the largest volume in common with the
/// parts of the dof (ties go to the lowest dof). This value may be extrapolated from an earlier cut cell. A dof without
/// common volume is *uncovered*: its parts were inside a body, or left out. It takes the value of an extension.
///
/// On a space that keeps its parts every field is carried over unchanged, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Sources {
    earlier_dofs: Vec<Option<u32>>,
}

impl Sources {
    /// Finds the sources of the dofs of `space`, on `cut`, among those of an earlier space on the same background.
    pub fn between<const D: usize>(
        background: &SimplexMesh<D>,
        earlier_cut: &CutMesh<D>,
        earlier_space: &XfemSpace<D>,
        cut: &CutMesh<D>,
        space: &XfemSpace<D>,
    ) -> Self {
        // (dof, earlier dof, common volume), one entry per cell and pair of parts.
        let mut common: Vec<(u32, u32, f64)> = Vec::with_capacity(cut.n_parts() * (D + 1));
        for part in cut.all_parts() {
            for earlier in earlier_cut.parts(cut.part_cell(part)) {
                let volume = cut.overlap_volume(background, part, earlier_cut, earlier);
                if volume > 0.0 {
                    let pairs = space.dofs(part).iter().zip(earlier_space.dofs(earlier));
                    common.extend(pairs.map(|(&dof, &earlier_dof)| (dof, earlier_dof, volume)));
                }
            }
        }
        // Stable, so that volumes are summed in the order of parts.
        common.sort_by_key(|&(dof, earlier_dof, _)| (dof, earlier_dof));
        let mut best: Vec<Option<(u32, f64)>> = vec![None; space.len()];
        for class in common.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let volume: f64 = class.iter().map(|entry| entry.2).sum();
            let slot = &mut best[class[0].0 as usize];
            if slot.is_none_or(|(_, largest)| volume > largest) {
                *slot = Some((class[0].1, volume));
            }
        }
        Self { earlier_dofs: best.into_iter().map(|best| best.map(|(dof, _)| dof)).collect() }
    }

    /// Returns the earlier dof of each dof; `None` for uncovered ones.
    pub fn earlier_dofs(&self) -> &[Option<u32>] {
        &self.earlier_dofs
    }

    /// Returns the number of uncovered dofs.
    pub fn n_uncovered(&self) -> usize {
        self.earlier_dofs.iter().filter(|source| source.is_none()).count()
    }

    /// Carries a vector field, one value per dof of the earlier space, to the space; uncovered dofs are zero.
    pub fn carry<const D: usize>(&self, values: &[Vector<D>]) -> Vec<Vector<D>> {
        let value = |source: &Option<u32>| source.map_or(Vector::zeros(), |earlier| values[earlier as usize]);
        self.earlier_dofs.iter().map(value).collect()
    }
}

//! Regions of fluid: parts connected through faces.

use cutcell::CutMesh;
use mesh::SimplexMesh;

use crate::Classes;

/// Returns the regions of fluid as classes of parts.
pub fn regions<const D: usize>(cut: &CutMesh<D>) -> Classes {
    let mut regions = Classes::new(cut.n_parts());
    cut.part_faces().iter().for_each(|face| regions.merge(face.parts[0].0, face.parts[1].0));
    regions
}

/// Returns for each part whether its region is a residue: each part of the region is below a fraction of its cell.
pub fn residues<const D: usize>(background: &SimplexMesh<D>, cut: &CutMesh<D>, fraction: f64) -> Vec<bool> {
    let is_thin = |part| cut.part_volume(part) < fraction * background.cell_volume(cut.part_cell(part));
    let mut is_residue: Vec<bool> = cut.all_parts().map(|part| !cut.is_whole(part) && is_thin(part)).collect();
    if is_residue.contains(&true) {
        let mut regions = regions(cut);
        let of_parts: Vec<usize> = (0..cut.n_parts() as u32).map(|part| regions.lowest(part) as usize).collect();
        let mut is_thin_region = vec![true; cut.n_parts()];
        of_parts.iter().zip(&is_residue).for_each(|(&region, is_thin)| is_thin_region[region] &= is_thin);
        is_residue = of_parts.into_iter().map(|region| is_thin_region[region]).collect();
    }
    is_residue
}

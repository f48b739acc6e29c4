//! Regions of fluid: parts connected through faces.

use cutcell::{CutMesh, PartId};
use mesh::SimplexMesh;

use crate::Classes;

/// Returns the regions of fluid as classes of parts.
pub fn regions<const D: usize>(cut: &CutMesh<D>) -> Classes {
    let mut classes = Classes::new(cut.n_parts());
    cut.part_faces().iter().for_each(|face| classes.merge(face.parts[0].0, face.parts[1].0));
    classes
}

/// Returns for each part whether its region is small: every part of the region has less than `fraction` of the volume
/// of its cell, and `is_kept` is false for all of them.
pub fn small_regions<const D: usize>(
    background: &SimplexMesh<D>,
    cut: &CutMesh<D>,
    fraction: f64,
    is_kept: impl Fn(PartId) -> bool,
) -> Vec<bool> {
    let is_small = |part| cut.part_volume(part) < fraction * background.cell_volume(cut.part_cell(part));
    let mut is_small: Vec<bool> = cut.all_parts().map(|part| is_small(part) && !is_kept(part)).collect();
    let mut classes = Classes::new(cut.n_parts());
    let faces = || cut.part_faces().iter().map(|face| face.parts.map(PartId::index));
    let of_small = |small: &[bool], parts: [usize; 2]| parts.iter().filter(|part| small[**part]).count();
    for [a, b] in faces().filter(|parts| of_small(&is_small, *parts) == 2) {
        classes.merge(a as u32, b as u32);
    }
    // A face between a small part and another one connects the whole class to other fluid.
    let connected: Vec<usize> = faces().filter(|parts| of_small(&is_small, *parts) == 1).flatten().collect();
    let mut is_connected = vec![false; cut.n_parts()];
    connected.into_iter().for_each(|part| is_connected[classes.lowest(part as u32) as usize] = true);
    for part in 0..cut.n_parts() {
        is_small[part] &= !is_connected[classes.lowest(part as u32) as usize];
    }
    is_small
}

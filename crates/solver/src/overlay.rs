//! The background cut by the bodies.

use cutcell::CutMesh;
use mesh::Point;
use xfem_space::residues;

use crate::Setup;
use crate::setup::FluidSetup;

/// Fraction of its cell below which a part may be a residue.
const RESIDUE: f64 = 1e-2;

/// Cuts the background with the bodies at the given positions, and leaves out residues: regions of fluid that consist of
/// parts below a hundredth of their cells.
///
/// Such a region is enclosed between surfaces that touch around it, such as the pole of a ball on a floor. Its fluid
/// would stop the surfaces with a pressure that grows without bound as its area goes to zero. Between
/// rough surfaces the fluid escapes; the region counts as closed.
pub(crate) fn overlay<const D: usize>(
    setup: &Setup<D>,
    fluid: &FluidSetup<D>,
    positions: &[Vec<Point<D>>],
) -> Result<CutMesh<D>, cutcell::Error> {
    let cut = CutMesh::overlay(&fluid.background, &setup.surfaces(positions), &fluid.overlay)?;
    let is_residue = residues(&fluid.background, &cut, RESIDUE);
    // A problem whose fluid is thin everywhere keeps it.
    let is_mixed = is_residue.contains(&true) && is_residue.contains(&false);
    Ok(if is_mixed { cut.without(&is_residue) } else { cut })
}

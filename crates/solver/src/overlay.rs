//! The background cut by the bodies.

use cutcell::{CutMesh, PartId};
use mesh::{Point, Vector, facet_normal};
use xfem_space::small_regions;

use crate::setup::{FluidBoundary, FluidSetup};
use crate::{Error, Setup};

/// Largest volume of a part of trapped fluid, relative to the volume of its cell.
const TRAPPED: f64 = 1e-2;

/// Largest velocity across a wall that is round-off, relative to the velocity.
const ALONG: f64 = 1e-9;

/// Cuts the background with the bodies at the given positions. In problems with contacts, trapped fluid is left out:
/// regions between bodies, walls and planes of symmetry all of whose parts have less than a hundredth of the volume of
/// their cells. A side with a given velocity is a wall where the velocity at `time`, the end of the step, is along it.
///
/// Surfaces that touch around a point enclose such a region, for example under the pole of a ball on a floor. Its fluid
/// is incompressible and would stop the surfaces, with a pressure that grows without bound as the area of the region
/// goes to zero. Between rough surfaces the fluid escapes.
///
/// # Errors
/// The surfaces cannot cut the background, or a part of the interface has no facet.
pub(crate) fn overlay<const D: usize>(
    setup: &Setup<D>,
    fluid: &FluidSetup<D>,
    positions: &[Vec<Point<D>>],
    time: f64,
) -> Result<CutMesh<D>, Error> {
    let background = &fluid.background;
    let cut = CutMesh::overlay(background, &setup.surfaces(positions), &fluid.overlay)?;
    check_interface(&cut)?;
    if setup.contacts.is_empty() {
        return Ok(cut);
    }
    let mut has_opening = vec![false; cut.n_parts()];
    for piece in cut.boundary() {
        let is_closed = match fluid.condition(background.facet_tag(piece.facet)) {
            Some(FluidBoundary::NoSlip | FluidBoundary::Symmetry { .. }) => true,
            Some(FluidBoundary::Velocity(velocity)) => {
                let points = &background.facet_points(piece.facet)[..D];
                let is_along = |u: Vector<D>| u.dot(&facet_normal(points)).abs() <= ALONG * u.norm();
                points.iter().all(|x| is_along(velocity(x, time)))
            }
            Some(FluidBoundary::Parallel { .. } | FluidBoundary::Open { .. }) | None => false,
        };
        has_opening[piece.part.index()] |= !is_closed;
    }
    let is_trapped = small_regions(background, &cut, TRAPPED, |part: PartId| has_opening[part.index()]);
    Ok(if is_trapped.contains(&true) { cut.without_parts(background, &is_trapped) } else { cut })
}

/// Returns an error if a part of the interface has no facet, so that fluid and body would not be coupled.
fn check_interface<const D: usize>(cut: &CutMesh<D>) -> Result<(), Error> {
    /// Largest share of the interface that round-off can leave without a facet.
    const LARGEST_SHARE: f64 = 1e-6;
    let uncovered = cut.report().uncovered_measure;
    let interface: f64 = cut.interface().iter().map(|piece| piece.measure).sum();
    if uncovered > LARGEST_SHARE * interface { Err(Error::Interface { uncovered, interface }) } else { Ok(()) }
}

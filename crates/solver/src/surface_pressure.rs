//! Pressures of the step before on the facets of bodies that deform.

use cutcell::InterfacePiece;
use mesh::Placed;

use crate::fluid_step::FluidStep;
use crate::{Setup, State};

/// Steps at the start of a run whose pressures may be those of an impulse: velocities may jump in the first one.
const FIRST_STEPS: usize = 2;

/// Returns for each body the pressures that act on its moved facets ([`interface_dg::terms::MovedPressure`]), in the
/// order of its facets: the mean over the facet in the step before, times the share of the facet that borders fluid in
/// this step, times the weight `α` of the traction of the fluid. Empty for bodies that do not deform.
///
/// All lists are empty with implicit Euler, which cuts the fluid at the start, as the scheme of the paper.
/// They are also empty in steps without accelerations and at the start of a run. The pressure before such a step may be
/// that of an impulse, which is unlike that of the step.
pub(crate) fn surface_pressures<const D: usize>(
    setup: &Setup<D>,
    previous: &State<D>,
    fluid: Option<&FluidStep<'_, D>>,
    extrapolates: bool,
) -> Vec<Vec<f64>> {
    let mut pressures = vec![Vec::new(); setup.bodies.len()];
    let (Some(fluid), Some(before)) = (fluid, &previous.fluid) else { return pressures };
    if !extrapolates || !previous.has_accelerations() || previous.step < FIRST_STEPS {
        return pressures;
    }
    let sums = |pieces: &[InterfacePiece<D>], of: &dyn Fn(&InterfacePiece<D>) -> f64| -> Vec<Vec<f64>> {
        let n_facets = |b: usize| if setup.bodies[b].deforms() { setup.bodies[b].surface().n_facets() } else { 0 };
        let mut sums: Vec<_> = (0..setup.bodies.len()).map(|b| vec![0.0; n_facets(b)]).collect();
        for piece in pieces {
            if let Some(sum) = sums[piece.body.index()].get_mut(piece.facet.index()) {
                *sum += piece.measure * of(piece);
            }
        }
        sums
    };
    let background = &fluid.setup.background;
    let pressure = |piece: &InterfacePiece<D>| {
        let middle = mesh::mean(&piece.points[..D]);
        let shape = background.simplex(piece.cell).barycentric(&middle).unwrap_or_default();
        before.space.dofs(piece.part).iter().zip(shape).map(|(dof, n)| before.pressure[*dof as usize] * n).sum()
    };
    let forces = sums(before.cut.interface(), &pressure);
    let [measures, wet] = [before.cut.interface(), fluid.cut.interface()].map(|pieces| sums(pieces, &|_| 1.0));
    for (b, pressures) in pressures.iter_mut().enumerate() {
        let surface = Placed::new(setup.bodies[b].surface(), &fluid.positions[b]);
        let of_facet = |(facet, force): (mesh::FacetId, &f64)| {
            let (k, whole) = (facet.index(), surface.facet_measure(facet));
            let is_wet = measures[b][k] > 0.0 && whole > 0.0;
            if is_wet { fluid.setup.alpha * force / measures[b][k] * (wet[b][k] / whole).min(1.0) } else { 0.0 }
        };
        *pressures = setup.bodies[b].surface().facets().zip(&forces[b]).map(of_facet).collect();
    }
    pressures
}

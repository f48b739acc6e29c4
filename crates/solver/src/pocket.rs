//! Pockets of fluid whose pressure is known up to a constant only.

use std::collections::BTreeMap;

use algebra::{BlockLayout, Constraints};
use cutcell::{InterfacePiece, PartId};
use solid_rigid::modes::{mode, n_modes};
use xfem_space::Classes;

use crate::setup::FluidBoundary;
use crate::{BodyUnknown, Motion, Setup, StepGeometry};

/// A connected set of parts without open boundary, and without a body around it that can change its volume.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pocket {
    /// The parts.
    pub parts: Vec<PartId>,
    /// The pressure dof that stands for the constant.
    pub dof: u32,
}

/// The pockets of a step: wherever walls and bodies of prescribed motion enclose the fluid.
///
/// A body that can give way feels the constant, and an open boundary fixes it; anywhere else the mean has to be fixed. A rigid body
/// gives way where it parts the fluid from other fluid, as a piston, and not where the fluid is all around it.
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
    for (root, flow) in rigid_flows(geometry, layout, bodies, constraints, |part| classes.lowest(part.0)) {
        is_fixed[root as usize] |= flow;
    }
    let mut pockets: Vec<(u32, Pocket)> = Vec::new();
    for part in cut.all_parts() {
        let root = classes.lowest(part.0);
        if is_fixed[root as usize] {
            continue;
        }
        match pockets.iter_mut().find(|(r, _)| *r == root) {
            Some((_, pocket)) => pocket.parts.push(part),
            None => pockets.push((root, Pocket { parts: vec![part], dof: geometry.space.dofs(part)[0] })),
        }
    }
    pockets.into_iter().map(|(_, pocket)| pocket).collect()
}

/// Whether rigid bodies can change the volume of pockets: for each pocket with such a body around it, and each of its free modes,
/// whether the mode has a flow through the pocket's share of the surface. There is none if that is the whole surface.
fn rigid_flows<const D: usize>(
    geometry: &StepGeometry<D>,
    layout: &BlockLayout,
    bodies: &[Option<BodyUnknown<D>>],
    constraints: &Constraints,
    mut root: impl FnMut(PartId) -> u32,
) -> Vec<(u32, bool)> {
    /// Flow through a closed surface relative to what would flow through it head-on, at most: round-off.
    const CLOSED: f64 = 1e-9;
    let mut flows: BTreeMap<(u32, usize, usize), [f64; 2]> = BTreeMap::new();
    for (item, piece) in geometry.cut.interface().iter().enumerate() {
        let body = piece.body.index();
        let Some(BodyUnknown { motion: Motion::Rigid { step, unknowns }, .. }) = &bodies[body] else { continue };
        let is_free = |m: &usize| constraints.get(layout.dof(*unknowns, *m)).is_none();
        for m in (0..n_modes(D)).filter(is_free) {
            let [flow, largest] = flows.entry((root(piece.part), body, m)).or_default();
            for at in geometry.pieces.points(item) {
                let velocity = mode(m, &(at.point - step.centre()));
                *flow += at.weight * velocity.dot(&piece.normal);
                *largest += at.weight * velocity.norm();
            }
        }
    }
    flows.into_iter().map(|((root, ..), [flow, largest])| (root, flow.abs() > CLOSED * largest)).collect()
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
        let mut dofs = Vec::new();
        for &part in &self.parts {
            let of_part = geometry.space.dofs(part);
            for q in geometry.parts.points(part) {
                let p: f64 = of_part.iter().zip(&q.shape).map(|(&dof, n)| pressure[dof as usize] * n).sum();
                integral += q.weight * p;
                volume += q.weight;
            }
            dofs.extend_from_slice(of_part);
        }
        dofs.sort_unstable();
        dofs.dedup();
        if volume > 0.0 {
            dofs.iter().for_each(|&dof| pressure[dof as usize] -= integral / volume);
        }
    }
}

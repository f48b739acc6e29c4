//! The share of the solid in the traction of the mortar.

use std::sync::Arc;

use algebra::{DofId, Sites};
use body::SurfaceStress;
use mesh::{BodyId, Vector};

use crate::InterfacePoints;
use crate::terms::Penalty;

/// Stresses of the bodies, which have the weight `1 - α` in the traction of the mortar.
#[derive(Clone)]
pub struct SolidShare<'a, const D: usize> {
    /// Weight `α` of the traction of the fluid, from 0 to 1.
    pub alpha: f64,
    /// Stress of each body on its surface. Where there is none the traction is that of the fluid alone.
    pub stresses: Vec<Option<Arc<dyn SurfaceStress<D> + 'a>>>,
    /// State at which the adjoint of the solid's traction is linearised; it is frozen for the step.
    pub start: Arc<[f64]>,
}

/// Traction of the solid at a point of the interface, with its derivatives by local unknowns.
pub struct SolidTraction<const D: usize> {
    /// Its weight `1 - α`.
    pub weight: f64,
    /// Traction `T^s n^f`.
    pub traction: Vector<D>,
    /// Row of each unknown on which it depends, with the derivative.
    pub derivatives: Vec<(usize, Vector<D>)>,
    /// The same at the start of the step: the traction `T^s n^f` of each test function.
    pub adjoint: Vec<(usize, Vector<D>)>,
}

/// A piece of the interface on which the penalty is too small for the share of the solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnstableShare {
    /// The body.
    pub body: BodyId,
    /// Smaller eigenvalue of the penalty `S`.
    pub penalty: f64,
    /// Smallest one with which the mortar is stable.
    pub required: f64,
}

impl<const D: usize> SolidShare<'_, D> {
    /// Returns the traction of the solid on an item with the given dofs; `None` for a body without stress.
    pub(crate) fn on_item(&self, points: &InterfacePoints<'_, D>, item: usize, x: &[f64]) -> Option<SolidTraction<D>> {
        let piece = &points.geometry.cut.interface()[item];
        let stress = self.stresses[piece.body.index()].as_ref()?;
        let (mut dofs, mut by_dof) = (Vec::new(), Vec::new());
        points.dofs(item, &mut dofs);
        let row = |dof: &DofId| dofs.iter().position(|other| other == dof);
        // The stress of linear simplices is constant on a facet.
        let middle = [1.0 / D as f64; D];
        let mut at = |x: &[f64]| {
            let traction = -stress.at(piece.facet, &middle, x, &mut by_dof);
            let of_fluid_normal = by_dof.iter().filter_map(|(dof, by_dof)| Some((row(dof)?, -by_dof)));
            (traction, of_fluid_normal.collect::<Vec<_>>())
        };
        let ((traction, derivatives), (_, adjoint)) = (at(x), at(&self.start));
        Some(SolidTraction { weight: 1.0 - self.alpha, traction, derivatives, adjoint })
    }

    /// Returns the first piece on which the mortar may be unstable.
    ///
    /// The form bounds the work of its tractions on the jump by viscosity, by the elasticity of the step, and by the penalty. A
    /// penalty `σ` that suffices for the fluid alone leaves `(1 - α²) σ` for the solid, whose traction has the weight `1 - α` and needs
    /// [`SurfaceStress::trace_bound`].
    pub fn unstable(&self, points: &InterfacePoints<'_, D>, penalty: &Penalty) -> Option<UnstableShare> {
        points.geometry.cut.interface().iter().enumerate().find_map(|(item, piece)| {
            let bound = self.stresses[piece.body.index()].as_ref()?.trace_bound(piece.facet);
            let required = bound * (1.0 - self.alpha) / (1.0 + self.alpha);
            let values = points.values;
            let (size, speed) = (values.cell_size(item), values.relative_speed(item));
            let [normal, tangential] = penalty.eigenvalues(size, speed, values.relative_acceleration(item));
            let penalty = normal.min(tangential);
            (penalty < required).then_some(UnstableShare { body: piece.body, penalty, required })
        })
    }
}

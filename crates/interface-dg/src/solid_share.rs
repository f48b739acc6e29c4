//! The share of the solid in the traction of the mortar.

use std::sync::Arc;

use algebra::DofId;
use body::SurfaceStress;
use mesh::{BodyId, FacetId, Vector};

/// Stresses of the bodies, which have the weight `1 - α` in the traction of the mortar.
#[derive(Clone)]
pub struct SolidShare<'a, const D: usize> {
    /// Weight `α` of the traction of the fluid, from 0 to 1.
    pub alpha: f64,
    /// Stress of each body on its surface; `None` for a body without stress, on which the traction is that of the fluid alone.
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

impl<const D: usize> SolidShare<'_, D> {
    /// Returns the traction of the solid on a facet, with rows in the list of local dofs; `None` for a body without stress.
    pub(crate) fn on_facet(
        &self,
        (body, facet): (BodyId, FacetId),
        dofs: &[DofId],
        x: &[f64],
    ) -> Option<SolidTraction<D>> {
        let stress = self.stresses[body.index()].as_ref()?;
        let mut by_dof = Vec::new();
        let row = |dof: &DofId| dofs.iter().position(|other| other == dof);
        let mut at = |x: &[f64]| {
            let traction = -stress.on(facet, x, &mut by_dof);
            let of_fluid_normal = by_dof.iter().filter_map(|(dof, by_dof)| Some((row(dof)?, -by_dof)));
            (traction, of_fluid_normal.collect::<Vec<_>>())
        };
        let ((traction, derivatives), (_, adjoint)) = (at(x), at(&self.start));
        Some(SolidTraction { weight: 1.0 - self.alpha, traction, derivatives, adjoint })
    }
}

//! The share of the solid in the traction of the mortar.

use std::sync::Arc;

use algebra::DofId;
use body::SurfaceStress;
use mesh::{BodyId, FacetId, Vector};

/// Stresses of the bodies for the traction of the mortar, `α T^f n + (1 - α) T^s n`.
#[derive(Clone)]
pub struct SolidShare<'a, const D: usize> {
    /// Weight `α` of the traction of the fluid, from 0 to 1.
    pub alpha: f64,
    /// Stress of each body on its surface; `None` for a body without stress, on which the traction is that of the fluid
    /// alone.
    pub stresses: Vec<Option<Arc<dyn SurfaceStress<D> + 'a>>>,
    /// Starting guess of the step, a global vector. The derivative of the solid's traction in the adjoint term is
    /// evaluated at this vector and does not change during the step.
    pub start: Arc<[f64]>,
}

/// Traction of the solid at a point of the interface, with its derivatives with respect to local unknowns.
pub struct SolidTraction<const D: usize> {
    /// Weight `1 - α` of this traction in that of the mortar.
    pub weight: f64,
    /// Traction `T^s n^f`.
    pub traction: Vector<D>,
    /// Local row of each unknown on which the traction depends, with the derivative.
    pub derivatives: Vec<(usize, Vector<D>)>,
    /// Rows and derivatives of `T^s n^f` at [`SolidShare::start`], for the adjoint consistency term.
    pub adjoint: Vec<(usize, Vector<D>)>,
}

impl<const D: usize> SolidShare<'_, D> {
    /// Returns the traction of the solid on a facet; `None` for a body without stress. Rows are positions in `dofs`,
    /// which must contain the dofs of the stress on the facet ([`SurfaceStress::dofs`]).
    pub(crate) fn on_facet(&self, body: BodyId, facet: FacetId, dofs: &[DofId], x: &[f64]) -> Option<SolidTraction<D>> {
        let stress = self.stresses[body.index()].as_ref()?;
        let mut derivatives = Vec::new();
        let row = |dof: &DofId| dofs.iter().position(|other| other == dof);
        let mut at = |x: &[f64]| {
            let traction = -stress.on(facet, x, &mut derivatives);
            let of_fluid_normal = derivatives.iter().filter_map(|(dof, derivative)| Some((row(dof)?, -derivative)));
            (traction, of_fluid_normal.collect::<Vec<_>>())
        };
        let ((traction, derivatives), (_, adjoint)) = (at(x), at(&self.start));
        Some(SolidTraction { weight: 1.0 - self.alpha, traction, derivatives, adjoint })
    }
}

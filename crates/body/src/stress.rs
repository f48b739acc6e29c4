//! Stresses on surfaces.

use algebra::DofId;
use mesh::{FacetId, Vector};

/// Derivatives of a vector: one entry for each dof on which it depends.
pub type ByDof<const D: usize> = Vec<(DofId, Vector<D>)>;

/// Traction `σ n` on one side of the surface of a body, constant on each facet, with its derivatives; `n` points out of
/// the body. It is a force per area of the surface at the positions at which the step integrates over it.
///
/// Consistent contact laws and the mortar use this traction. Implementations: the stress of a solid behind the surface,
/// and the stress of the fluid in front of it.
pub trait SurfaceStress<const D: usize>: Send + Sync {
    /// Appends the dofs on which the traction on a facet depends. The list does not change during a step.
    fn dofs(&self, facet: FacetId, out: &mut Vec<DofId>);

    /// Returns the traction on a facet at the state `x`. Replaces `derivatives` by the derivatives of the traction with
    /// respect to the dofs on which it depends, all among [`SurfaceStress::dofs`].
    ///
    /// Units: force per area.
    fn on(&self, facet: FacetId, x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D>;

    /// Returns the smallest `C` with `∫ |t(y)|² <= C y · K y` for all velocities `y` of the nodes of the cell behind
    /// the facet, for small strains. `t(y)` is the change of the traction on the facets of the cell that are on the
    /// surface, and `K y` the change of its internal forces, if the velocities at the stage change by `y`. A Nitsche
    /// term with this stress is stable if its penalty on velocities is above `C`.
    ///
    /// Zero for a stress without a stored energy. Units: force·time per volume.
    fn trace_bound(&self, _facet: FacetId) -> f64 {
        0.0
    }

    /// Returns the stiffness of the cell behind a facet divided by the height of the cell. Consistent contact laws
    /// scale their penalty with it. Zero for a stress that is not caused by a deformation.
    ///
    /// Units: force per volume.
    fn stiffness(&self, _facet: FacetId) -> f64 {
        0.0
    }
}

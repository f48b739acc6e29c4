//! Work of the contact traction on the relative motion of slave and obstacle.

use algebra::{LocalSystem, Term};
use mesh::{Tensor, Vector};

use crate::{Anchor, ContactNode, ContactSite};

/// `-(f, w^s - w^m)_{Γ^{s,n}}` with the traction `f = λ n^w + τ`; penalty: `+ (γ_C0/s) ([ε - Δ]₊, w_n^s - w_n^m)`
///
/// Source: paper, Eq. (7) for a rigid obstacle, Eq. (11) and the two-body form for a deformable one.
/// Couples: velocities of slave and master, and the dofs of the stress.   Domain: the slave's boundary facets. The
/// measure is that at the start of the step, for order 2 that of the element. Positions are the shifted positions of
/// the time scheme (implicit Euler: those at the end).
/// Units: force (2D: per unit depth).
/// With the share `s_a` of a node in `r = x - Π(x)` (the shape function `N_a` at the slave, `-N_a` at the master),
/// `G_a = ∂N_a/∂x` (zero at the slave), `C = ∂n/∂x` and the metric `W` ([`Anchor::Facet`]), all nodes alike:
///   residual_a = -∫ s_a f,    tangent_ab = -c_d ∫ (f ⊗ ∂s_a/∂x_b + s_a ∂f/∂x_b),
///   ∂Δ/∂x_b = -s_b n,    ∂n/∂x_b = s_b C - G_b ⊗ n,    ∂s_a/∂x_b = Δ (G_a · W G_b) n - s_b G_a,
/// and `∂f` by the chain rule through gap, motion, stress and frame: exact wherever the projection is smooth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactWork;

impl<const D: usize> Term<ContactSite<D>> for ContactWork {
    fn add(&self, site: &ContactSite<D>, out: &mut LocalSystem) {
        let force = site.frame.vector(&site.traction.value) * site.weight;
        let rows = || site.nodes().iter().filter_map(|node| Some((node, node.row?)));
        for (a, row) in rows() {
            out.add_vector::<D>(row, force * -a.share);
        }
        if !out.has_tangent() {
            return;
        }
        for (b, column) in rows() {
            let along = along(site, b);
            let by_b = force_by_position(site, b, &along) * site.weight;
            for (a, row) in rows() {
                let block: Tensor<D> =
                    force * share_by_position(site, a, (b.share, &along)).transpose() + by_b * a.share;
                out.add_block::<D, D>(row, column, block * -b.slope);
            }
        }
        for (column, derivative) in &site.stress_derivatives {
            let by_stress = force_by_stress(site, &site.frame.components(derivative)) * site.weight;
            for (a, row) in rows() {
                out.add_block::<D, 1>(row, *column, by_stress * -a.share);
            }
        }
    }
}

/// Returns `W G_b`.
fn along<const D: usize>(site: &ContactSite<D>, b: &ContactNode<D>) -> Vector<D> {
    match &site.projection.anchor {
        Anchor::Facet { metric, .. } => metric * b.gradient,
        Anchor::Fixed => b.gradient,
    }
}

/// Returns `∂s_a/∂x_b`, given `s_b` and `W G_b`.
fn share_by_position<const D: usize>(
    site: &ContactSite<D>,
    a: &ContactNode<D>,
    (share, along): (f64, &Vector<D>),
) -> Vector<D> {
    site.projection.normal * (site.at.gap * a.gradient.dot(along)) - a.gradient * share
}

/// Returns the change of the traction with a change of the stress, given in the frame.
fn force_by_stress<const D: usize>(site: &ContactSite<D>, change: &[f64; 3]) -> Vector<D> {
    let changes = site.traction.by_stress.iter().zip(change);
    changes.map(|(derivative, change)| site.frame.vector(derivative) * *change).sum()
}

/// Returns `∂f/∂x_b`, given `W G_b`; column `c` is the change of the traction with component `c` of the position.
fn force_by_position<const D: usize>(site: &ContactSite<D>, b: &ContactNode<D>, along: &Vector<D>) -> Tensor<D> {
    let (n, frame, law) = (site.projection.normal, &site.frame, &site.traction);
    let by_normal = site.projection.normal_gradient * b.share - b.gradient * n.transpose();
    let by_gap = frame.vector(&law.by_gap);
    let mut by_position = by_gap * n.transpose() * -b.share;
    // Axes turn with the normal, and with them the components of slip and stress.
    let axes = frame.by_normal().map(|axis| axis * by_normal);
    for (value, axis) in law.value.iter().zip(&axes) {
        by_position += axis * *value;
    }
    for (derivative, axis) in law.by_stress.iter().zip(&axes) {
        by_position += frame.vector(derivative) * (site.stress.transpose() * axis);
    }
    let by_motion = [site.by_advance, law.by_slip[0], law.by_slip[1]];
    if by_motion != [[0.0; 3]; 3] {
        let motion: Vector<D> = site.nodes().iter().map(|a| a.displacement * a.share).sum();
        let mut by_b = Tensor::identity() * b.share;
        for a in site.nodes() {
            by_b += a.displacement * share_by_position(site, a, (b.share, along)).transpose();
        }
        for (k, derivative) in by_motion.iter().enumerate() {
            let change = motion.transpose() * axes[k] + frame.axes[k].transpose() * by_b;
            by_position += frame.vector(derivative) * change;
        }
    }
    by_position
}

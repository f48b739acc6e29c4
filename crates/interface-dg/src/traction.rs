//! The traction that crosses the interface.

use algebra::Sites;
use mesh::{Point, Tensor, Vector, moment_of};

use crate::slip_patch::along_surface;
use crate::terms::Penalty;
use crate::{InterfacePoints, MeanSlips};

/// Means over one interface piece, with the normal `n` out of the body. Units of tractions: force per area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterfaceTraction<const D: usize> {
    /// Measure of the piece, with the weight of the coordinates.
    pub measure: f64,
    /// Fluid traction on the body, `T^f n = -p n + 2 μ D(u) n`, mean over the piece, with that of
    /// [`crate::terms::FilmEnd`].
    pub fluid: Vector<D>,
    /// Contribution of the share of the solid, `(1 - α) (T^s - T^f) n`, mean over the piece; zero for `α = 1`.
    pub exchange: Vector<D>,
    /// Pressure part of `fluid`.
    pub pressure: Vector<D>,
    /// Traction of the mortar's penalty on the body, `S (u - v_s)`, mean over the piece.
    pub penalty: Vector<D>,
    /// Velocity jump `u - v_s`, mean over the piece.
    pub jump: Vector<D>,
    /// The middle `x̄` of the piece.
    pub middle: Point<D>,
    /// Mean of `t (x - x̄)ᵀ` with the total traction `t`, the part of moments that the mean of `t` does not determine.
    pub first_moment: Tensor<D>,
}

impl<const D: usize> InterfaceTraction<D> {
    /// Returns the mean traction on the body: that of the mortar plus that of the penalty (variational traction).
    pub fn total(&self) -> Vector<D> {
        self.fluid + self.exchange + self.penalty
    }

    /// Returns the mean moment of the total traction about a point, per area. Component `k` is the moment about axis
    /// `k`; in 2D only the last one is not zero.
    pub fn moment(&self, about: &Point<D>) -> [f64; 3] {
        moment_of(&(self.first_moment + self.total() * (self.middle - about).transpose()))
    }
}

/// Returns the tractions of all pieces of a step at the state `x`, in the order of the pieces.
pub fn interface_tractions<const D: usize>(
    points: &InterfacePoints<'_, D>,
    penalty: &Penalty,
    x: &[f64],
) -> Vec<InterfaceTraction<D>> {
    let by_mean = tractions_by_mean(points, penalty, x);
    (0..points.len())
        .map(|item| {
            let mut mean = InterfaceTraction {
                measure: 0.0,
                fluid: Vector::zeros(),
                exchange: Vector::zeros(),
                pressure: Vector::zeros(),
                penalty: Vector::zeros(),
                jump: Vector::zeros(),
                middle: Point::zeros(),
                first_moment: Tensor::zeros(),
            };
            points.visit(item, x, |q| {
                mean.measure += q.at.weight;
                let (shared, at_end) = (q.shared_traction(), q.force_at_end());
                mean.fluid += (at_end - q.traction) * q.at.weight;
                mean.exchange -= (shared - q.traction) * q.at.weight;
                mean.pressure += (at_end - q.piece.normal * q.pressure) * q.at.weight;
                mean.jump += q.jump * q.at.weight;
                let by_penalty = penalty.weighted(q) * q.jump + by_mean[item] * q.at.weight;
                mean.penalty += by_penalty;
                mean.middle += q.at.point * q.at.weight;
                mean.first_moment += (by_penalty + (at_end - shared) * q.at.weight) * q.at.point.transpose();
            });
            if mean.measure == 0.0 {
                return mean;
            }
            let measure = mean.measure;
            mean.fluid /= measure;
            mean.exchange /= measure;
            mean.pressure /= measure;
            mean.jump /= measure;
            mean.penalty /= measure;
            mean.middle /= measure;
            mean.first_moment = mean.first_moment / measure - mean.total() * mean.middle.transpose();
            mean
        })
        .collect()
}

/// Returns the traction `(σ_t - σ_f) P m` of the penalty on the mean slip for each piece; zero where there is none.
pub(crate) fn tractions_by_mean<const D: usize>(
    points: &InterfacePoints<'_, D>,
    penalty: &Penalty,
    x: &[f64],
) -> Vec<Vector<D>> {
    let pieces = points.geometry.cut.interface();
    let mut tractions = vec![Vector::zeros(); pieces.len()];
    MeanSlips(points.clone()).for_each_piece(x, |piece, slip| {
        tractions[piece] = along_surface(&pieces[piece].normal) * slip.value * penalty.of_mean(slip);
    });
    tractions
}

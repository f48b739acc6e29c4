//! The traction that crosses the interface.

use mesh::Vector;

use crate::InterfacePieces;

/// Means over one interface piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterfaceTraction<const D: usize> {
    /// Fluid traction on the body, `T^f n = -p n + 2 μ D(u) n`, mean over the piece.
    pub fluid: Vector<D>,
    /// Its pressure part, `-p n`.
    pub pressure: Vector<D>,
    /// Traction of the mortar's penalty on the body, `γ_Σ μ/h_K (u - v_s)`, mean over the piece.
    pub penalty: Vector<D>,
    /// Velocity jump `u - v_s`, mean over the piece.
    pub jump: Vector<D>,
}

impl<const D: usize> InterfaceTraction<D> {
    /// What the body feels: fluid traction and penalty, the variational traction of the mortar.
    pub fn total(&self) -> Vector<D> {
        self.fluid + self.penalty
    }
}

/// Tractions of all pieces of a step at the state `x`, in the order of the pieces.
pub fn interface_tractions<const D: usize>(pieces: &InterfacePieces<'_, D>, x: &[f64]) -> Vec<InterfaceTraction<D>> {
    let penalty = &pieces.form.penalty;
    (0..pieces.geometry.cut.interface().len())
        .map(|item| {
            let mut mean = InterfaceTraction {
                fluid: Vector::zeros(),
                pressure: Vector::zeros(),
                penalty: Vector::zeros(),
                jump: Vector::zeros(),
            };
            let mut measure = 0.0;
            pieces.for_each_point(item, x, |q| {
                measure += q.at.weight;
                mean.fluid -= q.traction * q.at.weight;
                mean.pressure -= q.piece.normal * (q.pressure * q.at.weight);
                mean.jump += q.jump * q.at.weight;
                mean.penalty += q.jump * (q.at.weight * penalty.gamma_sigma * penalty.viscosity / q.cell_size);
            });
            mean.fluid /= measure;
            mean.pressure /= measure;
            mean.jump /= measure;
            mean.penalty /= measure;
            mean
        })
        .collect()
}

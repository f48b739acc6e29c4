//! Flow through the interface, which measures the error of the coupling.

use algebra::Sites;

use crate::InterfacePoints;

/// Flow through the interface, with the normal `n` out of the bodies. Units: volume/time (2D: per unit depth).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InterfaceFlow {
    /// `∫ (u - v_s)·n`: volume that crosses the interface per time, positive out of the bodies.
    pub leak_net: f64,
    /// `∫ |(u - v_s)·n|`.
    pub leak_absolute: f64,
    /// `∫ |v_s·n|`: volume that the bodies sweep per time.
    pub swept: f64,
}

/// Returns the flow through the interface of a step at the state `x`.
pub fn interface_flow<const D: usize>(points: &InterfacePoints<'_, D>, x: &[f64]) -> InterfaceFlow {
    let mut flow = InterfaceFlow::default();
    for (item, piece) in points.geometry.cut.interface().iter().enumerate() {
        points.visit(item, x, |q| {
            let through = q.jump.dot(&piece.normal);
            flow.leak_net += q.at.weight * through;
            flow.leak_absolute += q.at.weight * through.abs();
            flow.swept += q.at.weight * (q.velocity.dot(&piece.normal) - through).abs();
        });
    }
    flow
}

//! Velocity of the bodies at points that they have left.

use std::cell::OnceCell;

use body::{Located, Locator};
use mesh::{Point, Vector};

use crate::{Setup, State};

/// The extension of the fluid's velocity to uncovered vertices: the velocity of the body around a point, or of the nearest
/// body if there is none.
///
/// Velocity is continuous across the interface, so this is an extension of first order without extra unknowns.
pub(crate) struct Interior<'a, const D: usize> {
    setup: &'a Setup<D>,
    state: &'a State<D>,
    /// Built for the first point.
    bodies: OnceCell<Vec<Locator<'a, D>>>,
}

impl<'a, const D: usize> Interior<'a, D> {
    /// Creates the extension for the bodies in a state.
    pub(crate) fn new(setup: &'a Setup<D>, state: &'a State<D>) -> Self {
        Self { setup, state, bodies: OnceCell::new() }
    }

    /// Velocity at a point; zero without bodies.
    pub(crate) fn velocity(&self, x: &Point<D>) -> Vector<D> {
        let build = || {
            let bodies = self.setup.bodies.iter().zip(&self.state.bodies);
            bodies.map(|(body, state)| body.locator(state, self.state.time)).collect()
        };
        let located: Vec<Located<D>> = self.bodies.get_or_init(build).iter().filter_map(|at| at(x)).collect();
        let nearest = || located.iter().min_by(|a, b| a.distance.total_cmp(&b.distance));
        located.iter().find(|body| body.is_inside).or_else(nearest).map_or(Vector::zeros(), |body| body.velocity)
    }
}

//! Velocity of the bodies at points that they have left.

use std::cell::OnceCell;

use body::{Located, Locator};
use mesh::{Point, Vector};

use crate::{Setup, State};

/// Returns the extension of the fluid's velocity to uncovered vertices: the velocity of the body around a point, or of the
/// nearest body if there is none; zero without bodies.
///
/// Velocity is continuous across the interface, so this is an extension of first order without extra unknowns.
pub(crate) fn extension<'a, const D: usize>(
    setup: &'a Setup<D>,
    state: &'a State<D>,
) -> impl Fn(&Point<D>) -> Vector<D> + 'a {
    // Built for the first point.
    let bodies: OnceCell<Vec<Locator<'a, D>>> = OnceCell::new();
    let build = || setup.bodies.iter().zip(&state.bodies).map(|(body, at)| body.locator(at, state.time)).collect();
    move |x| {
        let located: Vec<Located<D>> = bodies.get_or_init(build).iter().filter_map(|at| at(x)).collect();
        let nearest = || located.iter().min_by(|a, b| a.distance.total_cmp(&b.distance));
        located.iter().find(|body| body.is_inside).or_else(nearest).map_or(Vector::zeros(), |body| body.velocity)
    }
}

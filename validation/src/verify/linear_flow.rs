//! Linear flow in a box, with a body that cuts the mesh: the setting of several checks.

use std::sync::Arc;

use cutwater::algebra::NewtonSettings;
use cutwater::mesh::SimplexMesh;
use cutwater::mesh::generate::{Size, graded_box};
use cutwater::solver::{FluidBoundary, Setup};
use rand::RngExt;
use rand_xoshiro::SplitMix64;

use super::flow::{Flow, KnownFlow, set_sides};
use super::{Failure, P, T, V};

/// Size of the cells of the background.
pub(super) const SIZE: f64 = 0.13;

/// Returns the background: a box of 2 x 1.5.
pub(super) fn background(h: f64) -> Result<SimplexMesh<2>, Failure> {
    Ok(graded_box::<2>([0.0, 0.0], [2.0, 1.5], &Size::uniform(h))?)
}

/// Velocity `a x + b` and pressure `g · x + p`, with the body force that makes the flow steady.
pub(super) struct LinearFlow {
    pub(super) a: T,
    pub(super) b: V,
    pub(super) g: V,
    pub(super) p: f64,
    pub(super) density: f64,
    pub(super) convects: bool,
}

impl Flow for LinearFlow {
    fn velocity(&self, x: &P, _: f64) -> V {
        self.a * x + self.b
    }
    fn gradient(&self, _: &P, _: f64) -> T {
        self.a
    }
    fn pressure(&self, x: &P, _: f64) -> f64 {
        self.p + self.g.dot(x)
    }
    fn force(&self, x: &P, t: f64) -> V {
        let inertia = if self.convects { self.a * self.velocity(x, t) * self.density } else { V::zeros() };
        inertia + self.g
    }
}

impl LinearFlow {
    /// Returns the fluid at rest with the pressure gradient `g`.
    pub(super) fn at_rest(g: V) -> Self {
        Self { a: T::zeros(), b: V::zeros(), g, p: 1.7, density: 1.2, convects: false }
    }

    /// Returns the flow as a problem with the given viscosity and open sides.
    pub(super) fn known(self, viscosity: f64, open: &'static [&'static str]) -> KnownFlow<Self> {
        KnownFlow { density: self.density, convects: self.convects, flow: Arc::new(self), viscosity, open }
    }
}

/// Returns a setup with fluid of density one at rest, with one condition on all sides of its background.
pub(super) fn still(
    background: SimplexMesh<2>,
    viscosity: f64,
    dt: f64,
    tolerance: f64,
    side: impl Fn() -> FluidBoundary<2>,
) -> Result<Setup<2>, Failure> {
    let flow = Arc::new(LinearFlow::at_rest(V::zeros()));
    let known = KnownFlow { flow, density: 1.0, viscosity, convects: true, open: &[] };
    let mut setup = known.setup(background, dt);
    setup.newton = NewtonSettings::new(tolerance);
    set_sides(&mut setup, side)?;
    Ok(setup)
}

/// Returns a polygon without any symmetry.
pub(super) fn nonagon(centre: P, random: &mut SplitMix64) -> Vec<P> {
    let turn = random.random_range(0.0..1.0);
    let corner = |k: u32| {
        let (angle, radius) = (turn + f64::from(k) * std::f64::consts::TAU / 9.0, random.random_range(0.2..0.45));
        centre + P::new(angle.cos(), angle.sin()) * radius
    };
    (0..9).map(corner).collect()
}

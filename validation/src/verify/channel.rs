//! Flow past a cylinder, with and without a flag, in a channel whose mesh does not follow it.

use std::f64::consts::TAU;
use std::sync::Arc;

use cutwater::mesh::SimplexMesh;
use cutwater::mesh::generate::{Region, RegionShape, Size, refined_box};
use cutwater::solver::{ConvectionForm, FluidBoundary, Setup, State};

use super::flow::{self, fluid_of, force, interface, polygon, wet};
use super::{DirectRun, Failure, P, V};

// Height of the channel; centre and radius of the cylinder, m.
const HEIGHT: f64 = 0.41;
pub(super) const CENTRE: [f64; 2] = [0.2, 0.2];
pub(super) const RADIUS: f64 = 0.05;
// End of the flag and half of its thickness, m.
const FLAG_END: f64 = 0.6;
const FLAG_HALF: f64 = 0.01;
/// Number of corners of the polygon that approximates the circle. It has the area of the disk, so its corners are
/// `(2π/n)²/12 = 1.3e-5` radii outside of the circle, and the middles of its edges half as far inside. The drag changes
/// about as much.
pub(super) const N_CORNERS: usize = 512;
/// Size of cells far away over that at the obstacle.
pub(super) const COARSE: f64 = 8.0;
/// Cells at the corners of the flag are finer by this factor. There the pressure goes like the distance to the power
/// -0.46.
const FINER_AT_CORNERS: f64 = 16.0;
/// Length of a step in which inertia is negligible, s.
const LONG: f64 = 1e9;
// Largest relative change of the force in the last step, and largest number of steps.
const UNCHANGED: f64 = 1e-6;
const MOST_STEPS: usize = 10;

/// A fluid that flows through a channel, past the cylinder.
#[derive(Clone, Copy)]
pub(super) struct Channel {
    pub(super) length: f64,
    pub(super) density: f64,
    pub(super) viscosity: f64,
    /// Mean speed of the parabolic inflow.
    pub(super) speed: f64,
    /// Whether there is a flag behind the cylinder.
    pub(super) has_flag: bool,
}

/// Resolution of the obstacle and of the fluid.
#[derive(Clone, Copy)]
pub(super) struct ChannelResolution {
    /// Cells in a diameter of the cylinder.
    pub(super) cells: usize,
    /// Size of cells far away over that at the obstacle.
    pub(super) coarse: f64,
    /// Number of corners of the polygon that approximates the circle.
    pub(super) n_corners: usize,
    /// Largest distance by which the flag swings to either side. Cells within this distance are as fine as those at the
    /// obstacle. Cells at the corners of the flag are refined further only if it does not swing.
    pub(super) swing: f64,
}

impl ChannelResolution {
    pub(super) fn new(cells: usize) -> Self {
        Self { cells, coarse: COARSE, n_corners: N_CORNERS, swing: 0.0 }
    }

    /// Returns the size of cells at the obstacle.
    pub(super) fn h(&self) -> f64 {
        2.0 * RADIUS / self.cells as f64
    }
}

/// A steady flow.
pub(super) struct Steady {
    pub(super) setup: Setup<2>,
    pub(super) state: State<2>,
    pub(super) n_dofs: usize,
    /// Steps and iterations of Newton's method until the flow did not change.
    pub(super) n_steps: usize,
    pub(super) n_iterations: usize,
    /// Force on the obstacle, from the variational traction of the mortar.
    pub(super) force: V,
    /// Part of `force` from the traction of the fluid, without the penalty.
    pub(super) by_traction: V,
}

impl Channel {
    /// Computes the steady flow by long steps of implicit Euler, beginning at rest.
    ///
    /// # Errors
    /// The flow still changes after many steps.
    pub(super) fn steady(&self, resolution: &ChannelResolution) -> Result<Steady, Failure> {
        let mut run = DirectRun::lagged(self.setup(resolution, |_| 1.0)?)?;
        let (mut before, mut n_iterations) = (V::zeros(), 0);
        for n_steps in 1..=MOST_STEPS {
            let report = run.advance()?;
            n_iterations += report.newton.iterations;
            let (force, _) = force(&run.state, &report, 0, &P::zeros())?;
            if (force - before).norm() <= UNCHANGED * force.norm() {
                let pieces = interface(&run.state, &report)?;
                let by_traction = pieces.map(|(piece, on_piece)| on_piece.fluid * piece.measure).sum();
                let DirectRun { setup, state, .. } = run;
                return Ok(Steady { setup, state, n_dofs: report.n_dofs, n_steps, n_iterations, force, by_traction });
            }
            before = force;
        }
        Err(format!("the flow still changes after {MOST_STEPS} steps").into())
    }

    /// Returns the inflow at a height.
    pub(super) fn inflow(&self, y: f64) -> f64 {
        6.0 * self.speed * y * (HEIGHT - y) / (HEIGHT * HEIGHT)
    }

    /// Returns the velocity of the inflow everywhere, with a part across it in the wake.
    pub(super) fn disturbed(&self, x: &P) -> V {
        let end = if self.has_flag { FLAG_END } else { CENTRE[0] + 2.0 * RADIUS };
        let from_wake = (x[0] - end - 2.0 * RADIUS) / (2.0 * RADIUS);
        V::new(self.inflow(x[1]), 0.5 * self.speed * (-from_wake * from_wake).exp())
    }

    /// Returns the coefficient of a force on the cylinder.
    pub(super) fn coefficient(&self, force: f64) -> f64 {
        force / (self.density * self.speed * self.speed * RADIUS)
    }

    /// Returns the setup of the flow from rest, in one long step. A function of time multiplies the inflow.
    pub(super) fn setup(&self, resolution: &ChannelResolution, factor: fn(f64) -> f64) -> Result<Setup<2>, Failure> {
        let mut fluid = flow::fluid(self.background(resolution)?, self.density, self.viscosity);
        fluid.convection = Some(ConvectionForm::Standard);
        let channel = *self;
        let inflow = FluidBoundary::Velocity(Arc::new(move |x: &P, t| V::new(factor(t) * channel.inflow(x[1]), 0.0)));
        // The traction of the developed flow in the form with the symmetric gradient: the condition "do nothing" of the
        // form with the full gradient.
        let shear = move |x: &P, _: &V, t| {
            let slope = 6.0 * channel.speed * (HEIGHT - 2.0 * x[1]) / (HEIGHT * HEIGHT);
            V::new(0.0, channel.viscosity * factor(t) * slope)
        };
        let outflow = FluidBoundary::Open { traction: Some(Arc::new(shear)), backflow: false };
        let mut setup = flow::problem(fluid, LONG);
        flow::set_side(&mut setup, "left", inflow)?;
        flow::set_side(&mut setup, "right", outflow)?;
        flow::set_side(&mut setup, "bottom", FluidBoundary::NoSlip)?;
        flow::set_side(&mut setup, "top", FluidBoundary::NoSlip)?;
        let at_rest = Arc::new(|_: &P, _: f64| V::zeros());
        setup.bodies.push(polygon(&[self.obstacle(resolution.n_corners)], |x, _| *x, at_rest));
        Ok(setup)
    }

    /// Returns the corners of the obstacle. The cylinder has the radius of a regular polygon with the area of the disk.
    pub(super) fn obstacle(&self, n_corners: usize) -> Vec<P> {
        let [x, y] = CENTRE;
        if !self.has_flag {
            return flow::disk(P::new(x, y), RADIUS, n_corners);
        }
        let step = TAU / n_corners as f64;
        let radius = RADIUS * (step / step.sin()).sqrt();
        let first = (FLAG_HALF / radius).asin();
        let turn = (TAU - 2.0 * first) / n_corners as f64;
        let on_arc = |k: usize| {
            let angle = first + turn * k as f64;
            P::new(x + radius * angle.cos(), y + radius * angle.sin())
        };
        let end = [-FLAG_HALF, FLAG_HALF].map(|dy| P::new(FLAG_END, y + dy));
        end.into_iter().chain((0..=n_corners).map(on_arc)).collect()
    }

    /// Returns the mesh of the channel. The size of cells grows in proportion to the distance from the centre of the
    /// cylinder, and from the flag as fast.
    fn background(&self, resolution: &ChannelResolution) -> Result<SimplexMesh<2>, Failure> {
        let h = resolution.h();
        let near = |from: [f64; 2], to: [f64; 2], within: f64, size: f64| Region {
            shape: RegionShape::Segment { ends: [from.into(), to.into()], within },
            size,
            growth: h / RADIUS,
        };
        let mut regions = vec![near(CENTRE, CENTRE, RADIUS, h)];
        if self.has_flag {
            regions.push(near(CENTRE, [FLAG_END, CENTRE[1]], FLAG_HALF + resolution.swing, h));
        }
        if self.has_flag && resolution.swing == 0.0 {
            for dy in [-FLAG_HALF, FLAG_HALF] {
                let corner = [FLAG_END, CENTRE[1] + dy];
                regions.push(Region { growth: 0.1, ..near(corner, corner, 0.0, h / FINER_AT_CORNERS) });
            }
        }
        let size = Size::uniform(resolution.coarse * h);
        Ok(refined_box([0.0, 0.0], [self.length, HEIGHT], &size, &regions)?)
    }
}

/// Takes a step. Returns the force on the first body, and the time of the stage, at which it acts.
pub(super) fn step_with_force(run: &mut DirectRun) -> Result<(f64, V), Failure> {
    let report = run.advance()?;
    let (force, _) = force(&run.state, &report, 0, &P::zeros())?;
    Ok((wet(&run.state)?.pressure_time, force))
}

/// Returns velocity and pressure at a point.
///
/// # Errors
/// The point is outside of the fluid.
pub(super) fn at(setup: &Setup<2>, state: &State<2>, x: &P) -> Result<(V, f64), Failure> {
    const OUTSIDE: &str = "the point is outside of the fluid";
    let fluid = wet(state)?;
    let (cell, shape) = fluid_of(setup)?.background.cell_index().locate(x).ok_or(OUTSIDE)?;
    Ok(fluid.at(fluid.cut.parts(cell).next().ok_or(OUTSIDE)?, &shape))
}

/// Returns the velocity of a state at a point; zero outside of the fluid.
pub(super) fn velocity_at(setup: &Setup<2>, state: &State<2>, x: &P) -> V {
    at(setup, state, x).map_or(V::zeros(), |(velocity, _)| velocity)
}

/// Returns the difference of the pressures at the foremost and the rearmost point of the cylinder.
pub(super) fn pressure_difference(setup: &Setup<2>, state: &State<2>) -> Result<f64, Failure> {
    let [front, back] = [-RADIUS, RADIUS].map(|dx| at(setup, state, &P::new(CENTRE[0] + dx, CENTRE[1])));
    Ok(front?.1 - back?.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn obstacles_have_the_area_of_disk_and_flag() {
        let channel = |has_flag| Channel { length: 2.5, density: 1.0, viscosity: 1.0, speed: 1.0, has_flag };
        let disk = std::f64::consts::PI * RADIUS * RADIUS;
        // The flag begins at the centre, and this part of it is in the disk.
        let inside = RADIUS * RADIUS * (FLAG_HALF / RADIUS).asin()
            + FLAG_HALF * (RADIUS * RADIUS - FLAG_HALF * FLAG_HALF).sqrt();
        let flag = 2.0 * FLAG_HALF * (FLAG_END - CENTRE[0]);
        for (has_flag, expected) in [(false, disk), (true, disk + flag - inside)] {
            let corners = channel(has_flag).obstacle(N_CORNERS);
            let area = flow::area(&corners);
            assert!((area / expected - 1.0).abs() < 2e-5, "{area} {expected}");
        }
    }
}

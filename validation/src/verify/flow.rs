//! Flows that are known everywhere, around bodies that cut the mesh, and the errors of discrete ones.

use std::sync::Arc;

use cutwater::algebra::time::ImplicitEuler;
use cutwater::algebra::{NewtonSettings, Workspace};
use cutwater::cutcell::InterfacePiece;
use cutwater::fluid_ns::NewtonianFluid;
use cutwater::interface_dg::InterfaceTraction;
use cutwater::mesh::{BoundaryMesh, SimplexMesh, VertexId};
use cutwater::solid_rigid::RigidBody;
use cutwater::solver::body::{Body, ParticleVelocity, PrescribedBody, TimeField};
use cutwater::solver::{
    ConvectionForm, FluidBoundary, FluidReport, FluidSetup, FluidState, Setup, Stabilisation, State, StepReport,
    Substep, advance,
};
use cutwater::xfem_space::PartValues;

use super::{Failure, P, T, V};

/// The standard stabilisation with the penalty of the paper's cases, for comparison.
pub(super) const PAPERS_PENALTY: Stabilisation =
    Stabilisation { penalty: Stabilisation::PAPER_44_2019.penalty, ..Stabilisation::STANDARD };

/// A flow with known fields.
pub(super) trait Flow: Send + Sync + 'static {
    fn velocity(&self, x: &P, t: f64) -> V;
    /// Returns `∂u_i/∂x_j` in row i, column j.
    fn gradient(&self, x: &P, t: f64) -> T;
    fn pressure(&self, x: &P, t: f64) -> f64;
    /// Returns the force per volume of the flow.
    fn force(&self, _x: &P, _t: f64) -> V {
        V::zeros()
    }
}

/// Fluid with a known flow on its sides, to be completed by bodies.
pub(super) struct KnownFlow<F> {
    pub(super) flow: Arc<F>,
    pub(super) density: f64,
    pub(super) viscosity: f64,
    /// Whether there is convection.
    pub(super) convects: bool,
    /// Sides where the traction of the flow is given; its velocity is on all others.
    pub(super) open: &'static [&'static str],
}

/// Names of the sides of a box.
const SIDES: [&str; 4] = ["left", "right", "bottom", "top"];

impl<F: Flow> KnownFlow<F> {
    /// Returns the setup of the flow on a background, without bodies.
    pub(super) fn setup(&self, background: SimplexMesh<2>, dt: f64) -> Setup<2> {
        let (at_start, forcing) = (Arc::clone(&self.flow), Arc::clone(&self.flow));
        let mut boundary = Vec::new();
        for side in SIDES {
            let Some(tag) = background.tag(side) else { continue };
            let condition = if self.open.contains(&side) {
                let (flow, viscosity) = (Arc::clone(&self.flow), self.viscosity);
                FluidBoundary::Open {
                    traction: Some(Arc::new(move |x, n, t| {
                        let gradient = flow.gradient(x, t);
                        (gradient + gradient.transpose()) * n * viscosity - n * flow.pressure(x, t)
                    })),
                    backflow: false,
                }
            } else {
                FluidBoundary::Velocity(self.velocity())
            };
            boundary.push((tag, condition));
        }
        let fluid = FluidSetup {
            convection: self.convects.then_some(ConvectionForm::Standard),
            body_force: Some(Arc::new(move |x, t| forcing.force(x, t))),
            initial_velocity: Some(Arc::new(move |x| at_start.velocity(x, 0.0))),
            boundary,
            ..fluid(background, self.density, self.viscosity)
        };
        problem(fluid, dt)
    }

    /// Returns the velocity of the flow as a field.
    pub(super) fn velocity(&self) -> TimeField<2> {
        let flow = Arc::clone(&self.flow);
        Arc::new(move |x, t| flow.velocity(x, t))
    }

    /// Returns the errors of a state in L2: velocity, its gradient, and pressure, from which the mean difference is
    /// taken if only velocities are given.
    pub(super) fn errors(&self, setup: &Setup<2>, state: &State<2>) -> Result<Errors, Failure> {
        let (t, of_pressure) = (state.time, wet(state)?.pressure_time);
        let shift = if self.open.is_empty() {
            let [integral, volume] =
                integrals(setup, state, |at| [at.pressure - self.flow.pressure(&at.x, of_pressure), 1.0])?;
            integral / volume
        } else {
            0.0
        };
        let squares = integrals(setup, state, |at| {
            [
                (at.velocity - self.flow.velocity(&at.x, t)).norm_squared(),
                (at.gradient - self.flow.gradient(&at.x, t)).norm_squared(),
                (at.pressure - self.flow.pressure(&at.x, of_pressure) - shift).powi(2),
            ]
        })?;
        Ok(Errors::of_squares(squares))
    }
}

/// Returns the fluid at rest without convection, forces and conditions, with the standard stabilisation.
pub(super) fn fluid<const D: usize>(background: SimplexMesh<D>, density: f64, viscosity: f64) -> FluidSetup<D> {
    FluidSetup { convection: None, ..FluidSetup::new(background, NewtonianFluid { density, viscosity }) }
}

/// Returns a setup with a fluid and without bodies.
pub(super) fn problem<const D: usize>(fluid: FluidSetup<D>, dt: f64) -> Setup<D> {
    let newton = NewtonSettings::new(1e-11);
    Setup {
        fluid: Some(fluid),
        bodies: Vec::new(),
        contacts: Vec::new(),
        scheme: Arc::new(ImplicitEuler),
        dt,
        most_halvings: 0,
        approach: None,
        newton,
    }
}

/// Errors in L2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errors {
    pub(super) velocity: f64,
    pub(super) gradient: f64,
    pub(super) pressure: f64,
}

impl Errors {
    fn of_squares(squares: [f64; 3]) -> Self {
        let [velocity, gradient, pressure] = squares.map(f64::sqrt);
        Self { velocity, gradient, pressure }
    }
}

/// Computes the norms of the difference of two states with the same cut.
pub(super) fn differences(setup: &Setup<2>, a: &State<2>, b: &State<2>) -> Result<Errors, Failure> {
    let mut between = a.clone();
    if let (Some(between), Some(b)) = (&mut between.fluid, &b.fluid) {
        between.velocity.iter_mut().zip(&b.velocity).for_each(|(a, b)| *a -= b);
        between.pressure.iter_mut().zip(&b.pressure).for_each(|(a, b)| *a -= b);
    }
    let squares = |at: &FlowPoint| [at.velocity.norm_squared(), at.gradient.norm_squared(), at.pressure.powi(2)];
    Ok(Errors::of_squares(integrals(setup, &between, squares)?))
}

/// Discrete fields at a quadrature point of the fluid.
pub(super) struct FlowPoint {
    pub(super) x: P,
    velocity: V,
    pub(super) gradient: T,
    pressure: f64,
}

/// Computes integrals over the fluid.
pub(super) fn integrals<const N: usize>(
    setup: &Setup<2>,
    state: &State<2>,
    values: impl Fn(&FlowPoint) -> [f64; N],
) -> Result<[f64; N], Failure> {
    let (background, fluid) = (&fluid_of(setup)?.background, wet(state)?);
    let mut sums = [0.0; N];
    let parts = PartValues::new(background, &fluid.cut);
    for part in fluid.cut.all_parts() {
        let dofs = fluid.space.dofs(part);
        let gradient: T =
            dofs.iter().zip(parts.gradients(part)).map(|(&k, g)| fluid.velocity[k as usize] * g.transpose()).sum();
        parts.for_each_point(background, &fluid.cut, part, 4, |x, weight, shape| {
            let (velocity, pressure) = fluid.at(part, shape);
            let at = FlowPoint { x: *x, velocity, gradient, pressure };
            sums.iter_mut().zip(values(&at)).for_each(|(sum, value)| *sum += weight * value);
        });
    }
    Ok(sums)
}

/// Returns a body with a given motion whose surface is the polygon through corners, counter-clockwise; loops after the
/// first are holes, clockwise.
pub(super) fn polygon(
    loops: &[Vec<P>],
    position: impl Fn(&P, f64) -> P + Send + Sync + 'static,
    velocity: TimeField<2>,
) -> Arc<dyn Body<2>> {
    polygon_of_particles(loops, position, Arc::new(move |x, [_, t]| velocity(x, t)))
}

/// Returns a polygon as [`polygon`] does, with the velocity of the particles of the surface.
pub(super) fn polygon_of_particles(
    loops: &[Vec<P>],
    position: impl Fn(&P, f64) -> P + Send + Sync + 'static,
    velocity: ParticleVelocity<2>,
) -> Arc<dyn Body<2>> {
    Arc::new(PrescribedBody {
        name: "body".to_owned(),
        boundary: boundary(loops),
        reference: loops.concat(),
        position: Arc::new(position),
        velocity,
    })
}

/// Returns the sides of polygons as a boundary mesh.
pub(super) fn boundary(loops: &[Vec<P>]) -> BoundaryMesh<2> {
    let mut facets = Vec::new();
    let mut first = 0;
    for corners in loops {
        let n = corners.len();
        facets.extend((0..n).flat_map(|k| [VertexId::new(first + k), VertexId::new(first + (k + 1) % n)]));
        first += n;
    }
    BoundaryMesh::from_facets(facets)
}

/// Returns the area of a polygon.
pub(super) fn area(corners: &[P]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    0.5 * corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

/// Returns a free rigid body inside of the polygon through corners, counter-clockwise.
pub(super) fn rigid_polygon(corners: Vec<P>, density: f64, gravity: V) -> Result<RigidBody<2>, Failure> {
    let loops = [corners];
    Ok(RigidBody::new("body", boundary(&loops), loops.concat(), density, gravity)?)
}

const DRY: &str = "there is no fluid";

/// Returns the fluid of a setup.
pub(super) fn fluid_of<const D: usize>(setup: &Setup<D>) -> Result<&FluidSetup<D>, Failure> {
    Ok(setup.fluid.as_ref().ok_or(DRY)?)
}

/// Returns the fluid as [`fluid_of`] does, mutably.
pub(super) fn fluid_mut<const D: usize>(setup: &mut Setup<D>) -> Result<&mut FluidSetup<D>, Failure> {
    Ok(setup.fluid.as_mut().ok_or(DRY)?)
}

/// Puts one condition on all sides of the box.
pub(super) fn set_sides(setup: &mut Setup<2>, condition: impl Fn() -> FluidBoundary<2>) -> Result<(), Failure> {
    fluid_mut(setup)?.boundary.iter_mut().for_each(|(_, on_side)| *on_side = condition());
    Ok(())
}

/// Puts a condition on one side of the box.
pub(super) fn set_side<const D: usize>(
    setup: &mut Setup<D>,
    side: &str,
    condition: FluidBoundary<D>,
) -> Result<(), Failure> {
    let fluid = fluid_mut(setup)?;
    let tag = fluid.background.tag(side).ok_or("a side has no name")?;
    match fluid.boundary.iter_mut().find(|(other, _)| *other == tag) {
        Some((_, on_side)) => *on_side = condition,
        None => fluid.boundary.push((tag, condition)),
    }
    Ok(())
}

/// Returns the condition of a side without traction.
pub(super) fn open<const D: usize>() -> FluidBoundary<D> {
    FluidBoundary::Open { traction: None, backflow: false }
}

/// Returns the condition of a side of a box that is open but for its bottom.
pub(super) fn wall_below(side: &str) -> FluidBoundary<2> {
    if side == "bottom" { FluidBoundary::NoSlip } else { open() }
}

pub(super) fn wet<const D: usize>(state: &State<D>) -> Result<&FluidState<D>, Failure> {
    Ok(state.fluid.as_ref().ok_or(DRY)?)
}

/// Returns the fluid's part of a report.
pub(super) fn wet_report<const D: usize>(report: &StepReport<D>) -> Result<&FluidReport<D>, Failure> {
    Ok(report.fluid.as_ref().ok_or(DRY)?)
}

/// Returns the pieces of the interface, with the tractions on them.
pub(super) fn interface<'s, const D: usize>(
    state: &'s State<D>,
    report: &'s StepReport<D>,
) -> Result<impl Iterator<Item = (&'s InterfacePiece<D>, &'s InterfaceTraction<D>)>, Failure> {
    Ok(wet(state)?.cut.interface().iter().zip(&wet_report(report)?.tractions))
}

/// Returns the outside of a closed curve, in a square around a centre: a polygon with a hole.
pub(super) fn outside(mut curve: Vec<P>, centre: P, half: f64) -> [Vec<P>; 2] {
    curve.reverse();
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    [corners.map(|[x, y]| centre + P::new(x, y) * half).to_vec(), curve]
}

/// Returns the corners of a regular polygon with the area of the disk.
pub(super) fn disk(centre: P, radius: f64, n: usize) -> Vec<P> {
    let step = std::f64::consts::TAU / n as f64;
    let radius = radius * (step / step.sin()).sqrt();
    (0..n).map(|k| centre + P::new((step * k as f64).cos(), (step * k as f64).sin()) * radius).collect()
}

/// Takes steps from the state at the start; returns the last state and its report.
pub(super) fn run<const D: usize>(setup: &Setup<D>, n_steps: usize) -> Result<(State<D>, StepReport<D>), Failure> {
    let mut work = Workspace::new();
    let mut state = State::initial(setup)?;
    let mut last = None;
    for _ in 0..n_steps {
        let (next, report) = advance(setup, &state, Substep::whole(setup.dt), &mut work)?;
        state = next;
        last = Some(report);
    }
    Ok((state, last.ok_or("no steps")?))
}

/// Computes the force of the fluid on a body, and its moment about a point, from the variational traction of the
/// mortar.
pub(super) fn force(state: &State<2>, report: &StepReport<2>, body: usize, about: &P) -> Result<(V, f64), Failure> {
    let mut sum = (V::zeros(), 0.0);
    for (_, traction) in interface(state, report)?.filter(|(piece, _)| piece.body.index() == body) {
        sum.0 += traction.total() * traction.measure;
        sum.1 += traction.moment(about)[2] * traction.measure;
    }
    Ok(sum)
}

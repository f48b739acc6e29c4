//! One time step: the page to read first.

use std::time::Instant;

use algebra::{Workspace, newton};
use cutcell::CutMesh;
use mesh::{Point, Vector};

use crate::bodies;
use crate::problem::StepForms;
use crate::setup::BodyKind;
use crate::{
    FluidState, FsiProblem, Setup, Stage, StageSeconds, State, StepError, StepGeometry, StepReport, StepSystem,
};

/// A step of the setup, or a part of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substep {
    /// Its length.
    pub dt: f64,
    /// Whether a step of the setup ends with it.
    pub is_last: bool,
}

/// Advances the coupled problem by one step on the geometry of the previous state.
///
/// See [`advance_by`].
///
/// # Errors
/// [`StepError`] with the stage that failed; the previous state is untouched.
pub fn advance<const D: usize>(
    setup: &Setup<D>,
    previous: &State<D>,
    work: &mut Workspace,
) -> Result<(State<D>, StepReport<D>), StepError> {
    advance_by(setup, previous, Substep { dt: setup.dt, is_last: true }, work)
}

/// Advances the coupled problem by a step, or a part of one, on the geometry of the previous state.
///
/// A function of setup and state: the workspace recycles memory and, but for a linear solver that keeps old factors
/// ([`Workspace::forget`]), changes no bits.
///
/// # Errors
/// [`StepError`] with the stage that failed; the previous state is untouched.
pub fn advance_by<const D: usize>(
    setup: &Setup<D>,
    previous: &State<D>,
    substep: Substep,
    work: &mut Workspace,
) -> Result<(State<D>, StepReport<D>), StepError> {
    let end = previous.next_time(substep.dt);
    let failed = |stage: Stage| StepError::at(previous.step + 1, end, stage);
    let clock = Instant::now();

    let positions = setup.positions(&previous.bodies);
    check_domain(setup, &positions).map_err(failed)?;
    let cut = CutMesh::overlay(&setup.background, &setup.surfaces(&positions), &setup.overlay)
        .map_err(|e| failed(e.into()))?;
    check_interface(&cut).map_err(failed)?;
    let seconds_cut = clock.elapsed().as_secs_f64();
    let geometry = StepGeometry::new(setup, previous, positions, cut);
    let seconds = StageSeconds {
        cut: seconds_cut,
        space: clock.elapsed().as_secs_f64() - seconds_cut,
        transfer: geometry.seconds_transfer,
        ..StageSeconds::default()
    };
    let system = StepSystem::new(setup, &geometry, previous, substep.dt).map_err(|e| failed(e.into()))?;
    let forms = StepForms::new(setup, &geometry, &system);
    let problem = FsiProblem::new(setup, &geometry, &system, &forms, previous).map_err(|e| failed(e.into()))?;
    let mut x = problem.initial_guess(&geometry, previous);
    let solve = newton(&problem, &mut x, work, &setup.newton).map_err(|e| failed(e.into()))?;

    problem.bodies.check_contacts(&x, &solve).map_err(failed)?;

    let state = accept(setup, substep, &geometry, &system, previous, &x);
    let report = StepReport::new(setup, substep, &geometry, &system, &problem, solve, &x, previous, &state, seconds);
    Ok((state, report))
}

/// Refuses a body that is moved by forces and has left the bounds of the background: it would fall for ever.
fn check_domain<const D: usize>(setup: &Setup<D>, positions: &[Vec<Point<D>>]) -> Result<(), Stage> {
    let vertices = setup.background.vertices().iter();
    let none = (Point::<D>::repeat(f64::INFINITY), Point::<D>::repeat(f64::NEG_INFINITY));
    let (low, high) = vertices.fold(none, |(low, high), x| (low.inf(x), high.sup(x)));
    let is_inside = |x: &Point<D>| (0..D).all(|a| low[a] <= x[a] && x[a] <= high[a]);
    for (body, positions) in setup.bodies.iter().zip(positions) {
        if !matches!(body.kind, BodyKind::Prescribed(_)) && !positions.iter().any(is_inside) {
            return Err(Stage::LeftDomain { body: body.name.clone() });
        }
    }
    Ok(())
}

/// Refuses a cut with a hole in the coupling of fluid and bodies.
fn check_interface<const D: usize>(cut: &CutMesh<D>) -> Result<(), Stage> {
    /// A hole of this share of the interface is a matter of round-off.
    const LARGEST_SHARE: f64 = 1e-6;
    let uncovered = cut.report().uncovered_measure;
    let interface: f64 = cut.interface().iter().map(|piece| piece.measure).sum();
    if uncovered > LARGEST_SHARE * interface { Err(Stage::Interface { uncovered, interface }) } else { Ok(()) }
}

/// The new state from the solution of a step.
fn accept<const D: usize>(
    setup: &Setup<D>,
    substep: Substep,
    geometry: &StepGeometry<D>,
    system: &StepSystem<D>,
    previous: &State<D>,
    x: &[f64],
) -> State<D> {
    let vectors = |range: std::ops::Range<usize>| -> Vec<Vector<D>> {
        x[range].chunks_exact(D).map(Vector::from_column_slice).collect()
    };
    let mut pressure = x[system.layout.range(system.pressure)].to_vec();
    system.pockets.iter().for_each(|pocket| pocket.remove_mean(geometry, &mut pressure));
    State {
        step: previous.step + usize::from(substep.is_last),
        time: system.time,
        bodies: bodies::accept(&setup.bodies, &system.bodies, &system.layout, system.time, x),
        fluid: FluidState {
            positions: geometry.positions.clone(),
            cut: geometry.cut.clone(),
            space: geometry.space.clone(),
            velocity: vectors(system.layout.range(system.velocity)),
            pressure,
        },
    }
}

//! The ball of the cases begins to fall: it has to take the fluid around it along.

use std::sync::Arc;

use cutwater::algebra::{LaggedSettings, LaggedSolver, Workspace};
use cutwater::io::ScenarioFile;
use cutwater::io::scenario::{Case, CaseVisitor, lower};
use cutwater::solid_rigid::RigidBody;
use cutwater::solver::{Observer, ObserverError, Setup, State, StepView, TimeLoop};

use super::record::Record;
use crate::case::scenario_path;
use crate::outcome::Failure;
use crate::table::short;

/// Acceleration of a rigid ball in ideal fluid, `-g m/(m + M_a)` with the added mass of the case's box, cm/s².
const RIGID: f64 = -594.5;
/// Largest relative error of the extrapolated acceleration.
const ACCURACY: f64 = 0.005;

/// Measures the first acceleration of a rigid ball, and the mean of the elastic one over 10 ms.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let sizes: &[f64] = if record.full { &[0.4, 0.2, 0.1, 0.05] } else { &[0.8, 0.4, 0.2] };
    let mut curves = Vec::new();
    for (name, is_rigid, n_steps) in [("rigid ball, first 1 ms", true, 1), ("elastic ball, mean of 10 ms", false, 10)] {
        let mut curve = Vec::new();
        for &h in sizes {
            let acceleration = acceleration(h, is_rigid, n_steps)?;
            record.show(format!("{name}: acceleration at h = {} cm [cm/s²]", short(h)), acceleration, Some(RIGID));
            curve.push((h, acceleration));
        }
        let [.., (_, coarse), (_, fine)] = curve[..] else { return Err("two meshes at least".into()) };
        // The mesh carries a layer of its own thickness along: the error is of first order.
        let limit = 2.0 * fine - coarse;
        if is_rigid {
            record.near_relative(format!("{name}: extrapolated to h = 0 [cm/s²]"), limit, RIGID, ACCURACY);
        } else {
            let approaches = curve.windows(2).all(|w| (w[1].1 - RIGID).abs() < (w[0].1 - RIGID).abs());
            record.at_least(
                format!("{name}: every refinement is nearer to that of a rigid ball"),
                f64::from(approaches),
                1.0,
            );
        }
        curves.push((name.to_owned(), curve));
    }
    record.figure("Acceleration of the ball [cm/s²]", "h [cm]", curves);
    record.note("The virtual barrier with cells of one size and the consistent profile of the interior penalty; linear extrapolation from the last two meshes.");
    Ok(())
}

fn acceleration(h: f64, is_rigid: bool, n_steps: usize) -> Result<f64, Failure> {
    let set = [
        format!("background.size={h}"),
        format!("body.0.shape.size={h}"),
        "fluid.cip={profile=\"consistent\",gamma_u=0.1}".to_owned(),
        "time.step=1e-3".to_owned(),
        "time.end=0.01".to_owned(),
    ];
    lower(&ScenarioFile::read(&scenario_path("virtual-barrier"), &set)?, Run { is_rigid, n_steps })?
}

/// Velocity of the centre of mass over time, after the last step.
#[derive(Default)]
struct Mean(f64);

impl<const D: usize> Observer<D> for Mean {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        if let Some(balance) = view.report.and_then(|report| report.bodies[0].balance.as_ref()) {
            self.0 = balance.momentum[D - 1] / balance.mass / view.state.time;
        }
        Ok(())
    }
}

struct Run {
    is_rigid: bool,
    n_steps: usize,
}

impl CaseVisitor for Run {
    type Output = Result<f64, Failure>;

    fn visit<const D: usize>(self, mut case: Case<D>) -> Self::Output {
        if self.is_rigid {
            make_rigid(&mut case.setup)?;
        }
        let mut mean = Mean::default();
        let state = State::initial(&case.setup)?;
        let work = Workspace::with_solver(Box::new(LaggedSolver::new(LaggedSettings::default())));
        TimeLoop::new(&case.setup, state, work).run(self.n_steps, &mut [&mut mean])?;
        Ok(mean.0)
    }
}

/// Makes a rigid body of the half ball, held on its plane of symmetry.
fn make_rigid<const D: usize>(setup: &mut Setup<D>) -> Result<(), Failure> {
    let ball = &setup.bodies[0];
    let start = ball.start();
    let solid = ball.cells(&start).ok_or("the ball is elastic")?.mesh;
    let balance = ball.balance(&start).ok_or("the ball is elastic")?;
    let density = balance.mass / solid.cells().map(|cell| solid.simplex(cell).volume()).sum::<f64>();
    let gravity = balance.body_force / balance.mass;
    let (surface, reference) = (ball.surface().clone(), ball.reference().to_vec());
    let mut rigid = RigidBody::new(ball.name(), surface, reference, density, gravity)?;
    rigid.held_axes[0] = true;
    rigid.holds_rotation = true;
    setup.bodies[0] = Arc::new(rigid);
    Ok(())
}

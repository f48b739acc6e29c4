//! First acceleration of the ball of the cases, which the added mass of the fluid reduces.

use std::sync::Arc;

use cutwater::io::ScenarioFile;
use cutwater::io::scenario::case::case;
use cutwater::solid_rigid::RigidBody;
use cutwater::solver::Setup;

use super::flow::fluid_mut;
use super::{DirectRun, Failure, Record, short};
use crate::case::scenario_path;
use crate::units::cgs;

/// Acceleration of a rigid ball in ideal fluid, `-g m/(m + M_a)` with the added mass of the case's box, cm/s².
const RIGID: f64 = -594.5;
/// Largest relative error of the extrapolated acceleration.
const ACCURACY: f64 = 0.005;

/// Sets of stabilisation parameters that are compared; the first one is judged.
const SETS: [&str; 2] = ["standard", "paper-44-2019"];

// Required order in the time step of the velocity of the rigid ball, with the scheme of second order, and its spectral
// radius.
const TIME_ORDER: f64 = 1.8;
const RHO_INF: f64 = 0.5;
// Time of that velocity, and the longest step.
const FALL: f64 = 0.04;
const LONGEST_STEP: f64 = 4e-3;

/// Measures the first acceleration of a rigid ball, and the mean of the elastic one over 10 ms.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let sizes: &[f64] = if record.full { &[0.4, 0.2, 0.1, 0.05] } else { &[0.8, 0.4, 0.2] };
    let mut curves = Vec::new();
    for (name, is_rigid, n_steps) in [("rigid ball, first 1 ms", true, 1), ("elastic ball, mean of 10 ms", false, 10)] {
        let mut curve = Vec::new();
        for &h in sizes {
            let [standard, paper] = SETS.map(|set| acceleration(h, is_rigid, n_steps, set));
            let (standard, at) =
                (standard?, cgs(&format!("acceleration at h = {} <length> [<acceleration>]", short(h))));
            record.show(format!("{name}: {at}"), standard, Some(RIGID));
            record.show(format!("{name}, the paper's set: {at}"), paper?, Some(RIGID));
            curve.push((h, standard));
        }
        let [.., (_, coarse), (_, fine)] = curve[..] else { return Err("two meshes at least".into()) };
        // A layer of fluid of the thickness of a cell moves with the body: the error is of first order.
        let limit = 2.0 * fine - coarse;
        if is_rigid {
            record.near_relative(
                cgs(&format!("{name}: extrapolated to h = 0 [<acceleration>]")),
                limit,
                RIGID,
                ACCURACY,
            );
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
    for (time, of_time) in [(None, ""), (Some(LONGEST_STEP), ", fixed time in the penalty of the pressure")] {
        let mut changes = Vec::new();
        for pair in (0..5).map(|k| LONGEST_STEP * 0.5_f64.powi(k)).collect::<Vec<_>>().windows(2) {
            changes.push((pair[0], (velocity(pair[0], time)? - velocity(pair[1], time)?).abs()));
        }
        record.order(
            &cgs(&format!(
                "free rigid ball, generalised-α{of_time}: velocity at 40 ms, change when dt is halved [<velocity>]"
            )),
            "dt",
            &changes,
            TIME_ORDER,
        );
    }
    record.figure(cgs("Acceleration of the ball [<acceleration>]"), &cgs("h [<length>]"), curves);
    record.note("A fixed time in the penalty of the pressure is `fluid.stabilisation.time`; it is the longest step of the study.");
    record.note("The virtual barrier with cells of one size and the standard stabilisation; linear extrapolation from the last two meshes.");
    Ok(())
}

/// Computes the velocity of the rigid ball after a fall of [`FALL`], with the scheme of second order and a time in the
/// penalty of the pressure.
fn velocity(dt: f64, time: Option<f64>) -> Result<f64, Failure> {
    let set = [
        "background.size=0.4".to_owned(),
        "body.0.shape.size=0.4".to_owned(),
        "fluid.stabilisation=standard".to_owned(),
        format!("time.step={dt}"),
        format!("time.end={FALL}"),
        format!("time.scheme={{ kind = \"generalised-alpha\", rho_inf = {RHO_INF} }}"),
    ];
    let mut case = case::<2>(&ScenarioFile::read(&scenario_path("virtual-barrier"), &set)?)?;
    make_rigid(&mut case.setup)?;
    fluid_mut(&mut case.setup)?.stabilisation.time = time;
    let mut run = DirectRun::lagged(case.setup)?;
    run.advance_by(case.n_steps as u32)?;
    Ok(run.state.bodies[0].velocity().first().ok_or("the ball has vertices")?[1])
}

/// Computes the velocity of the centre of mass after some steps with a set of stabilisation parameters, divided by the
/// time.
fn acceleration(h: f64, is_rigid: bool, n_steps: u32, of: &str) -> Result<f64, Failure> {
    let set = [
        format!("background.size={h}"),
        format!("body.0.shape.size={h}"),
        format!("fluid.stabilisation={of}"),
        "time.step=1e-3".to_owned(),
        "time.end=0.01".to_owned(),
    ];
    let mut case = case::<2>(&ScenarioFile::read(&scenario_path("virtual-barrier"), &set)?)?;
    if is_rigid {
        make_rigid(&mut case.setup)?;
    }
    let mut run = DirectRun::lagged(case.setup)?;
    let report = run.advance_by(n_steps)?;
    let balance = report.bodies[0].balance.as_ref().ok_or("the ball has a mass")?;
    Ok(balance.momentum[1] / balance.mass / run.state.time)
}

/// Makes a rigid body of the half ball, held on its plane of symmetry.
fn make_rigid(setup: &mut Setup<2>) -> Result<(), Failure> {
    let ball = &setup.bodies[0];
    let start = ball.initial();
    let balance = ball.balance(&start).ok_or("the ball is elastic")?;
    let density = balance.mass / balance.volume;
    let gravity = balance.body_force / balance.mass;
    let (surface, reference) = (ball.surface().clone(), ball.reference().to_vec());
    let mut rigid = RigidBody::new(ball.name(), surface, reference, density, gravity)?;
    rigid.held_axes[0] = true;
    rigid.holds_rotation = true;
    setup.bodies[0] = Arc::new(rigid);
    Ok(())
}

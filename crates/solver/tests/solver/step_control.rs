//! Steps that fail are divided, and their substeps have the same result as smaller steps.

use crate::fixture::*;
use solid_svk::SupportKind;
use solver::algebra::{LaggedSettings, LaggedSolver, NewtonSettings, Workspace};
use solver::mesh::generate::structured_box;
use solver::{Error, Observer, ObserverError, Setup, State, StepView, Substep, TimeLoop, advance};

/// Returns the setup of a block that is accelerated towards a clamped one, so fast that it moves farther in the first
/// step than contacts are searched.
fn thrown_block(most_halvings: usize, lift: f64) -> Setup<2> {
    let background = structured_box::<2>([0.0, 0.0], [2.0, 2.0], [12, 12]).expect("a box");
    let mut setup = setup(fluid(background, 1e-3, 1e-2), 1e-3);
    setup.newton = NewtonSettings::new(1e-8);
    setup.most_halvings = most_halvings;
    on_sides(&mut setup, &["bottom"], || solver::FluidBoundary::NoSlip);
    let block = structured_box::<2>([0.75, 0.55], [1.25, 1.05], [2, 2]).expect("a box");
    let ground = structured_box::<2>([0.15, 0.2], [1.85, 0.45], [6, 1]).expect("a box");
    let mut block = elastic("block", block, 1.0, 2e6, 8e6, V::new(0.0, -4e5));
    block.options.initial_displacement = Some(std::sync::Arc::new(move |_| V::new(0.0, lift)));
    let mut ground = elastic("ground", ground, 1.0, 2e6, 8e6, V::zeros());
    ground.support("bottom", SupportKind::Clamped);
    setup.bodies.extend([block.body(), ground.body()]);
    setup.contacts.push(contact(&setup.bodies, 0, (1e8, 0.05, 0.02), against(1, &setup.bodies)));
    setup
}

/// Number, end and length of a step or substep.
type Taken = (usize, f64, Substep);

/// Steps and substeps that an observer received.
#[derive(Default)]
struct AllTaken(Vec<Taken>);

impl Observer<2> for AllTaken {
    fn after_step(&mut self, view: &StepView<'_, 2>) -> Result<(), ObserverError> {
        if let Some(report) = view.report {
            assert_eq!(view.ends_step(), report.substep.is_last);
            self.0.push((view.state.step, view.state.time, report.substep));
        }
        Ok(())
    }
}

fn take_steps(setup: &Setup<2>, n: usize) -> (State<2>, Vec<Taken>, Result<(), solver::StepError>) {
    let start = State::initial(setup).expect("a cut");
    let mut run = TimeLoop::new(setup, start, Workspace::new());
    let mut taken = AllTaken::default();
    let outcome = run.run(n, &mut [&mut taken]);
    (run.state().clone(), taken.0, outcome)
}

#[test]
fn ends_of_steps_are_multiples_and_those_of_short_substeps_are_not() {
    let setup = thrown_block(0, 0.0);
    let state = State { time: 0.7999999999999999, ..State::initial(&setup).expect("a cut") };
    assert_eq!(state.next_time(0.1), 9.0 * 0.1);
    let late = State { time: 10.0, ..state };
    for dt in [1.2e-8, 3.1e-10] {
        assert!((late.next_time(dt) - 10.0 - dt).abs() < 4e-15, "{dt}");
    }
}

#[test]
fn a_step_that_may_miss_contact_is_divided() {
    let setup = thrown_block(6, 0.0);
    let n = 4;
    let (state, taken, outcome) = take_steps(&setup, n);
    outcome.expect("substeps that succeed");
    // The search allows a motion of 0.04, and the block would move by 0.4.
    assert!(taken[0].2.dt <= 0.5 * setup.dt, "{taken:?}");
    assert_eq!(state.step, n);
    assert!((state.time - n as f64 * setup.dt).abs() < 1e-15);
    assert_eq!(taken.iter().filter(|(_, _, substep)| substep.is_last).count(), n);
    let mut time = 0.0;
    for (step, end, Substep { dt, is_last }) in &taken {
        time += dt;
        assert!((time - end).abs() < 1e-15);
        // `step` is the number of complete whole steps.
        assert_eq!(*step, if *is_last { (time / setup.dt).round() as usize } else { (time / setup.dt) as usize });
    }
    // A later substep is longer than the first: steps grow back.
    assert!(taken.iter().any(|(_, _, substep)| substep.dt > taken[0].2.dt), "{taken:?}");

    // The same steps, one after the other.
    let (mut by_hand, mut work) = (State::initial(&setup).expect("a cut"), Workspace::new());
    for (_, _, substep) in taken {
        by_hand = advance(&setup, &by_hand, substep, &mut work).expect("a substep").0;
    }
    assert_eq!(by_hand.bodies, state.bodies);
    assert_eq!(wet(&by_hand).pressure, wet(&state).pressure);
}

#[test]
fn without_halvings_the_run_stops_at_the_last_good_state() {
    let setup = thrown_block(0, 0.0);
    let (state, taken, outcome) = take_steps(&setup, 1);
    let error = outcome.expect_err("contact may be missed");
    assert!(
        matches!(error.source, Error::MissedContact { contact: 0, motion, room, .. } if motion > room && room > 0.03),
        "{error:?}"
    );
    assert!(taken.is_empty() && state.time == 0.0);
    // One halving is not enough; the error names the substep that failed.
    let (_, _, outcome) = take_steps(&thrown_block(1, 0.0), 1);
    let error = outcome.expect_err("contact may still be missed");
    assert_eq!((error.step, error.time), (1, 5e-4));
}

#[test]
fn a_failure_of_newton_is_repaired_by_smaller_steps() {
    // Four corrections are too few for the first touch in one long step.
    let mut setup = falling_ball(0.8, 1.0005, 1.0, false);
    setup.dt = 8e-3;
    setup.newton.max_iterations = 4;
    let mut work = Workspace::with_solver(Box::new(LaggedSolver::new(LaggedSettings::default())));
    let start = State::initial(&setup).expect("a cut");
    let whole = advance(&setup, &start, Substep::whole(setup.dt), &mut work);
    assert!(matches!(whole.expect_err("too few corrections").source, Error::Newton(_)));
    setup.most_halvings = 8;
    let (state, taken, outcome) = take_steps(&setup, 1);
    outcome.expect("substeps of the step");
    assert_eq!(state.time, setup.dt);
    assert!(taken.len() > 1);
}

#[test]
fn bodies_far_apart_may_move_fast() {
    // The motion exceeds the searched distance, but the gap exceeds the motion.
    let setup = thrown_block(0, 0.4);
    let (state, taken, outcome) = take_steps(&setup, 1);
    outcome.expect("nothing to miss");
    assert!(state.step == 1 && taken.len() == 1);
}

/// Steps of unequal length, as they follow from halvings, keep the second order of the scheme.
#[test]
fn divided_steps_are_of_second_order() {
    let background = structured_box::<2>([0.0, 0.0], [2.0, 2.0], [8, 8]).expect("a box");
    // In a light fluid the weight of the penalty of the pressure hardly depends on the step.
    let mut setup = setup(fluid(background, 1e-6, 1.0), 5e-4);
    setup.scheme = second_order(0.0);
    setup.newton = NewtonSettings::new(1e-11);
    on_sides(&mut setup, &["bottom", "left", "right", "top"], || solver::FluidBoundary::NoSlip);
    let block = structured_box::<2>([0.72, 0.81], [1.19, 1.27], [1, 1]).expect("a box");
    setup.bodies.push(std::sync::Arc::new(rigid("block", &block, 2.0, V::new(0.0, -1.0))));
    // After the start, which is singular in time.
    let (start, _) = run(&setup, 40);
    let fall = |n: usize| {
        let (mut state, mut work) = (start.clone(), Workspace::new());
        for share in std::iter::repeat_n([0.5, 0.25, 0.25], n).flatten() {
            let dt = share * 0.04 / n as f64;
            state = advance(&setup, &state, Substep::whole(dt), &mut work).expect("a step").0;
        }
        motion(&state, 0).velocity[1]
    };
    let [coarse, middle, fine] = [4, 8, 16].map(fall);
    let order = ((coarse - middle) / (middle - fine)).abs().log2();
    assert!(order > 1.8 && order < 2.6, "{order}: {coarse} {middle} {fine}");
}

/// An inverted cell divides the step, then ends the run with the place of the cell.
#[test]
fn cells_do_not_turn_inside_out_silently() {
    let background = structured_box::<2>([0.0, 0.0], [2.0, 2.0], [8, 8]).expect("a box");
    let mut setup = setup(fluid(background, 1.0, 1.0), 1e-3);
    setup.most_halvings = 2;
    on_sides(&mut setup, &["bottom", "left", "right", "top"], || solver::FluidBoundary::NoSlip);
    let block = structured_box::<2>([0.7, 0.7], [1.3, 1.3], [4, 4]).expect("a box");
    let mut block = elastic("block", block, 1e3, 1e2, 1e2, V::zeros());
    // Its lower half is thrown upwards, through the upper one at rest.
    let thrown = |x: &P| V::new(0.0, if x[1] < 0.9 { 150.0 } else { 0.0 });
    block.options.initial_velocity = Some(std::sync::Arc::new(thrown));
    setup.bodies.push(block.body());
    let (_, _, outcome) = take_steps(&setup, 6);
    let error = outcome.expect_err("an inverted cell");
    let Error::Inverted { body, place, ratio, .. } = &error.source else { panic!("{error:?}") };
    assert!(body == "block" && *ratio <= 0.0 && place.len() == 2 && (0.7..1.5).contains(&place[1]), "{error:?}");
    assert!(error.source.smaller_step_may_succeed() && error.source.newton_report().is_some());
    assert!(error.source.to_string().contains("inside out"));
}

//! Newton's method: rates, kept factorisations, regimes, failures.

mod common;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use algebra::{
    BlockLayout, Constraints, DirectSolver, DofId, Equations, Forcing, LinearError, LinearReport, LinearSolver,
    LinearSystem, LocalSystem, NewtonError, NewtonReport, NewtonSettings, Workspace,
};
use common::{Flow, Part, scalar_field, springs};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

/// Returns the contribution of a scalar equation `f(x) = 0`, given by value and derivative.
fn scalar<'a>(function: impl Fn(f64) -> (f64, f64) + Send + Sync + 'a) -> Part<'a> {
    let add = move |_: usize, x: &[f64], out: &mut LocalSystem| {
        let (value, derivative) = function(x[0]);
        out.add(0, value);
        out.add_tangent(0, 0, derivative);
    };
    Part::new("scalar", 1, |_| vec![0], add)
}

/// Solves with Newton's method for one contribution without constraints.
fn newton(
    of: &Part<'_>,
    x: &mut [f64],
    work: &mut Workspace,
    settings: &NewtonSettings,
) -> Result<NewtonReport, NewtonError> {
    let (layout, constraints) = (scalar_field(x.len()), Constraints::new());
    let contributions = vec![Box::new(of.clone()) as _];
    let equations = Equations { layout: &layout, contributions, constraints: &constraints };
    algebra::newton(&equations, x, work, settings)
}

fn exact(tolerance: f64) -> NewtonSettings {
    NewtonSettings { contraction: 0.0, ..NewtonSettings::new(tolerance) }
}

fn cubic(x: f64) -> (f64, f64) {
    (x.powi(3) - 8.0, 3.0 * x * x)
}

/// Returns the observed orders of convergence of any three consecutive corrections above round-off.
fn rates(report: &NewtonReport) -> Vec<f64> {
    let corrections = report.correction_history.windows(3).filter(|c| c[2] > 1e-13);
    corrections.map(|c| (c[2] / c[1]).ln() / (c[1] / c[0]).ln()).collect()
}

#[test]
fn exact_newton_converges_quadratically() {
    let problem = scalar(cubic);
    let mut x = [3.0];
    let report = newton(&problem, &mut x, &mut Workspace::new(), &exact(1e-12)).unwrap();
    assert!((x[0] - 2.0).abs() < 1e-14);
    assert_eq!(report.factorizations, report.iterations);
    assert_eq!(report.residual_history.len(), report.iterations + 1);
    let rates = rates(&report);
    assert!(rates.last().is_some_and(|rate| *rate > 1.8), "{rates:?}");
}

#[test]
fn modified_newton_saves_factorisations() {
    let problem = scalar(cubic);
    let mut x = [2.2];
    let report = newton(&problem, &mut x, &mut Workspace::new(), &NewtonSettings::new(1e-10)).unwrap();
    assert!((x[0] - 2.0).abs() < 1e-10);
    assert!(report.factorizations < report.iterations, "{report:?}");
}

#[test]
fn a_poor_correction_with_an_old_tangent_is_not_used() {
    // x + 0.8 x³ = 1 from zero. The tangent at zero leads to x = 1. The next correction is 0.8 with this tangent, and
    // 0.8/3.4 with the tangent at x = 1.
    let stiffening = scalar(|x: f64| (x + 0.8 * x.powi(3) - 1.0, 1.0 + 2.4 * x * x));
    let report = newton(&stiffening, &mut [0.0], &mut Workspace::new(), &NewtonSettings::new(1e-10)).unwrap();
    let second = 0.8 / 3.4;
    assert!((report.correction_history[1] - second / (1.0 - second)).abs() < 1e-12, "{report:?}");
}

#[test]
fn a_flow_converges_to_the_same_state_with_exact_and_modified_newton() {
    let flow = Flow::new(12, 3.0);
    let equations = flow.equations();
    let n = flow.layout.len();
    let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
    let mut work = Workspace::new();
    let first = algebra::newton(&equations, &mut a, &mut work, &exact(1e-11)).unwrap();
    let second = algebra::newton(&equations, &mut b, &mut work, &NewtonSettings::new(1e-11)).unwrap();
    assert!(second.factorizations < first.factorizations, "{first:?} {second:?}");
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-8));
    for (dof, value) in flow.constraints.iter() {
        assert_eq!(a[dof.index()], value);
    }
    let calls: Vec<_> = first.timings.iter().map(|timing| timing.calls).collect();
    assert_eq!(calls, [first.iterations + 1, 1, first.iterations + 1, 1], "{first:?}");
}

#[test]
fn a_used_workspace_and_more_threads_give_the_same_bits() {
    let mut used = Workspace::new();
    for m in [9, 14, 6] {
        let flow = Flow::new(m, 3.0);
        let solve = |work: &mut Workspace, threads: usize| {
            let mut x = vec![0.0; flow.layout.len()];
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
                let work = work;
                algebra::newton(&flow.equations(), &mut x, work, &NewtonSettings::new(1e-10)).unwrap();
            });
            x.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
        };
        let reference = solve(&mut Workspace::new(), 1);
        assert!(reference == solve(&mut used, 4));
    }
}

#[test]
fn a_linear_problem_takes_one_correction() {
    let flow = Flow::new(8, 0.0);
    let equations = flow.equations();
    let mut x = vec![0.0; flow.layout.len()];
    let mut work = Workspace::new();
    let report = algebra::newton(&equations, &mut x, &mut work, &NewtonSettings::new(1e-10)).unwrap();
    assert_eq!((report.iterations, report.factorizations), (1, 1));
    let again = algebra::newton(&equations, &mut x, &mut work, &NewtonSettings::new(1e-10)).unwrap();
    assert_eq!(again.iterations, 1);
}

#[test]
fn a_state_at_rest_is_accepted_at_the_rounding_of_its_field() {
    // A force that rounding makes irregular below 1e-16, and a solution of zero, to which nothing can be relative.
    let mut random = SplitMix64::seed_from_u64(1);
    let noise = Mutex::new(move || random.random_range(0.0..1e-16));
    let rough = scalar(|x: f64| (x + (noise.lock().unwrap())(), 1.0));
    let solve = |rounding: f64| {
        let mut layout = scalar_field(1);
        let field = layout.fields().next().unwrap();
        layout.set_rounding(field, &[rounding]);
        let constraints = Constraints::new();
        let equations =
            Equations { layout: &layout, contributions: vec![Box::new(rough.clone())], constraints: &constraints };
        algebra::newton(&equations, &mut [1e-16], &mut Workspace::new(), &exact(1e-10))
    };
    assert!(solve(0.0).is_err());
    assert_eq!(solve(1e-15).unwrap().iterations, 1);
}

#[test]
fn without_unknowns_there_is_nothing_to_do() {
    let (layout, constraints) = (BlockLayout::new(), Constraints::new());
    let equations = Equations { layout: &layout, contributions: vec![], constraints: &constraints };
    assert_eq!(algebra::newton(&equations, &mut [], &mut Workspace::new(), &exact(1e-8)).unwrap().iterations, 0);
}

#[test]
fn a_change_of_regime_renews_the_factorisation_and_forbids_to_stop() {
    // Soft below 1, a thousand times stiffer above: x = 1 + 4/1000.
    let mut problem = scalar(|x: f64| if x < 1.0 { (x - 5.0, 1.0) } else { (1.0 + 1e3 * (x - 1.0) - 5.0, 1e3) });
    problem.regime = |x| u64::from(x[0] >= 1.0);
    let mut x = [0.0];
    let report = newton(&problem, &mut x, &mut Workspace::new(), &NewtonSettings::new(1e-10)).unwrap();
    assert!((x[0] - 1.004).abs() < 1e-12);
    assert_eq!(report.factorizations, 2);
    // A regime that changes at every evaluation prevents convergence.
    let mut drifting = scalar(|_: f64| (1.0, 1.0));
    drifting.regime = |x| x[0].to_bits();
    let settings = NewtonSettings { max_iterations: 4, max_halvings: 0, ..NewtonSettings::new(10.0) };
    let error = newton(&drifting, &mut [0.0], &mut Workspace::new(), &settings).unwrap_err();
    assert!(matches!(error, NewtonError::NotConverged { regime_changed: true, .. }), "{error:?}");
}

#[test]
fn a_regime_that_round_off_changes_does_not_prevent_convergence() {
    static N_CALLS: AtomicU64 = AtomicU64::new(0);
    let mut flickering = scalar(cubic);
    flickering.regime = |_| N_CALLS.fetch_add(1, Ordering::Relaxed);
    let mut x = [2.2];
    let report = newton(&flickering, &mut x, &mut Workspace::new(), &exact(1e-8)).unwrap();
    assert!((x[0] - 2.0).abs() < 1e-14 && *report.correction_history.last().unwrap() < 1e-12, "{report:?}");
}

#[test]
fn divergence_is_reported_with_its_history_and_the_start_is_restored() {
    let arctan = scalar(|x: f64| (x.atan(), 1.0 / (1.0 + x * x)));
    for settings in [exact(1e-10), NewtonSettings::new(1e-10)] {
        let settings = NewtonSettings { max_halvings: 0, ..settings };
        let mut x = [1.5];
        let error = newton(&arctan, &mut x, &mut Workspace::new(), &settings).unwrap_err();
        assert!(matches!(error, NewtonError::Diverged { .. }), "{error:?}");
        assert!(error.report().residual_history.len() > 3);
        assert_eq!(x, [1.5]);
    }
    // With a line search both converge, from far away too.
    for (settings, start) in [(exact(1e-10), 1.5), (NewtonSettings::new(1e-10), 1.5), (exact(1e-10), 3.0)] {
        let mut x = [start];
        newton(&arctan, &mut x, &mut Workspace::new(), &settings).unwrap();
        assert!(x[0].abs() < 1e-10);
    }
}

#[test]
fn searches_that_find_no_decrease_end_the_iteration() {
    // From 20 the first full step overshoots to -600, where even 1/256 of the next one is too long. Full steps from
    // there lead ever farther away.
    let arctan = scalar(|x: f64| (x.atan(), 1.0 / (1.0 + x * x)));
    let mut x = [20.0];
    let error = newton(&arctan, &mut x, &mut Workspace::new(), &exact(1e-10)).unwrap_err();
    assert!(matches!(&error, NewtonError::Diverged { report } if report.iterations > 1), "{error:?}");
    let settings = NewtonSettings { max_halvings: 12, ..exact(1e-10) };
    newton(&arctan, &mut x, &mut Workspace::new(), &settings).unwrap();
    assert!(x[0].abs() < 1e-10);
}

#[test]
fn a_residual_that_rises_for_an_iteration_is_accepted() {
    // A x = b with a stiffness of 100 for each component below zero. The first corrections change which components are
    // below zero and raise the residual. If each had to reduce it, halved corrections would end in a corner.
    let (a, b) = ([[3.0, 0.0, 1.0], [2.0, 2.0, -2.0], [0.0, -2.0, 3.0]], [3.0, 2.0, 2.0]);
    let add = move |_: usize, x: &[f64], out: &mut LocalSystem| {
        for (i, row) in a.iter().enumerate() {
            let stiffness = if x[i] < 0.0 { 100.0 } else { 0.0 };
            out.add(i, row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - b[i] + stiffness * x[i]);
            for (j, a) in row.iter().enumerate() {
                out.add_tangent(i, j, a + if i == j { stiffness } else { 0.0 });
            }
        }
    };
    let problem = Part::new("floor", 1, |_| vec![0, 1, 2], add);
    let mut x = [-1.0; 3];
    newton(&problem, &mut x, &mut Workspace::new(), &exact(1e-12)).unwrap();
    for (x, exact) in x.iter().zip([-1.0 / 101.0, 508.0 / 101.0, 406.0 / 101.0]) {
        assert!((x - exact).abs() < 1e-12, "{x} for {exact}");
    }
}

#[test]
fn other_failures_are_named() {
    let no_root = scalar(|x: f64| (x * x + 1.0, 2.0 * x));
    let settings = NewtonSettings { max_iterations: 3, ..exact(1e-10) };
    let error = newton(&no_root, &mut [0.3], &mut Workspace::new(), &settings).unwrap_err();
    assert!(matches!(error, NewtonError::NotConverged { regime_changed: false, .. } | NewtonError::Diverged { .. }));
    assert_eq!(error.report().iterations, 3);
    let root = scalar(|x: f64| ((x - 1.0).sqrt(), 0.5));
    let error = newton(&root, &mut [3.0], &mut Workspace::new(), &settings).unwrap_err();
    assert!(matches!(error, NewtonError::NotFinite { .. }), "{error:?}");
    let flat = scalar(|x: f64| (x * x - 1.0, 2.0 * x));
    let error = newton(&flat, &mut [0.0], &mut Workspace::new(), &settings).unwrap_err();
    assert!(matches!(error, NewtonError::Linear { source: LinearError::EmptyColumn { column: 0 }, .. }));
}

/// A linear solver that leaves exactly as large a residual as it may, or a fixed one. It notes how large it was, with
/// the right-hand side.
struct Lazy {
    direct: DirectSolver,
    fixed: Option<f64>,
    notes: Arc<Mutex<Vec<[f64; 2]>>>,
}

impl LinearSolver for Lazy {
    fn factorize(&mut self, system: &LinearSystem<'_>) -> Result<(), LinearError> {
        self.direct.factorize(system)
    }
    fn solve(
        &mut self,
        system: &LinearSystem<'_>,
        rhs: &[f64],
        x: &mut [f64],
        tolerance: f64,
    ) -> Result<LinearReport, LinearError> {
        let report = self.direct.solve(system, rhs, x, tolerance)?;
        let left = self.fixed.unwrap_or(tolerance);
        x.iter_mut().for_each(|x| *x *= 1.0 - left);
        self.notes.lock().expect("one thread").push([left, rhs[0]]);
        Ok(LinearReport { backward_error: left, ..report })
    }
    fn n_factorizations(&self) -> usize {
        self.direct.n_factorizations()
    }
}

fn lazy(fixed: Option<f64>) -> (Workspace, Arc<Mutex<Vec<[f64; 2]>>>) {
    let notes = Arc::default();
    let solver = Lazy { direct: DirectSolver::new(), fixed, notes: Arc::clone(&notes) };
    (Workspace::with_solver(Box::new(solver)), notes)
}

#[test]
fn adaptive_forcing_keeps_the_order_of_newton_and_wastes_nothing_at_the_end() {
    let (mut work, notes) = lazy(None);
    let settings = NewtonSettings { forcing: Forcing { first: 0.05, largest: 0.1 }, ..exact(1e-9) };
    let mut x = [3.0];
    let report = newton(&scalar(cubic), &mut x, &mut work, &settings).unwrap();
    assert!((x[0] - 2.0).abs() < 3e-9, "{x:?}");
    let notes = notes.lock().unwrap();
    let n = notes.len();
    assert!(n > 4 && n == report.iterations && notes[0][0] == 0.05, "{notes:?}");
    for (k, pair) in notes.windows(2).enumerate() {
        let ([_, before], [forcing, after]) = (pair[0], pair[1]);
        let wanted = (0.9 * (after / before).powf(1.618_033_988_749_895)).min(0.1);
        if k + 2 < n {
            assert!((forcing - wanted).abs() < 1e-12, "{notes:?}");
        } else {
            // The last correction is solved for only as far as the nonlinear tolerance needs it.
            assert!(forcing > 2.0 * wanted, "{notes:?}");
        }
    }
    let rates = rates(&report);
    assert!(rates[..rates.len() - 1].iter().all(|rate| *rate > 1.3), "{rates:?}");
}

#[test]
fn a_linear_solver_that_leaves_a_tenth_converges_at_its_rate() {
    let problem = scalar(|x: f64| (x - 1.0, 1.0));
    let (mut work, _) = lazy(Some(0.1));
    let settings = NewtonSettings::new(2e-6);
    let mut x = [0.0];
    let report = newton(&problem, &mut x, &mut work, &settings).unwrap();
    assert!((x[0] - 1.0).abs() < 4e-6, "{x:?}");
    assert_eq!(report.iterations, 6, "{report:?}");
}

#[test]
fn tied_unknowns_follow_and_the_others_are_in_equilibrium() {
    let layout = scalar_field(7);
    let mut constraints = Constraints::new();
    constraints.set(DofId::new(0), 0.0);
    constraints.set(DofId::new(6), 9.0);
    // Two springs have a given ratio of lengths, and one point follows from a prescribed one as well.
    constraints.tie(DofId::new(2), &[(DofId::new(1), 0.75), (DofId::new(3), 0.25)]);
    constraints.tie(DofId::new(5), &[(DofId::new(4), 0.5), (DofId::new(6), 0.5)]);
    let row = Box::new(springs(7));
    let equations = Equations { layout: &layout, contributions: vec![row], constraints: &constraints };
    let mut x = vec![0.0; 7];
    let report = algebra::newton(&equations, &mut x, &mut Workspace::new(), &exact(1e-12)).unwrap();
    assert_eq!((x[0], x[6]), (0.0, 9.0));
    assert!((x[2] - 0.75 * x[1] - 0.25 * x[3]).abs() < 1e-12 && (x[5] - 0.5 * (x[4] + x[6])).abs() < 1e-12);
    // Virtual work on the motions that the ties admit: of points 1, 3 and 4 with what follows them.
    let force = |k: usize| {
        let e = x[k + 1] - x[k];
        e + e.powi(3)
    };
    let on = |k: usize| force(k) - force(k - 1);
    for work in [on(1) + 0.75 * on(2), on(3) + 0.25 * on(2), on(4) + 0.5 * on(5)] {
        assert!(work.abs() < 1e-10, "{work}");
    }
    assert!(on(2).abs() > 0.1, "the tie has a force");
    let rates = rates(&report);
    assert!(rates.last().is_some_and(|rate| *rate > 1.7), "quadratic: {rates:?} {report:?}");
}

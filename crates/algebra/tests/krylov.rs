//! FGMRES, and factors that are used for matrices of other sizes.

use algebra::{
    BlockLayout, DirectSolver, Gmres, GmresSettings, LaggedSettings, LaggedSolver, LinearError, LinearReport,
    LinearSolver, ScaledMatrix,
};
use sprs::{CsMatI, TriMatI};

/// Returns the matrix of convection and diffusion on an `m` by `m` grid without the points of a disk, and the numbers
/// of its points in the grid as keys. Points next to the disk have a large penalty, as points at an interface have.
fn grid(m: usize, centre: [f64; 2], convection: f64) -> (CsMatI<f64, u32>, Vec<u64>) {
    let inside = |i: usize, j: usize| (i as f64 - centre[0]).hypot(j as f64 - centre[1]) < 0.2 * m as f64;
    let points: Vec<[usize; 2]> = (0..m * m).map(|k| [k % m, k / m]).filter(|[i, j]| !inside(*i, *j)).collect();
    let keys: Vec<u64> = points.iter().map(|[i, j]| (i + m * j) as u64).collect();
    let position = |i: usize, j: usize| keys.binary_search(&((i + m * j) as u64)).ok();
    let mut triplets = TriMatI::new((points.len(), points.len()));
    for (row, &[i, j]) in points.iter().enumerate() {
        let mut diagonal = 4.0;
        let steps: [(i64, i64, f64); 4] = [(1, 0, -1.0), (-1, 0, -1.0 - convection), (0, 1, -1.0), (0, -1, -1.0)];
        for (di, dj, value) in steps {
            let (i, j) = (i as i64 + di, j as i64 + dj);
            if (0..m as i64).contains(&i) && (0..m as i64).contains(&j) {
                match position(i as usize, j as usize) {
                    Some(column) => triplets.add_triplet(row, column, value),
                    None => diagonal += 1e4,
                }
            }
        }
        triplets.add_triplet(row, row, diagonal + convection);
    }
    (triplets.to_csc(), keys)
}

/// Factorises and solves.
fn solve(
    solver: &mut dyn LinearSolver,
    matrix: &CsMatI<f64, u32>,
    keys: &[u64],
    tolerance: f64,
) -> Result<(Vec<f64>, LinearReport), LinearError> {
    let mut layout = BlockLayout::new();
    layout.push_keyed("x", keys.to_vec(), 1);
    let scaled = ScaledMatrix::new(matrix.view())?;
    let system = scaled.system(&layout)?;
    let mut x = vec![0.0; keys.len()];
    solver.factorize(&system)?;
    let report = solver.solve(&system, &right_side(keys), &mut x, tolerance)?;
    Ok((x, report))
}

/// Returns a right-hand side without symmetry.
fn right_side(keys: &[u64]) -> Vec<f64> {
    keys.iter().map(|k| 1.0 + (*k as f64 * 0.37).sin()).collect()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
    a.iter().zip(b).fold(0.0_f64, |d, (a, b)| d.max((a - b).abs())) / size
}

#[test]
fn gmres_meets_its_tolerance_or_returns_an_error() {
    let (matrix, keys) = grid(20, [10.0, 10.0], 0.5);
    let rhs = right_side(&keys);
    let diagonal = matrix.diag();
    // The preconditioner changes from call to call, as flexible GMRES allows.
    let mut calls = 0;
    let mut precondition = |r: &[f64], z: &mut [f64]| {
        calls += 1;
        let factor = if calls % 2 == 0 { 1.0 } else { 0.3 };
        z.iter_mut().zip(r).zip(diagonal.data()).for_each(|((z, r), d)| *z = factor * r / d);
        Ok(())
    };
    let mut x = Vec::new();
    let settings = GmresSettings { tolerance: 1e-10, restart: 30, max_iterations: 500 };
    let report = Gmres::default().solve(&matrix, &mut precondition, &rhs, &mut x, &settings).unwrap();
    let mut image = vec![0.0; rhs.len()];
    sprs::prod::mul_acc_mat_vec_csc(matrix.view(), x.as_slice(), image.as_mut_slice());
    assert!(difference(&image, &rhs) < 1e-9 && report.backward_error <= 1e-10 && report.iterations > 30, "{report:?}");
    // A zero right-hand side has a zero solution.
    Gmres::default().solve(&matrix, &mut precondition, &vec![0.0; rhs.len()], &mut x, &settings).unwrap();
    assert!(x.iter().all(|x| *x == 0.0));
    let few = GmresSettings { max_iterations: 5, ..settings };
    let outcome = Gmres::default().solve(&matrix, &mut precondition, &rhs, &mut x, &few);
    assert!(matches!(outcome, Err(LinearError::NotConverged { iterations: 5, residual }) if residual < 1.0));
}

#[test]
fn gmres_breaks_down_happily_and_stops_at_a_kernel() {
    let mut identity = |x: &[f64], y: &mut [f64]| {
        y.copy_from_slice(x);
        Ok(())
    };
    let settings = GmresSettings { tolerance: 1e-12, restart: 10, max_iterations: 10 };
    let mut x = Vec::new();
    let multiple = |factor: f64| CsMatI::new_csc((3, 3), vec![0, 1, 2, 3], vec![0, 1, 2], vec![factor; 3]);
    let report = Gmres::default().solve(&multiple(2.0), &mut identity, &[1.0, 2.0, 3.0], &mut x, &settings).unwrap();
    assert_eq!((report.iterations, x.as_slice()), (1, [0.5, 1.0, 1.5].as_slice()));
    let outcome = Gmres::default().solve(&multiple(0.0), &mut identity, &[1.0, 2.0, 3.0], &mut x, &settings);
    assert!(matches!(outcome, Err(LinearError::NotConverged { .. })));
}

#[test]
fn old_factors_serve_while_a_body_moves() {
    let m = 60;
    let mut lagged = LaggedSolver::new(LaggedSettings::default());
    let n_steps = 12;
    let mut sizes = Vec::new();
    for step in 0..n_steps {
        let (matrix, keys) = grid(m, [30.0 + 0.4 * step as f64, 28.0 + 0.2 * step as f64], 0.3 + 0.01 * step as f64);
        let (x, report) = solve(&mut lagged, &matrix, &keys, 1e-10).unwrap();
        let (exact, _) = solve(&mut DirectSolver::new(), &matrix, &keys, 0.0).unwrap();
        assert!(difference(&x, &exact) < 1e-8, "step {step}: {}", difference(&x, &exact));
        assert!(report.iterations <= 25, "step {step}: {} iterations", report.iterations);
        sizes.push(keys.len());
    }
    sizes.dedup();
    assert!(sizes.len() > 3, "unknowns come and go");
    assert!(lagged.n_factorizations() <= n_steps / 3, "{} factorisations", lagged.n_factorizations());
}

#[test]
fn a_solver_that_recalls_gives_the_bits_of_the_other() {
    let solve = |solver: &mut LaggedSolver, centre: f64| {
        let (matrix, keys) = grid(30, [centre, 14.0], 0.2);
        solve(solver, &matrix, &keys, 1e-6).unwrap().0
    };
    let new = || LaggedSolver::new(LaggedSettings::default());
    let mut used = new();
    solve(&mut used, 13.0);
    let memory = used.memory();
    let with_memory = solve(&mut used, 14.0);
    assert_eq!(used.n_factorizations(), 1);
    let mut other = new();
    other.recall(&memory).unwrap();
    assert_eq!(other.memory(), memory);
    let recalled = solve(&mut other, 14.0);
    assert_eq!(other.n_factorizations(), 0);
    assert!(recalled.iter().zip(&with_memory).all(|(a, b)| a.to_bits() == b.to_bits()));
    let without = solve(&mut new(), 14.0);
    assert!(with_memory != without && difference(&with_memory, &without) < 1e-4);
}

/// Checks that lists which no solver wrote are errors: each list left out, shortened, and with a number out of range.
#[test]
fn other_lists_are_no_memory() {
    let (matrix, keys) = grid(10, [5.0, 5.0], 0.2);
    let mut solver = LaggedSolver::new(LaggedSettings::default());
    assert!(solver.memory().is_empty() && solver.recall(&[]).is_ok());
    solve(&mut solver, &matrix, &keys, 1e-6).unwrap();
    let memory = solver.memory();
    let refused = |lists: &[Vec<f64>]| {
        let mut other = LaggedSolver::new(LaggedSettings::default());
        other.recall(lists) == Err(LinearError::Memory) && DirectSolver::new().recall(lists) == Err(LinearError::Memory)
    };
    for k in 0..memory.len() {
        let changed = |change: &dyn Fn(&mut Vec<f64>)| {
            let mut lists = memory.clone();
            change(&mut lists[k]);
            lists
        };
        assert!(refused(&[&memory[..k], &memory[k + 1..]].concat()), "without list {k}");
        assert!(refused(&changed(&|list| _ = list.pop())), "list {k} shortened");
        // Flags, scales and entries may be any number.
        if ![0, 1, 2, 5].contains(&k) {
            assert!([0.5, -1.0, 1e12, f64::NAN].iter().all(|x| refused(&changed(&|list| list[1] = *x))), "list {k}");
        }
        // Pointers that do not begin at zero, rows and nodes that there are not.
        if k == 3 {
            assert!(refused(&changed(&|list| list.iter_mut().for_each(|x| *x += 1.0))));
        } else if k == 4 || k == 6 {
            let n = memory[1].len() as f64;
            assert!(refused(&changed(&|list| *list.last_mut().unwrap() = n)));
        }
    }
    // No memory is that of a new solver.
    solver.recall(&[]).unwrap();
    assert!(solver.memory().is_empty());
    let mut other = LaggedSolver::new(LaggedSettings::default());
    let solved = [&mut solver, &mut other].map(|solver| solve(solver, &matrix, &keys, 1e-6).unwrap().0);
    assert_eq!(solved[0], solved[1]);
}

#[test]
fn an_impossible_matrix_is_an_error_and_the_next_one_is_solved() {
    let mut solver = LaggedSolver::new(LaggedSettings::default());
    let singular: CsMatI<f64, u32> = CsMatI::new_csc((2, 2), vec![0, 2, 4], vec![0, 1, 0, 1], vec![1.0; 4]);
    assert!(solve(&mut solver, &singular, &[0, 1], 1e-8).is_err());
    let (matrix, keys) = grid(10, [5.0, 5.0], 0.1);
    let (x, _) = solve(&mut solver, &matrix, &keys, 1e-8).unwrap();
    assert!(x.iter().all(|x| x.is_finite()));
}

/// Returns a matrix with a zero block on the diagonal. Each unknown of the block has its pivot in another node, which
/// may be eliminated elsewhere.
fn hidden_pivots(n: usize) -> CsMatI<f64, u32> {
    let mut triplets = TriMatI::new((2 * n, 2 * n));
    for k in 0..n {
        triplets.add_triplet(k, n + k, 1.0);
        triplets.add_triplet(n + k, k, 1.0);
        triplets.add_triplet(n + k, n + (k + 1) % n, 0.5);
    }
    triplets.to_csc()
}

#[test]
fn free_pivoting_takes_over_where_static_pivots_vanish() {
    let matrix = hidden_pivots(40);
    let keys: Vec<u64> = (0..80).collect();
    let mut lagged = LaggedSolver::new(LaggedSettings::default());
    let (x, report) = solve(&mut lagged, &matrix, &keys, 1e-12).unwrap();
    let (exact, _) = solve(&mut DirectSolver::new(), &matrix, &keys, 0.0).unwrap();
    assert!(difference(&x, &exact) < 1e-10);
    assert_eq!((report.iterations, lagged.n_factorizations(), lagged.n_fallbacks()), (1, 1, 1));
    let mut other = LaggedSolver::new(LaggedSettings::default());
    other.recall(&lagged.memory()).unwrap();
    assert_eq!(other.memory()[0], [1.0]);
    assert_eq!(
        solve(&mut other, &matrix, &keys, 1e-12).unwrap().0,
        solve(&mut lagged, &matrix, &keys, 1e-12).unwrap().0
    );
    // Factors of the next matrix are static again.
    let (matrix, keys) = grid(20, [10.0, 10.0], 0.5);
    solve(&mut lagged, &matrix, &keys, 1e-12).unwrap();
    assert_eq!((lagged.n_factorizations(), lagged.n_fallbacks()), (2, 1));
}

#[test]
fn free_pivoting_takes_over_where_gmres_does_not_converge() {
    // One iteration is enough in double precision only.
    let (matrix, keys) = grid(30, [15.0, 15.0], 0.5);
    let mut lagged = LaggedSolver::new(LaggedSettings { restart: 1, ..LaggedSettings::default() });
    let (_, report) = solve(&mut lagged, &matrix, &keys, 1e-12).unwrap();
    assert!(report.backward_error <= 1e-12);
    assert_eq!((report.iterations, lagged.n_factorizations(), lagged.n_fallbacks()), (3, 3, 1));
}

#[test]
fn slivers_and_strong_convection_are_solved_with_factors_in_single_precision() {
    let (plain, keys) = grid(40, [20.0, 20.0], 0.3);
    // Unknowns of slivers: their rows, their columns, or both are tiny.
    let scale = |k: usize, phase: usize| if (k + phase).is_multiple_of(7) { 1e-12 } else { 1.0 };
    let mut slivers = plain.clone();
    for (j, mut column) in slivers.outer_iterator_mut().enumerate() {
        column.iter_mut().for_each(|(i, value)| *value *= scale(i, 0) * scale(j, 3) * scale(i, 5) * scale(j, 5));
    }
    let (fast, keys_fast) = grid(40, [20.0, 20.0], 1e4);
    for (name, matrix, keys) in [("slivers", slivers, keys), ("convection", fast, keys_fast)] {
        let mut lagged = LaggedSolver::new(LaggedSettings::default());
        let (x, report) = solve(&mut lagged, &matrix, &keys, 1e-12).unwrap();
        let (exact, _) = solve(&mut DirectSolver::new(), &matrix, &keys, 0.0).unwrap();
        assert!(difference(&x, &exact) < 1e-8, "{name}: {:e}", difference(&x, &exact));
        assert!(report.iterations <= 3 && lagged.n_fallbacks() == 0, "{name}: {report:?}");
    }
}

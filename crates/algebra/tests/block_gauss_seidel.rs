//! Block Gauss-Seidel: cases where a block solver or the sweep is exact, and cases that must be errors.

use algebra::{
    BlockGaussSeidel, BlockGaussSeidelSettings, BlockLayout, BlockSolver, DirectSolver, Fill, LinearError,
    LinearReport, LinearSolver, ScaledMatrix,
};
use sprs::{CsMatI, TriMatI};

type Matrix = CsMatI<f64, u32>;

const ALL: Fill = Fill::Threshold { drop: 0.0, growth: 1e3 };

fn matrix(n: usize, entries: impl IntoIterator<Item = (usize, usize, f64)>) -> Matrix {
    let mut triplets = TriMatI::new((n, n));
    entries.into_iter().for_each(|(i, j, value)| triplets.add_triplet(i, j, value));
    triplets.to_csc()
}

/// Returns the entries of a five-point stencil with convection on an `m` by `m` grid, whose unknowns begin at `first`.
fn stencil(m: usize, first: usize, convection: f64) -> Vec<(usize, usize, f64)> {
    let mut entries = Vec::new();
    for k in 0..m * m {
        let row = first + k;
        entries.push((row, row, 4.1 + convection));
        if k % m > 0 {
            entries.push((row, row - 1, -1.0 - convection));
            entries.push((row - 1, row, -1.0));
        }
        if k >= m {
            entries.push((row, row - m, -1.0));
            entries.push((row - m, row, -1.0));
        }
    }
    entries
}

fn settings(solvers: &[BlockSolver]) -> BlockGaussSeidelSettings {
    BlockGaussSeidelSettings { solvers: solvers.to_vec(), max_iterations: 200, ..BlockGaussSeidelSettings::default() }
}

/// Returns a layout of scalar fields, each on nodes of its own.
fn scalar_fields(sizes: &[usize]) -> BlockLayout {
    let mut layout = BlockLayout::new();
    for n in sizes {
        layout.push("field", *n, 1);
    }
    layout
}

/// Solves with the fields of a layout, and compares with the direct solver if it converges.
fn solve(
    matrix: &Matrix,
    layout: &BlockLayout,
    settings: BlockGaussSeidelSettings,
) -> Result<(LinearReport, BlockGaussSeidel), LinearError> {
    let scaled = ScaledMatrix::new(matrix.view())?;
    let system = scaled.system(layout)?;
    let rhs: Vec<f64> = (0..matrix.rows()).map(|k| 1.0 + (k as f64 * 0.37).sin()).collect();
    let (mut x, mut exact) = (vec![0.0; rhs.len()], vec![0.0; rhs.len()]);
    let mut solver = BlockGaussSeidel::new(settings);
    solver.factorize(&system)?;
    let report = solver.solve(&system, &rhs, &mut x, 1e-10)?;
    let mut direct = DirectSolver::new();
    direct.factorize(&system)?;
    direct.solve(&system, &rhs, &mut exact, 0.0)?;
    let size = exact.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
    let error = x.iter().zip(&exact).fold(0.0_f64, |d, (a, b)| d.max((a - b).abs())) / size;
    assert!(error < 1e-7, "error {error:e} of {report:?}");
    Ok((report, solver))
}

#[test]
fn incomplete_factors_without_fill_are_exact() {
    let n = 50;
    let chain = (0..n).flat_map(|i| [(i, i, 3.0), (i, (i + 1) % n, if i + 1 < n { -1.5 } else { 0.0 })]);
    let chain = chain.chain((1..n).map(|i| (i, i - 1, -0.7)));
    let chain = matrix(n, chain.filter(|(_, _, value)| *value != 0.0));
    let one = [BlockSolver::Incomplete(Fill::Pattern)];
    assert_eq!(solve(&chain, &scalar_fields(&[n]), settings(&one)).unwrap().0.iterations, 1);
    // Two chains of nodes one after the other: couplings inside and between nodes of two and of three unknowns.
    let mut layout = BlockLayout::new();
    layout.push("pairs", 10, 2);
    layout.push("triples", 10, 3);
    let nodes = layout.nodes();
    let field = |i: usize| i < 20;
    let are_coupled = |i: usize, j: usize| field(i) == field(j) && nodes[i].abs_diff(nodes[j]) <= 1;
    let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| are_coupled(*i, *j));
    let value = |i: usize, j: usize| if i == j { 6.0 } else { ((7 * i + 3 * j) as f64).sin() };
    let coupled = matrix(n, entries.map(|(i, j)| (i, j, value(i, j))));
    assert_eq!(solve(&coupled, &layout, settings(&one)).unwrap().0.iterations, 1);
}

#[test]
fn incomplete_factors_with_all_fill_are_exact_and_with_less_are_not() {
    let m = 12;
    let grid = matrix(m * m, stencil(m, 0, 0.5));
    let iterations = |fill| {
        let settings = settings(&[BlockSolver::Incomplete(fill)]);
        solve(&grid, &scalar_fields(&[m * m]), settings).unwrap().0.iterations
    };
    assert_eq!(iterations(ALL), 1);
    let [pattern, coarse, fine] =
        [Fill::Pattern, Fill::Threshold { drop: 1e-2, growth: 2.0 }, Fill::Threshold { drop: 1e-4, growth: 4.0 }]
            .map(iterations);
    assert!(1 < fine && fine < coarse && coarse < pattern && pattern < 30, "{fine} {coarse} {pattern}");
}

#[test]
fn a_node_is_a_saddle_point() {
    // Two unknowns per node, the second with a zero on the diagonal: eliminated alone it has no pivot.
    let n = 40;
    let entries = (0..n / 2).flat_map(|k| {
        let own = [(2 * k, 2 * k, 4.0), (2 * k, 2 * k + 1, 2.0), (2 * k + 1, 2 * k, 2.0)];
        let next = (k + 1 < n / 2).then_some([(2 * k, 2 * k + 2, -1.0), (2 * k + 2, 2 * k, -1.0)]);
        own.into_iter().chain(next.into_iter().flatten())
    });
    let saddle = matrix(n, entries);
    let mut pairs = BlockLayout::new();
    pairs.push("pairs", n / 2, 2);
    let one = [BlockSolver::Incomplete(Fill::Pattern)];
    assert_eq!(solve(&saddle, &pairs, settings(&one)).unwrap().0.iterations, 1);
    // The second unknowns are leaves of the graph. Reverse Cuthill-McKee orders one of them before its only neighbour.
    let scalar = solve(&saddle, &scalar_fields(&[n]), settings(&one));
    assert!(matches!(scalar, Err(LinearError::Unstable { error }) if error.is_infinite()), "{:?}", scalar.err());
}

#[test]
fn unstable_incomplete_factors_are_refused() {
    // Rotating convection, far stronger than diffusion, without upwinding: factors without fill grow exponentially.
    let m = 40;
    let mut entries = stencil(m, 0, 0.0);
    for (i, j, value) in &mut entries {
        let (lower, upper) = (*i.max(j), *i.min(j));
        let strength = 30.0 * ((lower % m) as f64 - 20.0);
        if lower - upper == m {
            *value += if *i == lower { -strength } else { strength };
        } else if lower > upper {
            *value += if *i == lower { 700.0 } else { -700.0 };
        }
    }
    let turning = matrix(m * m, entries);
    let one = settings(&[BlockSolver::Incomplete(Fill::Pattern)]);
    let outcome = solve(&turning, &scalar_fields(&[m * m]), one);
    assert!(matches!(outcome, Err(LinearError::Unstable { error }) if error > 10.0), "{:?}", outcome.err());
}

/// Returns the matrix of two grids. Unknowns of the first enter the equations of the second with the factor `coupling`,
/// those of the second enter the equations of the first with the factor `back`.
fn two_grids(m: usize, coupling: f64, back: f64) -> Matrix {
    let mut entries = stencil(m, 0, 0.5);
    entries.extend(stencil(m, m * m, 0.0));
    entries.extend((0..m).flat_map(|k| [(m * m + k, k, coupling), (k, m * m + k, back)]));
    matrix(2 * m * m, entries)
}

#[test]
fn a_sweep_is_exact_for_block_triangular_matrices() {
    let m = 8;
    let n = m * m;
    let without_patch = BlockGaussSeidelSettings { stiff: 1e3, ..settings(&[BlockSolver::Lu]) };
    let two = scalar_fields(&[n, n]);
    let (report, solver) = solve(&two_grids(m, 0.8, 0.0), &two, without_patch.clone()).unwrap();
    assert_eq!((report.iterations, solver.block_sizes(), solver.patch_size()), (1, vec![n, n], 0));
    let (report, _) = solve(&two_grids(m, 0.8, 0.8), &two, without_patch.clone()).unwrap();
    assert!(report.iterations > 3, "{report:?}");
    // Fields on the same nodes are one block, here with exact factors.
    let mut shared = BlockLayout::new();
    let first = shared.push("first", n, 1);
    shared.push_on(first, "second", 1);
    let (report, solver) = solve(&two_grids(m, 0.8, 0.8), &shared, without_patch).unwrap();
    assert_eq!((report.iterations, solver.block_sizes()), (1, vec![2 * n]));
}

#[test]
fn stiff_ties_between_blocks_need_the_patch() {
    // The sides of two grids tied by a penalty.
    let m = 24;
    let n = m * m;
    let mut entries = stencil(m, 0, 0.5);
    entries.extend(stencil(m, n, 0.0));
    for k in 0..m {
        let penalty = 1e6;
        let (a, b) = (k, n + k);
        entries.extend([(a, a, penalty), (a, b, -penalty), (b, a, -penalty), (b, b, penalty)]);
    }
    let tied = matrix(2 * n, entries);
    let iterations = |stiff| {
        let settings = BlockGaussSeidelSettings { stiff, ..settings(&[BlockSolver::Lu]) };
        solve(&tied, &scalar_fields(&[n, n]), settings).map(|(report, solver)| (report.iterations, solver.patch_size()))
    };
    let (with, size) = iterations(0.1).unwrap();
    assert!(with < 15 && size == 4 * m, "{with} iterations, {size} unknowns in the patch");
    let (without, none) = iterations(1e3).unwrap();
    assert!(without > 20 && none == 0, "{without} iterations without patch");
}

#[test]
fn cholesky_is_lu_where_it_can_be_and_falls_back_where_it_cannot() {
    let m = 10;
    let symmetric = stencil(m, 0, 0.0);
    let badly_scaled = symmetric.iter().map(|(i, j, v)| (*i, *j, v * 10_f64.powi((i % 7 + j % 7) as i32)));
    let indefinite = symmetric.iter().map(|(i, j, v)| (*i, *j, if i == j { v - 3.0 } else { *v }));
    let cases = [matrix(m * m, badly_scaled), matrix(m * m, indefinite), matrix(m * m, stencil(m, 0, 0.5))];
    for case in &cases {
        let (report, _) = solve(case, &scalar_fields(&[m * m]), settings(&[BlockSolver::Cholesky])).unwrap();
        assert_eq!(report.iterations, 1);
    }
}

#[test]
fn stalls_are_errors_and_leave_the_solution_alone() {
    let m = 20;
    let grid = matrix(m * m, stencil(m, 0, 0.1));
    let few = BlockGaussSeidelSettings { max_iterations: 3, ..settings(&[BlockSolver::Incomplete(Fill::Pattern)]) };
    let layout = scalar_fields(&[m * m]);
    let scaled = ScaledMatrix::new(grid.view()).unwrap();
    let system = scaled.system(&layout).unwrap();
    let mut solver = BlockGaussSeidel::new(few);
    let mut x = vec![7.0; m * m];
    assert_eq!(solver.solve(&system, &vec![1.0; m * m], &mut x, 1e-8), Err(LinearError::NotFactorized));
    solver.factorize(&system).unwrap();
    let outcome = solver.solve(&system, &vec![1.0; m * m], &mut x, 1e-12);
    assert!(matches!(outcome, Err(LinearError::NotConverged { iterations: 3, .. })), "{outcome:?}");
    assert!(x.iter().all(|x| *x == 7.0));
    // A matrix that cannot be factorised leaves no solver behind.
    let singular = matrix(2, [(0, 0, 1.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 1.0)]);
    let (scaled, two) = (ScaledMatrix::new(singular.view()).unwrap(), scalar_fields(&[2]));
    let system = scaled.system(&two).unwrap();
    assert!(solver.factorize(&system).is_err());
    assert_eq!(solver.solve(&system, &[1.0, 1.0], &mut [0.0; 2], 1e-8), Err(LinearError::NotFactorized));
}

#[test]
fn patterns_need_not_be_symmetric() {
    let chain = |upper: bool| {
        let off = move |k: usize| if upper { (k, k + 1, 1.0) } else { (k + 1, k, 1.0) };
        matrix(12, (0..12).map(|k| (k, k, 1.0)).chain((0..11).map(off)))
    };
    for upper in [false, true] {
        for fill in [Fill::Pattern, ALL] {
            let solvers = settings(&[BlockSolver::Incomplete(fill)]);
            let (report, _) = solve(&chain(upper), &scalar_fields(&[12]), solvers).unwrap_or_else(|e| panic!("{e}"));
            // A triangular matrix has exact factors without fill.
            assert!(report.iterations <= 2, "{report:?}");
        }
    }
}

#[test]
fn a_singular_patch_is_left_out() {
    // Regular as a whole; in the patch {0, 1, 2, 5} two unknowns are coupled to unknown 0 only.
    let symmetric = [(0, 1, 0.5), (0, 2, 0.5), (1, 3, 1.0), (2, 4, 1.0), (0, 5, -1.0)];
    let diagonal = [(0, 0, 2.0), (3, 3, 1.0), (4, 4, 1.0), (5, 5, 2.0)];
    let both = symmetric.into_iter().flat_map(|(i, j, v)| [(i, j, v), (j, i, v)]);
    let saddle = matrix(6, diagonal.into_iter().chain(both));
    solve(&saddle, &scalar_fields(&[5, 1]), settings(&[BlockSolver::Lu])).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn numbers_whose_squares_leave_the_range_are_solved_for() {
    let laplace = matrix(9, stencil(3, 0, 0.0));
    let layout = scalar_fields(&[9]);
    let scaled = ScaledMatrix::new(laplace.view()).unwrap_or_else(|e| panic!("{e}"));
    let system = scaled.system(&layout).unwrap_or_else(|e| panic!("{e}"));
    let mut solver = BlockGaussSeidel::new(settings(&[BlockSolver::Incomplete(Fill::Pattern)]));
    solver.factorize(&system).unwrap_or_else(|e| panic!("{e}"));
    let solve = |solver: &mut BlockGaussSeidel, size: f64| {
        let mut x = [0.0; 9];
        solver.solve(&system, &[size; 9], &mut x, 1e-10).unwrap_or_else(|e| panic!("{e}"));
        x.map(|x| x / size)
    };
    let one = solve(&mut solver, 1.0);
    for size in [1e200, 1e-200, 1e300] {
        let x = solve(&mut solver, size);
        assert!(x.iter().zip(one).all(|(a, b)| (a - b).abs() < 1e-8), "{size:e} {x:?}");
    }
    let mut x = [7.0; 9];
    let outcome = solver.solve(&system, &[f64::MAX; 9], &mut x, 1e-10);
    assert!(outcome.is_err() || x.iter().all(|x| x.is_finite()), "{outcome:?} {x:?}");
}

//! The direct solver on regular, stiff and singular systems.

mod common;

use algebra::{
    BlockSystem, DirectSolver, LinearError, LinearReport, LinearSolver, MatrixView, ScaledMatrix, Scaling,
    condition_number,
};
use common::{Flow, max_norm, refs, scalar_field, state};
use sprs::CsMatI;

/// Returns a matrix given by rows, with its zeros stored.
fn dense(by_rows: &[&[f64]]) -> CsMatI<f64, u32> {
    let n = by_rows.len();
    let values = (0..n * n).map(|k| by_rows[k % n][k / n]).collect();
    CsMatI::new_csc(
        (n, n),
        (0..=n as u32).map(|j| j * n as u32).collect(),
        (0..n as u32).cycle().take(n * n).collect(),
        values,
    )
}

fn product(matrix: MatrixView<'_>, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    for (value, (i, j)) in matrix.iter() {
        y[i as usize] += value * x[j as usize];
    }
    y
}

fn solve_with(
    solver: &mut DirectSolver,
    matrix: MatrixView<'_>,
    rhs: &[f64],
) -> Result<(Vec<f64>, LinearReport), LinearError> {
    let (scaled, layout) = (ScaledMatrix::new(matrix)?, scalar_field(matrix.rows()));
    let system = scaled.system(&layout)?;
    let mut x = vec![0.0; rhs.len()];
    solver.factorize(&system)?;
    let report = solver.solve(&system, rhs, &mut x, 0.0)?;
    Ok((x, report))
}

fn solve(matrix: MatrixView<'_>, rhs: &[f64]) -> Result<Vec<f64>, LinearError> {
    solve_with(&mut DirectSolver::new(), matrix, rhs).map(|(x, _)| x)
}

/// Returns the assembled system of a flow problem, and the problem.
fn assembled(m: usize) -> (BlockSystem, Flow) {
    let flow = Flow::new(m, 1.0);
    let mut system = BlockSystem::new(&flow.layout, &refs(&flow.parts()), &flow.constraints);
    system.assemble(&refs(&flow.parts()), &state(flow.layout.len()));
    system.equilibrate().expect("a regular matrix");
    (system, flow)
}

#[test]
fn a_small_system() {
    let a = dense(&[&[0.0, 2.0], &[4.0, 1.0]]);
    let x = solve(a.view(), &[2.0, 9.0]).unwrap();
    assert_eq!(x, [2.0, 1.0]);
}

#[test]
fn an_empty_system() {
    let a = dense(&[]);
    assert_eq!(solve(a.view(), &[]).unwrap(), [0.0; 0]);
}

#[test]
fn penalties_of_1e9_do_not_spoil_the_solution() {
    let (system, _) = assembled(16);
    let n = system.residual().len();
    let mut stiff = system.matrix().to_owned();
    // Springs of stiffness 1e9 between every 7th unknown j of the first field and its successor j + 1.
    let mut n_stiff = 0;
    for j in (0..n / 3 - 1).step_by(7).filter(|j| !system.constrained()[*j] && !system.constrained()[*j + 1]) {
        let entries = [(j + 1, j, -1.0), (j, j + 1, -1.0), (j + 1, j + 1, 1.0), (j, j, 1.0)];
        if entries.iter().all(|(i, j, _)| stiff.get(*i, *j).is_some()) {
            entries.iter().for_each(|(i, j, sign)| *stiff.get_mut(*i, *j).unwrap() += sign * 1e9);
            n_stiff += 1;
        }
    }
    assert!(n_stiff > 10);
    let rhs = product(stiff.view(), &state(n));
    let (x, report) = solve_with(&mut DirectSolver::new(), stiff.view(), &rhs).unwrap();
    assert!(report.backward_error < 1e-12, "{report:?}");
    // The residual of the unscaled system, row by row.
    let achieved = product(stiff.view(), &x);
    let sizes = product(stiff.map(|v| v.abs()).view(), &x.iter().map(|v| v.abs()).collect::<Vec<_>>());
    for row in 0..n {
        assert!((achieved[row] - rhs[row]).abs() <= 1e-11 * (sizes[row] + rhs[row].abs()), "row {row}");
    }
}

#[test]
fn singular_matrices_are_errors() {
    let exactly = dense(&[&[1.0, 2.0, 0.0], &[2.0, 4.0, 0.0], &[0.0, 0.0, 1.0]]);
    assert!(matches!(solve(exactly.view(), &[1.0, 2.0, 1.0]), Err(LinearError::Singular { .. })));
    let nearly = dense(&[&[1.0, 0.1, 0.3], &[0.7, 0.9, 0.2], &[1.7, 1.0, 0.5]]);
    assert!(matches!(solve(nearly.view(), &[1.0, 1.0, 2.0]), Err(LinearError::Singular { .. })));
    let empty_row = dense(&[&[1.0, 2.0], &[0.0, 0.0]]);
    assert!(matches!(solve(empty_row.view(), &[1.0, 0.0]), Err(LinearError::EmptyRow { row: 1 })));
    let empty_column = dense(&[&[0.0, 2.0], &[0.0, 1.0]]);
    assert!(matches!(solve(empty_column.view(), &[1.0, 0.0]), Err(LinearError::EmptyColumn { column: 0 })));
    let nan = dense(&[&[1.0, 2.0], &[f64::NAN, 1.0]]);
    assert!(matches!(solve(nan.view(), &[1.0, 0.0]), Err(LinearError::NotFinite { row: 1 })));
    let fine = dense(&[&[1.0, 2.0], &[0.0, 1.0]]);
    assert!(matches!(solve(fine.view(), &[1.0, f64::INFINITY]), Err(LinearError::NotFinite { row: 1 })));
}

#[test]
fn a_pattern_without_a_transversal_is_an_error() {
    let (ptr, rows, values) = ([0, 1, 2, 5], [0, 0, 0, 1, 2], [1.0, 2.0, 1.0, 1.0, 1.0]);
    let a = MatrixView::new_csc((3, 3), &ptr, &rows, &values);
    let error = solve(a, &[1.0, 1.0, 1.0]).unwrap_err();
    assert!(matches!(error, LinearError::StructurallySingular { .. } | LinearError::Singular { .. }), "{error}");
}

#[test]
fn a_free_pressure_constant_is_an_error() {
    for m in [4, 40] {
        let mut flow = Flow::new(m, 0.0);
        let pressure = flow.layout.dof(algebra::FieldId::new(2), 0, 0);
        flow.constraints = flow.constraints.iter().filter(|(dof, _)| *dof != pressure).collect();
        // With prescribed velocities on the whole boundary, a constant pressure is in the kernel of the matrix.
        let system = BlockSystem::new(&flow.layout, &refs(&flow.parts()), &flow.constraints);
        let outcome = solve(system.matrix(), &vec![0.0; flow.layout.len()]);
        assert!(matches!(outcome, Err(LinearError::Singular { .. })), "m = {m}: {:?}", outcome.map(|_| ()));
    }
}

#[test]
fn the_solver_survives_errors_and_changes_of_pattern_and_is_reproducible() {
    let mut used = DirectSolver::new();
    let singular = ScaledMatrix::new(dense(&[&[1.0, 1.0], &[1.0, 1.0]]).view()).unwrap();
    let two = scalar_field(2);
    let singular = singular.system(&two).unwrap();
    let not_factorized = |solver: &mut DirectSolver| {
        matches!(solver.solve(&singular, &[1.0, 1.0], &mut [0.0; 2], 0.0), Err(LinearError::NotFactorized))
    };
    assert!(not_factorized(&mut used));
    for m in [12, 30, 5, 30] {
        let (system, flow) = assembled(m);
        assert!(used.factorize(&singular).is_err());
        assert!(not_factorized(&mut used));
        let n = flow.layout.len();
        let mut new = DirectSolver::new();
        let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
        for (solver, x) in [(&mut used, &mut a), (&mut new, &mut b)] {
            let linear = system.linear_system().unwrap();
            solver.factorize(&linear).unwrap();
            solver.solve(&linear, system.residual(), x, 0.0).unwrap();
        }
        assert!(a.iter().zip(&b).all(|(a, b)| a.to_bits() == b.to_bits()), "m = {m}");
        assert!(max_norm(&a) > 0.0);
    }
}

#[test]
fn the_same_pattern_is_analysed_once_and_old_factors_keep_solving() {
    let (mut system, flow) = assembled(10);
    let n = flow.layout.len();
    let mut solver = DirectSolver::new();
    let mut x = vec![0.0; n];
    let mut again = vec![0.0; n];
    for _ in 0..3 {
        solver.factorize(&system.linear_system().unwrap()).unwrap();
    }
    let rhs = system.residual().to_vec();
    solver.solve(&system.linear_system().unwrap(), &rhs, &mut x, 0.0).unwrap();
    assert_eq!((solver.n_symbolic_factorizations(), solver.n_factorizations()), (1, 3));
    // A new assembly does not change the equilibrated matrix.
    system.assemble(&refs(&flow.parts()), &vec![0.0; n]);
    solver.solve(&system.linear_system().unwrap(), &rhs, &mut again, 0.0).unwrap();
    assert_eq!(x, again);
}

#[test]
fn the_condition_number_is_that_of_the_matrix_or_of_the_equilibrated_one() {
    let of = |matrix: &CsMatI<f64, u32>, scaling| {
        condition_number(matrix.view(), &scalar_field(matrix.rows()), scaling).expect("a regular matrix")
    };
    let near = |condition: f64, exact: f64| assert!((condition / exact - 1.0).abs() < 1e-3, "{condition} {exact}");
    // Equilibration removes the scales of the rows and columns of a diagonal matrix.
    let diagonal = dense(&[&[4.0, 0.0], &[0.0, 1024.0]]);
    near(of(&diagonal, Scaling::Equilibrated), 1.0);
    near(of(&diagonal, Scaling::None), 256.0);
    // The symmetric matrix has the eigenvalues 1.999 and 0.001, the shear the golden ratio g and 1/g as singular
    // values.
    let symmetric = dense(&[&[1.0, 0.999], &[0.999, 1.0]]);
    let shear = dense(&[&[1.0, 1.0], &[0.0, 1.0]]);
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    for scaling in [Scaling::Equilibrated, Scaling::None] {
        near(of(&symmetric, scaling), 1999.0);
        near(of(&shear, scaling), golden.powi(2));
    }
    // Not symmetric: sum and product of the squared singular values are trace and determinant (4) of `A Aᵀ`.
    let scaled = dense(&[&[8.0, 0.5], &[0.0, 0.25]]);
    let trace = 64.0 + 0.25 + 0.0625_f64;
    let largest = 0.5 * (trace + (trace * trace - 16.0).sqrt());
    near(of(&scaled, Scaling::None), largest / 2.0);
}

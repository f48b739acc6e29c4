//! Stokes flow around a cut disk and a cut sphere: errors compared with those of another code, and their orders.

use benchmarks::UnfittedStokes;

/// N, then errors in L2 of velocity, its gradient, and pressure.
type Row = (u32, [f64; 3]);

/// Errors of ngsxfem 2.1.2608 with the forms of this library: `2 μ (D(u), ∇v)` with the corresponding traction, and
/// velocities on the sides interpolated at the vertices.
const SAME_FORMS: [Row; 3] = [
    (32, [1.3104e-3, 0.15050, 2.9498e-2]),
    (64, [3.3769e-4, 0.075252, 9.4179e-3]),
    (128, [8.5874e-5, 0.037620, 3.0999e-3]),
];

/// Computes the errors on all meshes of a table and checks that they agree with the table within 5 %. The remaining
/// differences are due to the polygons and to the lengths in the penalties.
fn compare(table: [Row; 3], forms: fn(UnfittedStokes<2>) -> UnfittedStokes<2>) -> [[f64; 3]; 3] {
    table.map(|(n, peer)| {
        let ours = forms(UnfittedStokes::around_disk(n)).errors().expect("a linear problem");
        assert!(ours.iter().zip(peer).all(|(a, b)| (0.95..1.05).contains(&(a / b))), "N = {n}: {ours:?} and {peer:?}");
        ours
    })
}

/// Returns the orders of convergence between a mesh and one of half its size.
fn orders(coarse: [f64; 3], fine: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| (coarse[k] / fine[k]).log2())
}

#[test]
fn errors_are_those_of_another_code_with_the_same_forms() {
    let [_, coarse, fine] = compare(SAME_FORMS, |stokes| stokes);
    let orders = orders(coarse, fine);
    assert!(orders[0] > 1.9 && orders[1] > 0.98 && orders[2] > 1.5, "{orders:?}");
}

#[test]
fn errors_are_the_published_ones_with_the_published_forms() {
    let [coarsest, coarse, fine, _] = UnfittedStokes::PUBLISHED_ERRORS;
    compare([coarsest, coarse, fine], UnfittedStokes::with_published_forms);
}

#[test]
fn errors_decrease_in_3d() {
    let [coarse, fine] = [6, 12].map(|n| UnfittedStokes::around_sphere(n).errors().expect("a linear problem"));
    let orders = orders(coarse, fine);
    assert!(orders[0] > 1.6 && orders[1] > 0.85 && orders[2] > 1.0, "{orders:?}");
}

//! Stokes flow around a cut disk and a cut sphere: errors compared with those of another code, and their orders.

use algebra::{NewtonSettings, Workspace, newton};
use benchmarks::{StokesErrors, StokesWeights, UnfittedStokes};

fn errors<const D: usize>(stokes: &UnfittedStokes<D>) -> StokesErrors {
    stokes.with_equations(|equations| {
        let mut x = vec![0.0; equations.layout.len()];
        newton(equations, &mut x, &mut Workspace::new(), &NewtonSettings::new(1e-9)).expect("a linear problem");
        stokes.errors(&x)
    })
}

/// Computes the errors on all meshes of a table and checks that they agree with it within 5 %. The remaining differences are
/// the polygons, and the lengths in the penalties (see `StokesWeights`).
fn compare(table: [Row; 3], forms: fn(UnfittedStokes<2>) -> UnfittedStokes<2>) -> [StokesErrors; 3] {
    table.map(|(n, velocity, gradient, pressure)| {
        let ours = errors(&forms(UnfittedStokes::around_disk(n, StokesWeights::PUBLISHED)));
        let ratios = [ours.velocity / velocity, ours.gradient / gradient, ours.pressure / pressure];
        assert!(ratios.iter().all(|ratio| (0.95..1.05).contains(ratio)), "N = {n}: {ours:?}, ratios {ratios:?}");
        ours
    })
}

/// N, then errors of velocity (L2), its gradient, and pressure (L2).
type Row = (u32, f64, f64, f64);

/// ngsxfem 2.1.2608 with the forms of this library: `2 μ (D(u), ∇v)` with the corresponding traction, and velocities on the
/// sides interpolated at the vertices.
const SAME_FORMS: [Row; 3] =
    [(32, 1.3104e-3, 0.15050, 2.9498e-2), (64, 3.3769e-4, 0.075252, 9.4179e-3), (128, 8.5874e-5, 0.037620, 3.0999e-3)];

#[test]
fn errors_are_those_of_another_code_with_the_same_forms() {
    let computed = compare(SAME_FORMS, |stokes| stokes);
    let order = |of: fn(&StokesErrors) -> f64| (of(&computed[1]) / of(&computed[2])).log2();
    let orders = [order(|e| e.velocity), order(|e| e.gradient), order(|e| e.pressure)];
    assert!(orders[0] > 1.9 && orders[1] > 0.98 && orders[2] > 1.5, "{orders:?}");
}

/// ngsxfem 2.1, as published: `μ (∇u, ∇v)`, and velocities on the sides by a local L2 projection.
const PUBLISHED_FORMS: [Row; 3] =
    [(32, 9.382e-4, 0.15064, 2.2667e-2), (64, 2.3916e-4, 0.075268, 6.8153e-3), (128, 6.0555e-5, 0.037621, 2.1170e-3)];

#[test]
fn errors_are_the_published_ones_with_the_published_forms() {
    compare(PUBLISHED_FORMS, UnfittedStokes::with_published_forms);
}

#[test]
fn errors_decrease_in_3d() {
    let [coarse, fine] = [6, 12].map(|n| errors(&UnfittedStokes::around_sphere(n, StokesWeights::PUBLISHED)));
    let orders = [
        (coarse.velocity / fine.velocity).log2(),
        (coarse.gradient / fine.gradient).log2(),
        (coarse.pressure / fine.pressure).log2(),
    ];
    assert!(orders[0] > 1.6 && orders[1] > 0.85 && orders[2] > 1.0, "{orders:?}");
}

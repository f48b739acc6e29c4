//! Errors of unfitted Stokes flow beside those of another code on the same mesh.

use std::path::Path;

use benchmarks::{StokesErrors, StokesWeights, UnfittedStokes};
use cutwater::algebra::{NewtonSettings, NonlinearProblem, Workspace, newton};

use super::Failure;
use super::record::Record;

/// Largest ratio of our errors to those of the peer.
const LARGEST_RATIO: f64 = 1.2;

/// N, then errors of velocity, its gradient and pressure, of ngsxfem 2.1.
type Row = (u32, [f64; 3]);

/// With its own forms: `μ (∇u, ∇v)`, velocities on the sides by a local L2 projection.
const PUBLISHED_FORMS: [Row; 2] = [(128, [6.0555e-5, 0.037621, 2.1170e-3]), (256, [1.5e-5, 0.0188, 6.8e-4])];
/// With the forms of this library: `2 μ (D(u), ∇v)` with its traction, velocities on the sides given at the vertices.
const OUR_FORMS: [Row; 2] = [(128, [8.5874e-5, 0.037620, 3.0999e-3]), (256, [2.166e-5, 0.0188, 1.05e-3])];

/// Compares like with like, and shows what the forms make.
///
/// # Errors
/// Newton's method fails.
pub(super) fn measure(record: &mut Record, _out: &Path) -> Result<(), Failure> {
    let n_meshes = if record.full { 2 } else { 1 };
    for ((n, published), (_, ours)) in PUBLISHED_FORMS.into_iter().zip(OUR_FORMS).take(n_meshes) {
        let around_disk = || UnfittedStokes::around_disk(n, StokesWeights::PUBLISHED);
        let with_ours = errors(&around_disk())?;
        let with_published = errors(&around_disk().with_published_forms())?;
        for (k, quantity) in ["u", "∇u", "p"].into_iter().enumerate() {
            let quantity = format!("{quantity} in L2 over that of ngsxfem, N = {n}");
            record.at_most(format!("{quantity}, its forms in both"), with_published[k] / published[k], LARGEST_RATIO);
            record.at_most(format!("{quantity}, our forms in both"), with_ours[k] / ours[k], LARGEST_RATIO);
            record.show(format!("{quantity}, each with its own"), with_ours[k] / published[k], None);
        }
    }
    record.note(
        "Each with its own forms, errors of velocity and pressure in L2 are larger here: the viscous form is 2 μ (D(u), ∇v), \
         the only one with the traction that moves a body. Given the same forms the two codes agree.",
    );
    Ok(())
}

fn errors(stokes: &UnfittedStokes<2>) -> Result<[f64; 3], Failure> {
    stokes.with_problem(|problem| {
        let mut x = vec![0.0; problem.layout().len()];
        newton(problem, &mut x, &mut Workspace::new(), &NewtonSettings::new(1e-9))?;
        let StokesErrors { velocity, gradient, pressure } = stokes.errors(&x);
        Ok([velocity, gradient, pressure])
    })
}

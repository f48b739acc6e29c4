//! A cylinder that moves along the middle of a narrow channel in Stokes flow: drag and leak.

use std::f64::consts::PI;
use std::sync::Arc;

use cutwater::algebra::time::QuasiStatic;
use cutwater::mesh::generate::structured_box;
use cutwater::solver::{FluidBoundary, Setup, Stabilisation};

use super::flow::{disk, fluid_mut, force, polygon, set_side, wet_report};
use super::linear_flow::still;
use super::{DirectRun, Failure, P, Record, V};

/// Diameter of the cylinder over the height of the channel.
const BLOCKAGE: f64 = 0.3;
/// Length of the channel, which is closed at both ends, in diameters. The ends change the drag by less than 1e-6.
const LENGTH: f64 = 12.0;
// Cells in a diameter, in short and in full, and those for which the accuracy is required.
const QUICK: [usize; 2] = [8, 16];
const FULL: [usize; 3] = [8, 16, 32];
const JUDGED: usize = 16;
// Largest relative error of the drag, and largest leak over the flow that the cylinder displaces.
const ACCURACY: f64 = 0.015;
const LARGEST_LEAK: f64 = 0.005;
/// Least order of the drag.
const ORDER: f64 = 1.8;
// Steps, and cells that the cylinder passes in all of them.
const N_STEPS: usize = 6;
const CELLS_PASSED: f64 = 1.6;

/// Measures drag and leak while the cylinder passes one and a half cells.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let mut errors = Vec::new();
    for &cells in if record.full { &FULL[..] } else { &QUICK[..] } {
        let (mean, scatter, leak) = drag(cells, Stabilisation::STANDARD)?;
        let error = (mean / exact_drag() - 1.0).abs();
        let at = format!("{cells} cells per diameter");
        record.show(format!("{at}: mean drag"), mean, Some(exact_drag()));
        record.show(format!("{at}: largest difference from the mean, over it"), scatter, None);
        if cells == JUDGED {
            record.at_most(format!("{at}: error of the mean drag"), error, ACCURACY);
            record.at_most(format!("{at}: absolute leak over the displaced flow"), leak, LARGEST_LEAK);
        } else {
            record.show(format!("{at}: absolute leak over the displaced flow"), leak, None);
        }
        errors.push((1.0 / cells as f64, error));
        let (mean, _, leak) = drag(cells, Stabilisation::PAPER_44_2019)?;
        record.show(format!("{at}, the paper's set: mean drag"), mean, Some(exact_drag()));
        record.show(format!("{at}, the paper's set: absolute leak over the displaced flow"), leak, None);
    }
    record.order("error of the mean drag", "h/D", &errors, ORDER);
    record.note(
        "Drag over viscosity and speed, in half of the channel. Reference: Faxén 1946 in Happel and Brenner, Low Reynolds Number \
         Hydrodynamics, doi:10.1007/978-94-009-8352-6, chapter 7.",
    );
    Ok(())
}

/// Returns the drag over viscosity and speed, by Faxén's series in the blockage.
fn exact_drag() -> f64 {
    let k = BLOCKAGE;
    let series = 1.7244 * k.powi(2) - 1.7302 * k.powi(4) + 2.4056 * k.powi(6) - 4.5913 * k.powi(8);
    4.0 * PI / ((1.0 / k).ln() - 0.9157 + series)
}

/// Computes the mean drag, its largest relative difference from the mean, and the largest leak of all steps.
fn drag(cells: usize, set: Stabilisation) -> Result<(f64, f64, f64), Failure> {
    let mut setup = setup(cells)?;
    fluid_mut(&mut setup)?.stabilisation = set;
    let mut run = DirectRun::new(setup)?;
    let (mut drags, mut leak) = (Vec::new(), 0.0_f64);
    for _ in 0..N_STEPS {
        let report = run.advance()?;
        // By symmetry the force on the other half is the same.
        drags.push(-2.0 * force(&run.state, &report, 0, &P::zeros())?.0[0]);
        let flow = wet_report(&report)?.flow;
        leak = leak.max(flow.leak_absolute / flow.swept);
    }
    let mean = drags.iter().sum::<f64>() / N_STEPS as f64;
    let scatter = drags.iter().map(|drag| (drag / mean - 1.0).abs()).fold(0.0, f64::max);
    Ok((mean, scatter, leak))
}

fn setup(cells: usize) -> Result<Setup<2>, Failure> {
    let size = [LENGTH, 0.5 / BLOCKAGE];
    let n = size.map(|length| (length * cells as f64).round() as usize);
    let dt = CELLS_PASSED / (N_STEPS * cells) as f64;
    let mut setup = still(structured_box::<2>([0.0; 2], size, n)?, 1.0, dt, 1e-10, || FluidBoundary::NoSlip)?;
    setup.scheme = Arc::new(QuasiStatic);
    let fluid = fluid_mut(&mut setup)?;
    // Without inertia the penalty does not depend on speeds either.
    fluid.material.density = 1e-9;
    fluid.convection = None;
    set_side(&mut setup, "bottom", FluidBoundary::symmetry(1))?;
    // Edges of a third of a cell.
    let corners = disk(P::new(0.5 * LENGTH, 0.0), 0.5, (3.0 * PI * cells as f64).ceil() as usize);
    setup.bodies.push(polygon(&[corners], |x, t| x + V::new(t, 0.0), Arc::new(|_, _| V::new(1.0, 0.0))));
    Ok(setup)
}

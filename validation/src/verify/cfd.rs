//! Steady flow past the rigid flag of the Turek-Hron benchmark.

use super::channel::{Channel, ChannelResolution};
use super::{Failure, Record};

/// Benchmarks CFD1 and CFD2 of Turek and Hron 2006, doi:10.1007/3-540-34596-5_15: mean speed, m/s, drag and lift, N/m.
const CASES: [(&str, f64, [f64; 2]); 2] = [("CFD1", 0.2, [14.29, 1.119]), ("CFD2", 1.0, [136.7, 10.53])];
const NAMES: [&str; 2] = ["drag", "lift"];
/// Largest relative errors of drag and lift on the finest mesh.
const ACCURACY: [f64; 2] = [0.01, 0.03];
/// Cells in a diameter of the cylinder; the quick version has the first two, and CFD1 only.
const CELLS: [usize; 4] = [16, 32, 64, 128];

/// Measures drag and lift of cylinder and flag on several meshes.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let (n_cases, meshes) = if record.full { (2, &CELLS[..]) } else { (1, &CELLS[..2]) };
    for &(case, speed, known) in &CASES[..n_cases] {
        let channel = Channel { length: 2.5, density: 1e3, viscosity: 1.0, speed, has_flag: true };
        let mut errors: [Vec<(f64, f64)>; 2] = Default::default();
        for &cells in meshes {
            let resolution = ChannelResolution::new(cells);
            let flow = channel.steady(&resolution)?;
            let name = format!("{case}, h = D/{cells}");
            record.show(format!("{name}: unknowns"), flow.n_dofs as f64, None);
            record.show(format!("{name}: steps until steady"), flow.n_steps as f64, None);
            for k in 0..2 {
                let quantity = format!("{name}: {} [N/m]", NAMES[k]);
                if Some(&cells) == meshes.last() {
                    record.near_relative(quantity, flow.force[k], known[k], ACCURACY[k]);
                } else {
                    record.show(quantity, flow.force[k], Some(known[k]));
                }
                let by_traction = format!("{name}: {} by the traction of the fluid [N/m]", NAMES[k]);
                record.show(by_traction, flow.by_traction[k], Some(known[k]));
                errors[k].push((resolution.h(), (flow.force[k] / known[k] - 1.0).abs()));
            }
        }
        record.log_figure(format!("{case}: relative errors"), "h [m]", NAMES.into_iter().zip(errors).collect());
    }
    record.note(
        "Channel and settings of the check `dfg`, 2.5 m long, with the flag from the cylinder to x = 0.6 m, 2 cm thick. Cylinder and flag are \
         one polygon. Cells at the flag are as fine as those at the cylinder, and at its two corners h/16. The known \
         numbers have four digits, so that errors below 5e-4 cannot be measured.",
    );
    Ok(())
}

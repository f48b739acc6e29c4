//! The steady DFG benchmark: drag, lift and pressure of a cylinder in a channel, at a Reynolds number of 20.

use super::channel::{CENTRE, COARSE, Channel, ChannelResolution, N_CORNERS, RADIUS, Steady, at, pressure_difference};
use super::{Failure, P, Record, short};

/// Benchmark 2D-1 of Schäfer and Turek 1996.
const CHANNEL: Channel = Channel { length: 2.2, density: 1.0, viscosity: 1e-3, speed: 0.2, has_flag: false };
/// Drag and lift coefficient and pressure difference, Pa, by spectral elements (Nabh 1998).
const KNOWN: [f64; 3] = [5.579_535_233_84, 0.010_618_948_146, 0.117_520_166_97];
const NAMES: [&str; 3] = ["C_D", "C_L", "pressure difference"];
/// Largest relative errors at about 65 000 unknowns.
const ACCURACY: [f64; 3] = [0.005, 0.05, 0.005];
/// Middle and half of the interval of the length of the recirculation, m.
const RECIRCULATION: [f64; 2] = [0.0847, 0.0005];
/// Cells in a diameter; the last is left out of the quick version. With the third there are about 65 000 unknowns.
const CELLS: [usize; 4] = [16, 32, 64, 128];
/// Least order of the drag in h: that of a functional with linear elements is two.
const ORDER: f64 = 1.9;

/// Measures the three numbers on several meshes, and in the full check the effect of the polygon and of the coarse
/// cells.
pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let meshes = if record.full { &CELLS[..] } else { &CELLS[..3] };
    let mut errors: [Vec<(f64, f64)>; 3] = Default::default();
    for &cells in meshes {
        let resolution = ChannelResolution::new(cells);
        let flow = CHANNEL.steady(&resolution)?;
        let (computed, relative) = (numbers(&flow)?, relative_errors(&flow)?);
        let name = format!("h = D/{cells}");
        record.show(format!("{name}: unknowns"), flow.n_dofs as f64, None);
        record.show(format!("{name}: steps until steady"), flow.n_steps as f64, None);
        record.show(format!("{name}: iterations of Newton's method in all steps"), flow.n_iterations as f64, None);
        for k in 0..3 {
            let quantity = format!("{name}: {}", NAMES[k]);
            if cells == CELLS[2] {
                record.near_relative(quantity, computed[k], KNOWN[k], ACCURACY[k]);
            } else {
                record.show(quantity, computed[k], Some(KNOWN[k]));
            }
            errors[k].push((resolution.h(), relative[k].abs()));
        }
        record.show(
            format!("{name}: C_D by the traction of the fluid"),
            CHANNEL.coefficient(flow.by_traction[0]),
            Some(KNOWN[0]),
        );
        record.show(
            format!("{name}: C_L by the traction of the fluid"),
            CHANNEL.coefficient(flow.by_traction[1]),
            Some(KNOWN[1]),
        );
        if cells == CELLS[2] {
            let [middle, half] = RECIRCULATION;
            record.near(format!("{name}: length of the recirculation, m"), recirculation(&flow)?, middle, half);
        }
    }
    record.order("C_D, relative error", "h", &errors[0], ORDER);
    record.show_order("C_L, relative error", "h", &errors[1]);
    record.show_order("pressure difference, relative error", "h", &errors[2]);
    record.log_figure("Relative errors", "h [m]", NAMES.into_iter().zip(errors).collect());
    if record.full {
        let usual = ChannelResolution::new(CELLS[2]);
        let polygons = [32, 64, 128, 256, 1024];
        let backgrounds = [4.0, 16.0];
        let polygons =
            polygons.map(|n| (format!("polygon of {n} corners"), ChannelResolution { n_corners: n, ..usual }));
        let backgrounds = backgrounds.map(|c| (format!("{c} h far away"), ChannelResolution { coarse: c, ..usual }));
        for (name, resolution) in polygons.into_iter().chain(backgrounds) {
            let errors = relative_errors(&CHANNEL.steady(&resolution)?)?;
            for (quantity, error) in NAMES.into_iter().zip(errors) {
                record.show(format!("h = D/{}, {name}: relative error of {quantity}", usual.cells), error, None);
            }
        }
    }
    record.note(format!(
        "Channel of {} m with a cylinder that its mesh does not follow: a regular polygon of {N_CORNERS} corners with the area of the disk, \
         which deviates from the circle by 1.3e-5 radii. Cells of size h at the cylinder grow in proportion to the distance \
         from its centre, up to {} h. Coefficients are those of the variational traction of the mortar (traction of the \
         fluid and penalty) unless said otherwise. Pressures are those of the cells at the foremost and the rearmost point of the cylinder. \
         Steps of implicit Euler have 1e9 s, begin at rest, and end when the force changes by less than 1e-6.",
        short(CHANNEL.length),
        short(COARSE),
    ));
    record.note(
        "The weights of penalties have the velocity of the last step, so one step is not enough. The pressure at a point of the surface \
         converges more slowly than the forces, and depends on how the surface cuts the cells there: at D/64 it changes by up to 0.3 % \
         when one weight of the stabilisation is divided by ten, and the drag by up to 0.01 %. With D/192 and D/256 (5.6e5 and 1.0e6 unknowns) \
         errors of the pressure difference are 0.12 % and 0.08 %, those of the drag 1.7e-5 and 1.0e-5, about as much as the polygon deviates.",
    );
    Ok(())
}

/// Returns drag and lift coefficient and the pressure difference.
fn numbers(flow: &Steady) -> Result<[f64; 3], Failure> {
    let [drag, lift] = [0, 1].map(|k| CHANNEL.coefficient(flow.force[k]));
    Ok([drag, lift, pressure_difference(&flow.setup, &flow.state)?])
}

/// Returns the relative errors of the three numbers, with their signs.
fn relative_errors(flow: &Steady) -> Result<[f64; 3], Failure> {
    let computed = numbers(flow)?;
    Ok(std::array::from_fn(|k| computed[k] / KNOWN[k] - 1.0))
}

/// Computes the distance from the cylinder to the point behind it where the velocity along the channel changes its
/// sign.
fn recirculation(flow: &Steady) -> Result<f64, Failure> {
    let rear = CENTRE[0] + RADIUS;
    let (mut low, mut high) = (0.5 * RADIUS, 4.0 * RADIUS);
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        let (velocity, _) = at(&flow.setup, &flow.state, &P::new(rear + middle, CENTRE[1]))?;
        if velocity[0] < 0.0 { low = middle } else { high = middle }
    }
    Ok(low)
}

//! Bodies that come close to vertices and lines of the mesh: condition numbers, and what they do to results.

use std::path::Path;

use cutwater::algebra::{Workspace, condition_number};
use cutwater::mesh::generate::structured_box;
use cutwater::solver::{State, advance};

use super::Failure;
use super::flow::{self, P, Random, polygon};
use super::orders::{Couette, couette_setup, known_polynomial};
use super::record::{Figure, Record};

/// Squares per side of the box.
const N: usize = 12;
/// Largest ratio of condition numbers over a sweep with ghost penalty.
const LARGEST_RATIO: f64 = 10.0;
/// Distances from 1e-1 to 1e-14 of the size of a cell.
const DECADES: std::ops::RangeInclusive<i32> = 1..=14;
/// A step so long that nothing is left of inertia.
const STEADY: f64 = 1e9;

/// What a body comes close to.
#[derive(Clone, Copy)]
enum Place {
    /// A corner of the body, to a vertex.
    Vertex,
    /// A side of the body, to a line of the mesh that is parallel to it.
    Line,
    /// A corner of the body, to the middle of a line of the mesh.
    Middle,
}

/// Measures sweeps and scatter.
///
/// # Errors
/// A step fails.
pub(super) fn measure(record: &mut Record, _out: &Path) -> Result<(), Failure> {
    for (place, name) in
        [(Place::Vertex, "corner to a vertex"), (Place::Middle, "corner to a line"), (Place::Line, "side to a line")]
    {
        let mut curves = Vec::new();
        for (ghost, label) in [(true, "with ghost penalty"), (false, "without")] {
            let mut conditions = Vec::new();
            let (mut solutions, mut energy_error): (Vec<f64>, f64) = (Vec::new(), 0.0);
            for decade in DECADES {
                let distance = 10.0_f64.powi(-decade);
                let [condition, energy, error] = solve(place, distance / N as f64, ghost)?;
                conditions.push((distance, condition));
                solutions.push(energy);
                energy_error = error;
            }
            let largest = conditions.iter().map(|(_, c)| *c).fold(0.0, f64::max);
            let least = conditions.iter().map(|(_, c)| *c).fold(f64::INFINITY, f64::min);
            if ghost {
                record.at_most(format!("{name}: condition number, largest over least"), largest / least, LARGEST_RATIO);
                record.show(format!("{name}: largest condition number"), largest, None);
                // From 1e-6 to 1e-12 of a cell; then round-off puts the body onto the line, and dofs vanish with their slivers.
                let (near, touching) = (solutions[11], solutions[13]);
                let change = solutions[5..=11].iter().map(|s| (s / near - 1.0).abs()).fold(0.0, f64::max);
                record.at_most(format!("{name}: change of the kinetic energy from 1e-6 h to 1e-12 h"), change, 1e-6);
                let jump = ((touching - near) / energy_error).abs();
                record.at_most(format!("{name}: its jump at the touch, over its error on this mesh"), jump, 1.0);
            } else {
                record.show(format!("{name}: the same without ghost penalty"), largest / least, None);
            }
            curves.push((label.to_owned(), conditions));
        }
        record.figures.push(Figure {
            title: format!("{name}: condition number"),
            x_title: "distance over h".to_owned(),
            curves,
            is_log: true,
        });
    }
    scatter(record)?;
    record.note(
        "Condition numbers in the Euclidean norm of the equilibrated matrix of a Stokes problem, 12 × 12 squares. The ghost \
         penalty is taken away with a weight of zero; the interior penalty of the pressure stays.",
    );
    Ok(())
}

/// Condition number, kinetic energy, and the error of that, of the flow with a square body at a distance from a vertex or line.
fn solve(place: Place, distance: f64, ghost: bool) -> Result<[f64; 3], Failure> {
    let known = known_polynomial();
    let h = 1.0 / N as f64;
    let mut setup = known.setup(structured_box::<2>([-0.5; 2], [0.5; 2], [N; 2])?, STEADY);
    if !ghost {
        setup.fluid.gamma_ghost = 0.0;
    }
    // The corner at the upper right comes close to a vertex; its sides are parallel to lines or turned.
    let corner = P::new(-0.5 + 8.0 * h, -0.5 + 8.0 * h);
    let side = 3.3 * h;
    let square = [[-1.0, -1.0], [0.0, -1.0], [0.0, 0.0], [-1.0, 0.0]].map(|[x, y]| P::new(x, y) * side);
    let turned = |angle: f64| {
        square.map(|x| P::new(angle.cos() * x[0] - angle.sin() * x[1], angle.sin() * x[0] + angle.cos() * x[1]))
    };
    let corners = match place {
        Place::Vertex => turned(0.2).map(|x| corner + x - P::new(distance, 0.6 * distance)),
        // Half a cell below the vertex, away from the diagonal.
        Place::Middle => turned(0.2).map(|x| corner + x - P::new(distance, 0.37 * h)),
        Place::Line => square.map(|x| corner + x - P::new(distance, 0.37 * h)),
    };
    setup.bodies.push(polygon(&[corners.to_vec()], |x, _| *x, known.velocity()));
    let mut work = Workspace::new();
    let (state, report) = advance(&setup, &State::initial(&setup)?, &mut work)?;
    let condition = condition_number(work.system().matrix(), work.system().unknowns())?;
    let energy = report.fluid_kinetic_energy;
    Ok([condition, energy, energy - known.kinetic_energy(&setup, &state)])
}

/// Torques of the flow between cylinders at random places of the mesh.
fn scatter(record: &mut Record) -> Result<(), Failure> {
    let (n, places) = if record.full { (32, 100) } else { (20, 25) };
    let mut random = Random(11);
    let mut torques = Vec::new();
    let h = 1.0 / n as f64;
    for _ in 0..places {
        let centre = P::new(random.between(0.0, h), random.between(0.0, h));
        let (_, setup) = couette_setup(n, centre)?;
        let (state, report) = flow::run(&setup, 1)?;
        torques.push(flow::force(&state, &report, 0, &centre).1 / Couette::TORQUE - 1.0);
    }
    let mean = torques.iter().sum::<f64>() / places as f64;
    let deviation = (torques.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / places as f64).sqrt();
    record.show(format!("Couette torque, {places} random places, h = 1/{n}: mean relative error"), mean, Some(0.0));
    record.at_most("the same: standard deviation, beside the mean error", deviation, mean.abs());
    Ok(())
}

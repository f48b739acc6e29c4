//! Steady flow in a cavity with a moving lid, by Newton's method with continuation.

use std::sync::Arc;

use cutwater::algebra::time::QuasiStatic;
use cutwater::algebra::{NewtonSettings, Workspace};
use cutwater::mesh::generate::structured_box;
use cutwater::solver::{ConvectionForm, FluidBoundary, Observer, ObserverError, Setup, State, StepView, TimeLoop};

use super::flow::{fluid, fluid_of, problem, wet};
use super::signal::{negative, peak};
use super::{Failure, P, Record, V, short};

/// Reynolds number.
const REYNOLDS: f64 = 1000.0;
/// Least horizontal velocity on the vertical line through the middle, greatest and least vertical velocity on the
/// horizontal one (Botella and Peyret 1998, doi:10.1016/S0045-7930(98)00002-4, Chebyshev polynomials of degree 160).
const KNOWN: [(&str, f64); 3] = [
    ("least u_x for x = 1/2", -0.388_569_8),
    ("greatest u_y for y = 1/2", 0.376_944_7),
    ("least u_y for y = 1/2", -0.527_077_1),
];
// Cells along a side, and largest relative error with the finest mesh. A boundary layer, `1/√Re`, then has 4 cells.
// With 1.5 cells `dfg-unsteady` allows 10 %, and errors fall with the square.
const SIZES: [usize; 3] = [32, 64, 128];
const ACCURACY: f64 = 0.014;
/// Required order of the errors in h.
const ORDER: f64 = 1.8;
/// Tolerance of Newton's method.
const TOLERANCE: f64 = 1e-10;
/// Largest number of halvings of the increment of the lid's speed.
const MOST_HALVINGS: usize = 6;

/// Increments of the lid's speed, and iterations of Newton's method with those of failed increments.
#[derive(Default)]
struct Increments {
    number: usize,
    iterations: usize,
}

impl Observer<2> for Increments {
    fn after_step(&mut self, view: &StepView<'_, 2>) -> Result<(), ObserverError> {
        if let Some(report) = view.report {
            self.number += 1;
            self.iterations += report.newton.iterations;
        }
        Ok(())
    }
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let mut errors = [Vec::new(), Vec::new(), Vec::new()];
    for (n, &cells) in SIZES.iter().enumerate() {
        let (found, increments) = steady(cells)?;
        record.show(format!("h = 1/{cells}: increments of the speed"), increments.number as f64, None);
        record.show(format!("h = 1/{cells}: Newton iterations"), increments.iterations as f64, None);
        for (k, (name, known)) in KNOWN.into_iter().enumerate() {
            let quantity = format!("h = 1/{cells}: {name}");
            if n + 1 == SIZES.len() {
                record.near_relative(quantity, found[k], known, ACCURACY);
            } else {
                record.show(quantity, found[k], Some(known));
            }
            errors[k].push((1.0 / cells as f64, (found[k] - known).abs()));
        }
    }
    for ((name, _), errors) in KNOWN.into_iter().zip(&errors) {
        record.order(&format!("error of the {name}"), "h", errors, ORDER);
    }
    record.note(format!(
        "Scheme `quasi-static`: one step without inertia, in which the speed of the lid grows from zero to that of Re = {}. Where Newton's method \
         fails the increment is halved, at most {MOST_HALVINGS} times, as in every run. Extrema are those of parabolas through three vertices.",
        short(REYNOLDS),
    ));
    Ok(())
}

/// Computes the steady flow with a number of cells along a side.
fn steady(cells: usize) -> Result<([f64; 3], Increments), Failure> {
    let background = structured_box::<2>([0.0, 0.0], [1.0, 1.0], [cells, cells])?;
    let mut fluid = fluid(background, 1.0, 1.0 / REYNOLDS);
    fluid.convection = Some(ConvectionForm::Standard);
    for side in ["left", "right", "bottom", "top"] {
        let tag = fluid.background.tag(side).ok_or("a side has no name")?;
        let lid = FluidBoundary::Velocity(Arc::new(|_: &P, speed| V::new(speed, 0.0)));
        fluid.boundary.push((tag, if side == "top" { lid } else { FluidBoundary::NoSlip }));
    }
    let setup = Setup {
        scheme: Arc::new(QuasiStatic),
        newton: NewtonSettings::new(TOLERANCE),
        most_halvings: MOST_HALVINGS,
        approach: None,
        ..problem(fluid, 1.0)
    };
    let mut run = TimeLoop::new(&setup, State::initial(&setup)?, Workspace::new());
    let mut increments = Increments::default();
    run.run(1, &mut [&mut increments])?;
    Ok((extrema(&setup, run.state())?, increments))
}

/// Returns the quantities of [`KNOWN`].
fn extrema(setup: &Setup<2>, state: &State<2>) -> Result<[f64; 3], Failure> {
    let (background, fluid) = (&fluid_of(setup)?.background, wet(state)?);
    let profile = |across: usize, component: usize| {
        let vertices = fluid.space.vertices().iter().map(|v| background.vertex(*v)).zip(&fluid.velocity);
        let on_line = vertices.filter(|(x, _)| (x[across] - 0.5).abs() < 1e-9);
        let mut curve: Vec<_> = on_line.map(|(x, u)| (x[1 - across], u[component])).collect();
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        curve
    };
    let (vertical, horizontal) = (profile(0, 0), profile(1, 1));
    Ok([-peak(&negative(&vertical)).1, peak(&horizontal).1, -peak(&negative(&horizontal)).1])
}

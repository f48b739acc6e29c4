//! A cylinder that approaches a wall in Stokes flow: the force of the film.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

use cutwater::mesh::SimplexMesh;
use cutwater::mesh::generate::structured_box;
use cutwater::solver::FluidBoundary;

use super::Failure;
use super::exact::Linear;
use super::flow::{self, P, V, disk, polygon};
use super::record::{Figure, Record};

/// Gaps, over the radius of the cylinder.
const GAPS: [f64; 3] = [0.2, 0.1, 0.05];
/// Largest relative error at four cells across the film or more.
const ACCURACY: f64 = 0.03;
/// Distance of the outer boundary from the wall under the cylinder, in radii.
const FAR: f64 = 60.0;
/// A step so long that nothing is left of inertia.
const STEADY: f64 = 1e9;

/// Measures forces for several gaps and numbers of cells across them.
///
/// # Errors
/// A step fails.
pub(super) fn measure(record: &mut Record, _out: &Path) -> Result<(), Failure> {
    let cells: &[f64] = if record.full { &[0.5, 1.0, 2.0, 4.0, 8.0] } else { &[1.0, 2.0, 4.0] };
    let mut curves = Vec::new();
    for gap in GAPS {
        let exact = exact_force(gap);
        let mut curve = Vec::new();
        for &n in cells {
            let computed = force(gap, n)?;
            let quantity = format!("force at gap {gap} R, {n} cells across it");
            if n >= 4.0 {
                record.near_relative(quantity, computed, exact, ACCURACY);
            } else {
                record.show(quantity, computed, Some(exact));
            }
            curve.push((n, computed / exact));
        }
        curves.push((format!("gap {gap} R"), curve));
    }
    record.figures.push(Figure {
        title: "Force of the film over the exact one".to_owned(),
        x_title: "cells across the gap".to_owned(),
        curves,
        is_log: false,
    });
    record.note(
        "Stokes flow, per unit of viscosity and speed; half of a domain of 60 radii whose mesh is graded towards the point under \
         the cylinder. Exact for a half plane: 4π/(α - tanh α), cosh α = 1 + gap/R.",
    );
    Ok(())
}

/// Force over viscosity and speed on a cylinder of radius one that moves towards a wall.
fn exact_force(gap: f64) -> f64 {
    let alpha = (1.0 + gap).acosh();
    4.0 * PI / (alpha - alpha.tanh())
}

/// Force with so many cells across the gap.
fn force(gap: f64, cells: f64) -> Result<f64, Failure> {
    let known = Linear::at_rest(V::zeros()).known(1.0, &[]);
    let mut setup = known.setup(graded(gap, cells)?, STEADY);
    let tag = |name: &str| setup.background.tag(name).ok_or("a side of a box");
    let open = || FluidBoundary::Open { traction: None, backflow: false };
    setup.fluid.boundary = vec![
        (tag("left")?, FluidBoundary::Symmetry { axis: 0 }),
        (tag("right")?, open()),
        (tag("top")?, open()),
        (tag("bottom")?, FluidBoundary::NoSlip),
    ];
    // Edges no longer than the film's cells, but fine enough where those are coarse.
    let n = (8.0 * PI * cells / gap).max(240.0).round() as usize;
    let corners = disk(P::new(0.0, 1.0 + gap), 1.0, n);
    setup.bodies.push(polygon(&[corners], |x, _| *x, Arc::new(|_, _| V::new(0.0, -1.0))));
    let (state, report) = flow::run(&setup, 1)?;
    // The other half has the same.
    Ok(2.0 * flow::force(&state, &report, 0, &P::zeros()).0[1])
}

/// A quarter plane with cells of size `gap/cells` at its corner that grow with the distance.
fn graded(gap: f64, cells: f64) -> Result<SimplexMesh<2>, Failure> {
    // x = a sinh(b s): cells have about their least size within a, twice the length of the film.
    let a = 2.0 * gap.sqrt();
    let b = (FAR / a).asinh();
    let n = (a * b * cells / gap).ceil() as usize;
    let even = structured_box::<2>([0.0; 2], [1.0; 2], [n; 2])?;
    let stretch = |s: f64| if s == 1.0 { FAR } else { a * (b * s).sinh() };
    let vertices = even.vertices().iter().map(|x| P::new(stretch(x[0]), stretch(x[1]))).collect();
    let cells = even.cells().flat_map(|cell| even.cell(cell).iter().copied()).collect();
    let side = |facet: &[P]| {
        let on = |axis: usize, value: f64| facet.iter().all(|x| x[axis] == value);
        let sides = [(0, 0.0, "left"), (0, FAR, "right"), (1, 0.0, "bottom"), (1, FAR, "top")];
        sides.into_iter().find(|(axis, value, _)| on(*axis, *value)).map(|(_, _, name)| name)
    };
    Ok(SimplexMesh::new(vertices, cells)?.with_boundary_tags(side))
}

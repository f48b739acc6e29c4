//! Films that are thinner than a few cells: spheres, cylinders and plates that approach a wall.

use std::f64::consts::PI;
use std::sync::Arc;

use cutwater::mesh::SimplexMesh;
use cutwater::mesh::generate::{Region, RegionShape, Size, refined_box, structured_box};
use cutwater::solver::{FilmSetup, FluidBoundary, Setup, Stabilisation};

use super::axisymmetric::{brenner, moving, slow, sphere};
use super::flow::{self, fluid_mut, polygon};
use super::lubrication::{approach, exact_force, graded};
use super::{Failure, P, Record, Run, V};

/// Gaps over the size of a cell: those judged, and thinner ones.
const GAPS: [f64; 6] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.1];
const THIN: [f64; 2] = [0.05, 0.02];

/// A mesh for films, and the settings of the solver.
#[derive(Clone, Copy)]
struct Case {
    /// Cells per radius.
    cells: f64,
    film: bool,
    stabilisation: Stabilisation,
    /// Shift of the mesh across the wall and of its cells along it, over the size of a cell.
    shift: f64,
}

impl Case {
    fn new(cells: f64) -> Self {
        Self { cells, film: true, stabilisation: Stabilisation::STANDARD, shift: 0.0 }
    }
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let number = |name: &str, default: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let mut stabilisation = Stabilisation::STANDARD;
    let g = number("G_SIGMA", 35.0);
    stabilisation.penalty = cutwater::interface_dg::terms::PenaltyProfile::Split {
        gamma_normal: number("G_N", g),
        gamma_tangential: number("G_T", g),
    };
    stabilisation.gamma_pressure = number("G_P", 0.05);
    stabilisation.gamma_ghost = number("G_G", 0.1);
    let line = |name: String, of: &dyn Fn(f64) -> Result<f64, Failure>| -> Result<(), Failure> {
        let mut text = format!("{name:24}");
        for gap in [4.0, 2.0, 1.4, 1.0, 0.7, 0.5, 0.25, 0.1, 0.05, 0.02] {
            text += &format!(" {:.4}", of(gap)?);
        }
        println!("{text}");
        Ok(())
    };
    let case = |cells: f64| Case { stabilisation, ..Case::new(cells) };
    line("sphere 20".into(), &|gap| sphere_force(&case(20.0), gap))?;
    line("sphere 40".into(), &|gap| sphere_force(&case(40.0), gap))?;
    line("cylinder 20".into(), &|gap| cylinder_force(&case(20.0), gap))?;
    for degrees in [0.0, 3.0, 10.0, 20.0, 30.0] {
        line(format!("plates {degrees}"), &|gap| plates_force(&case(20.0), gap, degrees))?;
    }
    record.show("x", 0.0, None);
    Ok(())
}

/// Returns the force on a sphere of radius one that approaches a wall, over the exact one; the gap is given over the size of a cell.
fn sphere_force(case: &Case, gap: f64) -> Result<f64, Failure> {
    /// Extent of the fluid in radii. Without an outer boundary forces are lower by less than 1 %.
    const FAR: f64 = 40.0;
    let h = 1.0 / case.cells;
    let gap = gap * h;
    let near = RegionShape::Segment { ends: [P::zeros(), P::new(0.0, 2.2)], within: 1.2 };
    let regions = [Region { shape: near, size: h, growth: 0.25 }];
    let background = refined_box([0.0, -case.shift * h], [FAR, FAR], &Size::uniform(4.0), &regions)?;
    let open = || FluidBoundary::Open { traction: None, backflow: false };
    let on_side = |side: &str| if side == "bottom" { FluidBoundary::NoSlip } else { open() };
    let mut setup = slow(background, 1e-9, on_side)?;
    set(case, &mut setup)?;
    let velocity = Arc::new(|_: &P, _| V::new(0.0, -1.0));
    setup.bodies.push(moving(sphere(1.0 + gap, 1.0, h), |x, t| x - V::new(0.0, t), velocity));
    Ok(force(setup)? / (6.0 * PI * brenner(gap)))
}

fn set(case: &Case, setup: &mut Setup<2>) -> Result<(), Failure> {
    let fluid = fluid_mut(setup)?;
    fluid.film = case.film.then_some(FilmSetup { roughness: 0.0 });
    fluid.stabilisation = case.stabilisation;
    Ok(())
}

fn force(setup: Setup<2>) -> Result<f64, Failure> {
    let mut run = Run::new(setup)?;
    let report = run.advance()?;
    Ok(flow::force(&run.state, &report, 0, &P::zeros())?.0[1])
}

/// Returns the force on a cylinder of radius one that approaches a wall, over the exact one.
fn cylinder_force(case: &Case, gap: f64) -> Result<f64, Failure> {
    let h = 1.0 / case.cells;
    let gap = gap * h;
    let n = 4 * (2.0 * PI / h).ceil() as usize;
    let mut setup = approach(graded(0.4, h)?, gap, n)?;
    set(case, &mut setup)?;
    Ok(2.0 * force(setup)? / exact_force(gap))
}

/// Returns the force on one of two parallel plates that approach each other, tilted relative to the mesh, over the exact one.
fn plates_force(case: &Case, gap: f64, degrees: f64) -> Result<f64, Failure> {
    const CELLS: usize = 40;
    let h = 1.0 / CELLS as f64;
    let gap = gap * h;
    let background: SimplexMesh<2> = structured_box::<2>([0.0, -0.75], [1.0, 0.75], [CELLS, CELLS * 3 / 2])?;
    let angle = f64::to_radians(degrees);
    let (along, across) = (V::new(angle.cos(), angle.sin()), V::new(-angle.sin(), angle.cos()));
    let middle = P::new(0.5, 0.0031);
    // Plates end outside of the mesh.
    let plate = |side: f64| {
        let at = |x: f64, y: f64| middle + along * x + across * (side * 0.5 * gap + y);
        let thickness = 0.2 * side;
        let corners = [at(-2.0, 0.0), at(2.0, 0.0), at(2.0, thickness), at(-2.0, thickness)];
        if side > 0.0 { corners.to_vec() } else { corners.into_iter().rev().collect() }
    };
    let mut setup = super::linear_flow::Linear::at_rest(V::zeros()).known(1.0, &[]).setup(background, 1e9);
    flow::set_sides(&mut setup, || FluidBoundary::Open { traction: None, backflow: false })?;
    set(case, &mut setup)?;
    for side in [1.0, -1.0] {
        let velocity = across * (-0.5 * side);
        setup.bodies.push(polygon(&[plate(side)], |x, _| *x, Arc::new(move |_, _| velocity)));
    }
    let mut run = Run::new(setup)?;
    let report = run.advance()?;
    let force = flow::force(&run.state, &report, 0, &P::zeros())?.0.dot(&across);
    let length = 1.0 / angle.cos();
    Ok(force / (length / gap).powi(3))
}

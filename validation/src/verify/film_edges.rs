//! Films that end at the edge of a body, with open fluid behind it: plates that approach a wall, and gates.

use std::f64::consts::PI;
use std::sync::Arc;

use cutwater::algebra::time::QuasiStatic;
use cutwater::mesh::generate::structured_box;
use cutwater::solver::{FilmSetup, FluidBoundary, Setup, TractionField};

use super::flow::{self, fluid_mut, polygon, set_side};
use super::{Failure, P, Record, V};

/// Largest relative error of the force on plates.
const PLATES: f64 = 0.02;
/// Largest relative error of the leak below gates.
const LEAK: f64 = 0.06;

/// Measures the force on a plate over a wall, with open fluid behind its edges.
///
/// The reference is Reynolds' equation with the resistance of the open fluid, which was computed on meshes with 10 and
/// 20 cells across gaps of 1/10, 1/20 and 1/40 of the length: [`with_open_fluid`].
pub(super) fn edges(record: &mut Record) -> Result<(), Failure> {
    let positions = if record.full { 10 } else { 3 };
    let lengths: &[f64] = if record.full { &[10.0, 20.0, 40.0] } else { &[20.0] };
    for &along in lengths {
        for gap in [1.0, 0.5, 0.25, 0.1, 0.02] {
            let ratio = |begins| Ok(plate_in_fluid(along, gap, begins)? / with_open_fluid(gap / along));
            let worst = worst_of(positions, ratio)?;
            let name = format!(
                "plate of {along} cells with open fluid behind its edges, gap of {gap} cells, worst of {positions} positions: force over the exact one"
            );
            record.near_relative(name, worst, 1.0, PLATES);
        }
        for gap in [0.5, 0.1, 0.02] {
            let ratio = |begins| Ok(plate_over_floor(along, gap, begins)? / with_open_fluid(gap / along));
            let worst = worst_of(positions, ratio)?;
            let name = format!(
                "plate of {along} cells with open fluid behind its edges, a gap of {gap} cells in two layers, worst of {positions} positions: force over the exact one"
            );
            record.near_relative(name, worst, 1.0, PLATES);
        }
        for gap in [1.0, 0.5, 0.1, 0.02] {
            let ratio = |begins| Ok(equal_plates(along, gap, begins)? / with_open_fluid_between_plates(gap / along));
            let worst = worst_of(positions, ratio)?;
            let name = format!(
                "two equal plates of {along} cells with open fluid behind their edges, gap of {gap} cells, worst of {positions} positions: force over the exact one"
            );
            record.near_relative(name, worst, 1.0, PLATES);
        }
    }
    let lengths: &[f64] = if record.full { &[2.0, 3.0, 5.0, 10.0] } else { &[3.0] };
    for &along in lengths {
        for gap in [0.3, 0.1, 0.02] {
            let ratio = worst_of(positions, |begins| leak(along, gap, begins))?;
            let name = format!(
                "gate with a seal of {along} cells, gap of {gap} cells, worst of {positions} positions: leak over the exact one"
            );
            record.near_relative(name, ratio, 1.0, LEAK);
        }
    }
    if record.full {
        // Twenty cells across the gap are without a model of the film.
        let ratio = plate_in_fluid(200.0, 20.0, 0.5)? / with_open_fluid(0.1);
        let name = "plate of ten gaps, 20 cells across them: force over that of Reynolds' equation and the open fluid";
        record.near_relative(name, ratio, 1.0, PLATES);
    }
    Ok(())
}

/// Returns the value farthest from one of those for so many positions in a cell.
fn worst_of(positions: u32, ratio: impl Fn(f64) -> Result<f64, Failure>) -> Result<f64, Failure> {
    let ratios = (0..positions).map(|k| ratio((f64::from(k) + 0.5) / f64::from(positions)));
    let ratios = ratios.collect::<Result<Vec<_>, _>>()?;
    let off = |ratio: &f64| (ratio - 1.0).abs();
    Ok(ratios.into_iter().max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(f64::NAN))
}

/// Returns the force on a plate over a wall with open fluid behind its edges, over that of Reynolds' equation, for a
/// gap relative to the length.
fn with_open_fluid(gap: f64) -> f64 {
    1.0 + 3.8 * gap + 10.0 * gap * gap
}

/// Returns the force on two equal plates that approach each other, as [`with_open_fluid`] does for a plate over a wall.
/// The open fluid resists as that on one side of a slit, like a film of the length `ε = 4/(3π) δ` (Hasimoto 1958, DOI
/// 10.1143/JPSJ.13.633), so that the term of first order is `6 ε/L`. That of second order is from runs with 8 and 16
/// cells across gaps of 1/5 and 1/10 of the length.
fn with_open_fluid_between_plates(gap: f64) -> f64 {
    1.0 + 8.0 / PI * gap + 5.0 * gap * gap
}

/// Returns a body over a wall in open fluid, which moves down with a speed. It has a length, its lower and upper side
/// are at two heights above the wall, and it begins at a fraction of a cell. Cells have the size one; the fluid ends at
/// a distance from the body.
fn over_floor(around: f64, length: f64, heights: [f64; 2], begins: f64, speed: f64) -> Result<Setup<2>, Failure> {
    let cells = [length + 2.0 * around, 2.0 * around].map(|n| n as usize);
    let background = structured_box::<2>([0.0; 2], cells.map(|n| n as f64), cells)?;
    let mut setup = flow::problem(flow::fluid(background, 1e-9, 1.0), 1e9);
    for side in ["left", "right", "bottom", "top"] {
        set_side(&mut setup, side, flow::wall_below(side))?;
    }
    setup.scheme = Arc::new(QuasiStatic);
    fluid_mut(&mut setup)?.film = Some(FilmSetup::default());
    let [from, to] = [around - 1.0 + begins, around - 1.0 + begins + length];
    let [low, high] = heights;
    let corners = [(from, low), (to, low), (to, high), (from, high)].map(|(x, y)| P::new(x, y));
    setup.bodies.push(polygon(&[corners.to_vec()], |x, _| *x, Arc::new(move |_, _| V::new(0.0, -speed))));
    Ok(setup)
}

/// Returns the force on the first body in the first step.
pub(super) fn first_force(setup: &Setup<2>) -> Result<V, Failure> {
    let (state, report) = flow::run(setup, 1)?;
    Ok(flow::force(&state, &report, 0, &P::zeros())?.0)
}

/// Returns the force on a plate over a wall that ends in open fluid over that of Reynolds' equation. Its length and the
/// gap are relative to the size of a cell, and it begins at a fraction of a cell.
fn plate_in_fluid(along: f64, gap: f64, begins: f64) -> Result<f64, Failure> {
    let around = 4.0 * gap.max(1.0);
    let setup = over_floor(around, along, [gap, gap + 0.5 * around], begins, 1.0)?;
    Ok(first_force(&setup)?[1] * (gap / along).powi(3))
}

/// Returns the result of [`plate_in_fluid`] for a plate over the top of a body, with a line of the mesh in the middle
/// of the film.
fn plate_over_floor(along: f64, gap: f64, begins: f64) -> Result<f64, Failure> {
    const AROUND: f64 = 4.0;
    const LINE: f64 = 2.0;
    let [below, above] = [LINE - 0.5 * gap, LINE + 0.5 * gap];
    let mut setup = over_floor(AROUND, along, [above, above + 0.5 * AROUND], begins, 1.0)?;
    let right = along + 2.0 * AROUND + 1.0;
    let corners = [(-1.0, -1.0), (right, -1.0), (right, below), (-1.0, below)].map(|(x, y)| P::new(x, y));
    setup.bodies.push(polygon(&[corners.to_vec()], |x, _| *x, Arc::new(|_, _| V::zeros())));
    Ok(first_force(&setup)?[1] * (gap / along).powi(3))
}

/// Returns the result of [`plate_in_fluid`] for two equal plates in open fluid that approach each other. Their film is
/// around the middle of a row of cells.
fn equal_plates(along: f64, gap: f64, begins: f64) -> Result<f64, Failure> {
    const AROUND: f64 = 4.0;
    const MIDDLE: f64 = 3.5;
    let [below, above] = [MIDDLE - 0.5 * gap, MIDDLE + 0.5 * gap];
    let mut setup = over_floor(AROUND, along, [above, above + 0.5 * AROUND], begins, 0.5)?;
    flow::set_sides(&mut setup, flow::open)?;
    let [from, to] = [AROUND - 1.0 + begins, AROUND - 1.0 + begins + along];
    let corners = [(from, below - 0.5 * AROUND), (to, below - 0.5 * AROUND), (to, below), (from, below)];
    let upwards = Arc::new(|_: &P, _: f64| V::new(0.0, 0.5));
    setup.bodies.push(polygon(&[corners.map(|(x, y)| P::new(x, y)).to_vec()], |x, _| *x, upwards));
    Ok(first_force(&setup)?[1] * (gap / along).powi(3))
}

/// Returns the leak below a gate between two pressures over that of a film with the resistance of the open fluid on
/// both sides, `1.27 δ` as that of [`with_open_fluid`].
fn leak(along: f64, gap: f64, begins: f64) -> Result<f64, Failure> {
    const AROUND: f64 = 4.0;
    let mut setup = over_floor(AROUND, along, [gap, 3.0 * AROUND], begins, 0.0)?;
    let traction: TractionField<2> = Arc::new(|_, n, _| -*n);
    set_side(&mut setup, "left", FluidBoundary::Open { traction: Some(traction), backflow: false })?;
    set_side(&mut setup, "top", FluidBoundary::NoSlip)?;
    let (state, _) = flow::run(&setup, 1)?;
    let (background, fluid) = (&flow::fluid_of(&setup)?.background, flow::wet(&state)?);
    let [right, height] = [along + 2.0 * AROUND, 2.0 * AROUND];
    let nodes =
        fluid.velocity.iter().enumerate().map(|(dof, u)| (background.vertex(fluid.space.vertex(dof as u32)), u));
    // The velocity on the right is linear between nodes at the distance one, and zero at its ends.
    let flux: f64 = nodes.filter(|(x, _)| x[0] == right && x[1] > 0.0 && x[1] < height).map(|(_, u)| u[0]).sum();
    Ok(flux * 12.0 * (along + 1.27 * gap) / gap.powi(3))
}

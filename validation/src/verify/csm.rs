//! The flag of the Turek-Hron benchmark without a fluid, under its weight: at rest, and swinging.
//!
//! Source: Turek and Hron 2006, Proposal for numerical benchmarking of fluid-structure interaction between an elastic
//! object and laminar incompressible flow, doi:10.1007/3-540-34596-5_15, CSM1 to CSM3. SI units.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use cutwater::algebra::time::{ImplicitEuler, QuasiStatic};
use cutwater::mesh::generate::structured_box;
use cutwater::mesh::{SimplexMesh, VertexId};
use cutwater::solid_svk::{LameParameters, Order, SaintVenantKirchhoff, SolidMesh, SupportKind};

use super::dry::{self, Scheme, elastic_of, second_order};
use super::signal::{negative, peak, rises};
use super::{DirectRun, Failure, P, Record, V, short};

const LENGTH: f64 = 0.35;
const THICKNESS: f64 = 0.02;
// The point whose displacement is measured, and the cylinder that holds the other end.
const TIP: [f64; 2] = [0.6, 0.2];
const CYLINDER: ([f64; 2], f64) = ([0.2, 0.2], 0.05);
pub(super) const DENSITY: f64 = 1e3;
const GRAVITY: f64 = 2.0;
// Shear modulus of CSM1 and CSM3, and of CSM2; λ = 4 μ, which is ν = 0.4.
pub(super) const SOFT: f64 = 0.5e6;
pub(super) const STIFF: f64 = 2e6;
// Vertical displacement of the tip.
const CSM1: f64 = -66.10e-3;
const CSM2: f64 = -16.97e-3;
/// Mean, amplitude, frequency of CSM3.
const CSM3: [f64; 3] = [-63.607e-3, 65.160e-3, 1.0995];
/// Rows of cells across the flag, and displacements of CSM1 with P1 of another code (NGSolve).
const PEER: [(usize, f64); 5] = [(2, -28.99e-3), (4, -49.89e-3), (8, -61.06e-3), (16, -64.74e-3), (32, -65.75e-3)];
/// Largest relative difference from the results of the other code.
const SAME: f64 = 1e-3;
// Rows of quadratic elements, and of linear ones that are compared with them in cost.
const QUADRATIC_ROWS: usize = 4;
const LINEAR_ROWS: usize = 32;
/// Largest relative errors with quadratic elements: of displacements at rest, of amplitude and of frequency.
const QUADRATIC: [f64; 3] = [0.005, 0.01, 0.01];
/// Steps in which the weight is applied at rest.
const LOAD_STEPS: u32 = 4;

/// Quantities of a swing that are compared, with the largest relative error.
const COMPARED: [(&str, f64); 3] =
    [("mean of u_y [m]", 0.02), ("amplitude of u_y [m]", 0.02), ("frequency [Hz]", 0.01)];
/// Swings of the comparison, of which the last complete one is evaluated.
const SWINGS: f64 = 2.4;
/// Rows, swings and time steps of the comparison of time steps.
const LONG: (usize, f64, [f64; 3]) = (8, 11.0, [1e-2, 5e-3, 2.5e-3]);

#[derive(Clone, Copy)]
struct Flag {
    /// Rows of cells across it, each of squares in two triangles.
    rows: usize,
    mu: f64,
    order: Order,
    /// Whether its end follows the cylinder, as that of the benchmark; a straight end is at the cylinder's rightmost
    /// point.
    is_fitted: bool,
}

impl Flag {
    /// Creates the run of the flag under a given gravity.
    fn run(self, gravity: f64, scheme: Scheme, dt: f64) -> Result<DirectRun, Failure> {
        let material = SaintVenantKirchhoff::new(LameParameters::new(self.mu, 4.0 * self.mu)?);
        let mut body = elastic_of(self.solid()?, DENSITY, material, V::new(0.0, -gravity), scheme)?;
        body.hold("left", SupportKind::Clamped)?;
        dry::run(vec![body], None, dt, 1e-9)
    }

    /// Returns the elements. Nodes on edges are moved as vertices are.
    fn solid(self) -> Result<SolidMesh<2>, Failure> {
        let mesh = mesh(self.rows, self.is_fitted)?;
        Ok(match self.order {
            Order::Linear => SolidMesh::new(mesh)?,
            Order::Quadratic if self.is_fitted => {
                let on_edge = edge_nodes(self.rows)?;
                SolidMesh::curved(mesh, |ends, middle| on_edge(ends).unwrap_or(middle))?
            }
            Order::Quadratic => SolidMesh::of_order(mesh, Order::Quadratic)?,
        })
    }

    /// Computes the displacement of the tip at rest.
    fn rest(self) -> Result<V, Failure> {
        let mut run = self.run(0.0, Arc::new(QuasiStatic), 1.0)?;
        for k in 1..=LOAD_STEPS {
            let state = run.state;
            run = self.run(GRAVITY * f64::from(k) / f64::from(LOAD_STEPS), Arc::new(QuasiStatic), 1.0)?;
            run.state = state;
            run.advance()?;
        }
        displacement(&run)
    }

    /// Computes the times and vertical displacements of the tip over a number of swings of the benchmark.
    fn swing(self, scheme: Scheme, dt: f64, swings: f64) -> Result<Vec<(f64, f64)>, Failure> {
        let mut run = self.run(GRAVITY, scheme, dt)?;
        let mut signal = vec![(0.0, 0.0)];
        while run.state.time < swings / CSM3[2] {
            run.advance()?;
            signal.push((run.state.time, displacement(&run)?[1]));
        }
        Ok(signal)
    }
}

/// Returns the mesh of the flag with a number of rows of squares across it, each in two triangles.
pub(super) fn mesh(rows: usize, is_fitted: bool) -> Result<SimplexMesh<2>, Failure> {
    Ok(squares(rows)?.mapped(|at| moved(at, is_fitted))?)
}

/// Returns where the nodes on the edges of a fitted flag are, for the ends of an edge; none for other vertices than its
/// own.
pub(super) fn edge_nodes(rows: usize) -> Result<impl Fn([VertexId; 2]) -> Option<P>, Failure> {
    let even = squares(rows)?;
    Ok(move |ends: [VertexId; 2]| {
        let [a, b] = ends.map(|end| even.vertices().get(end.index()));
        Some(moved(&((a? + b?) * 0.5), true))
    })
}

/// Returns the mesh of a flag with a straight end.
fn squares(rows: usize) -> Result<SimplexMesh<2>, Failure> {
    let columns = (rows as f64 * LENGTH / THICKNESS).round() as usize;
    let [x, y] = TIP;
    let (low, high) = ([x - LENGTH, y - 0.5 * THICKNESS], [x, y + 0.5 * THICKNESS]);
    Ok(structured_box::<2>(low, high, [columns, rows])?)
}

/// Returns where a point of the flag with a straight end is in one whose end follows the cylinder.
fn moved(at: &P, is_fitted: bool) -> P {
    let (x, ([cx, cy], radius)) = (TIP[0], CYLINDER);
    let end = cx + (radius.powi(2) - (at[1] - cy).powi(2)).sqrt();
    let stretch = if is_fitted { (x - end) / LENGTH } else { 1.0 };
    P::new(x - (x - at[0]) * stretch, at[1])
}

/// Returns the displacement of the tip, where the two halves of the end meet.
pub(super) fn displacement(run: &DirectRun) -> Result<V, Failure> {
    let tip = P::from(TIP);
    let at =
        run.setup.bodies[0].reference().iter().position(|x| (x - tip).norm() < 1e-9).ok_or("no vertex at the tip")?;
    Ok(run.state.bodies[0].displacement()[at])
}

/// Returns the mean, amplitude and frequency of each swing, from one passage of the middle downwards to the next.
fn swings(signal: &[(f64, f64)]) -> Vec<[f64; 3]> {
    let down = negative(signal);
    let range = |k: Range<usize>| [-peak(&down[k.clone()]).1, peak(&signal[k]).1];
    let [low, high] = range(0..signal.len());
    let passages = rises(&down, -0.5 * (low + high));
    let swing = |w: &[(usize, f64)]| {
        let [low, high] = range(w[0].0 - 1..w[1].0 + 1);
        [0.5 * (high + low), 0.5 * (high - low), (w[1].1 - w[0].1).recip()]
    };
    passages.windows(2).map(swing).collect()
}

fn last(signal: &[(f64, f64)]) -> Result<[f64; 3], Failure> {
    Ok(swings(signal).pop().ok_or("the flag does not swing twice")?)
}

/// Extrapolates values on two meshes, given by their numbers of rows, whose errors fall with the square of the size.
fn extrapolated(rows: [usize; 2], [coarse, fine]: [f64; 2]) -> f64 {
    fine + (fine - coarse) / ((rows[1] as f64 / rows[0] as f64).powi(2) - 1.0)
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    let flag = |rows: usize, mu: f64| Flag { rows, mu, order: Order::Linear, is_fitted: true };
    let mut errors = Vec::new();
    let mut values = Vec::new();
    let peer = if record.full { &PEER[..] } else { &PEER[..4] };
    for &(rows, peer) in peer {
        let u = flag(rows, SOFT).rest()?[1];
        record.show(format!("CSM1, {rows} rows: u_y [m]"), u, Some(CSM1));
        // The same element on as many squares: the results agree up to the printed digits and the direction of the
        // diagonals.
        record.near_relative(format!("CSM1, {rows} rows: u_y compared with NGSolve's P1 [m]"), u, peer, SAME);
        errors.push((1.0 / rows as f64, (u - CSM1).abs()));
        values.push(u);
    }
    let [.., coarse, fine] = values[..] else { return Err("two meshes are needed".into()) };
    record.near_relative("CSM1: extrapolated u_y [m]", extrapolated([1, 2], [coarse, fine]), CSM1, 5e-3);
    record.order("error of u_y, CSM1", "1/rows", &errors, 1.7);
    let rows = if record.full { [16, 32] } else { [8, 16] };
    let both = |flag: &dyn Fn(usize) -> Flag| -> Result<[f64; 2], Failure> {
        Ok([flag(rows[0]).rest()?[1], flag(rows[1]).rest()?[1]])
    };
    let stiff = both(&|rows| flag(rows, STIFF))?;
    record.show(format!("CSM2, {} rows: u_y [m]", rows[1]), stiff[1], Some(CSM2));
    record.near_relative("CSM2: extrapolated u_y [m]", extrapolated(rows, stiff), CSM2, 5e-3);
    let straight = both(&|rows| Flag { is_fitted: false, ..flag(rows, SOFT) })?;
    record.show("CSM1, straight end: extrapolated u_y [m]", extrapolated(rows, straight), Some(CSM1));

    swinging(record)?;
    quadratic(record)?;
    record.note(format!(
        "A flag of {LENGTH} by {THICKNESS}, its end clamped to the cylinder, squares in two triangles. Linear triangles are too stiff in \
         bending; their errors fall with the square of the size, which extrapolation uses."
    ));
    Ok(())
}

fn swinging(record: &mut Record) -> Result<(), Failure> {
    let (rows, dt): (&[usize], f64) = if record.full { (&[8, 16, 32], 5e-3) } else { (&[6, 10], 1e-2) };
    let flag = |rows: usize| Flag { rows, mu: SOFT, order: Order::Linear, is_fitted: true };
    let scheme = second_order(0.8)?;
    let (mut found, mut curves) = (Vec::new(), Vec::new());
    for &rows in rows {
        let signal = flag(rows).swing(Arc::clone(&scheme), dt, SWINGS)?;
        found.push(last(&signal)?);
        curves.push((format!("{rows} rows"), signal));
    }
    let ([.., before, finest], [.., coarse, fine]) = (rows, &found[..]) else {
        return Err("two meshes are needed".into());
    };
    for (k, (name, tolerance)) in COMPARED.into_iter().enumerate() {
        for (rows, found) in rows.iter().zip(&found) {
            record.show(format!("CSM3, {rows} rows: {name}"), found[k], Some(CSM3[k]));
        }
        let limit = extrapolated([*before, *finest], [coarse[k], fine[k]]);
        let extrapolated = format!("CSM3: extrapolated {name}");
        if record.full {
            record.near_relative(format!("CSM3: {name}"), fine[k], CSM3[k], tolerance);
            record.show(extrapolated, limit, Some(CSM3[k]));
            if let [a, b, c] = found[..] {
                let order = ((a[k] - b[k]) / (b[k] - c[k])).log2();
                record.show(format!("CSM3: order of differences of the {name} between three meshes"), order, None);
            }
        } else {
            // Meshes of the quick version are too coarse for the bound.
            record.near_relative(extrapolated, limit, CSM3[k], tolerance);
        }
    }
    let euler = flag(rows[0]).swing(Arc::new(ImplicitEuler), dt, SWINGS)?;
    let quantity = format!("CSM3, {} rows, implicit Euler: amplitude of u_y in the second swing [m]", rows[0]);
    record.show(quantity, last(&euler)?[1], Some(CSM3[1]));
    curves.push((format!("{} rows, implicit Euler", rows[0]), euler));
    record.figure("CSM3: u_y of the tip [m]", "t [s]", curves);
    if record.full {
        time_steps(record, &flag)?;
    }
    record.note(format!(
        "CSM3 with generalised-α, rho_inf = 0.8, dt = {dt}, in the second swing. The swings are not quite periodic: how far the tip \
         comes back, {} mm above its start in the reference, changes slowly from swing to swing. Mean and amplitude take half of that each: with dt = 5e-3 the tip comes back to its start within 0.2 mm in the second swing, on all \
         meshes, and the mean is that much lower than that of the reference.",
        short(1e3 * (CSM3[0] + CSM3[1])),
    ));
    Ok(())
}

/// Compares the flag of quadratic elements with the benchmark, and its cost with that of linear elements of the same
/// use.
fn quadratic(record: &mut Record) -> Result<(), Failure> {
    let flag = |mu: f64| Flag { rows: QUADRATIC_ROWS, mu, order: Order::Quadratic, is_fitted: true };
    let linear = Flag { rows: LINEAR_ROWS, mu: SOFT, order: Order::Linear, is_fitted: true };
    let name = |flag: Flag| format!("{} rows of order {}", flag.rows, flag.order.degree());
    let quadratic = name(flag(SOFT));
    for (case, mu, exact) in [("CSM1", SOFT, CSM1), ("CSM2", STIFF, CSM2)] {
        record.near_relative(format!("{case}, {quadratic}: u_y [m]"), flag(mu).rest()?[1], exact, QUADRATIC[0]);
    }
    let signal = flag(SOFT).swing(second_order(0.8)?, 5e-3, SWINGS)?;
    let found = last(&signal)?;
    record.show(format!("CSM3, {quadratic}: {}", COMPARED[0].0), found[0], Some(CSM3[0]));
    for k in 1..3 {
        record.near_relative(format!("CSM3, {quadratic}: {}", COMPARED[k].0), found[k], CSM3[k], QUADRATIC[k]);
    }
    let compared = if record.full { vec![flag(SOFT), linear] } else { vec![flag(SOFT)] };
    for flag in compared {
        let name = name(flag);
        record.show(format!("{name}: unknowns"), (2 * flag.solid()?.nodes().len()) as f64, None);
        let begin = Instant::now();
        flag.rest()?;
        record.show(format!("CSM1, {name}: time [s]"), begin.elapsed().as_secs_f64(), None);
    }
    Ok(())
}

/// Computes many swings of a coarse flag with several time steps: records the last one, and the return of the tip in
/// each.
fn time_steps(record: &mut Record, flag: &dyn Fn(usize) -> Flag) -> Result<(), Failure> {
    let (rows, many, steps) = LONG;
    let mut curves = Vec::new();
    for dt in steps {
        let swings = swings(&flag(rows).swing(second_order(0.8)?, dt, many)?);
        for (n, swing) in [(2, swings.get(1)), (swings.len(), swings.last())] {
            let swing = swing.ok_or("the flag does not swing twice")?;
            for (k, (name, _)) in COMPARED.into_iter().enumerate() {
                record.show(format!("CSM3, {rows} rows, dt = {}, swing {n}: {name}", short(dt)), swing[k], None);
            }
        }
        let highest = swings.iter().enumerate().map(|(k, swing)| ((k + 1) as f64, 1e3 * (swing[0] + swing[1])));
        curves.push((format!("dt = {}", short(dt)), highest.collect()));
    }
    record.figure(format!("CSM3, {rows} rows: how far the tip comes back [mm]"), "swing", curves);
    Ok(())
}

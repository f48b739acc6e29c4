//! Films that are thinner than a few cells: spheres, cylinders and plates that approach each other.

use std::f64::consts::PI;
use std::sync::Arc;

use cutwater::algebra::NewtonSettings;
use cutwater::algebra::time::QuasiStatic;
use cutwater::body::PrescribedBody;
use cutwater::interface_dg::terms::PenaltyProfile;
use cutwater::mesh::generate::{Region, RegionShape, Size, refined_box, structured_box};
use cutwater::mesh::{Coordinates, Vector};
use cutwater::solid_rigid::RigidBody;
use cutwater::solver::{FilmSetup, FluidBoundary, Setup, Stabilisation};

use super::axisymmetric::{brenner, moving, slow, sphere};
use super::film_edges::{edges, first_force};
use super::flow::{self, boundary, fluid_mut, polygon};
use super::linear_flow::LinearFlow;
use super::lubrication::{approach, exact_force, graded};
use super::record::worse;
use super::{DirectRun, Failure, P, Record, V, short};

// Gaps relative to the size of a cell: those at which the film is at least two cells wide, and smaller ones with their
// largest relative errors.
const GAPS: [f64; 6] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.1];
const THIN: [(f64, f64); 2] = [(0.05, 0.15), (0.02, 0.3)];
/// Largest relative error of the force on spheres with smaller cells near the axis at the thin gaps.
const POLE: f64 = 0.05;
// Largest relative errors of the force on spheres, cylinders and plates.
const SPHERE: f64 = 0.06;
const CYLINDER: f64 = 0.05;
const PLATES: f64 = 0.02;
/// Largest relative error of the flux of a channel.
const CHANNEL: f64 = 0.01;
// Largest relative change of the force between neighbours in a sweep, and with parameters of the stabilisation.
const JUMP: f64 = 0.03;
const SPREAD: f64 = 0.02;
const SPREAD_OF_PENALTY: f64 = 0.05;
/// Least share of the displaced fluid that leaves past the end of a film.
const LEAVES: f64 = 0.99;
/// Largest relative error of the time in which a sphere falls, and of its gap.
const FALL: f64 = 0.03;

/// A mesh for films, and the settings of the solver.
#[derive(Clone, Copy)]
struct FilmCase {
    /// Cells per radius.
    cells: f64,
    stabilisation: Stabilisation,
    /// Whether the flux of the film is modelled.
    film: bool,
    /// Cells per radius near the axis, where the film is; `None` for `cells`.
    pole: Option<f64>,
    /// Height of a body that is the wall above a line of the mesh, relative to the size of a cell; `None` if the wall
    /// is the side of the mesh.
    wall: Option<f64>,
}

impl FilmCase {
    fn new(cells: f64) -> Self {
        Self { cells, stabilisation: Stabilisation::STANDARD, film: true, pole: None, wall: None }
    }

    fn set(&self, setup: &mut Setup<2>) -> Result<(), Failure> {
        let fluid = fluid_mut(setup)?;
        fluid.film = self.film.then_some(FilmSetup::default());
        fluid.stabilisation = self.stabilisation;
        Ok(())
    }
}

pub(super) fn measure(record: &mut Record) -> Result<(), Failure> {
    spheres(record)?;
    cylinders(record)?;
    plates(record)?;
    edges(record)?;
    if record.full {
        sweeps(record)?;
        parameters(record)?;
    }
    fall(record)?;
    record.note(
        "Stokes flow with the standard set; gaps in cells at the film. Sphere: Brenner 1961, doi:10.1016/0009-2509(61)80035-3, in a box of 40 radii. Cylinder: \
         4π/(α - tanh α). Plates: Reynolds' equation, μ L³ V/δ³, 3π μ R⁴ V/(2 δ³) and 0.4217 μ L⁴ V/δ³ for squares, with the pressure zero where they leave the mesh of 40 cells, 20 in space. A film \
         of four cells or more is left to the cells: two layers of cells carry three quarters of the flux of a parabola, four layers 15/16.",
    );
    Ok(())
}

/// Measures the force on a sphere that approaches a wall.
fn spheres(record: &mut Record) -> Result<(), Failure> {
    let meshes: &[f64] = if record.full { &[20.0, 40.0, 10.0] } else { &[20.0] };
    let mut curves = Vec::new();
    for &cells in meshes {
        let mut curve = Vec::new();
        for (gap, bound) in GAPS.map(|gap| (gap, SPHERE)).into_iter().chain(THIN) {
            let of_film = sphere_force(&FilmCase::new(cells), gap)?;
            let name = format!("sphere, {cells} cells per radius, gap of {gap} cells: force over the exact one");
            // The pressure of a film acts over a radius of √(2 R δ), which these meshes resolve to the same gaps as
            // that of 20 cells only.
            if (2.0 * cells * gap).sqrt() >= 1.99 || (bound > SPHERE && cells >= 20.0) {
                record.near_relative(name, of_film.ratio, 1.0, bound);
            } else {
                record.show(name, of_film.ratio, Some(1.0));
            }
            curve.push((gap, of_film.ratio));
            if cells == 20.0 && [1.0, 0.25].contains(&gap) {
                let name = format!(
                    "sphere, gap of {gap} cells: share of the displaced fluid that leaves past the end of the film"
                );
                record.at_least(name, of_film.leaves, LEAVES);
            }
        }
        curves.push((format!("{cells} cells per radius"), curve));
    }
    for (gap, _) in THIN {
        let ratio = sphere_force(&FilmCase { pole: Some(160.0), ..FilmCase::new(20.0) }, gap)?.ratio;
        let name = format!(
            "sphere, 20 cells per radius and 160 near the axis, gap of {gap} of the larger cells: force over the exact one"
        );
        record.near_relative(name, ratio, 1.0, POLE);
    }
    let mut without = Vec::new();
    for gap in GAPS.into_iter().chain(THIN.map(|(gap, _)| gap)) {
        without.push((gap, sphere_force(&FilmCase { film: false, ..FilmCase::new(20.0) }, gap)?.ratio));
    }
    let largest = without.iter().map(|(_, ratio)| ratio.max(1.0 / ratio)).fold(1.0, worse);
    record.show("sphere, 20 cells per radius, flux of the film not modelled: largest factor between the force and the exact one", largest, None);
    curves.push(("20 cells per radius, flux of the film not modelled".to_owned(), without));
    record.log_figure("Force on a sphere over the exact one", "gap over h", curves);
    Ok(())
}

/// Measures the force on a cylinder that approaches a wall.
fn cylinders(record: &mut Record) -> Result<(), Failure> {
    for gap in GAPS {
        let h = 0.05;
        let n = 4 * (2.0 * PI / h).ceil() as usize;
        let mut setup = approach(graded(0.4, h)?, gap * h, n)?;
        FilmCase::new(1.0 / h).set(&mut setup)?;
        let ratio = 2.0 * first_force(&setup)?[1] / exact_force(gap * h);
        record.near_relative(format!("cylinder, gap of {gap} cells: force over the exact one"), ratio, 1.0, CYLINDER);
    }
    Ok(())
}

/// Measures the forces on plates that approach each other, and the pressure along a channel.
fn plates(record: &mut Record) -> Result<(), Failure> {
    // Both directions: the diagonals of the squares have one.
    let tilts: &[f64] = if record.full { &[0.0, 10.0, 20.0, 30.0, -10.0, -20.0, -30.0] } else { &[0.0, 20.0, -20.0] };
    for &degrees in tilts {
        for gap in [4.0, 2.0, 1.0, 0.5, 0.25, 0.1, 0.02] {
            let ratio = squeeze(gap, degrees)?;
            let name = format!("plates tilted by {degrees}°, gap of {gap} cells: force over the exact one");
            record.near_relative(name, ratio, 1.0, PLATES);
        }
    }
    for gap in [0.25, 0.1, 0.02] {
        let name = format!("plates of 10 cells, a gap of {gap} cells in two layers: force over the exact one");
        record.near_relative(name, in_two_layers(gap)?, 1.0, PLATES);
    }
    for gap in [1.0, 0.25, 0.02] {
        let name = format!("disks, gap of {gap} cells: force over the exact one");
        record.near_relative(name, disks(gap)?, 1.0, PLATES);
        let name =
            format!("plates that part, gap of {gap} cells, with a floor of the pressure: force over the exact one");
        record.near_relative(name, cavity(gap)?, 1.0, PLATES);
        let name = format!("square plates in space, gap of {gap} cells: force over the exact one");
        record.near_relative(name, square_plates(gap)?, 1.0, PLATES);
        let name = format!("channel of {gap} cells with a given flux: gradient of the pressure over the exact one");
        record.near_relative(name, channel(gap)?, 1.0, CHANNEL);
    }
    Ok(())
}

/// Sweeps the gap, and the position of the mesh relative to the wall.
fn sweeps(record: &mut Record) -> Result<(), Failure> {
    const STEPS: usize = 100;
    const SHIFTS: usize = 20;
    let jump = |ratios: &[f64]| ratios.windows(2).map(|pair| (pair[1] / pair[0] - 1.0).abs()).fold(0.0, worse);
    let gaps = || (0..STEPS).map(|k| 4.0 * (0.1_f64 / 4.0).powf(k as f64 / (STEPS - 1) as f64));
    let ratios =
        gaps().map(|gap| Ok(sphere_force(&FilmCase::new(20.0), gap)?.ratio)).collect::<Result<Vec<_>, Failure>>()?;
    let swept = gaps().zip(ratios.iter().copied()).collect();
    record.log_figure(
        "Force on a sphere over the exact one, 100 gaps",
        "gap over h",
        vec![("20 cells per radius".to_owned(), swept)],
    );
    record.at_most(
        "sphere, 100 gaps from 4 to 0.1 cells: largest change of the ratio between neighbours",
        jump(&ratios),
        JUMP,
    );
    let off = |ratios: &[f64]| ratios.iter().map(|ratio| (ratio - 1.0).abs()).fold(0.0, worse);
    record.at_most("sphere, 100 gaps from 4 to 0.1 cells: largest relative error of the force", off(&ratios), SPHERE);
    for gap in [1.0, 0.25] {
        let case = |k: usize| FilmCase { wall: Some(k as f64 / SHIFTS as f64), ..FilmCase::new(20.0) };
        let ratios =
            (0..SHIFTS).map(|k| Ok(sphere_force(&case(k), gap)?.ratio)).collect::<Result<Vec<_>, Failure>>()?;
        let name = format!("sphere and a body as wall, gap of {gap} cells, 20 positions in a cell");
        record.at_most(format!("{name}: largest change of the ratio between neighbours"), jump(&ratios), JUMP);
        record.at_most(format!("{name}: largest relative error of the force"), off(&ratios), SPHERE);
    }
    Ok(())
}

/// Varies the parameters of the stabilisation.
fn parameters(record: &mut Record) -> Result<(), Failure> {
    let set = Stabilisation::STANDARD;
    let penalty = |gamma: f64| Stabilisation {
        penalty: PenaltyProfile::Split { gamma_normal: gamma, gamma_tangential: gamma },
        ..set
    };
    for gap in [1.0, 0.25] {
        let ratio = |stabilisation| {
            Ok::<_, Failure>(sphere_force(&FilmCase { stabilisation, ..FilmCase::new(20.0) }, gap)?.ratio)
        };
        let standard = ratio(set)?;
        for factor in [10.0, 0.1] {
            let of_pressure = ratio(Stabilisation { gamma_pressure: factor * set.gamma_pressure, ..set })?;
            let of_ghost = ratio(Stabilisation { gamma_ghost: factor * set.gamma_ghost, ..set })?;
            for (name, with) in [("γ_p", of_pressure), ("γ_g", of_ghost)] {
                let name =
                    format!("sphere, gap of {gap} cells, {name} times {}: relative change of the force", short(factor));
                record.at_most(name, (with / standard - 1.0).abs(), SPREAD);
            }
        }
        let [low, high] = [ratio(penalty(100.0))?, ratio(penalty(1000.0))?];
        let name = format!("sphere, gap of {gap} cells, γ_n = γ_t from 100 to 1000: relative change of the force");
        record.at_most(name, (high / low - 1.0).abs(), SPREAD_OF_PENALTY);
        record.show(
            format!("sphere, gap of {gap} cells, γ_n = γ_t from 35 to 100: relative change of the force"),
            (low / standard - 1.0).abs(),
            None,
        );
    }
    Ok(())
}

/// Computes the fall of a sphere onto a wall under a constant weight, without inertia.
fn fall(record: &mut Record) -> Result<(), Failure> {
    const CELLS: f64 = 20.0;
    /// Change of the gap in a step, relative to the gap.
    const STEP: f64 = 0.06;
    let h = 1.0 / CELLS;
    let [begin, end] = [2.0 * h, 0.1 * h];
    let mut setup = over_wall(&FilmCase::new(CELLS))?;
    // The weight is that of unit force over 6 π μ R.
    let corners = sphere(1.0 + begin, 1.0, h);
    let surface = boundary(std::slice::from_ref(&corners)).with_coordinates(Coordinates::Axisymmetric);
    let ball = RigidBody::new("sphere", surface.clone(), corners.clone(), 1.0, V::zeros())?;
    let gravity = V::new(0.0, -6.0 * PI / ball.mass.mass);
    setup.bodies.push(Arc::new(RigidBody::new("sphere", surface, corners, 1.0, gravity)?));
    let mut run = DirectRun::new(setup)?;
    let (mut gap, mut time, mut exact, mut off) = (begin, 0.0, begin, 0.0_f64);
    while gap > end {
        let dt = STEP * gap * brenner(gap);
        run.setup.dt = dt;
        let report = run.advance()?;
        gap = report.bodies[0].lowest.1[1];
        time += dt;
        // d gap/dt = -1/brenner(gap), by the explicit midpoint rule.
        const PARTS: usize = 20;
        for _ in 0..PARTS {
            let dt = dt / PARTS as f64;
            let middle = exact - 0.5 * dt / brenner(exact);
            exact -= dt / brenner(middle);
        }
        off = worse(off, (gap / exact - 1.0).abs());
    }
    let n = 10_000;
    let needed: f64 = (0..n)
        .map(|k| {
            let [from, to] = [k, k + 1].map(|k| begin * (gap / begin).powf(f64::from(k) / f64::from(n)));
            (from - to) * brenner(0.5 * (from + to))
        })
        .sum();
    record.near_relative("falling sphere, gap from 2 to 0.1 cells: time over the exact one", time / needed, 1.0, FALL);
    record.at_most("falling sphere, gap from 2 to 0.1 cells: largest relative error of the gap", off, FALL);
    Ok(())
}

/// The force of a film.
struct Force {
    /// Force, divided by the exact force.
    ratio: f64,
    /// Share of the displaced fluid that does not leak through the surface over the film.
    leaves: f64,
}

/// Returns a fluid over a wall, with a mesh for spheres of radius one near it.
fn over_wall(case: &FilmCase) -> Result<Setup<2>, Failure> {
    /// Extent of the fluid in radii. Without an outer boundary forces are lower by less than 1 %.
    const FAR: f64 = 40.0;
    let h = 1.0 / case.cells;
    // A body as wall has four lines of the mesh below its surface.
    let bottom = case.wall.map_or(0.0, |height| -(4.0 + height) * h);
    let near = RegionShape::Segment { ends: [P::new(0.0, bottom), P::new(0.0, 2.2)], within: 1.2 };
    let mut regions = vec![Region { shape: near, size: h, growth: 0.25 }];
    if let Some(pole) = case.pole {
        let near = RegionShape::Segment { ends: [P::new(0.0, bottom), P::new(0.2, bottom)], within: 0.02 };
        regions.push(Region { shape: near, size: 1.0 / pole, growth: 0.25 });
    }
    let background = refined_box([0.0, bottom], [FAR, FAR + bottom], &Size::uniform(4.0), &regions)?;
    let mut setup = slow(background, 1e-9, flow::wall_below)?;
    case.set(&mut setup)?;
    if case.wall.is_some() {
        // The body ends outside of the mesh. Facets on the axis have measure zero.
        let corners =
            [(0.0, 2.0 * bottom), (2.0 * FAR, 2.0 * bottom), (2.0 * FAR, 0.0), (0.0, 0.0)].map(|(r, z)| P::new(r, z));
        setup.bodies.push(moving(corners.to_vec(), |x, _| *x, Arc::new(|_, _| V::zeros())));
    }
    Ok(setup)
}

/// Returns the force on a sphere of radius one that approaches a wall; the gap is given over the size of a cell.
fn sphere_force(case: &FilmCase, gap: f64) -> Result<Force, Failure> {
    let h = 1.0 / case.cells;
    let gap = gap * h;
    let mut setup = over_wall(case)?;
    let velocity = Arc::new(|_: &P, _| V::new(0.0, -1.0));
    let facet = case.pole.map_or(h, |pole| 1.0 / pole);
    setup.bodies.push(moving(sphere(1.0 + gap, 1.0, facet), |x, t| x - V::new(0.0, t), velocity));
    let body = setup.bodies.len() - 1;
    let (state, report) = flow::run(&setup, 1)?;
    let end = (2.0 * gap).sqrt();
    let (mut swept, mut leaks) = (0.0, 0.0);
    for (piece, on_piece) in flow::interface(&state, &report)? {
        if piece.body.index() == body && on_piece.middle[0] < end && piece.normal[1] < 0.0 {
            // The measure of a piece is that of the circle.
            swept -= piece.normal[1] * on_piece.measure;
            leaks += on_piece.jump.dot(&piece.normal) * on_piece.measure;
        }
    }
    let force = flow::force(&state, &report, body, &P::zeros())?.0[1];
    Ok(Force { ratio: force / (6.0 * PI * brenner(gap)), leaves: 1.0 - (leaks / swept).abs() })
}

/// Number of cells along the plates.
const CELLS: usize = 40;
/// Height of the middle of films over a line of the mesh, over the size of a cell.
const OFF_LINE: f64 = 0.124;

/// Returns two plates at a gap, tilted relative to the mesh, which end outside of it; with the directions along and
/// across them.
fn between_plates(gap: f64, degrees: f64, speed: f64) -> Result<(Setup<2>, [V; 2]), Failure> {
    plates_along(CELLS, OFF_LINE, gap, degrees, speed)
}

/// Returns the result of [`between_plates`] for a number of cells along the plates and a height of the middle of the
/// film.
fn plates_along(
    cells: usize,
    off_line: f64,
    gap: f64,
    degrees: f64,
    speed: f64,
) -> Result<(Setup<2>, [V; 2]), Failure> {
    let h = 1.0 / cells as f64;
    let background = structured_box::<2>([0.0, -0.8], [1.0, 0.8], [cells, cells * 8 / 5])?;
    let angle = f64::to_radians(degrees);
    let (along, across) = (V::new(angle.cos(), angle.sin()), V::new(-angle.sin(), angle.cos()));
    let middle = P::new(0.5, off_line * h);
    let plate = |side: f64| {
        let at = |x: f64, y: f64| middle + along * x + across * side * (0.5 * gap * h + y);
        let corners = [at(-2.0, 0.0), at(2.0, 0.0), at(2.0, 0.2), at(-2.0, 0.2)];
        if side > 0.0 { corners.to_vec() } else { corners.into_iter().rev().collect() }
    };
    let mut setup = LinearFlow::at_rest(V::zeros()).known(1.0, &[]).setup(background, 1e9);
    flow::set_sides(&mut setup, flow::open)?;
    FilmCase::new(cells as f64).set(&mut setup)?;
    for side in [1.0, -1.0] {
        let velocity = across * (-0.5 * side * speed);
        setup.bodies.push(polygon(&[plate(side)], |x, _| *x, Arc::new(move |_, _| velocity)));
    }
    Ok((setup, [along, across]))
}

/// Returns the force on one of two plates of ten cells that approach each other over the exact one, with a line of the
/// mesh in the middle of the film.
fn in_two_layers(gap: f64) -> Result<f64, Failure> {
    let (setup, _) = plates_along(10, 0.0, gap, 0.0, 1.0)?;
    Ok(first_force(&setup)?[1] * (gap / 10.0).powi(3))
}

/// Returns the force on one of two parallel plates that approach each other over the exact one.
fn squeeze(gap: f64, degrees: f64) -> Result<f64, Failure> {
    let (setup, [along, across]) = between_plates(gap, degrees, 1.0)?;
    let force = first_force(&setup)?.dot(&across);
    let length_over_gap = CELLS as f64 / (along[0] * gap);
    Ok(force / length_over_gap.powi(3))
}

/// Returns the force on one of two parallel plates that part, with vapour in the middle of the film, over the exact
/// one.
fn cavity(gap: f64) -> Result<f64, Failure> {
    let (mut setup, [_, across]) = between_plates(gap, 0.0, -1.0)?;
    let delta = gap / CELLS as f64;
    // Vapour in the middle half: the pressure falls by 6 μ V/δ³ times the square of the distance from its edge.
    let width = 0.25;
    let floor = -6.0 * width * width / delta.powi(3);
    // Vapour is a penalty, with round-off above the tolerance of the linear problems.
    setup.newton = NewtonSettings::new(1e-8);
    fluid_mut(&mut setup)?.film = Some(FilmSetup { floor: Some(floor), ..FilmSetup::default() });
    let force = first_force(&setup)?.dot(&across);
    Ok(force / (floor * (1.0 - 2.0 * width + 2.0 * width * 2.0 / 3.0)))
}

/// Returns the gradient of the pressure along a channel with a given flux over the exact one.
fn channel(gap: f64) -> Result<f64, Failure> {
    let (mut setup, _) = between_plates(gap, 0.0, 0.0)?;
    flow::set_side(&mut setup, "left", FluidBoundary::Velocity(Arc::new(|_, _| V::new(1.0, 0.0))))?;
    let (state, report) = flow::run(&setup, 1)?;
    // Pressures on the upper plate, away from the ends.
    let mut sums = [(0.0, 0.0, 0.0); 2];
    for (piece, on_piece) in flow::interface(&state, &report)? {
        let x = on_piece.middle[0];
        let section = [0.2..0.4, 0.6..0.8].iter().position(|section| section.contains(&x));
        if let (0, Some(section)) = (piece.body.index(), section)
            && piece.normal[1] < 0.0
        {
            let sum = &mut sums[section];
            // The traction on the plate is the pressure times its normal into the plate.
            sum.0 += on_piece.measure;
            sum.1 += x * on_piece.measure;
            sum.2 += on_piece.pressure[1] * on_piece.measure;
        }
    }
    let [(x0, p0), (x1, p1)] = sums.map(|(measure, x, p)| (x / measure, p / measure));
    let gap = gap / CELLS as f64;
    Ok((p0 - p1) / (x1 - x0) * gap * gap / 12.0)
}

/// Returns the force on one of two disks that approach each other over the exact one.
fn disks(gap: f64) -> Result<f64, Failure> {
    let h = 1.0 / CELLS as f64;
    let background = structured_box::<2>([0.0, 0.0], [1.0, 0.5], [CELLS, CELLS / 2])?;
    let mut setup = slow(background, 1e-9, flow::wall_below)?;
    FilmCase::new(CELLS as f64).set(&mut setup)?;
    let low = gap * h;
    let corners = [(0.0, low), (2.0, low), (2.0, low + 0.2), (0.0, low + 0.2)].map(|(r, z)| P::new(r, z));
    setup.bodies.push(moving(corners.to_vec(), |x, _| *x, Arc::new(|_, _| V::new(0.0, -1.0))));
    Ok(first_force(&setup)?[1] * low.powi(3) / (1.5 * PI))
}

/// Returns the force on one of two square plates in space that approach each other over the exact one.
fn square_plates(gap: f64) -> Result<f64, Failure> {
    /// Cells along the plates.
    const ALONG: usize = 20;
    let length = ALONG as f64;
    let background = structured_box::<3>([0.0, 0.0, -1.0], [length, length, 3.0], [ALONG, ALONG, 4])?;
    let mut setup = flow::problem(flow::fluid(background, 1e-9, 1.0), 1e9);
    for side in ["left", "right", "front", "back", "bottom", "top"] {
        flow::set_side(&mut setup, side, flow::open())?;
    }
    setup.scheme = Arc::new(QuasiStatic);
    fluid_mut(&mut setup)?.film = Some(FilmSetup::default());
    let middle = 0.5 + OFF_LINE;
    for (side, speed) in [(-1.0, 0.0), (1.0, -1.0)] {
        let ends = [middle + side * 0.5 * gap, middle + side * (0.5 * gap + 1.0)];
        let [low, high] = [f64::min, f64::max].map(|end| end(ends[0], ends[1]));
        let plate = structured_box::<3>([-1.0, -1.0, low], [length + 1.0, length + 1.0, high], [1; 3])?;
        setup.bodies.push(Arc::new(PrescribedBody {
            name: "plate".to_owned(),
            boundary: plate.boundary(),
            reference: plate.vertices().to_vec(),
            position: Arc::new(|x, _| *x),
            velocity: Arc::new(move |_, _| Vector::z() * speed),
        }));
    }
    let (state, report) = flow::run(&setup, 1)?;
    let force: f64 = flow::interface(&state, &report)?
        .filter(|(piece, _)| piece.body.index() == 1)
        .map(|(_, on_piece)| on_piece.total()[2] * on_piece.measure)
        .sum();
    let odd = (0..20).map(|k| f64::from(2 * k + 1));
    let series: f64 = odd.map(|n| (n * PI / 2.0).tanh() / n.powi(5)).sum();
    Ok(force * gap.powi(3) / length.powi(4) / (1.0 - 192.0 / PI.powi(5) * series))
}

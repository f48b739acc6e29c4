//! Films thinner than cells: exact flows between plates, vapour, asperities, and the energy of a falling ball.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::fixture::*;
use solver::mesh::generate::structured_box;
use solver::mesh::{Coordinates, Point, SimplexMesh, Vector};
use solver::{FilmSetup, FluidBoundary, Setup, State};

/// Cells along the plates, each of size one.
const CELLS: usize = 40;
/// In space, along each axis.
const CELLS_IN_SPACE: usize = 8;
/// Height of the middle of films above a line of the mesh.
const MIDDLE: f64 = 0.9;

/// Returns the length of the plates.
const fn length<const D: usize>() -> f64 {
    (if D == 2 { CELLS } else { CELLS_IN_SPACE }) as f64
}

/// Returns plates at a gap around the middle of a row of cells. The upper one has a velocity; both end outside of the
/// mesh.
fn plates<const D: usize>(gap: f64, velocity: Vector<D>, film: FilmSetup) -> Setup<D> {
    plates_with_ends(gap, MIDDLE, velocity, film, [-1.0, length::<D>() + 1.0])
}

/// Returns plates as [`plates`] does, with the height of the middle of the film and the ends of the upper one along all
/// other axes.
fn plates_with_ends<const D: usize>(
    gap: f64,
    middle: f64,
    velocity: Vector<D>,
    film: FilmSetup,
    ends: [f64; 2],
) -> Setup<D> {
    let length = length::<D>();
    let of = |along: f64, across: f64| std::array::from_fn(|k| if k + 1 < D { along } else { across });
    let background = structured_box::<D>(of(0.0, -2.0), of(length, 3.0), of(length, 5.0).map(|n| n as usize));
    let mut setup = with_films(background.expect("a box"));
    fluid_of(&mut setup).film = Some(film);
    let plate =
        |ends: [f64; 2], from, to| structured_box::<D>(of(ends[0], from), of(ends[1], to), [1; D]).expect("a plate");
    let (below, above) = (middle - 0.5 * gap, middle + 0.5 * gap);
    let outside = [-1.0, length + 1.0];
    setup.bodies.push(prescribed(&plate(outside, below - 1.0, below), |x, _| *x, |_, _| Vector::zeros()));
    setup.bodies.push(prescribed(&plate(ends, above, above + 1.0), |x, _| *x, move |_, _| velocity));
    setup
}

/// Sets a condition on all sides.
fn on_all_sides<const D: usize>(setup: &mut Setup<D>, condition: impl Fn() -> FluidBoundary<D>) {
    on_sides(setup, &["left", "right", "bottom", "top", "front", "back"][..2 * D], condition);
}

/// Squeezes out a film. Returns the force over `μ L³ V/δ³` and the width in space.
fn squeeze<const D: usize>(gap: f64) -> f64 {
    let ends = [-1.0, length::<D>() + 1.0];
    squeeze_between_edges::<D>(gap, MIDDLE, 0.0, ends) * ((ends[1] - ends[0]) / length::<D>()).powi(D as i32 + 1)
}

#[test]
fn the_force_of_a_film_that_is_squeezed_out_is_that_of_reynolds() {
    // The wider films have two layers of cells.
    for gap in [0.15, 0.4, 1.0] {
        assert!((squeeze::<2>(gap) - 1.0).abs() < 0.01, "gap {gap}: {}", squeeze::<2>(gap));
    }
    // A square: 12 times the mean of u with -Δu = 1 on the unit square, which linear functions on 8 × 8 squares, equal
    // to the five-point formula, have as 0.951 of 1 - 192/π⁵ Σ tanh((2k + 1) π/2)/(2k + 1)⁵ = 0.4217.
    let in_space = squeeze::<3>(0.15) / (0.951 * 0.4217);
    assert!((in_space - 1.0).abs() < 0.02, "{in_space}");
}

#[test]
fn films_of_two_layers_do_not_resist_more() {
    // The slip of a linear velocity varies along the surfaces of two layers. If the penalty acted on all of it, the
    // force would be 1.10.
    for facets in [1, 12, 22] {
        let (cells, gap) = (10, 0.1);
        let length = cells as f64;
        let background = structured_box::<2>([0.0, -1.0], [length, 3.0], [cells, 4]).expect("a box");
        let mut setup = with_films(background);
        let (from, to) = (1.0 - 0.5 * gap, 1.0 + 0.5 * gap);
        for (heights, velocity) in [([-0.5, from], 0.0), ([to, 2.5], -1.0)] {
            let plate = structured_box::<2>([-1.0, heights[0]], [length + 1.0, heights[1]], [facets, 1]);
            let velocity = V::new(0.0, velocity);
            setup.bodies.push(prescribed(&plate.expect("a plate"), |x, _| *x, move |_, _| velocity));
        }
        on_all_sides(&mut setup, open);
        let found = force(&setup)[1] * (gap / length).powi(3);
        assert!((found - 1.0).abs() < 0.01, "{facets} facets: {found}");
    }
}

/// Squeezes out a film between a wide plate and one with the given ends, behind which the fluid is open. Returns the
/// force over `μ L³ V/δ³` and the width in space.
fn squeeze_between_edges<const D: usize>(gap: f64, middle: f64, roughness: f64, ends: [f64; 2]) -> f64 {
    let mut down = Vector::zeros();
    down[D - 1] = -1.0;
    let mut setup = plates_with_ends::<D>(gap, middle, down, FilmSetup { roughness, floor: None }, ends);
    on_all_sides(&mut setup, open);
    force(&setup)[D - 1] * gap.powi(3) / (ends[1] - ends[0]).powi(D as i32 + 1)
}

/// Returns the force of a film of ten cells with open fluid behind its edges over that of Reynolds' equation. The
/// resistance of the open fluid was computed on fine cells (`cargo xtask verify films`).
fn with_open_fluid(gap: f64) -> f64 {
    1.0 + 3.8 * (gap / 10.0) + 10.0 * (gap / 10.0).powi(2)
}

#[test]
fn films_reach_edges_inside_of_cells() {
    for begins in [0.05, 0.25, 0.5, 0.75] {
        for gap in [0.02, 0.1, 0.3] {
            // With the film up to the last cell before an edge the force on the thin film is 0.60; 0.84 to 0.91 without
            // the pressure on the last piece of the plate.
            let (found, exact) =
                (squeeze_between_edges::<2>(gap, MIDDLE, 0.0, [10.0 + begins, 20.0 + begins]), with_open_fluid(gap));
            assert!((found / exact - 1.0).abs() < 0.1, "gap {gap}, {begins}: {} for {exact}", found);
            // In two layers of cells, on both sides of a line of the mesh, the velocity between the layers falls to
            // that of the open fluid before the edge: 1.3 to 1.6 if the film conducts only what layers lack there.
            let found = squeeze_between_edges::<2>(gap, 1.0, 0.0, [10.0 + begins, 20.0 + begins]);
            assert!((found / exact - 1.0).abs() < 0.15, "two layers, gap {gap}, {begins}: {} for {exact}", found);
        }
        // Of a plate of five cells in space, of which at most three would be a film: 0.36. The open fluid adds to it.
        let found = squeeze_between_edges::<3>(0.1, MIDDLE, 0.0, [1.0 + begins, 6.0 + begins]) / 0.4217;
        assert!((0.9..1.15).contains(&found), "{begins}: {found}");
    }
}

#[test]
fn fluid_in_a_corner_between_two_films_is_not_open() {
    // Half of a piston over the floor of a channel, with a clearance as wide as the film, through which the fluid
    // leaves upwards. The pressure at the corner is that of the flux along the clearance.
    for (gap, clearance) in [(0.1_f64, 0.1_f64), (0.1, 0.2), (0.2, 0.2)] {
        let background = structured_box::<2>([0.0; 2], [12.0; 2], [12, 12]).expect("a box");
        let mut setup = with_films(background);
        on_sides(&mut setup, &["left"], || FluidBoundary::symmetry(0));
        on_sides(&mut setup, &["right", "bottom"], || FluidBoundary::NoSlip);
        on_sides(&mut setup, &["top"], open);
        let (radius, length) = (12.0 - clearance, 8.0 - gap);
        let piston = structured_box::<2>([-1.0, gap], [radius, 8.0], [1, 1]).expect("a piston");
        setup.bodies.push(prescribed(&piston, |x, _| *x, |_, _| V::new(0.0, -1.0)));
        let below = 4.0 * (radius / gap).powi(3);
        let beside = 12.0 * length * radius.powi(2) / clearance.powi(3);
        let found = force(&setup)[1] / (below + beside);
        assert!((found - 1.0).abs() < 0.15, "gap {gap}, clearance {clearance}: {found}");
    }
}

#[test]
fn a_part_past_the_edge_is_no_film() {
    // A triangle in front of the left edge: the direction from the edge to its middle and the normal of the plate
    // enclose less than 60 degrees.
    let background = structured_box::<2>([0.0; 2], [18.0, 8.0], [18, 8]).expect("a box");
    let mut setup = with_films(background);
    on_sides(&mut setup, &["left", "right", "top"], open);
    on_sides(&mut setup, &["bottom"], || FluidBoundary::NoSlip);
    let gap = 0.5;
    let plate = structured_box::<2>([3.95, gap], [13.95, gap + 2.0], [1, 1]).expect("a plate");
    setup.bodies.push(prescribed(&plate, |x, _| *x, |_, _| V::new(0.0, -1.0)));
    let ratio = force(&setup)[1] * (gap / 10.0_f64).powi(3) / with_open_fluid(gap);
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
}

/// Returns the leak below a gate over a wall, over `δ³ p/(12 μ (L + 1.27 δ))`.
fn leak(length: f64, gap: f64, begins: f64) -> f64 {
    const PRESSURE: f64 = 3.0;
    let background = structured_box::<2>([0.0; 2], [20.0, 8.0], [20, 8]).expect("a box");
    let mut setup = with_films(background);
    on_sides(&mut setup, &["bottom", "top"], || FluidBoundary::NoSlip);
    on_sides(&mut setup, &["right"], open);
    on_sides(&mut setup, &["left"], || FluidBoundary::Open {
        traction: Some(Arc::new(|_: &Point<2>, n: &Vector<2>, _: f64| *n * -PRESSURE)),
        backflow: false,
    });
    let from = 8.0 + begins;
    let gate = structured_box::<2>([from, gap], [from + length, 10.0], [1, 1]).expect("a gate");
    setup.bodies.push(prescribed(&gate, |x, _| *x, |_, _| Vector::zeros()));
    let (state, _) = run(&setup, 1);
    let fluid = wet(&state);
    let on_right = (0..fluid.space.len()).filter_map(|dof| {
        let x = fluid_of(&mut setup).background.vertex(fluid.space.vertex(dof as u32));
        (x[0] == 20.0).then_some(fluid.velocity[dof][0] * if x[1] == 8.0 || x[1] == 0.0 { 0.5 } else { 1.0 })
    });
    on_right.sum::<f64>() / (gap.powi(3) * PRESSURE / (12.0 * (length + 1.27 * gap)))
}

#[test]
fn a_gate_leaks_as_the_film_below_it_conducts() {
    for (length, bound) in [(2.0, 0.2), (3.0, 0.15), (5.0, 0.1)] {
        for gap in [0.02, 0.1, 0.3] {
            for begins in [0.1, 0.3, 0.5, 0.7, 0.9] {
                let found = leak(length, gap, begins);
                assert!((found - 1.0).abs() < bound, "length {length}, gap {gap}, {begins}: {found}");
            }
        }
    }
}

#[test]
fn the_force_on_disks_is_that_of_reynolds() {
    // A film of one cell between a disk and a wall on lines of the mesh.
    const RADIUS: usize = 20;
    let background = structured_box::<2>([0.0, 0.0], [RADIUS as f64, 4.0], [RADIUS, 4]).expect("a box");
    let around_axis = |mesh: SimplexMesh<2>| mesh.with_coordinates(Coordinates::Axisymmetric).expect("radii");
    let mut setup = with_films(around_axis(background));
    on_sides(&mut setup, &["left"], || FluidBoundary::symmetry(0));
    on_sides(&mut setup, &["bottom"], || FluidBoundary::NoSlip);
    on_sides(&mut setup, &["right", "top"], open);
    let plate = structured_box::<2>([0.0, 1.0], [RADIUS as f64 + 1.0, 2.0], [1, 1]).expect("a plate");
    setup.bodies.push(prescribed(&around_axis(plate), |x, _| *x, |_, _| V::new(0.0, -1.0)));
    let ratio = force(&setup)[1] / (1.5 * PI * (RADIUS as f64).powi(4));
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

#[test]
fn tangents_of_flux_and_vapour_are_exact() {
    let mut setup = plates::<2>(0.4, V::new(0.0, 1.0), FilmSetup { roughness: 0.0, floor: Some(-0.3) });
    on_all_sides(&mut setup, open);
    let names = check_tangents(&setup, 1.0);
    assert!(names.contains(&"fluid cells") && names.contains(&"cavitation"), "{names:?}");
}

/// Shears a film of half a cell: the tractions are constant.
fn shear<const D: usize>() {
    let (gap, speed, across) = (0.5, 2.0, D - 1);
    let mut velocity = Vector::zeros();
    velocity[0] = speed;
    let mut setup = plates::<D>(gap, velocity, FilmSetup::default());
    on_all_sides(&mut setup, open);
    let on_ends = move |x: &Point<D>, n: &Vector<D>, _: f64| {
        let mut traction = Vector::zeros();
        if (x[across] - MIDDLE).abs() < 0.5 * gap {
            (traction[0], traction[across]) = (n[across] * speed / gap, n[0] * speed / gap);
        }
        traction
    };
    fluid_of(&mut setup).boundary.drain(..2);
    on_sides(&mut setup, &["left", "right"], || FluidBoundary::Open {
        traction: Some(Arc::new(on_ends)),
        backflow: false,
    });
    let (state, reports) = run(&setup, 1);
    let mut shear = 0.0;
    for (piece, on) in wet(&state).cut.interface().iter().zip(&wet_report(&reports[0]).tractions) {
        // Only the sides of the plates towards each other.
        if piece.body.index() == 1 && piece.normal[across] < 0.0 {
            let mut off = on.total();
            off[0] += speed / gap;
            assert!(off.norm() < 1e-10, "{:?}", on.total());
            shear += on.total()[0] * on.measure;
        }
    }
    assert!((shear + speed / gap * length::<D>().powi(D as i32 - 1)).abs() < 1e-9, "{shear}");
}

#[test]
fn a_film_of_half_a_cell_shears_as_couette_flow_does() {
    shear::<2>();
    shear::<3>();
}

/// Checks fluid at rest under a force per volume: the gradient of the pressure is that force.
fn rest<const D: usize>(force: Vector<D>, gaps: &[f64]) {
    for &gap in gaps {
        let mut setup = plates(gap, Vector::zeros(), FilmSetup::default());
        fluid_of(&mut setup).body_force = Some(Arc::new(move |_, _| force));
        on_all_sides(&mut setup, || FluidBoundary::NoSlip);
        let (state, _) = run(&setup, 1);
        let wet = wet(&state);
        let speed = wet.velocity.iter().map(Vector::norm).fold(0.0, f64::max);
        assert!(speed < 1e-10, "gap {gap}: {speed:e}");
        // Pressures are known up to a constant in each of the three closed domains; their gradients are not.
        let background = &setup.fluid.as_ref().expect("a fluid").background;
        for part in wet.cut.all_parts() {
            let dofs = wet.space.dofs(part);
            let at = |k: usize| (background.vertex(wet.space.vertex(dofs[k])), wet.pressure[dofs[k] as usize]);
            for k in 1..=D {
                let ((x, p), (x0, p0)) = (at(k), at(0));
                assert!((p - p0 - force.dot(&(x - x0))).abs() < 1e-9, "gap {gap}: {}", p - p0);
            }
        }
    }
}

#[test]
fn fluid_at_rest_in_a_film_has_the_pressure_of_its_weight() {
    rest(V::new(0.7, -3.0), &[0.05, 0.5, 1.7]);
    rest(Vector::<3>::new(0.7, 0.4, -3.0), &[0.5]);
}

#[test]
fn fluid_at_rest_has_no_force_across_a_film_that_ends_at_edges() {
    // A brick whose side is half a cell from a wall, with the weight of the fluid along the film.
    let background = structured_box::<2>([0.0, 0.0], [8.0, 20.0], [8, 20]).expect("a box");
    let mut setup = setup(fluid(background, 1e-9, 1.0), 1e3);
    setup.scheme = Arc::new(solver::algebra::time::QuasiStatic);
    fluid_of(&mut setup).film = Some(FilmSetup::default());
    fluid_of(&mut setup).body_force = Some(Arc::new(|_, _| V::new(0.0, -3.0)));
    on_all_sides(&mut setup, || FluidBoundary::NoSlip);
    let brick = structured_box::<2>([0.5, 5.3], [3.2, 14.6], [1, 1]).expect("a brick");
    setup.bodies.push(prescribed(&brick, |x, _| *x, |_, _| V::zeros()));
    let found = force(&setup);
    assert!((found - V::new(0.0, 3.0 * 2.7 * 9.3)).norm() < 1e-8, "{found}");
}

#[test]
fn films_of_more_than_four_cells_are_left_to_the_cells() {
    let body = || structured_box::<2>([5.0, 1.2], [7.0, 2.2], [2, 1]).expect("a body");
    let of = |film: Option<FilmSetup>| {
        let background = structured_box::<2>([0.0, -8.0], [CELLS as f64, 8.0], [CELLS, 16]).expect("a box");
        let mut setup = setup(fluid(background, 1.0, 0.1), 0.1);
        fluid_of(&mut setup).film = film;
        setup.bodies.push(prescribed(&body(), |x, t| x - V::new(0.0, t), |_, _| V::new(0.0, -1.0)));
        on_sides(&mut setup, &["left", "right", "bottom"], || FluidBoundary::NoSlip);
        on_sides(&mut setup, &["top"], open);
        run(&setup, 3).0
    };
    let (without, with) = (of(None), of(Some(FilmSetup::default())));
    assert!(wet(&without).velocity == wet(&with).velocity && wet(&without).pressure == wet(&with).pressure);
}

#[test]
fn asperities_keep_thin_films_open() {
    // The gap has its volume, and conducts as a film of the thickness of the asperities.
    let (gap, roughness) = (0.02, 0.1);
    let mut setup = plates(gap, V::new(0.0, -1.0), FilmSetup { roughness, floor: None });
    on_sides(&mut setup, &SIDES, open);
    let exact = (CELLS as f64).powi(3) / (gap * roughness * roughness);
    let found = force(&setup)[1];
    assert!((found / exact - 1.0).abs() < 0.03, "{}", found / exact);
}

#[test]
fn fluid_is_trapped_between_bodies_that_may_touch_and_walls() {
    // A film of 0.005 cells at the side of a row: its parts have less than a hundredth of their cells.
    let volume = |has_contact: bool, side: fn() -> FluidBoundary<2>| {
        let mut setup = plates(0.005, V::zeros(), FilmSetup::default());
        on_all_sides(&mut setup, side);
        let obstacle = against(0, &setup.bodies);
        setup.contacts.extend(has_contact.then(|| contact(&setup.bodies, 1, (1.0, 0.0, 1.0), obstacle)));
        let (state, _) = run(&setup, 1);
        let initial = State::initial(&setup).expect("a start");
        assert_eq!(wet(&initial).cut, wet(&state).cut, "the bodies are at rest");
        wet(&state).cut.fluid_volume()
    };
    let film = 0.005 * length::<2>();
    let all = volume(false, || FluidBoundary::NoSlip);
    assert_eq!(volume(true, open), all);
    assert_eq!(volume(true, || FluidBoundary::parallel(0)), all);
    // A wall that moves along itself encloses fluid; one through which fluid flows does not.
    let along = volume(true, || FluidBoundary::Velocity(Arc::new(|_, _| V::new(0.0, 2.0))));
    assert!((all - along - film).abs() < 1e-12);
    assert_eq!(volume(true, || FluidBoundary::Velocity(Arc::new(|_, _| V::new(0.1, 2.0)))), all);
    assert!((all - volume(true, || FluidBoundary::NoSlip) - film).abs() < 1e-12);
    assert!((all - volume(true, || FluidBoundary::symmetry(0)) - film).abs() < 1e-12);
}

#[test]
fn vapour_bounds_the_tension_of_a_film_that_opens() {
    let gap = 0.25;
    let tension = |floor| {
        let mut setup = plates(gap, V::new(0.0, 1.0), FilmSetup { roughness: 0.0, floor });
        on_sides(&mut setup, &SIDES, open);
        let (state, _) = run(&setup, 1);
        let lowest = wet(&state).pressure.iter().fold(f64::INFINITY, |low, p| low.min(*p));
        (lowest, force(&setup)[1])
    };
    // Without a floor the lowest pressure is -3/2 μ V L²/δ³.
    let length = CELLS as f64;
    let (lowest, force) = tension(None);
    assert!((lowest / (-1.5 * length.powi(2) / gap.powi(3)) - 1.0).abs() < 0.05, "{lowest}");
    assert!((force / -(length / gap).powi(3) - 1.0).abs() < 0.05, "{force}");
    // Vapour in the middle half.
    let width = 0.25 * length;
    let floor = -6.0 * width * width / gap.powi(3);
    let (lowest, force) = tension(Some(floor));
    assert!((lowest / floor - 1.0).abs() < 2e-3, "{}", lowest / floor);
    let exact = floor * (length - 2.0 * width + 2.0 * width * 2.0 / 3.0);
    assert!((force / exact - 1.0).abs() < 0.05, "{}", force / exact);
}

/// The film grows at a rate that the fluid of a closed region cannot follow.
#[test]
fn no_vapour_appears_in_a_closed_region() {
    let gap = 0.25;
    let of = |floor| {
        let mut setup = plates(gap, V::new(0.0, 1.0), FilmSetup { roughness: 0.0, floor });
        on_all_sides(&mut setup, || FluidBoundary::NoSlip);
        run(&setup, 1)
    };
    let [(without, _), (with, reports)] = [None, Some(-0.1)].map(of);
    let pressures = wet(&without).pressure.iter().zip(&wet(&with).pressure);
    let largest = wet(&without).pressure.iter().fold(0.0_f64, |largest, p| largest.max(p.abs()));
    assert!(largest > 1e3 && pressures.fold(0.0_f64, |most, (p, q)| most.max((p - q).abs())) < 1e-6 * largest);
    let source = wet_report(&reports[0]).pocket_source;
    assert!((source * gap - 1.0).abs() < 1e-6, "{source}");
    // The reaction of the pocket works against the mean pressure that is removed.
    let ledger = &reports[0].ledger;
    assert!(ledger.other.abs() < 1e-8 * ledger.largest_line(), "{ledger:?}");
}

#[test]
fn a_ball_that_falls_into_a_film_loses_energy_in_every_step() {
    let background = structured_box::<2>([-4.0, 0.0], [4.0, 4.0], [24, 12]).expect("a box");
    let mut setup = setup(fluid(background, 0.2, 0.5), 2e-3);
    fluid_of(&mut setup).convection = Some(solver::ConvectionForm::Skew);
    fluid_of(&mut setup).film = Some(FilmSetup::default());
    on_sides(&mut setup, &["left", "right", "bottom"], || FluidBoundary::NoSlip);
    on_sides(&mut setup, &["top"], open);
    let ball = rigid("ball", &disk([0.0, 1.3], 1.0, 0.1), 3.0, V::new(0.0, -100.0));
    setup.bodies.push(Arc::new(ball));
    let (state, reports) = run(&setup, 40);
    assert!(motion(&state, 0).centre[1] < 1.25, "{}", motion(&state, 0).centre[1]);
    let size = reports.iter().map(|report| report.ledger.largest_line()).fold(0.0, f64::max);
    for report in &reports {
        let ledger = &report.ledger;
        assert!(ledger.film > 0.0 && ledger.dissipation() > -1e-9 * size, "{ledger:?}");
        assert!(ledger.defect().abs() < 1e-9 * size && ledger.other.abs() < 1e-9 * size, "{ledger:?}");
    }
    let (film, viscosity) =
        reports.iter().fold((0.0, 0.0), |sum, r| (sum.0 + r.ledger.film, sum.1 + r.ledger.viscosity));
    assert!(film > 0.1 * viscosity, "film {film}, viscosity {viscosity}");
}

#[test]
fn films_that_reach_past_a_line_of_the_mesh_by_a_sliver_have_the_force_of_reynolds() {
    // The upper plate is at a line of the mesh or just above it. Parts above the line are slivers, some without
    // moments.
    for above in [0.0, 1e-14, 1e-12, 1e-9, 1e-7, 1e-5, 1e-4, 1e-3] {
        let gap = 0.2 + 2.0 * above;
        let (plane, in_space) = (squeeze::<2>(gap), squeeze::<3>(gap) / (0.951 * 0.4217));
        assert!((plane - 1.0).abs() < 0.005, "{above:e} above: {plane}");
        assert!((in_space - 1.0).abs() < 0.015, "{above:e} above: {in_space}");
        // Asperities fill slivers, and not the film.
        for roughness in [0.0, 1e-6, 1e-3, 0.1] {
            let with_edges = squeeze_between_edges::<2>(gap, MIDDLE, roughness, [10.3, 20.3]);
            let ratio = with_edges / with_open_fluid(gap);
            assert!((ratio - 1.0).abs() < 0.1, "{above:e} above, roughness {roughness}: {ratio}");
        }
    }
}

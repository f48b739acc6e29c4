//! The mortar on one cut cell: values by hand, action and reaction, leak and traction.

mod moved;

use std::sync::Arc;

use algebra::time::Affine;
use algebra::{BlockLayout, BlockSystem, Constraints, Contributions, Integral, check_tangent};
use body::{SurfaceMotion, SurfaceStress, SurfaceVelocity};
use cutcell::{CutMesh, OverlayOptions};
use fluid_ns::{FilmSurfaces, FilmValues, FluidFields, FluidGeometry, NewtonianFluid};
use interface_dg::terms::{ClosedPressure, PenaltyProfile};
use interface_dg::{
    ClosedPoints, FluidStress, InterfacePoints, MortarForm, PieceValues, interface_flow, interface_power,
    interface_tractions,
};
use mesh::generate::structured_box;
use mesh::{BodyId, Coordinates, MAX_FACET_NODES, Placed, Point, SimplexMesh, Tensor, Vector, VertexId};
use xfem_space::{PartValues, XfemSpace, face_values};

type V = Vector<2>;

const FLUID: NewtonianFluid = NewtonianFluid { density: 1.0, viscosity: 0.5 };

/// Returns the form with the uniform penalty.
fn uniform(gamma_sigma: f64) -> MortarForm {
    MortarForm::new(FLUID, PenaltyProfile::Uniform { gamma_sigma }, 0.0)
}

/// A background of squares of side 1 with a body below y = 0.4, whose top is the only wet side.
struct Fixture {
    background: SimplexMesh<2>,
    body: SimplexMesh<2>,
    cut: CutMesh<2>,
    space: XfemSpace<2>,
    /// Whether the fluid between the body and the upper side of the background is a film.
    is_film: bool,
}

/// Returns the velocity of fluid at rest.
fn still(_: &Point<2>) -> V {
    V::zeros()
}

/// Returns the pressure zero.
fn unpressed(_: &Point<2>) -> f64 {
    0.0
}

impl Fixture {
    fn new() -> Self {
        Self::between(0.0, 2.0)
    }

    /// Creates the fixture with the sides of the body at two places.
    fn between(left: f64, right: f64) -> Self {
        Self::of(left, right, 2, Coordinates::Cartesian)
    }

    /// Creates the fixture with a height of the background and coordinates.
    fn of(left: f64, right: f64, height: usize, coordinates: Coordinates) -> Self {
        let background = structured_box::<2>([0.0, 0.0], [2.0, height as f64], [2, height]).expect("a box");
        let background = background.with_coordinates(coordinates).expect("a meridian half-plane");
        let body = structured_box::<2>([left, 0.0], [right, 0.4], [3, 1]).expect("a box");
        let boundary = body.boundary();
        let placed = [Placed::new(&boundary, body.vertices())];
        let cut = CutMesh::overlay(&background, &placed, &OverlayOptions::new()).expect("a cut");
        let space = XfemSpace::new(&background, &cut);
        Self { background, body, cut, space, is_film: false }
    }

    /// Calls `visit` with the interface, the form, the state, the forces on fluid and body, and the sum of the pressure
    /// rows.
    fn with_points<R>(
        &self,
        form: MortarForm,
        u: impl Fn(&Point<2>) -> V,
        p: impl Fn(&Point<2>) -> f64,
        v: V,
        elastic: bool,
        visit: impl FnOnce(&InterfacePoints<'_, 2>, &MortarForm, &[f64], [V; 2], f64) -> R,
    ) -> R {
        let parts = PartValues::new(&self.background, &self.cut);
        let faces = face_values(&self.background, &self.cut, &self.space, &parts);
        let history = vec![V::zeros(); self.space.len()];
        let boundary = self.body.boundary();
        let mut values = PieceValues::new(&self.background, &self.cut, &parts, &[&boundary], 2);
        if self.is_film {
            let placed = [Placed::new(&boundary, self.body.vertices())];
            let surfaces = FilmSurfaces::new(&placed, &self.background, |tag| tag == self.background.tag("top"));
            let films = FilmValues::new(&self.background, &self.cut, &parts, &surfaces, 0.0);
            values.set_films(&self.cut, &[&boundary], &films);
        }
        values.set_relative_speeds(&self.cut, &self.space, &history, |_| [v; MAX_FACET_NODES]);
        let acceleration = Affine { slope: 1.0, predicted: Vec::new() };
        let mut layout = BlockLayout::new();
        let velocity = layout.push("velocity", self.space.len(), 2);
        let pressure = layout.push_on(velocity, "pressure", 1);
        let field = layout.push("body", self.body.n_vertices(), 2);
        let surface = SurfaceMotion {
            boundary: &boundary,
            geometry: self.body.vertices().to_vec(),
            start: self.body.vertices().to_vec(),
            end: Affine { slope: 1.0, predicted: self.body.vertices().to_vec() },
            stage: None,
            velocity: if elastic {
                SurfaceVelocity::Field(field)
            } else {
                SurfaceVelocity::Given(Box::new(move |_| v))
            },
        };
        let Self { background, cut, space, .. } = self;
        let points = InterfacePoints {
            geometry: FluidGeometry {
                background,
                cut,
                space,
                parts: &parts,
                faces: &faces,
                known_velocity: &history,
                films: None,
                acceleration: &acceleration,
            },
            fields: FluidFields { layout: &layout, velocity, pressure },
            values: &values,
            surfaces: vec![&surface],
            fluid: FLUID,
            solid: None,
        };
        let at = |k: &VertexId| background.vertex(*k);
        let mut x = vec![0.0; layout.len()];
        layout.set(velocity, space.vertices().iter().map(|k| u(&at(k)).into()), &mut x);
        layout.set(pressure, space.vertices().iter().map(|k| [p(&at(k))]), &mut x);
        layout.set(field, vec![v.into(); self.body.n_vertices()], &mut x);
        let interface = form.contributions(points.clone());
        let in_films = form.in_films(points.clone());
        assert_eq!(in_films.is_some(), self.is_film);
        let mut terms: Vec<&dyn Contributions> = vec![&interface];
        terms.extend(in_films.iter().map(|slips| slips as &dyn Contributions));
        assert!(terms.iter().all(|terms| check_tangent(*terms, &x, 1e-5) < 1e-9));
        let mut system = BlockSystem::new(&layout, &terms, &Constraints::new());
        system.assemble_residual(&terms, &x);
        let sum = system.residual();
        let force = [velocity, field].map(|field| layout.values::<2>(field, sum).map(V::from).sum());
        visit(&points, &form, &x, force, sum[layout.range(pressure)].iter().sum())
    }
}

#[test]
fn pressure_pushes_fluid_and_body_apart() {
    // u = v: no jump. -(T n^f, v - w) with T n^f = -p n^f, n^f = (0, -1), on a length of 2.
    let u = |_: &Point<2>| V::new(1.0, 0.5);
    let p = |_: &Point<2>| 3.0;
    Fixture::new().with_points(uniform(1e3), u, p, V::new(1.0, 0.5), true, |points, form, x, force, flux| {
        assert!((force[0] - V::new(0.0, -6.0)).norm() < 1e-12, "{}", force[0]);
        assert!((force[0] + force[1]).norm() < 1e-12, "action and reaction");
        assert!(flux.abs() < 1e-12);
        for t in interface_tractions(points, &form.penalty, x) {
            // The traction on the body is -p n with n = (0, 1).
            assert!((t.total() - V::new(0.0, -3.0)).norm() < 1e-12 && t.jump.norm() < 1e-12);
        }
    });
}

#[test]
fn shear_drags_the_body_along() {
    // u = (y - 0.4, 0): no jump on the interface; viscous traction on the body μ (1, 0).
    let u = |x: &Point<2>| V::new(x[1] - 0.4, 0.0);
    Fixture::new().with_points(uniform(1e3), u, unpressed, V::zeros(), true, |points, form, x, force, _| {
        assert!((force[1] - V::new(-1.0, 0.0)).norm() < 1e-12, "{}", force[1]);
        assert!((force[0] + force[1]).norm() < 1e-12);
        assert!(
            interface_tractions(points, &form.penalty, x).iter().all(|t| (t.fluid - V::new(0.5, 0.0)).norm() < 1e-12)
        );
    });
}

#[test]
fn a_jump_is_penalised_and_counted_as_leak() {
    for elastic in [true, false] {
        // Fluid at rest, body moving up with 2: jump (0, -2); every cell has h_K = √(0.5 · 4/√3).
        Fixture::new().with_points(
            uniform(100.0),
            still,
            unpressed,
            V::new(0.0, 2.0),
            elastic,
            |points, _, x, force, flux| {
                let h = (0.5 * 4.0 / 3.0_f64.sqrt()).sqrt();
                let penalty = 100.0 * 0.5 / h * -2.0 * 2.0;
                assert!((force[0] - V::new(0.0, penalty)).norm() < 1e-10, "{}", force[0]);
                let reaction = if elastic { -force[0] } else { V::zeros() };
                assert!((force[1] - reaction).norm() < 1e-10);
                // -(u - v_s)·n^f q: jump·n^f = 2 on a length of 2.
                assert!((flux + 4.0).abs() < 1e-12, "{flux}");
                let flow = interface_flow(points, x);
                assert!((flow.leak_net + 4.0).abs() < 1e-12 && (flow.leak_absolute - 4.0).abs() < 1e-12);
                assert!((flow.swept - 4.0).abs() < 1e-12);
            },
        );
    }
}

/// Checks the mean traction of linear fields against their gradients, and its derivatives against finite differences.
#[test]
fn fluid_stress_is_the_traction_of_the_fluid() {
    let gradient = Tensor::<2>::new(0.7, -1.1, 0.4, 0.3);
    let p = |x: &Point<2>| 2.0 - 3.0 * x[0] + 0.5 * x[1];
    let u = |x: &Point<2>| gradient * x + V::new(0.2, -0.4);
    Fixture::new().with_points(uniform(1e3), u, p, V::zeros(), true, |points, _, x, _, _| {
        let stress = Arc::new(FluidStress::new(points.clone(), BodyId(0), |_| V::zeros()));
        let closed = ClosedPoints::new(Arc::clone(&stress));
        let pieces = points.geometry.cut.interface().iter();
        let rim: Vec<f64> = pieces.map(|piece| p(&((piece.points[0] + piece.points[1]) / 2.0))).collect();
        let surface = points.surfaces[0];
        let (mut dofs, mut derivatives, mut unused) = (Vec::new(), Vec::new(), Vec::new());
        let (mut n_wet, mut worst) = (0, [0.0_f64; 2]);
        for facet in surface.boundary.facets() {
            dofs.clear();
            stress.dofs(facet, &mut dofs);
            let found = stress.on(facet, x, &mut derivatives);
            assert!(derivatives.iter().all(|(dof, _)| dofs.contains(dof)));
            let corners = surface.boundary.facet(facet);
            let middle: Point<2> = (0..2).map(|k| surface.geometry[corners[k].index()] / 2.0).sum();
            // The top of the body is wet; the other sides lie on the boundary of the background, and carry the
            // pressure of the nearest piece.
            if corners.iter().any(|v| surface.geometry[v.index()][1] < 0.3) {
                let normal = Placed::new(surface.boundary, &surface.geometry).facet_normal(facet);
                let pressure = -found.dot(&normal);
                assert!((found + normal * pressure).norm() < 1e-14 && rim.iter().any(|p| (p - pressure).abs() < 1e-12));
                continue;
            }
            n_wet += 1;
            let normal = V::new(0.0, 1.0);
            let expected = (gradient + gradient.transpose()) * normal * 0.5 - normal * p(&middle);
            worst[0] = worst[0].max((found - expected).norm() / expected.norm());
            for dof in &dofs {
                let mut of_dof =
                    derivatives.iter().filter(|(other, _)| other == dof).map(|(_, derivative)| *derivative);
                let derivative = of_dof.next().unwrap_or_default();
                assert!(of_dof.next().is_none(), "each dof once");
                let mut moved = x.to_vec();
                let mut with = |value: f64| {
                    moved[dof.index()] = value;
                    stress.on(facet, &moved, &mut unused)
                };
                let (value, step) = (x[dof.index()], 1e-3);
                let difference = (with(value + step) - with(value - step)) / (2.0 * step);
                worst[1] = worst[1].max((difference - derivative).norm());
            }
            assert!(derivatives.iter().any(|(_, derivative)| derivative.norm() > 0.1));
        }
        assert_eq!(n_wet, 3);
        let closed = Integral::linear("closed surface", closed, vec![&ClosedPressure]);
        assert!(closed.len() > 3 && check_tangent(&closed, x, 1e-3) < 1e-9);
        assert!(worst[0] < 1e-13 && worst[1] < 1e-11, "{worst:?}");
    });
}

/// Checks the mean over facets that are wet in part: their ends lie outside of the background.
#[test]
fn fluid_stress_of_a_facet_that_is_closed_in_part() {
    let (p, force) = (|x: &Point<2>| 2.0 - 3.0 * x[0], V::new(5.0, -7.0));
    // Facets on the top: (-1, 0.2), (0.2, 1.4), (1.4, 2.6).
    Fixture::between(-1.0, 2.6).with_points(uniform(1e3), still, p, V::zeros(), true, |points, _, x, _, _| {
        let stress = FluidStress::new(points.clone(), BodyId(0), |_| force);
        let surface = Placed::new(points.surfaces[0].boundary, &points.surfaces[0].geometry);
        let mut n_checked = 0;
        for facet in surface.boundary().facets() {
            let [left, right] = {
                let ends = surface.facet_points(facet);
                [ends[0][0].min(ends[1][0]), ends[0][0].max(ends[1][0])]
            };
            let (wet, closed) = if left < -0.9 && right > 0.1 {
                ([0.0, 0.2], [-1.0, 0.0])
            } else if left > 1.3 && left < 2.5 {
                ([1.4, 2.0], [2.0, 2.6])
            } else {
                continue;
            };
            if surface.facet_normal(facet)[1] < 0.5 {
                continue;
            }
            n_checked += 1;
            // The piece that is nearest to the middle of the facet continues the pressure of its own middle.
            let middle = |ends: [f64; 2]| (ends[0] + ends[1]) / 2.0;
            let share = (wet[1] - wet[0]) / (right - left);
            let pieces = points.geometry.cut.interface().iter().filter(|piece| piece.facet == facet);
            let of_pieces = pieces.map(|piece| (piece.points[0][0] + piece.points[1][0]) / 2.0);
            let rim = of_pieces.min_by(|a, b| (a - middle(closed)).abs().total_cmp(&(b - middle(closed)).abs()));
            let rim = rim.expect("a piece");
            let at = |at: f64| p(&Point::<2>::new(at, 0.4));
            let continued = at(rim) + force[0] * (middle(closed) - rim);
            let expected = share * at(middle(wet)) + (1.0 - share) * continued;
            let mut derivatives = Vec::new();
            let found = stress.on(facet, x, &mut derivatives);
            assert!((found + V::new(0.0, expected)).norm() < 1e-12 * expected.abs(), "{found} {expected}");
            // The mean is linear in the state.
            for (dof, derivative) in &derivatives {
                let mut moved = x.to_vec();
                moved[dof.index()] += 1.0;
                let difference = stress.on(facet, &moved, &mut Vec::new()) - found;
                assert!((difference - derivative).norm() < 1e-12, "{difference} {derivative}");
            }
            assert!(derivatives.len() > 3);
        }
        assert_eq!(n_checked, 2);
    });
}

/// Checks the closed underside of a flat body: its pressure is that at the sides, although pieces of the top are
/// nearer.
#[test]
fn the_pressure_below_a_flat_body_is_not_that_above_it() {
    let p = |x: &Point<2>| 2.0 - 3.0 * x[1];
    let fixture = Fixture::between(0.5, 1.5);
    fixture.with_points(uniform(1e3), still, p, V::zeros(), true, |points, _, x, _, _| {
        let stress = FluidStress::new(points.clone(), BodyId(0), |_| V::zeros());
        let surface = Placed::new(points.surfaces[0].boundary, &points.surfaces[0].geometry);
        let below = surface.boundary().facets().filter(|facet| surface.facet_normal(*facet)[1] < -0.5);
        let pressures: Vec<f64> = below.map(|facet| stress.on(facet, x, &mut Vec::new())[1]).collect();
        // The middle of a side is at the height 0.2.
        assert!(pressures.len() == 3 && pressures.iter().all(|found| (found - 1.4).abs() < 1e-12), "{pressures:?}");
    });
}

/// Returns the force on the fluid at rest by a body that moves with a velocity.
fn force_on_fluid(form: MortarForm, v: V) -> V {
    Fixture::new().with_points(form, still, unpressed, v, true, |_, _, _, force, _| {
        assert!((force[0] + force[1]).norm() < 1e-12 * force[0].norm(), "action and reaction");
        force[0]
    })
}

#[test]
fn the_split_penalty_has_inertia_in_the_normal_direction_only() {
    // The interface has the normal (0, 1) and the length 2.
    let h = (0.5 * 4.0 / 3.0_f64.sqrt()).sqrt();
    let (viscous, rate) = (0.5 / h, 40.0);
    let inertial = 5.0_f64.sqrt() / 6.0 + h * rate / 12.0;
    let profile = PenaltyProfile::Split { gamma_normal: 35.0, gamma_tangential: 20.0 };
    let force = force_on_fluid(MortarForm::new(FLUID, profile, rate), V::new(1.0, 2.0));
    let expected = V::new(20.0 * viscous, 35.0 * (viscous + inertial) * 2.0) * -2.0;
    assert!((force - expected).norm() < 1e-11 * expected.norm(), "{force}");
}

#[test]
fn a_split_penalty_without_inertia_is_the_uniform_one() {
    let still = NewtonianFluid { density: 0.0, ..FLUID };
    let split = PenaltyProfile::Split { gamma_normal: 33.0, gamma_tangential: 33.0 };
    let v = V::new(1.3, 0.7);
    assert_eq!(force_on_fluid(MortarForm::new(still, split, 7.0), v), force_on_fluid(uniform(33.0), v));
}

/// Checks a slip that varies along the film: its mean on a side of a body in a fluid part has the whole penalty, the
/// rest is resisted by the layer of the film, too. Cells border on two facets of the body, and with rotational symmetry
/// weights grow along the film.
fn check_mean_slip(height: usize, coordinates: Coordinates, share: f64) {
    const RATE: f64 = 3.0;
    const LAYER: f64 = 0.6;
    let fixture = Fixture { is_film: true, ..Fixture::of(0.0, 2.0, height, coordinates) };
    // ∫ w x^n from 0 to x, with the weight w = 1 or 2π x.
    let integral = |x: f64, n: i32| match coordinates {
        Coordinates::Cartesian => x.powi(n + 1) / f64::from(n + 1),
        Coordinates::Axisymmetric => 2.0 * std::f64::consts::PI * x.powi(n + 2) / f64::from(n + 2),
    };
    let h = (0.5 * 4.0 / 3.0_f64.sqrt()).sqrt();
    let of_mean = 40.0 * FLUID.viscosity / h;
    let of_rest = 1.0 / (1.0 / of_mean + share * LAYER / FLUID.viscosity);
    // Diagonals of the squares end the cells at the height 0.4.
    let cells = [[0.0_f64, 0.4], [0.4, 1.0], [1.0, 1.4], [1.4, 2.0]];
    let exact = cells.iter().map(|[from, to]| {
        let [weight, first, second] = [0, 1, 2].map(|n| integral(*to, n) - integral(*from, n));
        RATE.powi(2) * (of_mean * first.powi(2) / weight + of_rest * (second - first.powi(2) / weight))
    });
    let exact = exact.sum::<f64>();
    for elastic in [true, false] {
        let (u, p) = (|x: &Point<2>| V::new(RATE * x[0], 0.0), |_: &Point<2>| 0.0);
        fixture.with_points(uniform(40.0), u, p, V::zeros(), elastic, |points, form, x, force, _| {
            let power = interface_power(points, &form.penalty, x);
            assert!((power.penalty_tangential - exact).abs() < 1e-12 * exact, "{power:?}, {exact}");
            let tractions = interface_tractions(points, &form.penalty, x);
            let total: V = tractions.iter().map(|on| on.penalty * on.measure).sum();
            let mean = RATE * of_mean * integral(2.0, 1);
            assert!((total[0] - mean).abs() < 1e-12 * mean, "{total}, {mean}");
            let on_body: V = tractions.iter().map(|on| on.total() * on.measure).sum();
            assert!(!elastic || (force[1] + on_body).norm() < 1e-12 * on_body.norm(), "{} {on_body}", force[1]);
        });
    }
}

#[test]
fn the_penalty_in_films_acts_on_the_mean_slip() {
    check_mean_slip(2, Coordinates::Cartesian, 1.0);
    check_mean_slip(2, Coordinates::Axisymmetric, 1.0);
    // The gap is 2.6 cells, with the share (4 - 2.6)/2.
    check_mean_slip(3, Coordinates::Cartesian, 0.7);
}

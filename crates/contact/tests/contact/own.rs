//! A body in contact with itself.

use std::cell::RefCell;
use std::f64::consts::FRAC_PI_4;

use algebra::time::ImplicitEuler;
use algebra::{Contributions, worst_tangent_entry};
use body::{Body, BodyState};
use contact::{ContactForm, ContactItems, ContactLaw, ContactSites, NitscheLaw, OwnSurface, PenaltyLaw};
use mesh::generate::structured_box;
use mesh::nalgebra::Rotation2;
use mesh::{CellId, FacetId, Point, SimplexMesh, Vector, VertexId};
use rand::SeedableRng;
use rand_xoshiro::SplitMix64;
use solid_svk::{ElasticBody, ElasticOptions, Order, SaintVenantKirchhoff, SolidForm, SolidMesh};

use crate::setting::{Scene, n_active, numbers, report_of, residual, soft, work};

const SIZE: f64 = 0.02;
const OFFSET: f64 = 0.05;
/// Height of the slit of the clamp.
const SLIT: f64 = 0.2;

/// Returns a clamp: a square without the strip between its two jaws, open to the right.
fn clamp(order: Order) -> ElasticBody<2> {
    part_of_square(order, |middle| middle[0] < 0.2 || (middle[1] - 0.5).abs() > 0.5 * SLIT)
}

/// Returns the cells of a square whose middles are in a region.
fn part_of_square(order: Order, contains: impl Fn(Point<2>) -> bool) -> ElasticBody<2> {
    let square = structured_box([0.0, 0.0], [1.0, 1.0], [10, 10]).unwrap();
    let is_solid =
        |cell: &CellId| contains(square.cell(*cell).iter().map(|v| square.vertex(*v)).sum::<Point<2>>() / 3.0);
    let mut numbers = vec![None; square.n_vertices()];
    let (mut vertices, mut cells) = (Vec::new(), Vec::new());
    for vertex in square.cells().filter(is_solid).flat_map(|cell| square.cell(cell)) {
        cells.push(*numbers[vertex.index()].get_or_insert_with(|| {
            vertices.push(square.vertex(*vertex));
            VertexId::new(vertices.len() - 1)
        }));
    }
    elastic(order, SimplexMesh::new(vertices, cells).unwrap())
}

/// Returns an elastic body of the cells of a mesh.
fn elastic(order: Order, mesh: SimplexMesh<2>) -> ElasticBody<2> {
    let solid = SolidMesh::of_order(mesh, order).unwrap();
    let form = SolidForm::new(1.0, SaintVenantKirchhoff::new(soft()), Vector::zeros()).unwrap();
    ElasticBody::new("clamp", solid, form, ElasticOptions::default()).unwrap()
}

/// Returns the clamp with its jaws bent towards each other; `narrowing` is that of the slit at its open end.
fn bent(body: &ElasticBody<2>, narrowing: f64) -> BodyState<2> {
    let bend = |x: &Point<2>| {
        let arm = (x[0] - 0.2).max(0.0) / 0.8;
        Vector::<2>::new(0.0, -0.5 * narrowing * arm * arm * (x[1] - 0.5).signum())
    };
    let displacement: Vec<_> = body.reference().iter().map(bend).collect();
    let velocity = vec![Vector::zeros(); displacement.len()];
    BodyState::new(displacement, velocity)
}

/// Calls a test with the contact of the clamp, of either order, with itself and a state at rest.
fn closed_clamp(
    closed: f64,
    law: impl ContactLaw + Copy + 'static,
    test: impl Fn(&ContactSites<'_, 2>, &ElasticBody<2>, &[f64]),
) {
    closed_clamp_with(OFFSET + 2.0 * SIZE, closed, law, test);
}

/// Calls a test as [`closed_clamp`] does, with an exempt distance.
fn closed_clamp_with(
    exempt: f64,
    closed: f64,
    law: impl ContactLaw + Copy + 'static,
    test: impl Fn(&ContactSites<'_, 2>, &ElasticBody<2>, &[f64]),
) {
    for order in [Order::Linear, Order::Quadratic] {
        let body = clamp(order);
        let state = bent(&body, closed);
        with_contact(exempt, body, state, law, &test);
    }
}

/// Calls a test with the contact of a body with itself.
fn with_contact(
    exempt: f64,
    body: ElasticBody<2>,
    state: BodyState<2>,
    law: impl ContactLaw + 'static,
    test: impl Fn(&ContactSites<'_, 2>, &ElasticBody<2>, &[f64]),
) {
    let (bodies, states) = ([body], [state]);
    let scene = Scene::new(&bodies, &states, &ImplicitEuler, 1e-2);
    let form = ContactForm::new(law, SIZE).unwrap();
    let facets: Vec<FacetId> = bodies[0].surface().facets().collect();
    let reach = 2.0 * exempt;
    let surface = bodies[0].surface().clone();
    let obstacle = OwnSurface::new(surface, facets.clone(), bodies[0].reference().to_vec(), exempt).unwrap();
    let mut pair = scene.pair(&form, &facets, &obstacle);
    pair.master = Some(pair.slave);
    pair.share = if pair.stress.is_some() { 0.5 } else { 1.0 };
    let items = ContactItems::new(&pair, &scene.layout, reach);
    let contact = ContactSites { items: &items, pair, layout: &scene.layout };
    test(&contact, &bodies[0], &vec![0.0; scene.layout.len()]);
}

fn penalty() -> PenaltyLaw {
    PenaltyLaw::new(1e3, OFFSET).unwrap()
}

#[test]
fn an_open_clamp_does_not_touch_itself() {
    // Neighbours along the surface and the two sides of a jaw are near, but exempt.
    closed_clamp(0.0, penalty(), |contact, _, x| {
        assert_eq!(work(contact.clone()).len(), 0);
        assert_eq!(report_of(contact, x).minimum_gap, None);
    });
}

/// Checks the sides of a re-entrant corner that closes by 6 to 22 degrees: each lies in front of the other, and its
/// points are on both sides of the line of the other.
#[test]
fn the_sides_of_a_corner_do_not_touch_through_its_opening() {
    let is_angle = |x: Point<2>| x[0] < 0.3 || x[1] < 0.3;
    for (slope, curvature) in [(0.1, -1.0), (0.1, 0.0), (0.1, 1.0), (0.4, -1.0)] {
        let body = part_of_square(Order::Linear, is_angle);
        let raised = |x: &Point<2>| {
            let along = (x[0] - 0.3).max(0.0);
            Vector::<2>::new(0.0, slope * along * (1.0 + curvature * along))
        };
        let displacement: Vec<_> = body.reference().iter().map(raised).collect();
        let velocity = vec![Vector::zeros(); displacement.len()];
        with_contact(OFFSET + 2.0 * SIZE, body, BodyState::new(displacement, velocity), penalty(), |contact, _, x| {
            assert!(!work(contact.clone()).is_empty(), "the sides are in reach");
            let report = report_of(contact, x);
            assert_eq!((report.n_active, report.largest_penetration), (0, 0.0), "{slope} {curvature}");
        });
    }
}

#[test]
fn the_sides_of_a_part_do_not_touch_through_its_thickness() {
    // The jaws are 0.4 thick, less than half of the exempt distance; the slit is exempt too.
    for closed in [0.0, 0.15] {
        closed_clamp_with(0.85, closed, penalty(), |contact, _, _| assert_eq!(work(contact.clone()).len(), 0));
    }
}

#[test]
fn jaws_that_close_touch_each_other() {
    let closed = 0.18;
    closed_clamp(closed, penalty(), |contact, body, x| {
        let report = report_of(contact, x);
        let gap = report.minimum_gap.unwrap();
        assert!((gap - (SLIT - closed)).abs() < 2e-3, "{gap}");
        assert!(report.n_active > 3 && (report.largest_penetration - (OFFSET - gap)).abs() < 1e-9);
        // Both jaws act as slaves: forces cancel, and their moment about any point too.
        let forces = residual(contact, x);
        let of_vertex = |k: usize| Vector::<2>::new(forces[2 * k], forces[2 * k + 1]);
        let places = bent(body, closed).positions(body.reference());
        let sum = (0..places.len()).map(of_vertex).sum::<Vector<2>>();
        let moment: f64 = places.iter().enumerate().map(|(k, x)| x[0] * of_vertex(k)[1] - x[1] * of_vertex(k)[0]).sum();
        let largest = (0..places.len()).map(|k| of_vertex(k).norm()).fold(0.0, f64::max);
        assert!(sum.norm() < 1e-12 * largest && moment.abs() < 1e-12 * largest, "{sum} {moment} {largest}");
        // The jaws are pushed apart.
        let upper: f64 = places.iter().enumerate().filter(|(_, x)| x[1] > 0.5).map(|(k, _)| of_vertex(k)[1]).sum();
        assert!(upper < -0.5 * largest, "{upper} {largest}");
    });
}

/// Checks that jaws which overlap by a tenth of the slit, with vertices opposite to each other at the tips, are still
/// in contact there.
#[test]
fn jaws_that_overlap_touch_each_other() {
    let closed = 0.22;
    closed_clamp(closed, penalty(), |contact, _, x| {
        let report = report_of(contact, x);
        let gap = report.minimum_gap.unwrap();
        assert!((gap - (SLIT - closed)).abs() < 3e-3, "{gap}");
        assert!(report.n_active > 3);
    });
}

/// Checks that the jaws of a clamp which is turned touch as those of the straight one: the boxes around facets of the
/// two jaws are closer to each other than the exempt distance, and the facets are not.
#[test]
fn contact_does_not_depend_on_the_direction_of_the_axes() {
    let (closed, exempt) = (0.18, 0.12);
    let reports = [0.0, FRAC_PI_4].map(|angle| {
        let turn = Rotation2::new(angle).into_inner();
        let straight = clamp(Order::Linear);
        let mesh = straight.solid().mesh().mapped(|x| turn * x).unwrap();
        let displacement: Vec<_> = bent(&straight, closed).displacement().iter().map(|d| turn * d).collect();
        let velocity = vec![Vector::zeros(); displacement.len()];
        let report = RefCell::new(None);
        with_contact(
            exempt,
            elastic(Order::Linear, mesh),
            BodyState::new(displacement, velocity),
            penalty(),
            |contact, _, x| {
                let found = report_of(contact, x);
                report.replace(Some((found.n_active, found.minimum_gap.unwrap(), found.largest_penetration)));
            },
        );
        report.into_inner().unwrap()
    });
    let [straight, turned] = reports;
    assert!(straight.0 > 3 && straight.0 == turned.0, "{reports:?}");
    assert!((straight.1 - turned.1).abs() < 1e-12 && (straight.2 - turned.2).abs() < 1e-12, "{reports:?}");
}

#[test]
fn its_tangent_is_exact() {
    fn check(law: impl ContactLaw + Copy + 'static) {
        closed_clamp(0.17, law, |contact, _, at_rest| {
            let x = numbers(&mut SplitMix64::seed_from_u64(7), at_rest.len(), 0.3);
            assert!(n_active(contact, &x, |_| true) > 3);
            let contact = work(contact.clone());
            let worst = worst_tangent_entry(&contact, 0..contact.len(), &x, 1e-5);
            assert!(worst.relative < 1e-6, "{worst:?}");
        });
    }
    check(penalty());
    check(NitscheLaw::new(1.0, OFFSET, 0.0).unwrap());
}

//! A block and a rigid plane.

use algebra::{BlockLayout, Contributions, check_tangent};
use contact::{
    ContactBody, ContactFacets, ContactForm, ContactPair, ContactReport, DeformableObstacle, Error, Penalty, RigidPlane,
};
use mesh::{FacetId, Point, Vector};

use crate::setting::{Body, Random, residual, soft};

const GAMMA: f64 = 1e6;
const SIZE: f64 = 0.1;
const OFFSET: f64 = 0.05;
const DT: f64 = 1e-2;

/// The half space below the origin.
fn ground<const D: usize>() -> RigidPlane<D> {
    let mut down = Vector::zeros();
    down[D - 1] = -1.0;
    RigidPlane::new(Point::zeros(), down).unwrap()
}

/// A unit block at a height over the ground, all of its facets ready for contact.
fn over_ground<const D: usize>(height: f64, test: impl Fn(&BlockLayout, &Body<D>, &ContactFacets<'_, D>)) {
    let mut layout = BlockLayout::new();
    layout.push("other", 4);
    let mut min = [0.0; D];
    let mut max = [1.0; D];
    min[D - 1] = height;
    max[D - 1] = height + 1.0;
    let body = Body::block(&mut layout, min, max, [3; D], soft());
    let form = ContactForm::new(Penalty::new(GAMMA, OFFSET).unwrap(), SIZE).unwrap();
    let positions = body.positions();
    let facets: Vec<_> = body.solid.boundary().facets().collect();
    let obstacle = ground();
    let slave = body.contact(&positions, DT, &layout);
    let pair = ContactPair { slave, facets: &facets, obstacle: &obstacle, master: None, reach: 0.0 };
    test(&layout, &body, &ContactFacets::new(&form, pair).unwrap());
}

fn no_force_above_the_offset<const D: usize>() {
    for height in [OFFSET, 0.2] {
        over_ground::<D>(height, |layout, _, contact| {
            let x = vec![0.0; layout.len()];
            assert!(residual(contact, x.len(), &x).iter().all(|&r| r == 0.0));
            let report = ContactReport::new(contact, &x);
            assert!(!report.is_active() && report.force.norm() == 0.0 && report.stored_energy == 0.0);
            assert!((report.minimum_gap.unwrap() - height).abs() < 1e-15);
        });
    }
}

#[test]
fn no_force_above_the_offset_in_2d() {
    no_force_above_the_offset::<2>();
}

#[test]
fn no_force_above_the_offset_in_3d() {
    no_force_above_the_offset::<3>();
}

/// A block that sinks rigidly: the force on its base is that of the law times its area.
fn resultant_is_law_times_area<const D: usize>() {
    let height = 0.2;
    let sunk = -0.01;
    over_ground::<D>(height, |layout, body, contact| {
        let mut velocity = Vector::zeros();
        velocity[D - 1] = (sunk - height) / DT;
        let mut x = vec![0.0; layout.len()];
        let all = vec![velocity; body.solid.mesh().n_vertices()];
        body.solid.set_velocity(layout, body.field, &all, &mut x).unwrap();
        let base: Vec<_> = body.solid.boundary().facets().filter(|&f| is_base(body, f)).collect();
        let pair = ContactPair { facets: &base, ..*contact.pair() };
        let contact = ContactFacets::new(contact.form(), pair).unwrap();
        let report = ContactReport::new(&contact, &x);
        let pressure = GAMMA / SIZE * (OFFSET - sunk);
        assert!((report.active_area - 1.0).abs() < 1e-13);
        assert!(
            (report.force[D - 1] - pressure).abs() < 1e-12 * pressure && report.force.amax() == report.force[D - 1]
        );
        assert!((report.power - pressure * velocity[D - 1]).abs() < 1e-11 * pressure * velocity.norm());
        let energy = 0.5 * GAMMA / SIZE * (OFFSET - sunk).powi(2);
        assert!((report.stored_energy - energy).abs() < 1e-12 * energy);
        assert!((report.largest_penetration - (OFFSET - sunk)).abs() < 1e-14);
        assert!((report.minimum_gap.unwrap() - sunk).abs() < 1e-14);
        let r = residual(&contact, x.len(), &x);
        let force: Vector<D> = r[layout.range(body.field)].chunks_exact(D).map(Vector::from_column_slice).sum();
        assert!((force + report.force).norm() < 1e-12 * pressure);
    });
}

fn is_base<const D: usize>(body: &Body<D>, facet: FacetId) -> bool {
    body.solid.mesh().tag("bottom") == body.solid.boundary().tag(facet)
}

#[test]
fn resultant_is_law_times_area_in_2d() {
    resultant_is_law_times_area::<2>();
}

#[test]
fn resultant_is_law_times_area_in_3d() {
    resultant_is_law_times_area::<3>();
}

fn tangent_is_exact<const D: usize>() {
    for seed in 0..4 {
        over_ground::<D>(0.03, |layout, _, contact| {
            let x = Random::new(seed).numbers(layout.len(), 3.0);
            assert!(ContactReport::new(contact, &x).is_active());
            assert!(!contact.is_linear());
            let deviation = check_tangent(contact, &x, 1e-7);
            assert!(deviation < 1e-8, "{deviation:e}");
        });
    }
}

#[test]
fn tangent_is_exact_in_2d() {
    tangent_is_exact::<2>();
}

#[test]
fn tangent_is_exact_in_3d() {
    tangent_is_exact::<3>();
}

#[test]
fn regime_is_the_active_set() {
    over_ground::<2>(0.1, |layout, body, contact| {
        let at = |height: f64, tilt: f64| {
            let velocity = |p: &Point<2>| Vector::<2>::new(0.0, (height - 0.1 + tilt * p[0]) / DT);
            let all: Vec<_> = body.solid.mesh().vertices().iter().map(velocity).collect();
            let mut x = vec![0.0; layout.len()];
            body.solid.set_velocity(layout, body.field, &all, &mut x).unwrap();
            contact.regime(&x)
        };
        assert_eq!(at(0.3, 0.0), at(0.1, 0.2));
        assert_ne!(at(0.3, 0.0), at(0.04, 0.0));
        assert_eq!(at(0.04, 0.0), at(0.035, 0.0));
        assert_ne!(at(0.04, 0.1), at(0.04, -0.1));
    });
}

#[test]
fn nonsense_is_refused() {
    over_ground::<2>(0.1, |layout, body, contact| {
        let form = contact.form();
        let pair = *contact.pair();
        let unknown = [FacetId(1000)];
        let far = ContactPair { facets: &unknown, ..pair };
        assert!(matches!(ContactFacets::new(form, far), Err(Error::UnknownFacet { .. })));
        let lonely = ContactPair { master: Some(pair.slave), ..pair };
        assert!(matches!(ContactFacets::new(form, lonely), Err(Error::Master)));
        let facets = body.solid.boundary().facets().collect();
        let itself = DeformableObstacle::new(body.solid.boundary().clone(), facets).unwrap();
        let narcissus = ContactPair { obstacle: &itself, master: Some(pair.slave), ..pair };
        assert!(matches!(ContactFacets::new(form, narcissus), Err(Error::SelfContact)));
        let negative = ContactPair { reach: -1.0, ..pair };
        assert!(matches!(ContactFacets::new(form, negative), Err(Error::Parameter { .. })));
        assert!(ContactForm::<2>::new(Penalty::new(1.0, 0.0).unwrap(), 0.0).is_err());
        let positions = body.positions();
        let few = ContactBody::new(body.solid.boundary(), &positions[1..], DT, layout, body.field);
        assert!(matches!(few, Err(Error::Field { .. })));
    });
}

//! A block and a rigid plane.

use algebra::time::ImplicitEuler;
use algebra::{check_tangent, regime_of};
use body::{Body, BodyState};
use contact::{
    AugmentedLagrangianLaw, ContactForm, ContactItems, ContactLaw, ContactPair, ContactPoint, ContactSites,
    DeformableObstacle, Error, NitscheLaw, Obstacle, PenaltyLaw, RigidPlane, check_pair,
};
use mesh::{BoundaryMesh, FacetId, Point, Vector};
use rand::SeedableRng;
use rand_xoshiro::SplitMix64;
use solid_svk::{ElasticBody, Order};

use crate::setting::{Scene, block_of, n_active, numbers, report_of, residual, soft, with_velocity, work};

const GAMMA: f64 = 1e6;
const SIZE: f64 = 0.1;
const OFFSET: f64 = 0.05;
const DT: f64 = 1e-2;

/// Returns the half space below the origin.
fn ground<const D: usize>() -> RigidPlane<D> {
    let mut down = Vector::zeros();
    down[D - 1] = -1.0;
    RigidPlane::new(Point::zeros(), down).unwrap()
}

/// A unit block over the ground, its step and its contact.
type Test<'t, const D: usize> = dyn Fn(&ElasticBody<D>, &Scene<'_, D>, &ContactSites<'_, D>) + 't;

/// Calls `test` for unit blocks of both orders at a height over the ground, with contact on all of their facets.
fn over_ground<const D: usize>(height: f64, law: impl ContactLaw + Copy + 'static, test: &Test<'_, D>) {
    for order in [Order::Linear, Order::Quadratic] {
        over_ground_of(order, height, law, test);
    }
}

fn over_ground_of<const D: usize>(order: Order, height: f64, law: impl ContactLaw + 'static, test: &Test<'_, D>) {
    let (mut min, mut max) = ([0.0; D], [1.0; D]);
    min[D - 1] = height;
    max[D - 1] = height + 1.0;
    let n = [4 - order.degree(); D];
    let bodies = [block_of(order, (min, max), n, soft(), with_velocity(Vector::zeros()))];
    let states: [BodyState<D>; 1] = [bodies[0].initial()];
    let scene = Scene::new(&bodies, &states, &ImplicitEuler, DT);
    let form = ContactForm::new(law, SIZE).unwrap();
    let facets: Vec<_> = bodies[0].surface().facets().collect();
    let obstacle = ground();
    let pair = scene.pair(&form, &facets, &obstacle);
    let items = ContactItems::new(&pair, &scene.layout, 0.0);
    test(&bodies[0], &scene, &ContactSites { items: &items, pair, layout: &scene.layout });
}

fn penalty() -> PenaltyLaw {
    PenaltyLaw::new(GAMMA, OFFSET).unwrap()
}

/// Returns the global vector with a velocity at every vertex of the only body.
fn velocities<const D: usize>(body: &ElasticBody<D>, velocity: impl Fn(&Point<D>) -> Vector<D>) -> Vec<f64> {
    body.reference().iter().flat_map(|x| velocity(x).iter().copied().collect::<Vec<_>>()).collect()
}

fn no_force_above_the_offset<const D: usize>() {
    // At the offset itself the positions of points on elements of order 2 have round-off, which the law would see.
    for height in [OFFSET * (1.0 + 1e-14), 0.2] {
        over_ground::<D>(height, penalty(), &|_, scene, contact| {
            let x = vec![0.0; scene.layout.len()];
            assert!(residual(contact, &x).iter().all(|&r| r == 0.0));
            let report = report_of(contact, &x);
            assert!(!report.is_active() && report.force.norm() == 0.0 && report.stored_energy == 0.0);
            assert!((report.minimum_gap.unwrap() - height).abs() < 1e-15);
        });
    }
}

#[test]
fn no_force_above_the_offset_in_2d_and_3d() {
    no_force_above_the_offset::<2>();
    no_force_above_the_offset::<3>();
}

/// Checks that the force on the base of a block that sinks rigidly is that of the law times its area.
fn resultant_is_law_times_area<const D: usize>() {
    let height = 0.2;
    let sunk = -0.01;
    over_ground::<D>(height, penalty(), &|body, scene, contact| {
        let mut velocity = Vector::zeros();
        velocity[D - 1] = (sunk - height) / DT;
        let x = velocities(body, |_| velocity);
        let base: Vec<_> = body.surface().facets().filter(|&f| is_base(body, f)).collect();
        let pair = ContactPair { facets: &base, ..contact.pair.clone() };
        let items = ContactItems::new(&pair, &scene.layout, 0.0);
        let contact = ContactSites { items: &items, pair, layout: &scene.layout };
        let report = report_of(&contact, &x);
        let pressure = GAMMA / SIZE * (OFFSET - sunk);
        assert!((report.active_area - 1.0).abs() < 1e-13);
        assert!(
            (report.force[D - 1] - pressure).abs() < 1e-12 * pressure && report.force.amax() == report.force[D - 1]
        );
        assert!((report.powers[0] - pressure * velocity[D - 1]).abs() < 1e-11 * pressure * velocity.norm());
        let energy = 0.5 * GAMMA / SIZE * (OFFSET - sunk).powi(2);
        assert!((report.stored_energy - energy).abs() < 1e-12 * energy);
        assert!((report.largest_penetration - (OFFSET - sunk)).abs() < 1e-14);
        assert!((report.minimum_gap.unwrap() - sunk).abs() < 1e-14);
        let force: Vector<D> = residual(&contact, &x).chunks_exact(D).map(Vector::from_column_slice).sum();
        assert!((force + report.force).norm() < 1e-12 * pressure);
    });
}

fn is_base<const D: usize>(body: &ElasticBody<D>, facet: FacetId) -> bool {
    body.solid().mesh().tag("bottom") == body.surface().tag(facet)
}

#[test]
fn resultant_is_law_times_area_in_2d_and_3d() {
    resultant_is_law_times_area::<2>();
    resultant_is_law_times_area::<3>();
}

/// Checks the tangent at random states in which at least `n` active points meet a condition.
fn tangent_is_exact<const D: usize>(
    law: impl ContactLaw + Copy + 'static,
    n: usize,
    condition: fn(&ContactPoint) -> bool,
    (step, tolerance): (f64, f64),
) {
    for seed in 0..4 {
        over_ground::<D>(0.03, law, &|_, scene, contact| {
            // The numbers of a field in front of the body come first.
            let x = numbers(&mut SplitMix64::seed_from_u64(seed), 4 + scene.layout.len(), 3.0).split_off(4);
            let found = n_active(contact, &x, condition);
            assert!(found >= n, "{found} points");
            let deviation = check_tangent(&work(contact.clone()), &x, step);
            assert!(deviation < tolerance, "{deviation:e}");
        });
    }
}

#[test]
fn tangent_is_exact_in_2d_and_3d() {
    tangent_is_exact::<2>(penalty(), 1, |_| true, (1e-7, 1e-8));
    tangent_is_exact::<3>(penalty(), 1, |_| true, (1e-7, 1e-8));
}

#[test]
fn tangent_with_stress_is_exact() {
    let law = NitscheLaw::new(0.5, 0.2, 0.0).unwrap();
    tangent_is_exact::<2>(law, 8, |at| at.stress[0].abs() > 1.0, (1e-6, 1e-7));
    tangent_is_exact::<3>(law, 8, |at| at.stress[0].abs() > 1.0, (1e-6, 1e-7));
}

#[test]
fn tangent_with_friction_is_exact() {
    let law = NitscheLaw::new(0.5, 0.2, 0.4).unwrap();
    tangent_is_exact::<2>(law, 4, |at| at.slip[0].abs() > 1e-3, (1e-6, 1e-7));
    tangent_is_exact::<3>(law, 8, |at| at.slip.iter().all(|slip| slip.abs() > 1e-3), (1e-6, 1e-7));
}

/// Checks the tangent with the tractions of one state as multipliers at another one.
fn tangent_with_multipliers_is_exact<const D: usize>() {
    let law = AugmentedLagrangianLaw::new(0.1, OFFSET, 0.4, 1e-6).unwrap();
    over_ground::<D>(0.03, law, &|_, scene, contact| {
        let states: [Vec<f64>; 2] =
            [1, 2].map(|seed| numbers(&mut SplitMix64::seed_from_u64(seed), scene.layout.len(), 3.0));
        let [before, x] = &states;
        let multipliers = contact.multipliers(before).unwrap();
        let mut items = contact.items.clone();
        items.set_multipliers(&mut &multipliers.components[..]);
        let augmented = ContactSites { items: &items, ..contact.clone() };
        let pressed = n_active(&augmented, x, |at| at.stress[0] < 0.0 && at.slip[0].abs() > 1e-3);
        assert!(pressed >= 4 && multipliers.change > 0.0, "{pressed} points");
        let deviation = check_tangent(&work(augmented.clone()), x, 1e-6);
        assert!(deviation < 1e-7, "{deviation:e}");
    });
}

#[test]
fn tangent_with_multipliers_is_exact_in_2d_and_3d() {
    tangent_with_multipliers_is_exact::<2>();
    tangent_with_multipliers_is_exact::<3>();
}

#[test]
fn regime_is_the_active_set() {
    over_ground::<2>(0.1, penalty(), &|body, _, contact| {
        let at = |height: f64, tilt: f64| {
            let x = velocities(body, |p| Vector::<2>::new(0.0, (height - 0.1 + tilt * p[0]) / DT));
            regime_of(&work(contact.clone()), &x)
        };
        assert_eq!(at(0.3, 0.0), at(0.1, 0.2));
        assert_ne!(at(0.3, 0.0), at(0.04, 0.0));
        assert_eq!(at(0.04, 0.0), at(0.035, 0.0));
        assert_ne!(at(0.04, 0.1), at(0.04, -0.1));
    });
}

#[test]
fn nonsense_is_refused() {
    over_ground::<2>(0.1, penalty(), &|body, _, _| {
        let (slave, ground) = (body.surface(), ground());
        let check = |facet, obstacle: &dyn Obstacle<2>, master: Option<&BoundaryMesh<2>>| {
            check_pair(slave, &[FacetId(facet)], obstacle, master)
        };
        let block = DeformableObstacle::new(slave.clone(), slave.facets().collect()).unwrap();
        let other = BoundaryMesh::from_facets(slave.facet(FacetId(0)).to_vec());
        assert_eq!((check(0, &ground, None), check(0, &block, Some(slave))), (Ok(()), Ok(())));
        assert!(matches!(check(1000, &ground, None), Err(Error::UnknownFacet { .. })));
        assert_eq!(check(0, &ground, Some(slave)), Err(Error::Master));
        assert_eq!(check(0, &block, None), Err(Error::Master));
        assert_eq!(check(0, &block, Some(&other)), Err(Error::Master));
        let unknown = DeformableObstacle::new(slave.clone(), vec![FacetId(1000)]);
        assert!(matches!(unknown, Err(Error::UnknownFacet { .. })));
        for size in [0.0, -1.0, f64::NAN] {
            assert!(matches!(ContactForm::<2>::new(penalty(), size), Err(Error::Parameter(_))));
        }
    });
}

//! Static patch tests: uniform pressure between a block and a plane, and between two blocks.

use std::sync::Arc;

use algebra::time::QuasiStatic;
use body::{Body, BodyState};
use contact::{ContactForm, ContactLaw, ContactReport, DeformableObstacle, NitscheLaw, PenaltyLaw, RigidPlane};
use mesh::generate::structured_box;
use mesh::{Point, Vector};
use solid_svk::supports::{Support, SupportKind, tagged_facets};
use solid_svk::{ElasticOptions, Order, SolidMesh};

use crate::setting::{Scene, block_of, elastic, soft};

const SIZE: f64 = 0.1;
/// `4 μ (λ + μ)/(λ + 2 μ)` of [`soft`].
const MODULUS: f64 = 400.0 / 3.0;

/// Returns the nominal pressure of a bar in plane strain at a stretch: `E/(1 - ν²) l (1 - l²)/2`.
fn pressure_at(stretch: f64) -> f64 {
    -MODULUS * stretch * (stretch * stretch - 1.0) / 2.0
}

fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let sign = f(low).signum();
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle).signum() == sign { low = middle } else { high = middle }
    }
    low
}

/// Returns a support with a prescribed displacement along the last axis.
fn pushed_by<const D: usize>(displacement: f64) -> SupportKind<D> {
    SupportKind::Displacement(Arc::new(move |_, _| std::array::from_fn(|a| (a + 1 == D).then_some(displacement))))
}

/// Returns the options of a quasi-static body that is supported on tagged parts of its boundary.
fn supported<const D: usize>(parts: Vec<(&str, SupportKind<D>)>) -> impl FnOnce(&SolidMesh<D>) -> ElasticOptions<D> {
    move |solid| {
        let support = |(name, kind)| Support {
            vertices: solid.boundary().vertices_of(&tagged_facets(solid, name).unwrap()),
            kind,
        };
        let supports = parts.into_iter().map(support).collect();
        ElasticOptions { supports, ..ElasticOptions::default() }
    }
}

/// Offset of the law and displacement of the top of [`pushed_block`].
const OFFSET: f64 = 0.02;
const PUSHED: f64 = 0.05;

/// Returns a unit block of order 2 whose nodes on the edges of elements are shifted along the lower side, by different
/// fractions of their distance from its ends.
fn unevenly_divided() -> SolidMesh<2> {
    let mesh = structured_box([0.0, 0.0], [1.0, 1.0], [4, 3]).unwrap();
    SolidMesh::curved(mesh, |_, x| x + Vector::<2>::new(0.1 * x[0] * (1.0 - x[0]), 0.0)).unwrap()
}

/// Pushes a unit block onto a plane. Returns the report, the displacement of each vertex with its reference position,
/// and the number of iterations.
fn pushed_block(
    solid: SolidMesh<2>,
    law: impl ContactLaw + 'static,
) -> (ContactReport<2>, Vec<(Point<2>, Vector<2>)>, usize) {
    let supports = vec![("left", SupportKind::symmetry(0)), ("top", pushed_by(-PUSHED))];
    let bodies = [elastic(solid, soft(), supported(supports))];
    let states = [bodies[0].initial()];
    let scene = Scene::new(&bodies, &states, &QuasiStatic, 1.0);
    let form = ContactForm::new(law, SIZE).unwrap();
    let plane = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).unwrap();
    let facets = tagged_facets(bodies[0].solid(), "bottom").unwrap();
    let (found, end, iterations) = scene.advance(scene.pair(&form, &facets, &plane), 0.0, 1e-12);
    let moved = bodies[0].reference().iter().copied().zip(end[0].displacement().iter().copied());
    (found, moved.collect(), iterations)
}

#[test]
fn block_on_a_plane() {
    let mesh = structured_box([0.0, 0.0], [1.0, 1.0], [4, 3]).unwrap();
    let iterations = is_uniform_on_a_plane(SolidMesh::new(mesh).unwrap());
    assert!(iterations < 12, "{iterations}");
    is_uniform_on_a_plane(unevenly_divided());
}

/// Checks a block on a plane. Returns the number of iterations.
fn is_uniform_on_a_plane(solid: SolidMesh<2>) -> usize {
    // With an offset. The penetration is uniform and so is the pressure.
    let gamma = 1e3;
    let (found, moved, iterations) = pushed_block(solid, PenaltyLaw::new(gamma, OFFSET).unwrap());
    let gap = |stretch: f64| 1.0 - PUSHED - stretch;
    let stretch = bisect(0.8, 1.0, |l| pressure_at(l) - gamma / SIZE * (OFFSET - gap(l)));
    assert!((found.force[1] - pressure_at(stretch)).abs() < 1e-9 && found.force[0].abs() < 1e-9);
    assert!((found.minimum_gap.unwrap() - gap(stretch)).abs() < 1e-12);
    assert!((found.largest_penetration - (OFFSET - gap(stretch))).abs() < 1e-12);
    let lateral = (1.0 - (stretch * stretch - 1.0) / 3.0).sqrt();
    for (reference, d) in moved {
        let exact = Vector::<2>::new((lateral - 1.0) * reference[0], -PUSHED + (1.0 - stretch) * (1.0 - reference[1]));
        assert!((d - exact).norm() < 1e-10, "{d} {exact}");
    }
    iterations
}

/// The stress replaces the penetration. A wrong sign of the stress passes the checks of derivatives, but not this one.
#[test]
fn a_consistent_law_keeps_the_offset() {
    let mut forces = Vec::new();
    for gamma_0 in [10.0, 1000.0] {
        let (found, moved, _) = pushed_block(unevenly_divided(), NitscheLaw::new(gamma_0, OFFSET, 0.0).unwrap());
        let stretch = 1.0 - PUSHED - OFFSET;
        assert!((found.minimum_gap.unwrap() - OFFSET).abs() < 1e-11, "{found:?}");
        assert!((found.force[1] - pressure_at(stretch)).abs() < 1e-9 * found.force[1], "{found:?}");
        let lateral = (1.0 - (stretch * stretch - 1.0) / 3.0).sqrt();
        for (reference, d) in moved {
            let exact = Vector::<2>::new((lateral - 1.0) * reference[0], OFFSET + (stretch - 1.0) * reference[1]);
            assert!((d - exact).norm() < 1e-11, "{d} {exact}");
        }
        forces.push(found.force[1]);
    }
    assert!((forces[0] - forces[1]).abs() < 1e-9 * forces[0], "{forces:?}");
}

/// Pushes two unit blocks together, one on the other, with a penalty or else by Nitsche's law with an offset. Returns
/// the largest deviation of the displacement from the uniform state.
fn two_blocks<const D: usize>(order: Order, gamma: Option<f64>, n_slave: usize, n_master: usize) -> f64 {
    let pushed = 0.01;
    // Free sides: Young's modulus and Poisson's ratio, those of plane strain in 2D.
    let (modulus, ratio) = if D == 2 { (MODULUS, 1.0 / 3.0) } else { (125.0, 0.25) };
    let pressure_at = |stretch: f64| -modulus * stretch * (stretch * stretch - 1.0) / 2.0;
    let above = |bottom: f64| std::array::from_fn::<f64, D, _>(|a| if a + 1 == D { bottom } else { 0.0 });
    let below = |top: f64| std::array::from_fn::<f64, D, _>(|a| if a + 1 == D { top } else { 1.0 });
    let supports = |last| {
        let sides = ["left", "front"][..D - 1].iter().zip(0..);
        let symmetric = sides.map(|(side, axis)| (*side, SupportKind::symmetry(axis)));
        supported(symmetric.chain([last]).collect())
    };
    // Over the end of the master, normals turn within the gap: without an offset, at once.
    let offset = if gamma.is_none() { OFFSET } else { 0.0 };
    let bodies = [
        block_of(
            order,
            (above(1.0 + offset), below(2.0 + offset)),
            [n_slave; D],
            soft(),
            supports(("top", pushed_by(-pushed))),
        ),
        block_of(order, (above(0.0), below(1.0)), [n_master; D], soft(), supports(("bottom", pushed_by(0.0)))),
    ];
    let states: Vec<BodyState<D>> = bodies.iter().map(Body::initial).collect();
    let scene = Scene::new(&bodies, &states, &QuasiStatic, 1.0);
    let form = match gamma {
        Some(gamma) => ContactForm::new(PenaltyLaw::new(gamma, 0.0).unwrap(), SIZE),
        None => ContactForm::new(NitscheLaw::new(10.0, offset, 0.0).unwrap(), SIZE),
    };
    let form = form.unwrap();
    let top = tagged_facets(bodies[1].solid(), "top").unwrap();
    let obstacle = DeformableObstacle::new(bodies[1].surface().clone(), top).unwrap();
    let facets = tagged_facets(bodies[0].solid(), "bottom").unwrap();
    let (found, end, _) = scene.advance(scene.pair(&form, &facets, &obstacle), 0.1, 1e-12);
    let gap = |stretch: f64| 2.0 - pushed - 2.0 * stretch;
    let penalty = |gamma: f64| bisect(0.99, 1.0, |l| pressure_at(l) + gamma / SIZE * gap(l));
    let stretch = gamma.map_or(1.0 - 0.5 * pushed, penalty);
    // Pressure of linear elasticity (half the strain of the pile), up to the strain and the compliance of the penalty.
    assert!((pressure_at(stretch) / (modulus * 0.005) - 1.0).abs() < 0.015);
    assert!((found.force[D - 1] - pressure_at(stretch)).abs() < 1e-9 * found.force[D - 1]);
    let lateral = (1.0 - (stretch * stretch - 1.0) * ratio).sqrt();
    let mut deviation = 0.0_f64;
    for ((body, end), (fixed, moved)) in bodies.iter().zip(&end).zip([(2.0 + offset, -pushed), (0.0, 0.0)]) {
        for (at, d) in body.reference().iter().zip(end.displacement()) {
            let exact = Vector::<D>::from_fn(|a, _| {
                if a + 1 == D { moved + (stretch - 1.0) * (at[a] - fixed) } else { (lateral - 1.0) * at[a] }
            });
            deviation = deviation.max((d - exact).norm() / pushed);
        }
    }
    deviation
}

#[test]
fn two_blocks_pass_the_patch_test_whether_meshes_match_or_not() {
    for (order, gamma) in
        [Order::Linear, Order::Quadratic].into_iter().flat_map(|order| [(order, Some(1e4)), (order, None)])
    {
        let largest = 16 / order.degree().pow(2);
        for (n_slave, n_master) in [(3, 3), (4, 2), (4, 3), (3, 4), (2, 5), (largest, 3)] {
            let deviation = two_blocks::<2>(order, gamma, n_slave, n_master);
            assert!(deviation < 1e-9, "{n_slave} on {n_master}, {order:?}: {deviation:e}");
        }
        for (n_slave, n_master) in [(2, 2), (3, 2), (2, 3)] {
            let n = |n: usize| n.div_ceil(order.degree());
            let deviation = two_blocks::<3>(order, gamma, n(n_slave), n(n_master));
            assert!(deviation < 1e-9, "{n_slave} on {n_master} in space, {order:?}: {deviation:e}");
        }
    }
}

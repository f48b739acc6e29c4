//! Static patch tests: uniform pressure between a block and a plane, and between two blocks.

use algebra::{BlockLayout, Contributions, DofId};
use contact::{ContactFacets, ContactForm, ContactPair, ContactReport, DeformableObstacle, Penalty, RigidPlane};
use mesh::{Point, Vector};
use solid_svk::SolidCells;
use solid_svk::boundary::{Support, support_values, tagged_facets, vertices_of};

use crate::setting::{Body, Problem, soft};

const SIZE: f64 = 0.1;
/// `4 μ (λ + μ)/(λ + 2 μ)` of [`soft`].
const MODULUS: f64 = 400.0 / 3.0;

/// Nominal pressure of a bar in plane strain at a stretch: `E/(1 - ν²) l (1 - l²)/2`.
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

fn supports<const D: usize>(
    body: &Body<D>,
    layout: &BlockLayout,
    list: &[(&str, Support<'_, D>)],
) -> Vec<(DofId, f64)> {
    let mut values = Vec::new();
    for &(name, support) in list {
        let vertices = vertices_of(&body.solid, &tagged_facets(&body.solid, name).unwrap());
        values.extend(support_values(&body.solid, &vertices, support, &body.step(1.0), layout, body.field).unwrap());
    }
    values
}

#[test]
fn block_on_a_plane() {
    // With an offset. The penetration is uniform and so is the pressure.
    let (gamma, offset, pushed) = (1e3, 0.02, 0.05);
    let mut layout = BlockLayout::new();
    let body = Body::block(&mut layout, [0.0, 0.0], [1.0, 1.0], [4, 3], soft());
    let step = body.step(1.0);
    let cells = SolidCells::new(&body.solid, &body.form, &step, &layout, body.field).unwrap();
    let work = cells.internal_work();
    let form = ContactForm::new(Penalty::new(gamma, offset).unwrap(), SIZE).unwrap();
    let plane = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).unwrap();
    let positions = body.positions();
    let facets = tagged_facets(&body.solid, "bottom").unwrap();
    let slave = body.contact(&positions, 1.0, &layout);
    let pair = ContactPair { slave, facets: &facets, obstacle: &plane, master: None, reach: 0.0 };
    let contact = ContactFacets::new(&form, pair).unwrap();
    let down = |_: &Point<2>| [None, Some(-pushed)];
    let values =
        supports(&body, &layout, &[("left", Support::Symmetry { axis: 0 }), ("top", Support::Displacement(&down))]);
    let problem = Problem {
        layout: &layout,
        solids: vec![&work],
        contacts: vec![&contact],
        constraints: values.into_iter().collect(),
    };
    let mut x = vec![0.0; layout.len()];
    let report = problem.solve(&mut x, 1e-12);
    assert!(report.iterations < 12, "{report:?}");
    let gap = |stretch: f64| 1.0 - pushed - stretch;
    let stretch = bisect(0.8, 1.0, |l| pressure_at(l) - gamma / SIZE * (offset - gap(l)));
    let found = ContactReport::new(&contact, &x);
    assert!((found.force[1] - pressure_at(stretch)).abs() < 1e-9 && found.force[0].abs() < 1e-9);
    assert!((found.minimum_gap.unwrap() - gap(stretch)).abs() < 1e-12);
    assert!((found.largest_penetration - (offset - gap(stretch))).abs() < 1e-12);
    let lateral = (1.0 - (stretch * stretch - 1.0) / 3.0).sqrt();
    for (reference, d) in body.solid.mesh().vertices().iter().zip(body.solid.velocity(&layout, body.field, &x).unwrap())
    {
        let exact = Vector::<2>::new((lateral - 1.0) * reference[0], -pushed + (1.0 - stretch) * (1.0 - reference[1]));
        assert!((d - exact).norm() < 1e-10, "{d} {exact}");
    }
}

/// Two unit blocks, one on the other, pushed together: largest deviation of the displacement from the uniform state.
fn two_blocks<const D: usize>(n_slave: usize, n_master: usize) -> f64 {
    let (gamma, pushed) = (1e4, 0.01);
    // Free sides: Young's modulus and Poisson's ratio, those of plane strain in 2D.
    let (modulus, ratio) = if D == 2 { (MODULUS, 1.0 / 3.0) } else { (125.0, 0.25) };
    let pressure_at = |stretch: f64| -modulus * stretch * (stretch * stretch - 1.0) / 2.0;
    let above = |bottom: f64| std::array::from_fn::<f64, D, _>(|a| if a + 1 == D { bottom } else { 0.0 });
    let below = |top: f64| std::array::from_fn::<f64, D, _>(|a| if a + 1 == D { top } else { 1.0 });
    let mut layout = BlockLayout::new();
    let upper = Body::<D>::block(&mut layout, above(1.0), below(2.0), [n_slave; D], soft());
    let lower = Body::<D>::block(&mut layout, above(0.0), below(1.0), [n_master; D], soft());
    let steps = [upper.step(1.0), lower.step(1.0)];
    let cells = [&upper, &lower].map(|b| {
        let step = &steps[usize::from(b.field == lower.field)];
        SolidCells::new(&b.solid, &b.form, step, &layout, b.field).unwrap().internal_work()
    });
    let form = ContactForm::new(Penalty::new(gamma, 0.0).unwrap(), SIZE).unwrap();
    let top = tagged_facets(&lower.solid, "top").unwrap();
    let obstacle = DeformableObstacle::new(lower.solid.boundary().clone(), top).unwrap();
    let positions = [upper.positions(), lower.positions()];
    let facets = tagged_facets(&upper.solid, "bottom").unwrap();
    let pair = ContactPair {
        slave: upper.contact(&positions[0], 1.0, &layout),
        facets: &facets,
        obstacle: &obstacle,
        master: Some(lower.contact(&positions[1], 1.0, &layout)),
        reach: 0.1,
    };
    let contact = ContactFacets::new(&form, pair).unwrap();
    let down = |_: &Point<D>| std::array::from_fn(|a| (a + 1 == D).then_some(-pushed));
    let sides: Vec<_> =
        ["left", "front"][..D - 1].iter().zip(0..).map(|(s, axis)| (*s, Support::Symmetry { axis })).collect();
    let mut values = supports(&upper, &layout, &[&sides[..], &[("top", Support::Displacement(&down))]].concat());
    values.extend(supports(&lower, &layout, &[&sides[..], &[("bottom", Support::Symmetry { axis: D - 1 })]].concat()));
    let solids: Vec<&dyn Contributions> = vec![&cells[0], &cells[1]];
    let constraints = values.into_iter().collect();
    let mut x = vec![0.0; layout.len()];
    Problem { layout: &layout, solids, contacts: vec![&contact], constraints }.solve(&mut x, 1e-12);
    let gap = |stretch: f64| 2.0 - pushed - 2.0 * stretch;
    let stretch = bisect(0.99, 1.0, |l| pressure_at(l) + gamma / SIZE * gap(l));
    // Pressure of linear elasticity (half the strain of the pile), up to the strain and the compliance of the penalty.
    assert!((pressure_at(stretch) / (modulus * 0.005) - 1.0).abs() < 0.015);
    let found = ContactReport::new(&contact, &x);
    assert!((found.force[D - 1] - pressure_at(stretch)).abs() < 1e-9 * found.force[D - 1]);
    let lateral = (1.0 - (stretch * stretch - 1.0) * ratio).sqrt();
    let mut deviation = 0.0_f64;
    for body in [&upper, &lower] {
        let displacement = body.solid.velocity(&layout, body.field, &x).unwrap();
        for (at, d) in body.solid.mesh().vertices().iter().zip(displacement) {
            let (fixed, moved) = if body.field == lower.field { (0.0, 0.0) } else { (2.0, -pushed) };
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
    for (n_slave, n_master) in [(3, 3), (4, 2), (4, 3), (3, 4), (2, 5), (16, 3)] {
        let deviation = two_blocks::<2>(n_slave, n_master);
        assert!(deviation < 1e-9, "{n_slave} on {n_master}: {deviation:e}");
    }
    for (n_slave, n_master) in [(2, 2), (3, 2), (2, 3)] {
        let deviation = two_blocks::<3>(n_slave, n_master);
        assert!(deviation < 1e-9, "{n_slave} on {n_master} in space: {deviation:e}");
    }
}

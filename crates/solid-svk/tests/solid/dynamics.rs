//! Balances in time: energy, momentum, rigid motion, free fall.

use std::sync::Arc;

use crate::setting::{
    ORDERS, advance, at_rest, ball_material, curved, distorted, level, padded_layout, residual, round_disk, rule,
    solve, state, unit_body, unit_mesh, vectors, weightless,
};
use algebra::time::{GeneralisedAlpha, ImplicitEuler, Level, QuasiStatic};
use algebra::{BlockLayout, Constraints};
use body::{Body, StepTime};
use mesh::generate::{BallOptions, ball};
use mesh::{FacetId, Point, Vector, VertexId};
use rand::SeedableRng;
use rand_xoshiro::SplitMix64;
use solid_svk::energy::balance;
use solid_svk::supports::tagged_facets;
use solid_svk::{
    ElasticBody, ElasticOptions, Error, LameParameters, LinearElastic, Load, Material, Order, SolidCells, SolidForm,
    SolidMesh, Support, SupportKind,
};

#[test]
fn free_vibration_loses_energy_and_keeps_momentum() {
    let mesh = || ball([0.0, 0.0], 4.0, 1.0, &BallOptions::default()).unwrap();
    vibrates_freely(&SolidMesh::new(mesh()).unwrap());
    vibrates_freely(&round_disk(mesh(), 4.0));
}

fn vibrates_freely(mesh: &SolidMesh<2>) {
    let form = weightless();
    let n = mesh.nodes().len();
    let stretched: Vec<_> = mesh.nodes().iter().map(|x| Vector::<2>::new(0.1 * x[0], -0.1 * x[1])).collect();
    let mut now = level(stretched, vec![Vector::<2>::new(3.0, -20.0); n]);
    let of = |level: &Level<Vector<2>>| balance(mesh, &form, &level.displacement, &level.velocity);
    let mut before = of(&now);
    let momentum = before.momentum;
    let start = before.energy();
    for _ in 0..20 {
        now = advance(mesh, &form, &ImplicitEuler, 1e-4, 1e-12, &now);
        let after = of(&now);
        assert!(after.energy() < before.energy() && after.smallest_volume_ratio > 0.8);
        assert!((after.momentum - momentum).norm() < 1e-11 * momentum.norm(), "{}", after.momentum - momentum);
        let moved = after.centre_of_mass - before.centre_of_mass;
        assert!((moved - momentum / after.mass * 1e-4).norm() < 1e-12);
        before = after;
    }
    assert!(before.energy() > 0.3 * start);
}

#[test]
fn balances_of_a_turning_and_rising_square() {
    for order in ORDERS {
        turns_and_rises(&distorted(4, order));
    }
}

fn turns_and_rises(mesh: &SolidMesh<2>) {
    let form = SolidForm::new(3.0, ball_material(), Vector::<2>::new(0.0, -10.0)).unwrap();
    let centre = Point::<2>::new(0.5, 0.5);
    let velocity: Vec<_> = mesh
        .nodes()
        .iter()
        .map(|x| Vector::<2>::new(-(x[1] - centre[1]), x[0] - centre[0]) * 2.0 + Vector::<2>::new(0.0, 7.0))
        .collect();
    let displacement = vec![Vector::<2>::new(1.0, 2.0); velocity.len()];
    let found = balance(mesh, &form, &displacement, &velocity);
    // Moment of inertia m/6, so 1/2 (m/6) 2² + 1/2 m 7².
    assert!((found.kinetic_energy - (1.0 + 1.5 * 49.0)).abs() < 1e-12);
    assert!((found.momentum - Vector::<2>::new(0.0, 21.0)).norm() < 1e-12);
    assert!((found.centre_of_mass - Point::<2>::new(1.5, 2.5)).norm() < 1e-13);
    assert!((found.potential_energy - 3.0 * 10.0 * 2.5).abs() < 1e-11);
    assert!((found.volume - 1.0).abs() < 1e-13 && (found.mass - 3.0).abs() < 1e-12);
    assert!(found.elastic_energy.abs() < 1e-20);
}

#[test]
fn mass_and_centre_of_a_round_disk_are_those_of_its_elements() {
    // Between two vertices the edge is a parabola through the node, whose area is 2/3 of chord and sagitta: the error
    // of the whole falls with the fourth power of the angle, against the second for a polygon.
    let options = BallOptions { area_preserving: false };
    let mesh = round_disk(ball([0.0, 0.0], 4.0, 1.0, &options).unwrap(), 4.0);
    let n = mesh.boundary().n_facets() as f64 / 2.0;
    let angle = std::f64::consts::PI / n;
    let area = n * 16.0 * (angle.sin() * angle.cos() + 4.0 / 3.0 * angle.sin() * (1.0 - angle.cos()));
    let rest = at_rest(&mesh);
    let found = balance(&mesh, &weightless(), &rest.displacement, &rest.velocity);
    assert!(
        (found.mass / area - 1.0).abs() < 1e-13 && (found.volume / area - 1.0).abs() < 1e-13,
        "{} {area}",
        found.mass
    );
    assert!(found.centre_of_mass.norm() < 1e-12, "{}", found.centre_of_mass);
    assert!((area / (16.0 * std::f64::consts::PI) - 1.0).abs() < 0.3 * angle.powi(4));
}

#[test]
fn kinetic_energy_is_that_of_the_mass_matrix() {
    kinetic_energy_is_half_of_v_m_v(&unit_body(2));
    kinetic_energy_is_half_of_v_m_v(&curved(2));
}

fn kinetic_energy_is_half_of_v_m_v(mesh: &SolidMesh<3>) {
    let form = weightless();
    let (layout, field) = padded_layout(mesh);
    let rest = at_rest(mesh);
    let velocity = vectors::<3>(&mut SplitMix64::seed_from_u64(5), mesh.nodes().len(), 10.0);
    let rule = rule(&ImplicitEuler, 0.5, &rest);
    let inertia =
        form.inertia_and_body_force(SolidCells { solid: mesh, rule: &rule, layout: &layout, velocity: field });
    let x = state(&layout, field, &velocity);
    // The residual is M v/dt.
    let power: f64 = residual(&layout, &[&inertia], &x).iter().zip(&x).map(|(r, v)| r * v).sum();
    let found = balance(mesh, &form, &rest.displacement, &velocity);
    assert!((0.5 * 0.5 * power - found.kinetic_energy).abs() < 1e-12 * found.kinetic_energy);
}

#[test]
fn tractions_are_those_of_position_and_time_of_the_stage() {
    let mesh = unit_body::<2>(1);
    let facets = solid_svk::supports::tagged_facets(&mesh, "top").unwrap();
    let traction = |x: &Point<2>, t: f64| Vector::<2>::new(x[0] * t, x[1]);
    let options =
        ElasticOptions { loads: vec![Load::traction(facets, Arc::new(traction))], ..ElasticOptions::default() };
    let body = ElasticBody::new("body", mesh, weightless(), options).unwrap();
    let (start, mut layout) = (body.initial(), BlockLayout::new());
    let step = body.step(&start, &StepTime::new(&GeneralisedAlpha::new(0.5).unwrap(), 5.0, 3.0, false), &mut layout);
    let all = step.loads(&layout);
    let load = all.iter().find(|all| all.name() == "solid traction").unwrap();
    let force = residual(&layout, &[load.as_ref()], &vec![0.0; layout.len()]);
    // The stage lies a third of the step before its end; each end of the side carries half of it.
    for (x, force) in body.reference().iter().zip(force.chunks(2)) {
        let expected = if x[1] == 1.0 { traction(x, 4.0) * -0.5 } else { Vector::zeros() };
        assert!((Vector::<2>::new(force[0], force[1]) - expected).norm() < 1e-14, "{x}: {force:?}");
    }
}

#[test]
fn nonsense_is_refused() {
    let body = |options: ElasticOptions<2>| ElasticBody::new("body", unit_body(1), weightless(), options).map(|_| ());
    let support = |vertex: u32, kind| ElasticOptions {
        supports: vec![Support { vertices: vec![VertexId(vertex)], kind }],
        ..ElasticOptions::default()
    };
    let loaded = |facet| {
        let load = Load::pressure(vec![FacetId(facet)], 1.0);
        body(ElasticOptions { loads: vec![load], ..ElasticOptions::default() })
    };
    assert!(body(support(3, SupportKind::symmetry(1))).is_ok() && loaded(3).is_ok());
    assert!(matches!(body(support(4, SupportKind::Clamped)), Err(Error::UnknownVertex { n_vertices: 4, .. })));
    assert!(matches!(body(support(3, SupportKind::symmetry(2))), Err(Error::Parameter(_))));
    assert!(matches!(loaded(4), Err(Error::UnknownFacet { n_facets: 4, .. })));
    assert!(SolidForm::new(-1.0, ball_material(), Vector::<2>::zeros()).is_err());
    let unknown = solid_svk::supports::tagged_facets(&unit_body::<2>(1), "nowhere");
    assert!(matches!(unknown, Err(Error::UnknownTag { .. })));
}

#[test]
fn groups_of_cells_have_their_density_and_material() {
    for order in ORDERS {
        layers_have_their_density_and_material(order);
    }
}

/// Checks two layers between a held and a pulled side, without lateral strain: the stress `(λ + 2 μ) e` is the same in
/// both.
fn layers_have_their_density_and_material(order: Order) {
    let solid = SolidMesh::<2>::of_order(unit_mesh(4), order).unwrap();
    assert!(matches!(solid.clone().with_groups(vec![0; 3]), Err(Error::Groups { found: 3, n_cells: 32 })));
    let group = |cell| usize::from(solid.mesh().simplex(cell).centroid()[1] > 0.5);
    let groups = solid.mesh().cells().map(group).collect();
    let solid = solid.with_groups(groups).unwrap();
    let law = |mu: f64| LinearElastic::new(LameParameters::new(mu, 2.0).unwrap());
    let form = SolidForm::new(3.0, law(1.0), Vector::<2>::zeros()).unwrap();
    let alone = ElasticBody::new("body", solid.clone(), form, ElasticOptions::default()).map(|_| ());
    assert!(matches!(alone, Err(Error::MissingMaterial { found: 1, n_groups: 2 })));
    let groups: Vec<(f64, Arc<dyn Material<2>>)> = vec![(3.0, Arc::new(law(1.0))), (5.0, Arc::new(law(3.0)))];
    let form = SolidForm::of_groups(groups, Vector::zeros()).unwrap();
    // Strains 2/3 and 1/3 of the pull: stiffness 4 and 8.
    let support = |part: &str, kind| Support {
        vertices: solid.boundary().vertices_of(&tagged_facets(&solid, part).unwrap()),
        kind,
    };
    let pulled = Arc::new(|_: &Point<2>, _| [Some(0.0), Some(0.03)]);
    let side = || SupportKind::symmetry(0);
    let supports = vec![
        support("left", side()),
        support("right", side()),
        support("bottom", SupportKind::Clamped),
        support("top", SupportKind::Displacement(pulled)),
    ];
    let body = ElasticBody::new("body", solid, form, ElasticOptions { supports, ..ElasticOptions::default() }).unwrap();
    let (start, mut layout) = (body.initial(), BlockLayout::new());
    layout.push("other", 5, 1);
    let step = body.step(&start, &StepTime::new(&QuasiStatic, 1.0, 1.0, true), &mut layout);
    let mut constraints = Constraints::new();
    step.constrain(&layout, &mut constraints);
    let mut x = vec![0.0; layout.len()];
    solve(&layout, step.contributions(&layout), constraints, &mut x, 1e-12);
    let end = step.end(&layout, &x);
    for (x, d) in body.reference().iter().zip(end.displacement()) {
        let expected = 0.04 * x[1].min(0.5) + 0.02 * (x[1] - 0.5).max(0.0);
        assert!((d - Vector::<2>::new(0.0, expected)).norm() < 1e-13, "{x} {d}");
    }
    assert!(body.cells(&end).unwrap().stress.iter().all(|stress| (stress.cauchy[(1, 1)] / 0.16 - 1.0).abs() < 1e-10));
    let found = body.balance(&end).unwrap();
    // Energy: half the stress 0.16 times the displacement 0.03.
    assert!((found.mass - 4.0).abs() < 1e-13 && (found.elastic_energy - 0.0024).abs() < 1e-15, "{found:?}");
}

/// The ovalisation of the paper's ball in vacuum: ω r/c_s = 2.35106 for ν = 0.4 (root of the frequency determinant of a
/// free disk in plane strain), which is 132.29 Hz.
#[test]
fn disk_oscillates_with_its_own_frequency() {
    let mesh = |size: f64, area_preserving| ball([0.0, 0.0], 4.0, size, &BallOptions { area_preserving }).unwrap();
    oscillates_with_its_own_frequency(&SolidMesh::new(mesh(0.6, true)).unwrap(), 450, 0.01);
    oscillates_with_its_own_frequency(&round_disk(mesh(1.6, false), 4.0), 900, 0.005);
}

fn oscillates_with_its_own_frequency(mesh: &SolidMesh<2>, n_steps: u32, tolerance: f64) {
    let dt = 0.036 / f64::from(n_steps);
    let form = weightless();
    let n = mesh.nodes().len();
    let oval = |x: &Point<2>| Vector::<2>::new(x[0], -x[1]) * 1e-3;
    let mut now = level(mesh.nodes().iter().map(oval).collect(), vec![Vector::<2>::zeros(); n]);
    // Implicit Euler damps the higher modes that the start contains as well; the last period is nearly pure.
    // The difference of the second moments along the axes oscillates.
    let mut mass = vec![0.0; n];
    for cell in mesh.mesh().cells() {
        let nodes = mesh.cell(cell);
        for (i, row) in nodes.iter().zip(mesh.mass(cell).chunks_exact(nodes.len())) {
            mass[i.index()] += row.iter().sum::<f64>();
        }
    }
    let ovalisation = |level: &Level<Vector<2>>| -> f64 {
        let moments = mesh.nodes().iter().zip(&level.displacement).map(|(x, d)| x[0] * d[0] - x[1] * d[1]);
        moments.zip(&mass).map(|(moment, mass)| moment * mass).sum()
    };
    let (mut before, mut crossings) = (ovalisation(&now), Vec::new());
    for k in 1..=n_steps {
        now = advance(mesh, &form, &ImplicitEuler, dt, 1e-9, &now);
        let after = ovalisation(&now);
        if after * before < 0.0 {
            crossings.push(dt * (f64::from(k) - after / (after - before)));
        }
        before = after;
    }
    let [.., first, _, last] = crossings[..] else { panic!("{crossings:?}") };
    let frequency = 1.0 / (last - first);
    assert!((frequency - 132.29).abs() < tolerance * 132.29, "{frequency}");
}

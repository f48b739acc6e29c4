//! Tangents and stresses against finite differences at random states.

use std::sync::Arc;

use crate::setting::{
    ORDERS, at_rest, ball_material, curved, distorted, numbers, padded_layout, quadratic_field, rule, state, unit_body,
    unit_mesh, vector, vectors,
};
use algebra::time::{GeneralisedAlpha, ImplicitEuler, Level, QuasiStatic, TimeScheme};
use algebra::{Contributions, Integral, Term, check_tangent};
use body::SurfaceStress;
use mesh::{Coordinates, Point, Tensor, Vector, VertexId};
use rand::SeedableRng;
use rand_xoshiro::SplitMix64;
use solid_svk::kinematics::{cauchy_stress, gradient};
use solid_svk::terms::{FollowerPressure, Traction};
use solid_svk::{CellPoint, Material, Order, SolidCells, SolidFacet, SolidFacets, SolidForm, SolidMesh, SolidStress};

fn schemes() -> [Box<dyn TimeScheme>; 3] {
    [Box::new(ImplicitEuler), Box::new(GeneralisedAlpha::new(0.8).unwrap()), Box::new(QuasiStatic)]
}

/// Returns a level with random displacement, velocity and acceleration.
fn random_level<const D: usize>(random: &mut SplitMix64, n: usize) -> Level<Vector<D>> {
    let [displacement, velocity, acceleration] = [0.02, 5.0, 200.0].map(|scale| vectors(random, n, scale));
    Level { displacement, velocity, acceleration }
}

fn tangents_are_exact<const D: usize>(mesh: &SolidMesh<D>) {
    let (layout, field) = padded_layout(mesh);
    let mut random = SplitMix64::seed_from_u64(7);
    let form = SolidForm::new(1.3, ball_material(), vector(&mut random) * 1e3).unwrap();
    let loads: [&dyn Term<SolidFacet<D>>; 2] =
        [&FollowerPressure { pressure: 3e5 }, &Traction { traction: Arc::new(|_, _| Vector::repeat(2.0)) }];
    let facets: Vec<_> = mesh.boundary().facets().collect();
    for scheme in schemes() {
        let rule = rule(scheme.as_ref(), 1e-2, &random_level(&mut random, mesh.nodes().len()));
        let cells = SolidCells { solid: mesh, rule: &rule, layout: &layout, velocity: field };
        let x = numbers(&mut random, layout.len(), 5.0);
        let (linear, work) = (form.inertia_and_body_force(cells), form.internal_work(cells));
        assert!(linear.is_linear() && !work.is_linear());
        let mut all: Vec<(&dyn Contributions, f64)> = vec![(&linear, 1e-10), (&work, 1e-6)];
        let sites = SolidFacets { cells, facets: &facets, time: 0.0 };
        let loads = loads.map(|term| Integral::new("load", sites, vec![term]));
        all.extend(loads.iter().map(|load| (load as &dyn Contributions, 1e-7)));
        for (contribution, tolerance) in all {
            let deviation = check_tangent(contribution, &x, 1e-4);
            assert!(deviation < tolerance, "{}: {deviation:e}", contribution.name());
        }
    }
}

#[test]
fn tangents_are_exact_in_2d_and_3d() {
    tangents_are_exact(&unit_body::<2>(2));
    tangents_are_exact(&unit_body::<3>(2));
    tangents_are_exact(&curved::<2>(2));
    tangents_are_exact(&curved::<3>(1));
}

/// Checks that the stress on the surface is the Cauchy stress times the current normal, at the stage, and its
/// derivatives.
fn stress_on_the_surface<const D: usize>(mesh: &SolidMesh<D>) {
    let (layout, field) = padded_layout(mesh);
    let mut random = SplitMix64::seed_from_u64(11);
    let material = ball_material();
    let mut worst = [0.0_f64; 2];
    for scheme in schemes() {
        let rule = rule(scheme.as_ref(), 1e-2, &random_level(&mut random, mesh.nodes().len()));
        let x = numbers(&mut random, layout.len(), 5.0);
        let velocity = layout.values(field, &x).map(Vector::<D>::from).enumerate();
        let displacement: Vec<_> = velocity.map(|(i, v)| rule.displacement.at(i, v)).collect();
        let positions: Vec<Point<D>> = mesh.nodes().iter().zip(&displacement).map(|(x, d)| x + d).collect();
        let stress = SolidStress {
            cells: SolidCells { solid: mesh, rule: &rule, layout: &layout, velocity: field },
            materials: &[Arc::new(material)],
            positions: &positions,
        };
        let (mut dofs, mut derivatives, mut unused) = (Vec::new(), Vec::new(), Vec::new());
        for facet in mesh.boundary().facets() {
            let found = stress.on(facet, &x, &mut derivatives);
            let cell = mesh.boundary().facet_to_cell(facet).unwrap();
            if mesh.order() == Order::Linear {
                let gradients = mesh.mesh().simplex(cell).barycentric_gradients().unwrap();
                let vertices = mesh.mesh().cell(cell).iter().zip(&gradients);
                let gradient: Tensor<D> = vertices.map(|(v, g)| displacement[v.index()] * g.transpose()).sum();
                let f = Tensor::identity() + gradient;
                let normal = mesh.placed(&positions).facet_normal(facet);
                let expected = cauchy_stress(&f, &material.first_piola(&f)) * normal;
                worst[0] = worst[0].max((found - expected).norm() / expected.norm());
            }
            dofs.clear();
            stress.dofs(facet, &mut dofs);
            assert!(dofs.len() == D * mesh.order().n_nodes(D) && derivatives.iter().map(|(dof, _)| dof).eq(&dofs));
            let largest = derivatives.iter().fold(0.0_f64, |largest, (_, derivative)| largest.max(derivative.norm()));
            for (dof, derivative) in &derivatives {
                let step = 1e-4 * (1.0 + x[dof.index()].abs());
                let mut at = |by: f64| {
                    let mut moved = x.clone();
                    moved[dof.index()] += by;
                    stress.on(facet, &moved, &mut unused)
                };
                let difference = (at(step) - at(-step)) / (2.0 * step);
                worst[1] = worst[1].max((difference - derivative).norm() / largest);
            }
        }
    }
    assert!(worst[0] < 1e-12 && worst[1] < 1e-7, "{worst:?}");
}

#[test]
fn stress_on_the_surface_in_2d_and_3d() {
    stress_on_the_surface(&unit_body::<2>(2));
    stress_on_the_surface(&unit_body::<3>(2));
    stress_on_the_surface(&curved::<2>(2));
    stress_on_the_surface(&curved::<3>(1));
}

/// Checks that the nominal stress on the surface of quadratic cells is that of a quadratic displacement in the middle
/// of each facet.
fn stress_of_a_quadratic_displacement<const D: usize>() {
    let mesh = distorted::<D>(2, Order::Quadratic);
    let (layout, field) = padded_layout(&mesh);
    let rule = rule(&QuasiStatic, 1.0, &at_rest(&mesh));
    let material = ball_material();
    let (cells, mut unused) = (SolidCells { solid: &mesh, rule: &rule, layout: &layout, velocity: field }, Vec::new());
    let bend = quadratic_field();
    let displacement: Vec<_> = mesh.nodes().iter().map(|x| bend.at(x)).collect();
    let stress = SolidStress { cells, materials: &[Arc::new(material)], positions: mesh.nodes() };
    let x = state(&layout, field, &displacement);
    for facet in mesh.boundary().facets() {
        let found = stress.on(facet, &x, &mut unused);
        let nodes = mesh.boundary().facet(facet);
        let middle: Point<D> = nodes.iter().map(|node| mesh.nodes()[node.index()] / D as f64).sum();
        let f = Tensor::identity() + bend.gradient(&middle);
        let normal = mesh.placed(mesh.nodes()).facet_normal(facet);
        let expected = material.first_piola(&f) * normal;
        assert!((found - expected).norm() < 1e-11 * 1e7, "{found} {expected}");
    }
}

#[test]
fn stress_of_a_quadratic_displacement_in_2d_and_3d() {
    stress_of_a_quadratic_displacement::<2>();
    stress_of_a_quadratic_displacement::<3>();
}

/// Checks the bound of the traction by the energy of a cell at rest: random fields stay below it, and a field along the
/// normal of a cell with one facet on the surface reaches it: a stretch, or one that varies along the normal.
fn trace_bound<const D: usize>(order: Order) {
    let mesh = SolidMesh::<D>::of_order(unit_mesh(2), order).unwrap();
    let (layout, field) = padded_layout(&mesh);
    let mut random = SplitMix64::seed_from_u64(3);
    let material = ball_material();
    let scheme = &schemes()[0];
    let rule = rule(scheme.as_ref(), 1e-2, &at_rest(&mesh));
    let (x, slope) = (vec![0.0; layout.len()], rule.displacement.slope);
    let cells = SolidCells { solid: &mesh, rule: &rule, layout: &layout, velocity: field };
    let stress = SolidStress { cells, materials: &[Arc::new(material)], positions: mesh.nodes() };
    let (mut derivatives, mut n_reached) = (Vec::new(), 0);
    let placed = mesh.placed(mesh.nodes());
    for facet in mesh.boundary().facets() {
        let cell = mesh.boundary().facet_to_cell(facet).unwrap();
        let normal = placed.facet_normal(facet);
        let of_cell: Vec<_> =
            mesh.boundary().facets().filter(|f| mesh.boundary().facet_to_cell(*f) == Some(cell)).collect();
        let mut ratio = |values: &[Vector<D>]| {
            let mut on_surface = 0.0;
            for facet in &of_cell {
                stress.on(*facet, &x, &mut derivatives);
                let values = values.iter().flat_map(|y| y.iter().copied());
                let traction: Vector<D> = derivatives.iter().zip(values).map(|((_, by), y)| by * y).sum();
                on_surface += placed.facet_measure(*facet) * traction.norm_squared();
            }
            let energy = |point: CellPoint<'_, D>| {
                let gradient = gradient(values, point.gradients);
                point.weight * material.first_piola_derivative(&Tensor::identity(), &gradient).dot(&gradient)
            };
            on_surface / (slope * mesh.points(cell).map(energy).sum::<f64>())
        };
        let bound = stress.trace_bound(facet);
        for _ in 0..20 {
            let values = vectors::<D>(&mut random, mesh.cell(cell).len(), 1.0);
            assert!(ratio(&values) <= bound * (1.0 + 1e-12));
        }
        if of_cell.iter().all(|other| (placed.facet_normal(*other) - normal).norm() < 1e-12) {
            n_reached += 1;
            // The stretch is 1 on the facet and -D/2 at the vertex opposite to it, which has the least energy.
            let distance = |node: &VertexId| {
                let origin = mesh.nodes()[mesh.boundary().facet(facet)[0].index()];
                (origin - mesh.nodes()[node.index()]).dot(&normal)
            };
            let height = mesh.cell(cell).iter().map(distance).fold(0.0, f64::max);
            let bend = if order == Order::Linear { 0.0 } else { (1.0 + 0.5 * D as f64) / (2.0 * height) };
            let along = |s: f64| normal * (s - bend * s * s);
            let values: Vec<_> = mesh.cell(cell).iter().map(|node| along(distance(node))).collect();
            assert!((ratio(&values) / bound - 1.0).abs() < 1e-12);
        }
    }
    assert!(n_reached > 0);
}

/// Checks that the bound is one over a length, with rotational symmetry as in the plane.
#[test]
fn the_bound_of_the_traction_is_that_of_a_length() {
    for coordinates in [Coordinates::Cartesian, Coordinates::Axisymmetric] {
        let bounds = [1.0, 2.0].map(|scale| {
            let mesh = unit_mesh::<2>(2).mapped(|x| x * scale).unwrap().with_coordinates(coordinates).unwrap();
            let mesh = SolidMesh::new(mesh).unwrap();
            let (layout, field) = padded_layout(&mesh);
            let rule = rule(schemes()[0].as_ref(), 1e-2, &at_rest(&mesh));
            let cells = SolidCells { solid: &mesh, rule: &rule, layout: &layout, velocity: field };
            let stress = SolidStress { cells, materials: &[Arc::new(ball_material())], positions: mesh.nodes() };
            mesh.boundary().facets().map(|facet| stress.trace_bound(facet)).collect::<Vec<_>>()
        });
        for (small, large) in bounds[0].iter().zip(&bounds[1]) {
            assert!((small - 2.0 * large).abs() <= 1e-12 * small, "{coordinates:?}: {small} {large}");
        }
        assert!(bounds[0].iter().any(|bound| *bound > 0.0));
    }
}

#[test]
fn the_energy_of_a_cell_bounds_its_traction() {
    for order in ORDERS {
        trace_bound::<2>(order);
        trace_bound::<3>(order);
    }
}

//! Tangents and stresses against finite differences at random states.

use std::sync::Arc;

use crate::setting::{Random, ball_material, one_field, rule, unit_box};
use algebra::time::{GeneralisedAlpha, ImplicitEuler, Level, QuasiStatic, TimeScheme};
use algebra::{Contributions, Integral, Term, check_tangent};
use body::SurfaceStress;
use mesh::{Point, Tensor, Vector, VertexId};
use solid_svk::kinematics::cauchy_stress;
use solid_svk::terms::{FollowerPressure, Traction};
use solid_svk::{Material, SolidCells, SolidFacet, SolidFacets, SolidForm, SolidStress};

fn schemes() -> [Box<dyn TimeScheme>; 3] {
    [Box::new(ImplicitEuler), Box::new(GeneralisedAlpha::new(0.8).unwrap()), Box::new(QuasiStatic)]
}

/// Returns a level with random displacement, velocity and acceleration.
fn random_level<const D: usize>(random: &mut Random, n: usize) -> Level<Vector<D>> {
    let [displacement, velocity, acceleration] = [0.02, 5.0, 200.0].map(|scale| random.vectors(n, scale));
    Level { displacement, velocity, acceleration }
}

fn tangents_are_exact<const D: usize>() {
    let mesh = unit_box::<D>(2);
    let (layout, field) = one_field(&mesh);
    let mut random = Random::new(7);
    let form = SolidForm::new(1.3, ball_material(), random.vector() * 1e3).unwrap();
    let loads: [&dyn Term<SolidFacet<D>>; 2] =
        [&FollowerPressure { pressure: 3e5 }, &Traction { traction: Arc::new(|_, _| Vector::repeat(2.0)) }];
    let facets: Vec<_> = mesh.boundary().facets().collect();
    for scheme in schemes() {
        let rule = rule(scheme.as_ref(), 1e-2, &random_level(&mut random, mesh.mesh().n_vertices()));
        let cells = SolidCells { solid: &mesh, rule: &rule, layout: &layout, velocity: field };
        let x = random.numbers(layout.len(), 5.0);
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
    tangents_are_exact::<2>();
    tangents_are_exact::<3>();
}

/// Checks that the stress on the surface is the Cauchy stress times the current normal, at the stage, and its
/// derivatives.
fn stress_on_the_surface<const D: usize>() {
    let mesh = unit_box::<D>(2);
    let (layout, field) = one_field(&mesh);
    let mut random = Random::new(11);
    let material = ball_material();
    let mut worst = [0.0_f64; 2];
    for scheme in schemes() {
        let rule = rule(scheme.as_ref(), 1e-2, &random_level(&mut random, mesh.mesh().n_vertices()));
        let x = random.numbers(layout.len(), 5.0);
        let stress = SolidStress {
            cells: SolidCells { solid: &mesh, rule: &rule, layout: &layout, velocity: field },
            material: &material,
        };
        let velocity = layout.values(field, &x).map(Vector::<D>::from).enumerate();
        let displacement: Vec<_> = velocity.map(|(i, v)| rule.displacement.at(i, v)).collect();
        let positions: Vec<Point<D>> = mesh.mesh().vertices().iter().zip(&displacement).map(|(x, d)| x + d).collect();
        let barycentric = [1.0 / D as f64; D];
        let (mut dofs, mut derivatives, mut unused) = (Vec::new(), Vec::new(), Vec::new());
        for facet in mesh.boundary().facets() {
            let found = stress.at(facet, &barycentric, &x, &mut derivatives);
            let cell = mesh.boundary().facet_to_cell(facet).unwrap();
            let vertices = mesh.mesh().cell(cell).iter().zip(mesh.gradients(cell));
            let gradient: Tensor<D> = vertices.map(|(v, g)| displacement[v.index()] * g.transpose()).sum();
            let f = Tensor::identity() + gradient;
            let expected = cauchy_stress(&f, &material.first_piola(&f)) * mesh.placed(&positions).facet_normal(facet);
            worst[0] = worst[0].max((found - expected).norm() / expected.norm());
            dofs.clear();
            stress.dofs(facet, &mut dofs);
            assert!(dofs.len() == D * (D + 1) && derivatives.iter().map(|(dof, _)| dof).eq(&dofs));
            let largest = derivatives.iter().fold(0.0_f64, |largest, (_, derivative)| largest.max(derivative.norm()));
            for (dof, derivative) in &derivatives {
                let step = 1e-4 * (1.0 + x[dof.index()].abs());
                let mut at = |by: f64| {
                    let mut moved = x.clone();
                    moved[dof.index()] += by;
                    stress.at(facet, &barycentric, &moved, &mut unused)
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
    stress_on_the_surface::<2>();
    stress_on_the_surface::<3>();
}

/// Checks the bound of the traction by the energy of a cell at rest: random fields stay below it, and a stretch along the normal of a cell with one facet on
/// the surface reaches it.
fn trace_bound<const D: usize>() {
    let mesh = unit_box::<D>(2);
    let (layout, field) = one_field(&mesh);
    let mut random = Random::new(3);
    let material = ball_material();
    let scheme = &schemes()[0];
    let n = mesh.mesh().n_vertices();
    let at_rest =
        Level { displacement: vec![Vector::zeros(); n], velocity: vec![Vector::zeros(); n], acceleration: Vec::new() };
    let rule = rule(scheme.as_ref(), 1e-2, &at_rest);
    let (x, slope) = (vec![0.0; layout.len()], rule.displacement.slope);
    let cells = SolidCells { solid: &mesh, rule: &rule, layout: &layout, velocity: field };
    let stress = SolidStress { cells, material: &material };
    let (mut derivatives, mut n_reached) = (Vec::new(), 0);
    for facet in mesh.boundary().facets() {
        let cell = mesh.boundary().facet_to_cell(facet).unwrap();
        let normal = mesh.placed(mesh.mesh().vertices()).facet_normal(facet);
        let of_cell: Vec<_> =
            mesh.boundary().facets().filter(|f| mesh.boundary().facet_to_cell(*f) == Some(cell)).collect();
        let mut ratio = |gradient: &Tensor<D>| {
            let field = |vertex: VertexId| gradient * mesh.mesh().vertex(vertex);
            let mut on_surface = 0.0;
            for facet in &of_cell {
                stress.at(*facet, &[1.0 / D as f64; D], &x, &mut derivatives);
                let vertices =
                    mesh.mesh().cell(cell).iter().flat_map(|v| field(*v).iter().copied().collect::<Vec<_>>());
                let traction: Vector<D> = derivatives.iter().zip(vertices).map(|((_, by), y)| by * y).sum();
                let measure = mesh.placed(mesh.mesh().vertices()).facet_measure(*facet);
                on_surface += measure * traction.norm_squared();
            }
            let energy = material.first_piola_derivative(&Tensor::identity(), gradient).dot(gradient);
            on_surface / (slope * mesh.volume(cell) * energy)
        };
        let bound = stress.trace_bound(facet);
        for _ in 0..20 {
            let gradient = Tensor::<D>::from_fn(|_, _| random.numbers(1, 1.0)[0]);
            let strain = (gradient + gradient.transpose()) * 0.5;
            assert!(ratio(&strain) <= bound * (1.0 + 1e-12));
        }
        if of_cell.len() == 1 {
            n_reached += 1;
            assert!((ratio(&(normal * normal.transpose())) / bound - 1.0).abs() < 1e-12);
        }
    }
    assert!(n_reached > 0);
}

#[test]
fn the_energy_of_a_cell_bounds_its_traction() {
    trace_bound::<2>();
    trace_bound::<3>();
}

//! Exact static states: rigid motions, uniform strain, pressurised bodies.

use crate::setting::{
    Random, at_rest, ball_material, largest, largest_difference, one_field, residual, rule, solve, state, unit_box,
    velocities, weightless,
};
use algebra::time::{QuasiStatic, StepRule};
use algebra::{BlockLayout, Constraints, FieldId, Integral};
use body::{BodyState, StepTime};
use mesh::generate::{BallOptions, Size, ball, graded_box};
use mesh::nalgebra::Rotation3;
use mesh::{Point, Tensor, Vector, VertexId, det};
use solid_svk::energy::cell_stress;
use solid_svk::supports::{Support, SupportKind, tagged_facets, vertices_of};
use solid_svk::terms::FollowerPressure;
use solid_svk::{Material, SolidCells, SolidFacets, SolidMesh};
use std::sync::Arc;

/// A body in a step of unit length from rest: its velocity is its displacement.
struct Fixture<'m, const D: usize> {
    mesh: &'m SolidMesh<D>,
    layout: BlockLayout,
    field: FieldId,
    rule: StepRule<Vector<D>>,
}

impl<'m, const D: usize> Fixture<'m, D> {
    fn new(mesh: &'m SolidMesh<D>) -> Self {
        let (layout, field) = one_field(mesh);
        Self { mesh, layout, field, rule: rule(&QuasiStatic, 1.0, &at_rest(mesh)) }
    }

    fn cells(&self) -> SolidCells<'_, D> {
        SolidCells { solid: self.mesh, rule: &self.rule, layout: &self.layout, velocity: self.field }
    }

    fn state(&self, displacement: &[Vector<D>]) -> Vec<f64> {
        state(&self.layout, self.field, displacement)
    }

    fn displacement(&self, x: &[f64]) -> Vec<Vector<D>> {
        velocities(&self.layout, self.field, x)
    }

    fn hold(&self, vertices: Vec<VertexId>, kind: SupportKind<D>, constraints: &mut Constraints) {
        let rest = at_rest(self.mesh);
        let begin = BodyState::new(rest.displacement, rest.velocity);
        Support { vertices, kind }.constrain(
            self.cells(),
            &begin,
            &StepTime::new(&QuasiStatic, 1.0, 1.0, true),
            constraints,
        );
    }
}

fn rotation_is_free_of_stress<const D: usize>(q: Tensor<D>) {
    let mesh = unit_box::<D>(3);
    let form = weightless();
    let body = Fixture::new(&mesh);
    let displacement: Vec<_> = mesh.mesh().vertices().iter().map(|x| q * x - x + Vector::repeat(0.3)).collect();
    let x = body.state(&displacement);
    let r = residual(&body.layout, &[&form.internal_work(body.cells())], &x);
    // Forces of a unit strain are of the order of the shear modulus.
    assert!(largest(&r) < 1e-13 * 2e6, "{:e}", largest(&r));
    for cell in mesh.mesh().cells() {
        let stress = cell_stress(&mesh, &form, cell, &displacement);
        assert!(stress.cauchy.norm() < 1e-12 * 2e6 && stress.von_mises() < 1e-5);
    }
}

#[test]
fn rotation_is_free_of_stress_in_2d_and_3d() {
    let (s, c) = 2.1_f64.sin_cos();
    rotation_is_free_of_stress(Tensor::<2>::new(c, -s, s, c));
    rotation_is_free_of_stress(*Rotation3::from_euler_angles(0.4, -1.2, 2.2).matrix());
}

/// Checks that linear data on the whole boundary give the linear field inside, on any mesh and at any size of strain.
fn uniform_strain_is_exact<const D: usize>(mesh: &SolidMesh<D>, strain: f64) {
    let form = weightless();
    let body = Fixture::new(mesh);
    let mut random = Random::new(3);
    let gradient = Tensor::<D>::from_fn(|_, _| strain * random.number());
    let exact = |x: &Point<D>| gradient * x;
    let prescribed = move |x: &Point<D>, _| -> [Option<f64>; D] { std::array::from_fn(|a| Some((gradient * x)[a])) };
    let boundary: Vec<_> = mesh.boundary().facets().collect();
    let vertices = vertices_of(mesh, &boundary);
    assert!(vertices.len() < mesh.mesh().n_vertices());
    let mut constraints = Constraints::new();
    let n_held = D * vertices.len();
    body.hold(vertices, SupportKind::Displacement(Arc::new(prescribed)), &mut constraints);
    assert_eq!(constraints.len(), n_held);
    let work = form.internal_work(body.cells());
    // Starts near the solution: boundary data alone would invert cells next to the boundary.
    let near: Vec<_> = mesh.mesh().vertices().iter().map(|x| exact(x) + random.vector() * (0.02 * strain)).collect();
    let mut x = body.state(&near);
    solve(&body.layout, vec![Box::new(work)], constraints, &mut x, 1e-12);
    let found = body.displacement(&x);
    let expected: Vec<_> = mesh.mesh().vertices().iter().map(exact).collect();
    let error = largest_difference(&found, &expected) / strain;
    assert!(error < 1e-10, "{error:e}");
    let p = ball_material().first_piola(&(Tensor::identity() + gradient));
    for cell in mesh.mesh().cells() {
        let sigma = cell_stress(mesh, &form, cell, &found).cauchy;
        let expected = p * (Tensor::identity() + gradient).transpose() / det(&(Tensor::identity() + gradient));
        assert!((sigma - expected).norm() < 1e-8 * expected.norm());
    }
}

#[test]
fn uniform_strain_is_exact_in_2d_and_3d() {
    let mesh = graded_box([0.0, 0.0], [2.0, 1.0], &Size::uniform(0.2)).unwrap();
    let mesh = SolidMesh::<2>::new(mesh).unwrap();
    // Nearly infinitesimal strain (linear elasticity), and finite strain. The material is unstable under strong
    // compression.
    uniform_strain_is_exact(&mesh, 1e-4);
    uniform_strain_is_exact(&mesh, 0.05);
    uniform_strain_is_exact(&unit_box::<3>(3), 1e-4);
    uniform_strain_is_exact(&unit_box::<3>(3), 0.1);
}

#[test]
fn stretched_bar_in_plane_strain() {
    // Stretch, lateral stretch and Cauchy stress of a bar with free sides, in closed form.
    for [stretch, lateral, sigma] in [[0.9, 1.061446, -5.370035e5], [1.1, 0.927362, 8.303124e5]] {
        let mesh = graded_box([0.0, 0.0], [1.0, 1.0], &Size::uniform(0.3)).unwrap();
        let mesh = SolidMesh::<2>::new(mesh).unwrap();
        let form = weightless();
        let body = Fixture::new(&mesh);
        let stretched = move |_: &Point<2>, _| [Some(stretch - 1.0), None];
        let mut constraints = Constraints::new();
        for (name, support) in [
            ("left", SupportKind::Symmetry { axis: 0 }),
            ("bottom", SupportKind::Symmetry { axis: 1 }),
            ("right", SupportKind::Displacement(Arc::new(stretched))),
        ] {
            let vertices = vertices_of(&mesh, &tagged_facets(&mesh, name).unwrap());
            body.hold(vertices, support, &mut constraints);
        }
        let work = form.internal_work(body.cells());
        let mut x = vec![0.0; body.layout.len()];
        solve(&body.layout, vec![Box::new(work)], constraints, &mut x, 1e-12);
        let displacement = body.displacement(&x);
        for (reference, d) in mesh.mesh().vertices().iter().zip(&displacement) {
            assert!((d[1] - (lateral - 1.0) * reference[1]).abs() < 1e-6, "{d}");
        }
        for cell in mesh.mesh().cells() {
            let stress = cell_stress(&mesh, &form, cell, &displacement);
            assert!((stress.cauchy[(0, 0)] - sigma).abs() < 1.0);
            assert!(stress.cauchy[(1, 1)].abs() < 1e-4);
            let (s, z) = (stress.cauchy[(0, 0)], stress.out_of_plane);
            assert!((stress.von_mises() - (s * s - s * z + z * z).sqrt()).abs() < 1e-3);
            assert!((stress.pressure() + (s + z) / 3.0).abs() < 1e-3);
        }
    }
}

#[test]
fn pressurised_disk() {
    // x = s X with (λ + μ)(s² - 1) = -p; radial displacement at the rim. The size puts vertices on the horizontal axis.
    let options = BallOptions { area_preserving: false };
    let mesh = SolidMesh::<2>::new(ball([0.0, 0.0], 4.0, 0.87, &options).unwrap()).unwrap();
    let form = weightless();
    let body = Fixture::new(&mesh);
    let facets: Vec<_> = mesh.boundary().facets().collect();
    for (pressure, rim) in [(1e4, -2.000500e-3), (1e5, -2.0050252e-2), (1e6, -0.20526681)] {
        let s = (1.0_f64 - pressure / 1e7).sqrt();
        assert!((4.0 * (s - 1.0) - rim).abs() < 1e-6 * rim.abs());
        let term = FollowerPressure { pressure };
        let sites = SolidFacets { cells: body.cells(), facets: &facets, time: 0.0 };
        let load = Integral::new("pressure", sites, vec![&term]);
        let exact: Vec<_> = mesh.mesh().vertices().iter().map(|x| x * (s - 1.0)).collect();
        let x = body.state(&exact);
        let r = residual(&body.layout, &[&form.internal_work(body.cells()), &load], &x);
        assert!(largest(&r) < 1e-13 * 1e7, "{:e}", largest(&r));
        for cell in mesh.mesh().cells() {
            let sigma = cell_stress(&mesh, &form, cell, &exact).cauchy;
            assert!((sigma + Tensor::<2>::identity() * pressure).norm() < 1e-8 * 1e7);
        }
        // The same solution from rest. Constraints at two vertices on the horizontal axis prevent rigid motions.
        let on_axis = |x: &&(usize, &Point<2>)| x.1[1].abs() < 1e-9 && x.1[0].abs() > 3.9;
        let vertices: Vec<_> = mesh.mesh().vertices().iter().enumerate().collect();
        let rim_vertices: Vec<_> = vertices.iter().filter(on_axis).map(|(i, _)| *i).collect();
        assert_eq!(rim_vertices.len(), 2);
        let dof = |vertex, axis| body.layout.dof(body.field, vertex, axis);
        let mut constraints: Constraints = rim_vertices.iter().map(|&i| (dof(i, 1), 0.0)).collect();
        constraints.set(dof(rim_vertices[0], 0), exact[rim_vertices[0]][0]);
        let mut x = vec![0.0; body.layout.len()];
        let work = form.internal_work(body.cells());
        solve(&body.layout, vec![Box::new(work), Box::new(load)], constraints, &mut x, 1e-12);
        let found = body.displacement(&x);
        assert!(largest_difference(&found, &exact) < 1e-9);
    }
}

#[test]
fn pressurised_cube() {
    // x = s X with σ = S/s, so (3 λ + 2 μ)(s² - 1)/(2 s) = -p.
    let mesh = unit_box::<3>(2);
    let form = weightless();
    let body = Fixture::new(&mesh);
    let facets: Vec<_> = mesh.boundary().facets().collect();
    let s = 0.97;
    let term = FollowerPressure { pressure: -2.8e7 * (s * s - 1.0) / (2.0 * s) };
    let sites = SolidFacets { cells: body.cells(), facets: &facets, time: 0.0 };
    let load = Integral::new("pressure", sites, vec![&term]);
    let exact: Vec<_> = mesh.mesh().vertices().iter().map(|x| x * (s - 1.0)).collect();
    let x = body.state(&exact);
    let r = residual(&body.layout, &[&form.internal_work(body.cells()), &load], &x);
    assert!(largest(&r) < 1e-14 * 2.8e7, "{:e}", largest(&r));
}

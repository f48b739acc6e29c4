//! Exact static states: rigid motions, uniform strain, pressurised bodies.

use crate::setting::{
    Problem, Random, ball_material, largest, largest_difference, one_field, residual, unit_box, weightless,
};
use algebra::Contributions;
use mesh::generate::{BallOptions, Size, ball, graded_box};
use mesh::nalgebra::Rotation3;
use mesh::{Point, Tensor, Vector, det};
use solid_svk::boundary::{Support, support_values, tagged_facets, vertices_of};
use solid_svk::energy::CellStress;
use solid_svk::terms::FollowerPressure;
use solid_svk::{Material, SolidCells, SolidFacets, SolidMesh, StepRule};

/// A step of unit length from rest: the velocity is the displacement, and without inertia the step is a static solve.
fn static_step<const D: usize>(mesh: &SolidMesh<D>) -> StepRule<D> {
    let rest = vec![Vector::zeros(); mesh.mesh().n_vertices()];
    StepRule::implicit_euler(1.0, &rest, &rest).unwrap()
}

fn rotation_is_free_of_stress<const D: usize>(q: Tensor<D>) {
    let mesh = unit_box::<D>(3);
    let form = weightless();
    let (layout, field) = one_field(&mesh);
    let step = static_step(&mesh);
    let cells = SolidCells::new(&mesh, &form, &step, &layout, field).unwrap();
    let displacement: Vec<_> = mesh.mesh().vertices().iter().map(|x| q * x - x + Vector::repeat(0.3)).collect();
    let mut x = vec![0.0; layout.len()];
    mesh.set_velocity(&layout, field, &displacement, &mut x).unwrap();
    let r = residual(&[&cells.internal_work()], &x);
    // Forces of a unit strain are of the order of the shear modulus.
    assert!(largest(&r) < 1e-13 * 2e6, "{:e}", largest(&r));
    for cell in mesh.mesh().cells() {
        let stress = CellStress::new(&mesh, &form, cell, &displacement);
        assert!(stress.cauchy.norm() < 1e-12 * 2e6 && stress.von_mises() < 1e-5);
    }
}

#[test]
fn rotation_is_free_of_stress_in_2d() {
    let (s, c) = 2.1_f64.sin_cos();
    rotation_is_free_of_stress(Tensor::<2>::new(c, -s, s, c));
}

#[test]
fn rotation_is_free_of_stress_in_3d() {
    rotation_is_free_of_stress(*Rotation3::from_euler_angles(0.4, -1.2, 2.2).matrix());
}

/// Linear data on the whole boundary give the linear field inside, on any mesh and at any size of strain.
fn uniform_strain_is_exact<const D: usize>(mesh: &SolidMesh<D>, strain: f64) {
    let form = weightless();
    let (layout, field) = one_field(mesh);
    let step = static_step(mesh);
    let cells = SolidCells::new(mesh, &form, &step, &layout, field).unwrap();
    let mut random = Random::new(3);
    let gradient = Tensor::<D>::from_fn(|_, _| strain * random.number());
    let exact = |x: &Point<D>| gradient * x;
    let prescribed = |x: &Point<D>| -> [Option<f64>; D] { std::array::from_fn(|a| Some(exact(x)[a])) };
    let boundary: Vec<_> = mesh.boundary().facets().collect();
    let vertices = vertices_of(mesh, &boundary);
    assert!(vertices.len() < mesh.mesh().n_vertices());
    let values = support_values(mesh, &vertices, Support::Displacement(&prescribed), &step, &layout, field).unwrap();
    assert_eq!(values.len(), D * vertices.len());
    let work = cells.internal_work();
    // Not far from the solution: boundary data alone would turn cells next to the boundary inside out.
    let near: Vec<_> = mesh.mesh().vertices().iter().map(|x| exact(x) + random.vector() * (0.02 * strain)).collect();
    let mut x = vec![0.0; layout.len()];
    mesh.set_velocity(&layout, field, &near, &mut x).unwrap();
    // The field in front belongs to nobody here.
    let idle = (0..5).map(|k| (algebra::DofId(k), 0.0));
    Problem::new(&layout, vec![&work], values.into_iter().chain(idle)).solve(&mut x, 1e-12);
    let found = mesh.velocity(&layout, field, &x).unwrap();
    let expected: Vec<_> = mesh.mesh().vertices().iter().map(exact).collect();
    let error = largest_difference(&found, &expected) / strain;
    assert!(error < 1e-10, "{error:e}");
    let p = ball_material().first_piola(&(Tensor::identity() + gradient));
    for cell in mesh.mesh().cells() {
        let sigma = CellStress::new(mesh, &form, cell, &found).cauchy;
        let expected = p * (Tensor::identity() + gradient).transpose() / det(&(Tensor::identity() + gradient));
        assert!((sigma - expected).norm() < 1e-8 * expected.norm());
    }
}

#[test]
fn uniform_strain_is_exact_on_unstructured_meshes() {
    let mesh = graded_box([0.0, 0.0], [2.0, 1.0], &Size::uniform(0.2)).unwrap();
    let mesh = SolidMesh::<2>::new(mesh).unwrap();
    // All but infinitesimal (linear elasticity), and finite; far in compression the material is not stable.
    uniform_strain_is_exact(&mesh, 1e-4);
    uniform_strain_is_exact(&mesh, 0.05);
}

#[test]
fn uniform_strain_is_exact_in_3d() {
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
        let (layout, field) = one_field(&mesh);
        let step = static_step(&mesh);
        let cells = SolidCells::new(&mesh, &form, &step, &layout, field).unwrap();
        let stretched = |_: &Point<2>| [Some(stretch - 1.0), None];
        let mut values: Vec<_> = (0..5).map(|k| (algebra::DofId(k), 0.0)).collect();
        for (name, support) in [
            ("left", Support::Symmetry { axis: 0 }),
            ("bottom", Support::Symmetry { axis: 1 }),
            ("right", Support::Displacement(&stretched)),
        ] {
            let vertices = vertices_of(&mesh, &tagged_facets(&mesh, name).unwrap());
            values.extend(support_values(&mesh, &vertices, support, &step, &layout, field).unwrap());
        }
        let work = cells.internal_work();
        let mut x = vec![0.0; layout.len()];
        Problem::new(&layout, vec![&work], values).solve(&mut x, 1e-12);
        let displacement = mesh.velocity(&layout, field, &x).unwrap();
        for (reference, d) in mesh.mesh().vertices().iter().zip(&displacement) {
            assert!((d[1] - (lateral - 1.0) * reference[1]).abs() < 1e-6, "{d}");
        }
        for cell in mesh.mesh().cells() {
            let stress = CellStress::new(&mesh, &form, cell, &displacement);
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
    let (layout, field) = one_field(&mesh);
    let step = static_step(&mesh);
    let cells = SolidCells::new(&mesh, &form, &step, &layout, field).unwrap();
    let work = cells.internal_work();
    let facets: Vec<_> = mesh.boundary().facets().collect();
    for (pressure, rim) in [(1e4, -2.000500e-3), (1e5, -2.0050252e-2), (1e6, -0.20526681)] {
        let s = (1.0_f64 - pressure / 1e7).sqrt();
        assert!((4.0 * (s - 1.0) - rim).abs() < 1e-6 * rim.abs());
        let load = FollowerPressure { pressure };
        let load = SolidFacets::new(&mesh, &load, &facets, &step, &layout, field).unwrap();
        let exact: Vec<_> = mesh.mesh().vertices().iter().map(|x| x * (s - 1.0)).collect();
        let mut x = vec![0.0; layout.len()];
        mesh.set_velocity(&layout, field, &exact, &mut x).unwrap();
        let r = residual(&[&work, &load], &x);
        assert!(largest(&r) < 1e-13 * 1e7, "{:e}", largest(&r));
        for cell in mesh.mesh().cells() {
            let sigma = CellStress::new(&mesh, &form, cell, &exact).cauchy;
            assert!((sigma + Tensor::<2>::identity() * pressure).norm() < 1e-8 * 1e7);
        }
        // Found again from rest. Two vertices on the horizontal axis take the rigid motions.
        let on_axis = |x: &&(usize, &Point<2>)| x.1[1].abs() < 1e-9 && x.1[0].abs() > 3.9;
        let vertices: Vec<_> = mesh.mesh().vertices().iter().enumerate().collect();
        let rim_vertices: Vec<_> = vertices.iter().filter(on_axis).map(|(i, _)| *i).collect();
        assert_eq!(rim_vertices.len(), 2);
        let mut values: Vec<_> = (0..5).map(|k| (algebra::DofId(k), 0.0)).collect();
        values.extend(rim_vertices.iter().map(|&i| (layout.dof(field, 2 * i + 1), 0.0)));
        values.push((layout.dof(field, 2 * rim_vertices[0]), exact[rim_vertices[0]][0]));
        let mut x = vec![0.0; layout.len()];
        let contributions: Vec<&dyn Contributions> = vec![&work, &load];
        Problem::new(&layout, contributions, values).solve(&mut x, 1e-12);
        let found = mesh.velocity(&layout, field, &x).unwrap();
        assert!(largest_difference(&found, &exact) < 1e-9);
    }
}

#[test]
fn pressurised_cube() {
    // x = s X with σ = S/s, so (3 λ + 2 μ)(s² - 1)/(2 s) = -p.
    let mesh = unit_box::<3>(2);
    let form = weightless();
    let (layout, field) = one_field(&mesh);
    let step = static_step(&mesh);
    let cells = SolidCells::new(&mesh, &form, &step, &layout, field).unwrap();
    let facets: Vec<_> = mesh.boundary().facets().collect();
    let s = 0.97;
    let load = FollowerPressure { pressure: -2.8e7 * (s * s - 1.0) / (2.0 * s) };
    let load = SolidFacets::new(&mesh, &load, &facets, &step, &layout, field).unwrap();
    let exact: Vec<_> = mesh.mesh().vertices().iter().map(|x| x * (s - 1.0)).collect();
    let mut x = vec![0.0; layout.len()];
    mesh.set_velocity(&layout, field, &exact, &mut x).unwrap();
    let r = residual(&[&cells.internal_work(), &load], &x);
    assert!(largest(&r) < 1e-14 * 2.8e7, "{:e}", largest(&r));
}

//! Exact static states: rigid motions, uniform strain, pressurised bodies.

use crate::setting::{
    ORDERS, at_rest, ball_material, curved, distorted, largest, largest_difference, padded_layout, quadratic_field,
    residual, round_disk, rule, solve, state, unit_mesh, vector, velocities, weightless,
};
use algebra::time::{QuasiStatic, StepRule};
use algebra::{BlockLayout, Constraints, Contributions, FieldId, Integral};
use body::{BodyState, StepTime};
use mesh::generate::{BallOptions, Size, ball, graded_box};
use mesh::nalgebra::Rotation3;
use mesh::{Point, SimplexRule, Tensor, Vector, VertexId, det};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;
use solid_svk::energy::stresses;
use solid_svk::supports::{Support, SupportKind, facets_without_tags, tagged_facets};
use solid_svk::terms::{FollowerPressure, Traction};
use solid_svk::{LameParameters, LinearElastic, Material, Order, SolidCells, SolidFacets, SolidForm, SolidMesh};
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
        let (layout, field) = padded_layout(mesh);
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
        let start = BodyState::new(rest.displacement, rest.velocity);
        Support { vertices, kind }.constrain(
            self.cells(),
            &start,
            &StepTime::new(&QuasiStatic, 1.0, 1.0, true),
            constraints,
        );
    }
}

fn rotation_is_free_of_stress<const D: usize>(mesh: &SolidMesh<D>, q: &Tensor<D>) {
    let form = weightless();
    let body = Fixture::new(mesh);
    let displacement: Vec<_> = mesh.nodes().iter().map(|x| q * x - x + Vector::repeat(0.3)).collect();
    let x = body.state(&displacement);
    let r = residual(&body.layout, &[&form.internal_work(body.cells())], &x);
    // Forces of a unit strain are of the order of the shear modulus.
    assert!(largest(&r) < 1e-13 * 2e6, "{:e}", largest(&r));
    for stress in stresses(mesh, &form, &displacement) {
        assert!(stress.cauchy.norm() < 1e-12 * 2e6 && stress.von_mises() < 1e-5);
    }
}

#[test]
fn rotation_is_free_of_stress_in_2d_and_3d() {
    let (s, c) = 2.1_f64.sin_cos();
    let (plane, space) = (Tensor::<2>::new(c, -s, s, c), *Rotation3::from_euler_angles(0.4, -1.2, 2.2).matrix());
    for order in ORDERS {
        rotation_is_free_of_stress(&distorted(3, order), &plane);
        rotation_is_free_of_stress(&distorted(3, order), &space);
    }
    rotation_is_free_of_stress(&curved(3), &plane);
    rotation_is_free_of_stress(&curved(2), &space);
}

/// Checks that linear data on the whole boundary give the linear field inside, on any mesh and at any size of strain.
fn uniform_strain_is_exact<const D: usize>(mesh: &SolidMesh<D>, strain: f64) {
    let form = weightless();
    let body = Fixture::new(mesh);
    let mut random = SplitMix64::seed_from_u64(3);
    let gradient = Tensor::<D>::from_fn(|_, _| strain * random.random_range(-1.0..1.0));
    let exact = |x: &Point<D>| gradient * x;
    let prescribed = move |x: &Point<D>, _| -> [Option<f64>; D] { std::array::from_fn(|a| Some((gradient * x)[a])) };
    let boundary: Vec<_> = mesh.boundary().facets().collect();
    let vertices = mesh.boundary().vertices_of(&boundary);
    assert!(vertices.len() < mesh.nodes().len());
    let mut constraints = Constraints::new();
    let n_held = D * vertices.len();
    body.hold(vertices, SupportKind::Displacement(Arc::new(prescribed)), &mut constraints);
    assert_eq!(constraints.len(), n_held);
    let work = form.internal_work(body.cells());
    // Starts near the solution: boundary data alone would invert cells next to the boundary.
    let near: Vec<_> = mesh.nodes().iter().map(|x| exact(x) + vector(&mut random) * (0.02 * strain)).collect();
    let mut x = body.state(&near);
    solve(&body.layout, vec![Box::new(work)], constraints, &mut x, 1e-12);
    let found = body.displacement(&x);
    let expected: Vec<_> = mesh.nodes().iter().map(exact).collect();
    let error = largest_difference(&found, &expected) / strain;
    assert!(error < 1e-10, "{error:e}");
    let p = ball_material().first_piola(&(Tensor::identity() + gradient));
    let expected = p * (Tensor::identity() + gradient).transpose() / det(&(Tensor::identity() + gradient));
    for stress in stresses(mesh, &form, &found) {
        assert!((stress.cauchy - expected).norm() < 1e-8 * expected.norm());
    }
}

#[test]
fn uniform_strain_is_exact_in_2d_and_3d() {
    // Nearly infinitesimal strain (linear elasticity), and finite strain. The material is unstable under strong
    // compression.
    for order in ORDERS {
        let mesh = graded_box([0.0, 0.0], [2.0, 1.0], &Size::uniform(0.2)).unwrap();
        let mesh = SolidMesh::<2>::of_order(mesh, order).unwrap();
        for strain in [1e-4, 0.05] {
            uniform_strain_is_exact(&mesh, strain);
            uniform_strain_is_exact::<2>(&distorted(4, order), strain);
            uniform_strain_is_exact::<3>(&distorted(3, order), strain);
        }
    }
    uniform_strain_is_exact::<2>(&curved(4), 0.05);
}

#[test]
fn stretched_bar_in_plane_strain() {
    // Stretch, lateral stretch and Cauchy stress of a bar with free sides, in closed form.
    let states = [[0.9, 1.061446, -5.370035e5], [1.1, 0.927362, 8.303124e5]];
    for ([stretch, lateral, sigma], order) in states.into_iter().flat_map(|state| ORDERS.map(|order| (state, order))) {
        let mesh = graded_box([0.0, 0.0], [1.0, 1.0], &Size::uniform(0.3)).unwrap();
        let mesh = SolidMesh::<2>::of_order(mesh, order).unwrap();
        let form = weightless();
        let body = Fixture::new(&mesh);
        let stretched = move |_: &Point<2>, _| [Some(stretch - 1.0), None];
        let mut constraints = Constraints::new();
        for (name, support) in [
            ("left", SupportKind::symmetry(0)),
            ("bottom", SupportKind::symmetry(1)),
            ("right", SupportKind::Displacement(Arc::new(stretched))),
        ] {
            let vertices = mesh.boundary().vertices_of(&tagged_facets(&mesh, name).unwrap());
            body.hold(vertices, support, &mut constraints);
        }
        let work = form.internal_work(body.cells());
        // Starts with the stretch: the displaced end alone would invert the cells next to it.
        let stretched: Vec<_> = mesh.nodes().iter().map(|x| Vector::<2>::new((stretch - 1.0) * x[0], 0.0)).collect();
        let mut x = body.state(&stretched);
        solve(&body.layout, vec![Box::new(work)], constraints, &mut x, 1e-12);
        let displacement = body.displacement(&x);
        for (reference, d) in mesh.nodes().iter().zip(&displacement) {
            assert!((d[1] - (lateral - 1.0) * reference[1]).abs() < 1e-6, "{d}");
        }
        for stress in stresses(&mesh, &form, &displacement) {
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
    let options = BallOptions { area_preserving: false };
    let mesh = || ball([0.0, 0.0], 4.0, 0.87, &options).unwrap();
    pressurised(&SolidMesh::new(mesh()).unwrap());
    pressurised(&round_disk(mesh(), 4.0));
}

/// Checks x = s X with (λ + μ)(s² - 1) = -p; radial displacement at the rim. The size puts vertices on the horizontal
/// axis.
fn pressurised(mesh: &SolidMesh<2>) {
    let form = weightless();
    let body = Fixture::new(mesh);
    let facets: Vec<_> = mesh.boundary().facets().collect();
    for (pressure, rim) in [(1e4, -2.000500e-3), (1e5, -2.0050252e-2), (1e6, -0.20526681)] {
        let s = (1.0_f64 - pressure / 1e7).sqrt();
        assert!((4.0 * (s - 1.0) - rim).abs() < 1e-6 * rim.abs());
        let term = FollowerPressure { pressure };
        let sites = SolidFacets { cells: body.cells(), facets: &facets, time: 0.0 };
        let load = Integral::new("pressure", sites, vec![&term]);
        let exact: Vec<_> = mesh.nodes().iter().map(|x| x * (s - 1.0)).collect();
        let x = body.state(&exact);
        let r = residual(&body.layout, &[&form.internal_work(body.cells()), &load], &x);
        assert!(largest(&r) < 1e-13 * 1e7, "{:e}", largest(&r));
        for stress in stresses(mesh, &form, &exact) {
            assert!((stress.cauchy + Tensor::<2>::identity() * pressure).norm() < 1e-8 * 1e7);
        }
        if mesh.order() == Order::Quadratic && pressure > 1e5 {
            continue;
        }
        // The same solution from rest; quadratic elements have other states under the largest pressure. Constraints at
        // two vertices on the horizontal axis prevent rigid motions.
        let on_axis = |x: &&(usize, &Point<2>)| x.1[1].abs() < 1e-9 && x.1[0].abs() > 3.9;
        let vertices: Vec<_> = mesh.nodes().iter().enumerate().collect();
        let rim_vertices: Vec<_> = vertices.iter().filter(on_axis).map(|(i, _)| *i).collect();
        assert_eq!(rim_vertices.len(), 2);
        let dof = |vertex, axis| body.layout.dof(body.field, vertex, axis);
        let mut constraints: Constraints = rim_vertices.iter().map(|&i| (dof(i, 1), 0.0)).collect();
        constraints.set(dof(rim_vertices[0], 0), exact[rim_vertices[0]][0]);
        let mut x = vec![0.0; body.layout.len()];
        let work = form.internal_work(body.cells());
        solve(&body.layout, vec![Box::new(work), Box::new(load)], constraints, &mut x, 1e-12);
        let found = body.displacement(&x);
        let error = largest_difference(&found, &exact);
        assert!(error < 1e-9, "{pressure}: {error:e}");
    }
}

#[test]
fn pressurised_cube() {
    // x = s X with σ = S/s, so (3 λ + 2 μ)(s² - 1)/(2 s) = -p.
    for order in ORDERS {
        pressurised_cube_of_order(&SolidMesh::of_order(unit_mesh(2), order).unwrap());
    }
}

fn pressurised_cube_of_order(mesh: &SolidMesh<3>) {
    let form = weightless();
    let body = Fixture::new(mesh);
    let facets: Vec<_> = mesh.boundary().facets().collect();
    let s = 0.97;
    let term = FollowerPressure { pressure: -2.8e7 * (s * s - 1.0) / (2.0 * s) };
    let sites = SolidFacets { cells: body.cells(), facets: &facets, time: 0.0 };
    let load = Integral::new("pressure", sites, vec![&term]);
    let exact: Vec<_> = mesh.nodes().iter().map(|x| x * (s - 1.0)).collect();
    let x = body.state(&exact);
    let r = residual(&body.layout, &[&form.internal_work(body.cells()), &load], &x);
    assert!(largest(&r) < 1e-14 * 2.8e7, "{:e}", largest(&r));
}

/// Solves for a displacement that is given on the boundary but for the top, where its traction is.
fn loaded_on_top<const D: usize>(
    mesh: &SolidMesh<D>,
    form: &SolidForm<D>,
    material: LinearElastic,
    exact: impl Fn(&Point<D>) -> Vector<D> + Send + Sync + 'static,
    gradient: impl Fn(&Point<D>) -> Tensor<D> + Send + Sync + 'static,
) -> Vec<Vector<D>> {
    let body = Fixture::new(mesh);
    let loaded = tagged_facets(mesh, "top").unwrap();
    let up = mesh.placed(mesh.nodes()).facet_normal(loaded[0]);
    let traction = move |x: &Point<D>, _| material.first_piola(&(Tensor::identity() + gradient(x))) * up;
    let term = Traction { traction: Arc::new(traction) };
    let sites = SolidFacets { cells: body.cells(), facets: &loaded, time: 0.0 };
    let load = Integral::linear("traction", sites, vec![&term]);
    let prescribed = move |x: &Point<D>, _| -> [Option<f64>; D] { exact(x).map(Some).into() };
    let nodes = mesh.boundary().vertices_of(&facets_without_tags(mesh, &["top"]).unwrap());
    assert!(nodes.len() < mesh.nodes().len());
    let mut constraints = Constraints::new();
    body.hold(nodes, SupportKind::Displacement(Arc::new(prescribed)), &mut constraints);
    let (work, force) = (form.internal_work(body.cells()), form.inertia_and_body_force(body.cells()));
    let all: Vec<Box<dyn Contributions>> = vec![Box::new(work), Box::new(force), Box::new(load)];
    let mut x = vec![0.0; body.layout.len()];
    solve(&body.layout, all, constraints, &mut x, 1e-12);
    body.displacement(&x)
}

/// Checks that a linear material finds a quadratic displacement with its body force and, on one side, its traction.
fn quadratic_displacement_is_exact<const D: usize>(mesh: &SolidMesh<D>) {
    let lame = ball_material().lame;
    let (field, material) = (Arc::new(quadratic_field::<D>()), LinearElastic::new(lame));
    let form = SolidForm::new(2.0, material, field.divergence_of_stress(&lame) * -0.5).unwrap();
    let expected: Vec<_> = mesh.nodes().iter().map(|x| field.at(x)).collect();
    let of_field = Arc::clone(&field);
    let found = loaded_on_top(mesh, &form, material, move |x| field.at(x), move |x| of_field.gradient(x));
    let error = largest_difference(&found, &expected);
    assert!(error < 1e-12, "{error:e}");
}

#[test]
fn quadratic_displacement_is_exact_in_2d_and_3d() {
    quadratic_displacement_is_exact::<2>(&distorted(3, Order::Quadratic));
    quadratic_displacement_is_exact::<3>(&distorted(2, Order::Quadratic));
}

/// Returns the error in L2 of the smooth displacement `∇(e^x cos y)`, which is in equilibrium without a body force:
/// displacement given on the boundary but for one side with its traction, on a mesh with `n` bricks along each side.
fn error_of_smooth_solution<const D: usize>(order: Order, n: usize) -> f64 {
    let material = LinearElastic::new(LameParameters::new(1.0, 2.0).unwrap());
    let exact = |x: &Point<D>| {
        let mut u = Vector::<D>::zeros();
        (u[0], u[1]) = (x[0].exp() * x[1].cos(), -x[0].exp() * x[1].sin());
        u
    };
    let gradient = move |x: &Point<D>| {
        let (u, mut gradient) = (exact(x), Tensor::<D>::zeros());
        (gradient[(0, 0)], gradient[(0, 1)]) = (u[0], u[1]);
        (gradient[(1, 0)], gradient[(1, 1)]) = (u[1], -u[0]);
        gradient
    };
    let mesh = distorted::<D>(n, order);
    let form = SolidForm::new(1.0, material, Vector::zeros()).unwrap();
    let found = loaded_on_top(&mesh, &form, material, exact, gradient);
    let (rule, mut sum) = (SimplexRule::of_degree(D, 4), 0.0);
    for cell in mesh.mesh().cells() {
        let (simplex, nodes) = (mesh.mesh().simplex(cell), mesh.cell(cell));
        for (at, weight) in rule.points().iter().zip(rule.weights()) {
            let point: Point<D> = simplex.points().iter().zip(at).map(|(x, l)| x * *l).sum();
            let value: Vector<D> = nodes.iter().zip(shape(order, D, at)).map(|(i, n)| found[i.index()] * n).sum();
            sum += weight * simplex.volume() * (value - exact(&point)).norm_squared();
        }
    }
    sum.sqrt()
}

/// Returns the shape functions at a point in barycentric coordinates.
fn shape(order: Order, dimension: usize, at: &[f64]) -> Vec<f64> {
    let vertices = at[..=dimension].iter();
    if order == Order::Linear {
        return vertices.copied().collect();
    }
    let edges = (1..=dimension).flat_map(|j| (0..j).map(move |i| 4.0 * at[i] * at[j]));
    vertices.map(|l| l * (2.0 * l - 1.0)).chain(edges).collect()
}

#[test]
fn errors_of_a_smooth_solution_fall_with_the_order_plus_one() {
    fn orders<const D: usize>(n: [usize; 2]) {
        for order in ORDERS {
            let [coarse, fine] = n.map(|n| error_of_smooth_solution::<D>(order, n));
            let found = (coarse / fine).ln() / (n[1] as f64 / n[0] as f64).ln();
            let expected = (order.degree() + 1) as f64;
            assert!((found - expected).abs() < 0.15 * expected, "{order:?} in {D}d: {found}");
            assert!(found > expected - 0.1, "{order:?} in {D}d: {found}");
        }
    }
    orders::<2>([8, 16]);
    orders::<3>([3, 6]);
}

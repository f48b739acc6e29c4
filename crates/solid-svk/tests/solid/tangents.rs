//! Tangents against finite differences at random states.

use crate::setting::{Random, ball_material, one_field, unit_box};
use algebra::{Contributions, check_tangent};
use mesh::Vector;
use solid_svk::terms::{FollowerPressure, Traction};
use solid_svk::{FacetTerm, GeneralisedAlpha, SolidCells, SolidFacets, SolidForm, TimeScheme};

fn tangents_are_exact<const D: usize>() {
    let mesh = unit_box::<D>(2);
    let (layout, field) = one_field(&mesh);
    let mut random = Random::new(7);
    let n = mesh.mesh().n_vertices();
    let form = SolidForm::new(1.3, ball_material(), random.vector() * 1e3).unwrap();
    let loads: [&dyn FacetTerm<D>; 2] =
        [&FollowerPressure { pressure: 3e5 }, &Traction { traction: Vector::repeat(2.0) }];
    let facets: Vec<_> = mesh.boundary().facets().collect();
    let second_order = TimeScheme::GeneralisedAlpha(GeneralisedAlpha::new(0.8).unwrap());
    for scheme in [TimeScheme::ImplicitEuler, second_order, TimeScheme::QuasiStatic] {
        let [d, v, a] = [0.02, 5.0, 200.0].map(|scale| random.vectors(n, scale));
        let step = scheme.step(1e-2, &d, &v, Some(&a)).unwrap();
        let cells = SolidCells::new(&mesh, &form, &step, &layout, field).unwrap();
        let x = random.numbers(layout.len(), 5.0);
        let (linear, work) = (cells.linear(), cells.internal_work());
        assert!(linear.is_linear() && !work.is_linear());
        let mut all: Vec<(&dyn Contributions, f64)> = vec![(&linear, 1e-10), (&work, 1e-6)];
        let loads = loads.map(|term| SolidFacets::new(&mesh, term, &facets, &step, &layout, field).unwrap());
        all.extend(loads.iter().map(|l| (l as &dyn Contributions, 1e-7)));
        for (contribution, tolerance) in all {
            let deviation = check_tangent(contribution, &x, 1e-4);
            assert!(deviation < tolerance, "{}: {deviation:e}", contribution.name());
        }
    }
}

#[test]
fn tangents_are_exact_in_2d() {
    tangents_are_exact::<2>();
}

#[test]
fn tangents_are_exact_in_3d() {
    tangents_are_exact::<3>();
}

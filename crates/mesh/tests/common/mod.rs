//! Checks of meshes.

// Each test file uses a part of this module.
#![allow(dead_code)]

use mesh::{Placed, SimplexMesh, Vector};

pub(crate) fn volume<const D: usize>(mesh: &SimplexMesh<D>) -> f64 {
    mesh.cells().map(|c| mesh.cell_volume(c)).sum()
}

/// Checks that facets and cells refer to each other, and that the boundary is closed and encloses the cells.
pub(crate) fn assert_sound<const D: usize>(mesh: &SimplexMesh<D>) {
    for facet in mesh.facets() {
        for cell in mesh.facet_to_cell(facet).into_iter().flatten() {
            let local = mesh.cell_to_facet(cell).iter().position(|&f| f == facet).expect("the cell has the facet");
            assert!(!mesh.facet(facet).contains(&mesh.cell(cell)[local]));
            assert!(mesh.facet(facet).iter().all(|v| mesh.cell(cell).contains(v)));
        }
        assert_eq!(mesh.is_boundary(facet), mesh.facet_tag(facet).is_some(), "the boundary is tagged throughout");
    }
    let boundary = mesh.boundary();
    let placed = Placed::new(&boundary, mesh.vertices());
    let (volume, size) = (volume(mesh), boundary.facets().map(|f| placed.facet_measure(f)).sum::<f64>());
    let closure: Vector<D> = boundary.facets().map(|f| placed.facet_normal(f) * placed.facet_measure(f)).sum();
    assert!(closure.norm() < 1e-12 * size, "normals sum to {closure}");
    assert!((placed.enclosed().volume - volume).abs() < 1e-11 * volume);
    let mut used = vec![false; mesh.n_vertices()];
    mesh.cells().flat_map(|c| mesh.cell(c).to_vec()).for_each(|v| used[v.index()] = true);
    assert!(!used.contains(&false), "every vertex belongs to a cell");
}

/// Returns the smallest angle of a mesh in degrees.
pub(crate) fn smallest_angle(mesh: &SimplexMesh<2>) -> f64 {
    let of_cell = |cell| {
        let simplex = mesh.simplex(cell);
        let x = simplex.points();
        (0..3).map(|k| (x[(k + 1) % 3] - x[k]).angle(&(x[(k + 2) % 3] - x[k]))).fold(f64::INFINITY, f64::min)
    };
    mesh.cells().map(of_cell).fold(f64::INFINITY, f64::min).to_degrees()
}

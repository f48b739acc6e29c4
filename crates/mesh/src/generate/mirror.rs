//! Meshes completed by their mirror images.

use super::grid::side_names;
use crate::{CellId, Error, FacetId, Point, SimplexMesh, VertexId, require};

/// Vertices within this distance of the plane, relative to the extent of the mesh normal to it, lie on the plane.
const ON_PLANE: f64 = 1e-12;

/// Returns the union of a mesh and its mirror image at the plane `x[axis] == plane`.
///
/// Vertices and cells of the given half come first and keep their ids. Vertices within 1e-12 of the plane (relative to
/// the extent of the mesh) are moved onto it, and facets on it become interior. Mirrored facets have the tag of their
/// original, but names of opposite sides are swapped: "left" and "right" for axis 0, "front" and "back" (3D) or
/// "bottom" and "top" (2D) for axis 1, "bottom" and "top" for axis 2.
///
/// # Errors
/// [`Error::Parameter`]: `axis` not below `D`, vertices on both sides of the plane, or no boundary facet on it.
pub fn mirrored<const D: usize>(mesh: &SimplexMesh<D>, axis: usize, plane: f64) -> Result<SimplexMesh<D>, Error> {
    require(axis < D, "axis", axis as f64, "below the dimension")?;
    require(plane.is_finite(), "plane", plane, "finite")?;
    let (low, high) = mesh
        .vertices()
        .iter()
        .fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x[axis] - plane), high.max(x[axis] - plane)));
    let tolerance = ON_PLANE * (high - low);
    let is_outside = low >= -tolerance || high <= tolerance;
    require(is_outside, "plane", plane, "a plane with the whole mesh on one side")?;
    let on_plane = |x: &Point<D>| (x[axis] - plane).abs() <= tolerance;
    let touches = |facet: FacetId| mesh.facet(facet).iter().all(|&v| on_plane(&mesh.vertex(v)));
    require(mesh.facets().any(touches), "plane", plane, "a plane that contains facets of the mesh")?;

    let mut vertices = mesh.vertices().to_vec();
    let mut image = Vec::with_capacity(vertices.len());
    for index in 0..mesh.n_vertices() {
        if on_plane(&vertices[index]) {
            vertices[index][axis] = plane;
            image.push(VertexId::new(index));
        } else {
            let mut x = vertices[index];
            x[axis] = 2.0 * plane - x[axis];
            image.push(VertexId::new(vertices.len()));
            vertices.push(x);
        }
    }
    let mut cell_to_vertex: Vec<VertexId> = mesh.cells().flat_map(|c| mesh.cell(c).iter().copied()).collect();
    for cell in mesh.cells() {
        // Reflection inverts a cell; swapping two vertices restores the orientation.
        cell_to_vertex.extend((0..=D).map(|local| image[mesh.cell(cell)[swapped(local)].index()]));
    }
    let whole = SimplexMesh::new(vertices, cell_to_vertex)?;

    let names: Vec<Option<&str>> = whole
        .facets()
        .map(|facet| {
            let cell = whole.facet_to_cell(facet)[0]?;
            let local = whole.cell_to_facet(cell).iter().position(|&f| f == facet)?;
            let original = |c: usize, local: usize| mesh.facet_tag(mesh.cell_to_facet(CellId::new(c))[local]);
            let is_image = cell.index() >= mesh.n_cells();
            let tag = if is_image {
                original(cell.index() - mesh.n_cells(), swapped(local))
            } else {
                original(cell.index(), local)
            };
            let name = mesh.tag_names()[tag?.index()].as_str();
            Some(if is_image { opposite::<D>(name, axis) } else { name })
        })
        .collect();
    Ok(whole.with_facet_tags(|facet| names[facet.index()]))
}

/// Returns the local vertex of the original for vertex `local` of the image.
fn swapped(local: usize) -> usize {
    match local {
        0 => 1,
        1 => 0,
        _ => local,
    }
}

fn opposite<const D: usize>(name: &str, axis: usize) -> &str {
    let [low, high] = side_names::<D>(axis);
    if name == low {
        high
    } else if name == high {
        low
    } else {
        name
    }
}

//! A half mesh completed by its mirror image.

use super::grid::side_names;
use crate::{CellId, Error, FacetId, Point, SimplexMesh, VertexId};

/// Vertices this close to the plane, relative to the extent of the mesh across it, count as lying on it.
const ON_PLANE: f64 = 1e-12;

/// The mesh together with its mirror image across the plane `x[axis] == plane`, welded in the vertices on the plane.
///
/// Vertices and cells of the given half come first and keep their ids; vertices within 1e-12 (relative to the extent
/// of the mesh) of the plane are put on it. Facets on the plane become interior. Mirrored facets keep the tag of
/// their original, except that the names of opposite sides across the plane are swapped: "left" and "right" for
/// axis 0, "front" and "back" (3D) or "bottom" and "top" (2D) for axis 1, "bottom" and "top" for axis 2.
///
/// # Errors
/// [`Error::Generate`]: no such axis, vertices on both sides of the plane, or no boundary facet on it.
pub fn mirrored<const D: usize>(mesh: &SimplexMesh<D>, axis: usize, plane: f64) -> Result<SimplexMesh<D>, Error> {
    if axis >= D {
        return Err(Error::Generate { what: "axis", value: axis as f64, must: "be below the dimension" });
    }
    if !plane.is_finite() {
        return Err(Error::Generate { what: "plane", value: plane, must: "be finite" });
    }
    let (low, high) = mesh
        .vertices()
        .iter()
        .fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x[axis] - plane), high.max(x[axis] - plane)));
    let tolerance = ON_PLANE * (high - low);
    if low < -tolerance && high > tolerance {
        return Err(Error::Generate { what: "plane", value: plane, must: "have the mesh on one side" });
    }
    let on_plane = |x: &Point<D>| (x[axis] - plane).abs() <= tolerance;
    let touches = |facet: FacetId| mesh.facet(facet).iter().all(|&v| on_plane(&mesh.vertex(v)));
    if !mesh.facets().any(touches) {
        return Err(Error::Generate { what: "plane", value: plane, must: "contain facets of the mesh" });
    }

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
        // Reflection turns a cell inside out; swapping two vertices turns it back.
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

/// Local vertex of the original that is vertex `local` of the image.
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

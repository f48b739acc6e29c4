//! Supports of a body: clamps, symmetry planes and prescribed displacements, as values of its velocity.

use algebra::{BlockLayout, DofId, FieldId};
use mesh::{FacetId, Point, Vector, VertexId};

use crate::error::length;
use crate::{Error, SolidMesh, StepRule};

/// What holds a part of the boundary.
#[derive(Clone, Copy)]
pub enum Support<'a, const D: usize> {
    /// The vertices stay where they are.
    Clamped,
    /// The vertices stay in the plane normal to a coordinate axis; tangential motion is free.
    Symmetry {
        /// Number of the axis, from 0.
        axis: usize,
    },
    /// Displacement at the end of the step, given at reference positions; components with `None` are free.
    Displacement(&'a (dyn Fn(&Point<D>) -> [Option<f64>; D] + Sync)),
}

/// Boundary facets with the tag of that name.
///
/// # Errors
/// [`Error::UnknownTag`]: the mesh has no such tag.
pub fn tagged_facets<const D: usize>(mesh: &SolidMesh<D>, name: &str) -> Result<Vec<FacetId>, Error> {
    let tag = mesh.mesh().tag(name).ok_or_else(|| Error::UnknownTag { name: name.to_owned() })?;
    Ok(mesh.boundary().facets().filter(|&f| mesh.boundary().tag(f) == Some(tag)).collect())
}

/// Boundary facets with none of the given tags, for example those that may come into contact.
///
/// # Errors
/// [`Error::UnknownTag`]: the mesh has no such tag.
pub fn facets_without_tags<const D: usize>(mesh: &SolidMesh<D>, names: &[&str]) -> Result<Vec<FacetId>, Error> {
    let mut excluded = Vec::with_capacity(names.len());
    for &name in names {
        excluded.push(mesh.mesh().tag(name).ok_or_else(|| Error::UnknownTag { name: name.to_owned() })?);
    }
    let free = |f: &FacetId| mesh.boundary().tag(*f).is_none_or(|tag| !excluded.contains(&tag));
    Ok(mesh.boundary().facets().filter(free).collect())
}

/// Vertices of boundary facets, each once, in order.
pub fn vertices_of<const D: usize>(mesh: &SolidMesh<D>, facets: &[FacetId]) -> Vec<VertexId> {
    let mut vertices: Vec<_> = facets.iter().flat_map(|&f| mesh.boundary().facet(f)).copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// Values of the velocity dofs that a support prescribes, each dof once.
///
/// Two supports that meet in a vertex may name the same dof; clamps and symmetry planes then agree.
///
/// # Errors
/// [`Error::Length`]: field or step rule do not fit the mesh. [`Error::Parameter`]: no such axis.
pub fn support_values<const D: usize>(
    mesh: &SolidMesh<D>,
    vertices: &[VertexId],
    support: Support<'_, D>,
    step: &StepRule<D>,
    layout: &BlockLayout,
    field: FieldId,
) -> Result<Vec<(DofId, f64)>, Error> {
    length("field of the body", layout.range(field).len(), mesh.n_dofs())?;
    length("step rule", step.n_vertices(), mesh.mesh().n_vertices())?;
    if let Support::Symmetry { axis } = support
        && axis >= D
    {
        return Err(Error::Parameter { what: "axis of symmetry", value: axis as f64, must: "below the dimension" });
    }
    let mut values = Vec::with_capacity(D * vertices.len());
    for &vertex in vertices {
        let velocity: [Option<f64>; D] = match support {
            Support::Clamped => [Some(0.0); D],
            Support::Symmetry { axis } => std::array::from_fn(|a| (a == axis).then_some(0.0)),
            Support::Displacement(displacement) => {
                let prescribed = displacement(&mesh.mesh().vertex(vertex));
                let reached = Vector::from_fn(|a, _| prescribed[a].unwrap_or(0.0));
                let v = step.velocity_to_reach(vertex.index(), &reached);
                std::array::from_fn(|a| prescribed[a].map(|_| v[a]))
            }
        };
        for (a, value) in velocity.into_iter().enumerate() {
            values.extend(value.map(|v| (layout.dof(field, D * vertex.index() + a), v)));
        }
    }
    Ok(values)
}

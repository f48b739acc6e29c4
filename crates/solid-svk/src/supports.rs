//! Supports of a body: clamps, symmetry planes and prescribed displacements, as values of its velocity.

use std::collections::BTreeMap;
use std::sync::Arc;

use algebra::Constraints;
use algebra::time::Affine;
use body::{BodyState, StepTime};
use mesh::{FacetId, Point, Vector, VertexId, unit_vector};

use crate::{Error, SolidCells, SolidMesh};

/// Displacement at a reference position and time; components with `None` are free.
pub type DisplacementField<const D: usize> = Arc<dyn Fn(&Point<D>, f64) -> [Option<f64>; D] + Send + Sync>;

/// A support of an elastic body.
#[derive(Clone)]
pub struct Support<const D: usize> {
    /// Nodes that the support holds.
    pub vertices: Vec<VertexId>,
    /// Constraint on these nodes.
    pub kind: SupportKind<D>,
}

/// Constraint of a support on its nodes.
#[derive(Clone)]
pub enum SupportKind<const D: usize> {
    /// No motion.
    Clamped,
    /// No motion along the normal of a plane.
    Symmetry {
        /// Unit normal of the plane, of either sign.
        normal: Vector<D>,
    },
    /// Displacement at the end of the step.
    Displacement(DisplacementField<D>),
}

impl<const D: usize> SupportKind<D> {
    /// Creates the symmetry on a plane across an axis with an index from 0 to `D - 1`.
    pub fn symmetry(axis: usize) -> Self {
        Self::Symmetry { normal: unit_vector(axis) }
    }
}

impl<const D: usize> Support<D> {
    /// Prescribes the velocities of the held nodes such that at the end of the step the velocity is zero (clamps), its
    /// normal component is zero (symmetry), or the displacement has the given value.
    ///
    /// A support replaces earlier supports of the same dof. Planes of symmetry must come last: they are combined, and
    /// do not change values that other supports prescribe.
    pub fn constrain(
        &self,
        cells: SolidCells<'_, D>,
        start: &BodyState<D>,
        time: &StepTime,
        constraints: &mut Constraints,
    ) {
        let SolidCells { solid, layout, velocity: field, .. } = cells;
        let end = Affine::new(&time.weights.displacement, &start.level);
        for &vertex in &self.vertices {
            let at_rest = |start: f64| time.weights.stage_velocity(0.0, start);
            let start = &start.velocity()[vertex.index()];
            let velocity: [Option<f64>; D] = match &self.kind {
                SupportKind::Clamped => std::array::from_fn(|a| Some(at_rest(start[a]))),
                SupportKind::Symmetry { normal } => {
                    let equation: Vec<_> = layout.node(field, vertex.index()).zip(normal.iter().copied()).collect();
                    constraints.impose(&equation, at_rest(normal.dot(start)));
                    continue;
                }
                SupportKind::Displacement(displacement) => {
                    let prescribed = displacement(&solid.nodes()[vertex.index()], time.end);
                    // v = (d - d_pred)/c_d
                    let still = end.at(vertex.index(), Vector::zeros());
                    std::array::from_fn(|a| prescribed[a].map(|d| (d - still[a]) / end.slope))
                }
            };
            for (dof, value) in layout.node(field, vertex.index()).zip(velocity) {
                if let Some(value) = value {
                    constraints.set(dof, value);
                }
            }
        }
    }
}

/// Sine of the angle between two planes of symmetry below which they are one plane.
const SAME_PLANE: f64 = 1e-9;

/// Removes the components of velocities that supports hold: all of a clamp, and the normal ones of symmetries.
pub(crate) fn stop<const D: usize>(supports: &[Support<D>], velocity: &mut [Vector<D>]) {
    // Orthonormal directions that are held, for each node.
    let mut held: BTreeMap<VertexId, Vec<Vector<D>>> = BTreeMap::new();
    for support in supports {
        let normals: Vec<Vector<D>> = match &support.kind {
            SupportKind::Clamped => (0..D).map(unit_vector).collect(),
            SupportKind::Symmetry { normal } => vec![*normal],
            SupportKind::Displacement(_) => Vec::new(),
        };
        for vertex in &support.vertices {
            let known = held.entry(*vertex).or_default();
            for normal in &normals {
                let rest = known.iter().fold(*normal, |rest, direction| rest - direction * direction.dot(&rest));
                known.extend(rest.try_normalize(SAME_PLANE));
            }
        }
    }
    for (vertex, directions) in held {
        let v = &mut velocity[vertex.index()];
        directions.iter().for_each(|direction| *v -= direction * direction.dot(v));
    }
}

/// Returns the boundary facets with the tag of that name.
///
/// # Errors
/// [`Error::UnknownTag`]: the mesh has no such tag.
pub fn tagged_facets<const D: usize>(mesh: &SolidMesh<D>, name: &str) -> Result<Vec<FacetId>, Error> {
    let tag = mesh.mesh().tag(name);
    let facets = mesh.boundary().facets().filter(|&f| tag.is_some() && mesh.boundary().tag(f) == tag);
    let facets: Vec<FacetId> = facets.collect();
    if facets.is_empty() { Err(Error::UnknownTag { name: name.to_owned() }) } else { Ok(facets) }
}

/// Returns the boundary facets with none of the given tags, for example those that may come into contact.
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

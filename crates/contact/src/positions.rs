//! Positions of the vertices of an obstacle.

use algebra::BlockLayout;
use body::SurfaceMotion;
use mesh::{Point, VertexId};

/// Positions of vertices: fixed, or those of a moving surface at the end of a step, evaluated where they are needed.
#[derive(Clone, Copy)]
pub enum Positions<'a, const D: usize> {
    /// Fixed positions, one per vertex; none for a rigid obstacle.
    Fixed(&'a [Point<D>]),
    /// Positions at the end of a step at the state `x`.
    Moving {
        /// The surface.
        surface: &'a SurfaceMotion<'a, D>,
        /// The layout.
        layout: &'a BlockLayout,
        /// The global vector.
        x: &'a [f64],
    },
}

impl<'a, const D: usize> Positions<'a, D> {
    /// Returns the positions of a surface at the end of a step; an empty list without a surface.
    pub fn at_end(surface: Option<&'a SurfaceMotion<'a, D>>, layout: &'a BlockLayout, x: &'a [f64]) -> Self {
        surface.map_or(Self::Fixed(&[]), |surface| Self::Moving { surface, layout, x })
    }

    /// Returns the position of a vertex.
    #[inline]
    pub fn at(&self, vertex: VertexId) -> Point<D> {
        match self {
            Self::Fixed(positions) => positions[vertex.index()],
            Self::Moving { surface, layout, x } => surface.position_at(vertex, layout, x),
        }
    }

    /// Returns the positions of all vertices.
    pub(crate) fn all(&self) -> Vec<Point<D>> {
        match self {
            Self::Fixed(positions) => positions.to_vec(),
            Self::Moving { surface, .. } => (0..surface.start.len()).map(|k| self.at(VertexId::new(k))).collect(),
        }
    }
}

//! Stress of the fluid on the surface of a body.

use algebra::DofId;
use body::{ByDof, SurfaceStress};
use mesh::{BodyId, FacetId, MAX_CELL_VERTICES, Tensor, Vector};

use crate::InterfacePoints;

/// Barycentric coordinates above minus this value lie inside a piece.
const INSIDE: f64 = 1e-9;

/// Traction `T^f n` of the fluid in front of a body, `n` out of the body; zero where there is no fluid, because bodies
/// overlap or the facet lies outside the background.
pub struct FluidStress<'a, const D: usize> {
    points: InterfacePoints<'a, D>,
    /// Interface pieces on each facet, sorted by facet.
    pieces: Vec<(FacetId, usize)>,
}

impl<'a, const D: usize> FluidStress<'a, D> {
    /// Creates the stress on the surface of a body.
    pub fn new(points: InterfacePoints<'a, D>, body: BodyId) -> Self {
        let pieces = points.geometry.cut.interface().iter().enumerate().filter(|(_, piece)| piece.body == body);
        let mut pieces: Vec<_> = pieces.map(|(item, piece)| (piece.facet, item)).collect();
        pieces.sort_unstable();
        Self { points, pieces }
    }

    fn on_facet(&self, facet: FacetId) -> impl Iterator<Item = usize> {
        let begin = self.pieces.partition_point(|(other, _)| *other < facet);
        self.pieces[begin..].iter().take_while(move |(other, _)| *other == facet).map(|(_, item)| *item)
    }

    /// Returns whether a piece contains the point with given barycentric coordinates of its facet.
    fn contains(&self, item: usize, barycentric: &[f64]) -> bool {
        let corners = &self.points.geometry.cut.interface()[item].barycentric;
        let matrix = Tensor::<D>::from_fn(|row, column| corners[column][row]);
        let point = Vector::from_fn(|a, _| barycentric[a]);
        matrix.try_inverse().is_some_and(|inverse| (inverse * point).iter().all(|c| *c > -INSIDE))
    }
}

impl<const D: usize> SurfaceStress<D> for FluidStress<'_, D> {
    fn dofs(&self, facet: FacetId, out: &mut Vec<DofId>) {
        let InterfacePoints { geometry, fields, .. } = &self.points;
        let first = out.len();
        for item in self.on_facet(facet) {
            for &dof in geometry.space.dofs(geometry.cut.interface()[item].part) {
                let node = dof as usize;
                let dofs = fields.layout.node(fields.velocity, node).chain(fields.layout.node(fields.pressure, node));
                for dof in dofs {
                    if !out[first..].contains(&dof) {
                        out.push(dof);
                    }
                }
            }
        }
    }

    fn at(&self, facet: FacetId, barycentric: &[f64], x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        let InterfacePoints { geometry, fields, values, fluid, .. } = &self.points;
        derivatives.clear();
        let Some(item) = self.on_facet(facet).find(|&item| self.contains(item, barycentric)) else {
            return Vector::zeros();
        };
        let piece = &geometry.cut.interface()[item];
        let gradients = values.gradients(item);
        let shape = self.shape(item, barycentric);
        let (mut grad_u, mut pressure) = (Tensor::<D>::zeros(), 0.0);
        for (i, &dof) in geometry.space.dofs(piece.part).iter().enumerate() {
            grad_u += fields.velocity_at::<D>(x, dof) * gradients[i].transpose();
            pressure += fields.pressure_at(x, dof) * shape[i];
            let by_velocity = fluid.viscous_traction_by_velocity(&gradients[i], &piece.normal);
            let columns = (0..D).map(|b| by_velocity.column(b).into_owned()).chain([piece.normal * -shape[i]]);
            let node = dof as usize;
            let of_node = fields.layout.node(fields.velocity, node).chain(fields.layout.node(fields.pressure, node));
            derivatives.extend(of_node.zip(columns));
        }
        fluid.viscous_traction(&grad_u, &piece.normal) - piece.normal * pressure
    }
}

impl<const D: usize> FluidStress<'_, D> {
    /// Returns the shape values of the fluid part of a piece at a point of its facet.
    fn shape(&self, item: usize, barycentric: &[f64]) -> [f64; MAX_CELL_VERTICES] {
        let InterfacePoints { geometry, surfaces, positions, .. } = &self.points;
        let piece = &geometry.cut.interface()[item];
        let (surface, positions) = (surfaces[piece.body.index()], &positions[piece.body.index()]);
        let vertices = surface.boundary.facet(piece.facet).iter().zip(barycentric);
        let point = vertices.map(|(vertex, b)| positions[vertex.index()] * *b).sum();
        geometry.background.simplex(piece.cell).barycentric(&point).unwrap_or_default()
    }
}

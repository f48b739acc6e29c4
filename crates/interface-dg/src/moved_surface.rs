//! The surface of a body at the stage of a step, compared with the surface at which the fluid is cut.

use algebra::time::Affine;
use algebra::{BlockLayout, DofId, Sites};
use body::SurfaceMotion;
use mesh::{FacetId, Point, SimplexRule, Tensor, Vector, area_vector};

/// The surface of a body whose motion is unknown: one item per facet with a pressure, several sites.
///
/// The moved positions are those at the stage, which depend on the unknown velocity. Those of the cut are
/// [`SurfaceMotion::geometry`].
#[derive(Clone)]
pub struct MovedSurface<'a, const D: usize> {
    surface: &'a SurfaceMotion<'a, D>,
    layout: &'a BlockLayout,
    reference: &'a [Point<D>],
    displacement: Affine<Vector<D>>,
    pressures: &'a [f64],
    facets: Vec<FacetId>,
    rule: &'static SimplexRule,
}

/// A quadrature point of a facet, at its moved position and at that of the cut.
pub struct MovedPoint<const D: usize> {
    /// Pressure on the facet.
    pub pressure: f64,
    /// Shape values of the vertices of the facet. Local unknowns are their velocities, `D` each.
    pub shape: [f64; D],
    /// Area vector `n dA` out of the body at the moved position minus that on the cut, with the quadrature weight and
    /// the weight of the coordinates.
    pub change: Vector<D>,
    /// Derivatives of `change` with respect to the velocities of the vertices: column `b` is that by component `b`.
    pub by_velocity: [Tensor<D>; D],
}

impl<const D: usize> MovedPoint<D> {
    /// Returns the first local row of the velocity of a vertex of the facet.
    pub(crate) fn row(&self, vertex: usize) -> usize {
        D * vertex
    }
}

impl<'a, const D: usize> MovedSurface<'a, D> {
    /// Creates the points of a surface from the reference positions of its vertices, their displacements at the stage,
    /// and the pressures on the facets. There are none on facets without pressure, and if the motion of the body is
    /// prescribed.
    pub fn new(
        (surface, layout): (&'a SurfaceMotion<'a, D>, &'a BlockLayout),
        (reference, displacement): (&'a [Point<D>], Affine<Vector<D>>),
        pressures: &'a [f64],
    ) -> Self {
        let degree = 1 + surface.boundary.coordinates().degree();
        let has_pressure = |facet: &FacetId| surface.field().is_some() && pressures[facet.index()] != 0.0;
        let facets = surface.boundary.facets().filter(has_pressure).collect();
        let rule = SimplexRule::of_degree(D - 1, degree);
        Self { surface, layout, reference, displacement, pressures, facets, rule }
    }

    /// Returns whether area vectors with the weight of the coordinates are linear in the positions: their degree is
    /// one.
    pub fn is_linear(&self) -> bool {
        D - 1 + self.surface.boundary.coordinates().degree() == 1
    }

    /// Returns the force on the body at the state `x`. In axisymmetric coordinates the radial component is not set to
    /// zero ([`mesh::Coordinates::resultant`]).
    pub fn force(&self, x: &[f64]) -> Vector<D> {
        let mut force = Vector::zeros();
        (0..self.len()).for_each(|item| self.visit(item, x, |point| force -= point.change * point.pressure));
        force
    }
}

/// Returns the area vector of a facet, and its derivatives with respect to the positions of the vertices.
fn area<const D: usize>(points: &[Point<D>; D]) -> (Vector<D>, [Tensor<D>; D]) {
    let simplex = 1.0 / (1..D).product::<usize>() as f64;
    let mut edges = Tensor::<D>::zeros();
    (1..D).for_each(|k| edges.set_column(k, &(points[k] - points[0])));
    let mut by_vertex = [Tensor::<D>::zeros(); D];
    for k in 1..D {
        for b in 0..D {
            let mut varied = edges;
            varied.column_mut(k).fill(0.0);
            varied[(b, k)] = simplex;
            by_vertex[k].set_column(b, &area_vector(&varied));
        }
        let along = by_vertex[k];
        by_vertex[0] -= along;
    }
    (area_vector(&edges) * simplex, by_vertex)
}

impl<const D: usize> Sites for MovedSurface<'_, D> {
    type Site = MovedPoint<D>;

    fn len(&self) -> usize {
        self.facets.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let vertices = self.surface.boundary.facet(self.facets[item]).iter();
        let field = self.surface.field().into_iter();
        out.extend(field.flat_map(|field| vertices.clone().flat_map(move |v| self.layout.node(field, v.index()))));
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        let (surface, coordinates) = (self.surface, self.surface.boundary.coordinates());
        let vertices = surface.boundary.facet(self.facets[item]);
        let of_vertices = |of: &dyn Fn(usize) -> Point<D>| -> [Point<D>; D] { std::array::from_fn(of) };
        let moved = of_vertices(&|k| {
            let velocity = surface.velocity_at(vertices[k], self.layout, x);
            self.reference[vertices[k].index()] + self.displacement.at(vertices[k].index(), velocity)
        });
        let cut = of_vertices(&|k| surface.geometry[vertices[k].index()]);
        let ((of_moved, by_vertex), (of_cut, _)) = (area(&moved), area(&cut));
        for (local, weight) in self.rule.points().iter().zip(self.rule.weights()) {
            let shape: [f64; D] = std::array::from_fn(|k| local[k]);
            let at = |points: &[Point<D>; D]| points.iter().zip(&shape).map(|(x, n)| x * *n).sum::<Point<D>>();
            let [by_moved, by_cut] = [&moved, &cut].map(|points| weight * coordinates.weight(&at(points)));
            let by_position = coordinates.weight_gradient::<D>() * *weight;
            let slope = self.displacement.slope;
            visit(&MovedPoint {
                pressure: self.pressures[self.facets[item].index()],
                shape,
                change: of_moved * by_moved - of_cut * by_cut,
                by_velocity: std::array::from_fn(|k| {
                    (by_vertex[k] * by_moved + of_moved * (by_position * shape[k]).transpose()) * slope
                }),
            });
        }
    }
}

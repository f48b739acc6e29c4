//! Stress of the fluid on the surface of a body.

use std::sync::Arc;

use algebra::{BlockLayout, DofId};
use body::{ByDof, SurfaceMotion, SurfaceStress};
use cutcell::InterfacePiece;
use mesh::{BodyId, Coordinates, FacetId, MAX_CELL_VERTICES, Placed, Point, Vector, are_opposite, mean};

use crate::InterfacePoints;

/// A facet is closed in part if pieces cover less than this fraction of it.
const WET: f64 = 1.0 - 1e-9;

/// Mean over each facet of the traction `T^f n` of the fluid in front of a body, `n` out of the body.
///
/// The mean is used because the stress of a linear solid is constant in the cell behind a facet and balances the mean
/// of the traction. In a film the pressure varies over a facet by more than the contact traction. The pointwise
/// difference of the stresses is then not the contact traction, and a law that depends on it may have no solution.
///
/// The surface is *closed* where it borders no fluid: bodies touch or overlap there, or the facet lies outside the
/// background. The traction on closed parts is `-p n`. The pressure `p` is continued from the middle of the nearest
/// interface piece of the body as in fluid at rest, `∇p = f` with the force `f` per volume; it is zero if there is no
/// piece. Pieces that face the other way count only if there are no others: those on the far side of a thin part have
/// the pressure there. The model: between rough surfaces in contact there is fluid that is connected to the fluid at
/// the rim.
///
/// Source: Ager, Schott, Vuong, Popp, Wall 2019, doi:10.1002/nme.6094, who continue stresses of the fluid into the
/// contact zone.
pub struct FluidStress<'a, const D: usize> {
    points: InterfacePoints<'a, D>,
    body: BodyId,
    /// Facet and index of each interface piece of the body, sorted.
    pieces: Vec<(FacetId, usize)>,
    /// Facets that are closed in part or as a whole, sorted.
    closed: Vec<ClosedFacet<D>>,
}

/// A facet that is closed in part or as a whole.
struct ClosedFacet<const D: usize> {
    facet: FacetId,
    /// Index of the nearest interface piece of the same body that does not face the other way.
    rim: usize,
    /// The middle of this piece.
    middle: Point<D>,
    /// Force per volume on the fluid at `middle`.
    body_force: Vector<D>,
    /// Shape values of the fluid nodes of this piece at `middle`.
    shape: [f64; MAX_CELL_VERTICES],
}

impl<'a, const D: usize> FluidStress<'a, D> {
    /// Creates the stress on the surface of a body. `body_force` is the force per volume on the fluid at a point.
    pub fn new(points: InterfacePoints<'a, D>, body: BodyId, body_force: impl Fn(&Point<D>) -> Vector<D>) -> Self {
        let pieces = points.geometry.cut.interface().iter().enumerate().filter(|(_, piece)| piece.body == body);
        let mut pieces: Vec<_> = pieces.map(|(item, piece)| (piece.facet, item)).collect();
        pieces.sort_unstable();
        let mut stress = Self { points, body, pieces, closed: Vec::new() };
        stress.closed = stress.closed_facets(body_force);
        stress
    }

    /// Returns the surface of the body as it was cut.
    pub(crate) fn surface(&self) -> Placed<'_, D> {
        let body = self.body.index();
        Placed::new(self.points.surfaces[body].boundary, &self.points.surfaces[body].geometry)
    }

    /// Returns the interface pieces on a facet.
    pub(crate) fn pieces_of(&self, facet: FacetId) -> impl Iterator<Item = &InterfacePiece<D>> {
        self.on_facet(facet).map(|item| &self.points.geometry.cut.interface()[item])
    }

    /// Finds the facets that pieces do not cover completely, and the nearest piece of each.
    fn closed_facets(&self, body_force: impl Fn(&Point<D>) -> Vector<D>) -> Vec<ClosedFacet<D>> {
        let (surface, geometry) = (self.surface(), &self.points.geometry);
        let pieces = geometry.cut.interface();
        let is_closed = |facet: &FacetId| {
            let wet: f64 = self.pieces_of(*facet).map(|piece| piece.measure).sum();
            wet < WET * surface.facet_measure(*facet)
        };
        let nearest = |facet: FacetId| {
            let of_facet = surface.facet_middle(facet);
            let normal = surface.facet_normal(facet);
            let key = |item: usize| {
                (
                    are_opposite(&pieces[item].normal, &normal),
                    (mean(&pieces[item].points[..D]) - of_facet).norm_squared(),
                )
            };
            let is_before = |a: (bool, f64), b: (bool, f64)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
            let rim = self.pieces.iter().map(|(_, item)| *item).min_by(|a, b| is_before(key(*a), key(*b)))?;
            let middle = mean(&pieces[rim].points[..D]);
            let shape = geometry.background.simplex(pieces[rim].cell).barycentric(&middle).unwrap_or_default();
            Some(ClosedFacet { facet, rim, middle, body_force: body_force(&middle), shape })
        };
        surface.boundary().facets().filter(is_closed).filter_map(nearest).collect()
    }

    /// Returns the facets that are closed in part or as a whole, sorted.
    pub(crate) fn closed(&self) -> impl ExactSizeIterator<Item = FacetId> {
        self.closed.iter().map(|closed| closed.facet)
    }

    /// Returns the data of a closed facet; `None` if pieces cover the facet.
    fn rim(&self, facet: FacetId) -> Option<&ClosedFacet<D>> {
        let found = self.closed.binary_search_by_key(&facet, |closed| closed.facet).ok()?;
        Some(&self.closed[found])
    }

    /// Returns the pressure dofs of the nearest piece of a closed facet, with their shape values in its middle.
    pub(crate) fn rim_pressures(&self, facet: FacetId) -> impl Iterator<Item = (DofId, f64)> {
        let InterfacePoints { geometry, fields, .. } = &self.points;
        self.rim(facet).into_iter().flat_map(|closed| {
            let nodes = geometry.space.dofs(geometry.cut.interface()[closed.rim].part).iter().zip(closed.shape);
            nodes.flat_map(|(&node, shape)| {
                fields.layout.node(fields.pressure, node as usize).map(move |dof| (dof, shape))
            })
        })
    }

    /// Returns the pressure at a point of a closed facet.
    pub(crate) fn closed_pressure(&self, facet: FacetId, point: &Point<D>, x: &[f64]) -> f64 {
        let at_rim: f64 = self.rim_pressures(facet).map(|(dof, shape)| x[dof.index()] * shape).sum();
        at_rim + self.rim(facet).map_or(0.0, |closed| closed.body_force.dot(&(point - closed.middle)))
    }

    /// Returns the traction at a point of the closed part of a facet, and appends its derivatives.
    fn on_closed(&self, facet: FacetId, barycentric: &[f64], x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        let normal = self.surface().facet_normal(facet);
        derivatives.extend(self.rim_pressures(facet).map(|(dof, shape)| (dof, normal * -shape)));
        normal * -self.closed_pressure(facet, &self.position(facet, barycentric), x)
    }

    /// Returns the position of a point of a facet as it was cut.
    pub(crate) fn position(&self, facet: FacetId, barycentric: &[f64]) -> Point<D> {
        self.surface().facet_points(facet)[..D].iter().zip(barycentric).map(|(x, b)| x * *b).sum()
    }

    /// Returns the motion of the surface and the layout.
    pub(crate) fn motion(&self) -> (&SurfaceMotion<'a, D>, &BlockLayout) {
        (self.points.surfaces[self.body.index()], self.points.fields.layout)
    }

    /// Returns the indices of the interface pieces on a facet.
    fn on_facet(&self, facet: FacetId) -> impl Iterator<Item = usize> {
        let start = self.pieces.partition_point(|(other, _)| *other < facet);
        self.pieces[start..].iter().take_while(move |(other, _)| *other == facet).map(|(_, item)| *item)
    }
}

impl<const D: usize> SurfaceStress<D> for FluidStress<'_, D> {
    fn dofs(&self, facet: FacetId, out: &mut Vec<DofId>) {
        let InterfacePoints { geometry, fields, .. } = &self.points;
        let first = out.len();
        for item in self.on_facet(facet).chain(self.rim(facet).map(|closed| closed.rim)) {
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

    fn on(&self, facet: FacetId, x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        derivatives.clear();
        let (surface, coordinates) = (self.surface(), self.points.geometry.background.coordinates());
        let measure = surface.weighted_measure(facet);
        if measure == 0.0 {
            // A facet on the axis of axisymmetric coordinates.
            return Vector::zeros();
        }
        // Closed fraction of the facet, and the barycentric coordinates of the centroid of the closed part times this
        // fraction.
        let (mut share, mut moments) = (1.0, shares(coordinates, &surface.facet_points(facet)[..D]));
        let (mut sum, mut of_part) = (Vector::zeros(), Vec::new());
        for item in self.on_facet(facet) {
            let piece = &self.points.geometry.cut.interface()[item];
            let points = &piece.points[..D];
            let wet = piece.measure * coordinates.weight(&mean(points)) / measure;
            let shares = shares(coordinates, points);
            sum += self.on_piece(item, x, &mut of_part) * wet;
            add_to(derivatives, &mut of_part, wet);
            share -= wet;
            for (k, moment) in moments.iter_mut().enumerate() {
                *moment -= wet
                    * piece.barycentric[..D].iter().zip(&shares).map(|(corner, share)| corner[k] * share).sum::<f64>();
            }
        }
        if self.rim(facet).is_some() && share > 0.0 {
            sum += self.on_closed(facet, &moments.map(|moment| moment / share), x, &mut of_part) * share;
            add_to(derivatives, &mut of_part, share);
        }
        sum
    }
}

impl<const D: usize> FluidStress<'_, D> {
    /// Returns the mean of the traction on a piece, with the weight of the coordinates, and appends its derivatives.
    fn on_piece(&self, item: usize, x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        let InterfacePoints { geometry, fields, values, fluid, .. } = &self.points;
        let piece = &geometry.cut.interface()[item];
        let gradients = values.gradients(item);
        let points = &piece.points[..D];
        let centroid = shares(geometry.background.coordinates(), points).iter().zip(points).map(|(s, x)| x * *s).sum();
        let shape = geometry.background.simplex(piece.cell).barycentric(&centroid).unwrap_or_default();
        let dofs = geometry.space.dofs(piece.part);
        let (grad_u, pressure) = fields.grad_and_pressure(x, dofs, gradients, &shape);
        for (i, &dof) in dofs.iter().enumerate() {
            let by_velocity = fluid.viscous_traction_by_velocity(&gradients[i], &piece.normal);
            let columns = (0..D).map(|b| by_velocity.column(b).into_owned()).chain([piece.normal * -shape[i]]);
            let node = dof as usize;
            let of_node = fields.layout.node(fields.velocity, node).chain(fields.layout.node(fields.pressure, node));
            derivatives.extend(of_node.zip(columns));
        }
        fluid.viscous_traction(&grad_u, &piece.normal) - piece.normal * pressure
    }
}

/// Returns the weights with which the values of a linear function at the corners of a facet add up to its mean,
/// weighted by [`Coordinates::weight`]. They are the barycentric coordinates of the centroid.
fn shares<const D: usize>(coordinates: Coordinates, corners: &[Point<D>]) -> [f64; D] {
    let weights: [f64; D] = std::array::from_fn(|k| coordinates.weight(&corners[k]));
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| (sum + weight) / ((D + 1) as f64 * sum))
}

/// Adds the derivatives of a part times a factor to those of the sum, and empties the part.
fn add_to<const D: usize>(sum: &mut ByDof<D>, part: &mut ByDof<D>, factor: f64) {
    for (dof, derivative) in part.drain(..) {
        match sum.iter_mut().find(|(known, _)| *known == dof) {
            Some((_, total)) => *total += derivative * factor,
            None => sum.push((dof, derivative * factor)),
        }
    }
}

/// Traction of the stress of a body minus the traction of the fluid on its surface: the traction of contact.
pub struct StressJump<'a, const D: usize> {
    /// The stress of the body.
    pub solid: Arc<dyn SurfaceStress<D> + 'a>,
    /// The stress of the fluid.
    pub fluid: Arc<FluidStress<'a, D>>,
}

impl<const D: usize> SurfaceStress<D> for StressJump<'_, D> {
    fn dofs(&self, facet: FacetId, out: &mut Vec<DofId>) {
        self.solid.dofs(facet, out);
        self.fluid.dofs(facet, out);
    }

    fn on(&self, facet: FacetId, x: &[f64], derivatives: &mut ByDof<D>) -> Vector<D> {
        let mut of_fluid = Vec::new();
        let fluid = self.fluid.on(facet, x, &mut of_fluid);
        let solid = self.solid.on(facet, x, derivatives);
        // The two stresses depend on different fields, so that no dof occurs twice.
        derivatives.extend(of_fluid.into_iter().map(|(dof, derivative)| (dof, -derivative)));
        solid - fluid
    }

    fn stiffness(&self, facet: FacetId) -> f64 {
        self.solid.stiffness(facet)
    }
}

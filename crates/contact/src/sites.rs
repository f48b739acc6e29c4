//! Contact points of one step, with the facets of the obstacle in reach.

use std::sync::Arc;

use algebra::{BlockLayout, DofId, RegimeHash, Sites};
use body::{ByDof, SurfaceMotion, SurfaceStress};
use mesh::{
    BoundaryMesh, Coordinates, FacetId, MAX_FACET_NODES, MAX_FACET_VERTICES, Order, Placed, Point, SimplexRule, Vector,
    VertexId, positive,
};

use crate::law::discrete_gradient;
use crate::near::NearFacets;
use crate::segments::{Segment, divide};
use crate::site::ContactNode;
use crate::{Anchor, ContactLaw, ContactPoint, ContactSite, Error, Frame, Local, Obstacle, Positions, StressSource};

/// Upper bound of the sum of the absolute values of the shape functions at a point of a facet, of either order.
const SUM_OF_SHAPES: f64 = 2.0;

/// Round-off of gaps, relative to the contact size.
const ROUND_OFF: f64 = 1e-9;

/// Law, contact size and quadrature of a contact.
#[derive(Clone, Debug)]
pub struct ContactForm<const D: usize> {
    /// The law.
    pub law: Arc<dyn ContactLaw>,
    size: f64,
    rule: SimplexRule,
    /// Rule for segments that begin on the axis of axisymmetric coordinates.
    axis_rule: SimplexRule,
}

impl<const D: usize> ContactForm<D> {
    /// Creates a contact with a law and the contact size `s`, integrated with a rule that contains the vertices of the
    /// facets.
    ///
    /// # Errors
    /// [`Error::Parameter`]: contact size not positive.
    pub fn new(law: impl ContactLaw + 'static, size: f64) -> Result<Self, Error> {
        positive("contact size", size)?;
        Ok(Self {
            law: Arc::new(law),
            size,
            rule: SimplexRule::with_vertices(D - 1),
            axis_rule: SimplexRule::lobatto_segment_from_axis(),
        })
    }

    /// Returns the contact size `s`.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Returns the quadrature points of a segment: their barycentric coordinates in the facet, whose points `place`
    /// returns, and their weights relative to the measure of the segment. They contain the weight of the coordinates.
    /// Where the segment begins on the axis, the rule has the radius as a factor; with the other one the end on the
    /// axis, which is the first point of a body to touch, would have no weight.
    fn points_of(
        &self,
        segment: &Segment<D>,
        place: impl Fn(&[f64; D]) -> Point<D>,
        coordinates: Coordinates,
    ) -> Vec<([f64; D], f64)> {
        let weight_at = |shape: [f64; D]| coordinates.weight(&place(&shape));
        let at_ends = segment.corners.map(weight_at);
        let on_axis = at_ends.iter().position(|weight| *weight == 0.0);
        let mean = at_ends.iter().sum::<f64>() / D as f64;
        let rule = if on_axis.is_some() { &self.axis_rule } else { &self.rule };
        let points = rule.points().iter().zip(rule.weights()).map(|(&(mut point), weight)| {
            point.swap(0, on_axis.unwrap_or(0));
            let shape = segment.at(&point);
            (shape, weight * if on_axis.is_some() { mean } else { weight_at(shape) })
        });
        points.collect()
    }
}

/// Slave and obstacle in one step.
#[derive(Clone)]
pub struct ContactPair<'a, const D: usize> {
    /// Law, size and quadrature.
    pub form: &'a ContactForm<D>,
    /// The surface that is integrated over.
    pub slave: &'a SurfaceMotion<'a, D>,
    /// Facets of the slave that may come into contact, without symmetry lines and clamped parts.
    pub facets: &'a [FacetId],
    /// Geometry that the slave must not enter.
    pub obstacle: &'a dyn Obstacle<D>,
    /// The surface of a deformable obstacle.
    pub master: Option<&'a SurfaceMotion<'a, D>>,
    /// Traction on the slave's surface, if the law depends on it.
    pub stress: Option<Arc<dyn SurfaceStress<D> + 'a>>,
    /// Factor of the traction: a half if the law depends on a stress and both surfaces are slaves, else one.
    pub share: f64,
    /// Whether a law with energy acts as a discrete gradient over the step; otherwise it acts at the end.
    pub conserves: bool,
}

/// Checks that facets and surfaces fit together.
///
/// # Errors
/// [`Error::UnknownFacet`]: the slave's surface does not have one of the facets. [`Error::Master`]: a deformable
/// obstacle without its surface or with another one, or a rigid obstacle with a surface.
pub fn check_pair<const D: usize>(
    slave: &BoundaryMesh<D>,
    facets: &[FacetId],
    obstacle: &dyn Obstacle<D>,
    master: Option<&BoundaryMesh<D>>,
) -> Result<(), Error> {
    let n_facets = slave.n_facets();
    if let Some(&facet) = facets.iter().find(|f| f.index() >= n_facets) {
        return Err(Error::UnknownFacet { facet, n_facets });
    }
    if obstacle.boundary() == master { Ok(()) } else { Err(Error::Master) }
}

/// Facets that may touch in one step, with their segments, measures and dofs. It borrows nothing.
#[derive(Clone, Debug)]
pub struct ContactItems<const D: usize> {
    items: Vec<Item<D>>,
    /// Whether candidates were searched within the reach; false for an obstacle without facets.
    is_searched: bool,
    /// Whether the law acts as a discrete gradient.
    is_gradient: bool,
}

/// A facet of the slave with an obstacle in reach.
#[derive(Clone, Debug)]
struct Item<const D: usize> {
    facet: FacetId,
    /// Facets of the obstacle that the facet may touch.
    candidates: Vec<FacetId>,
    /// Quadrature points. Those of one segment, on which the master's shape functions have no kinks, follow each other.
    points: Vec<SlavePoint<D>>,
    /// Nodes of the candidates, each once, in order, with their first local rows.
    masters: Vec<(VertexId, Option<usize>)>,
    /// Dofs, each once: those of slave, master and stress.
    dofs: Vec<DofId>,
    /// Gap at the start of the step at each point, and the smaller one of this and that to the closest point. Infinite
    /// if it is not known; an empty list if no gap at the start is used.
    begin_gaps: Vec<[f64; 2]>,
    /// Multiplier at each point; an empty list means zero, and laws without multipliers.
    multipliers: Vec<Local>,
}

/// A quadrature point of a facet of the slave.
#[derive(Clone, Debug)]
struct SlavePoint<const D: usize> {
    /// Index of the segment within the item.
    segment: usize,
    /// Shape functions of the nodes of the facet ([`BoundaryMesh::nodes`]).
    shape: [f64; MAX_FACET_NODES],
    /// Quadrature weight with the measure of the element at the start of the step.
    weight: f64,
    /// Flat facet of the obstacle under the whole segment, onto whose plane the point is projected: at a kink of the
    /// obstacle each segment has the normal of its facet. `None` if the closest point is searched.
    facet: Option<FacetId>,
    /// Whether the point is past the end of the obstacle at the start of the step.
    is_past_end: bool,
}

/// Multipliers of all points of a contact after a solve.
#[derive(Clone, Debug)]
pub struct Multipliers {
    /// Components of the multipliers, one after another.
    pub components: Vec<f64>,
    /// Largest change of a traction since the previous solve, force per area.
    pub change: f64,
    /// Largest traction, force per area.
    pub largest: f64,
}

/// Returns the local row of a dof; appends the dof if it is new.
fn row_of(dof: DofId, dofs: &mut Vec<DofId>) -> usize {
    dofs.iter().position(|known| *known == dof).unwrap_or_else(|| {
        dofs.push(dof);
        dofs.len() - 1
    })
}

impl<const D: usize> ContactItems<D> {
    /// Returns whether candidates were searched within the reach; false for an obstacle without facets.
    pub fn is_searched(&self) -> bool {
        self.is_searched
    }

    /// Returns the slave's facet of an item.
    pub(crate) fn facet(&self, item: usize) -> FacetId {
        self.items[item].facet
    }

    /// Returns the slave's facets with an obstacle in reach, each with its candidates.
    pub(crate) fn candidates(&self) -> impl Iterator<Item = (FacetId, &[FacetId])> {
        self.items.iter().map(|item| (item.facet, &item.candidates[..]))
    }

    /// Sets a pressure at all points as multipliers of the first solve.
    pub fn begin_with(&mut self, pressure: f64) {
        for item in &mut self.items {
            item.multipliers = vec![[-pressure, 0.0, 0.0]; item.points.len()];
        }
    }

    /// Returns the components of the multipliers of all points.
    pub fn multipliers(&self) -> Vec<f64> {
        let of_item = |item: &Item<D>| {
            let mut values = item.multipliers.clone();
            values.resize(item.points.len(), Local::default());
            values
        };
        self.items.iter().flat_map(of_item).flatten().collect()
    }

    /// Sets the multipliers of the next solve to the first components of a list ([`Multipliers::components`]), and
    /// removes these from it.
    pub fn set_multipliers(&mut self, components: &mut &[f64]) {
        for item in &mut self.items {
            let (own, rest) = components.as_chunks().0.split_at(item.points.len());
            (item.multipliers, *components) = (own.to_vec(), rest.as_flattened());
        }
    }

    /// Finds candidates within the distance `reach` of the slave's facets at the start of the step. `reach` must be at
    /// least the offset of the law plus the relative motion in the step: a point without candidates has no traction.
    pub fn new(pair: &ContactPair<'_, D>, layout: &BlockLayout, reach: f64) -> Self {
        let &ContactPair { slave, facets, obstacle, master, .. } = pair;
        let placed = Placed::new(slave.boundary, &slave.start);
        let positions = master.map_or(&[][..], |master| &master.start);
        let mut items = Vec::new();
        let candidates = obstacle.candidates(placed, facets, positions, reach);
        let is_searched = candidates.is_some();
        let is_gradient = pair.conserves && pair.form.law.energy_density(&ContactPoint::default()).is_some();
        let candidates = candidates.unwrap_or_else(|| vec![Vec::new(); facets.len()]);
        for (&facet, candidates) in facets.iter().zip(candidates) {
            if is_searched && candidates.is_empty() {
                continue;
            }
            let mut dofs = Vec::new();
            let mut first_row = |surface: &SurfaceMotion<'_, D>, vertex: VertexId| {
                let nodes = surface.field().map(|field| layout.node(field, vertex.index()));
                // The dofs of a node follow each other, unless some of them were appended before.
                nodes.and_then(|dofs_of| dofs_of.map(|dof| row_of(dof, &mut dofs)).min())
            };
            for &node in slave.boundary.nodes(facet) {
                first_row(slave, node);
            }
            let (mut segments, mut masters) = (vec![Segment::whole()], Vec::new());
            // A law of collisions has no traction to integrate.
            let is_divided = pair.form.law.restitution().is_none();
            if let Some(master) = master {
                let opposite = Placed::new(master.boundary, &master.geometry);
                let own = Placed::new(slave.boundary, &slave.geometry);
                let corners = |points: [Point<D>; MAX_FACET_VERTICES]| std::array::from_fn(|k| points[k]);
                let opposite = candidates.iter().map(|&candidate| corners(opposite.facet_points(candidate)));
                if is_divided {
                    segments = divide(&corners(own.facet_points(facet)), opposite, slave.boundary.coordinates());
                }
                let nodes = master.boundary.nodes_of(&candidates);
                masters = nodes.into_iter().map(|node| (node, first_row(master, node))).collect();
            }
            let mut of_stress = Vec::new();
            pair.stress.iter().for_each(|stress| stress.dofs(facet, &mut of_stress));
            of_stress.into_iter().for_each(|dof| _ = row_of(dof, &mut dofs));
            let (nodes, coordinates) = (placed.nodes(facet), slave.boundary.coordinates());
            let place = |at: &[f64; D]| slave.boundary.shape(facet, at).at(&nodes);
            let mut points = Vec::new();
            for (number, segment) in segments.iter().enumerate() {
                let is_flat = slave.boundary.order() == Order::Linear;
                let under = master.filter(|_| is_divided && is_flat).and_then(|master| {
                    let vertices = Placed::new(slave.boundary, &slave.geometry).facet_points(facet);
                    let at = |corner: &[f64; D]| vertices.iter().zip(corner).map(|(vertex, b)| vertex * *b).sum();
                    let corners = segment.corners.each_ref().map(at);
                    let under = obstacle.facet_under(&corners, Positions::Fixed(&master.geometry), &candidates);
                    // Its points must be near the facet at the start as well.
                    let start = |corner: &[f64; D]| nodes.iter().zip(corner).map(|(node, b)| node * *b).sum();
                    let at_start = Positions::Fixed(positions);
                    let is_near = |facet: &FacetId| {
                        let mut corners = segment.corners.iter();
                        corners.all(|corner| obstacle.project_on_plane(*facet, &start(corner), at_start).is_some())
                    };
                    under.filter(is_near)
                });
                points.extend(pair.form.points_of(segment, place, coordinates).into_iter().map(|(at, weight)| {
                    let shape = slave.boundary.shape(facet, &at);
                    let (start, measure) = (shape.at(&nodes), placed.measure_at(facet, &shape));
                    let is_past_end = obstacle.is_past_end(&start, Positions::Fixed(positions), &candidates);
                    let shape = std::array::from_fn(|k| shape.values[k]);
                    SlavePoint {
                        segment: number,
                        facet: under,
                        shape,
                        weight: weight * (segment.share * measure),
                        is_past_end,
                    }
                }));
            }
            if points.iter().all(|point| point.weight == 0.0) {
                // On the axis.
                continue;
            }
            let positions = Positions::Fixed(positions);
            let mut near = NearFacets::new(obstacle, &candidates, positions);
            let begin_gap = |point: &SlavePoint<D>| {
                let start = nodes.iter().zip(&point.shape).map(|(node, share)| node * *share).sum();
                let mut gap = |facet| near.project(&start, facet).map_or(f64::INFINITY, |found| found.gap(&start));
                let at_start = gap(point.facet);
                [at_start, if point.facet.is_some() { at_start.min(gap(None)) } else { at_start }]
            };
            let begin_gaps = if is_gradient || is_searched && is_divided {
                points.iter().map(begin_gap).collect()
            } else {
                Vec::new()
            };
            items.push(Item { facet, candidates, points, masters, dofs, begin_gaps, multipliers: Vec::new() });
        }
        Self { items, is_searched, is_gradient }
    }
}

/// The quadrature points of a contact in one step. Only points in contact are visited; the others have no traction.
///
/// Time levels: the *weight* contains the measure of the slave's facet, and the weight of the coordinates
/// ([`mesh::Coordinates::weight`]), at the start of the step. *Gap, slip and frame* are evaluated at its end. The
/// *stress* is evaluated at the unknown state. Positions are the shifted positions of the time scheme. A discrete
/// gradient also depends on the gap at the start; then a point is visited if it is in contact at the start or the end.
#[derive(Clone)]
pub struct ContactSites<'a, const D: usize> {
    /// Facets that may touch.
    pub items: &'a ContactItems<D>,
    /// Slave and obstacle.
    pub pair: ContactPair<'a, D>,
    /// The layout.
    pub layout: &'a BlockLayout,
}

impl<const D: usize> ContactSites<'_, D> {
    /// Returns the index, within the item, of the segment in which a point lies.
    pub(crate) fn segment_of(&self, item: usize, site: &ContactSite<D>) -> usize {
        self.items.items[item].points[site.number].segment
    }

    /// Returns a node of a surface, with position and displacement at the state `x`.
    fn node(
        &self,
        surface: &SurfaceMotion<'_, D>,
        vertex: VertexId,
        row: Option<usize>,
        x: &[f64],
    ) -> (Point<D>, ContactNode<D>) {
        let position = surface.position_at(vertex, self.layout, x);
        let displacement = position - surface.start[vertex.index()];
        let velocity = surface.velocity_at(vertex, self.layout, x);
        (position, ContactNode { row, slope: surface.end.slope, displacement, velocity, ..ContactNode::none() })
    }

    /// Evaluates all of a point except its traction, given its position and, in `site`, its weight, the stress and the
    /// nodes of the slave. Returns whether it is in contact.
    #[inline]
    fn evaluate(
        &self,
        item: &Item<D>,
        near: &mut NearFacets<'_, D>,
        position: &Point<D>,
        x: &[f64],
        site: &mut ContactSite<D>,
    ) -> bool {
        let ContactPair { form, master, .. } = self.pair;
        let facet = item.points[site.number].facet;
        let Some(projection) = near.project(position, facet) else { return false };
        site.n_nodes = site.n_slave_nodes;
        if let (Anchor::Facet { facet, shape, gradient, .. }, Some(master)) = (&projection.anchor, master) {
            for (k, node) in master.boundary.nodes(*facet).iter().enumerate() {
                let Ok(local) = item.masters.binary_search_by_key(node, |(node, _)| *node) else { continue };
                let moved = self.node(master, *node, item.masters[local].1, x).1;
                site.nodes[site.n_slave_nodes + k] = ContactNode { share: -shape[k], gradient: gradient[k], ..moved };
                site.n_nodes = site.n_slave_nodes + k + 1;
            }
        }
        let frame = Frame::new(projection.normal);
        let motion = site.nodes().iter().fold(Vector::zeros(), |sum, node| sum + node.displacement * node.share);
        let [advance, slip @ ..] = frame.components(&motion);
        let gap = projection.gap(position);
        let mut at = ContactPoint { gap, slip, size: form.size, ..ContactPoint::default() };
        if let Some(stress) = &self.pair.stress {
            (at.stress, at.stiffness) = (frame.components(&site.stress), stress.stiffness(item.facet));
        } else if let Some(multiplier) = item.multipliers.get(site.number) {
            at.stress = *multiplier;
        }
        let beyond = form.law.offset().max(gap);
        let begin_gap = item.begin_gaps.get(site.number).map(|gaps| gaps[0]).filter(|_| self.items.is_gradient);
        let gap_at_start = begin_gap.map(|gap| if gap.is_finite() { gap } else { beyond });
        let start = gap_at_start.map(|gap| ContactPoint { gap, ..at });
        if !form.law.is_active(&at) && !start.is_some_and(|start| form.law.is_active(&start)) {
            return false;
        }
        // Without a gap at the start the motion is not compared with its change.
        let is_known = begin_gap.is_none_or(|gap| gap.is_finite());
        (site.gap_at_start, site.advance) = (gap_at_start, if is_known { advance } else { beyond - gap });
        (site.projection, site.frame, site.at) = (projection, frame, at);
        true
    }

    /// Returns an upper bound of the motion of the points of an item over the step, relative to the obstacle, given the
    /// nodes of the slave.
    fn largest_motion(&self, item: &Item<D>, slave: &[ContactNode<D>], x: &[f64]) -> f64 {
        if item.begin_gaps.is_empty() {
            return 0.0;
        }
        let origin = self.pair.master.map_or_else(Vector::zeros, |_| slave[0].displacement);
        let largest = |motions: &mut dyn Iterator<Item = Vector<D>>| {
            motions.map(|motion| (motion - origin).norm_squared()).fold(0.0, f64::max).sqrt()
        };
        let of_slave = largest(&mut slave.iter().map(|node| node.displacement));
        let of_master = self.pair.master.map(|master| {
            let motion = |node: VertexId| master.position_at(node, self.layout, x) - master.start[node.index()];
            largest(&mut item.masters.iter().map(|(node, _)| motion(*node)))
        });
        SUM_OF_SHAPES * (of_slave + of_master.unwrap_or(0.0))
    }

    /// Returns whether a point cannot be in contact at the end of the step, given the bound of its motion: not even
    /// with the smallest gap and the smallest normal stress that are possible.
    fn is_apart(&self, item: &Item<D>, number: usize, motion: f64, stress: &Vector<D>) -> bool {
        let Some([_, gap]) = item.begin_gaps.get(number).filter(|gaps| gaps[1].is_finite()) else { return false };
        let ContactForm { law, size, .. } = self.pair.form;
        let mut at = ContactPoint { gap: gap - motion - ROUND_OFF * size, size: *size, ..ContactPoint::default() };
        if let Some(source) = &self.pair.stress {
            (at.stress[0], at.stiffness) = (-stress.norm(), source.stiffness(item.facet));
        } else if let Some([normal, ..]) = item.multipliers.get(number) {
            at.stress[0] = *normal;
        }
        !law.is_active(&at)
    }

    /// Visits the points of an item that are in contact, without their traction.
    fn each_point(&self, item: usize, x: &[f64], mut visit: impl FnMut(&mut ContactSite<D>)) {
        let (item, slave) = (&self.items.items[item], self.pair.slave);
        let nodes = slave.boundary.nodes(item.facet);
        let mut points = [Point::zeros(); MAX_FACET_NODES];
        let mut site = ContactSite { n_slave_nodes: nodes.len(), ..ContactSite::new() };
        if let Some(stress) = &self.pair.stress {
            let mut derivatives = ByDof::new();
            site.stress = stress.on(item.facet, x, &mut derivatives);
            let row = |dof: &DofId| item.dofs.iter().position(|other| other == dof);
            site.stress_derivatives.extend(derivatives.iter().filter_map(|(dof, by_dof)| Some((row(dof)?, *by_dof))));
        }
        for (k, &node) in nodes.iter().enumerate() {
            (points[k], site.nodes[k]) = self.node(slave, node, slave.field().map(|_| D * k), x);
        }
        let motion = self.largest_motion(item, &site.nodes[..nodes.len()], x);
        let positions = Positions::at_end(self.pair.master, self.layout, x);
        let mut near = NearFacets::new(self.pair.obstacle, &item.candidates, positions);
        for (number, point) in item.points.iter().enumerate().filter(|(_, point)| !point.is_past_end) {
            if self.is_apart(item, number, motion, &site.stress) {
                continue;
            }
            let mut position = Point::zeros();
            for k in 0..nodes.len() {
                site.nodes[k].share = point.shape[k];
                position += points[k] * point.shape[k];
            }
            (site.number, site.weight) = (number, point.weight);
            if self.evaluate(item, &mut near, &position, x, &mut site) {
                visit(&mut site);
            }
        }
    }

    /// Returns the tractions at the state `x` as multipliers of the next solve; `None` if the law has none.
    pub fn multipliers(&self, x: &[f64]) -> Option<Multipliers> {
        let (form, items) = (self.pair.form, &self.items.items);
        (form.law.stress() == StressSource::Multiplier).then_some(())?;
        let mut multipliers = Multipliers { components: Vec::new(), change: 0.0, largest: 0.0 };
        for (number, item) in items.iter().enumerate() {
            let mut values = vec![Local::default(); item.points.len()];
            self.visit(number, x, |site| values[site.number] = site.traction.value);
            for (k, value) in values.iter().enumerate() {
                let before = item.multipliers.get(k).copied().unwrap_or_default();
                let norm = |of: &dyn Fn(usize) -> f64| (0..3).map(|i| of(i).powi(2)).sum::<f64>().sqrt();
                multipliers.change = multipliers.change.max(norm(&|i| value[i] - before[i]));
                multipliers.largest = multipliers.largest.max(norm(&|i| value[i]));
            }
            multipliers.components.extend(values.as_flattened());
        }
        Some(multipliers)
    }

    /// Returns the energy that the law stores at the state `x`.
    pub fn stored_energy(&self, x: &[f64]) -> f64 {
        let mut energy = 0.0;
        for item in 0..self.len() {
            let law = &self.pair.form.law;
            self.visit(item, x, |site| energy += site.weight * law.energy_density(&site.at).unwrap_or(0.0));
        }
        energy
    }

    /// Returns the power of the contact forces at vertices of given motion: the weak form tested with their velocities.
    pub fn given_power(&self, x: &[f64]) -> f64 {
        let mut power = 0.0;
        for item in 0..self.len() {
            self.visit(item, x, |site| {
                let force = site.frame.vector(&site.traction.value) * site.weight;
                let given = site.nodes().iter().filter(|node| node.row.is_none());
                power -= given.map(|node| force.dot(&node.velocity) * node.share).sum::<f64>();
            });
        }
        power
    }
}

impl<const D: usize> Sites for ContactSites<'_, D> {
    type Site = ContactSite<D>;

    fn len(&self) -> usize {
        self.items.items.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        out.extend_from_slice(&self.items.items[item].dofs);
    }

    fn visit(&self, item: usize, x: &[f64], mut visit: impl FnMut(&Self::Site)) {
        self.each_point(item, x, |site| {
            let law = self.pair.form.law.as_ref();
            let (traction, by_advance) = match site.gap_at_start {
                Some(gap) => discrete_gradient(law, &site.at, gap, site.advance),
                None => (law.traction(&site.at), Local::default()),
            };
            site.traction = traction.times(self.pair.share);
            site.by_advance = by_advance.map(|derivative| self.pair.share * derivative);
            visit(site);
        });
    }

    /// Returns the hash of the set of active points.
    fn regime(&self, item: usize, x: &[f64]) -> Option<u64> {
        let mut hash = RegimeHash::default();
        hash.extend([item as u64]);
        self.each_point(item, x, |site| hash.extend([site.number as u64]));
        Some(hash.value())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PenaltyLaw;

    #[test]
    fn points_of_segments_on_the_axis_have_weights_and_integrate() {
        let form = ContactForm::<2>::new(PenaltyLaw::new(1.0, 0.0).expect("a law"), 1.0).expect("a form");
        for ends in [[0.0, 2.0], [2.0, 0.0], [2.0, 3.0]] {
            let place = |at: &[f64; 2]| Point::<2>::new(ends[0] * at[0] + ends[1] * at[1], 1.0);
            let points = form.points_of(&Segment::whole(), place, Coordinates::Axisymmetric);
            assert!(points.iter().all(|(_, weight)| *weight > 0.0), "{points:?}");
            for degree in 0..=4 {
                let integral: f64 = points.iter().map(|(s, weight)| weight * place(s)[0].powi(degree)).sum();
                let primitive = |r: f64| std::f64::consts::TAU * r.powi(degree + 2) / f64::from(degree + 2);
                let exact = ((primitive(ends[1]) - primitive(ends[0])) / (ends[1] - ends[0])).abs();
                assert!((integral - exact).abs() < 1e-13 * exact, "{ends:?}, {degree}: {integral} {exact}");
            }
        }
    }
}

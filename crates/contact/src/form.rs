//! The weak form of contact, and what it adds to the system.

use std::sync::Arc;

use algebra::{Contributions, DofId, LocalSystem};
use mesh::{BoundaryMesh, FacetId, MAX_CELL_VERTICES, Placed, Point, SimplexRule, VertexId};

use crate::error::{non_negative, positive};
use crate::obstacle::MAX_FACET_VERTICES;
use crate::segments::{Segment, divide};
use crate::site::{ContactNode, MAX_NODES};
use crate::terms::NormalTraction;
use crate::{Anchor, Candidates, ContactBody, ContactLaw, ContactPoint, ContactSite, Error, Motion, Obstacle};

/// Law, contact size and quadrature of a contact: everything constant in time but the bodies.
#[derive(Clone, Debug)]
pub struct ContactForm<const D: usize> {
    /// The law.
    pub law: Arc<dyn ContactLaw>,
    /// `(-λ n^w, w^s - w^m)`
    pub normal_traction: NormalTraction,
    element_size: f64,
    rule: SimplexRule,
}

impl<const D: usize> ContactForm<D> {
    /// Contact with a law and the contact size `s`, integrated with a rule that contains the vertices of the facets.
    ///
    /// # Errors
    /// [`Error::Parameter`]: contact size not positive.
    pub fn new(law: impl ContactLaw + 'static, element_size: f64) -> Result<Self, Error> {
        positive("contact size", element_size)?;
        Ok(Self {
            law: Arc::new(law),
            normal_traction: NormalTraction,
            element_size,
            rule: SimplexRule::with_vertices(D - 1),
        })
    }

    /// Contact size `s`.
    pub fn element_size(&self) -> f64 {
        self.element_size
    }

    /// What the law is asked at a gap.
    #[inline]
    pub fn at(&self, gap: f64) -> ContactPoint {
        ContactPoint { gap, element_size: self.element_size, normal_stress: 0.0 }
    }
}

/// Who meets whom in one step.
#[derive(Clone, Copy, Debug)]
pub struct ContactPair<'a, const D: usize> {
    /// The body whose surface is integrated over.
    pub slave: ContactBody<'a, D>,
    /// Facets of its boundary that may come into contact: no symmetry lines, no clamped parts.
    pub facets: &'a [FacetId],
    /// What it must not enter.
    pub obstacle: &'a dyn Obstacle<D>,
    /// The body of a deformable obstacle.
    pub master: Option<ContactBody<'a, D>>,
    /// How far from a facet of the slave to look for facets of a deformable obstacle: at least the offset of the law
    /// plus the relative motion in a step. A point without an obstacle in reach feels none.
    pub reach: f64,
}

/// The facets of a slave in one step.
#[derive(Clone, Debug)]
pub struct ContactFacets<'a, const D: usize> {
    form: &'a ContactForm<D>,
    pair: ContactPair<'a, D>,
    candidates: Candidates,
    /// Entries of `pair.facets` with something in reach.
    items: Vec<usize>,
    measures: Vec<f64>,
    /// Parts of the items, without kinks of the master's shape functions inside.
    segments: Vec<Segment<D>>,
    segment_offsets: Vec<usize>,
    master_offsets: Vec<usize>,
    master_vertices: Vec<VertexId>,
}

impl<'a, const D: usize> ContactFacets<'a, D> {
    /// Finds candidates and measures; both hold for the whole step.
    ///
    /// # Errors
    /// [`Error::UnknownFacet`], [`Error::Master`], [`Error::SelfContact`], or [`Error::Parameter`] for a reach that
    /// is negative.
    pub fn new(form: &'a ContactForm<D>, pair: ContactPair<'a, D>) -> Result<Self, Error> {
        non_negative("reach of contact", pair.reach)?;
        let n_facets = pair.slave.boundary().n_facets();
        if let Some(&facet) = pair.facets.iter().find(|f| f.index() >= n_facets) {
            return Err(Error::UnknownFacet { facet, n_facets });
        }
        if pair.obstacle.boundary() != pair.master.map(|master| master.boundary()) {
            return Err(Error::Master);
        }
        if pair.master.is_some_and(|master| master.is_same_field(&pair.slave)) {
            return Err(Error::SelfContact);
        }
        let placed = Placed::new(pair.slave.boundary(), pair.slave.predicted());
        let positions = pair.master.map_or(&[][..], |master| master.predicted());
        let candidates = pair.obstacle.candidates(placed, pair.facets, positions, pair.reach);
        let mut facets = Self {
            form,
            pair,
            candidates,
            items: Vec::new(),
            measures: Vec::new(),
            segments: Vec::new(),
            segment_offsets: vec![0],
            master_offsets: vec![0],
            master_vertices: Vec::new(),
        };
        for (index, &facet) in pair.facets.iter().enumerate() {
            if let Some(boundary) = pair.obstacle.boundary() {
                let candidates = facets.candidates.list(index);
                if candidates.is_empty() {
                    continue;
                }
                let opposite = Placed::new(boundary, positions);
                let corners = |points: [Point<D>; MAX_CELL_VERTICES]| std::array::from_fn(|k| points[k]);
                let opposite = candidates.iter().map(|&candidate| corners(opposite.facet_points(candidate)));
                facets.segments.extend(divide(&corners(placed.facet_points(facet)), opposite));
                let vertices = vertices_of(boundary, candidates);
                facets.master_vertices.extend(vertices);
                facets.master_offsets.push(facets.master_vertices.len());
            } else {
                facets.segments.push(Segment::whole());
            }
            facets.segment_offsets.push(facets.segments.len());
            facets.items.push(index);
            facets.measures.push(placed.facet_measure(facet));
        }
        Ok(facets)
    }

    /// The form.
    pub fn form(&self) -> &'a ContactForm<D> {
        self.form
    }

    /// Slave and obstacle.
    pub fn pair(&self) -> &ContactPair<'a, D> {
        &self.pair
    }

    /// Fingerprint of the set of active quadrature points at the state `x`: two states with the same active set have
    /// the same number.
    pub fn regime(&self, x: &[f64]) -> u64 {
        // Fowler-Noll-Vo hash of the numbers of the active points.
        const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
        const PRIME: u64 = 0x0100_0000_01b3;
        let mut hash = OFFSET;
        for item in 0..self.len() {
            self.for_each_site(item, x, |q, site| {
                if site.is_active {
                    for number in [self.items[item], q] {
                        hash = (hash ^ number as u64).wrapping_mul(PRIME);
                    }
                }
            });
        }
        hash
    }

    /// Visits the quadrature points of an item that have an obstacle in reach, with their numbers.
    #[inline]
    pub(crate) fn for_each_site(&self, item: usize, x: &[f64], mut visit: impl FnMut(usize, &ContactSite<D>)) {
        let slave = &self.pair.slave;
        let vertices = slave.boundary().facet(self.pair.facets[self.items[item]]);
        let motion = slave.motion(x);
        let mut points = [Point::zeros(); MAX_FACET_VERTICES];
        let mut nodes = [ContactNode::none(); MAX_NODES];
        for (k, &vertex) in vertices.iter().enumerate() {
            points[k] = motion.position(vertex);
            nodes[k].row = D * k;
            nodes[k].displacement_per_velocity = slave.displacement_per_velocity();
        }
        let rule = &self.form.rule;
        let segments = &self.segments[self.segment_offsets[item]..self.segment_offsets[item + 1]];
        for (s, segment) in segments.iter().enumerate() {
            let measure = segment.share * self.measures[item];
            for (q, (point, weight)) in rule.points().iter().zip(rule.weights()).enumerate() {
                let shape = segment.at(point);
                let mut position = Point::zeros();
                for k in 0..D {
                    nodes[k].share = shape[k];
                    position += points[k] * shape[k];
                }
                if let Some(site) = self.site(item, x, position, weight * measure, &nodes) {
                    visit(s * rule.weights().len() + q, &site);
                }
            }
        }
    }

    /// One point, given the nodes of the slave.
    #[inline]
    fn site(
        &self,
        item: usize,
        x: &[f64],
        position: Point<D>,
        weight: f64,
        slave_nodes: &[ContactNode<D>; MAX_NODES],
    ) -> Option<ContactSite<D>> {
        let motion = self.pair.master.map_or(Motion::frozen(&[]), |master| master.motion(x));
        let candidates = self.candidates.list(self.items[item]);
        let projection = self.pair.obstacle.project(&position, motion, candidates)?;
        let at = self.form.at(projection.gap(&position));
        let mut site = ContactSite {
            weight,
            x: position,
            projection,
            at,
            traction: self.form.law.traction(at),
            is_active: self.form.law.is_active(at),
            nodes: *slave_nodes,
            n_nodes: D,
        };
        if let (Anchor::Facet { facet, barycentric, barycentric_gradient }, Some(master)) =
            (projection.anchor, self.pair.master)
        {
            for (k, vertex) in master.boundary().facet(facet).iter().enumerate() {
                let Ok(local) = self.master_vertices(item).binary_search(vertex) else { continue };
                site.nodes[D + k] = ContactNode {
                    row: D * (D + local),
                    share: -barycentric[k],
                    gradient: barycentric_gradient[k],
                    displacement_per_velocity: master.displacement_per_velocity(),
                };
                site.n_nodes = D + k + 1;
            }
        }
        Some(site)
    }

    /// Vertices of the candidates of an item, each once, in order.
    #[inline]
    fn master_vertices(&self, item: usize) -> &[VertexId] {
        match (self.master_offsets.get(item), self.master_offsets.get(item + 1)) {
            (Some(&from), Some(&to)) => &self.master_vertices[from..to],
            _ => &[],
        }
    }
}

impl<const D: usize> Contributions for ContactFacets<'_, D> {
    fn len(&self) -> usize {
        self.items.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        let slave = &self.pair.slave;
        for &vertex in slave.boundary().facet(self.pair.facets[self.items[item]]) {
            out.extend(slave.dofs(vertex));
        }
        if let Some(master) = &self.pair.master {
            for &vertex in self.master_vertices(item) {
                out.extend(master.dofs(vertex));
            }
        }
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        self.for_each_site(item, x, |_, site| {
            if site.is_active {
                self.form.normal_traction.add(site, out);
            }
        });
    }

    fn name(&self) -> &'static str {
        "contact"
    }
}

/// Vertices of facets, each once, in order.
fn vertices_of<const D: usize>(boundary: &BoundaryMesh<D>, facets: &[FacetId]) -> Vec<VertexId> {
    let mut vertices: Vec<_> = facets.iter().flat_map(|&f| boundary.facet(f)).copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

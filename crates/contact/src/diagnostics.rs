//! Gap, penetration, active area, force, power and energy of a contact.

use std::collections::BTreeMap;

use algebra::Sites;
use mesh::{FacetId, Placed, Point, Vector};

use crate::{Anchor, ContactSites, Positions};

/// Contact between a slave and its obstacle at one state.
///
/// In plane problems forces, powers and energies are per unit depth, and areas are lengths. In axisymmetric coordinates
/// all are those of the whole body.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactReport<const D: usize> {
    /// Smallest gap of the slave's vertices to the whole obstacle, or to the facets in reach for a body in contact with
    /// itself; `None` if there is no gap.
    pub minimum_gap: Option<f64>,
    /// Largest `[ε - Δ]₊` at the quadrature points in contact, at the shifted positions at which the law acts.
    pub largest_penetration: f64,
    /// Quadrature points on which contact acts in the step: those with a traction, and those in contact at the shifted
    /// positions at its end.
    pub n_active: usize,
    /// Sum of the quadrature weights of these points: the measure of the slave's surface in contact.
    pub active_area: f64,
    /// Force on the slave, `∫ (λ n^w + τ)`, at the stage. With a discrete gradient, points that are in contact only
    /// at the start contribute too.
    pub force: Vector<D>,
    /// Power of contact on the slave and on the master; the latter is zero for a rigid obstacle. The sum is negative
    /// while energy is stored.
    pub powers: [f64; 2],
    /// Part of the sum of these powers that normal tractions have, without friction.
    pub normal_power: f64,
    /// Energy stored by the law.
    pub stored_energy: f64,
    /// Mean contact pressure `-λ` on the facets of the slave with contact points, in the order of the facets. Forces
    /// are divided by the measures of the facets over which the step is integrated.
    pub slave_pressures: Vec<(FacetId, f64)>,
    /// Mean contact pressure on the facets of a deformable obstacle, from the forces at opposite points of the slave.
    pub master_pressures: Vec<(FacetId, f64)>,
}

impl<const D: usize> ContactReport<D> {
    /// Creates the report at the state `x`, with the velocities at the stage of the step and the positions of all
    /// vertices of slave and master at its end.
    pub fn new(sites: &ContactSites<'_, D>, x: &[f64], [slave, master]: [&[Point<D>]; 2]) -> Self {
        let mut report = Self {
            minimum_gap: minimum_gap(sites, slave, master),
            largest_penetration: 0.0,
            n_active: 0,
            active_area: 0.0,
            force: Vector::zeros(),
            powers: [0.0; 2],
            normal_power: 0.0,
            stored_energy: 0.0,
            slave_pressures: Vec::new(),
            master_pressures: Vec::new(),
        };
        let mut on_slave: BTreeMap<FacetId, f64> = BTreeMap::new();
        // The force of a segment is assigned to one facet of the master: that in which the closest point of one of its
        // quadrature points is farthest from the edges.
        let mut segments: BTreeMap<(usize, usize), Opposite> = BTreeMap::new();
        let law = &sites.pair.form.law;
        for item in 0..sites.len() {
            sites.visit(item, x, |site| {
                if law.is_active(&site.at) || site.traction.value[0] < 0.0 {
                    report.n_active += 1;
                    report.active_area += site.weight;
                }
                report.largest_penetration = report.largest_penetration.max(law.offset() - site.at.gap);
                report.stored_energy += site.weight * law.energy_density(&site.at).unwrap_or(0.0);
                let force = site.frame.vector(&site.traction.value) * site.weight;
                report.force += force;
                // The first component of a traction is `λ`.
                let pressing = -site.traction.value[0] * site.weight;
                *on_slave.entry(sites.items.facet(item)).or_default() += pressing;
                if let Anchor::Facet { facet, inside, .. } = site.projection.anchor {
                    let segment = segments.entry((item, sites.segment_of(item, site))).or_default();
                    segment.force += pressing;
                    if segment.facet.is_none() || inside > segment.inside {
                        (segment.facet, segment.inside) = (Some(facet), inside);
                    }
                }
                let velocity: Vector<D> = site.nodes().iter().map(|node| node.velocity * node.share).sum();
                report.normal_power += site.weight * site.traction.value[0] * site.frame.axes[0].dot(&velocity);
                for (k, node) in site.nodes().iter().enumerate() {
                    report.powers[usize::from(k >= site.n_slave_nodes)] += node.share * force.dot(&node.velocity);
                }
            });
        }
        report.force = sites.pair.slave.boundary.coordinates().resultant(report.force);
        let mut on_master: BTreeMap<FacetId, f64> = BTreeMap::new();
        for (facet, force) in segments.into_values().filter_map(|segment| Some((segment.facet?, segment.force))) {
            *on_master.entry(facet).or_default() += force;
        }
        let slave = sites.pair.slave;
        report.slave_pressures = pressures(on_slave, Placed::new(slave.boundary, &slave.start));
        if let Some(master) = sites.pair.master {
            report.master_pressures = pressures(on_master, Placed::new(master.boundary, &master.start));
        }
        report
    }

    /// Returns whether there is contact.
    pub fn is_active(&self) -> bool {
        self.n_active > 0
    }
}

/// Force of a segment of the slave, and the facet opposite to it.
#[derive(Default)]
struct Opposite {
    force: f64,
    facet: Option<FacetId>,
    /// Smallest barycentric coordinate in this facet.
    inside: f64,
}

/// Returns the mean pressures on facets from the forces on them.
fn pressures<const D: usize>(forces: BTreeMap<FacetId, f64>, surface: Placed<'_, D>) -> Vec<(FacetId, f64)> {
    forces.into_iter().map(|(facet, force)| (facet, force / surface.weighted_measure(facet))).collect()
}

/// Returns the smallest gap of the vertices of the slave's facets to the whole obstacle, or to the candidates if
/// [`crate::Obstacle::smallest_gap`] is `None`.
fn minimum_gap<const D: usize>(sites: &ContactSites<'_, D>, slave: &[Point<D>], master: &[Point<D>]) -> Option<f64> {
    let pair = &sites.pair;
    let vertices = pair.slave.boundary.vertices_of(pair.facets);
    let points: Vec<Point<D>> = vertices.into_iter().map(|v| slave[v.index()]).collect();
    let to_whole = pair.obstacle.smallest_gap(&points, Positions::Fixed(master));
    let to_candidates = |(facet, near): (FacetId, &[FacetId])| {
        let points = pair.slave.boundary.facet(facet).iter().map(|v| &slave[v.index()]);
        let gap = |x: &Point<D>| Some(pair.obstacle.project(x, Positions::Fixed(master), near)?.gap(x));
        points.filter_map(gap).reduce(f64::min)
    };
    to_whole.or_else(|| sites.items.candidates().filter_map(to_candidates).reduce(f64::min))
}

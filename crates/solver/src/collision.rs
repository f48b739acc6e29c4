//! The collision of a contact in one step.

use std::collections::BTreeMap;

use algebra::{Constraints, Contributions, DofId, LocalSystem};
use contact::{Anchor, ContactPoint, Positions, Projection};
use mesh::{BodyId, Placed, Point, Vector, VertexId};

use crate::contact_step::StepRefs;
use crate::setup::Contact;
use crate::{Setup, State};

/// Penalty weight `c` relative to mass/Δt, with the smaller mass of two bodies. The relative error of the velocity is
/// about its inverse.
const STIFFNESS: f64 = 1e8;

/// Size of the negative excess of velocity at which a point is released because it pulls, relative to the largest
/// relative velocity at the start. The penalty gives this excess an impulse of 1e-4 times mass and velocity, which is
/// above round-off.
const LEAST_PULL: f64 = 1e-4 / STIFFNESS;
/// Smallest excess of velocity at which a point that does not act is added, relative to the same velocity.
const LEAST_EXCESS: f64 = 1e-6;
/// Largest number of times that a point is added. A point is released whenever it pulls.
const MOST_ADDITIONS: usize = 2;

/// `Σ c (n·(v_s - v_m) - r) (n·(w_s - w_m))`: at the points that act, two bodies separate with the given relative
/// velocity
///
/// The points are the vertices of the slave whose gap is below the offset, and `r = -e n·(v_s - v_m)^n` with the
/// restitution `e`. In the first solve the points that approach act. The solve is repeated without points that pull,
/// and with points that would approach faster than `r`. So impulses only push, and relative velocities are at most `r`.
/// Impulses of one restitution generate no energy, for any number of points. Other forces work during the step.
///
/// Source: Newton's law of restitution, for several points after Moreau 1988, Unilateral contact and dry friction in
/// finite freedom dynamics, doi:10.1007/978-3-7091-2624-0_1.
/// Couples: velocities of one vertex of the slave and of the facet of the master.
/// Units: force (2D: per unit depth).
#[derive(Clone)]
pub(crate) struct Collision<const D: usize> {
    points: Vec<CollisionPoint<D>>,
    /// Largest relative velocity along a normal at the start.
    fastest: f64,
    /// The weight `c`.
    weight: f64,
}

/// A vertex of the slave and the closest point of the master.
#[derive(Clone)]
struct CollisionPoint<const D: usize> {
    /// Dofs with their share in the relative velocity along the normal, those of the slave first.
    dofs: Vec<(DofId, f64)>,
    /// Number of dofs of the slave.
    n_of_slave: usize,
    /// The velocity `r` at the stage, positive in approach.
    velocity: f64,
    /// Parts of the relative velocity that a prescribed motion of the slave and of the master give.
    given: [f64; 2],
    /// Normal into the obstacle.
    normal: Vector<D>,
    /// Whether the point acts.
    acts: bool,
    /// Number of times that the point may still be added.
    n_additions_left: usize,
}

impl<const D: usize> Collision<D> {
    /// Returns the collision of a contact for the velocities `start` at the start; `None` if its law has no
    /// restitution, or no point that can move is in contact at the start of the step.
    pub(crate) fn new(
        contact: &Contact<D>,
        setup: &Setup<D>,
        previous: &State<D>,
        refs: StepRefs<'_, D>,
        constraints: &Constraints,
        start: &[f64],
    ) -> Option<Self> {
        let restitution = contact.form().law.restitution()?;
        let (mut points, mut fastest, mut moves) = (Vec::new(), 0.0_f64, [false; 2]);
        let is_free = |dof: DofId| constraints.get(dof).is_none();
        let can_move = |(dof, _): &(DofId, f64)| match constraints.tie_of(*dof) {
            Some(masters) => masters.iter().any(|(master, _)| is_free(*master)),
            None => is_free(*dof),
        };
        for (vertex, found) in touching(contact, setup, previous) {
            let mut point = CollisionPoint::new(contact, vertex, &found, previous, refs);
            let (of_slave, of_master) = point.dofs.split_at(point.n_of_slave);
            let can_move = [of_slave, of_master].map(|dofs| dofs.iter().any(can_move));
            if can_move.contains(&true) {
                moves = [moves[0] || can_move[0], moves[1] || can_move[1]];
                let approach = point.velocities(start).iter().sum::<f64>();
                fastest = fastest.max(approach.abs());
                point.velocity = refs.time.weights.stage_velocity(-restitution * approach, approach);
                point.acts = approach > 0.0;
                points.push(point);
            }
        }
        // With the larger mass, a pull that turns the lighter body around would be below the tolerance. A body that is
        // held along the normals does not count.
        let bodies = [Some(contact.body()), contact.master()].into_iter().zip(moves);
        let of_moving = bodies.filter(|(_, moves)| *moves).filter_map(|(id, _)| id);
        let balance = |id: BodyId| setup.bodies[id.index()].balance(&previous.bodies[id.index()]);
        let mass = of_moving.filter_map(balance).map(|balance| balance.mass).fold(f64::INFINITY, f64::min);
        (!points.is_empty()).then(|| Self { points, fastest, weight: STIFFNESS * mass / refs.time.length })
    }

    /// Returns the number of points that act.
    pub(crate) fn n_active(&self) -> usize {
        self.points.iter().filter(|point| point.acts).count()
    }

    /// Returns the force on the slave.
    pub(crate) fn force(&self, x: &[f64]) -> Vector<D> {
        let acting = self.points.iter().filter(|point| point.acts);
        acting.map(|point| point.normal * -(self.weight * point.excess(x))).sum()
    }

    /// Returns the power of the impulses on the slave and on the master.
    pub(crate) fn powers(&self, x: &[f64]) -> [f64; 2] {
        let mut powers = [0.0; 2];
        for point in self.points.iter().filter(|point| point.acts) {
            for (power, velocity) in powers.iter_mut().zip(point.velocities(x)) {
                *power -= self.weight * point.excess(x) * velocity;
            }
        }
        powers
    }

    /// Returns the power of a body of prescribed motion at the points.
    pub(crate) fn given_power(&self, x: &[f64]) -> f64 {
        let acting = self.points.iter().filter(|point| point.acts);
        acting.map(|point| self.weight * point.excess(x) * (point.given[0] + point.given[1])).sum()
    }

    /// Returns whether bodies approach at a point.
    pub(crate) fn approaches(&self) -> bool {
        self.points.iter().any(|point| point.acts)
    }

    /// Releases points that pull, and adds those that exceed their bounds. Returns whether any point changed.
    pub(crate) fn settle(&mut self, x: &[f64]) -> bool {
        let mut has_changed = false;
        for point in &mut self.points {
            let excess = point.excess(x);
            if point.acts && excess < -LEAST_PULL * self.fastest {
                (point.acts, has_changed) = (false, true);
            } else if !point.acts && excess > LEAST_EXCESS * self.fastest && point.n_additions_left > 0 {
                (point.acts, has_changed) = (true, true);
                point.n_additions_left -= 1;
            }
        }
        has_changed
    }
}

/// Returns the vertices of the slave that touch the master at the start of the step, with the closest points.
fn touching<const D: usize>(
    contact: &Contact<D>,
    setup: &Setup<D>,
    previous: &State<D>,
) -> BTreeMap<VertexId, Projection<D>> {
    let positions = |id: BodyId| previous.bodies[id.index()].positions(setup.bodies[id.index()].reference());
    let (slave, law) = (setup.bodies[contact.body().index()].surface(), &contact.form().law);
    let (own, opposite) = (positions(contact.body()), contact.master().map_or(Vec::new(), positions));
    let candidates = contact.obstacle().candidates(Placed::new(slave, &own), contact.facets(), &opposite, law.offset());
    let mut touching: BTreeMap<VertexId, Projection<D>> = BTreeMap::new();
    for (index, &facet) in contact.facets().iter().enumerate() {
        let near = candidates.as_ref().map_or(&[][..], |of_facets| &of_facets[index]);
        for &vertex in slave.facet(facet) {
            let x: Point<D> = own[vertex.index()];
            let at = Positions::Fixed(&opposite[..]);
            let Some(found) = contact.obstacle().project(&x, at, near) else { continue };
            if contact.obstacle().is_past_end(&x, at, near) {
                continue;
            }
            let gap = found.gap(&x);
            let at = ContactPoint { gap, size: contact.form().size(), ..ContactPoint::default() };
            if law.is_active(&at) && touching.get(&vertex).is_none_or(|other| gap < other.gap(&x)) {
                touching.insert(vertex, found);
            }
        }
    }
    touching
}

impl<const D: usize> CollisionPoint<D> {
    /// Creates the point of a vertex of the slave and the closest point of the master. It does not act.
    fn new(
        contact: &Contact<D>,
        vertex: VertexId,
        found: &Projection<D>,
        previous: &State<D>,
        refs: StepRefs<'_, D>,
    ) -> Self {
        let mut ends = vec![(contact.body(), vertex, 1.0)];
        if let (Some(id), Anchor::Facet { facet, shape, .. }) = (contact.master(), &found.anchor) {
            let nodes = refs.bodies[id.index()].surface().boundary.nodes(*facet);
            ends.extend(nodes.iter().zip(shape).map(|(&vertex, share)| (id, vertex, -share)));
        }
        let (mut dofs, mut n_of_slave, mut given) = (Vec::new(), 0, [0.0; 2]);
        for (end, (id, vertex, share)) in ends.into_iter().enumerate() {
            match refs.bodies[id.index()].surface().field() {
                Some(field) => {
                    let of_vertex = refs.layout.node(field, vertex.index()).zip(&found.normal);
                    dofs.extend(of_vertex.map(|(dof, n)| (dof, share * n)).filter(|(_, share)| *share != 0.0));
                }
                None => {
                    let velocity = previous.bodies[id.index()].velocity()[vertex.index()];
                    given[usize::from(end > 0)] += velocity.dot(&found.normal) * share;
                }
            }
            if end == 0 {
                n_of_slave = dofs.len();
            }
        }
        let (normal, n_additions_left) = (found.normal, MOST_ADDITIONS);
        Self { dofs, n_of_slave, velocity: 0.0, given, normal, acts: false, n_additions_left }
    }

    /// Returns the velocity of the slave along the normal, and minus that of the master. Their sum is the relative
    /// velocity.
    fn velocities(&self, x: &[f64]) -> [f64; 2] {
        let of = |dofs: &[(DofId, f64)]| dofs.iter().map(|(dof, share)| share * x[dof.index()]).sum::<f64>();
        let (slave, master) = self.dofs.split_at(self.n_of_slave);
        [self.given[0] + of(slave), self.given[1] + of(master)]
    }

    /// Returns the relative velocity minus the velocity `r`.
    fn excess(&self, x: &[f64]) -> f64 {
        self.velocities(x).iter().sum::<f64>() - self.velocity
    }
}

impl<const D: usize> Contributions for Collision<D> {
    fn name(&self) -> &'static str {
        "collision"
    }

    fn len(&self) -> usize {
        self.points.len()
    }

    fn dofs(&self, item: usize, out: &mut Vec<DofId>) {
        out.extend(self.points[item].dofs.iter().map(|(dof, _)| *dof));
    }

    fn add(&self, item: usize, x: &[f64], out: &mut LocalSystem) {
        let point = &self.points[item];
        if !point.acts {
            return;
        }
        let force = self.weight * point.excess(x);
        for (i, (_, share)) in point.dofs.iter().enumerate() {
            out.add(i, force * share);
            if out.has_tangent() {
                for (j, (_, other)) in point.dofs.iter().enumerate() {
                    out.add_tangent(i, j, self.weight * share * other);
                }
            }
        }
    }

    fn is_linear(&self) -> bool {
        true
    }
}

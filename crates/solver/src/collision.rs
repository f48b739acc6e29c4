//! The collision of a contact in one step.

use algebra::{Contributions, DofId, LocalSystem};
use body::SurfaceMotion;
use contact::{Anchor, CollisionLaw, ContactLaw, Positions, Projection};
use mesh::{BodyId, Placed, Point, Vector, VertexId};

use crate::State;
use crate::contact_step::Partners;
use crate::setup::Contact;

/// `F(Δ, n·(v_s - v_m)) n·(w_s - w_m)`: the force of [`CollisionLaw`] at the closest points of two bodies
///
/// Gap `Δ` at the end of the step, velocities at its stage; closest points and normal are those at its start.
/// Couples: velocities of one vertex of the slave and of the facet of the master.
/// Units: force (2D: per unit depth).
#[derive(Clone)]
pub(crate) struct Collision<const D: usize> {
    law: CollisionLaw,
    /// Reduced mass of the bodies.
    mass: f64,
    /// Dofs with their share in the relative velocity along the normal.
    dofs: Vec<(DofId, f64)>,
    /// Gap at the end without a relative velocity at the stage, and its derivative by that velocity.
    gap: [f64; 2],
    /// Gap at the start.
    start: f64,
    /// Normal into the obstacle.
    normal: Vector<D>,
}

impl<const D: usize> Collision<D> {
    /// Returns the collision of a contact; `None` if its law has none or the bodies are farther apart than they can move in the step.
    pub(crate) fn new(contact: &Contact<D>, previous: &State<D>, step: Partners<'_, D>) -> Option<Self> {
        let law = contact.form().law.collision()?;
        let surface = |id: BodyId| step.bodies[id.index()].surface();
        let (slave, master) = (surface(contact.body()), contact.master().map(surface));
        let fastest = |id: BodyId| previous.bodies[id.index()].velocity().iter().map(Vector::norm).fold(0.0, f64::max);
        let speed = fastest(contact.body()) + contact.master().map_or(0.0, fastest);
        let reach = law.offset() + 2.0 * (speed * step.time.length + contact.form().size());
        let opposite = master.map_or(&[][..], |master| &master.begin);
        let placed = Placed::new(slave.boundary, &slave.begin);
        let candidates = contact.geometry().candidates(placed, contact.facets(), opposite, reach);
        let mut closest: Option<(f64, VertexId, Projection<D>)> = None;
        for (number, &facet) in contact.facets().iter().enumerate() {
            let near = candidates.as_ref().map_or(&[][..], |of_facets| &of_facets[number]);
            for &vertex in slave.boundary.facet(facet) {
                let x: Point<D> = slave.begin[vertex.index()];
                let Some(found) = contact.geometry().project(&x, Positions::Fixed(opposite), near) else { continue };
                let gap = found.gap(&x);
                if gap < reach && closest.as_ref().is_none_or(|(least, ..)| gap < *least) {
                    closest = Some((gap, vertex, found));
                }
            }
        }
        let (start, vertex, found) = closest?;
        let (layout, at_rest) = (step.layout, vec![0.0; step.layout.len()]);
        let (mut dofs, mut gap) = (Vec::new(), [start, 0.0]);
        let mut add = |surface: &SurfaceMotion<'_, D>, vertex: VertexId, share: f64| {
            let motion = surface.position_at(vertex, layout, &at_rest) - surface.begin[vertex.index()];
            gap[0] -= share * motion.dot(&found.normal);
            if let Some(field) = surface.field() {
                gap[1] = -surface.slope;
                let of_vertex = layout.node(field, vertex.index()).zip(&found.normal);
                dofs.extend(of_vertex.map(|(dof, n)| (dof, share * n)).filter(|(_, share)| *share != 0.0));
            }
        };
        add(slave, vertex, 1.0);
        if let (Some(master), Anchor::Facet { facet, barycentric, .. }) = (master, found.anchor) {
            for (&vertex, share) in master.boundary.facet(facet).iter().zip(barycentric) {
                add(master, vertex, -share);
            }
        }
        let bodies = [Some(contact.body()), contact.master()].into_iter().flatten();
        let inverse: f64 = bodies.filter_map(|id| step.mass(id)).map(f64::recip).sum();
        (!dofs.is_empty()).then(|| Self { law: *law, mass: inverse.recip(), dofs, gap, start, normal: found.normal })
    }

    /// Returns the force on the slave.
    pub(crate) fn force(&self, x: &[f64]) -> Vector<D> {
        self.normal * -self.at(x)[0]
    }

    /// Returns the force that pushes the bodies apart, and its derivative by the velocity of approach.
    fn at(&self, x: &[f64]) -> [f64; 2] {
        let approach = self.dofs.iter().map(|(dof, share)| share * x[dof.index()]).sum::<f64>();
        let [at_rest, slope] = self.gap;
        let gaps = [self.start, at_rest + slope * approach];
        let [force, by_gap, by_approach] = self.law.force(gaps, approach, self.mass);
        [force, by_gap * slope + by_approach]
    }
}

impl<const D: usize> Contributions for Collision<D> {
    fn name(&self) -> &'static str {
        "collision"
    }

    fn len(&self) -> usize {
        1
    }

    fn dofs(&self, _item: usize, out: &mut Vec<DofId>) {
        out.extend(self.dofs.iter().map(|(dof, _)| *dof));
    }

    fn add(&self, _item: usize, x: &[f64], out: &mut LocalSystem) {
        let [force, derivative] = self.at(x);
        for (i, (_, share)) in self.dofs.iter().enumerate() {
            out.add(i, force * share);
            if out.has_tangent() {
                for (j, (_, other)) in self.dofs.iter().enumerate() {
                    out.add_tangent(i, j, derivative * share * other);
                }
            }
        }
    }
}

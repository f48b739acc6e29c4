//! The collision of a contact in one step.

use algebra::{Contributions, DofId, LocalSystem};
use contact::{Anchor, ContactPoint, Positions, Projection};
use mesh::{Placed, Point, Vector, VertexId};

use crate::contact_step::Partners;
use crate::setup::Contact;
use crate::{Setup, State};

/// Penalty weight relative to mass/Δt; its inverse is about the relative error of the velocity.
const STIFFNESS: f64 = 1e8;

/// `c (n·(v_s - v_m) - w) (n·(w_s - w_m))`: at the closest points of two bodies the relative velocity along the normal is the given one
///
/// Source: Newton's law of restitution, `w = -e n·(v_s - v_m)^n`.
/// Couples: velocities of one vertex of the slave and of the facet of the master.
/// Units: force (2D: per unit depth).
#[derive(Clone)]
pub(crate) struct Collision<const D: usize> {
    /// Dofs with their share in the relative velocity along the normal.
    dofs: Vec<(DofId, f64)>,
    /// The velocity `w` at the stage, positive in approach.
    velocity: f64,
    /// The weight `c`.
    weight: f64,
    /// Normal into the obstacle.
    normal: Vector<D>,
}

impl<const D: usize> Collision<D> {
    /// Returns the collision of a contact; `None` if its law has no restitution, the bodies are not in contact at the start of the step, or they do not
    /// approach.
    pub(crate) fn new(
        contact: &Contact<D>,
        (setup, previous): (&Setup<D>, &State<D>),
        step: Partners<'_, D>,
    ) -> Option<Self> {
        let law = &contact.form().law;
        let restitution = law.restitution()?;
        let surface = |id: mesh::BodyId| step.bodies[id.index()].surface();
        let (slave, master) = (surface(contact.body()), contact.master().map(surface));
        let opposite = master.map_or(&[][..], |master| &master.begin);
        let placed = Placed::new(slave.boundary, &slave.begin);
        let candidates = contact.geometry().candidates(placed, contact.facets(), opposite, law.offset());
        let mut closest: Option<(f64, VertexId, Projection<D>)> = None;
        for (number, &facet) in contact.facets().iter().enumerate() {
            let near = candidates.as_ref().map_or(&[][..], |of_facets| &of_facets[number]);
            for &vertex in slave.boundary.facet(facet) {
                let x: Point<D> = slave.begin[vertex.index()];
                let Some(found) = contact.geometry().project(&x, Positions::Fixed(opposite), near) else { continue };
                let gap = found.gap(&x);
                let at = ContactPoint { gap, size: contact.form().size(), ..ContactPoint::default() };
                if law.is_active(&at) && closest.as_ref().is_none_or(|(least, ..)| gap < *least) {
                    closest = Some((gap, vertex, found));
                }
            }
        }
        let (_, vertex, found) = closest?;
        let velocity = |id: mesh::BodyId, vertex: VertexId| previous.bodies[id.index()].velocity()[vertex.index()];
        let layout = step.layout;
        let (mut dofs, mut approach) = (Vec::new(), velocity(contact.body(), vertex).dot(&found.normal));
        let mut add = |surface: &body::SurfaceMotion<'_, D>, vertex: VertexId, share: f64| {
            if let Some(field) = surface.field() {
                let of_vertex = layout.node(field, vertex.index()).zip(&found.normal);
                dofs.extend(of_vertex.map(|(dof, n)| (dof, share * n)).filter(|(_, share)| *share != 0.0));
            }
        };
        add(slave, vertex, 1.0);
        if let (Some(id), Some(master), Anchor::Facet { facet, barycentric, .. }) =
            (contact.master(), master, found.anchor)
        {
            for (&vertex, share) in master.boundary.facet(facet).iter().zip(barycentric) {
                approach -= velocity(id, vertex).dot(&found.normal) * share;
                add(master, vertex, -share);
            }
        }
        if approach <= 0.0 || dofs.is_empty() {
            return None;
        }
        let bodies = [Some(contact.body()), contact.master()].into_iter().flatten();
        let balance = |id: mesh::BodyId| setup.bodies[id.index()].balance(&previous.bodies[id.index()]);
        let mass = bodies.filter_map(balance).map(|balance| balance.mass).fold(0.0, f64::max);
        Some(Self {
            dofs,
            velocity: step.time.weights.stage_velocity(-restitution * approach, approach),
            weight: STIFFNESS * mass / step.time.length,
            normal: found.normal,
        })
    }

    /// Returns the force on the slave.
    pub(crate) fn force(&self, x: &[f64]) -> Vector<D> {
        self.normal * -(self.weight * self.excess(x))
    }

    /// Returns the difference of the relative velocity from the given one.
    fn excess(&self, x: &[f64]) -> f64 {
        self.dofs.iter().map(|(dof, share)| share * x[dof.index()]).sum::<f64>() - self.velocity
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
        let force = self.weight * self.excess(x);
        for (i, (_, share)) in self.dofs.iter().enumerate() {
            out.add(i, force * share);
            if out.has_tangent() {
                for (j, (_, other)) in self.dofs.iter().enumerate() {
                    out.add_tangent(i, j, self.weight * share * other);
                }
            }
        }
    }

    fn is_linear(&self) -> bool {
        true
    }
}

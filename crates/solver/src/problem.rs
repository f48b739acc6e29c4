//! The coupled problem of one step, by composition.

use algebra::{Contributions, Equations, Integral};
use body::SurfaceMotion;
use contact::ContactSites;
use contact::terms::ContactWork;
use interface_dg::terms::{ClosedPressure, MovedPressure};
use interface_dg::{ClosedPoints, InterfacePoints, MovedSurface};
use mesh::{BodyId, Order};

use crate::Step;

/// The coupled problem of one step.
pub struct Problem<'p, const D: usize> {
    /// Layout, contributions and constraints.
    pub equations: Equations<'p>,
    pub(crate) step: &'p Step<'p, D>,
    /// The interface, if there is a fluid.
    pub interface: Option<InterfacePoints<'p, D>>,
    /// Surfaces of bodies that deform, where they differ from the plane facets of the cut.
    pub moved: Vec<(BodyId, MovedSurface<'p, D>)>,
    /// The contacts, in the order of the setup.
    pub contacts: Vec<ContactSites<'p, D>>,
    /// Parts of surfaces that border no fluid, of bodies in contacts whose law depends on the jump of stress.
    pub closed: Vec<(BodyId, ClosedPoints<'p, D>)>,
}

impl<const D: usize> Step<'_, D> {
    /// Composes the problem. The order of its contributions is that of Eq. (11) of the paper. The paper does not have
    /// pressures on moved surfaces, collisions, and the pressure on closed parts of surfaces.
    pub fn problem(&self) -> Problem<'_, D> {
        let layout = &self.layout;
        let mut contributions: Vec<Box<dyn Contributions + '_>> = Vec::new();
        contributions.extend(self.fluid.iter().flat_map(|fluid| fluid.contributions(layout)));
        for body in &self.bodies {
            contributions.extend(body.contributions(layout).into_iter().chain(body.loads(layout)));
        }
        let interface = self.interface();
        if let (Some(fluid), Some(points)) = (&self.fluid, &interface) {
            contributions.push(Box::new(fluid.mortar.contributions(points.clone())));
            contributions.extend(fluid.mortar.in_films(points.clone()).map(|slips| Box::new(slips) as _));
        }
        let moved = interface.as_ref().map_or_else(Vec::new, |points| self.moved_surfaces(points));
        for (_, surface) in &moved {
            contributions.push(Box::new(moved_pressure(surface.clone())));
        }
        let contacts = self.setup.contacts.iter().zip(&self.contacts);
        let contacts: Vec<_> = contacts.map(|(contact, step)| step.sites(contact, self.refs())).collect();
        for sites in &contacts {
            contributions.push(Box::new(contact_work(sites.clone())));
        }
        for collision in self.collisions.iter().flatten() {
            contributions.push(Box::new(collision.clone()));
        }
        let closed = self.refs().closed(&self.setup.contacts);
        for (_, points) in &closed {
            contributions.push(Box::new(closed_pressure(points.clone())));
        }
        let equations = Equations { layout, contributions, constraints: &self.constraints };
        Problem { equations, step: self, interface, moved, contacts, closed }
    }

    /// Returns the surfaces of bodies that differ from the plane facets of the cut: at the stage, and for order 2 with
    /// every scheme.
    fn moved_surfaces<'p>(&'p self, points: &InterfacePoints<'p, D>) -> Vec<(BodyId, MovedSurface<'p, D>)> {
        let differs =
            |surface: &SurfaceMotion<'_, D>| surface.stage.is_some() || surface.boundary.order() != Order::Linear;
        let bodies =
            self.bodies.iter().enumerate().filter(|(_, body)| differs(body.surface())).map(|(b, _)| BodyId::new(b));
        bodies.map(|body| (body, MovedSurface::new(points.clone(), body))).collect()
    }
}

/// Returns the weak form of the pressure on the closed part of a surface.
pub(crate) fn closed_pressure<const D: usize>(points: ClosedPoints<'_, D>) -> Integral<'_, ClosedPoints<'_, D>> {
    Integral::new("closed surface", points, vec![&ClosedPressure])
}

/// Returns the weak form of a contact.
pub(crate) fn contact_work<const D: usize>(sites: ContactSites<'_, D>) -> Integral<'_, ContactSites<'_, D>> {
    Integral::new("contact", sites, vec![&ContactWork])
}

/// Returns the weak form of the pressure on a moved surface.
pub(crate) fn moved_pressure<const D: usize>(surface: MovedSurface<'_, D>) -> Integral<'_, MovedSurface<'_, D>> {
    Integral::new("moved surface", surface, vec![&MovedPressure])
}

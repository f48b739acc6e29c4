//! The coupled problem of one step, by composition.

use algebra::{Contributions, Equations, Integral};
use contact::ContactSites;
use contact::terms::ContactWork;
use interface_dg::InterfacePoints;

use crate::Step;

/// The coupled problem of one step.
pub struct Problem<'p, const D: usize> {
    /// Layout, contributions and constraints.
    pub equations: Equations<'p>,
    pub(crate) step: &'p Step<'p, D>,
    /// The interface, if there is a fluid.
    pub interface: Option<InterfacePoints<'p, D>>,
    /// The contacts, in the order of the setup.
    pub contacts: Vec<ContactSites<'p, D>>,
}

impl<const D: usize> Step<'_, D> {
    /// Composes the problem; the order of its contributions is that of Eq. (11) of the paper.
    pub fn problem(&self) -> Problem<'_, D> {
        let layout = &self.layout;
        let mut contributions: Vec<Box<dyn Contributions + '_>> = Vec::new();
        contributions.extend(self.fluid.iter().flat_map(|fluid| fluid.contributions(layout)));
        contributions.extend(self.bodies.iter().flat_map(|body| body.contributions(layout)));
        let interface = self.fluid.as_ref().map(|fluid| fluid.interface(layout, &self.bodies));
        if let (Some(fluid), Some(points)) = (&self.fluid, &interface) {
            contributions.push(Box::new(fluid.mortar.contributions(points.clone())));
        }
        let contacts = self.setup.contacts.iter().zip(&self.contacts);
        let contacts: Vec<_> = contacts.map(|(contact, step)| step.sites(contact, self.partners())).collect();
        for sites in &contacts {
            contributions.push(Box::new(Integral::new("contact", sites.clone(), vec![&ContactWork])));
        }
        let equations = Equations { layout, contributions, constraints: &self.constraints };
        Problem { equations, step: self, interface, contacts }
    }
}

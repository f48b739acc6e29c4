//! Bodies and contacts without a fluid around them.
//!
//! The same bodies, supports, loads, contacts and time schemes as in the coupled problem, without background, cut and space.

use algebra::{
    BlockLayout, Constraints, Contributions, NewtonReport, NewtonSettings, NonlinearProblem, Workspace, newton,
};
use contact::ContactReport;
use solid_svk::energy::BodyBalance;

use crate::bodies::{self, BodyForms};
use crate::state::{initial_body, next_time};
use crate::{Body, BodyState, Contact, Stage, StepError};

/// Bodies and contacts, and how they are advanced: everything constant in time.
pub struct DrySetup<const D: usize> {
    /// The bodies.
    pub bodies: Vec<Body<D>>,
    /// The contacts.
    pub contacts: Vec<Contact<D>>,
    /// Time step.
    pub dt: f64,
    /// Newton's method.
    pub newton: NewtonSettings,
}

/// The state at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct DryState<const D: usize> {
    /// Number of steps since the start.
    pub step: usize,
    /// Time.
    pub time: f64,
    /// The bodies, in the order of the setup.
    pub bodies: Vec<BodyState<D>>,
}

/// What a step has to say about itself.
#[derive(Clone, Debug)]
pub struct DryReport<const D: usize> {
    /// Newton's method.
    pub newton: NewtonReport,
    /// The contacts.
    pub contacts: Vec<ContactReport<D>>,
}

impl<const D: usize> DryState<D> {
    /// The state at time zero.
    pub fn initial(setup: &DrySetup<D>) -> Self {
        Self { step: 0, time: 0.0, bodies: setup.bodies.iter().map(|body| initial_body(&body.kind)).collect() }
    }

    /// Energies, momentum and volume of a body; `None` if its motion is prescribed.
    pub fn balance(&self, setup: &DrySetup<D>, body: usize) -> Option<BodyBalance<D>> {
        setup.bodies[body].balance(&self.bodies[body])
    }
}

struct DryProblem<'a, const D: usize> {
    layout: &'a BlockLayout,
    constraints: Constraints,
    forms: BodyForms<'a, D>,
}

impl<const D: usize> NonlinearProblem for DryProblem<'_, D> {
    fn layout(&self) -> &BlockLayout {
        self.layout
    }

    fn contributions(&self) -> Vec<&dyn Contributions> {
        self.forms.solids().chain(self.forms.contacts()).collect()
    }

    fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    fn regime(&self, x: &[f64]) -> u64 {
        self.forms.regime(x)
    }
}

/// Advances the bodies by one step.
///
/// # Errors
/// [`StepError`] with the stage that failed; the previous state is untouched.
pub fn advance<const D: usize>(
    setup: &DrySetup<D>,
    previous: &DryState<D>,
    work: &mut Workspace,
) -> Result<(DryState<D>, DryReport<D>), StepError> {
    let (step, time) = (previous.step + 1, next_time(previous.time, setup.dt));
    let failed = |stage: Stage| StepError::at(step, time, stage);
    let mut layout = BlockLayout::new();
    let when = (time, setup.dt);
    let unknowns = bodies::unknowns(&setup.bodies, &setup.contacts, &previous.bodies, when, &mut layout)
        .map_err(|e| failed(e.into()))?;
    let mut constraints = Constraints::new();
    bodies::constrain(&setup.bodies, &unknowns, &layout, time, &mut constraints).map_err(|e| failed(e.into()))?;
    let forms = BodyForms::new(&setup.bodies, &setup.contacts, &unknowns, &layout, &previous.bodies, setup.dt)
        .map_err(|e| failed(e.into()))?;
    let problem = DryProblem { layout: &layout, constraints, forms };
    let mut x = vec![0.0; layout.len()];
    bodies::set_velocities(&unknowns, &previous.bodies, &layout, &mut x);
    let newton = newton(&problem, &mut x, work, &setup.newton).map_err(|e| failed(e.into()))?;
    problem.forms.check_contacts(&x, &newton).map_err(failed)?;
    let contacts = problem.forms.contacts.iter().map(|contact| ContactReport::new(contact, &x)).collect();
    let bodies = bodies::accept(&setup.bodies, &unknowns, &layout, time, &x);
    Ok((DryState { step, time, bodies }, DryReport { newton, contacts }))
}

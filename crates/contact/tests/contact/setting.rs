//! Bodies, steps, laws and sums of contributions for the tests.

use std::sync::Arc;

use algebra::time::TimeScheme;
use algebra::{
    BlockLayout, BlockSystem, Constraints, Contributions, Equations, Integral, NewtonReport, NewtonSettings, Sites,
    Workspace,
};
use body::{Body, BodyState, BodyStep, StepTime, SurfaceMotion};
use contact::terms::ContactWork;
use contact::{
    ContactForm, ContactItems, ContactPair, ContactPoint, ContactReport, ContactSites, Obstacle, StressSource,
};
use mesh::generate::structured_box;
use mesh::{FacetId, Vector, VertexId};
use rand::RngExt;
use rand_xoshiro::SplitMix64;
use solid_svk::{ElasticBody, ElasticOptions, LameParameters, Order, SaintVenantKirchhoff, SolidForm, SolidMesh};

/// Bodies in one step. The first one is the slave, and the second one, if there is one, is the master.
pub(crate) struct Scene<'a, const D: usize> {
    pub(crate) layout: BlockLayout,
    pub(crate) steps: Vec<Box<dyn BodyStep<D> + 'a>>,
    time: StepTime,
}

impl<'a, const D: usize> Scene<'a, D> {
    pub(crate) fn new(
        bodies: &'a [ElasticBody<D>],
        states: &'a [BodyState<D>],
        scheme: &dyn TimeScheme,
        dt: f64,
    ) -> Self {
        let mut layout = BlockLayout::new();
        let time = StepTime::new(scheme, dt, dt, true);
        let steps = bodies.iter().zip(states).map(|(body, state)| body.step(state, &time, &mut layout)).collect();
        Self { layout, steps, time }
    }

    /// Returns the pair of slave and obstacle, with the stress if the law depends on it.
    pub(crate) fn pair<'s>(
        &'s self,
        form: &'s ContactForm<D>,
        facets: &'s [FacetId],
        obstacle: &'s dyn Obstacle<D>,
    ) -> ContactPair<'s, D> {
        let [slave, master] = [0, 1].map(|k| self.steps.get(k).map(|step| step.surface()));
        let positions = slave.map_or(&[][..], |slave| &slave.start);
        let stress = self.steps[0].stress(&self.layout, positions).filter(|_| form.law.stress() != StressSource::None);
        ContactPair {
            form,
            slave: slave.unwrap(),
            facets,
            obstacle,
            master,
            stress: stress.map(Arc::from),
            share: 1.0,
            conserves: self.time.weights.conserves,
        }
    }

    /// Returns the velocities at the start of the step.
    pub(crate) fn guess(&self) -> Vec<f64> {
        let mut x = vec![0.0; self.layout.len()];
        self.steps.iter().for_each(|step| step.guess(&self.layout, &mut x));
        x
    }

    pub(crate) fn solve(&self, contact: ContactSites<'_, D>, x: &mut [f64], tolerance: f64) -> NewtonReport {
        let (layout, mut constraints) = (&self.layout, Constraints::new());
        self.steps.iter().for_each(|step| step.constrain(layout, &mut constraints));
        let mut contributions: Vec<Box<dyn Contributions + '_>> = Vec::new();
        self.steps
            .iter()
            .for_each(|step| contributions.extend(step.contributions(layout).into_iter().chain(step.loads(layout))));
        contributions.push(Box::new(work(contact)));
        let equations = Equations { layout, contributions, constraints: &constraints };
        algebra::newton(&equations, x, &mut Workspace::new(), &NewtonSettings::new(tolerance)).unwrap()
    }

    /// Solves from the velocities at the start of the step; returns report, states at the end, and iterations.
    pub(crate) fn advance(
        &self,
        pair: ContactPair<'_, D>,
        reach: f64,
        tolerance: f64,
    ) -> (ContactReport<D>, Vec<BodyState<D>>, usize) {
        let items = ContactItems::new(&pair, &self.layout, reach);
        let sites = ContactSites { items: &items, pair, layout: &self.layout };
        let mut x = self.guess();
        let iterations = self.solve(sites.clone(), &mut x, tolerance).iterations;
        (report_of(&sites, &x), self.end(&x), iterations)
    }

    pub(crate) fn end(&self, x: &[f64]) -> Vec<BodyState<D>> {
        self.steps.iter().map(|step| step.end(&self.layout, x)).collect()
    }
}

/// Returns the report of a contact whose shifted positions are those at the end.
pub(crate) fn report_of<const D: usize>(sites: &ContactSites<'_, D>, x: &[f64]) -> ContactReport<D> {
    let positions = |surface: &SurfaceMotion<'_, D>| {
        let vertices = (0..surface.start.len()).map(VertexId::new);
        vertices.map(|vertex| surface.position_at(vertex, sites.layout, x)).collect::<Vec<_>>()
    };
    let master = sites.pair.master.map(positions).unwrap_or_default();
    ContactReport::new(sites, x, [&positions(sites.pair.slave), &master])
}

/// Returns the weak form of a contact.
pub(crate) fn work<'a, const D: usize>(sites: ContactSites<'a, D>) -> Integral<'a, ContactSites<'a, D>> {
    Integral::new("contact", sites, vec![&ContactWork])
}

/// Returns a box of unit density of linear elements.
pub(crate) fn block<const D: usize>(
    min: [f64; D],
    max: [f64; D],
    n: [usize; D],
    lame: LameParameters,
    options: impl FnOnce(&SolidMesh<D>) -> ElasticOptions<D>,
) -> ElasticBody<D> {
    block_of(Order::Linear, (min, max), n, lame, options)
}

/// Returns a box of unit density between two corners.
pub(crate) fn block_of<const D: usize>(
    order: Order,
    (min, max): ([f64; D], [f64; D]),
    n: [usize; D],
    lame: LameParameters,
    options: impl FnOnce(&SolidMesh<D>) -> ElasticOptions<D>,
) -> ElasticBody<D> {
    elastic(SolidMesh::of_order(structured_box(min, max, n).unwrap(), order).unwrap(), lame, options)
}

/// Returns a body of unit density.
pub(crate) fn elastic<const D: usize>(
    solid: SolidMesh<D>,
    lame: LameParameters,
    options: impl FnOnce(&SolidMesh<D>) -> ElasticOptions<D>,
) -> ElasticBody<D> {
    let form = SolidForm::new(1.0, SaintVenantKirchhoff::new(lame), Vector::zeros()).unwrap();
    let options = options(&solid);
    ElasticBody::new("body", solid, form, options).unwrap()
}

/// Returns a function that creates the options of a body without supports that starts with a velocity.
pub(crate) fn with_velocity<const D: usize>(velocity: Vector<D>) -> impl FnOnce(&SolidMesh<D>) -> ElasticOptions<D> {
    move |_| ElasticOptions { initial_velocity: Some(Arc::new(move |_| velocity)), ..ElasticOptions::default() }
}

pub(crate) fn soft() -> LameParameters {
    LameParameters::new(50.0, 50.0).unwrap()
}

/// Returns a vector with random entries between -1 and 1.
pub(crate) fn vector<const D: usize>(random: &mut SplitMix64) -> Vector<D> {
    Vector::from_fn(|_, _| random.random_range(-1.0..1.0))
}

/// Returns random numbers between -scale and scale.
pub(crate) fn numbers(random: &mut SplitMix64, n: usize, scale: f64) -> Vec<f64> {
    (0..n).map(|_| random.random_range(-scale..scale)).collect()
}

/// Returns the residual of a contact.
pub(crate) fn residual<const D: usize>(sites: &ContactSites<'_, D>, x: &[f64]) -> Vec<f64> {
    let work = work(sites.clone());
    let mut system = BlockSystem::new(sites.layout, &[&work], &Constraints::new());
    system.assemble_residual(&[&work], x);
    system.residual().to_vec()
}

/// Returns the number of active points at which a condition holds.
pub(crate) fn n_active<const D: usize>(
    sites: &ContactSites<'_, D>,
    x: &[f64],
    condition: impl Fn(&ContactPoint) -> bool,
) -> usize {
    let mut n = 0;
    for item in 0..sites.len() {
        sites.visit(item, x, |site| n += usize::from(condition(&site.at)));
    }
    n
}

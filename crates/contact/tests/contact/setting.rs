//! Bodies, steps and sums of contributions for the tests.

use algebra::{BlockLayout, Constraints, Contributions, DofId, FieldId, LocalSystem, NewtonReport, NewtonSettings};
use algebra::{NonlinearProblem, Workspace};
use contact::{ContactBody, ContactFacets};
use mesh::generate::structured_box;
use mesh::{Point, Vector};
use solid_svk::{LameParameters, SaintVenantKirchhoff, SolidForm, SolidMesh, StepRule};

/// A problem made of given contributions; the last ones are contacts.
pub(crate) struct Problem<'a, const D: usize> {
    pub(crate) layout: &'a BlockLayout,
    pub(crate) solids: Vec<&'a dyn Contributions>,
    pub(crate) contacts: Vec<&'a ContactFacets<'a, D>>,
    pub(crate) constraints: Constraints,
}

impl<const D: usize> NonlinearProblem for Problem<'_, D> {
    fn layout(&self) -> &BlockLayout {
        self.layout
    }

    fn contributions(&self) -> Vec<&dyn Contributions> {
        let contacts = self.contacts.iter().map(|&c| c as &dyn Contributions);
        self.solids.iter().copied().chain(contacts).collect()
    }

    fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    fn regime(&self, x: &[f64]) -> u64 {
        self.contacts.iter().fold(0, |hash, contact| hash.rotate_left(1) ^ contact.regime(x))
    }
}

impl<const D: usize> Problem<'_, D> {
    pub(crate) fn solve(&self, x: &mut [f64], tolerance: f64) -> NewtonReport {
        algebra::newton(self, x, &mut Workspace::new(), &NewtonSettings::new(tolerance)).unwrap()
    }
}

/// One body with its field in a layout.
pub(crate) struct Body<const D: usize> {
    pub(crate) solid: SolidMesh<D>,
    pub(crate) form: SolidForm<D>,
    pub(crate) field: FieldId,
    pub(crate) displacement: Vec<Vector<D>>,
    pub(crate) velocity: Vec<Vector<D>>,
}

impl<const D: usize> Body<D> {
    /// A box at rest.
    pub(crate) fn block(
        layout: &mut BlockLayout,
        min: [f64; D],
        max: [f64; D],
        n: [usize; D],
        lame: LameParameters,
    ) -> Self {
        let solid = SolidMesh::new(structured_box(min, max, n).unwrap()).unwrap();
        let form = SolidForm::new(1.0, SaintVenantKirchhoff::new(lame), Vector::zeros()).unwrap();
        let field = layout.push("body", solid.n_dofs());
        let rest = vec![Vector::zeros(); solid.mesh().n_vertices()];
        Self { solid, form, field, displacement: rest.clone(), velocity: rest }
    }

    pub(crate) fn step(&self, dt: f64) -> StepRule<D> {
        StepRule::implicit_euler(dt, &self.displacement, &self.velocity).unwrap()
    }

    pub(crate) fn positions(&self) -> Vec<Point<D>> {
        self.solid.positions(&self.displacement).unwrap()
    }

    pub(crate) fn contact<'a>(
        &'a self,
        positions: &'a [Point<D>],
        dt: f64,
        layout: &BlockLayout,
    ) -> ContactBody<'a, D> {
        ContactBody::new(self.solid.boundary(), positions, dt, layout, self.field).unwrap()
    }

    /// Takes over the state at the end of a step.
    pub(crate) fn accept(&mut self, step: &StepRule<D>, layout: &BlockLayout, x: &[f64]) {
        self.velocity = self.solid.velocity(layout, self.field, x).unwrap();
        self.displacement = step.end().displacement.values(&self.velocity).unwrap();
    }
}

pub(crate) fn soft() -> LameParameters {
    LameParameters::new(50.0, 50.0).unwrap()
}

/// Pseudo-random numbers in (-1, 1).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector<const D: usize>(&mut self) -> Vector<D> {
        Vector::from_fn(|_, _| self.number())
    }

    pub(crate) fn numbers(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| self.number() * scale).collect()
    }
}

/// Residual of a contribution.
pub(crate) fn residual(contribution: &dyn Contributions, n: usize, x: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; n];
    let (mut dofs, mut local): (Vec<DofId>, _) = (Vec::new(), LocalSystem::new());
    for item in 0..contribution.len() {
        dofs.clear();
        contribution.dofs(item, &mut dofs);
        let mut sorted = dofs.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), dofs.len(), "dofs of an item are distinct");
        local.reset(dofs.len());
        contribution.add(item, x, &mut local);
        dofs.iter().zip(local.residual()).for_each(|(d, r)| sum[d.index()] += r);
    }
    sum
}

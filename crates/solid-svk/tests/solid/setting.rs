//! A body alone: layout, step and contributions for the tests.

use algebra::{
    BlockLayout, Constraints, Contributions, DofId, FieldId, NewtonReport, NewtonSettings, NonlinearProblem, Workspace,
};
use mesh::{Point, Vector};
use solid_svk::{LameParameters, SaintVenantKirchhoff, SolidForm, SolidMesh};

/// A problem made of given contributions.
pub(crate) struct Problem<'a> {
    pub(crate) layout: &'a BlockLayout,
    pub(crate) contributions: Vec<&'a dyn Contributions>,
    pub(crate) constraints: Constraints,
}

impl NonlinearProblem for Problem<'_> {
    fn layout(&self) -> &BlockLayout {
        self.layout
    }

    fn contributions(&self) -> Vec<&dyn Contributions> {
        self.contributions.clone()
    }

    fn constraints(&self) -> &Constraints {
        &self.constraints
    }
}

impl<'a> Problem<'a> {
    pub(crate) fn new(
        layout: &'a BlockLayout,
        contributions: Vec<&'a dyn Contributions>,
        values: impl IntoIterator<Item = (DofId, f64)>,
    ) -> Self {
        Self { layout, contributions, constraints: values.into_iter().collect() }
    }

    pub(crate) fn solve(&self, x: &mut [f64], tolerance: f64) -> NewtonReport {
        algebra::newton(self, x, &mut Workspace::new(), &NewtonSettings::new(tolerance)).unwrap()
    }
}

/// The material of the ball in the paper, Sec. 4.
pub(crate) fn ball_material() -> SaintVenantKirchhoff {
    SaintVenantKirchhoff::new(LameParameters::new(2e6, 8e6).unwrap())
}

/// A body of that material without weight.
pub(crate) fn weightless<const D: usize>() -> SolidForm<D> {
    SolidForm::new(1.0, ball_material(), Vector::zeros()).unwrap()
}

/// The unit square or cube, divided into `n` bricks along each side.
pub(crate) fn unit_box<const D: usize>(n: usize) -> SolidMesh<D> {
    SolidMesh::new(mesh::generate::structured_box([0.0; D], [1.0; D], [n; D]).unwrap()).unwrap()
}

pub(crate) fn one_field<const D: usize>(mesh: &SolidMesh<D>) -> (BlockLayout, FieldId) {
    let mut layout = BlockLayout::new();
    // A field in front, so that the body does not begin at zero.
    layout.push("other", 5);
    let field = layout.push("solid velocity", mesh.n_dofs());
    (layout, field)
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

    pub(crate) fn vectors<const D: usize>(&mut self, n: usize, scale: f64) -> Vec<Vector<D>> {
        (0..n).map(|_| self.vector() * scale).collect()
    }

    pub(crate) fn numbers(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| self.number() * scale).collect()
    }
}

/// Sum of the residuals of contributions.
pub(crate) fn residual(contributions: &[&dyn Contributions], x: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; x.len()];
    let (mut dofs, mut local) = (Vec::new(), algebra::LocalSystem::new());
    for contribution in contributions {
        for item in 0..contribution.len() {
            dofs.clear();
            contribution.dofs(item, &mut dofs);
            local.reset(dofs.len());
            contribution.add(item, x, &mut local);
            dofs.iter().zip(local.residual()).for_each(|(d, r)| sum[d.index()] += r);
        }
    }
    sum
}

pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

pub(crate) fn largest_difference<const D: usize>(a: &[Point<D>], b: &[Point<D>]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (x, y)| m.max((x - y).norm()))
}

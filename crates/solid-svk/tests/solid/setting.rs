//! A body alone: layout, step and contributions for the tests.

use algebra::time::{Level, StepRule, TimeScheme};
use algebra::{
    BlockLayout, BlockSystem, Constraints, Contributions, DofId, Equations, FieldId, NewtonReport, NewtonSettings,
    Workspace,
};
use mesh::{Point, Vector};
use solid_svk::{LameParameters, SaintVenantKirchhoff, SolidCells, SolidForm, SolidMesh};

/// Dofs of the field in front of the body.
const N_OTHER: usize = 5;

/// Solves for the body. The dofs of the field in front of it are zero.
pub(crate) fn solve(
    layout: &BlockLayout,
    contributions: Vec<Box<dyn Contributions + '_>>,
    mut constraints: Constraints,
    x: &mut [f64],
    tolerance: f64,
) -> NewtonReport {
    (0..N_OTHER).for_each(|k| constraints.set(DofId::new(k), 0.0));
    let equations = Equations { layout, contributions, constraints: &constraints };
    algebra::newton(&equations, x, &mut Workspace::new(), &NewtonSettings::new(tolerance)).unwrap()
}

/// Returns a level without acceleration.
pub(crate) fn level<const D: usize>(displacement: Vec<Vector<D>>, velocity: Vec<Vector<D>>) -> Level<Vector<D>> {
    Level { displacement, velocity, acceleration: Vec::new() }
}

pub(crate) fn at_rest<const D: usize>(mesh: &SolidMesh<D>) -> Level<Vector<D>> {
    let zero = vec![Vector::zeros(); mesh.mesh().n_vertices()];
    level(zero.clone(), zero)
}

pub(crate) fn rule<const D: usize>(scheme: &dyn TimeScheme, dt: f64, level: &Level<Vector<D>>) -> StepRule<Vector<D>> {
    StepRule::new(&scheme.weights(dt, level.acceleration.is_empty()), level)
}

/// Returns the global vector with given velocities of the body.
pub(crate) fn state<const D: usize>(layout: &BlockLayout, field: FieldId, velocity: &[Vector<D>]) -> Vec<f64> {
    let mut x = vec![0.0; layout.len()];
    layout.set(field, velocity.iter().map(|v| (*v).into()), &mut x);
    x
}

pub(crate) fn velocities<const D: usize>(layout: &BlockLayout, field: FieldId, x: &[f64]) -> Vec<Vector<D>> {
    layout.values(field, x).map(Vector::from).collect()
}

/// Advances a body without supports by one step.
pub(crate) fn advance<const D: usize>(
    mesh: &SolidMesh<D>,
    form: &SolidForm<D>,
    scheme: &dyn TimeScheme,
    dt: f64,
    tolerance: f64,
    level: &Level<Vector<D>>,
) -> Level<Vector<D>> {
    let (layout, field) = one_field(mesh);
    let rule = rule(scheme, dt, level);
    let cells = SolidCells { solid: mesh, rule: &rule, layout: &layout, velocity: field };
    let mut x = state(&layout, field, &level.velocity);
    let contributions: Vec<Box<dyn Contributions + '_>> =
        vec![Box::new(form.inertia_and_body_force(cells)), Box::new(form.internal_work(cells))];
    solve(&layout, contributions, Constraints::new(), &mut x, tolerance);
    scheme.weights(dt, level.acceleration.is_empty()).end(level, &velocities(&layout, field, &x))
}

/// Returns the material of the ball in the paper, Sec. 4.
pub(crate) fn ball_material() -> SaintVenantKirchhoff {
    SaintVenantKirchhoff::new(LameParameters::new(2e6, 8e6).unwrap())
}

/// Returns the form of a body of that material without weight.
pub(crate) fn weightless<const D: usize>() -> SolidForm<D> {
    SolidForm::new(1.0, ball_material(), Vector::zeros()).unwrap()
}

/// Returns the unit square or cube, divided into `n` bricks along each side.
pub(crate) fn unit_box<const D: usize>(n: usize) -> SolidMesh<D> {
    SolidMesh::new(mesh::generate::structured_box([0.0; D], [1.0; D], [n; D]).unwrap()).unwrap()
}

pub(crate) fn one_field<const D: usize>(mesh: &SolidMesh<D>) -> (BlockLayout, FieldId) {
    let mut layout = BlockLayout::new();
    // A field in front, so that the body does not begin at zero.
    layout.push("other", N_OTHER, 1);
    let field = layout.push("solid velocity", mesh.mesh().n_vertices(), D);
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

/// Returns the sum of the residuals of contributions.
pub(crate) fn residual(layout: &BlockLayout, contributions: &[&dyn Contributions], x: &[f64]) -> Vec<f64> {
    let mut system = BlockSystem::new(layout, contributions, &Constraints::new());
    system.assemble_residual(contributions, x);
    system.residual().to_vec()
}

pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

pub(crate) fn largest_difference<const D: usize>(a: &[Point<D>], b: &[Point<D>]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (x, y)| m.max((x - y).norm()))
}

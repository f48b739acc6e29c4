//! A body alone: layout, step and contributions for the tests.

use algebra::time::{Level, StepRule, TimeScheme};
use algebra::{
    BlockLayout, BlockSystem, Constraints, Contributions, DofId, Equations, FieldId, NewtonReport, NewtonSettings,
    Workspace,
};
use mesh::generate::structured_box;
use mesh::{FacetId, Point, SimplexMesh, Tensor, Vector, VertexId, sym};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;
use solid_svk::{LameParameters, Order, SaintVenantKirchhoff, SolidCells, SolidForm, SolidMesh};

/// Number of dofs of the field that precedes the velocity in the layout.
const N_OTHER: usize = 5;

/// Solves for the body. The dofs of the field that precedes its velocity are zero.
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
    let zero = vec![Vector::zeros(); mesh.nodes().len()];
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
    let (layout, field) = padded_layout(mesh);
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

/// Returns the form of a body of [`ball_material`] with density 1 and without gravity.
pub(crate) fn weightless<const D: usize>() -> SolidForm<D> {
    SolidForm::new(1.0, ball_material(), Vector::zeros()).unwrap()
}

pub(crate) const ORDERS: [Order; 2] = [Order::Linear, Order::Quadratic];

/// Returns the unit square or cube, divided into `n` bricks along each side.
pub(crate) fn unit_mesh<const D: usize>(n: usize) -> SimplexMesh<D> {
    structured_box([0.0; D], [1.0; D], [n; D]).unwrap()
}

/// Returns the unit square or cube of linear elements, divided into `n` bricks along each side.
pub(crate) fn unit_body<const D: usize>(n: usize) -> SolidMesh<D> {
    SolidMesh::new(unit_mesh(n)).unwrap()
}

/// Returns the unit square or cube with all vertices inside moved.
pub(crate) fn distorted<const D: usize>(n: usize, order: Order) -> SolidMesh<D> {
    let (mesh, mut random) = (unit_mesh::<D>(n), SplitMix64::seed_from_u64(17));
    let is_inside = |x: &Point<D>| x.iter().all(|c| *c > 0.0 && *c < 1.0);
    let mut moved = |x: &Point<D>| if is_inside(x) { x + vector::<D>(&mut random) * (0.15 / n as f64) } else { *x };
    let vertices = mesh.vertices().iter().map(&mut moved).collect();
    let cells = mesh.cells().flat_map(|cell| mesh.cell(cell).to_vec()).collect();
    let moved = SimplexMesh::new(vertices, cells).unwrap();
    let named = moved.with_facet_tags(|facet| mesh.facet_tag(facet).map(|tag| mesh.tag_names()[tag.index()].as_str()));
    SolidMesh::of_order(named, order).unwrap()
}

/// Returns the unit square or cube of quadratic elements with curved edges, inside and on the boundary.
pub(crate) fn curved<const D: usize>(n: usize) -> SolidMesh<D> {
    SolidMesh::curved(unit_mesh(n), |_, x: Point<D>| {
        x + Vector::from_fn(|a, _| 0.05 / n as f64 * (7.0 * x.sum() + a as f64).sin())
    })
    .unwrap()
}

/// Returns a disk around the origin of quadratic elements, whose nodes on the boundary lie on the circle.
pub(crate) fn round_disk(mesh: SimplexMesh<2>, radius: f64) -> SolidMesh<2> {
    let on_circle = |facet: &FacetId| mesh.is_boundary(*facet);
    let sides: Vec<[VertexId; 2]> =
        mesh.facets().filter(on_circle).map(|f| [mesh.facet(f)[0], mesh.facet(f)[1]]).collect();
    let on_circle = |[a, b]: [VertexId; 2]| sides.contains(&[a, b]) || sides.contains(&[b, a]);
    SolidMesh::curved(mesh, |ends, x| if on_circle(ends) { x * (radius / x.norm()) } else { x }).unwrap()
}

/// A displacement that is quadratic in the position.
pub(crate) struct Quadratic<const D: usize> {
    linear: Tensor<D>,
    /// Second derivatives of each component, symmetric.
    hessians: [Tensor<D>; D],
}

/// Returns a displacement with strains of a few percent on the unit square or cube.
pub(crate) fn quadratic_field<const D: usize>() -> Quadratic<D> {
    let mut random = SplitMix64::seed_from_u64(23);
    let mut tensor = |scale: f64| Tensor::<D>::from_fn(|_, _| scale * random.random_range(-1.0..1.0));
    Quadratic { linear: tensor(0.05), hessians: std::array::from_fn(|_| sym(&tensor(0.05))) }
}

impl<const D: usize> Quadratic<D> {
    pub(crate) fn at(&self, x: &Point<D>) -> Vector<D> {
        self.linear * x + Vector::from_fn(|a, _| 0.5 * x.dot(&(self.hessians[a] * x)))
    }

    pub(crate) fn gradient(&self, x: &Point<D>) -> Tensor<D> {
        let mut gradient = self.linear;
        (0..D).for_each(|a| gradient.set_row(a, &(gradient.row(a) + (self.hessians[a] * x).transpose())));
        gradient
    }

    /// Returns `div (2 μ e + λ tr e I)` of the strain `e`, a constant.
    pub(crate) fn divergence_of_stress(&self, lame: &LameParameters) -> Vector<D> {
        // ∂_b ∂_b u_a, and ∂_a ∂_b u_b.
        let laplacian = Vector::<D>::from_fn(|a, _| self.hessians[a].trace());
        let grad_div = Vector::<D>::from_fn(|a, _| (0..D).map(|b| self.hessians[b][(a, b)]).sum());
        laplacian * lame.mu + grad_div * (lame.mu + lame.lambda)
    }
}

/// Returns a layout with another field before the velocity, so that its first dof is not zero, and the velocity.
pub(crate) fn padded_layout<const D: usize>(mesh: &SolidMesh<D>) -> (BlockLayout, FieldId) {
    let mut layout = BlockLayout::new();
    layout.push("other", N_OTHER, 1);
    let field = layout.push("solid velocity", mesh.nodes().len(), D);
    (layout, field)
}

/// Returns a vector with random entries between -1 and 1.
pub(crate) fn vector<const D: usize>(random: &mut SplitMix64) -> Vector<D> {
    Vector::from_fn(|_, _| random.random_range(-1.0..1.0))
}

/// Returns random vectors with entries between -scale and scale.
pub(crate) fn vectors<const D: usize>(random: &mut SplitMix64, n: usize, scale: f64) -> Vec<Vector<D>> {
    (0..n).map(|_| vector(random) * scale).collect()
}

/// Returns random numbers between -scale and scale.
pub(crate) fn numbers(random: &mut SplitMix64, n: usize, scale: f64) -> Vec<f64> {
    (0..n).map(|_| random.random_range(-scale..scale)).collect()
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

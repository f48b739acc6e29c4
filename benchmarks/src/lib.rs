//! Fixtures of the benchmarks.

use std::sync::Arc;

use algebra::time::{ImplicitEuler, Level, StepRule, TimeScheme};
use algebra::{BlockLayout, BlockSystem, Contributions, Equations, NewtonSettings};
use body::Body;
use contact::{ContactForm, PenaltyLaw, RigidPlane};
use fluid_ns::NewtonianFluid;
use fluid_ns::terms::CipProfile;
use mesh::generate::{BallOptions, Size, graded_box, half_ball, structured_box};
use mesh::{BodyId, Point, SimplexMesh, Vector};
use solid_svk::supports::tagged_facets;
use solid_svk::{
    ElasticBody, ElasticOptions, LameParameters, Material, SaintVenantKirchhoff, SolidCells, SolidForm, SolidMesh,
    Support, SupportKind,
};
use solver::{Contact, ContactObstacle, FluidBoundary, FluidSetup, Problem, Setup, Stabilisation, State, Step};

mod shapes;
mod unfitted_stokes;

pub use shapes::{BODY_CENTRE, polygon, sphere};
pub use unfitted_stokes::UnfittedStokes;

// Compiles the code of the README and of the guides, since this package depends on all libraries.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
#[doc = include_str!("../../docs/src/guides/cutcell-alone.md")]
#[doc = include_str!("../../docs/src/guides/add-a-body.md")]
#[doc = include_str!("../../docs/src/guides/add-a-contact-law.md")]
#[doc = include_str!("../../docs/src/guides/add-a-material.md")]
#[doc = include_str!("../../docs/src/guides/add-a-term.md")]
#[doc = include_str!("../../docs/src/guides/add-a-time-scheme.md")]
struct Documents;

/// Stabilisation with the uniform penalty of the paper and interior penalties that vanish under refinement. Versions
/// before the standard set solve the step in 3D with these parameters, so that times can be compared with theirs.
pub const UNIFORM: Stabilisation =
    Stabilisation { cip: CipProfile::Consistent { gamma_u: 0.1 }, ..Stabilisation::PAPER_44_2019 };

/// Gap between ball and ground, cm. Cut cells are in the fine part of the background, and contact is inactive.
const GAP: f64 = 0.2;

/// Contact size and offset, cm: contact is active at smaller gaps.
const CONTACT_SIZE: f64 = 0.1;

/// A resolution, with its name in benchmark ids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Name; "h04" is 0.4 cm near the ground and in the ball.
    pub name: &'static str,
    /// Size of cells near the ground and in the ball, cm.
    pub fine: f64,
    /// Size of cells far from the ground, cm.
    pub coarse: f64,
}

/// Resolutions from coarse to that of the paper.
pub const RESOLUTIONS: [Resolution; 3] = [
    Resolution { name: "h04", fine: 0.4, coarse: 1.0 },
    Resolution { name: "h02", fine: 0.2, coarse: 0.8 },
    Resolution { name: "h01", fine: 0.1, coarse: 0.5 },
];

/// Returns the mesh of the graded box in which the ball falls: the half on one side of the plane of symmetry.
pub fn background(resolution: Resolution) -> SimplexMesh<2> {
    let Resolution { fine, coarse, .. } = resolution;
    let size = Size::Graded { fine, fine_until: 4.5, coarse, coarse_from: 10.0, axis: 1 };
    graded_box([0.0, 0.0], [10.0, 15.0], &size).expect("a box of positive extent and size")
}

/// Returns the mesh of the half ball above the ground.
pub fn ball(resolution: Resolution) -> SimplexMesh<2> {
    ball_above(resolution, GAP)
}

fn ball_above(resolution: Resolution, gap: f64) -> SimplexMesh<2> {
    let options = BallOptions { area_preserving: false };
    half_ball([0.0, 4.0 + gap], 4.0, resolution.fine, &options).expect("a ball of positive radius and size")
}

/// Returns the setup of the paper's cases: an elastic ball in a fluid, above the ground.
pub fn falling_ball(resolution: Resolution) -> Setup<2> {
    ball_in_fluid(resolution, GAP)
}

/// Returns the setup of [`falling_ball`] with the ball so close to the ground that contact is active.
pub fn ball_in_contact(resolution: Resolution) -> Setup<2> {
    ball_in_fluid(resolution, 0.5 * CONTACT_SIZE)
}

fn ball_in_fluid(resolution: Resolution, gap: f64) -> Setup<2> {
    let mut fluid = fluid(background(resolution), Stabilisation::PAPER_44_2019);
    let tag = |name: &str| fluid.background.tag(name).expect("sides of a box are tagged");
    let open = || FluidBoundary::Open { traction: None, backflow: true };
    fluid.boundary = vec![
        (tag("bottom"), FluidBoundary::NoSlip),
        (tag("left"), FluidBoundary::symmetry(0)),
        (tag("right"), open()),
        (tag("top"), open()),
    ];
    let solid = SolidMesh::new(ball_above(resolution, gap)).expect("a mesh with positive cells");
    let surface = tagged_facets(&solid, "surface").expect("a ball has a surface");
    let diameter = tagged_facets(&solid, "left").expect("a half ball has a diameter");
    let support = Support { vertices: solid.boundary().vertices_of(&diameter), kind: SupportKind::symmetry(0) };
    let options = ElasticOptions { supports: vec![support], ..ElasticOptions::default() };
    let bodies = vec![elastic("ball", solid, options)];
    let ground = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).expect("a unit normal");
    let form = ContactForm::new(PenaltyLaw::new(1e8, CONTACT_SIZE).expect("a positive penalty"), CONTACT_SIZE)
        .expect("a positive size");
    let contact = Contact::new(&bodies, BodyId(0), surface, form, ContactObstacle::Rigid(Box::new(ground)));
    Setup { contacts: vec![contact.expect("facets of the ball")], ..setup(fluid, bodies, 1e-3) }
}

/// Returns a fluid of density and viscosity of the paper, at rest, without conditions on the boundary.
fn fluid<const D: usize>(background: SimplexMesh<D>, stabilisation: Stabilisation) -> FluidSetup<D> {
    let material = NewtonianFluid { density: 1.0, viscosity: 1e-2 };
    FluidSetup { stabilisation, ..FluidSetup::new(background, material) }
}

fn set_sides<const D: usize>(fluid: &mut FluidSetup<D>, condition: fn(&str) -> FluidBoundary<D>) {
    let sides = shapes::SIDES.iter().filter_map(|name| Some((fluid.background.tag(name)?, condition(name))));
    fluid.boundary = sides.collect();
}

/// Returns an elastic body of the density and stiffness of the paper, under gravity.
fn elastic<const D: usize>(name: &str, solid: SolidMesh<D>, options: ElasticOptions<D>) -> Arc<dyn Body<D>> {
    let material = SaintVenantKirchhoff::new(LameParameters { mu: 2e6, lambda: 8e6 });
    let mut gravity = Vector::<D>::zeros();
    gravity[1] = -1e3;
    let form = SolidForm::new(1.0, material, gravity).expect("a positive density");
    Arc::new(ElasticBody::new(name, solid, form, options).expect("supports on vertices of the body"))
}

/// Returns a setup of bodies in a fluid without contacts.
fn setup<const D: usize>(fluid: FluidSetup<D>, bodies: Vec<Arc<dyn Body<D>>>, dt: f64) -> Setup<D> {
    let newton = NewtonSettings::new(1e-8);
    Setup {
        fluid: Some(fluid),
        bodies,
        contacts: Vec::new(),
        scheme: Arc::new(ImplicitEuler),
        dt,
        most_halvings: 0,
        approach: None,
        newton,
    }
}

/// Returns the setup of an elastic square or cube that falls in a box of `n` squares or cubes along each side. Cells of
/// the body have nearly the same size. Weight, stiffness and time step are of the order of those in the paper.
pub fn falling_box<const D: usize>(n: usize, stabilisation: Stabilisation) -> Setup<D> {
    const SIDE: f64 = 10.0;
    let background = structured_box([0.0; D], [SIDE; D], [n; D]).expect("a box");
    let mut fluid = fluid(background, stabilisation);
    set_sides(&mut fluid, |name| match name {
        "top" => FluidBoundary::Open { traction: None, backflow: true },
        _ => FluidBoundary::NoSlip,
    });
    // Not aligned with the planes of the background.
    let corner: [f64; D] = std::array::from_fn(|axis| 3.0 + BODY_CENTRE[axis]);
    let cube = structured_box(corner, corner.map(|x| x + 0.4 * SIDE), [(2 * n).div_ceil(5); D]).expect("a box");
    let solid = SolidMesh::new(cube).expect("a mesh with positive cells");
    setup(fluid, vec![elastic("box", solid, ElasticOptions::default())], 1e-3)
}

/// Returns the setup of a rotating fluid in a box of `n` x `n` squares without bodies, with convection
/// and interior penalties on all faces.
pub fn whirl(n: usize) -> Setup<2> {
    let background = structured_box([0.0, 0.0], [1.0, 1.0], [n, n]).expect("a box");
    let mut fluid = fluid(background, Stabilisation::STANDARD);
    fluid.initial_velocity = Some(Arc::new(|x| Vector::<2>::new(x[1] - 0.5, 0.5 - x[0])));
    set_sides(&mut fluid, |_| FluidBoundary::NoSlip);
    setup(fluid, Vec::new(), 1e-2)
}

/// Returns the number of cells of the background.
pub fn n_background_cells<const D: usize>(setup: &Setup<D>) -> usize {
    setup.fluid.as_ref().map_or(0, |fluid| fluid.background.n_cells())
}

/// Calls a closure with the layout of an elastic unit square or cube of `n` bricks along each side, its internal work
/// and a state.
pub fn with_internal_work<const D: usize, R>(
    n: usize,
    material: impl Material<D> + 'static,
    then: impl FnOnce(&BlockLayout, &dyn Contributions, &[f64]) -> R,
) -> R {
    let mesh = structured_box([0.0; D], [1.0; D], [n; D]).expect("a box");
    let solid = SolidMesh::new(mesh).expect("a mesh with positive cells");
    let form = SolidForm::new(1.0, material, Vector::zeros()).expect("a positive density");
    let rest = vec![Vector::zeros(); solid.mesh().n_vertices()];
    let level = Level { displacement: rest.clone(), velocity: rest, acceleration: Vec::new() };
    let rule = StepRule::new(&ImplicitEuler.weights(1.0, true), &level);
    let mut layout = BlockLayout::new();
    let field = layout.push("velocity", solid.mesh().n_vertices(), D);
    let work = form.internal_work(SolidCells { solid: &solid, rule: &rule, layout: &layout, velocity: field });
    let x: Vec<f64> = (0..layout.len()).map(|k| 1e-3 * (k as f64).sin()).collect();
    then(&layout, &work, &x)
}

/// Calls a closure with the problem of the first step and its starting guess.
pub fn with_first_problem<const D: usize, R>(setup: &Setup<D>, then: impl FnOnce(&Problem<'_, D>, &[f64]) -> R) -> R {
    let start = State::initial(setup).expect("the body cuts the background");
    let step = Step::prepare(setup, &start, start.step_time(setup, setup.dt)).expect("the body cuts the background");
    then(&step.problem(), &step.guess())
}

/// Returns the assembled and equilibrated system of the first step.
pub fn first_system<const D: usize>(setup: &Setup<D>) -> BlockSystem {
    with_first_problem(setup, |problem, x| system_at(&problem.equations, x))
}

/// Returns the assembled and equilibrated system of unfitted Stokes flow.
pub fn stokes_system<const D: usize>(stokes: &UnfittedStokes<D>) -> BlockSystem {
    stokes.with_equations(|equations| system_at(equations, &vec![0.0; equations.layout.len()]))
}

/// Returns references to the contributions of equations.
pub fn contributions<'e>(equations: &'e Equations<'_>) -> Vec<&'e dyn Contributions> {
    equations.contributions.iter().map(|contribution| contribution.as_ref() as &dyn Contributions).collect()
}

/// Creates the system of equations, not assembled yet.
pub fn system(equations: &Equations<'_>) -> BlockSystem {
    BlockSystem::new(equations.layout, &contributions(equations), equations.constraints)
}

fn system_at(equations: &Equations<'_>, x: &[f64]) -> BlockSystem {
    let mut system = system(equations);
    system.assemble(&contributions(equations), x);
    system.equilibrate().expect("a regular matrix");
    system
}

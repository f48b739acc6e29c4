//! Fixtures of the benchmarks: a ball in a box at three resolutions.

use std::sync::Arc;

use algebra::{BlockLayout, BlockSystem, Contributions, NewtonSettings, NonlinearProblem};
use contact::{ContactForm, Penalty, RigidPlane};
use cutcell::{CutMesh, OverlayOptions};
use fluid_ns::NewtonianFluid;
use fluid_ns::terms::CipProfile;
use mesh::generate::{BallOptions, Size, graded_box, half_ball, structured_box};
use mesh::{BodyId, BoundaryMesh, Point, SimplexMesh, Vector, VertexId};
use solid_svk::boundary::{tagged_facets, vertices_of};
use solid_svk::{
    LameParameters, Material, SaintVenantKirchhoff, SolidCells, SolidForm, SolidMesh, StepRule, TimeScheme,
};
use solver::{
    Body, BodyKind, BodySupport, Contact, ContactObstacle, ElasticBody, FluidBoundary, FluidSetup, FsiProblem, Setup,
    State, StepForms, StepGeometry, StepSystem, SupportKind,
};

mod published_forms;
mod unfitted_stokes;

pub use unfitted_stokes::{StokesErrors, StokesProblem, StokesWeights, UnfittedStokes};

// The code of the README and of the guides is compiled here, where all libraries are in sight.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
#[cfg(doctest)]
#[doc = include_str!("../../docs/src/guides/cutcell-alone.md")]
struct CutcellAlone;

/// Gap between ball and ground: cut cells lie in the fine part of the background, contact does not act.
const GAP: f64 = 0.2;

/// Distance of ball and ground from which on the penalty of contact acts.
const CONTACT_SIZE: f64 = 0.1;

/// A resolution, with the name that it has in benchmark ids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Name: "h04" is 0.4 cm near the ground and in the ball.
    pub name: &'static str,
    /// Size of cells near the ground and in the ball, cm.
    pub fine: f64,
    /// Size of cells far away, cm.
    pub coarse: f64,
}

/// From a toy to the resolution of the paper.
pub const RESOLUTIONS: [Resolution; 3] = [
    Resolution { name: "h04", fine: 0.4, coarse: 1.0 },
    Resolution { name: "h02", fine: 0.2, coarse: 0.8 },
    Resolution { name: "h01", fine: 0.1, coarse: 0.5 },
];

/// The graded box in which the ball falls (half of it: the rest is its mirror image).
pub fn background(resolution: Resolution) -> SimplexMesh<2> {
    let Resolution { fine, coarse, .. } = resolution;
    let size = Size::Graded { fine, fine_until: 4.5, coarse, coarse_from: 10.0, axis: 1 };
    graded_box([0.0, 0.0], [10.0, 15.0], &size).expect("a box of positive extent and size")
}

/// The half ball just above the ground.
pub fn ball(resolution: Resolution) -> SimplexMesh<2> {
    ball_above(resolution, GAP)
}

fn ball_above(resolution: Resolution, gap: f64) -> SimplexMesh<2> {
    let options = BallOptions { area_preserving: false };
    half_ball([0.0, 4.0 + gap], 4.0, resolution.fine, &options).expect("a ball of positive radius and size")
}

/// Centre of disk and sphere in boxes around the origin: where the peers put it, too.
pub const BODY_CENTRE: [f64; 3] = [0.041_421_356_237_309_5, 0.073_205_080_756_887_7, 0.023_606_797_749_979];

/// A disk as a surface: a polygon with its corners on the circle around the first two coordinates of `centre`.
pub fn polygon(centre: [f64; 3], radius: f64, n_edges: u32) -> (Vec<Point<2>>, BoundaryMesh<2>) {
    let corner = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(n_edges);
        Point::<2>::new(centre[0], centre[1]) + Point::<2>::new(angle.cos(), angle.sin()) * radius
    };
    let facets = (0..n_edges).flat_map(|k| [VertexId(k), VertexId((k + 1) % n_edges)]).collect();
    ((0..n_edges).map(corner).collect(), BoundaryMesh::from_facets(facets))
}

/// A sphere as a surface: an octahedron with each triangle divided into n².
pub fn sphere(centre: [f64; 3], radius: f64, n: u32) -> (Vec<Point<3>>, BoundaryMesh<3>) {
    let mut numbers = std::collections::HashMap::new();
    let mut positions = Vec::new();
    let mut facets = Vec::new();
    for octant in 0..8 {
        let signs: [i64; 3] = std::array::from_fn(|k| if octant >> k & 1 == 0 { 1 } else { -1 });
        let mut vertex = |i: u32, j: u32| {
            let key = [i64::from(n - i - j) * signs[0], i64::from(i) * signs[1], i64::from(j) * signs[2]];
            *numbers.entry(key).or_insert_with(|| {
                positions.push(Point::<3>::from(centre) + Point::<3>::from(key.map(|c| c as f64)).normalize() * radius);
                VertexId::new(positions.len() - 1)
            })
        };
        let mut push = |[a, b, c]: [VertexId; 3]| {
            facets.extend(if signs.iter().product::<i64>() > 0 { [a, b, c] } else { [a, c, b] });
        };
        for i in 0..n {
            for j in 0..n - i {
                push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                if i + j + 1 < n {
                    push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
        }
    }
    (positions, BoundaryMesh::from_facets(facets))
}

/// The elastic ball in the fluid of the paper's cases, above the ground.
pub fn falling_ball(resolution: Resolution) -> Setup<2> {
    ball_in_fluid(resolution, GAP)
}

/// The same with the ball so close to the ground that the penalty of contact acts.
pub fn ball_in_contact(resolution: Resolution) -> Setup<2> {
    ball_in_fluid(resolution, 0.5 * CONTACT_SIZE)
}

fn ball_in_fluid(resolution: Resolution, gap: f64) -> Setup<2> {
    let background = background(resolution);
    let tag = |name: &str| background.tag(name).expect("sides of a box are tagged");
    let open = || FluidBoundary::Open { traction: None, backflow: true };
    let fluid = FluidSetup {
        material: NewtonianFluid { density: 1.0, viscosity: 1e-2 },
        cip: CipProfile::Paper { gamma_1: 0.7 },
        gamma_pressure: 0.1,
        gamma_ghost: 1.0,
        convection: Some(false),
        body_force: None,
        initial_velocity: None,
        boundary: vec![
            (tag("bottom"), FluidBoundary::NoSlip),
            (tag("left"), FluidBoundary::Symmetry { axis: 0 }),
            (tag("right"), open()),
            (tag("top"), open()),
        ],
    };
    let solid = SolidMesh::new(ball_above(resolution, gap)).expect("a mesh with positive cells");
    let surface = tagged_facets(&solid, "surface").expect("a ball has a surface");
    let diameter = tagged_facets(&solid, "left").expect("a half ball has a diameter");
    let support = BodySupport { vertices: vertices_of(&solid, &diameter), kind: SupportKind::Symmetry { axis: 0 } };
    let material = SaintVenantKirchhoff::new(LameParameters { mu: 2e6, lambda: 8e6 });
    let elastic = ElasticBody {
        form: SolidForm::new(1.0, material, Vector::<2>::new(0.0, -1e3)).expect("a positive density"),
        scheme: TimeScheme::ImplicitEuler,
        solid,
        supports: vec![support],
        loads: Vec::new(),
        initial_displacement: None,
        initial_velocity: None,
    };
    let ground = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).expect("a unit normal");
    let contact = Contact {
        body: BodyId(0),
        facets: surface,
        form: ContactForm::new(Penalty::new(1e8, CONTACT_SIZE).expect("a positive penalty"), CONTACT_SIZE)
            .expect("a positive size"),
        obstacle: ContactObstacle::Rigid(Box::new(ground)),
    };
    Setup {
        fluid,
        background,
        bodies: vec![Body { name: "ball".to_owned(), kind: BodyKind::Elastic(Box::new(elastic)) }],
        contacts: vec![contact],
        gamma_sigma: 1e5,
        dt: 1e-3,
        most_halvings: 0,
        newton: NewtonSettings::new(1e-8),
        overlay: OverlayOptions::new(),
    }
}

/// An elastic square or cube that falls in a box of N squares or cubes along each side, with cells of the same size: the
/// coupled problem at any size in two and three dimensions. Its weight, stiffness and time step are of the paper's order.
pub fn falling_box<const D: usize>(n: usize) -> Setup<D> {
    const SIDE: f64 = 10.0;
    let background = structured_box([0.0; D], [SIDE; D], [n; D]).expect("a box");
    let open = |name: &str| name == "top";
    let boundary = unfitted_stokes::SIDES.iter().filter_map(|name| {
        let condition =
            if open(name) { FluidBoundary::Open { traction: None, backflow: true } } else { FluidBoundary::NoSlip };
        background.tag(name).map(|tag| (tag, condition))
    });
    let fluid = FluidSetup {
        material: NewtonianFluid { density: 1.0, viscosity: 1e-2 },
        cip: CipProfile::Consistent { gamma_u: 0.1 },
        gamma_pressure: 0.1,
        gamma_ghost: 1.0,
        convection: Some(false),
        body_force: None,
        initial_velocity: None,
        boundary: boundary.collect(),
    };
    // Off the planes of the background, and a little above the middle.
    let corner: [f64; D] = std::array::from_fn(|axis| 3.0 + BODY_CENTRE[axis]);
    let body = structured_box(corner, corner.map(|x| x + 0.4 * SIDE), [(2 * n).div_ceil(5); D]).expect("a box");
    let mut gravity = Vector::<D>::zeros();
    gravity[1] = -1e3;
    let elastic = ElasticBody {
        scheme: TimeScheme::ImplicitEuler,
        solid: SolidMesh::new(body).expect("a mesh with positive cells"),
        form: SolidForm::new(1.0, SaintVenantKirchhoff::new(LameParameters { mu: 2e6, lambda: 8e6 }), gravity)
            .expect("a positive density"),
        supports: Vec::new(),
        loads: Vec::new(),
        initial_displacement: None,
        initial_velocity: None,
    };
    Setup {
        fluid,
        background,
        bodies: vec![Body { name: "box".to_owned(), kind: BodyKind::Elastic(Box::new(elastic)) }],
        contacts: Vec::new(),
        gamma_sigma: 1e5,
        dt: 1e-3,
        most_halvings: 0,
        newton: NewtonSettings::new(1e-8),
        overlay: OverlayOptions::new(),
    }
}

/// Fluid that turns in a box of N x N squares without bodies: convection, and interior penalties on all faces.
pub fn whirl(n: usize) -> Setup<2> {
    let background = structured_box([0.0, 0.0], [1.0, 1.0], [n, n]).expect("a box");
    let walls = ["left", "right", "bottom", "top"].map(|name| background.tag(name).expect("sides of a box are tagged"));
    Setup {
        fluid: FluidSetup {
            material: NewtonianFluid { density: 1.0, viscosity: 1e-2 },
            cip: CipProfile::Consistent { gamma_u: 0.1 },
            gamma_pressure: 0.1,
            gamma_ghost: 1.0,
            convection: Some(false),
            body_force: None,
            initial_velocity: Some(Arc::new(|x| Vector::<2>::new(x[1] - 0.5, 0.5 - x[0]))),
            boundary: walls.map(|tag| (tag, FluidBoundary::NoSlip)).into(),
        },
        background,
        bodies: Vec::new(),
        contacts: Vec::new(),
        gamma_sigma: 0.0,
        dt: 1e-2,
        most_halvings: 0,
        newton: NewtonSettings::new(1e-8),
        overlay: OverlayOptions::new(),
    }
}

/// An elastic unit square or cube, divided into `n` bricks along each side.
pub fn elastic_box<const D: usize>(n: usize, material: impl Material<D> + 'static) -> (SolidMesh<D>, SolidForm<D>) {
    let mesh = structured_box([0.0; D], [1.0; D], [n; D]).expect("a box");
    let form = SolidForm::new(1.0, material, Vector::zeros()).expect("a positive density");
    (SolidMesh::new(mesh).expect("a mesh with positive cells"), form)
}

/// Calls a closure with the layout of a body, its internal work and a state.
pub fn with_internal_work<const D: usize, R>(
    (solid, form): &(SolidMesh<D>, SolidForm<D>),
    then: impl FnOnce(&BlockLayout, &dyn Contributions, &[f64]) -> R,
) -> R {
    let rest = vec![Vector::zeros(); solid.mesh().n_vertices()];
    let step = StepRule::implicit_euler(1.0, &rest, &rest).expect("a positive time step");
    let mut layout = BlockLayout::new();
    let field = layout.push("velocity", solid.n_dofs());
    let cells = SolidCells::new(solid, form, &step, &layout, field).expect("a field of the size of the body");
    let x: Vec<f64> = (0..layout.len()).map(|k| 1e-3 * (k as f64).sin()).collect();
    then(&layout, &cells.internal_work(), &x)
}

/// Calls a closure with the problem of the first step and its starting guess.
pub fn with_first_problem<const D: usize, R>(
    setup: &Setup<D>,
    then: impl FnOnce(&FsiProblem<'_, D>, &[f64]) -> R,
) -> R {
    let start = State::initial(setup).expect("the ball cuts the background");
    let positions = setup.positions(&start.bodies);
    let surfaces = setup.surfaces(&positions);
    let cut = CutMesh::overlay(&setup.background, &surfaces, &setup.overlay).expect("the ball cuts the background");
    let geometry = StepGeometry::new(setup, &start, positions, cut);
    let system = StepSystem::new(setup, &geometry, &start, setup.dt).expect("the parts of the setup fit");
    let forms = StepForms::new(setup, &geometry, &system);
    let problem = FsiProblem::new(setup, &geometry, &system, &forms, &start).expect("the parts of the setup fit");
    let x = problem.initial_guess(&geometry, &start);
    then(&problem, &x)
}

/// The assembled system of the first step.
pub fn first_system<const D: usize>(setup: &Setup<D>) -> BlockSystem {
    with_first_problem(setup, |problem, x| system_at(problem, x))
}

/// The assembled system of unfitted Stokes flow.
pub fn stokes_system<const D: usize>(stokes: &UnfittedStokes<D>) -> BlockSystem {
    stokes.with_problem(|problem| system_at(problem, &vec![0.0; problem.layout().len()]))
}

fn system_at(problem: &dyn NonlinearProblem, x: &[f64]) -> BlockSystem {
    let contributions = problem.contributions();
    let mut system = BlockSystem::new(problem.layout(), &contributions, problem.constraints());
    system.assemble(&contributions, x);
    system
}

//! Bodies that pass vertices, edges and faces of the mesh by a distance of either sign, in the plane and in space.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use cutwater::algebra::{Scaling, Workspace, condition_number};
use cutwater::fluid_ns::terms::CipProfile;
use cutwater::mesh::generate::structured_box;
use cutwater::mesh::search::SurfaceIndex;
use cutwater::mesh::{Placed, Point, SimplexMesh, Vector, VertexId};
use cutwater::solver::body::{Body, PrescribedBody, TimeField};
use cutwater::solver::{FluidBoundary, FluidSetup, Setup, Stabilisation, State, Substep, advance};

use super::flow::{Flow, fluid, fluid_mut, fluid_of, interface, polygon, problem, wet, wet_report};
use super::orders::StokesPolynomial;
use super::record::worse;
use super::{Failure, P};

/// Squares per side of the plane box, bricks per side of the one in space; both have sides of length one.
const N: [usize; 2] = [12, 5];
/// Length of a step in which inertia is negligible.
pub(super) const STEADY: f64 = 1e9;
/// Length of a step in which viscosity is negligible: `ρ h²/(μ dt)` is about 7000 in the plane.
pub(super) const SHORT: f64 = 1e-6;
/// Largest depth inside of bodies, in cells, at which vertices count as fluid: those that are passed.
const PASSED: f64 = 0.11;

type Bodies<const D: usize> = Vec<Arc<dyn Body<D>>>;

/// A motion of bodies past a vertex, edge or face of the mesh.
pub(super) struct Sweep<const D: usize> {
    /// Names of the body and of the part of the mesh that it passes.
    pub(super) name: &'static str,
    /// Bodies that are past it by a distance in cells, which is negative before.
    bodies: fn(f64) -> Result<Bodies<D>, Failure>,
}

/// Sweeps in the plane.
pub(super) const PLANE: [Sweep<2>; 5] = [
    Sweep { name: "side past a vertex", bodies: side_past_a_vertex },
    Sweep { name: "side past an edge", bodies: side_past_an_edge },
    Sweep { name: "notch past a vertex", bodies: |s| notch(s, 0.0) },
    Sweep { name: "notch past an edge", bodies: |s| notch(s, 0.37) },
    Sweep { name: "two sides that close a gap", bodies: gap },
];

/// Sweeps in space: the fluid in cut cells is a slice along a face, a wedge along an edge, or a corner at a vertex.
pub(super) const SPACE: [Sweep<3>; 3] = [
    Sweep { name: "cube, side past a vertex", bodies: |s| cube([0.5, 0.4], s) },
    Sweep { name: "cube, side past an edge", bodies: |s| cube([0.0, 0.4], s) },
    Sweep { name: "cube, side past a face", bodies: |s| cube([0.0, 0.0], s) },
];

fn size<const D: usize>() -> f64 {
    1.0 / N[D - 2] as f64
}

/// Returns the setup of one step of the flow around bodies. The ghost penalty is the only penalty of jumps of velocity
/// gradients.
fn setup<const D: usize>(bodies: Bodies<D>, dt: f64) -> Result<Setup<D>, Failure> {
    let background = structured_box::<D>([-0.5; D], [0.5; D], [N[D - 2]; D])?;
    let side = |name: &str| background.tag(name).ok_or("a box has sides");
    let mut boundary = Vec::new();
    for name in if D == 2 { &["left", "bottom", "top"][..] } else { &["left", "front", "back", "bottom", "top"] } {
        boundary.push((side(name)?, FluidBoundary::Velocity(polynomial())));
    }
    let traction = |x: &Point<D>, n: &Vector<D>, _: f64| {
        let x = plane(x);
        let gradient = StokesPolynomial.gradient(&x, 0.0);
        let viscous = (gradient + gradient.transpose()) * P::new(n[0], n[1]);
        Vector::from_fn(|a, _| if a < 2 { viscous[a] } else { 0.0 }) - n * StokesPolynomial.pressure(&x, 0.0)
    };
    boundary.push((side("right")?, FluidBoundary::Open { traction: Some(Arc::new(traction)), backflow: false }));
    let at_start = polynomial();
    let fluid = FluidSetup {
        stabilisation: Stabilisation { cip: CipProfile::Consistent { gamma_u: 0.0 }, ..Stabilisation::STANDARD },
        // In space the flow starts from rest.
        initial_velocity: (D == 2).then(|| Arc::new(move |x: &Point<D>| at_start(x, 0.0)) as _),
        boundary,
        ..fluid(background, 1.0, 1.0)
    };
    Ok(Setup { bodies, ..problem(fluid, dt) })
}

fn plane<const D: usize>(x: &Point<D>) -> P {
    P::new(x[0], x[1])
}

/// Returns the velocity of the plane flow, also in space.
fn polynomial<const D: usize>() -> TimeField<D> {
    Arc::new(|x, t| {
        let u = StokesPolynomial.velocity(&plane(x), t);
        Vector::from_fn(|a, _| if a < 2 { u[a] } else { 0.0 })
    })
}

/// Turns a point from the first axis towards another one.
fn turned<const D: usize>(x: &Point<D>, to: usize, angle: f64) -> Point<D> {
    let (mut turned, (sin, cos)) = (*x, angle.sin_cos());
    turned[0] = cos * x[0] - sin * x[to];
    turned[to] = sin * x[0] + cos * x[to];
    turned
}

/// Returns a polygon, turned and then moved to a place of the mesh. Corners and place are in units of cells; the place
/// is relative to the middle of the box.
fn placed(corners: &[[f64; 2]], angle: f64, place: [f64; 2]) -> Arc<dyn Body<2>> {
    let h = size::<2>();
    let corners = corners.iter().map(|&[x, y]| (turned(&P::new(x, y), 1, angle) + P::from(place)) * h);
    polygon(&[corners.collect()], |x, _| *x, polynomial())
}

/// Returns the corners of a rectangle, from one corner to the opposite one.
fn rectangle(low: [f64; 2], high: [f64; 2]) -> [[f64; 2]; 4] {
    [low, [high[0], low[1]], high, [low[0], high[1]]]
}

/// Returns a body with a side that passes a vertex. Behind the vertex, the fluid in the cell is a corner.
fn side_past_a_vertex(s: f64) -> Result<Bodies<2>, Failure> {
    Ok(vec![placed(&rectangle([s - 3.3, -1.7], [s, 1.6]), 0.4, [2.0, 1.0])])
}

/// Returns a body with a side that passes a line of the mesh. Behind the line, the fluid in the cells is a slice, or a
/// corner between two slices.
fn side_past_an_edge(s: f64) -> Result<Bodies<2>, Failure> {
    Ok(vec![placed(&rectangle([s - 3.3, -1.67], [s, 1.63]), 0.0, [2.0, 0.0])])
}

/// Returns a body with a notch, whose tip reaches a vertex, or a point of the edge above it. The fluid in the cell is
/// the tip.
fn notch(s: f64, above: f64) -> Result<Bodies<2>, Failure> {
    let block = [[-1.7, -1.9], [1.6, -1.9], [1.6, -0.8], [0.0, 0.0], [1.6, 0.8], [1.6, 1.9], [-1.7, 1.9]];
    Ok(vec![placed(&block.map(|[x, y]| [x + s, y]), 0.2, [1.0, above])])
}

/// Returns two bodies with a gap. The fluid between them is a film that shares unknowns with the fluid around only at
/// its ends.
fn gap(s: f64) -> Result<Bodies<2>, Failure> {
    let place = [0.36, 0.54];
    let left = placed(&rectangle([s - 2.1, -1.7], [s, 1.6]), 0.15, place);
    Ok(vec![left, placed(&rectangle([0.0, -1.5], [2.2, 1.8]), 0.15, place)])
}

/// Returns a cube one of whose sides passes a vertex, turned about two axes.
fn cube([about_second, about_third]: [f64; 2], s: f64) -> Result<Bodies<3>, Failure> {
    let brick = structured_box::<3>([s - 1.6, -0.83, -0.77], [s, 0.77, 0.83], [1, 1, 1])?;
    let place = Point::<3>::new(0.5, 0.5, 0.5);
    let at = |x: &Point<3>| {
        let x = turned(&turned(x, 2, about_second), 1, about_third);
        (x + place) * size::<3>()
    };
    let velocity = polynomial::<3>();
    let body = PrescribedBody {
        name: "cube".to_owned(),
        boundary: brick.boundary(),
        reference: brick.vertices().iter().map(at).collect(),
        position: Arc::new(|x, _| *x),
        velocity: Arc::new(move |x, [_, t]| velocity(x, t)),
    };
    Ok(vec![Arc::new(body)])
}

/// Results at one distance.
pub(super) struct Found<const D: usize> {
    /// Condition numbers of the equilibrated matrix, and of the matrix as it is.
    pub(super) conditions: [f64; 2],
    /// The flow, if the system can be solved.
    pub(super) flow: Option<Numbers<D>>,
}

/// Numbers that should depend continuously on the distance.
pub(super) struct Numbers<const D: usize> {
    /// Velocity and pressure of vertices in the fluid, without those that have unknowns of several parts.
    at_vertices: BTreeMap<VertexId, (Vector<D>, f64)>,
    /// Force on all bodies together.
    force: Vector<D>,
    /// Kinetic energy of the fluid.
    pub(super) energy: f64,
}

impl<const D: usize> Numbers<D> {
    /// Returns the largest differences of velocity and of pressure over the vertices in both results, and the
    /// difference of the forces.
    pub(super) fn differences(&self, other: &Self) -> [f64; 3] {
        let mut largest = [0.0, 0.0, (self.force - other.force).norm()];
        for (vertex, (velocity, pressure)) in &self.at_vertices {
            let Some((other_velocity, other_pressure)) = other.at_vertices.get(vertex) else { continue };
            largest[0] = worse(largest[0], (velocity - other_velocity).norm());
            largest[1] = worse(largest[1], (pressure - other_pressure).abs());
        }
        largest
    }

    /// Returns the numbers of the exact flow at the same vertices. The flow exerts no force on a body, since no force
    /// acts on the fluid in its place.
    pub(super) fn exact(&self, background: &SimplexMesh<D>) -> Self {
        let of = |vertex: VertexId| {
            let x = background.vertex(vertex);
            (polynomial()(&x, 0.0), StokesPolynomial.pressure(&plane(&x), 0.0))
        };
        let at_vertices = self.at_vertices.keys().map(|&vertex| (vertex, of(vertex))).collect();
        Self { at_vertices, force: Vector::zeros(), energy: f64::NAN }
    }
}

impl<const D: usize> Sweep<D> {
    /// Returns the setup of a step with the bodies at a distance in cells.
    pub(super) fn setup(&self, distance: f64, dt: f64, has_ghost_penalty: bool) -> Result<Setup<D>, Failure> {
        let mut setup = setup((self.bodies)(distance)?, dt)?;
        if !has_ghost_penalty {
            fluid_mut(&mut setup)?.stabilisation.gamma_ghost = 0.0;
        }
        Ok(setup)
    }
}

/// Solves, and computes the condition numbers of the matrix.
pub(super) fn find<const D: usize>(setup: &Setup<D>) -> Result<Found<D>, Failure> {
    let mut work = Workspace::new();
    let step = advance(setup, &State::initial(setup)?, Substep::whole(setup.dt), &mut work);
    let system = work.system();
    // Without an inverse there is no condition number, or an infinite one.
    let conditions = [Scaling::Equilibrated, Scaling::None]
        .map(|scaling| condition_number(system.matrix(), system.layout(), scaling).unwrap_or(f64::INFINITY));
    let Ok((state, report)) = step else { return Ok(Found { conditions, flow: None }) };

    let (background, fluid) = (&fluid_of(setup)?.background, wet(&state)?);
    let bodies = setup.bodies.iter().zip(&fluid.positions);
    let surfaces: Vec<_> = bodies.map(|(body, x)| SurfaceIndex::new(&Placed::new(body.surface(), x))).collect();
    let depth = |x: &Point<D>| {
        let distances = surfaces.iter().filter_map(|surface| surface.signed_distance(x));
        distances.map(|distance| -distance).fold(f64::NEG_INFINITY, f64::max)
    };
    let (mut at_vertices, mut seen) = (BTreeMap::new(), BTreeSet::new());
    for (dof, &vertex) in fluid.space.vertices().iter().enumerate() {
        if !seen.insert(vertex) {
            // Fluid on the other side of a body has unknowns at the same vertex.
            at_vertices.remove(&vertex);
        } else if depth(&background.vertex(vertex)) < PASSED * size::<D>() {
            at_vertices.insert(vertex, (fluid.velocity[dof], fluid.pressure[dof]));
        }
    }
    let force = interface(&state, &report)?.map(|(piece, traction)| traction.total() * piece.measure).sum();
    let energy = wet_report(&report)?.kinetic_energy;
    Ok(Found { conditions, flow: Some(Numbers { at_vertices, force, energy }) })
}

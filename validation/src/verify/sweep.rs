//! Bodies at small positive and negative distances from vertices, edges and faces of the mesh, in 2D and 3D.

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

/// Squares along each side of the box in 2D, bricks along each side in 3D. Sides have length one.
const N: [usize; 2] = [12, 5];
/// Length of a step in which inertia is negligible.
pub(super) const STEADY: f64 = 1e9;
/// Length of a step in which viscosity is negligible: `ρ h²/(μ dt)` is about 7000 in the plane.
pub(super) const SHORT: f64 = 1e-6;
/// Largest depth inside a body, in cells, at which values of vertices are compared. Sweeps end at 0.1: vertices that a
/// body has just covered are included.
const PASSED: f64 = 0.11;

type Bodies<const D: usize> = Vec<Arc<dyn Body<D>>>;

/// A motion of bodies past a vertex, edge or face of the mesh.
pub(super) struct Sweep<const D: usize> {
    /// Names of the body and of the part of the mesh that the body passes.
    pub(super) name: &'static str,
    /// Returns the bodies at a signed distance, in cells, from that part of the mesh; positive once they have passed.
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

/// Returns the size of a square or brick.
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
        let x = first_two(x);
        let gradient = StokesPolynomial.gradient(&x, 0.0);
        let viscous = (gradient + gradient.transpose()) * P::new(n[0], n[1]);
        Vector::from_fn(|a, _| if a < 2 { viscous[a] } else { 0.0 }) - n * StokesPolynomial.pressure(&x, 0.0)
    };
    boundary.push((side("right")?, FluidBoundary::Open { traction: Some(Arc::new(traction)), backflow: false }));
    let at_start = polynomial();
    let fluid = FluidSetup {
        stabilisation: Stabilisation { cip: CipProfile::Consistent { gamma_u: 0.0 }, ..Stabilisation::STANDARD },
        // In 3D the flow starts from rest.
        initial_velocity: (D == 2).then(|| Arc::new(move |x: &Point<D>| at_start(x, 0.0)) as _),
        boundary,
        ..fluid(background, 1.0, 1.0)
    };
    Ok(Setup { bodies, ..problem(fluid, dt) })
}

fn first_two<const D: usize>(x: &Point<D>) -> P {
    P::new(x[0], x[1])
}

/// Returns the velocity of the plane flow, also in space.
fn polynomial<const D: usize>() -> TimeField<D> {
    Arc::new(|x, t| {
        let u = StokesPolynomial.velocity(&first_two(x), t);
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

/// Returns a body with a side that passes a vertex. Once it has passed, the fluid in the cell is a corner.
fn side_past_a_vertex(s: f64) -> Result<Bodies<2>, Failure> {
    Ok(vec![placed(&rectangle([s - 3.3, -1.7], [s, 1.6]), 0.4, [2.0, 1.0])])
}

/// Returns a body with a side that passes a line of the mesh. Once it has passed, the fluid in the cells is a slice, or
/// a corner between two slices.
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

/// Returns a cube whose side passes a vertex, an edge or a face, depending on the angles of its rotation, rad.
fn cube([angle_about_y, angle_about_z]: [f64; 2], s: f64) -> Result<Bodies<3>, Failure> {
    let brick = structured_box::<3>([s - 1.6, -0.83, -0.77], [s, 0.77, 0.83], [1, 1, 1])?;
    let place = Point::<3>::new(0.5, 0.5, 0.5);
    let at = |x: &Point<3>| {
        let x = turned(&turned(x, 2, angle_about_y), 1, angle_about_z);
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
pub(super) struct SweepResult<const D: usize> {
    /// Condition numbers of the matrix, with equilibration and without.
    pub(super) conditions: [f64; 2],
    /// The flow, if the system can be solved.
    pub(super) flow: Option<FlowValues<D>>,
}

/// Quantities that should depend continuously on the distance.
pub(super) struct FlowValues<const D: usize> {
    /// Velocity and pressure at vertices in the fluid, without vertices with unknowns of several parts.
    at_vertices: BTreeMap<VertexId, (Vector<D>, f64)>,
    /// Force on all bodies together.
    force: Vector<D>,
    /// Kinetic energy of the fluid.
    pub(super) energy: f64,
}

impl<const D: usize> FlowValues<D> {
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

    /// Returns the values of the exact flow at the same vertices. The exact force is zero: the flow satisfies the
    /// Stokes equations without body force also in the volume of the body. The energy is NaN.
    pub(super) fn exact(&self, background: &SimplexMesh<D>) -> Self {
        let of = |vertex: VertexId| {
            let x = background.vertex(vertex);
            (polynomial()(&x, 0.0), StokesPolynomial.pressure(&first_two(&x), 0.0))
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

/// Advances one step. Returns the condition numbers of its last matrix, and the flow if the step succeeded.
pub(super) fn solve<const D: usize>(setup: &Setup<D>) -> Result<SweepResult<D>, Failure> {
    let mut work = Workspace::new();
    let step = advance(setup, &State::initial(setup)?, Substep::whole(setup.dt), &mut work);
    let system = work.system();
    // A matrix that cannot be factorised has an infinite condition number.
    let conditions = [Scaling::Equilibrated, Scaling::None]
        .map(|scaling| condition_number(system.matrix(), system.layout(), scaling).unwrap_or(f64::INFINITY));
    let Ok((state, report)) = step else { return Ok(SweepResult { conditions, flow: None }) };

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
    Ok(SweepResult { conditions, flow: Some(FlowValues { at_vertices, force, energy }) })
}

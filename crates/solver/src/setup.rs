//! Everything that is constant in time.

use std::sync::Arc;

use algebra::NewtonSettings;
use contact::{ContactForm, DeformableObstacle, Obstacle};
use cutcell::OverlayOptions;
use fluid_ns::NewtonianFluid;
use fluid_ns::terms::CipProfile;
use mesh::{BodyId, BoundaryMesh, FacetId, Placed, Point, SimplexMesh, Tag, Vector, VertexId};
use solid_rigid::{MassProperties, Spin};
use solid_svk::{FacetTerm, SolidForm, SolidMesh, TimeScheme};

/// A vector at a point.
pub type PointField<const D: usize> = Arc<dyn Fn(&Point<D>) -> Vector<D> + Send + Sync>;
/// A vector at a point and time.
pub type TimeField<const D: usize> = Arc<dyn Fn(&Point<D>, f64) -> Vector<D> + Send + Sync>;
/// Velocity of a body at a point where it was at the first time, for the second one.
///
/// Within a step a body is where it was at the begin and has the velocity of the end: a rigid one has the velocity and spin of the
/// second time, with arms from where its centre was at the first. With equal times it is the velocity at a current position.
pub type SurfaceVelocity<const D: usize> = Arc<dyn Fn(&Point<D>, [f64; 2]) -> Vector<D> + Send + Sync>;
/// A traction at a point, given the outward normal, at a time.
pub type TractionField<const D: usize> = Arc<dyn Fn(&Point<D>, &Vector<D>, f64) -> Vector<D> + Send + Sync>;

/// A coupled problem: background, fluid, bodies, contacts and parameters.
pub struct Setup<const D: usize> {
    /// The background mesh.
    pub background: SimplexMesh<D>,
    /// The fluid.
    pub fluid: FluidSetup<D>,
    /// The bodies, in the order of the overlay.
    pub bodies: Vec<Body<D>>,
    /// The contacts.
    pub contacts: Vec<Contact<D>>,
    /// Penalty parameter `γ_Σ` of the mortar.
    pub gamma_sigma: f64,
    /// Time step.
    pub dt: f64,
    /// How often a step may be halved that fails (see [`crate::TimeLoop::run`]). Zero: the run stops with the first failure.
    pub most_halvings: usize,
    /// Newton's method.
    pub newton: NewtonSettings,
    /// The overlay.
    pub overlay: OverlayOptions,
}

/// The fluid with its stabilisation and boundary conditions.
pub struct FluidSetup<const D: usize> {
    /// Density and viscosity.
    pub material: NewtonianFluid,
    /// Interior penalty of the velocity.
    pub cip: CipProfile,
    /// `γ_p` of the interior penalty of the pressure.
    pub gamma_pressure: f64,
    /// `γ_g` of the ghost penalty.
    pub gamma_ghost: f64,
    /// Convection: `None` for Stokes, else whether to add the skew part.
    pub convection: Option<bool>,
    /// Force per volume.
    pub body_force: Option<TimeField<D>>,
    /// Velocity at the start; at rest if `None`.
    pub initial_velocity: Option<PointField<D>>,
    /// What holds on the tagged parts of the boundary; parts that are not listed are open.
    pub boundary: Vec<(Tag, FluidBoundary<D>)>,
}

/// A condition on a part of the background's boundary.
pub enum FluidBoundary<const D: usize> {
    /// `u = 0`.
    NoSlip,
    /// `u` given: moving walls, inflow profiles.
    Velocity(TimeField<D>),
    /// `u·n = 0` on a plane across the axis, with free tangential traction.
    Symmetry {
        /// Number of the axis, from 0.
        axis: usize,
    },
    /// Traction given (zero if `None`).
    Open {
        /// The traction `T^f n`.
        traction: Option<TractionField<D>>,
        /// Whether to stabilise inflow.
        backflow: bool,
    },
}

/// A body.
pub struct Body<const D: usize> {
    /// Name, for reports and files.
    pub name: String,
    /// What moves it.
    pub kind: BodyKind<D>,
}

/// What moves a body.
pub enum BodyKind<const D: usize> {
    /// Elasticity: its velocity is unknown.
    Elastic(Box<ElasticBody<D>>),
    /// Momentum alone: it does not deform.
    Rigid(Box<RigidBody<D>>),
    /// A given motion.
    Prescribed(PrescribedBody<D>),
}

/// An elastic body.
pub struct ElasticBody<const D: usize> {
    /// Mesh in the reference configuration.
    pub solid: SolidMesh<D>,
    /// Material, inertia, body force.
    pub form: SolidForm<D>,
    /// How it is advanced in time; the fluid is always advanced by implicit Euler.
    pub scheme: TimeScheme,
    /// What holds it.
    pub supports: Vec<BodySupport<D>>,
    /// Loads on facets of its boundary.
    pub loads: Vec<(Vec<FacetId>, Arc<dyn FacetTerm<D>>)>,
    /// Displacement at the start; none if `None`.
    pub initial_displacement: Option<PointField<D>>,
    /// Velocity at the start; at rest if `None`.
    pub initial_velocity: Option<PointField<D>>,
}

/// A support of an elastic body.
pub struct BodySupport<const D: usize> {
    /// The vertices that it holds.
    pub vertices: Vec<VertexId>,
    /// How.
    pub kind: SupportKind<D>,
}

/// How a support holds.
pub enum SupportKind<const D: usize> {
    /// No motion.
    Clamped,
    /// No motion along an axis.
    Symmetry {
        /// Number of the axis, from 0.
        axis: usize,
    },
    /// Displacement components given at a reference point and time.
    #[allow(clippy::type_complexity)]
    Displacement(Arc<dyn Fn(&Point<D>, f64) -> [Option<f64>; D] + Send + Sync>),
}

/// A body that moves freely without deforming, advanced by implicit Euler.
pub struct RigidBody<const D: usize> {
    /// Its surface.
    pub boundary: BoundaryMesh<D>,
    /// Reference positions of the vertices of the surface.
    pub reference: Vec<Point<D>>,
    /// Mass, centre and moments.
    pub mass: MassProperties<D>,
    /// Acceleration of gravity.
    pub gravity: Vector<D>,
    /// Axes along which the centre is held.
    pub held_axes: [bool; D],
    /// Whether rotation is held.
    pub holds_rotation: bool,
    /// Velocity of the centre at the start.
    pub initial_velocity: Vector<D>,
    /// Spin at the start, rad/s.
    pub initial_spin: Spin,
}

impl<const D: usize> RigidBody<D> {
    /// A body at rest that nothing holds, of uniform density inside of its surface.
    ///
    /// # Errors
    /// [`solid_rigid::Error`]: density not positive, or a surface that encloses nothing.
    pub fn new(
        boundary: BoundaryMesh<D>,
        reference: Vec<Point<D>>,
        density: f64,
        gravity: Vector<D>,
    ) -> Result<Self, solid_rigid::Error> {
        let mass = MassProperties::of_surface(&Placed::new(&boundary, &reference), density)?;
        Ok(Self {
            boundary,
            reference,
            mass,
            gravity,
            held_axes: [false; D],
            holds_rotation: false,
            initial_velocity: Vector::zeros(),
            initial_spin: [0.0; 3],
        })
    }
}

/// A body with a given motion.
pub struct PrescribedBody<const D: usize> {
    /// Its surface.
    pub boundary: BoundaryMesh<D>,
    /// Reference positions of the vertices of the surface.
    pub reference: Vec<Point<D>>,
    /// Position at a time, from the reference position.
    pub position: TimeField<D>,
    /// Velocity of the surface.
    pub velocity: SurfaceVelocity<D>,
}

/// A contact of a body with an obstacle.
pub struct Contact<const D: usize> {
    /// The slave.
    pub body: BodyId,
    /// Facets of its boundary that may come into contact.
    pub facets: Vec<FacetId>,
    /// Law and contact size.
    pub form: ContactForm<D>,
    /// The obstacle.
    pub obstacle: ContactObstacle<D>,
}

/// An obstacle.
pub enum ContactObstacle<const D: usize> {
    /// One that does not move.
    Rigid(Box<dyn Obstacle<D>>),
    /// The boundary of another body.
    Body {
        /// The master.
        body: BodyId,
        /// Its surface.
        surface: DeformableObstacle<D>,
    },
}

impl<const D: usize> Contact<D> {
    /// Whether a body takes part.
    pub fn names(&self, body: usize) -> bool {
        let master = match &self.obstacle {
            ContactObstacle::Rigid(_) => None,
            ContactObstacle::Body { body, .. } => Some(*body),
        };
        self.body.index() == body || master.is_some_and(|master| master.index() == body)
    }
}

impl<const D: usize> ContactObstacle<D> {
    /// The geometry.
    pub fn geometry(&self) -> &dyn Obstacle<D> {
        match self {
            Self::Rigid(obstacle) => obstacle.as_ref(),
            Self::Body { surface, .. } => surface,
        }
    }
}

impl<const D: usize> Body<D> {
    /// The elastic body, if it is one.
    pub fn elastic(&self) -> Option<&ElasticBody<D>> {
        match &self.kind {
            BodyKind::Elastic(body) => Some(body),
            BodyKind::Rigid(_) | BodyKind::Prescribed(_) => None,
        }
    }

    /// The rigid body, if it is one.
    pub fn rigid(&self) -> Option<&RigidBody<D>> {
        match &self.kind {
            BodyKind::Rigid(body) => Some(body),
            BodyKind::Elastic(_) | BodyKind::Prescribed(_) => None,
        }
    }

    /// The surface.
    pub fn boundary(&self) -> &BoundaryMesh<D> {
        match &self.kind {
            BodyKind::Elastic(body) => body.solid.boundary(),
            BodyKind::Rigid(body) => &body.boundary,
            BodyKind::Prescribed(body) => &body.boundary,
        }
    }

    /// Reference positions of the vertices.
    pub fn reference(&self) -> &[Point<D>] {
        match &self.kind {
            BodyKind::Elastic(body) => body.solid.mesh().vertices(),
            BodyKind::Rigid(body) => &body.reference,
            BodyKind::Prescribed(body) => &body.reference,
        }
    }
}

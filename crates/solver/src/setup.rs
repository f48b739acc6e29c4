//! The coupled problem: data that are constant in time.

use std::collections::BTreeSet;
use std::sync::Arc;

use algebra::NewtonSettings;
use algebra::time::TimeScheme;
use body::{Body, BodyState, PointField, TimeField};
use contact::{ContactForm, DeformableObstacle, Obstacle, OwnSurface, Positions, check_pair};
use cutcell::OverlayOptions;
use fluid_ns::NewtonianFluid;
use mesh::{BodyId, BoundaryMesh, FacetId, Placed, Point, SimplexMesh, Tag, Vector, VertexId, unit_vector};

use crate::{Error, Stabilisation};

/// Traction, force per area, as a function of the point, the outward normal and the time.
pub type TractionField<const D: usize> = Arc<dyn Fn(&Point<D>, &Vector<D>, f64) -> Vector<D> + Send + Sync>;

/// A coupled problem: fluid, bodies, contacts and parameters.
pub struct Setup<const D: usize> {
    /// The fluid; `None` for bodies in vacuum.
    pub fluid: Option<FluidSetup<D>>,
    /// The bodies, in the order of the overlay.
    pub bodies: Vec<Arc<dyn Body<D>>>,
    /// The contacts.
    pub contacts: Vec<Contact<D>>,
    /// Time scheme of all fields.
    pub scheme: Arc<dyn TimeScheme>,
    /// Time step.
    pub dt: f64,
    /// Number of times that a failing step may be halved (see [`crate::TimeLoop::run`]). Zero: the first failure is
    /// final.
    pub most_halvings: usize,
    /// Steps whose length follows the gaps of contacts; `None` for steps of one length.
    pub approach: Option<ApproachSteps>,
    /// Newton's method.
    pub newton: NewtonSettings,
}

/// Steps that become shorter as the bodies of a contact approach, and longer again as they part.
///
/// The force of a film depends on its thickness, so that a step must be shorter than the time in which the gap would
/// close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApproachSteps {
    /// Largest motion of the bodies of a contact in a substep, relative to the gap between them.
    pub fraction: f64,
    /// Smallest length of a substep, a time.
    pub smallest: f64,
}

/// The fluid with its background mesh, stabilisation and boundary conditions.
pub struct FluidSetup<const D: usize> {
    /// The background mesh.
    pub background: SimplexMesh<D>,
    /// The overlay of the bodies.
    pub overlay: OverlayOptions,
    /// Density and viscosity.
    pub material: NewtonianFluid,
    /// Stabilisation of fluid and interface.
    pub stabilisation: Stabilisation,
    /// Films thinner than a few cells; `None` if their flux is not modelled.
    pub film: Option<FilmSetup>,
    /// Weight `α` of the fluid's traction in the mortar, from 0 to 1; the traction of elastic bodies has the weight
    /// `1 - α`. The mortar is stable for `α = 1`; smaller weights need a penalty that grows with stiffness and step
    /// ([`Error::UnstableShare`]).
    pub alpha: f64,
    /// Form of the convective term; `None` for Stokes flow.
    pub convection: Option<ConvectionForm>,
    /// Force per volume.
    pub body_force: Option<TimeField<D>>,
    /// Velocity at the start; zero if `None`.
    pub initial_velocity: Option<PointField<D>>,
    /// Conditions on the tagged parts of the boundary; parts that are not listed are open.
    pub boundary: Vec<(Tag, FluidBoundary<D>)>,
}

/// Form of the convective term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConvectionForm {
    /// `ρ (u·∇u, v)`.
    Standard,
    /// `ρ (u·∇u, v) + ρ/2 (∇·u, u·v)`.
    Skew,
}

impl<const D: usize> FluidSetup<D> {
    /// Creates a fluid at rest without forces, films and conditions on the boundary, with convection and the standard
    /// stabilisation.
    pub fn new(background: SimplexMesh<D>, material: NewtonianFluid) -> Self {
        Self {
            background,
            overlay: OverlayOptions::new(),
            material,
            stabilisation: Stabilisation::STANDARD,
            film: None,
            alpha: 1.0,
            convection: Some(ConvectionForm::Standard),
            body_force: None,
            initial_velocity: None,
            boundary: Vec::new(),
        }
    }
}

/// Films between bodies, and between bodies and walls, that are thinner than a few cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmSetup {
    /// Height of the asperities of two opposite surfaces together, a length. A thinner film has the conductance of this
    /// thickness, or of the extent of its cell across the film if that is less.
    pub roughness: f64,
    /// Lowest pressure in films, at which vapour appears; `None` if pressures are not bounded.
    pub floor: Option<f64>,
}

/// A condition on a part of the background's boundary.
pub enum FluidBoundary<const D: usize> {
    /// `u = 0`.
    NoSlip,
    /// `u` given: moving walls, inflow profiles.
    Velocity(TimeField<D>),
    /// `u·n = 0` on a plane, with free tangential traction.
    Symmetry {
        /// Unit normal of the plane, of either sign.
        normal: Vector<D>,
    },
    /// Flow through a plane along its normal, with the normal traction given.
    Parallel {
        /// Unit normal of the plane, of either sign.
        normal: Vector<D>,
        /// The traction `T^f n`, of which only the normal part acts (zero if `None`).
        traction: Option<TractionField<D>>,
    },
    /// Traction given (zero if `None`).
    Open {
        /// The traction `T^f n`.
        traction: Option<TractionField<D>>,
        /// Whether to stabilise inflow.
        backflow: bool,
    },
}

impl<const D: usize> FluidBoundary<D> {
    /// Creates the symmetry on a plane across an axis with an index from 0 to `D - 1`.
    pub fn symmetry(axis: usize) -> Self {
        Self::Symmetry { normal: unit_vector(axis) }
    }

    /// Creates the flow along an axis with an index from 0 to `D - 1`, without traction.
    pub fn parallel(axis: usize) -> Self {
        Self::Parallel { normal: unit_vector(axis), traction: None }
    }

    /// Returns the traction, if one is given.
    pub fn traction(&self) -> Option<&TractionField<D>> {
        match self {
            Self::Open { traction, .. } | Self::Parallel { traction, .. } => traction.as_ref(),
            Self::NoSlip | Self::Velocity(_) | Self::Symmetry { .. } => None,
        }
    }

    /// Returns whether fluid may cross the part without a given velocity.
    pub fn is_open(&self) -> bool {
        matches!(self, Self::Open { .. } | Self::Parallel { .. })
    }

    /// Returns the directions without flow if others are free: the normal of a plane of symmetry, or `D - 1` directions
    /// along the plane of a parallel flow.
    pub(crate) fn without_flow(&self) -> Vec<Vector<D>> {
        match self {
            Self::Symmetry { normal } => vec![*normal],
            Self::Parallel { normal, .. } => {
                let across = (0..D).filter(|axis| *axis != normal.iamax());
                across.map(|axis| unit_vector(axis) - normal * normal[axis]).collect()
            }
            Self::NoSlip | Self::Velocity(_) | Self::Open { .. } => Vec::new(),
        }
    }
}

impl<const D: usize> FluidSetup<D> {
    /// Returns the condition on the parts of the boundary with a tag.
    pub(crate) fn condition(&self, tag: Option<Tag>) -> Option<&FluidBoundary<D>> {
        self.boundary.iter().find(|(other, _)| Some(*other) == tag).map(|(_, condition)| condition)
    }

    /// Returns whether fluid may cross the parts of the boundary with a tag.
    pub(crate) fn is_open(&self, tag: Option<Tag>) -> bool {
        self.condition(tag).is_none_or(FluidBoundary::is_open)
    }

    /// Returns whether the parts of the boundary with a tag are walls, between which and bodies films form.
    pub(crate) fn is_wall(&self, tag: Option<Tag>) -> bool {
        matches!(self.condition(tag), Some(FluidBoundary::NoSlip | FluidBoundary::Velocity(_)))
    }

    /// Checks that each condition is on sides of the background, and the only one there.
    fn check_sides(&self) -> Result<(), Error> {
        let mut seen = BTreeSet::new();
        let known: BTreeSet<_> =
            self.background.facets().filter_map(|facet| self.background.facet_tag(facet)).collect();
        for (condition, (tag, _)) in self.boundary.iter().enumerate() {
            if !known.contains(tag) {
                return Err(Error::UnknownSide { condition });
            }
            if !seen.insert(tag) {
                return Err(Error::RepeatedCondition { side: self.background.tag_names()[tag.index()].clone() });
            }
        }
        Ok(())
    }

    /// Checks that sides on the axis of axisymmetric coordinates are planes of symmetry.
    fn check_axis(&self) -> Result<(), Error> {
        let Some(radial) = self.background.coordinates().radial() else { return Ok(()) };
        let on_axis = |facet: &FacetId| {
            let vertices = self.background.facet(*facet);
            self.background.is_boundary(*facet) && vertices.iter().all(|v| self.background.vertex(*v)[radial] == 0.0)
        };
        let is_symmetry = |facet: FacetId| {
            let condition = self.condition(self.background.facet_tag(facet));
            matches!(condition, Some(FluidBoundary::Symmetry { normal }) if normal[radial].abs() == 1.0)
        };
        if self.background.facets().filter(on_axis).all(is_symmetry) { Ok(()) } else { Err(Error::Axis) }
    }
}

/// A contact of a body with an obstacle.
pub struct Contact<const D: usize> {
    body: BodyId,
    facets: Vec<FacetId>,
    form: ContactForm<D>,
    obstacle: ContactObstacle<D>,
}

/// An obstacle.
pub enum ContactObstacle<const D: usize> {
    /// An obstacle that does not move.
    Rigid(Box<dyn Obstacle<D>>),
    /// The boundary of another body.
    Body {
        /// The master.
        body: BodyId,
        /// Its surface.
        surface: DeformableObstacle<D>,
    },
    /// The boundary of the slave itself.
    Own(OwnSurface<D>),
}

impl<const D: usize> Contact<D> {
    /// Creates the contact of a body, the slave, with an obstacle. `facets` are those of its boundary that may come
    /// into contact.
    ///
    /// # Errors
    /// [`contact::Error`]: a facet or a body that does not exist, a body that is its own obstacle without
    /// [`ContactObstacle::Own`], or an obstacle that is not the surface of its body.
    pub fn new(
        bodies: &[Arc<dyn Body<D>>],
        body: BodyId,
        facets: Vec<FacetId>,
        form: ContactForm<D>,
        obstacle: ContactObstacle<D>,
    ) -> Result<Self, contact::Error> {
        let contact = Self { body, facets, form, obstacle };
        contact.check(bodies)?;
        Ok(contact)
    }

    /// Checks that facets and obstacle belong to the bodies.
    fn check(&self, bodies: &[Arc<dyn Body<D>>]) -> Result<(), contact::Error> {
        let n_bodies = bodies.len();
        let find = |id: BodyId| bodies.get(id.index()).ok_or(contact::Error::UnknownBody { body: id, n_bodies });
        let slave = find(self.body)?;
        let master = self.master().map(find).transpose()?;
        if matches!(self.obstacle, ContactObstacle::Body { body, .. } if body == self.body) {
            return Err(contact::Error::SelfContact);
        }
        check_pair(slave.surface(), &self.facets, self.obstacle(), master.map(|master| master.surface()))
    }

    /// Returns the slave.
    pub fn body(&self) -> BodyId {
        self.body
    }

    /// Returns the body of a deformable obstacle, which may be the slave itself; `None` for a rigid obstacle.
    pub fn master(&self) -> Option<BodyId> {
        match &self.obstacle {
            ContactObstacle::Rigid(_) => None,
            ContactObstacle::Body { body, .. } => Some(*body),
            ContactObstacle::Own(_) => Some(self.body),
        }
    }

    /// Returns the facets of the slave that may come into contact.
    pub fn facets(&self) -> &[FacetId] {
        &self.facets
    }

    /// Returns the smallest gap of the slave's nodes that may come into contact. `slave` and `master` are positions of
    /// all nodes of the bodies. With a master at rest, nodes of the slave without a velocity, such as clamped ones, are
    /// left out; the gap is infinite if all are. Returns `None` for contact of a body with itself.
    pub(crate) fn smallest_gap(
        &self,
        surface: &BoundaryMesh<D>,
        [slave, master]: [&[Point<D>]; 2],
        speed_of: impl Fn(VertexId) -> f64,
        master_speed: f64,
    ) -> Option<f64> {
        let mut nodes: Vec<VertexId> = self.facets.iter().flat_map(|facet| surface.nodes(*facet)).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.retain(|node| master_speed > 0.0 || speed_of(*node) > 0.0);
        let points: Vec<_> = nodes.iter().map(|node| slave[node.index()]).collect();
        if points.is_empty() {
            return Some(f64::INFINITY);
        }
        self.obstacle().smallest_gap(&points, Positions::Fixed(master))
    }

    /// Returns the law, contact size and quadrature.
    pub fn form(&self) -> &ContactForm<D> {
        &self.form
    }

    /// Returns the obstacle.
    pub fn obstacle(&self) -> &dyn Obstacle<D> {
        match &self.obstacle {
            ContactObstacle::Rigid(obstacle) => obstacle.as_ref(),
            ContactObstacle::Body { surface, .. } => surface,
            ContactObstacle::Own(surface) => surface,
        }
    }
}

impl<const D: usize> Setup<D> {
    /// Checks the numbers of the setup, and that its parts fit together. [`crate::State::initial`] calls it.
    ///
    /// # Errors
    /// [`Error::Parameter`]: a time step, weight, roughness, mass or normal out of its range.
    /// [`Error::UnknownSide`] and [`Error::RepeatedCondition`]: a condition on no side, or two on one.
    /// [`Error::Axis`]: a side on the axis of rotation without symmetry. [`Error::Coordinates`]: a body in other
    /// coordinates than the background. [`Error::Contact`]: a contact that was made for other bodies.
    pub fn check(&self) -> Result<(), Error> {
        mesh::positive("time step", self.dt)?;
        if let Some(ApproachSteps { fraction, smallest }) = self.approach {
            mesh::positive("fraction of the gap in a step", fraction)?;
            mesh::positive("smallest step", smallest)?;
        }
        if let Some(fluid) = &self.fluid {
            let NewtonianFluid { density, viscosity } = fluid.material;
            mesh::require(density >= 0.0 && density.is_finite(), "density of the fluid", density, "zero or positive")?;
            mesh::positive("viscosity", viscosity)?;
            if let Some(time) = fluid.stabilisation.time {
                mesh::positive("time of the stabilisation", time)?;
            }
            mesh::require((0.0..=1.0).contains(&fluid.alpha), "weight alpha", fluid.alpha, "from 0 to 1")?;
            let roughness = fluid.film.map_or(0.0, |film| film.roughness);
            mesh::require(roughness >= 0.0 && roughness.is_finite(), "roughness", roughness, "zero or positive")?;
        }
        for (_, condition) in self.fluid.iter().flat_map(|fluid| &fluid.boundary) {
            if let FluidBoundary::Symmetry { normal } | FluidBoundary::Parallel { normal, .. } = condition {
                let (length, is_unit) = (normal.norm(), (normal.norm() - 1.0).abs() < 1e-9);
                mesh::require(is_unit, "length of the normal of a symmetry or flow", length, "one")?;
            }
        }
        if let Some(fluid) = &self.fluid {
            fluid.check_sides()?;
            fluid.check_axis()?;
            let coordinates = fluid.background.coordinates();
            if let Some(body) = self.bodies.iter().find(|body| body.surface().coordinates() != coordinates) {
                return Err(Error::Coordinates { body: body.name().to_owned() });
            }
        }
        for body in &self.bodies {
            if let Some(balance) = body.balance(&body.initial()) {
                mesh::positive("mass of a body", balance.mass)?;
            }
        }
        for (index, contact) in self.contacts.iter().enumerate() {
            contact.check(&self.bodies).map_err(|source| Error::Contact { contact: index, source })?;
        }
        Ok(())
    }

    /// Returns the positions of the vertices of each body in the given states.
    pub fn positions(&self, states: &[BodyState<D>]) -> Vec<Vec<Point<D>>> {
        self.bodies.iter().zip(states).map(|(body, state)| state.positions(body.reference())).collect()
    }

    /// Returns the surfaces of the bodies at the given positions.
    pub fn surfaces<'a>(&'a self, positions: &'a [Vec<Point<D>>]) -> Vec<Placed<'a, D>> {
        self.bodies.iter().zip(positions).map(|(body, x)| Placed::new(body.surface(), x)).collect()
    }
}

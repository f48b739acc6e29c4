//! Contacts and obstacles of a scenario.

use std::sync::Arc;

use contact::{
    AugmentedLagrangianLaw, CollisionLaw, ContactForm, DeformableObstacle, NitscheLaw, Obstacle, OwnSurface,
    PenaltyLaw, RigidBall, RigidPlane, RigidSurface,
};
use mesh::{BodyId, BoundaryMesh, FacetId, Placed, Point, Tag};
use solver::body::{Body, TimeField};
use solver::{Contact, ContactObstacle, FluidBoundary, FluidSetup};

use super::body::Built;
use super::condition::sampled;
use super::error::{ErrorKind, ScenarioError, sorted};
use super::geometry::{Geometry, Shape, ZERO_VECTOR};
use super::key::{Quantity, missing};
use super::table::{At, Components, choices, keys};

keys! {
    /// Contact between bodies, or of a body with an obstacle: `pairs`, or `pair`, or `body` and `obstacle`.
    pub struct ContactKeys {
        /// Every two bodies that can meet, and every body that deforms with itself. In each pair the slave is the movable
        /// body, elastic or free. Of two such bodies it is the elastic one if `law` is `nitsche`, then the one with the
        /// smaller facets, else the first one.
        pairs: Option<At<Pairs>> [group(0)],
        /// Names of two bodies, or twice that of a body in contact with itself; the slave is chosen as for `pairs`.
        pair: Option<At<Vec<At<String>>>> [group(1)],
        /// Name of the slave; `all` for every movable body.
        body: Option<At<String>> [group(2)],
        /// The obstacle of `body`.
        obstacle: Option<At<ObstacleChoice>> [group(2)],
        /// Contact law.
        law: ContactLawChoice,
        /// Contact size `s`: the laws `penalty` and `augmented-lagrangian` divide by it. Obstacles are searched within a
        /// distance that is the sum of the offset, twice this length and twice the motion of both bodies in the step,
        /// at their largest speeds at its start.
        size: f64 [unit(Quantity::LENGTH), positive],
        /// Offset `ε`: contact begins at this distance.
        offset: f64 [unit(Quantity::LENGTH), non_negative],
    }
}

impl ContactKeys {
    /// Returns whether the obstacle is a body.
    pub fn is_between_bodies(&self) -> bool {
        let of_body = |obstacle: &ObstacleChoice| matches!(obstacle, ObstacleChoice::Body { .. });
        self.pairs.is_some() || self.pair.is_some() || self.obstacle.as_deref().is_some_and(of_body)
    }
}

choices! {
    /// Pairs of bodies.
    pub enum Pairs {
        /// All of them.
        All = "all",
    }
}

choices! {
    /// Contact law.
    pub enum ContactLawChoice ["kind"] {
        /// Pressure `γ_C0/s [ε - Δ]₊` at the distance `Δ`. Without friction: that is a key of `nitsche` and
        /// `augmented-lagrangian`.
        Penalty = "penalty" {
            /// Penalty parameter `γ_C0`.
            gamma_contact_0: f64 [unit(Quantity::PRESSURE), positive],
        },
        /// Augmented Lagrangian: the step is solved again, with the tractions of its last solve as multipliers, until
        /// bodies in contact have the distance `ε`, without the error of a penalty. For bodies that do not deform; those
        /// that deform have `nitsche`, which needs one solve.
        AugmentedLagrangian = "augmented-lagrangian" {
            /// Parameter `γ_C0`. Results do not depend on it if the solves of a step settle. Begin with a hundred times
            /// `size` times the mass over the area of a facet over the square of the step. With friction much more is
            /// too large.
            gamma_contact_0: f64 [unit(Quantity::PRESSURE), positive],
            /// Coefficient of Coulomb friction: the tangential traction is at most this number times the pressure.
            friction: f64 [non_negative] = 0.0,
            /// Largest error of the distance between bodies in contact, relative to `size`; with friction also that of
            /// tractions, relative to the largest one.
            tolerance: f64 [positive] = 1e-6,
        },
        /// Collision of bodies that do not deform. If the gap is below the offset, which is the roughness of the
        /// surfaces, the velocity of approach is reversed in one step, for bodies and fluid together.
        Collision = "collision" {
            /// Restitution of a collision without fluid.
            restitution: f64 [between(0.0, 1.0)],
        },
        /// Nitsche's method: pressure `[γ_C (ε - Δ) - s_n]₊`, with the normal stress `s_n` of the slave minus that of
        /// the fluid, and `γ_C = γ_0 (2 μ + λ)/h` of the slave's cell of height `h`. Bodies in contact have the
        /// distance `ε`, without the error of a penalty. The slave is elastic.
        Nitsche = "nitsche" {
            /// Number `γ_0`. It must be above 2 in 2D and 3 in 3D, times the number of facets of a cell that
            /// lie on the surface. Larger numbers hardly change results.
            gamma_0: f64 [positive] = 10.0,
            /// Coefficient of Coulomb friction: the tangential traction is at most this number times the pressure.
            friction: f64 [non_negative] = 0.0,
        },
    }
}

choices! {
    /// Obstacle of a contact.
    pub enum ObstacleChoice ["kind"] {
        /// Plane at rest.
        RigidPlane = "rigid-plane" {
            /// A point on the plane.
            point: Components<f64> [unit(Quantity::LENGTH)],
            /// Normal of the plane, into the obstacle.
            normal: At<Components<f64>>,
        },
        /// Disk or ball at rest.
        Ball = "ball" {
            /// Centre.
            centre: Components<f64> [unit(Quantity::LENGTH)],
            /// Radius.
            radius: f64 [unit(Quantity::LENGTH), positive],
            /// Whether the outside is the obstacle, a round container.
            hollow: bool = false,
        },
        /// Surface of a shape at rest.
        Shape = "shape" {
            /// Shape.
            shape: At<Shape>,
            /// Whether the outside is the obstacle, a container.
            hollow: bool = false,
        },
        /// Parts of the boundary of the background.
        Wall = "wall" {
            /// Names of the parts.
            parts: At<Vec<At<String>>>,
        },
        /// Another body, or the slave itself.
        Body = "body" {
            /// Name of the body; copies have names of their own.
            name: At<String>,
        },
    }
}

impl ContactLawChoice {
    /// Returns the coefficient of friction.
    fn friction(&self) -> f64 {
        match *self {
            Self::AugmentedLagrangian { friction, .. } | Self::Nitsche { friction, .. } => friction,
            Self::Penalty { .. } | Self::Collision { .. } => 0.0,
        }
    }
}

/// Relative difference of sizes that is round-off.
const ROUND_OFF: f64 = 1e-9;

/// Word for all bodies.
pub(super) const ALL: &str = "all";

/// Builder of contacts. Bodies are in the order of their tables.
pub(super) struct ContactBuilder<'p, const D: usize> {
    built: &'p [Built<D>],
    bodies: Vec<Arc<dyn Body<D>>>,
    /// Mean measure of the facets of each body.
    mean_facets: Vec<f64>,
    fluid: Option<&'p FluidSetup<D>>,
    /// End of the run.
    end: f64,
}

impl<'p, const D: usize> ContactBuilder<'p, D> {
    pub(super) fn new(built: &'p [Built<D>], fluid: Option<&'p FluidSetup<D>>, end: f64) -> Self {
        let bodies: Vec<_> = built.iter().map(|built| Arc::clone(&built.body)).collect();
        let mean_facets = bodies.iter().map(|body| mean_facet(body.surface(), body.reference())).collect();
        Self { built, bodies, mean_facets, fluid, end }
    }

    /// Builds the contacts of a table.
    ///
    /// # Errors
    /// Names that do not exist, obstacles that cannot be built, and pairs of which neither can move.
    pub(super) fn contacts(&self, given: &At<ContactKeys>) -> Result<Vec<Contact<D>>, ScenarioError> {
        let has_pairs = given.pairs.is_some() || given.pair.is_some();
        if let (true, None, Some(obstacle)) = (has_pairs, &given.body, &given.obstacle) {
            let cause = "`pairs` or `pair`: contact with an obstacle needs a table of its own with `body`; here";
            return Err(obstacle.at.error(ErrorKind::NoEffect(cause)));
        }
        match (&given.pairs, &given.pair, &given.body) {
            (Some(_), None, None) => self.all_pairs(given),
            (None, Some(names), None) => Ok(vec![self.single_pair(given, names)?]),
            (None, None, Some(name)) => {
                let absent = || missing(&given.at, ContactKeys::KEYS, "obstacle");
                let obstacle = given.obstacle.as_ref().ok_or_else(absent)?;
                let slaves = if **name == ALL { self.movable().collect() } else { vec![self.find(name)?] };
                slaves.into_iter().map(|slave| self.with_obstacle(given, slave, obstacle)).collect()
            }
            (None, None, None) if given.obstacle.is_some() => Err(missing(&given.at, ContactKeys::KEYS, "body")),
            (None, None, None) => Err(given.at.invalid(
                "no bodies are named; add `pairs = \"all\"`, `pair = [\"NAME\", \"NAME\"]`, or `body` and `obstacle`",
            )),
            _ => Err(given.at.invalid("give one of pairs, pair, and body with its obstacle")),
        }
    }

    fn all_pairs(&self, given: &At<ContactKeys>) -> Result<Vec<Contact<D>>, ScenarioError> {
        let ids = || (0..self.bodies.len()).map(BodyId::new);
        let pairs = ids().flat_map(|a| ids().filter(move |b| *b >= a).map(move |b| [a, b]));
        let can_meet = |&[a, b]: &[BodyId; 2]| {
            if a == b { self.deforms(a) } else { self.can_move(a) || self.can_move(b) }
        };
        let pairs: Vec<_> = pairs.filter(can_meet).collect();
        if pairs.is_empty() {
            return Err(given.at.invalid(
                "`pairs = \"all\"` has no pair of bodies of which one can move, and no body that deforms; add a body, or contact with an obstacle by `body` and \
                 `obstacle`",
            ));
        }
        pairs.into_iter().map(|pair| self.between(given, self.in_order(given, pair))).collect()
    }

    fn single_pair(&self, given: &At<ContactKeys>, names: &At<Vec<At<String>>>) -> Result<Contact<D>, ScenarioError> {
        let [a, b] = &names[..] else {
            return Err(names.at.invalid(format!("this has {} names, but a pair has two", names.len())));
        };
        let pair = [self.find(a)?, self.find(b)?];
        self.check_motion(pair, b)?;
        self.between(given, self.in_order(given, pair))
    }

    fn with_obstacle(
        &self,
        given: &At<ContactKeys>,
        slave: BodyId,
        obstacle: &At<ObstacleChoice>,
    ) -> Result<Contact<D>, ScenarioError> {
        let fail = |error: contact::Error| obstacle.at.error(error);
        let turned = |surface: BoundaryMesh<D>, hollow: bool| if hollow { surface.reversed() } else { surface };
        let geometry: Box<dyn Obstacle<D>> = match &**obstacle {
            ObstacleChoice::Body { name } => {
                let master = self.find(name)?;
                self.check_motion([slave, master], name)?;
                return self.between(given, [slave, master]);
            }
            _ if !self.can_move(slave) => {
                return Err(self.immovable(
                    obstacle,
                    slave,
                    "the body has a given motion, or all of its motions are held, and the obstacle is at rest",
                ));
            }
            ObstacleChoice::RigidPlane { point, normal } => {
                let direction = normal.vector::<D>().try_normalize(0.0);
                let direction = direction.ok_or_else(|| normal.at.invalid(ZERO_VECTOR))?;
                Box::new(RigidPlane::new(point.vector(), direction).map_err(fail)?)
            }
            ObstacleChoice::Ball { centre, radius, hollow } => {
                let create = if *hollow { RigidBall::hollow } else { RigidBall::new };
                Box::new(create(centre.vector(), *radius).map_err(fail)?)
            }
            ObstacleChoice::Shape { shape, hollow } => {
                let (surface, positions) = Geometry::new(shape)?.into_surface();
                let facets = surface.facets().collect();
                Box::new(RigidSurface::new(turned(surface, *hollow), facets, positions).map_err(fail)?)
            }
            ObstacleChoice::Wall { parts } => {
                let missing =
                    || obstacle.at.invalid("a wall is a part of the background, and there is none; add [background]");
                let fluid = self.fluid;
                let background = fluid.map(|fluid| &fluid.background).ok_or_else(missing)?;
                let boundary = background.boundary();
                let mut facets = Vec::new();
                for name in &**parts {
                    let known = background.boundary_names();
                    let tag = background.tag(name).filter(|_| known.contains(&name.as_str()));
                    let tag = tag.ok_or_else(|| name.at.unknown("part of the background", name, sorted(known)))?;
                    facets.extend(boundary.facets().filter(|facet| boundary.tag(*facet) == Some(tag)));
                    if given.law.friction() > 0.0 && fluid.is_some_and(|fluid| slides(fluid, tag, self.end)) {
                        return Err(name.at.invalid(format!(
                            "side `{}` has a velocity along itself, and a wall is an obstacle at rest, along which friction would hold the body; let a body with a given motion \
                             take its place, or set `friction` to zero",
                            name.as_str()
                        )));
                    }
                }
                if facets.is_empty() {
                    return Err(parts.at.invalid("no part is named; name at least one part of the background"));
                }
                Box::new(RigidSurface::new(boundary.reversed(), facets, background.vertices().to_vec()).map_err(fail)?)
            }
        };
        self.contact(given, slave, ContactObstacle::Rigid(geometry))
    }

    /// Returns the contact of a slave with a master, which may be the slave.
    fn between(&self, given: &At<ContactKeys>, [slave, master]: [BodyId; 2]) -> Result<Contact<D>, ScenarioError> {
        let fail = |error: contact::Error| given.at.error(error);
        let (body, facets) = (&self.bodies[master.index()], self.free_facets(master));
        let boundary = body.surface().clone();
        let obstacle = if slave == master {
            let exempt = exempt(given);
            ContactObstacle::Own(OwnSurface::new(boundary, facets, body.reference().to_vec(), exempt).map_err(fail)?)
        } else {
            ContactObstacle::Body { body: master, surface: DeformableObstacle::new(boundary, facets).map_err(fail)? }
        };
        self.contact(given, slave, obstacle)
    }

    fn contact(
        &self,
        given: &At<ContactKeys>,
        slave: BodyId,
        obstacle: ContactObstacle<D>,
    ) -> Result<Contact<D>, ScenarioError> {
        let fail = |error: contact::Error| given.at.error(error);
        let master = if let ContactObstacle::Body { body, .. } = &obstacle { Some(*body) } else { None };
        let deforming = [Some(slave), master].into_iter().flatten().find(|body| self.deforms(*body));
        let form = match given.law {
            ContactLawChoice::Penalty { gamma_contact_0 } => {
                ContactForm::new(PenaltyLaw::new(gamma_contact_0, given.offset).map_err(fail)?, given.size)
            }
            ContactLawChoice::Collision { .. } if deforming.is_some() => {
                return Err(self.deforming(given, deforming.unwrap_or(slave), "collision"));
            }
            ContactLawChoice::AugmentedLagrangian { .. } if self.deforms(slave) => {
                return Err(self.deforming(given, slave, "augmented-lagrangian"));
            }
            ContactLawChoice::Collision { restitution } => {
                ContactForm::new(CollisionLaw::new(restitution, given.offset).map_err(fail)?, given.size)
            }
            ContactLawChoice::AugmentedLagrangian { gamma_contact_0, friction, tolerance } => {
                let law = AugmentedLagrangianLaw::new(gamma_contact_0, given.offset, friction, tolerance);
                ContactForm::new(law.map_err(fail)?, given.size)
            }
            ContactLawChoice::Nitsche { .. } if !self.deforms(slave) => {
                return Err(self.rigid(given, slave, "nitsche"));
            }
            ContactLawChoice::Nitsche { gamma_0, .. } if gamma_0 <= D as f64 => {
                return Err(given.at.invalid(format!(
                    "`gamma_0` is {gamma_0}, and must be above {D} in dimension {D}, times the number of facets of a cell that lie on the surface; leave it out for the default, 10"
                )));
            }
            ContactLawChoice::Nitsche { gamma_0, friction } => {
                ContactForm::new(NitscheLaw::new(gamma_0, given.offset, friction).map_err(fail)?, given.size)
            }
        };
        let form = form.map_err(fail)?;
        Contact::new(&self.bodies, slave, self.free_facets(slave), form, obstacle).map_err(fail)
    }

    /// Returns slave and master of a pair.
    fn in_order(&self, given: &ContactKeys, [a, b]: [BodyId; 2]) -> [BodyId; 2] {
        let needs_stress = matches!(given.law, ContactLawChoice::Nitsche { .. });
        match (self.deforms(a), self.deforms(b)) {
            (true, false) if needs_stress => return [a, b],
            (false, true) if needs_stress => return [b, a],
            _ => {}
        }
        // Sizes of copies of a body differ by round-off.
        let is_finer = self.mean_facets[b.index()] < (1.0 - ROUND_OFF) * self.mean_facets[a.index()];
        match (self.can_move(a), self.can_move(b)) {
            (false, true) => [b, a],
            (true, true) if is_finer => [b, a],
            _ => [a, b],
        }
    }

    /// Checks that one of two bodies can move, or that a body in contact with itself deforms.
    fn check_motion<T>(&self, [a, b]: [BodyId; 2], place: &At<T>) -> Result<(), ScenarioError> {
        if a == b && !self.deforms(a) {
            let name = self.bodies[a.index()].name();
            return Err(place.at.invalid(format!("body `{name}` does not deform, so that it cannot touch itself")));
        }
        if a != b && !self.can_move(a) && !self.can_move(b) {
            return Err(self.immovable(place, a, "both have a given motion"));
        }
        Ok(())
    }

    fn immovable<T>(&self, place: &At<T>, slave: BodyId, why: &str) -> ScenarioError {
        let name = self.bodies[slave.index()].name();
        place.at.invalid(format!(
            "neither `{name}` nor its obstacle can move: {why}; take the contact out, or make `{name}` elastic or free"
        ))
    }

    fn find(&self, name: &At<String>) -> Result<BodyId, ScenarioError> {
        let found = self.bodies.iter().position(|body| body.name() == name.as_str()).map(BodyId::new);
        found.ok_or_else(|| name.at.unknown("body", name, self.bodies.iter().map(|body| body.name())))
    }

    fn movable(&self) -> impl Iterator<Item = BodyId> {
        (0..self.bodies.len()).map(BodyId::new).filter(|body| self.can_move(*body))
    }

    fn can_move(&self, body: BodyId) -> bool {
        self.bodies[body.index()].is_movable()
    }

    fn deforms(&self, body: BodyId) -> bool {
        self.built[body.index()].body.deforms()
    }

    /// Returns the error of a law that does not allow a slave that deforms.
    fn deforming(&self, given: &At<ContactKeys>, slave: BodyId, law: &str) -> ScenarioError {
        let name = self.bodies[slave.index()].name();
        given.at.invalid(format!(
            "body `{name}` deforms, and the law `{law}` is for bodies that do not; use the law `nitsche` or `penalty`, or motion = {{ kind = \"free\" }}"
        ))
    }

    /// Returns the error of a law that needs the stress of the slave, for a slave that does not deform.
    fn rigid(&self, given: &At<ContactKeys>, slave: BodyId, law: &str) -> ScenarioError {
        let name = self.bodies[slave.index()].name();
        given.at.invalid(format!(
            "the law `{law}` depends on the stress of the slave, but body `{name}` is rigid; give the law `augmented-lagrangian`, or make the other body the slave if it is \
             elastic"
        ))
    }

    fn free_facets(&self, body: BodyId) -> Vec<FacetId> {
        self.built[body.index()].contact_facets.clone()
    }
}

/// Velocity of a side along itself that is round-off, relative to its speed.
const ALONG: f64 = 1e-9;

/// Returns whether a given velocity of a side is not normal to it, at the vertices and at some of the times up to `end`.
fn slides<const D: usize>(fluid: &FluidSetup<D>, side: Tag, end: f64) -> bool {
    let velocities = fluid.boundary.iter().filter(|(tag, _)| *tag == side);
    let surface = fluid.background.boundary();
    let placed = Placed::new(&surface, fluid.background.vertices());
    let is_along = |velocity: &TimeField<D>, facet: FacetId| {
        let normal = placed.facet_normal(facet);
        let points = surface.facet(facet).iter().map(|vertex| fluid.background.vertex(*vertex));
        points
            .flat_map(|x| sampled([0.0, end]).map(move |t| velocity(&x, t)))
            .any(|v| (v - normal * normal.dot(&v)).norm() > ALONG * v.norm())
    };
    velocities.filter_map(|(_, of)| if let FluidBoundary::Velocity(velocity) = of { Some(velocity) } else { None }).any(
        |velocity| {
            surface.facets().filter(|facet| surface.tag(*facet) == Some(side)).any(|facet| is_along(velocity, facet))
        },
    )
}

/// Returns the distance in the undeformed body up to which two parts of a surface are excluded from contact with each
/// other. Neighbours along the surface are within twice the size. With three offsets, the sides of a right-angled
/// corner touch only if it has closed to less than 30 degrees.
fn exempt(given: &ContactKeys) -> f64 {
    (given.offset + 2.0 * given.size).max(3.0 * given.offset)
}

/// Returns the mean measure of the facets of a surface.
fn mean_facet<const D: usize>(surface: &BoundaryMesh<D>, positions: &[Point<D>]) -> f64 {
    let placed = Placed::new(surface, positions);
    surface.facets().map(|facet| placed.facet_measure(facet)).sum::<f64>() / surface.n_facets() as f64
}

//! Elastic, free and prescribed bodies of a scenario.

use std::sync::Arc;

use mesh::{Aabb, BoundaryMesh, Coordinates, FacetId, Point, SimplexMesh, Vector, VertexId};
use solid_rigid::{RigidBody, Spin};
use solid_svk::supports::{facets_without_tags, tagged_facets};
use solid_svk::{
    ElasticBody, ElasticOptions, LameParameters, LinearElastic, Load, Material, NeoHookean, SaintVenantKirchhoff,
    SolidForm, SolidMesh, Support, SupportKind,
};
use solver::body::{Body, PointField, TimeField, VectorInTime};

use super::error::{ErrorKind, Location, ScenarioError, sorted};
use super::field::Field;
use super::formula::Formula;
use super::geometry::{Geometry, Shape, plane_normal};
use super::key::{Quantity, missing};
use super::motion::{AXIAL, GuideKeys, Held, MotionChoice, check_spin, finite, is_zero, prescribed};
use super::solver::{Time, TimeSchemeChoice};
use super::table::{At, Components, Named, choices, keys};

keys! {
    /// Body: elastic without a `motion`, rigid with one.
    pub struct BodyKeys {
        /// Name, for reports, columns and contacts: letters, digits, `-`, `_` and dots.
        name: At<String>,
        /// Shape.
        shape: At<Shape>,
        /// Shift of the shape from its place, and of the centre of a given rotation. Positions in formulas of the body are
        /// those before the shift.
        shift: Option<Components<f64>> [unit(Quantity::LENGTH)],
        /// Shifts of further bodies that are like this one otherwise, named `NAME-2`, `NAME-3` and so on.
        copies: Vec<Components<f64>> [unit(Quantity::LENGTH)],
        /// Motion of a body that does not deform; without one the body is elastic.
        motion: Option<At<MotionChoice>>,
        /// Order of the elements of an elastic body; 1 if left out. Elements of order 2 have nodes on their edges;
        /// those on the edge of a disk lie on its circle. Order 1 is far too stiff in bending with few elements through
        /// the thickness: a cantilever of two bends by about half of what it should. It is also too stiff if Poisson's ratio is near one half.
        /// Use order 2 for beams, plates and materials that hardly change their volume.
        order: Option<At<usize>> [between(1.0, 2.0)],
        /// Material of an elastic body.
        material: Option<At<MaterialChoice>>,
        /// Other materials and densities of groups of cells, by the names of the groups in the mesh file.
        groups: Named<GroupKeys>,
        /// Density of an elastic or free body.
        density: Option<At<f64>> [unit(Quantity::DENSITY), positive],
        /// Acceleration of gravity of an elastic or free body. In a container with the acceleration `a(t)` it is `g - a(t)`, and
        /// `fluid.body_force` is the density of the fluid times that. Only a constant one has a potential energy; the work of one
        /// that varies in time is that of a load.
        gravity: Option<At<Components<At<Formula>>>> [unit(Quantity::ACCELERATION)],
        /// Conditions on tagged parts of the surface of an elastic body; other parts are free.
        boundary: Option<At<Named<BodyCondition>>>,
        /// Displacement of an elastic body at the start; none if left out.
        initial_displacement: Option<Field> [unit(Quantity::LENGTH)],
        /// Mass of the nodes on those parts of the surface of an elastic body that may come into contact. Without mass there the pressure of contact does not oscillate in time. Masses
        /// of cells near these parts are lumped then. For elements of order 1.
        contact_mass: Option<At<ContactMass>>,
        /// Velocity of an elastic or free body at the start; at rest if left out. Clamped parts, and motion across planes of
        /// symmetry, begin at rest.
        initial_velocity: Option<Field> [unit(Quantity::VELOCITY)],
    }
}

keys! {
    /// Group of cells of an elastic body.
    pub struct GroupKeys {
        /// Material; that of the body if left out.
        material: Option<At<MaterialChoice>>,
        /// Density; that of the body if left out.
        density: Option<At<f64>> [unit(Quantity::DENSITY), positive],
    }
}

choices! {
    /// Mass of the nodes that may come into contact.
    pub enum ContactMass {
        /// That of the elements.
        Consistent = "consistent",
        /// None: it goes to nodes inside of the body.
        Redistributed = "redistributed",
    }
}

keys! {
    /// Parameters of an isotropic material.
    pub struct LameKeys {
        /// Shear modulus `μ`.
        mu: Option<f64> [unit(Quantity::PRESSURE), group(0)],
        /// First Lamé parameter `λ`.
        lambda: Option<f64> [unit(Quantity::PRESSURE), group(0)],
        /// Young's modulus.
        young: Option<f64> [unit(Quantity::PRESSURE), group(1)],
        /// Poisson's ratio.
        poisson: Option<f64> [group(1)],
    }
}

choices! {
    /// Material of an elastic body.
    pub enum MaterialChoice ["kind"] {
        /// `S = 2 μ E + λ tr(E) I`; with `mu` and `lambda`, or with `young` and `poisson`.
        SaintVenantKirchhoff(LameKeys) = "saint-venant-kirchhoff",
        /// `W = μ/2 (F:F - D) - μ ln J + λ/2 (ln J)²`; resists any compression. With `mu` and `lambda`, or with `young`
        /// and `poisson`.
        NeoHookean(LameKeys) = "neo-hookean",
        /// Hooke's law between stress and the linear strain, for small displacements and rotations. With `mu` and
        /// `lambda`, or with `young` and `poisson`.
        Linear(LameKeys) = "linear",
    }
}

choices! {
    /// Condition on a part of the surface of an elastic body.
    pub enum BodyCondition ["kind"] {
        /// No motion across a plane.
        Symmetry = "symmetry" {
            /// Normal of the plane; that of the facets if left out.
            normal: Option<Components<f64>>,
        },
        /// No motion.
        Clamped = "clamped",
        /// Given displacement.
        Displacement = "displacement" {
            /// Displacement.
            value: Field [unit(Quantity::LENGTH)],
        },
        /// Load that does not follow the motion.
        Traction = "traction" {
            /// Force per area of the undeformed surface.
            value: Field [unit(Quantity::PRESSURE)],
        },
    }
}

impl At<BodyKeys> {
    /// Returns the body and its copies.
    pub(super) fn with_copies(&self) -> impl Iterator<Item = Self> {
        let first = self.map(|body| BodyKeys { copies: Vec::new(), ..body.clone() });
        let copy = |(k, shift): (usize, &Components<f64>)| {
            let name = self.name.map(|name| format!("{name}-{}", k + 2));
            let shift = Some(self.shift.as_ref().map_or(shift.clone(), |own| own.plus(shift)));
            first.map(|body| BodyKeys { name, shift, ..body.clone() })
        };
        let copies: Vec<Self> = self.copies.iter().enumerate().map(copy).collect();
        std::iter::once(first).chain(copies)
    }
}

impl BodyKeys {
    /// Returns the conditions on parts of the surface, with the names of the parts.
    pub(crate) fn conditions(&self) -> impl Iterator<Item = (&str, &BodyCondition)> {
        self.boundary.iter().flat_map(|boundary| &boundary.0).map(|(name, condition)| (name.as_str(), &**condition))
    }

    /// Returns the shift of the shape.
    fn shift<const D: usize>(&self) -> Vector<D> {
        self.shift.as_ref().map_or(Vector::zeros(), Components::vector)
    }

    /// Returns the shape at its place.
    ///
    /// # Errors
    /// A shape that cannot be made; a shift so large that rounding destroys it.
    pub(super) fn geometry<const D: usize>(&self) -> Result<Geometry<D>, ScenarioError> {
        Geometry::new(&self.shape)?.shifted(self.shift()).map_err(|error| {
            self.shape.at.invalid(format!(
                "with its shift the shape loses its cells to rounding ({error}); make the shift smaller"
            ))
        })
    }

    /// Checks that the keys belong to the motion of the body.
    pub(super) fn check(&self) -> Result<(), ScenarioError> {
        fn place<T>(value: &Option<At<T>>) -> Option<&Location> {
            value.as_ref().map(|value| &value.at)
        }
        let (allowed, with): (&[&str], _) = match self.motion.as_deref() {
            None => return Ok(()),
            Some(MotionChoice::Free { .. }) => {
                (&["density", "gravity", "initial_velocity"], "a body that does not deform")
            }
            Some(_) => (&[], "a motion that is given"),
        };
        let given = [
            ("order", place(&self.order)),
            ("material", place(&self.material)),
            ("groups", self.groups.0.first().map(|(_, group)| &group.at)),
            ("density", place(&self.density)),
            ("gravity", place(&self.gravity)),
            ("boundary", place(&self.boundary)),
            ("contact_mass", place(&self.contact_mass)),
            ("initial_displacement", place(&self.initial_displacement)),
            ("initial_velocity", place(&self.initial_velocity)),
        ];
        let refused = given.iter().filter(|(key, _)| !allowed.contains(key)).find_map(|(_, place)| *place);
        refused.map_or(Ok(()), |place| Err(place.error(ErrorKind::NoEffect(with))))
    }
}

/// Returns the value of a required key of a body.
fn needed<'v, T>(body: &At<BodyKeys>, key: &'static str, value: &'v Option<At<T>>) -> Result<&'v At<T>, ScenarioError> {
    value.as_ref().ok_or_else(|| missing(&body.at, BodyKeys::KEYS, key))
}

/// Returns the constant gravity of a body, or zero and the gravity as a function of time.
///
/// # Errors
/// A value that is not finite at a step; a radial component in axisymmetric coordinates, whose sum over all angles has
/// no weight.
fn gravity<const D: usize>(
    given: &At<BodyKeys>,
    time: &Time,
    coordinates: Coordinates,
) -> Result<(Vector<D>, Option<VectorInTime<D>>), ScenarioError> {
    let axes = needed(given, "gravity", &given.gravity)?;
    if let Some(across) = coordinates.radial().and_then(|radial| axes.get(radial)).filter(|across| !is_zero(across)) {
        return Err(across
            .at
            .invalid("in axisymmetric coordinates gravity is along the axis, y; set its component x to zero"));
    }
    let is_constant = axes.iter().all(|axis| axis.is_constant());
    let axes = axes.iter().map(|axis| finite(axis, time)).collect::<Result<Vec<_>, _>>()?;
    let at = move |t| Vector::from_fn(|axis, _| axes[axis].at(&[], t).value);
    Ok(if is_constant { (at(0.0), None) } else { (Vector::zeros(), Some(Arc::new(at))) })
}

pub(super) fn body<const D: usize>(
    given: &At<BodyKeys>,
    time: &Time,
    coordinates: Coordinates,
) -> Result<Built<D>, ScenarioError> {
    let geometry = given.geometry()?;
    let part_names;
    let body: Arc<dyn Body<D>> = match (given.motion.as_ref(), geometry) {
        (None, geometry) => return elastic(given, geometry, time, coordinates),
        (Some(motion), geometry) => {
            part_names = geometry.part_names();
            let (boundary, reference) = geometry.into_surface();
            check_radii(given, &reference, coordinates)?;
            let boundary = boundary.with_coordinates(coordinates);
            match &**motion {
                MotionChoice::Free { held, initial_spin, guided } => {
                    check_free_axial::<D>(given, initial_spin.as_ref(), guided.as_ref(), coordinates)?;
                    let guide = guided.as_ref().map(|guided| guided.guide(time)).transpose()?;
                    check_guided(given, held, initial_spin.as_ref(), guided.as_ref())?;
                    initial_spin.as_ref().map_or(Ok(()), |spin| check_spin(spin, time))?;
                    let body = free(given, boundary, reference, held, initial_spin.as_ref(), time)?;
                    let initial_velocity = guide.as_ref().map_or(body.initial_velocity, |guide| (guide.velocity)(0.0));
                    Arc::new(RigidBody { guide, initial_velocity, ..body })
                }
                _ => {
                    let motion = motion.map(|motion| motion.shifted(given.shift.as_ref()));
                    Arc::new(prescribed(&given.name, &motion, time, boundary, reference)?)
                }
            }
        }
    };
    let contact_facets = body.surface().facets().filter(|facet| !on_axis(body.surface(), body.reference(), *facet));
    Ok(Built { contact_facets: contact_facets.collect(), part_names, body })
}

/// Checks that no vertex has a negative radius in axisymmetric coordinates.
fn check_radii<const D: usize>(
    given: &At<BodyKeys>,
    vertices: &[Point<D>],
    coordinates: Coordinates,
) -> Result<(), ScenarioError> {
    let Some(radial) = coordinates.radial() else { return Ok(()) };
    match vertices.iter().find(|x| x[radial] < 0.0) {
        None => Ok(()),
        Some(x) => Err(given.shape.at.invalid(format!(
            "in axisymmetric coordinates x is the radius, and this shape has a vertex at x = {:e}; move it to x >= 0, or use half of it, such as \
             kind = \"half-ball\"",
            x[radial]
        ))),
    }
}

/// Checks that a guided body has no other motion at the start, and is not held along an axis of the guide.
fn check_guided(
    given: &At<BodyKeys>,
    held: &[At<Held>],
    initial_spin: Option<&At<Spin>>,
    guided: Option<&GuideKeys>,
) -> Result<(), ScenarioError> {
    let Some(guided) = guided else { return Ok(()) };
    let moves = |held: &&At<Held>| {
        let velocity = (***held != Held::Rotation).then(|| guided.velocity.get(***held as usize)).flatten();
        velocity.is_some_and(|formula| !is_zero(formula))
    };
    let velocity = given.initial_velocity.as_ref().map(|velocity| velocity.at.clone());
    let other = velocity.or(initial_spin.filter(|spin| ***spin != [0.0; 3]).map(|spin| spin.at.clone()));
    if let Some(place) = other {
        let with = "a body that is guided, which begins with the velocity of its guide";
        return Err(place.error(ErrorKind::NoEffect(with)));
    }
    held.iter().find(moves).map_or(Ok(()), |held| {
        Err(held.at.invalid(
            "the guide moves the body along this axis; set this component of its velocity to zero, or do not hold it",
        ))
    })
}

/// Checks that a free rigid body does not start with, and is not guided along, a motion that axisymmetric coordinates
/// hold: along the radius, and rotation.
fn check_free_axial<const D: usize>(
    given: &At<BodyKeys>,
    initial_spin: Option<&At<Spin>>,
    guided: Option<&GuideKeys>,
    coordinates: Coordinates,
) -> Result<(), ScenarioError> {
    let Some(radial) = coordinates.radial() else { return Ok(()) };
    let along = given.initial_velocity.as_ref().map(|field| field.at.part(radial));
    let velocity = given.initial_velocity.as_ref().and_then(|field| field.constant::<D>()).zip(along);
    let velocity = velocity.filter(|(value, _)| value[radial] != 0.0).map(|(_, place)| place);
    let spin = initial_spin.filter(|spin| ***spin != [0.0; 3]).map(|spin| spin.at.clone());
    let guide = guided.and_then(|guide| guide.velocity.get(radial)).filter(|formula| !is_zero(formula));
    let found = velocity.or(spin).or_else(|| guide.map(|formula| formula.at.clone()));
    found.map_or(Ok(()), |place| Err(place.invalid(AXIAL)))
}

/// Returns whether a facet lies on the axis of axisymmetric coordinates. It is then not part of the surface.
fn on_axis<const D: usize>(surface: &BoundaryMesh<D>, positions: &[Point<D>], facet: FacetId) -> bool {
    let is_on = |radial: usize| surface.facet(facet).iter().all(|vertex| positions[vertex.index()][radial] == 0.0);
    surface.coordinates().radial().is_some_and(is_on)
}

/// A body, and the facets of its surface that may come into contact.
pub(super) struct Built<const D: usize> {
    pub(super) body: Arc<dyn Body<D>>,
    pub(super) contact_facets: Vec<FacetId>,
    /// Names of the tags of the surface.
    pub(super) part_names: Vec<String>,
}

fn elastic<const D: usize>(
    given: &At<BodyKeys>,
    geometry: Geometry<D>,
    time: &Time,
    coordinates: Coordinates,
) -> Result<Built<D>, ScenarioError> {
    let (mesh, nodes) = geometry.into_mesh(&given.shape)?;
    check_radii(given, mesh.vertices(), coordinates)?;
    let mesh = mesh.with_coordinates(coordinates).map_err(|error| given.shape.at.error(error))?;
    let group_of = groups(&given.groups, &mesh)?;
    let solid = match given.order.as_deref() {
        Some(2) => {
            if let Shape::Ball { area_preserving: true, .. } | Shape::HalfBall { area_preserving: true, .. } =
                *given.shape
            {
                return Err(given.shape.at.part("area_preserving").error(ErrorKind::NoEffect("elements of order 2")));
            }
            SolidMesh::curved(mesh, |ends, middle| nodes.get(&ends).copied().unwrap_or(middle))
        }
        _ => SolidMesh::new(mesh),
    };
    let solid = solid.and_then(|solid| solid.with_groups(group_of)).map_err(|error| given.shape.at.error(error))?;
    let material = needed(given, "material", &given.material)?;
    let density = needed(given, "density", &given.density)?;
    let (gravity, variable_gravity) = gravity(given, time, coordinates)?;
    let mut parts = vec![(**density, law(material)?)];
    for (_, group) in &given.groups.0 {
        let (density, material) =
            (group.density.as_ref().unwrap_or(density), group.material.as_ref().unwrap_or(material));
        parts.push((**density, law(material)?));
    }
    let form = SolidForm::of_groups(parts, gravity).map_err(|error| density.at.error(error))?;
    let (supports, loads) = match &given.boundary {
        Some(conditions) => supports_and_loads(given, conditions, &solid, time)?,
        None => Default::default(),
    };
    let at_start = |field: &Option<Field>| -> Result<Option<PointField<D>>, ScenarioError> {
        let Some(field) = field else { return Ok(None) };
        let field = field.before_shift(given.shift(), solid.nodes(), &[0.0])?;
        Ok(Some(Arc::new(move |x| field(x, 0.0))))
    };
    let options = ElasticOptions {
        supports,
        loads,
        variable_gravity,
        initial_displacement: at_start(&given.initial_displacement)?,
        initial_velocity: at_start(&given.initial_velocity)?,
    };
    if let (Some(given), Some(displacement)) = (&given.initial_displacement, &options.initial_displacement) {
        let displaced = solid.mesh().mapped(|x| x + displacement(x));
        displaced
            .map_err(|_| given.at.invalid("this displacement turns cells of the body inside out; make it smaller"))?;
    }
    let contact_facets = free_facets(given, &solid)?;
    let solid = match &given.contact_mass {
        Some(mass) if **mass == ContactMass::Redistributed => without_mass(mass, solid, &contact_facets)?,
        _ => solid,
    };
    let part_names = solid.mesh().tag_names().to_vec();
    let body = ElasticBody::new(&given.name, solid, form, options).map_err(|error| given.at.error(error))?;
    Ok(Built { body: Arc::new(body), contact_facets, part_names })
}

/// Returns the mesh of the body without mass at the vertices of facets.
fn without_mass<const D: usize>(
    given: &At<ContactMass>,
    solid: SolidMesh<D>,
    facets: &[FacetId],
) -> Result<SolidMesh<D>, ScenarioError> {
    let nodes: Vec<VertexId> = facets.iter().flat_map(|facet| solid.boundary().facet(*facet)).copied().collect();
    let (solid, keeps_moments) = solid.without_mass_at(&nodes).map_err(|error| given.at.error(error))?;
    let changed = "the mass of the surface cannot go to nodes inside without a change of the centre of mass; use a finer mesh, or leave `contact_mass` out";
    if keeps_moments { Ok(solid) } else { Err(given.at.invalid(changed)) }
}

/// Returns the facets that may come into contact: all except those on planes of symmetry and clamped facets.
fn free_facets<const D: usize>(given: &At<BodyKeys>, solid: &SolidMesh<D>) -> Result<Vec<FacetId>, ScenarioError> {
    let off_axis = |facet: &FacetId| !on_axis(solid.boundary(), solid.nodes(), *facet);
    let Some(boundary) = &given.boundary else { return Ok(solid.boundary().facets().filter(off_axis).collect()) };
    let is_held =
        |condition: &BodyCondition| matches!(condition, BodyCondition::Symmetry { .. } | BodyCondition::Clamped);
    let held = boundary.0.iter().filter(|(_, condition)| is_held(condition));
    let held: Vec<&str> = held.map(|(name, _)| name.as_str()).collect();
    let mut free = facets_without_tags(solid, &held).map_err(|error| boundary.at.error(error))?;
    free.retain(off_axis);
    Ok(free)
}

/// Returns the group of each cell: 0, or one more than the index of the given group with the cell.
fn groups<const D: usize>(given: &Named<GroupKeys>, mesh: &SimplexMesh<D>) -> Result<Vec<usize>, ScenarioError> {
    let names = mesh.group_names();
    let mut group_of = vec![0; mesh.n_cells()];
    for (k, (name, group)) in given.0.iter().enumerate() {
        if !names.contains(&name.as_str()) {
            return Err(group.at.unknown("group of cells", name, names));
        }
        let tag = mesh.tag(name);
        let of_group = mesh.cells().filter(|cell| mesh.cell_tag(*cell) == tag);
        of_group.for_each(|cell| group_of[cell.index()] = k + 1);
    }
    Ok(group_of)
}

/// Returns the parameters of a material.
fn lame(material: &At<MaterialChoice>) -> Result<LameParameters, ScenarioError> {
    let (MaterialChoice::SaintVenantKirchhoff(keys) | MaterialChoice::NeoHookean(keys) | MaterialChoice::Linear(keys)) =
        &**material;
    let &LameKeys { mu, lambda, young, poisson } = keys;
    let parameters = match (mu, lambda, young, poisson) {
        (Some(mu), Some(lambda), None, None) => LameParameters::new(mu, lambda),
        (None, None, Some(young), Some(poisson)) => LameParameters::from_young_poisson(young, poisson),
        _ => return Err(material.at.error(ErrorKind::Either("mu and lambda", "young and poisson"))),
    };
    parameters.map_err(|error| material.at.error(error))
}

/// Builds a material law.
fn law<const D: usize>(material: &At<MaterialChoice>) -> Result<Arc<dyn Material<D>>, ScenarioError> {
    let lame = lame(material)?;
    Ok(match &**material {
        MaterialChoice::SaintVenantKirchhoff(_) => Arc::new(SaintVenantKirchhoff::new(lame)),
        MaterialChoice::NeoHookean(_) => Arc::new(NeoHookean::new(lame)),
        MaterialChoice::Linear(_) => Arc::new(LinearElastic::new(lame)),
    })
}

impl BodyKeys {
    /// Returns Young's modulus of an elastic body, of the cells without a group; `None` for other bodies.
    pub(crate) fn young(&self) -> Option<f64> {
        let material = self.material.as_ref().filter(|_| self.motion.is_none())?;
        Some(lame(material).ok()?.young())
    }
}

/// Largest distance of a given displacement at the start from that of the body that is round-off, relative to the
/// extent of the part.
const SAME_PLACE: f64 = 1e-9;

/// Checks that a given displacement begins where the body does: a jump would be the motion of the first step.
fn check_start<const D: usize>(
    given: &BodyKeys,
    at: &Location,
    points: &[Point<D>],
    displacement: &TimeField<D>,
) -> Result<(), ScenarioError> {
    let initial = given.initial_displacement.as_ref();
    let initial = initial.map(|field| field.before_shift(given.shift(), points, &[0.0])).transpose()?;
    let of_body = |x: &Point<D>| initial.as_ref().map_or(Vector::zeros(), |initial| initial(x, 0.0));
    let bounds = Aabb::of_points(points);
    let extent = bounds.extent().max().max(bounds.low.amax()).max(bounds.high.amax());
    let jumps = |x: &&Point<D>| (displacement(x, 0.0) - of_body(x)).norm() > SAME_PLACE * extent;
    points.iter().find(jumps).map_or(Ok(()), |x| {
        let [given, start] = [displacement(x, 0.0), of_body(x)].map(|of| of.as_slice().to_vec());
        let place = x.as_slice();
        Err(at.invalid(format!(
            "at t = 0 the displacement of this part is {given:?} at {place:?}, and the body begins there with {start:?}: the first step would \
             carry the part over the difference; let it begin with the displacement of the body, or give `initial_displacement`"
        )))
    })
}

fn supports_and_loads<const D: usize>(
    given: &BodyKeys,
    conditions: &Named<BodyCondition>,
    solid: &SolidMesh<D>,
    time: &Time,
) -> Result<(Vec<Support<D>>, Vec<Load<D>>), ScenarioError> {
    let mesh = solid.mesh();
    let times = [0.0, time.end];
    let mut supports = Vec::new();
    let mut loads = Vec::new();
    for (name, condition) in &conditions.0 {
        let unknown = || {
            match sorted(mesh.boundary_names()) {
            names if names.is_empty() => condition.at.invalid(format!(
                "there is no part `{name}`: no part of this surface has a name; in a mesh the physical groups of its boundary name them"
            )),
            names => condition.at.unknown("part of the surface", name, names),
        }
        };
        let tag = mesh.tag(name).ok_or_else(unknown)?;
        let facets = tagged_facets(solid, name).map_err(|_| unknown())?;
        let vertices = solid.boundary().vertices_of(&facets);
        let points: Vec<_> = vertices.iter().map(|vertex| solid.nodes()[vertex.index()]).collect();
        let kind = match &**condition {
            BodyCondition::Clamped => SupportKind::Clamped,
            BodyCondition::Symmetry { normal } => {
                SupportKind::Symmetry { normal: plane_normal(&condition.at, mesh, tag, normal.as_ref())? }
            }
            BodyCondition::Displacement { value } => {
                let displacement = value.before_shift(given.shift(), &points, &times)?;
                if *time.scheme != TimeSchemeChoice::QuasiStatic {
                    check_start(given, &condition.at, &points, &displacement)?;
                }
                SupportKind::Displacement(Arc::new(move |x, t| {
                    let d = displacement(x, t);
                    std::array::from_fn(|axis| Some(d[axis]))
                }))
            }
            BodyCondition::Traction { value } => {
                loads.push(Load::traction(facets, value.before_shift(given.shift(), &points, &times)?));
                continue;
            }
        };
        supports.push(Support { vertices, kind });
    }
    // At vertices of two supports the later one is applied: a clamp, else a displacement, else a plane of symmetry.
    supports.sort_by_key(|support| match support.kind {
        SupportKind::Symmetry { .. } => 0,
        SupportKind::Displacement(_) => 1,
        SupportKind::Clamped => 2,
    });
    Ok((supports, loads))
}

fn free<const D: usize>(
    given: &At<BodyKeys>,
    boundary: BoundaryMesh<D>,
    reference: Vec<Point<D>>,
    held: &[At<Held>],
    initial_spin: Option<&At<Spin>>,
    time: &Time,
) -> Result<RigidBody<D>, ScenarioError> {
    let coordinates = boundary.coordinates();
    let density = **needed(given, "density", &given.density)?;
    let (gravity, variable_gravity) = gravity(given, time, coordinates)?;
    let mut body = RigidBody::new(&given.name, boundary, reference, density, gravity)
        .map_err(|error| given.shape.at.error(error))?;
    body.variable_gravity = variable_gravity;
    for (k, motion) in held.iter().enumerate() {
        if held[..k].iter().any(|other| **other == **motion) {
            return Err(motion.at.invalid("this motion is held twice; take one out"));
        }
        let no_effect = || motion.at.error(ErrorKind::NoEffect("two dimensions"));
        // With rotational symmetry bodies move along the axis, without rotation.
        if coordinates.radial().is_some() && **motion != Held::Y {
            return Err(motion.at.error(ErrorKind::NoEffect("axisymmetric coordinates")));
        }
        match **motion {
            Held::Rotation => body.holds_rotation = true,
            axis => *body.held_axes.get_mut(axis as usize).ok_or_else(no_effect)? = true,
        }
    }
    body.initial_spin = initial_spin.map_or([0.0; 3], |spin| **spin);
    if let Some(velocity) = &given.initial_velocity {
        let value: Vector<D> = velocity.constant().ok_or_else(|| {
            velocity.at.invalid("a rigid body has one velocity at the start; give numbers instead of formulas")
        })?;
        body.initial_velocity = value;
        if let Some(axis) = (0..D).find(|axis| body.held_axes[*axis] && value[*axis] != 0.0) {
            return Err(velocity.at.part(axis).error(ErrorKind::NoEffect("an axis that is held")));
        }
    }
    if let Some(given) = initial_spin.filter(|spin| body.holds_rotation && ***spin != [0.0; 3]) {
        return Err(given.at.error(ErrorKind::NoEffect("a rotation that is held")));
    }
    Ok(body)
}

//! Planes of symmetry, and the bodies on them.

use mesh::generate::HALF_BALL_PLANE;
use mesh::{Aabb, BoundaryMesh, FacetId, Point, SimplexMesh, Tag, Vector, VertexId, unit_vector};
use solver::{FluidBoundary, FluidSetup};

use super::background::Background;
use super::body::{BodyCondition, BodyKeys, Built};
use super::condition::{FluidCondition, on_plane, tagged_vertices};
use super::contact::{ALL, ContactKeys, ObstacleChoice};
use super::error::ScenarioError;
use super::geometry::Shape;
use super::motion::{Held, MotionChoice};
use super::table::{At, Named};

/// A plane of symmetry: the points `x` with `normal · x = place`.
pub(super) struct SymmetryPlane<const D: usize> {
    /// Unit normal.
    pub(super) normal: Vector<D>,
    /// The side of the background on the plane.
    pub(super) side: Tag,
    /// Bounding box of the side.
    bounds: Aabb<D>,
    /// The normal times this sign points out of the background.
    outward: f64,
    /// Signed distance from the origin along the normal.
    place: f64,
    /// Tolerance of the distance from the plane up to which a vertex counts as on it.
    tolerance: f64,
}

impl<const D: usize> SymmetryPlane<D> {
    /// Returns whether a point lies on the plane.
    pub(super) fn contains(&self, x: &Point<D>) -> bool {
        (self.normal.dot(x) - self.place).abs() <= self.tolerance
    }

    /// Returns whether a point lies on the plane and in the bounding box of the side.
    pub(super) fn is_on_side(&self, x: &Point<D>) -> bool {
        let Aabb { low, high } = &self.bounds;
        let is_between = |k: usize| (low[k] - self.tolerance..=high[k] + self.tolerance).contains(&x[k]);
        self.contains(x) && (0..D).all(is_between)
    }
}

/// Returns whether a contact keeps a body on its side of a plane of symmetry: the obstacle is the plane, or a wall with
/// the side of the background on it.
fn stops<const D: usize>(
    contact: &ContactKeys,
    body: &str,
    plane: &SymmetryPlane<D>,
    background: &SimplexMesh<D>,
) -> bool {
    let is_plane = match contact.obstacle.as_deref() {
        Some(ObstacleChoice::RigidPlane { point, normal }) => {
            let normal = normal.vector::<D>();
            normal.dot(&plane.normal).abs() > (1.0 - 1e-9) * normal.norm() && plane.contains(&point.vector())
        }
        Some(ObstacleChoice::Wall { parts }) => parts.iter().any(|part| background.tag(part) == Some(plane.side)),
        _ => false,
    };
    is_plane && contact.body.as_ref().is_some_and(|name| **name == body || **name == ALL)
}

/// Distance beyond a plane of symmetry, relative to the size of the domain, up to which a vertex counts as on it. It is
/// above the rounding of files with seven digits.
const BEYOND: f64 = 1e-6;

/// Returns the vertices of a surface that lie beyond a plane of symmetry. The list is empty unless the surface crosses
/// the side of the background on this plane and has vertices inside.
fn beyond<const D: usize>(
    plane: &SymmetryPlane<D>,
    background: &SimplexMesh<D>,
    surface: &BoundaryMesh<D>,
    positions: &[Point<D>],
) -> Vec<VertexId> {
    let domain = Aabb::of_points(background.vertices());
    let height = |x: &Point<D>| plane.normal.dot(x) - plane.place;
    let margin = BEYOND * domain.extent().max();
    let out = |vertex: &VertexId| plane.outward * height(&positions[vertex.index()]);
    let all = surface.vertices_of(&surface.facets().collect::<Vec<_>>());
    let is_across = |facet: FacetId| {
        let corners = surface.facet(facet);
        (0..corners.len()).any(|k| {
            let [from, to] = [corners[k], corners[(k + 1) % corners.len()]].map(|vertex| positions[vertex.index()]);
            let [a, b] = [height(&from), height(&to)];
            a.abs() <= margin && plane.is_on_side(&(from - plane.normal * a))
                || a * b < 0.0 && plane.is_on_side(&(from + (to - from) * (a / (a - b))))
        })
    };
    let is_inside = all.iter().any(|vertex| out(vertex) < -margin);
    let found: Vec<_> = all.into_iter().filter(|vertex| out(vertex) > margin).collect();
    if is_inside && surface.facets().any(is_across) { found } else { Vec::new() }
}

/// Returns the planes of symmetry.
pub(super) fn symmetry_planes<const D: usize>(fluid: &FluidSetup<D>) -> Vec<SymmetryPlane<D>> {
    let tolerance = on_plane(&fluid.background);
    let planes = fluid.boundary.iter().filter_map(|(tag, condition)| {
        let FluidBoundary::Symmetry { normal } = condition else { return None };
        let points = tagged_vertices(&fluid.background, *tag);
        let place = normal.dot(points.first()?);
        let outward = fluid.background.tag_normal(*tag).map_or(1.0, |outward| outward.dot(normal).signum());
        Some(SymmetryPlane { normal: *normal, side: *tag, bounds: Aabb::of_points(&points), outward, place, tolerance })
    });
    planes.collect()
}

/// Returns the names of the sides with a parabolic inflow that end at a plane of symmetry, off the axis of axisymmetric
/// coordinates. The parabola is zero there.
pub(crate) fn parabolas_at_symmetry<'c, const D: usize>(
    conditions: &'c Named<FluidCondition>,
    fluid: &FluidSetup<D>,
) -> Vec<&'c str> {
    let planes = symmetry_planes(fluid);
    let is_off_axis = |x: &Point<D>| fluid.background.coordinates().radial().is_none_or(|radial| x[radial] != 0.0);
    let is_end = |x: &Point<D>| is_off_axis(x) && planes.iter().any(|plane| plane.is_on_side(x));
    let ends = |name: &str| {
        fluid.background.tag(name).is_some_and(|tag| tagged_vertices(&fluid.background, tag).iter().any(is_end))
    };
    let parabolas = conditions.0.iter().filter(|(_, of)| matches!(**of, FluidCondition::Inflow { .. }));
    parabolas.map(|(name, _)| name.as_str()).filter(|name| ends(name)).collect()
}

/// Checks that the sides on the axis of axisymmetric coordinates are planes of symmetry.
pub(super) fn check_axis<const D: usize>(fluid: &FluidSetup<D>, given: &At<Background>) -> Result<(), ScenarioError> {
    let Some(radial) = fluid.background.coordinates().radial() else { return Ok(()) };
    for (tag, condition) in &fluid.boundary {
        let points = tagged_vertices(&fluid.background, *tag);
        let is_on_axis = points.iter().all(|x| x[radial] == 0.0);
        if is_on_axis && !matches!(condition, FluidBoundary::Symmetry { normal } if normal[radial] == 1.0) {
            let name = &fluid.background.tag_names()[tag.index()];
            return Err(given.boundary().at.invalid(format!(
                "side `{name}` lies on the axis of rotation, where nothing crosses; give it the condition \"symmetry\""
            )));
        }
    }
    Ok(())
}

/// Removes facets on planes of symmetry from the contact facets of rigid and prescribed bodies. Returns an error if a
/// free body with such facets is not held, or if nothing keeps such facets of an elastic body on the plane.
pub(super) fn respect_symmetry<const D: usize>(
    contacts: &[At<ContactKeys>],
    bodies: &[At<BodyKeys>],
    fluid: &FluidSetup<D>,
    built: &mut [Built<D>],
) -> Result<(), ScenarioError> {
    let planes = symmetry_planes(fluid);
    let domain = Aabb::of_points(fluid.background.vertices());
    for given in bodies {
        let Shape::HalfBall { centre, mirrored: false, .. } = &*given.shape else { continue };
        let is_symmetric = |(name, condition): (&str, &BodyCondition)| {
            name == HALF_BALL_PLANE && matches!(condition, BodyCondition::Symmetry { .. })
        };
        let at = centre[0] + given.shift.as_ref().map_or(0.0, |shift| shift[0]);
        let on_diameter = unit_vector::<D>(0) * at;
        let is_on_plane = planes.iter().any(|plane| plane.normal[0] == 1.0 && plane.contains(&on_diameter));
        let is_inside = domain.low[0] <= at && at <= domain.high[0];
        let is_on_axis = fluid.background.coordinates().radial() == Some(0) && at == 0.0;
        if given.conditions().any(is_symmetric) && is_inside && !is_on_plane && !is_on_axis {
            return Err(given.shape.at.invalid(format!(
                "the diameter of this half ball is a line of symmetry at x = {at}, but no side of the background is one there; move it, or use a ball"
            )));
        }
    }
    for (given, Built { body, contact_facets, part_names }) in bodies.iter().zip(built) {
        let positions = body.initial().positions(body.reference());
        let on_plane = |facet: FacetId| {
            let vertices = body.surface().facet(facet);
            planes.iter().find(|plane| vertices.iter().all(|v| plane.contains(&positions[v.index()])))
        };
        let is_clamped = |vertex: VertexId| {
            let clamps = |name: &String| {
                given.conditions().any(|(part, of)| part == name && matches!(of, BodyCondition::Clamped))
            };
            let surface = body.surface();
            let mut around = surface.facets().filter(|facet| surface.facet(*facet).contains(&vertex));
            around.any(|facet| surface.tag(facet).and_then(|tag| part_names.get(tag.index())).is_some_and(clamps))
        };
        let is_free = |plane: &SymmetryPlane<D>| {
            let vertices = beyond(plane, &fluid.background, body.surface(), &positions);
            vertices.into_iter().any(|vertex| !is_clamped(vertex))
        };
        if body.is_movable() && planes.iter().any(is_free) {
            return Err(given.shape.at.invalid(format!(
                "body `{}` crosses a plane of symmetry of the background: the fluid would act on the part inside only, but gravity and inertia on the whole body; use the \
                 part on one side, such as kind = \"half-ball\", move it, or clamp all of an elastic body that is beyond",
                body.name()
            )));
        }
        let Some(motion) = &given.motion else {
            let is_moved = |facet: &FacetId| {
                let name = body.surface().tag(*facet).and_then(|tag| part_names.get(tag.index()));
                let moves = |of: &BodyCondition| matches!(of, BodyCondition::Displacement { .. });
                given.conditions().any(|(part, of)| name.is_some_and(|name| part == name) && moves(of))
            };
            let is_loose = |facet: &&FacetId| {
                let at = body.surface().facet(**facet).iter().map(|v| positions[v.index()]);
                let side = planes.iter().find(|plane| at.clone().all(|x| plane.is_on_side(&x)));
                let is_stopped = |plane| contacts.iter().any(|of| stops(of, &given.name, plane, &fluid.background));
                side.is_some_and(|plane| !is_moved(facet) && !is_stopped(plane))
            };
            if contact_facets.iter().any(|facet| is_loose(&facet)) {
                return Err(given.shape.at.invalid(format!(
                    "a part of the surface of `{}` lies on a plane of symmetry of the background, and nothing keeps it on this plane; give the part the \
                     condition \"symmetry\" in `boundary`, or state a contact with the plane",
                    given.name.as_str()
                )));
            }
            continue;
        };
        contact_facets.retain(|facet| on_plane(*facet).is_none());
        // A body on the axis of rotation moves along the axis only.
        let is_axisymmetric = body.surface().coordinates().radial().is_some();
        let MotionChoice::Free { held, .. } = &**motion else { continue };
        if is_axisymmetric {
            continue;
        }
        let is_held = |what: Held| held.iter().any(|held| **held == what);
        let across = |plane: &SymmetryPlane<D>| {
            let axes = [Held::X, Held::Y, Held::Z].into_iter().zip(["\"x\"", "\"y\"", "\"z\""]);
            let axes = axes.zip(plane.normal.iter()).filter(|(_, n)| **n != 0.0).map(|(axis, _)| axis);
            axes.chain([(Held::Rotation, "\"rotation\"")]).collect::<Vec<_>>()
        };
        let is_loose = |plane: &&SymmetryPlane<D>| across(plane).iter().any(|(what, _)| !is_held(*what));
        if let Some(plane) = body.surface().facets().filter_map(on_plane).find(is_loose) {
            let (name, needed) =
                (body.name(), across(plane).into_iter().map(|(_, word)| word).collect::<Vec<_>>().join(", "));
            return Err(motion.at.invalid(format!(
                "body `{name}` stands on a plane of symmetry, which it must not leave; sliding along an oblique plane is not available: add held = [{needed}]"
            )));
        }
    }
    Ok(())
}

//! Shapes of bodies: one function for each kind.

use std::collections::HashMap;

use mesh::generate::{BallOptions, Size, ball, graded_box, half_ball, mirrored, structured_box};
use mesh::{BoundaryMesh, Point, SimplexMesh, Tag, Vector, VertexId};

use super::error::{ErrorKind, Location, ScenarioError};
use super::key::Quantity;
use super::table::{At, Components, choices};

choices! {
    /// Shape of a body.
    pub enum Shape ["kind"] {
        /// Disk, in 2D; tag `surface`.
        Ball = "ball" {
            /// Centre.
            centre: Components<f64> [unit(Quantity::LENGTH)],
            /// Radius.
            radius: f64 [unit(Quantity::LENGTH), positive],
            /// Mean diameter of the cells.
            size: f64 [unit(Quantity::LENGTH), positive],
            /// Whether the polygon has the area of the disk; its vertices lie on the circle otherwise.
            area_preserving: bool = false,
        },
        /// Half of a disk with `x` not below that of the centre, in 2D; tags `left` (the diameter) and `surface`.
        HalfBall = "half-ball" {
            /// Centre of the disk.
            centre: Components<f64> [unit(Quantity::LENGTH)],
            /// Radius.
            radius: f64 [unit(Quantity::LENGTH), positive],
            /// Mean diameter of the cells.
            size: f64 [unit(Quantity::LENGTH), positive],
            /// Whether the polygon has the area of the disk; its vertices lie on the circle otherwise.
            area_preserving: bool = false,
            /// Whether the mirror image is added: an exactly symmetric disk with tag `surface`.
            mirrored: bool = false,
        },
        /// Box; tags `left`, `right`, `bottom`, `top`, and in 3D `front`, `back`.
        Box = "box" {
            /// Lowest corner.
            min: Components<f64> [unit(Quantity::LENGTH)],
            /// Highest corner.
            max: Components<f64> [unit(Quantity::LENGTH)],
            /// Mean diameter of the cells; or `n`.
            size: Option<f64> [unit(Quantity::LENGTH), positive, group(0)],
            /// Number of bricks along each axis, divided into 2 triangles or 6 tetrahedra; or `size`.
            n: Option<Components<usize>> [between(1.0, f64::INFINITY), group(1)],
        },
        /// Simple polygon without a mesh of its inside, in 2D; for bodies that do not deform.
        Polygon = "polygon" {
            /// Corners, in order.
            corners: Vec<Components<f64>> [unit(Quantity::LENGTH)],
            /// Largest length of the segments into which the sides are divided.
            size: f64 [unit(Quantity::LENGTH), positive],
        },
    }
}

/// Geometry of a body.
pub(super) enum Geometry<const D: usize> {
    /// A mesh of the body.
    Mesh(Box<SimplexMesh<D>>),
    /// The surface of the body, with the positions of its vertices.
    Surface(BoundaryMesh<D>, Vec<Point<D>>),
}

impl<const D: usize> Geometry<D> {
    /// Builds the geometry of a shape.
    ///
    /// # Errors
    /// A mesh that cannot be generated, or a shape that does not exist in dimension `D`.
    pub(super) fn new(shape: &At<Shape>) -> Result<Self, ScenarioError> {
        let mesh = match &**shape {
            Shape::Ball { centre, radius, size, area_preserving } => {
                let options = BallOptions { area_preserving: *area_preserving };
                ball(centre.vector::<D>().into(), *radius, *size, &options)
            }
            Shape::HalfBall { centre, radius, size, area_preserving, mirrored: is_whole } => {
                let options = BallOptions { area_preserving: *area_preserving };
                let centre = centre.vector::<D>();
                let half = half_ball(centre.into(), *radius, *size, &options);
                if *is_whole { half.and_then(|half| mirrored(&half, 0, centre[0])) } else { half }
            }
            Shape::Box { min, max, size, n } => {
                let (min, max) = (min.vector::<D>().into(), max.vector::<D>().into());
                match (size, n) {
                    (Some(h), None) => graded_box(min, max, &Size::uniform(*h)),
                    (None, Some(n)) => structured_box(min, max, std::array::from_fn(|axis| n[axis])),
                    _ => return Err(shape.at.error(ErrorKind::Either("size", "n"))),
                }
            }
            Shape::Polygon { corners, size } => return polygon(&shape.at, corners, *size),
        };
        match mesh {
            Ok(mesh) => Ok(Self::Mesh(Box::new(mesh))),
            Err(error @ mesh::Error::Dimension { .. }) => {
                Err(shape.at.invalid(format!("{error}; use a box, or dimension = 2")))
            }
            Err(error) => Err(shape.at.error(error)),
        }
    }

    /// Returns the geometry at another place.
    ///
    /// # Errors
    /// A shift so large that rounding destroys the mesh.
    pub(super) fn shifted(self, by: Vector<D>) -> Result<Self, mesh::Error> {
        Ok(match self {
            Self::Mesh(mesh) => Self::Mesh(Box::new(mesh.mapped(|x| x + by)?)),
            Self::Surface(surface, positions) => Self::Surface(surface, positions.iter().map(|x| x + by).collect()),
        })
    }

    /// Returns the surface with the positions of its own vertices.
    pub(super) fn into_surface(self) -> (BoundaryMesh<D>, Vec<Point<D>>) {
        let mesh = match self {
            Self::Surface(surface, positions) => return (surface, positions),
            Self::Mesh(mesh) => mesh,
        };
        let whole = mesh.boundary();
        let mut numbers: Vec<Option<VertexId>> = vec![None; mesh.n_vertices()];
        let mut positions = Vec::new();
        let mut facets = Vec::with_capacity(D * whole.n_facets());
        for vertex in whole.facets().flat_map(|facet| whole.facet(facet)) {
            facets.push(*numbers[vertex.index()].get_or_insert_with(|| {
                positions.push(mesh.vertex(*vertex));
                VertexId::new(positions.len() - 1)
            }));
        }
        (BoundaryMesh::from_facets(facets), positions)
    }
}

/// Builds the surface of a polygon, counter-clockwise.
fn polygon<const D: usize>(
    at: &Location,
    corners: &[Components<f64>],
    size: f64,
) -> Result<Geometry<D>, ScenarioError> {
    if D != 2 {
        return Err(at.invalid("a polygon exists in two dimensions only; use a box, or dimension = 2"));
    }
    if corners.len() < 3 {
        let message = format!("this has {} corners, but a polygon needs three", corners.len());
        return Err(at.part("corners").invalid(message));
    }
    let mut corners: Vec<Point<D>> = corners.iter().map(Components::vector).collect();
    let sides = |corners: &[Point<D>]| {
        corners.iter().copied().zip(corners.iter().copied().cycle().skip(1)).collect::<Vec<(Point<D>, Point<D>)>>()
    };
    let double_area: f64 = sides(&corners).iter().map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
    if double_area < 0.0 {
        corners.reverse();
    }
    let mut positions = Vec::new();
    for (a, b) in sides(&corners) {
        let n = ((b - a).norm() / size).ceil();
        if n.is_nan() || !(1.0..=MOST_SEGMENTS).contains(&n) {
            let message = format!("a side has {n} segments of this size; use from 1 to {MOST_SEGMENTS:e}");
            return Err(at.part("size").invalid(message));
        }
        positions.extend((0..n as usize).map(|k| a + (b - a) * (k as f64 / n)));
    }
    let n = positions.len();
    let facets = (0..n).flat_map(|k| [VertexId::new(k), VertexId::new((k + 1) % n)]).collect();
    Ok(Geometry::Surface(BoundaryMesh::from_facets(facets), positions))
}

/// Returns the positions of the nodes that elements of order 2 have on the round edges of a shifted shape, for the ends of each edge in ascending order.
///
/// # Errors
/// A polygon with the area of the disk, which belongs to elements of order 1.
pub(super) fn nodes_on_circle<const D: usize>(
    shape: &At<Shape>,
    shift: Vector<D>,
    mesh: &SimplexMesh<D>,
) -> Result<HashMap<[VertexId; 2], Point<D>>, ScenarioError> {
    let (Shape::Ball { centre, area_preserving, .. } | Shape::HalfBall { centre, area_preserving, .. }) = &**shape
    else {
        return Ok(HashMap::new());
    };
    if *area_preserving {
        return Err(shape.at.part("area_preserving").error(ErrorKind::NoEffect("elements of order 2")));
    }
    let (centre, tag) = (centre.vector::<D>() + shift, mesh.tag("surface"));
    let mut nodes = HashMap::new();
    for facet in mesh.facets().filter(|facet| tag.is_some() && mesh.facet_tag(*facet) == tag) {
        for (k, &a) in mesh.facet(facet).iter().enumerate() {
            for &b in &mesh.facet(facet)[..k] {
                let arms = [a, b].map(|vertex| mesh.vertex(vertex) - centre);
                let middle = (arms[0] + arms[1]).normalize() * arms[0].norm();
                nodes.insert([a.min(b), a.max(b)], centre + middle);
            }
        }
    }
    Ok(nodes)
}

/// Largest number of segments of a side of a polygon.
const MOST_SEGMENTS: f64 = 1e6;

/// Largest deviation of a normal from an axis, relative to its length.
const ALONG_AXIS: f64 = 1e-9;

/// Returns the outward unit normal of a tagged part of a boundary and the number of the axis along which it points.
///
/// A normal that is given replaces that of the facets.
///
/// # Errors
/// Facets that do not lie in one plane, or a normal that is not along an axis.
pub(super) fn normal_along_axis<const D: usize>(
    at: &Location,
    mesh: &SimplexMesh<D>,
    tag: Tag,
    given: Option<&Components<f64>>,
) -> Result<(usize, Vector<D>), ScenarioError> {
    let normal = match given {
        Some(given) => given.vector::<D>().try_normalize(0.0).ok_or_else(|| at.part("normal").invalid(ZERO_VECTOR))?,
        None => mesh.tag_normal(tag).ok_or_else(|| {
            at.invalid("this part of the boundary is not plane; use another condition, or give a symmetry its normal")
        })?,
    };
    let axis = normal.iamax();
    if normal.iter().enumerate().any(|(a, n)| a != axis && n.abs() > ALONG_AXIS) {
        let normal = normal.as_slice();
        return Err(at.invalid(format!(
            "the normal {normal:?} is not along an axis, and oblique planes are not available yet; turn the geometry"
        )));
    }
    Ok((axis, normal))
}

/// Message about a vector that must give a direction.
pub(super) const ZERO_VECTOR: &str = "this vector is zero, but must give a direction";

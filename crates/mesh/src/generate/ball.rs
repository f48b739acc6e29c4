//! Disks, half disks and balls of uniform cell size.

use std::f64::consts::PI;

use super::icosahedron::divided_icosahedron;
use super::size::{MEAN_EDGE, affordable};
use super::triangulate::{Outline, filled};
use super::unit::Unit;
use crate::{Error, Point, SimplexMesh, positive, require};

/// Approximation of a ball by a polygon or polyhedron.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BallOptions {
    /// Whether the polygon or polyhedron has the area or volume of the ball; otherwise its vertices lie on the ball.
    pub area_preserving: bool,
}

/// Generates a ball with cells of size `h` (at most the radius). Its boundary has the tag "surface".
///
/// In 2D, boundary vertices are equally spaced and angles are at least 25 degrees. In 3D, the 20 tetrahedra between the
/// centre and the faces of an icosahedron are divided, and the vertices are moved along rays until each layer is a
/// sphere; edges have the mean length `h`.
///
/// # Errors
/// [`Error::Parameter`]: centre, radius or size not finite, radius or size not positive, or too many cells.
pub fn ball<const D: usize>(
    centre: [f64; D],
    radius: f64,
    h: f64,
    options: &BallOptions,
) -> Result<SimplexMesh<D>, Error> {
    if D == 3 {
        check(&centre, radius, h)?;
        let unit = divided_icosahedron(radius / h.min(radius))?;
        let scale = if options.area_preserving { (4.0 / 3.0 * PI / unit.volume()).cbrt() } else { 1.0 };
        let centre = Point::from(centre);
        return Ok(unit.mapped(|x| centre + x * (radius * scale))?.with_boundary_tags(|_| Some("surface")));
    }
    let circle = Circle::new(&centre, radius, h, options)?;
    let mut outline = Outline::default();
    let n = 2 * circle.n_half;
    outline.side((0..=n).map(|i| circle.node(i % n)));
    Ok(circle.placed(filled(outline, |_| circle.h)?)?.with_boundary_tags(|_| Some("surface")))
}

/// Tag of the facets of a [`half_ball`] on its plane of symmetry.
pub const HALF_BALL_PLANE: &str = "left";

/// Generates the half of a [`ball`] with `x >= centre[0]`. Vertices on the plane of symmetry lie exactly on it. Facets
/// on it have the tag [`HALF_BALL_PLANE`], all others "surface". The boundary vertices are those of [`ball`] up to
/// round-off.
///
/// # Errors
/// As [`ball`]. [`Error::Dimension`]: `D` is not 2.
pub fn half_ball<const D: usize>(
    centre: [f64; D],
    radius: f64,
    h: f64,
    options: &BallOptions,
) -> Result<SimplexMesh<D>, Error> {
    let circle = Circle::new(&centre, radius, h, options)?;
    let n = circle.n_half;
    let mut outline = Outline::default();
    outline.side((0..=n).map(|i| circle.node(i)));
    let [lowest, highest] = [circle.node(0)[1], circle.node(n)[1]];
    let n_diameter = ((highest - lowest) / circle.h).round() as usize;
    outline.side((0..=n_diameter).rev().map(|i| [0.0, lowest + (highest - lowest) * (i as f64 / n_diameter as f64)]));
    let mesh = circle.placed(filled(outline, |_| circle.h)?)?;
    Ok(mesh.with_boundary_tags(|points| {
        let on_plane = points.iter().all(|p| p[0] == centre[0]);
        Some(if on_plane { HALF_BALL_PLANE } else { "surface" })
    }))
}

fn check<const D: usize>(centre: &[f64; D], radius: f64, h: f64) -> Result<(), Error> {
    for &c in centre {
        require(c.is_finite(), "centre", c, "finite")?;
    }
    positive("radius", radius)?;
    positive("size", h)?;
    Ok(())
}

/// A circle about the origin that represents one about `centre`.
struct Circle {
    /// Unit of `radius` and `h`.
    unit: Unit,
    /// Position of the centre, in the unit of the caller.
    centre: [f64; 2],
    /// Distance of the nodes from the centre.
    radius: f64,
    /// Mean length of the edges.
    h: f64,
    /// Number of boundary segments of one half.
    n_half: usize,
}

impl Circle {
    fn new<const D: usize>(centre: &[f64; D], radius: f64, h: f64, options: &BallOptions) -> Result<Self, Error> {
        check(centre, radius, h)?;
        let &[x, y] = centre.as_slice() else {
            return Err(Error::Dimension { shape: "half-ball", dimension: D });
        };
        let unit = Unit::of(2.0 * radius);
        let [radius, h] = [radius, h].map(|length| unit.of_length(length));
        let h = MEAN_EDGE * h.min(radius);
        affordable(2.0 * PI * (radius / h).powi(2))?;
        let n_half = (PI * radius / h).round() as usize;
        let angle = PI / n_half as f64;
        let scale = if options.area_preserving { (angle / angle.sin()).sqrt() } else { 1.0 };
        Ok(Self { unit, centre: [x, y], radius: radius * scale, h, n_half })
    }

    /// Moves a mesh about the origin to the centre, in the unit of the caller.
    fn placed<const D: usize>(&self, mesh: SimplexMesh<D>) -> Result<SimplexMesh<D>, Error> {
        mesh.mapped(|x| Point::from_fn(|axis, _| self.centre[axis] + self.unit.to_caller_unit(x[axis])))
    }

    /// Returns the node `i` relative to the centre, counter-clockwise from the lowest one. The nodes on the vertical
    /// diameter are exact.
    fn node(&self, i: usize) -> [f64; 2] {
        if i == 0 {
            return [0.0, -self.radius];
        }
        if i == self.n_half {
            return [0.0, self.radius];
        }
        let angle = PI * i as f64 / self.n_half as f64;
        [self.radius * angle.sin(), -self.radius * angle.cos()]
    }
}

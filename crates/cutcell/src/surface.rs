//! The facets of all surfaces of an overlay.

use mesh::{Aabb, BodyId, FacetId, Placed, Point, SimplexMesh, Vector, require};

use crate::exact::{HalfSpace, is_degenerate};
use crate::soundness::{FARTHEST, check_self_intersections, check_surface};
use crate::{Error, OverlayOptions};

/// Square of the sine of an angle of a triangle below which its sides are treated as parallel.
const NEEDLE: f64 = 1e-12;

/// Smaller coordinates are set to zero, since products of three of them would underflow.
const SMALLEST: f64 = 1e-60;

fn flushed<const D: usize>(x: &Point<D>) -> Point<D> {
    x.map(|c| if c.abs() < SMALLEST { 0.0 } else { c })
}

/// A point on a facet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FacetPoint<const D: usize> {
    pub(crate) x: Point<D>,
    pub(crate) barycentric: [f64; 3],
}

/// One facet of one surface.
#[derive(Clone, Debug)]
pub(crate) struct Facet<const D: usize> {
    pub(crate) body: BodyId,
    pub(crate) id: FacetId,
    points: [Point<D>; 4],
    /// Indices of the corners among the vertices of all surfaces.
    pub(crate) vertices: [u32; 3],
    /// Unit normal, out of the body.
    pub(crate) normal: Vector<D>,
    pub(crate) plane: HalfSpace<D>,
    /// Planes through the sides, normal to the facet, see [`crate::exact::Plane::rim`].
    pub(crate) rims: [HalfSpace<D>; 3],
    pub(crate) bounds: Aabb<D>,
}

impl<const D: usize> Facet<D> {
    /// Creates a facet from its `D` corners and their indices among the vertices of all surfaces.
    pub(crate) fn new(body: BodyId, id: FacetId, corners: &[Point<D>], vertices: [u32; 3]) -> Self {
        let mut points = [Point::zeros(); 4];
        for (slot, x) in points.iter_mut().zip(corners) {
            *slot = flushed(x);
        }
        let corners = &points[..D];
        let plane = HalfSpace::through(corners);
        let normal = plane.normal;
        let bounds = Aabb::of_points(corners);
        let rims = std::array::from_fn(|k| HalfSpace::through(&rim_points(corners, &normal, k % D)[..D]));
        Self { body, id, points, vertices, normal, plane, rims, bounds }
    }

    pub(crate) fn points(&self) -> &[Point<D>] {
        &self.points[..D]
    }

    /// Returns the points that define the plane through a rim, exactly; only the first `D` are used.
    pub(crate) fn rim_points(&self, local: usize) -> [Point<D>; 3] {
        rim_points(self.points(), &self.normal, local)
    }

    /// Returns a point on the facet with its barycentric coordinates.
    pub(crate) fn point(&self, x: Point<D>) -> FacetPoint<D> {
        let [a, b, c, _] = self.barycentric(&x);
        FacetPoint { x, barycentric: [a, b, c] }
    }

    /// Computes the barycentric coordinates of a point on the facet.
    fn barycentric(&self, x: &Point<D>) -> [f64; 4] {
        let origin = self.points[0];
        let r = x - origin;
        let mut coordinates = [0.0; 4];
        match D {
            2 => {
                let t = self.points[1] - origin;
                let l = (r.dot(&t) / t.norm_squared()).clamp(0.0, 1.0);
                coordinates[..2].copy_from_slice(&[1.0 - l, l]);
            }
            _ => {
                let (a, b) = (self.points[1] - origin, self.points[2] - origin);
                let (aa, ab, bb, ra, rb) = (a.dot(&a), a.dot(&b), b.dot(&b), r.dot(&a), r.dot(&b));
                let det = aa * bb - ab * ab;
                if det > NEEDLE * aa * bb {
                    let (l1, l2) = ((ra * bb - rb * ab) / det, (rb * aa - ra * ab) / det);
                    coordinates[..3].copy_from_slice(&[1.0 - l1 - l2, l1, l2]);
                } else {
                    // The width is round-off: the longest side represents the facet.
                    let length = |k: usize| (self.points[(k + 1) % 3] - self.points[k]).norm_squared();
                    let k = (1..3).fold(0, |longest, k| if length(k) > length(longest) { k } else { longest });
                    let side = self.points[(k + 1) % 3] - self.points[k];
                    let l = ((x - self.points[k]).dot(&side) / side.norm_squared()).clamp(0.0, 1.0);
                    coordinates[k] = 1.0 - l;
                    coordinates[(k + 1) % 3] = l;
                }
            }
        }
        coordinates
    }
}

/// Collects the facets of positive measure of all surfaces, in the order of bodies and facets.
///
/// # Errors
/// Invalid surfaces and options, see [`Error`].
pub(crate) fn collect<const D: usize>(
    background: &SimplexMesh<D>,
    surfaces: &[Placed<'_, D>],
    options: &OverlayOptions,
    facets: &mut Vec<Facet<D>>,
) -> Result<(), Error> {
    facets.clear();
    let tolerance = options.relative_tolerance;
    require((0.0..1.0).contains(&tolerance), "relative tolerance", tolerance, "from 0 to below 1")?;
    let largest_coordinate = background.vertices().iter().fold(0.0_f64, |r, x| r.max(x.amax()));
    let mut first_vertex = 0;
    for (index, surface) in surfaces.iter().enumerate() {
        let body = BodyId::new(index);
        check_surface(body, surface, FARTHEST * largest_coordinate)?;
        if options.refuse_self_intersections {
            check_self_intersections(body, surface)?;
        }
        for id in surface.boundary().facets() {
            let corners = surface.facet_points(id).map(|x| flushed(&x));
            let corners = &corners[..D];
            if is_degenerate(corners) {
                continue;
            }
            let mut vertices = [0; 3];
            for (slot, v) in vertices.iter_mut().zip(surface.boundary().facet(id)) {
                *slot = first_vertex + v.0;
            }
            facets.push(Facet::new(body, id, corners, vertices));
        }
        first_vertex += surface.positions().len() as u32;
    }
    Ok(())
}

fn rim_points<const D: usize>(points: &[Point<D>], normal: &Vector<D>, local: usize) -> [Point<D>; 3] {
    let (a, b) = (points[local], points[(local + 1) % D]);
    // The distance is the size of the facet, but large enough that round-off does not turn the plane.
    let tip = a + normal * (points[1] - points[0]).norm().max(1e-6 * a.amax());
    let mut through = [Point::zeros(); 3];
    match (D, local) {
        (2, 0) => through[..2].copy_from_slice(&[a, tip]),
        (2, _) => through[..2].copy_from_slice(&[tip, a]),
        _ => through = [a, b, tip],
    }
    through
}

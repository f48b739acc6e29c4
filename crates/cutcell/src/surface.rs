//! All facets of all surfaces of an overlay, checked.

use std::collections::HashMap;

use mesh::{BodyId, FacetId, Placed, Point, Vector, VertexId};

use crate::Error;
use crate::exact::HalfSpace;

/// One facet of one surface.
#[derive(Clone, Debug)]
pub(crate) struct Facet<const D: usize> {
    pub(crate) body: BodyId,
    pub(crate) id: FacetId,
    points: [Point<D>; 4],
    /// Numbers of the corners among the vertices of all surfaces.
    pub(crate) vertices: [u32; 3],
    /// Unit normal, out of the body.
    pub(crate) normal: Vector<D>,
    pub(crate) plane: HalfSpace<D>,
    /// Upright planes through the rims, see [`crate::exact::Plane::rim`].
    pub(crate) rims: [HalfSpace<D>; 3],
    pub(crate) low: Point<D>,
    pub(crate) high: Point<D>,
}

impl<const D: usize> Facet<D> {
    pub(crate) fn points(&self) -> &[Point<D>] {
        &self.points[..D]
    }

    /// Points of the upright plane through a rim; the first `D` count. All of them are points to take as they are.
    pub(crate) fn rim_points(&self, local: usize) -> [Point<D>; 3] {
        rim_points(self.points(), &self.normal, local)
    }

    /// Barycentric coordinates on the facet of a point on it.
    pub(crate) fn barycentric(&self, x: &Point<D>) -> [f64; 4] {
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
                let (l1, l2) = ((ra * bb - rb * ab) / det, (rb * aa - ra * ab) / det);
                coordinates[..3].copy_from_slice(&[1.0 - l1 - l2, l1, l2]);
            }
        }
        coordinates
    }
}

/// The facets of all surfaces that have an area, in the order of bodies and facets.
///
/// # Errors
/// Surfaces that are empty, open, non-manifold, turned inwards, or have coordinates that are not finite.
pub(crate) fn collect<const D: usize>(surfaces: &[Placed<'_, D>]) -> Result<Vec<Facet<D>>, Error> {
    let mut facets = Vec::with_capacity(surfaces.iter().map(|s| s.boundary().n_facets()).sum());
    let mut first_vertex = 0;
    for (index, surface) in surfaces.iter().enumerate() {
        let body = BodyId::new(index);
        check_surface(body, surface)?;
        for id in surface.boundary().facets() {
            let points = surface.facet_points(id);
            let normal = surface.facet_normal(id);
            if normal.iter().all(|c| *c == 0.0) {
                continue;
            }
            let (mut low, mut high) = (points[0], points[0]);
            for x in &points[1..D] {
                low = low.inf(x);
                high = high.sup(x);
            }
            let mut vertices = [0; 3];
            for (slot, v) in vertices.iter_mut().zip(surface.boundary().facet(id)) {
                *slot = first_vertex + v.0;
            }
            let plane = HalfSpace::through(&points[..D]);
            let rims = std::array::from_fn(|k| HalfSpace::through(&rim_points(&points[..D], &normal, k % D)[..D]));
            facets.push(Facet { body, id, points, vertices, normal, plane, rims, low, high });
        }
        first_vertex += surface.positions().len() as u32;
    }
    Ok(facets)
}

fn rim_points<const D: usize>(points: &[Point<D>], normal: &Vector<D>, local: usize) -> [Point<D>; 3] {
    let (a, b) = (points[local], points[(local + 1) % D]);
    let tip = a + normal * (points[1] - points[0]).norm();
    let mut through = [Point::zeros(); 3];
    match (D, local) {
        (2, 0) => through[..2].copy_from_slice(&[a, tip]),
        (2, _) => through[..2].copy_from_slice(&[tip, a]),
        _ => through = [a, b, tip],
    }
    through
}

fn check_surface<const D: usize>(body: BodyId, surface: &Placed<'_, D>) -> Result<(), Error> {
    let boundary = surface.boundary();
    if boundary.n_facets() == 0 {
        return Err(Error::Empty { body });
    }
    // A rim is a facet without one of its vertices; the surface is closed when every rim is seen once from either
    // side.
    let mut rims: HashMap<[VertexId; 2], (i32, u32, FacetId)> = HashMap::with_capacity(boundary.n_facets() * 2);
    for facet in boundary.facets() {
        let vertices = boundary.facet(facet);
        for &vertex in vertices {
            let x = surface.positions()[vertex.index()];
            if x.iter().any(|c| !c.is_finite()) {
                return Err(Error::NotFinite { body, facet, vertex });
            }
        }
        for k in 0..D {
            let (key, sense) = match D {
                2 => ([vertices[k]; 2], if k == 0 { 1 } else { -1 }),
                _ => {
                    let (a, b) = (vertices[k], vertices[(k + 1) % D]);
                    if a < b { ([a, b], 1) } else { ([b, a], -1) }
                }
            };
            let rim = rims.entry(key).or_insert((0, 0, facet));
            rim.0 += sense;
            rim.1 += 1;
        }
    }
    let mut worst: Option<([VertexId; 2], (i32, u32, FacetId))> = None;
    for (key, rim) in rims {
        if (rim.0 != 0 || rim.1 != 2) && worst.is_none_or(|(k, _)| key < k) {
            worst = Some((key, rim));
        }
    }
    if let Some(([vertex, _], (_, count, facet))) = worst {
        let mut point = [0.0; 3];
        point[..D].copy_from_slice(surface.positions()[vertex.index()].as_slice());
        return Err(if count > 2 {
            Error::NonManifold { body, facet, vertex, point }
        } else {
            Error::Open { body, facet, vertex, point }
        });
    }
    let volume = surface.enclosed_volume();
    if volume < 0.0 {
        return Err(Error::Inward { body, volume });
    }
    Ok(())
}

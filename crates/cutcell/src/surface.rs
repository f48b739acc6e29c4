//! All facets of all surfaces of an overlay, checked.

use std::collections::HashMap;

use mesh::{BodyId, FacetId, Placed, Point, Vector, VertexId};

use crate::Error;
use crate::predicates::determinant;

/// One facet of one surface.
#[derive(Clone, Debug)]
pub(crate) struct Facet<const D: usize> {
    pub(crate) body: BodyId,
    pub(crate) id: FacetId,
    points: [Point<D>; 4],
    /// Unit normal, out of the body.
    pub(crate) normal: Vector<D>,
    /// Determinant of a point to its distance: one over the length of the normal before normalisation.
    inverse_scale: f64,
    pub(crate) low: Point<D>,
    pub(crate) high: Point<D>,
}

impl<const D: usize> Facet<D> {
    pub(crate) fn points(&self) -> &[Point<D>] {
        &self.points[..D]
    }

    /// Signed distance to the plane of the facet, positive in front of it, zero within the tolerance.
    pub(crate) fn distance(&self, x: &Point<D>, tolerance: f64) -> f64 {
        let d = -determinant(self.points(), x) * self.inverse_scale;
        if d.abs() <= tolerance { 0.0 } else { d }
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
            let inverse_scale = surface.facet_normal_scaled(id).norm().recip();
            facets.push(Facet { body, id, points, normal, inverse_scale, low, high });
        }
    }
    Ok(facets)
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

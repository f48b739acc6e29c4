//! Names of planes, and planes with rounding.

use mesh::{FacetId, Point, Vector, facet_normal};

use super::crossing::cross_of_differences;

/// Name of a plane.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Plane(u32);

/// Definition of a plane.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum PlaneKind {
    /// A face of the background.
    Mesh(FacetId),
    /// A facet (index among all facets).
    Facet(u32),
    /// A rim of a facet (facet and local number), normal to the facet.
    Rim(u32, usize),
}

const MESH: u32 = 1 << 31;

impl Plane {
    pub(crate) fn mesh(facet: FacetId) -> Self {
        Self(facet.0 | MESH)
    }

    pub(crate) fn facet(facet: u32) -> Self {
        Self(4 * facet)
    }

    /// Returns the plane through rim `local` of a facet that contains the normal of the facet; its front is outside of
    /// the facet. Rim `k` of a triangle is the side from corner `k` to the next one, rim `k` of a segment is its corner
    /// `k`.
    pub(crate) fn rim(facet: u32, local: usize) -> Self {
        Self(4 * facet + 1 + local as u32)
    }

    pub(super) fn is_mesh(self) -> bool {
        self.0 & MESH != 0
    }

    pub(crate) fn kind(self) -> PlaneKind {
        match (self.0 & MESH, self.0 % 4) {
            (0, 0) => PlaneKind::Facet(self.0 / 4),
            (0, rim) => PlaneKind::Rim(self.0 / 4, rim as usize - 1),
            _ => PlaneKind::Mesh(FacetId(self.0 & !MESH)),
        }
    }
}

/// A plane in rounded numbers: errors of distances are at most `slack` times the distance from the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpace<const D: usize> {
    pub(crate) origin: Point<D>,
    /// Unit normal.
    pub(crate) normal: Vector<D>,
    pub(super) slack: f64,
}

impl<const D: usize> HalfSpace<D> {
    /// Creates the plane through `D` points that do not coincide (2D) or lie on a line (3D).
    pub(crate) fn through(points: &[Point<D>]) -> Self {
        if D == 2 {
            return Self { origin: points[0], normal: facet_normal(points), slack: 16.0 * f64::EPSILON };
        }
        // The two shortest sides give the smallest cancellation.
        let sides = [points[1] - points[0], points[2] - points[1], points[0] - points[2]];
        let squares = sides.map(|s| s.norm_squared());
        let longest = (0..3).fold(0, |l, k| if squares[k] > squares[l] { k } else { l });
        let (i, j) = ((longest + 1) % 3, (longest + 2) % 3);
        let mut n = Vector::<D>::zeros();
        for k in 0..3 {
            let (p, q) = ((k + 1) % 3, (k + 2) % 3);
            n[k] = sides[i][p] * sides[j][q] - sides[i][q] * sides[j][p];
        }
        let length = n.norm();
        let slack = f64::EPSILON * (8.0 * (squares[i] * squares[j]).sqrt() / length + 8.0);
        if slack < 1e-11 {
            return Self { origin: points[j], normal: n / length, slack };
        }
        // A needle: with rounded sides, the error of the normal would be too large.
        let n = cross_of_differences([&points[1], &points[0]], [&points[2], &points[0]]);
        let n = Vector::<D>::from_fn(|k, _| n[k]);
        Self { origin: points[j], normal: n / n.norm(), slack: 16.0 * f64::EPSILON }
    }

    /// Returns the signed distance of a point from the plane, positive in front of it, and the bound of its error.
    #[inline]
    pub(crate) fn distance(&self, x: &Point<D>) -> (f64, f64) {
        let r = x - self.origin;
        (self.normal.dot(&r), self.slack * r.iter().map(|c| c.abs()).sum::<f64>())
    }
}

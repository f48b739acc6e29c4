//! Convex pieces of a plane: segments in 2D, polygons in 3D.

use mesh::Point;
use smallvec::SmallVec;

use crate::exact::{Corner, HalfSpace, Plane, Planes};

/// Points of a convex face, on the stack if they are few.
pub(crate) type Points<const D: usize> = SmallVec<[Point<D>; 8]>;

/// A convex piece of a plane with exact corners: a segment (2D), or a polygon that turns counter-clockwise around the
/// normal of the plane (3D), with the planes that bound its sides.
#[derive(Clone, Debug)]
pub(crate) struct Polygon<const D: usize> {
    pub(crate) plane: Plane,
    pub(crate) corners: SmallVec<[Corner<D>; 8]>,
    /// The plane that meets this one in the side from corner `k` to the next; of no meaning in 2D.
    pub(crate) sides: SmallVec<[Plane; 8]>,
}

impl<const D: usize> Polygon<D> {
    /// A polygon without corners.
    pub(crate) fn on(plane: Plane) -> Self {
        Self { plane, corners: SmallVec::new(), sides: SmallVec::new() }
    }

    pub(crate) fn push(&mut self, corner: Corner<D>, side: Plane) {
        self.corners.push(corner);
        self.sides.push(side);
    }

    pub(crate) fn points(&self) -> Points<D> {
        self.corners.iter().map(|corner| corner.x).collect()
    }

    /// On which side of a plane the polygon lies.
    pub(crate) fn place(&self, planes: &Planes<'_, D>, by: Plane, half_space: &HalfSpace<D>) -> Place<D> {
        let distances: Distances = self.corners.iter().map(|corner| planes.side(corner, by, half_space)).collect();
        match (distances.iter().any(|d| *d < 0.0), distances.iter().any(|d| *d > 0.0)) {
            (false, false) => Place::On,
            (true, false) => Place::Behind,
            (false, true) => Place::Front,
            (true, true) => Place::Both(Box::new(self.divided(planes, by, half_space, &distances))),
        }
    }

    fn divided(&self, planes: &Planes<'_, D>, by: Plane, half_space: &HalfSpace<D>, distances: &[f64]) -> [Self; 2] {
        let n = self.corners.len();
        let mut parts = [Self::on(self.plane), Self::on(self.plane)];
        // Whether the corners of the parts lie on the plane.
        let mut on_plane: [SmallVec<[bool; 8]>; 2] = Default::default();
        for k in 0..n {
            for (part, sign) in [1.0, -1.0].into_iter().enumerate() {
                if sign * distances[k] <= 0.0 {
                    parts[part].push(self.corners[k], self.sides[k]);
                    on_plane[part].push(distances[k] == 0.0);
                }
            }
            let next = (k + 1) % n;
            // A segment has one side only, which is a polygon's own plane.
            if (D > 2 || next > k) && differ(distances[k], distances[next]) {
                let on = if D > 2 { [self.plane, self.sides[k], by] } else { [self.plane, by, by] };
                let ends = [k, next].map(|end| (&self.corners[end], distances[end]));
                let corner = planes.crossing(ends, on, half_space);
                for part in 0..2 {
                    parts[part].push(corner, self.sides[k]);
                    on_plane[part].push(true);
                }
            }
        }
        for (part, on_plane) in parts.iter_mut().zip(on_plane) {
            let n = on_plane.len();
            for k in (0..n).filter(|&k| on_plane[k] && on_plane[(k + 1) % n]) {
                part.sides[k] = by;
            }
        }
        parts
    }
}

/// Where a polygon lies with respect to a plane.
pub(crate) enum Place<const D: usize> {
    /// On the plane.
    On,
    /// Behind it.
    Behind,
    /// In front of it.
    Front,
    /// On both sides, with the parts behind and in front.
    Both(Box<[Polygon<D>; 2]>),
}

/// Signed distances of the corners of a piece from a plane, with exact signs.
pub(super) type Distances = SmallVec<[f64; 16]>;

/// Whether two distances lie strictly on different sides.
#[inline]
pub(super) fn differ(a: f64, b: f64) -> bool {
    (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)
}

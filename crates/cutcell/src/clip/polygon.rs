//! Convex pieces of planes: segments in 2D, polygons in 3D.

use mesh::Point;
use smallvec::SmallVec;

use crate::exact::{Corner, HalfSpace, Known, Plane, Planes};

/// A convex piece of a plane with exact corners: a segment (2D), or a polygon that turns counter-clockwise around the
/// normal of the plane (3D). Its sides are stored in [`Polygons`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polygon {
    pub(crate) plane: Plane,
    first: u32,
    end: u32,
}

/// A corner, and the plane that intersects the plane of the polygon in the side from this corner to the next (3D only).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side<const D: usize> {
    pub(crate) corner: Corner<D>,
    pub(crate) beyond: Plane,
}

/// The polygons of one cell. Divisions add polygons; only [`Polygons::forget`] and [`Polygons::clear`] remove some.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polygons<const D: usize> {
    sides: Vec<Side<D>>,
    distances: Vec<f64>,
    pub(super) known: Known,
}

impl<const D: usize> Polygons<D> {
    pub(crate) fn clear(&mut self) {
        self.sides.clear();
        self.known.clear();
    }

    /// Adds a polygon.
    pub(crate) fn push(&mut self, plane: Plane, sides: impl IntoIterator<Item = Side<D>>) -> Polygon {
        let first = self.sides.len() as u32;
        self.sides.extend(sides);
        Polygon { plane, first, end: self.sides.len() as u32 }
    }

    /// Removes a polygon and all polygons that were added after it.
    pub(crate) fn forget(&mut self, polygon: Polygon) {
        self.sides.truncate(polygon.first as usize);
    }

    pub(crate) fn sides(&self, polygon: Polygon) -> &[Side<D>] {
        &self.sides[polygon.first as usize..polygon.end as usize]
    }

    /// Returns the rounded corners.
    pub(crate) fn points(&self, polygon: Polygon) -> FacePoints<D> {
        self.sides(polygon).iter().map(|side| side.corner.x).collect()
    }

    /// Returns the rims of a facet on which a piece of it has sides, as bits. For segments, both bits are set.
    pub(crate) fn rims(&self, polygon: Polygon, facet: u32) -> u8 {
        if D == 2 {
            return 0b11;
        }
        let is_side = |rim: &usize| self.sides(polygon).iter().any(|side| side.beyond == Plane::rim(facet, *rim));
        (0..D).filter(is_side).map(|rim| 1 << rim).sum()
    }

    /// Classifies a polygon relative to a plane; divides it into the parts behind and in front if it crosses the plane.
    pub(crate) fn place(
        &mut self,
        planes: &Planes<'_, D>,
        polygon: Polygon,
        by: Plane,
        half_space: &HalfSpace<D>,
    ) -> Place<[Polygon; 2]> {
        self.place_with(planes, polygon, by, half_space, |polygons, crossings| {
            [1.0, -1.0].map(|sign| polygons.part(polygon, by, crossings, sign))
        })
    }

    /// Classifies a polygon as [`Self::place`] does, but creates only one part: in front of the plane or behind it.
    pub(crate) fn place_one(
        &mut self,
        planes: &Planes<'_, D>,
        polygon: Polygon,
        by: Plane,
        half_space: &HalfSpace<D>,
        is_in_front: bool,
    ) -> Place<Polygon> {
        self.place_with(planes, polygon, by, half_space, |polygons, crossings| {
            polygons.part(polygon, by, crossings, if is_in_front { -1.0 } else { 1.0 })
        })
    }

    /// Classifies a polygon relative to a plane. If it crosses the plane, calls `divide` with the crossings; distances
    /// of the corners are then in `self.distances`.
    fn place_with<P>(
        &mut self,
        planes: &Planes<'_, D>,
        polygon: Polygon,
        by: Plane,
        half_space: &HalfSpace<D>,
        divide: impl FnOnce(&mut Self, &SideCrossings<D>) -> P,
    ) -> Place<P> {
        self.distances.clear();
        let (mut is_behind, mut is_in_front) = (false, false);
        for side in &self.sides[polygon.first as usize..polygon.end as usize] {
            let distance = planes.side(&side.corner, by, half_space, &mut self.known);
            is_behind |= distance < 0.0;
            is_in_front |= distance > 0.0;
            self.distances.push(distance);
        }
        match (is_behind, is_in_front) {
            (false, false) => Place::On,
            (true, false) => Place::Behind,
            (false, true) => Place::Front,
            (true, true) => {
                let crossings = self.crossings(planes, polygon, by, half_space);
                Place::Both(divide(self, &crossings))
            }
        }
    }

    /// Computes the corners at which the sides of a polygon cross a plane, from the distances of its corners.
    fn crossings(
        &mut self,
        planes: &Planes<'_, D>,
        polygon: Polygon,
        by: Plane,
        half_space: &HalfSpace<D>,
    ) -> SideCrossings<D> {
        let sides = &self.sides[polygon.first as usize..polygon.end as usize];
        let n = sides.len();
        let mut crossings = SideCrossings::new();
        for k in 0..if D > 2 { n } else { n - 1 } {
            let next = if k + 1 < n { k + 1 } else { 0 };
            let (at, at_next) = (self.distances[k], self.distances[next]);
            if differ(at, at_next) {
                let on = if D > 2 { [polygon.plane, sides[k].beyond, by] } else { [polygon.plane, by, by] };
                let ends = [(&sides[k].corner, at), (&sides[next].corner, at_next)];
                crossings.push((k, planes.crossing(ends, on, half_space, &mut self.known)));
            }
        }
        crossings
    }

    /// Adds the part on one side of a plane (`sign` 1: behind, -1: in front), from the distances of the corners.
    fn part(&mut self, polygon: Polygon, by: Plane, crossings: &SideCrossings<D>, sign: f64) -> Polygon {
        let (first, start) = (polygon.first as usize, self.sides.len());
        let n = polygon.end as usize - first;
        for k in 0..n {
            let side = self.sides[first + k];
            let (at, next) = (sign * self.distances[k], sign * self.distances[if k + 1 < n { k + 1 } else { 0 }]);
            // Where the boundary leaves the part, the part continues along the plane.
            if at <= 0.0 {
                let leaves = at == 0.0 && next >= 0.0;
                self.sides.push(Side { corner: side.corner, beyond: if leaves { by } else { side.beyond } });
            }
            if let Some((_, corner)) = crossings.iter().find(|crossing| crossing.0 == k) {
                self.sides.push(Side { corner: *corner, beyond: if at < 0.0 { by } else { side.beyond } });
            }
        }
        Polygon { plane: polygon.plane, first: start as u32, end: self.sides.len() as u32 }
    }
}

/// Position of a polygon relative to a plane.
pub(crate) enum Place<P> {
    /// On the plane.
    On,
    /// Behind it.
    Behind,
    /// In front of it.
    Front,
    /// On both sides, with its parts.
    Both(P),
}

/// Indices of the sides that cross a plane, with the crossings: two for a polygon, one for a segment.
type SideCrossings<const D: usize> = SmallVec<[(usize, Corner<D>); 2]>;

/// FacePoints of a convex face, on the stack if they are few.
pub(crate) type FacePoints<const D: usize> = SmallVec<[Point<D>; 8]>;

/// Returns whether two distances lie strictly on different sides.
#[inline]
pub(super) fn differ(a: f64, b: f64) -> bool {
    (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)
}

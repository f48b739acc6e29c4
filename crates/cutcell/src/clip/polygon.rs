//! Convex pieces of planes: segments in 2D, polygons in 3D.

use mesh::Point;
use smallvec::SmallVec;

use crate::exact::{Corner, HalfSpace, Known, Plane, Planes};

/// A convex piece of a plane with exact corners: a segment (2D), or a polygon that turns counter-clockwise around the
/// normal of the plane (3D). Its sides are among those of [`Polygons`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polygon {
    pub(crate) plane: Plane,
    first: u32,
    end: u32,
}

/// A corner, and the plane that meets that of the polygon in the side from this corner to the next; of no meaning in 2D.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side<const D: usize> {
    pub(crate) corner: Corner<D>,
    pub(crate) beyond: Plane,
}

/// The polygons of one cell: division adds polygons, and nothing is removed before the next cell.
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

    /// Forgets a polygon and all that were added after it.
    pub(crate) fn forget(&mut self, polygon: Polygon) {
        self.sides.truncate(polygon.first as usize);
    }

    pub(crate) fn sides(&self, polygon: Polygon) -> &[Side<D>] {
        &self.sides[polygon.first as usize..polygon.end as usize]
    }

    /// Rounded corners.
    pub(crate) fn points(&self, polygon: Polygon) -> Points<D> {
        self.sides(polygon).iter().map(|side| side.corner.x).collect()
    }

    /// On which side of a plane a polygon lies.
    pub(crate) fn place(
        &mut self,
        planes: &Planes<'_, D>,
        polygon: Polygon,
        by: Plane,
        half_space: &HalfSpace<D>,
    ) -> Place {
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
            (true, true) => Place::Both(self.divided(planes, polygon, by, half_space)),
        }
    }

    /// The parts behind a plane and in front of it, from the distances of the corners.
    fn divided(
        &mut self,
        planes: &Planes<'_, D>,
        polygon: Polygon,
        by: Plane,
        half_space: &HalfSpace<D>,
    ) -> [Polygon; 2] {
        let first = polygon.first as usize;
        let n = polygon.end as usize - first;
        // Corners after which a side crosses the plane: two of a convex polygon, one of a segment, which has one side.
        let mut crossings: SmallVec<[(usize, Corner<D>); 2]> = SmallVec::new();
        for k in 0..if D > 2 { n } else { n - 1 } {
            let ends = [k, if k + 1 < n { k + 1 } else { 0 }];
            let distances = ends.map(|end| self.distances[end]);
            if differ(distances[0], distances[1]) {
                let [a, b] = ends.map(|end| &self.sides[first + end].corner);
                let beyond = self.sides[first + k].beyond;
                let on = if D > 2 { [polygon.plane, beyond, by] } else { [polygon.plane, by, by] };
                crossings.push((
                    k,
                    planes.crossing([(a, distances[0]), (b, distances[1])], on, half_space, &mut self.known),
                ));
            }
        }
        [1.0, -1.0].map(|sign| {
            let start = self.sides.len();
            for k in 0..n {
                let side = self.sides[first + k];
                if sign * self.distances[k] <= 0.0 {
                    // A side that leaves the part on the plane goes on along the plane.
                    let next = sign * self.distances[if k + 1 < n { k + 1 } else { 0 }];
                    let leaves = self.distances[k] == 0.0 && next >= 0.0;
                    self.sides.push(Side { corner: side.corner, beyond: if leaves { by } else { side.beyond } });
                }
                if let Some((_, corner)) = crossings.iter().find(|crossing| crossing.0 == k) {
                    // Behind the crossing the part has either the rest of this side or the plane.
                    let leaves = sign * self.distances[k] < 0.0;
                    self.sides.push(Side { corner: *corner, beyond: if leaves { by } else { side.beyond } });
                }
            }
            Polygon { plane: polygon.plane, first: start as u32, end: self.sides.len() as u32 }
        })
    }
}

/// Where a polygon lies with respect to a plane.
pub(crate) enum Place {
    /// On the plane.
    On,
    /// Behind it.
    Behind,
    /// In front of it.
    Front,
    /// On both sides, with the parts behind and in front.
    Both([Polygon; 2]),
}

/// Points of a convex face, on the stack if they are few.
pub(crate) type Points<const D: usize> = SmallVec<[Point<D>; 8]>;

/// Whether two distances lie strictly on different sides.
#[inline]
pub(super) fn differ(a: f64, b: f64) -> bool {
    (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)
}

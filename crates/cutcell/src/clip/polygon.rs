//! Convex pieces of a plane: segments in 2D, polygons in 3D.

use mesh::Point;

use crate::exact::{Corner, Plane, Planes};

/// A convex piece of a plane with exact corners: a segment (2D), or a polygon that turns counter-clockwise around the
/// normal of the plane (3D), with the planes that bound its sides.
#[derive(Clone, Debug)]
pub(crate) struct Polygon<const D: usize> {
    pub(crate) plane: Plane,
    pub(crate) corners: Vec<Corner<D>>,
    /// The plane that meets this one in the side from corner `k` to the next; of no meaning in 2D.
    pub(crate) sides: Vec<Plane>,
}

impl<const D: usize> Polygon<D> {
    pub(crate) fn points(&self) -> Vec<Point<D>> {
        self.corners.iter().map(|corner| corner.x).collect()
    }

    /// What lies behind and in front of a plane. A polygon in the plane has neither.
    pub(crate) fn split(self, planes: &Planes<'_, D>, by: Plane) -> [Option<Self>; 2] {
        let half_space = planes.half_space(by);
        let sides: Vec<f64> = self.corners.iter().map(|corner| planes.side(corner, by, &half_space)).collect();
        match (sides.iter().any(|s| *s < 0.0), sides.iter().any(|s| *s > 0.0)) {
            (false, false) => [None, None],
            (true, false) => [Some(self), None],
            (false, true) => [None, Some(self)],
            (true, true) => {
                let crossings = Crossings::of_loop::<D>(&sides, |k, l| {
                    let on = match D {
                        2 => [self.plane, by, by],
                        _ => [self.plane, self.sides[k], by],
                    };
                    planes.crossing([(&self.corners[k], sides[k]), (&self.corners[l], sides[l])], on, &half_space)
                });
                [1.0, -1.0].map(|sign| {
                    let mut part = Self { plane: self.plane, corners: Vec::new(), sides: Vec::new() };
                    let mut on_cut = Vec::new();
                    for_each_kept::<D>(&sides, sign, |kept| {
                        let (corner, side, is_on_cut) = match kept {
                            Kept::Corner(k) => (self.corners[k], k, sides[k] == 0.0),
                            Kept::Crossing(k) => (crossings.at(k), k, true),
                        };
                        part.corners.push(corner);
                        part.sides.push(self.sides.get(side).copied().unwrap_or(by));
                        on_cut.push(is_on_cut);
                    });
                    let n = on_cut.len();
                    for k in 0..n {
                        if on_cut[k] && on_cut[(k + 1) % n] {
                            part.sides[k] = by;
                        }
                    }
                    Some(part)
                })
            }
        }
    }
}

/// Corners where the sides of one polygon cross a plane.
struct Crossings<const D: usize>(Vec<(usize, Corner<D>)>);

impl<const D: usize> Crossings<D> {
    fn of_loop<const E: usize>(sides: &[f64], crossing: impl Fn(usize, usize) -> Corner<D>) -> Self {
        let n = sides.len();
        let n_sides = if E == 2 { 1 } else { n };
        let crossed = (0..n_sides).map(|k| (k, (k + 1) % n)).filter(|&(k, l)| differ(sides[k], sides[l]));
        Self(crossed.map(|(k, l)| (k, crossing(k, l))).collect())
    }

    fn at(&self, side: usize) -> Corner<D> {
        let found = self.0.iter().find(|crossing| crossing.0 == side);
        found.unwrap_or(&self.0[0]).1
    }
}

/// What stays of a loop of corners on one side of a plane.
#[derive(Clone, Copy)]
pub(super) enum Kept {
    /// A corner.
    Corner(usize),
    /// Where the side from that corner to the next crosses the plane.
    Crossing(usize),
}

/// Walks around a loop (along a segment in 2D) and visits what lies on the side of `sign`, 1 for behind, and on the
/// plane itself.
#[inline]
pub(super) fn for_each_kept<const D: usize>(sides: &[f64], sign: f64, mut visit: impl FnMut(Kept)) {
    let n = sides.len();
    for k in 0..n {
        if sign * sides[k] <= 0.0 {
            visit(Kept::Corner(k));
        }
        if (D > 2 || k + 1 < n) && differ(sides[k], sides[(k + 1) % n]) {
            visit(Kept::Crossing(k));
        }
    }
}

/// Whether two distances lie strictly on different sides.
#[inline]
pub(super) fn differ(a: f64, b: f64) -> bool {
    (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)
}

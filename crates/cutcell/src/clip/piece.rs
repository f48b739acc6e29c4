//! Convex pieces of a cell with exact corners, and their division by planes.

use mesh::Point;
use smallvec::SmallVec;

use super::polygon::{Polygon, Polygons, Side, differ};
use super::polytope::{FaceLabel, Polytopes};
use crate::exact::{Corner, Plane, PlaneKind, Planes, signed_volume};

/// A convex polygon (D = 2) or polyhedron (D = 3) whose corners are exact.
///
/// Faces are loops of corners: edges from one corner to the next with the inside on the left (2D), polygons that turn
/// counter-clockwise as seen from outside (3D).
#[derive(Clone, Debug, Default)]
pub(crate) struct Piece<const D: usize> {
    pub(crate) corners: Vec<Corner<D>>,
    /// Plane of each face, and the end of its loop.
    faces: Vec<(Plane, u32)>,
    /// Corners of the faces, each with the plane beyond the edge to the next corner.
    loops: Vec<(u32, Plane)>,
}

impl<const D: usize> Piece<D> {
    fn clear(&mut self) {
        self.corners.clear();
        self.faces.clear();
        self.loops.clear();
    }

    /// Sets this to a positively oriented simplex with the given planes of its faces; face `i` is opposite to point
    /// `i`.
    pub(crate) fn set_simplex(&mut self, points: &[Point<D>], planes: [Plane; 4]) {
        self.clear();
        let others = |i: usize| (0..=D).filter(move |&k| k != i);
        for (i, &x) in points.iter().enumerate() {
            let mut on = [planes[i]; 3];
            for (slot, k) in on.iter_mut().zip(others(i)) {
                *slot = planes[k];
            }
            self.corners.push(Corner::of_mesh(x, on));
        }
        for opposite in 0..=D {
            let mut corners = [0; 3];
            for (slot, k) in corners.iter_mut().zip(others(opposite)) {
                *slot = k;
            }
            if opposite % 2 == 1 {
                corners.swap(0, 1);
            }
            for k in 0..D {
                // The edge from `k` to the next corner of a triangle lies opposite to the remaining corner.
                self.loops.push((corners[k] as u32, planes[corners[(k + 2) % 3]]));
            }
            self.close_face(planes[opposite]);
        }
    }

    /// Ends a face: its loop consists of the entries since the last face.
    fn close_face(&mut self, plane: Plane) {
        self.faces.push((plane, self.loops.len() as u32));
    }

    pub(crate) fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// Returns the plane and loop of a face.
    #[inline]
    fn loop_of(&self, face: usize) -> Face<'_> {
        let start = if face == 0 { 0 } else { self.faces[face - 1].1 as usize };
        let (plane, end) = self.faces[face];
        (plane, &self.loops[start..end as usize])
    }

    pub(crate) fn plane(&self, face: usize) -> Plane {
        self.faces[face].0
    }

    /// Returns the sides of a face.
    pub(crate) fn face(&self, face: usize) -> impl Iterator<Item = Side<D>> + '_ {
        let (_, corners) = self.loop_of(face);
        corners.iter().map(|&(corner, beyond)| Side { corner: self.corners[corner as usize], beyond })
    }

    /// Divides the piece by a plane into the parts behind it and in front of it; returns the section, a polygon on the
    /// plane. Returns `None`, without parts, if one of them would be empty.
    pub(crate) fn split(
        &self,
        planes: &Planes<'_, D>,
        by: Plane,
        polygons: &mut Polygons<D>,
        parts: [&mut Self; 2],
    ) -> Option<Polygon> {
        let half_space = planes.half_space(by);
        let mut distances = Distances::new();
        let (mut is_behind, mut is_in_front) = (false, false);
        for corner in &self.corners {
            let distance = planes.side(corner, by, &half_space, &mut polygons.known);
            is_behind |= distance < 0.0;
            is_in_front |= distance > 0.0;
            distances.push(distance);
        }
        if !(is_behind && is_in_front) {
            return None;
        }
        let crossings = self.crossings(&distances, |plane, a, b, side| {
            let on = if D == 2 { [plane, by, by] } else { [plane, side, by] };
            planes.crossing([a, b].map(|k| (&self.corners[k], distances[k])), on, &half_space, &mut polygons.known)
        });
        let [behind, front] = parts;
        self.divide(&distances, by, &crossings, [&mut *behind, front]);
        Some(polygons.push(by, behind.face(behind.n_faces() - 1)))
    }

    /// Returns the corners at which edges cross a plane. `crossing` is called once per edge with the plane of a face,
    /// the two ends of the edge, and the plane beyond the edge.
    fn crossings(
        &self,
        distances: &[f64],
        mut crossing: impl FnMut(Plane, usize, usize, Plane) -> Corner<D>,
    ) -> EdgeCrossings<D> {
        let mut crossings = EdgeCrossings::new();
        for face in 0..self.n_faces() {
            let (plane, corners) = self.loop_of(face);
            for k in 0..if D == 2 { 1 } else { corners.len() } {
                let ((a, side), (b, _)) = (corners[k], corners[if k + 1 < corners.len() { k + 1 } else { 0 }]);
                // In 3D, every edge belongs to two faces, in opposite directions.
                if (D == 2 || a < b) && differ(distances[a as usize], distances[b as usize]) {
                    crossings.push(([a.min(b), a.max(b)], crossing(plane, a as usize, b as usize, side)));
                }
            }
        }
        crossings
    }

    /// Fills the parts behind and in front of a plane. Their last face is the one on the plane.
    fn divide(&self, distances: &[f64], by: Plane, crossings: &EdgeCrossings<D>, mut parts: [&mut Self; 2]) {
        let corners = self.divide_corners(distances, crossings, &mut parts);
        let corners = Divided { corners: &corners, crossings };
        let mut sections = [SectionEdges::new(), SectionEdges::new()];
        for face in 0..self.n_faces() {
            let face = self.loop_of(face);
            let (lowest, highest) = corners.range(face.1);
            if lowest < 0 && highest > 0 {
                let [exit, entry] = corners.meetings(face.1);
                parts[0].add_crossed(0, face, &corners, [&entry, &exit], by, &mut sections[0]);
                parts[1].add_crossed(1, face, &corners, [&exit, &entry], by, &mut sections[1]);
            } else if lowest < 0 {
                parts[0].add_uncrossed(0, face, &corners, by, &mut sections[0]);
            } else if highest > 0 {
                parts[1].add_uncrossed(1, face, &corners, by, &mut sections[1]);
            }
        }
        for (part, section) in parts.into_iter().zip(sections) {
            part.close(section, by);
        }
    }

    /// Fills the corners of the parts behind and in front of a plane, crossings last.
    fn divide_corners(
        &self,
        distances: &[f64],
        crossings: &[Crossing<D>],
        parts: &mut [&mut Self; 2],
    ) -> SmallVec<[DividedCorner; 32]> {
        parts.iter_mut().for_each(|part| part.clear());
        let divide = |(corner, &distance): (&Corner<D>, &f64)| {
            let numbers = [0, 1].map(|side: usize| parts[side].corners.len() as u32);
            if distance <= 0.0 {
                parts[0].corners.push(*corner);
            }
            if distance >= 0.0 {
                parts[1].corners.push(*corner);
            }
            DividedCorner { side: i8::from(distance > 0.0) - i8::from(distance < 0.0), numbers }
        };
        let mut divided: SmallVec<[DividedCorner; 32]> = self.corners.iter().zip(distances).map(divide).collect();
        let numbers = [0, 1].map(|side: usize| parts[side].corners.len() as u32);
        divided.extend((0..crossings.len() as u32).map(|k| DividedCorner { side: 0, numbers: numbers.map(|n| n + k) }));
        for part in parts {
            part.corners.extend(crossings.iter().map(|crossing| crossing.1));
        }
        divided
    }

    /// Adds the part on one side (0 behind, 1 in front) of a face that crosses the plane. The loop of the face enters
    /// this side at the first and leaves it at the second of the given meetings.
    fn add_crossed(
        &mut self,
        side: usize,
        (plane, rim): Face<'_>,
        corners: &Divided<'_, D>,
        [from, to]: [&Meeting; 2],
        by: Plane,
        section: &mut SectionEdges,
    ) {
        let [first, last] = [from, to].map(|meeting| meeting.numbers[side]);
        if D > 2 {
            self.loops.push((first, from.beyond));
            let mut k = from.after;
            loop {
                self.loops.push((corners.of(rim[k].0).numbers[side], rim[k].1));
                if k == to.before {
                    break;
                }
                k = following(rim, k);
            }
            self.loops.push((last, by));
            section.push((first, last, plane));
        } else if from.after == 1 {
            // The edge begins on the other side.
            self.loops.extend([(first, by), (corners.of(rim[1].0).numbers[side], by)]);
            section.push((first, 0, plane));
        } else {
            self.loops.extend([(corners.of(rim[0].0).numbers[side], by), (last, by)]);
            section.push((last, 1, plane));
        }
        self.close_face(plane);
    }

    /// Adds a face on one side of the plane, which may have an edge (a point in 2D) on the plane.
    fn add_uncrossed(
        &mut self,
        side: usize,
        (plane, rim): Face<'_>,
        corners: &Divided<'_, D>,
        by: Plane,
        section: &mut SectionEdges,
    ) {
        let start = self.loops.len();
        self.loops.extend(rim.iter().map(|&(corner, beyond)| (corners.of(corner).numbers[side], beyond)));
        self.close_face(plane);
        for (k, &(corner, _)) in rim.iter().enumerate() {
            let next = following(rim, k);
            if corners.of(corner).side != 0 {
                continue;
            }
            if D == 2 {
                section.push((self.loops[start + k].0, k as u32, plane));
            } else if corners.of(rim[next].0).side == 0 {
                self.loops[start + k].1 = by;
                section.push((self.loops[start + next].0, self.loops[start + k].0, plane));
            }
        }
    }

    /// Adds the face on the dividing plane. In 3D `section` has the edges of the face (from, to, plane beyond). In 2D
    /// `section` has the two ends of the face; the second number is 1 for the end at which the loop begins.
    fn close(&mut self, mut section: SectionEdges, by: Plane) {
        if D == 2 {
            section.sort_by_key(|end| std::cmp::Reverse(end.1));
        } else {
            // Sorts the edges into a loop.
            for k in 1..section.len() {
                let at = section[k - 1].1;
                if let Some(next) = (k..section.len()).find(|&l| section[l].0 == at) {
                    section.swap(k, next);
                }
            }
        }
        self.loops.extend(section.iter().map(|&(corner, _, side)| (corner, side)));
        self.close_face(by);
    }

    /// Returns the volume (area in 2D). Simplices of a volume below `doubt`, the bound of round-off, are evaluated
    /// exactly; inverted simplices are left out.
    pub(crate) fn volume(&self, doubt: f64) -> f64 {
        let mut volume = 0.0;
        self.for_each_simplex(|points| volume += signed_volume(points, doubt).max(0.0));
        volume
    }

    /// Returns the measure of the surface.
    pub(crate) fn surface(&self) -> f64 {
        (0..self.n_faces()).map(|face| self.face_measure(face)).sum()
    }

    /// Returns the face on a plane, if any.
    pub(crate) fn face_on(&self, plane: Plane) -> Option<usize> {
        self.faces.iter().position(|face| face.0 == plane)
    }

    pub(crate) fn face_measure(&self, face: usize) -> f64 {
        let x = |(k, _): (u32, Plane)| self.corners[k as usize].x;
        let (_, corners) = self.loop_of(face);
        if D == 2 {
            return (x(corners[1]) - x(corners[0])).norm();
        }
        corners[1..].windows(2).map(|pair| mesh::simplex_measure(&[x(corners[0]), x(pair[0]), x(pair[1])])).sum()
    }

    /// Returns the mean of the corners.
    pub(crate) fn inner_point(&self) -> Point<D> {
        self.corners.iter().map(|corner| corner.x).sum::<Point<D>>() / self.corners.len() as f64
    }

    fn for_each_simplex(&self, mut visit: impl FnMut(&[Point<D>])) {
        let mut simplex = [self.corners[0].x; 4];
        for face in 0..self.n_faces() {
            let (_, corners) = self.loop_of(face);
            if corners.iter().any(|corner| corner.0 == 0) || corners.len() < D {
                continue;
            }
            simplex[1] = self.corners[corners[0].0 as usize].x;
            for k in 1..=corners.len() + 1 - D {
                for j in 0..D - 1 {
                    simplex[2 + j] = self.corners[corners[k + j].0 as usize].x;
                }
                visit(&simplex[..=D]);
            }
        }
    }

    /// Appends the piece with rounded corners to `polytopes`. `cell_facets` are the facets of its cell.
    pub(crate) fn round_into(&self, polytopes: &mut Polytopes<D>, cell_facets: &[mesh::FacetId]) {
        let label = |plane: Plane| match plane.kind() {
            PlaneKind::Facet(facet) | PlaneKind::Rim(facet, _) => FaceLabel::Facet(facet),
            PlaneKind::Mesh(id) => FaceLabel::Cell(cell_facets.iter().position(|&f| f == id).unwrap_or(0) as u8),
        };
        polytopes.push(
            self.corners.iter().map(|corner| corner.x),
            self.faces.iter().map(|&(plane, end)| (label(plane), end)),
            self.loops.iter().map(|corner| corner.0),
        );
    }
}

/// Plane and loop of a face.
type Face<'a> = (Plane, &'a [(u32, Plane)]);
/// Signed distances of the corners from a plane, with exact signs.
type Distances = SmallVec<[f64; 32]>;
/// A crossed edge, and the corner on it.
type Crossing<const D: usize> = ([u32; 2], Corner<D>);
type EdgeCrossings<const D: usize> = SmallVec<[Crossing<D>; 8]>;
/// Sides of the face on a dividing plane, see [`Piece::close`].
type SectionEdges = SmallVec<[(u32, u32, Plane); 16]>;

/// A corner of a piece that a plane divides.
#[derive(Clone, Copy)]
struct DividedCorner {
    /// -1 behind the plane, 0 on it, 1 in front of it.
    side: i8,
    /// Indices in the parts behind and in front. The index in a part without the corner is not used.
    numbers: [u32; 2],
}

/// Corners of a divided piece, followed by the crossings.
struct Divided<'a, const D: usize> {
    corners: &'a [DividedCorner],
    crossings: &'a [Crossing<D>],
}

/// The point at which the loop of a face meets a plane on the way to the other side.
struct Meeting {
    numbers: [u32; 2],
    /// Plane beyond the edge that begins at the point.
    beyond: Plane,
    /// Positions in the loop of the last corner on this side, and of the first one on the other.
    before: usize,
    after: usize,
}

impl<const D: usize> Divided<'_, D> {
    fn of(&self, corner: u32) -> &DividedCorner {
        &self.corners[corner as usize]
    }

    /// Returns the lowest and the highest side on which a loop has corners.
    fn range(&self, rim: &[(u32, Plane)]) -> (i8, i8) {
        rim.iter().fold((1, -1), |(lowest, highest), corner| {
            let side = self.of(corner.0).side;
            (side.min(lowest), side.max(highest))
        })
    }

    /// Returns the points at which a loop leaves the side behind the plane and the side in front of it.
    fn meetings(&self, rim: &[(u32, Plane)]) -> [Meeting; 2] {
        let side = |k: usize| self.of(rim[k].0).side;
        [-1, 1].map(|from| {
            let leaves = |&k: &usize| side(k) == from && side(following(rim, k)) != from;
            let before = (0..rim.len()).find(leaves).unwrap_or(0);
            let next = following(rim, before);
            let ((a, beyond), (b, beyond_next)) = (rim[before], rim[next]);
            if side(next) == 0 {
                let numbers = self.of(b).numbers;
                return Meeting { numbers, beyond: beyond_next, before, after: following(rim, next) };
            }
            let edge = [a.min(b), a.max(b)];
            let crossing = self.crossings.iter().position(|crossing| crossing.0 == edge).unwrap_or(0);
            let numbers = self.corners[self.corners.len() - self.crossings.len() + crossing].numbers;
            Meeting { numbers, beyond, before, after: next }
        })
    }
}

/// Returns the position after `k` in a loop.
fn following(rim: &[(u32, Plane)], k: usize) -> usize {
    if k + 1 < rim.len() { k + 1 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::Plane;

    impl<const D: usize> Piece<D> {
        /// Returns the part behind a plane, from the signed distances of the corners, with rounding.
        fn behind(&self, distances: &[f64]) -> Self {
            let by = self.faces[0].0;
            let crossings = self.crossings(distances, |_, a, b, _| {
                let (x, y) = (self.corners[a].x, self.corners[b].x);
                Corner::of_mesh(x + (y - x) * (distances[a] / (distances[a] - distances[b])), [by; 3])
            });
            let [mut behind, mut front] = [Self::default(), Self::default()];
            self.divide(distances, by, &crossings, [&mut behind, &mut front]);
            behind
        }
    }

    /// Divides a simplex repeatedly; checks that the pieces fill it and are closed by their faces.
    fn check_division<const D: usize>() {
        let mut corners = vec![Point::<D>::zeros()];
        corners.extend((0..D).map(|k| Point::<D>::from_fn(|i, _| f64::from(u8::from(i == k)))));
        let mut simplex = Piece::default();
        simplex.set_simplex(&corners, [Plane::facet(0); 4]);
        let mut pieces = vec![simplex];
        let volume = pieces[0].volume(0.0);
        for step in 0..6 {
            let normal = Point::<D>::from_fn(|k, _| ((1 + step * D + k) as f64 * 1.7).sin()).normalize();
            let at = Point::<D>::repeat(0.2 + 0.02 * step as f64);
            let divide = |piece: &Piece<D>| {
                let distances: Vec<f64> = piece.corners.iter().map(|c| normal.dot(&(c.x - at))).collect();
                let opposite: Vec<f64> = distances.iter().map(|d| -d).collect();
                if distances.iter().any(|d| *d > 0.0) && distances.iter().any(|d| *d < 0.0) {
                    vec![piece.behind(&distances), piece.behind(&opposite)]
                } else {
                    vec![piece.clone()]
                }
            };
            pieces = pieces.iter().flat_map(divide).collect();
        }
        assert!(pieces.len() > 6);
        assert!(pieces.iter().all(|piece| piece.volume(0.0) > 0.0));
        let sum: f64 = pieces.iter().map(|piece| piece.volume(0.0)).sum();
        assert!((sum - volume).abs() < 1e-14, "{sum} {volume}");
        for piece in &pieces {
            // The cones over the faces from any point, with signs, make up the piece only if the faces close it.
            let mut polytopes = Polytopes::default();
            piece.round_into(&mut polytopes, &[]);
            let rounded = polytopes.get(0);
            let apex = Point::<D>::repeat(7.0);
            let mut cones = 0.0;
            for (_, face) in rounded.faces() {
                for k in 1..=face.len() + 1 - D {
                    let mut simplex = vec![apex, rounded.points()[face[0] as usize]];
                    simplex.extend(face[k..k + D - 1].iter().map(|&c| rounded.points()[c as usize]));
                    cones += mesh::Simplex::new(&simplex).volume();
                }
            }
            assert!((cones - rounded.volume()).abs() < 1e-13, "{cones} {}", rounded.volume());
        }
    }

    #[test]
    fn division_keeps_the_volume_in_2d_and_3d() {
        check_division::<2>();
        check_division::<3>();
    }
}

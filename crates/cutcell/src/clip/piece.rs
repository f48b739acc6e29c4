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
    /// The plane of each face, and where its loop ends.
    faces: Vec<(Plane, u32)>,
    /// Corners of the faces, with the plane of the face on the other side of the edge to the next one.
    loops: Vec<(u32, Plane)>,
}

impl<const D: usize> Piece<D> {
    fn clear(&mut self) {
        self.corners.clear();
        self.faces.clear();
        self.loops.clear();
    }

    /// Becomes a positively oriented simplex with the planes of its faces, face `i` opposite to point `i`.
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

    /// What was added to the loops since the last face is a face.
    fn close_face(&mut self, plane: Plane) {
        self.faces.push((plane, self.loops.len() as u32));
    }

    pub(crate) fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// The plane of a face and its loop.
    #[inline]
    fn loop_of(&self, face: usize) -> (Plane, &[(u32, Plane)]) {
        let start = if face == 0 { 0 } else { self.faces[face - 1].1 as usize };
        let (plane, end) = self.faces[face];
        (plane, &self.loops[start..end as usize])
    }

    pub(crate) fn plane(&self, face: usize) -> Plane {
        self.faces[face].0
    }

    /// A face as the sides of a polygon of its plane.
    pub(crate) fn face(&self, face: usize) -> impl Iterator<Item = Side<D>> + '_ {
        let (_, corners) = self.loop_of(face);
        corners.iter().map(|&(corner, beyond)| Side { corner: self.corners[corner as usize], beyond })
    }

    /// Divides by a plane into the parts behind it and in front of it; gives the section, a polygon on the plane.
    /// `None`, and no parts, if one of them is empty.
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
        self.half(&distances, 1.0, by, &crossings, behind);
        self.half(&distances, -1.0, by, &crossings, front);
        Some(polygons.push(by, behind.face(behind.n_faces() - 1)))
    }

    /// The part behind a plane, from the signed distances of the corners, with rounding only.
    pub(crate) fn behind(&self, distances: &[f64]) -> Self {
        let crossings = self.crossings(distances, |_, a, b, _| {
            let (x, y) = (self.corners[a].x, self.corners[b].x);
            Corner::of_mesh(x + (y - x) * (distances[a] / (distances[a] - distances[b])), [self.faces[0].0; 3])
        });
        let mut behind = Self::default();
        self.half(distances, 1.0, self.faces[0].0, &crossings, &mut behind);
        behind
    }

    /// Corners where the edges cross a plane, each once. `crossing` takes the plane of a face, the two ends of an edge of
    /// it, and the plane of the face beyond the edge.
    fn crossings(
        &self,
        distances: &[f64],
        mut crossing: impl FnMut(Plane, usize, usize, Plane) -> Corner<D>,
    ) -> Crossings<D> {
        let mut crossings = Crossings::new();
        for face in 0..self.n_faces() {
            let (plane, corners) = self.loop_of(face);
            for k in 0..if D == 2 { 1 } else { corners.len() } {
                let ((a, side), (b, _)) = (corners[k], corners[if k + 1 < corners.len() { k + 1 } else { 0 }]);
                // In 3D every edge belongs to two faces, once in either direction.
                if (D == 2 || a < b) && differ(distances[a as usize], distances[b as usize]) {
                    crossings.push(([a.min(b), a.max(b)], crossing(plane, a as usize, b as usize, side)));
                }
            }
        }
        crossings
    }

    /// The part on one side (`sign` 1: behind) of a plane, its face on the plane the last one.
    fn half(&self, distances: &[f64], sign: f64, by: Plane, crossings: &Crossings<D>, half: &mut Self) {
        half.clear();
        // Numbers in the half; those of corners beyond the plane are never used.
        half.corners.reserve(self.corners.len() + crossings.len());
        let mut number = |(corner, &distance): (&Corner<D>, &f64)| {
            let number = half.corners.len() as u32;
            if sign * distance <= 0.0 {
                half.corners.push(*corner);
            }
            number
        };
        let numbers: SmallVec<[u32; 32]> = self.corners.iter().zip(distances).map(&mut number).collect();
        let first_crossing = half.corners.len() as u32;
        half.corners.extend(crossings.iter().map(|crossing| crossing.1));
        half.loops.reserve(self.loops.len() + 3 * crossings.len());
        let mut section = Section::new();
        for face in 0..self.n_faces() {
            let (plane, corners) = self.loop_of(face);
            let (mut is_within, mut is_beyond) = (true, true);
            for &(k, _) in corners {
                let outwards = sign * distances[k as usize];
                is_within &= outwards < 0.0;
                is_beyond &= outwards >= 0.0;
            }
            if is_beyond {
                continue;
            }
            if is_within {
                half.loops.extend(corners.iter().map(|&(k, side)| (numbers[k as usize], side)));
                half.close_face(plane);
                continue;
            }
            let (start, n) = (half.loops.len(), corners.len());
            let n_sides = section.len();
            let mut keep = |number: u32, side: Plane, leaves: bool| {
                if leaves && D > 2 {
                    section.push((half.loops.len() as u32, number, plane));
                }
                half.loops.push((number, if leaves { by } else { side }));
            };
            for k in 0..n {
                let ((a, side), (b, _)) = (corners[k], corners[if k + 1 < n { k + 1 } else { 0 }]);
                let (at, next) = (sign * distances[a as usize], sign * distances[b as usize]);
                // A loop that leaves the half goes on along the plane.
                if at <= 0.0 {
                    keep(numbers[a as usize], side, at == 0.0 && next >= 0.0);
                }
                if (D > 2 || k + 1 < n) && differ(at, next) {
                    let edge = [a.min(b), a.max(b)];
                    let crossing = crossings.iter().position(|crossing| crossing.0 == edge).unwrap_or(0);
                    keep(first_crossing + crossing as u32, side, at < 0.0);
                }
            }
            if D == 2 {
                // The half enters the plane where this edge ends, and leaves it where this edge begins.
                let ends = (0..n).filter(|&k| sign * distances[corners[k].0 as usize] >= 0.0);
                section.extend(ends.map(|k| (half.loops[start + k].0, k as u32, plane)));
            } else {
                // So far the sides of the section start at positions in the loop, not at corners.
                let next = |k: u32| if k as usize + 1 < half.loops.len() { k as usize + 1 } else { start };
                section[n_sides..].iter_mut().for_each(|side| side.0 = half.loops[next(side.0)].0);
            }
            half.close_face(plane);
        }
        half.close(section, by);
    }

    /// Adds the face on a plane from its sides: in 3D edges (from, to, plane beyond), in 2D its two ends, the first one
    /// marked with 1.
    fn close(&mut self, mut section: Section, by: Plane) {
        if D == 2 {
            section.sort_by_key(|end| std::cmp::Reverse(end.1));
        } else {
            // Chain the edges.
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

    /// Volume (area in 2D), of simplices with no more round-off than `doubt` or exact ones. Those that are inside out count
    /// nothing.
    pub(crate) fn volume(&self, doubt: f64) -> f64 {
        let mut volume = 0.0;
        self.for_each_simplex(|points| volume += signed_volume(points, doubt).max(0.0));
        volume
    }

    /// Measure of the surface.
    pub(crate) fn surface(&self) -> f64 {
        (0..self.n_faces()).map(|face| self.face_measure(face)).sum()
    }

    /// Measure of the face on a plane, if there is one.
    pub(crate) fn measure_on(&self, plane: Plane) -> Option<f64> {
        let face = self.faces.iter().position(|face| face.0 == plane)?;
        Some(self.face_measure(face))
    }

    fn face_measure(&self, face: usize) -> f64 {
        let x = |(k, _): (u32, Plane)| self.corners[k as usize].x;
        let (_, corners) = self.loop_of(face);
        if D == 2 {
            return (x(corners[1]) - x(corners[0])).norm();
        }
        corners[1..].windows(2).map(|pair| mesh::simplex_measure(&[x(corners[0]), x(pair[0]), x(pair[1])])).sum()
    }

    /// Mean of the corners.
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

    /// Adds the piece with rounded corners, faces labelled for the cell with the given facets.
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

/// Signed distances of the corners from a plane, with exact signs.
type Distances = SmallVec<[f64; 32]>;
/// Crossed edges with the corners on them.
type Crossings<const D: usize> = SmallVec<[([u32; 2], Corner<D>); 8]>;
/// Sides of the face on a dividing plane while it is put together.
type Section = SmallVec<[(u32, u32, Plane); 16]>;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::Plane;

    /// Divides a simplex again and again; the pieces fill it, and their faces close them.
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
    fn division_keeps_the_volume_in_2d() {
        check_division::<2>();
    }

    #[test]
    fn division_keeps_the_volume_in_3d() {
        check_division::<3>();
    }
}

//! Convex pieces of a cell with exact corners, and their division by planes.

use mesh::Point;

use super::polygon::{Kept, Polygon, differ, for_each_kept};
use super::polytope::{FaceLabel, Polytope};
use crate::exact::{Corner, Plane, PlaneKind, Planes};

/// A convex polygon (D = 2) or polyhedron (D = 3) whose corners are exact.
///
/// Faces are loops of corners: edges from one corner to the next with the inside on the left (2D), polygons that turn
/// counter-clockwise as seen from outside (3D).
#[derive(Clone, Debug)]
pub(crate) struct Piece<const D: usize> {
    pub(crate) corners: Vec<Corner<D>>,
    /// The plane of each face.
    labels: Vec<Plane>,
    offsets: Vec<u32>,
    loops: Vec<u32>,
    /// The plane of the face on the other side of the edge from each entry of `loops` to the next one.
    sides: Vec<Plane>,
}

impl<const D: usize> Piece<D> {
    /// A positively oriented simplex with the planes of its faces, face `i` opposite to point `i`.
    pub(crate) fn simplex(points: &[Point<D>], faces: [Plane; 4]) -> Self {
        let others = |i: usize| (0..=D).filter(move |&k| k != i);
        let corner = |i: usize| {
            let mut on = [faces[i]; 3];
            for (slot, k) in on.iter_mut().zip(others(i)) {
                *slot = faces[k];
            }
            Corner::of_mesh(points[i], on)
        };
        let mut piece = Self {
            corners: (0..=D).map(corner).collect(),
            labels: Vec::new(),
            offsets: Vec::new(),
            loops: Vec::new(),
            sides: Vec::new(),
        };
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
                piece.loops.push(corners[k] as u32);
                piece.sides.push(faces[corners[(k + 2) % 3]]);
            }
            piece.close_face(faces[opposite]);
        }
        piece
    }

    fn with_room_for(n_corners: usize, n_faces: usize, n_loops: usize) -> Self {
        Self {
            corners: Vec::with_capacity(n_corners),
            labels: Vec::with_capacity(n_faces),
            offsets: Vec::with_capacity(n_faces),
            loops: Vec::with_capacity(n_loops),
            sides: Vec::with_capacity(n_loops),
        }
    }

    /// What was added to the loops since the last face is a face.
    fn close_face(&mut self, label: Plane) {
        self.labels.push(label);
        self.offsets.push(self.loops.len() as u32);
    }

    pub(crate) fn n_faces(&self) -> usize {
        self.labels.len()
    }

    fn range(&self, face: usize) -> std::ops::Range<usize> {
        let start = if face == 0 { 0 } else { self.offsets[face - 1] as usize };
        start..self.offsets[face] as usize
    }

    pub(crate) fn label(&self, face: usize) -> Plane {
        self.labels[face]
    }

    /// A face as a polygon of its plane.
    pub(crate) fn face(&self, face: usize) -> Polygon<D> {
        let range = self.range(face);
        Polygon {
            plane: self.labels[face],
            corners: self.loops[range.clone()].iter().map(|&k| self.corners[k as usize]).collect(),
            sides: self.sides[range].to_vec(),
        }
    }

    /// Divides by a plane into the parts behind it and in front of it; also gives the section, a polygon on the plane.
    /// `None` if one of the parts is empty.
    pub(crate) fn split(&self, planes: &Planes<'_, D>, by: Plane) -> Option<([Self; 2], Polygon<D>)> {
        let half_space = planes.half_space(by);
        let sides: Vec<f64> = self.corners.iter().map(|corner| planes.side(corner, by, &half_space)).collect();
        if !(sides.iter().any(|s| *s < 0.0) && sides.iter().any(|s| *s > 0.0)) {
            return None;
        }
        let crossing = |face: usize, a: usize, b: usize, side: Plane| {
            let on = if D == 2 { [self.labels[face], by, by] } else { [self.labels[face], side, by] };
            let at = |k: usize| (&self.corners[k], sides[k]);
            planes.crossing([at(a), at(b)], on, &half_space)
        };
        let crossings = self.crossings(&sides, crossing);
        let (behind, section) = self.half(&sides, 1.0, by, &crossings);
        let (front, _) = self.half(&sides, -1.0, by, &crossings);
        Some(([behind, front], section))
    }

    /// The part behind a plane, from the signed distances of the corners, with rounding only.
    pub(crate) fn behind(&self, distances: &[f64]) -> Self {
        let crossings = self.crossings(distances, |_, a, b, _| {
            let (x, y) = (self.corners[a].x, self.corners[b].x);
            Corner::of_mesh(x + (y - x) * (distances[a] / (distances[a] - distances[b])), [self.labels[0]; 3])
        });
        self.half(distances, 1.0, self.labels[0], &crossings).0
    }

    /// Corners where the edges cross a plane, each once, with the two ends.
    fn crossings(
        &self,
        distances: &[f64],
        crossing: impl Fn(usize, usize, usize, Plane) -> Corner<D>,
    ) -> Vec<(u32, u32, Corner<D>)> {
        let mut crossings = Vec::new();
        for face in 0..self.n_faces() {
            let range = self.range(face);
            let corners = &self.loops[range.clone()];
            for k in 0..if D == 2 { 1 } else { corners.len() } {
                let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
                // In 3D every edge belongs to two faces, once in either direction.
                if (D == 2 || a < b) && differ(distances[a as usize], distances[b as usize]) {
                    let side = self.sides[range.start + k];
                    crossings.push((a.min(b), a.max(b), crossing(face, a as usize, b as usize, side)));
                }
            }
        }
        crossings
    }

    /// The part on one side (`sign` 1: behind) of a plane, and its face on the plane.
    fn half(&self, distances: &[f64], sign: f64, by: Plane, crossings: &[(u32, u32, Corner<D>)]) -> (Self, Polygon<D>) {
        let mut half = Self::with_room_for(
            self.corners.len() + crossings.len(),
            self.n_faces() + 1,
            self.loops.len() + 3 * crossings.len(),
        );
        // New numbers of old corners, then of crossings.
        let mut numbers = vec![u32::MAX; self.corners.len() + crossings.len()];
        let mut section: Vec<(u32, u32, Plane)> = Vec::with_capacity(crossings.len() + 2);
        let mut on_plane = Vec::new();
        let mut values = Vec::new();
        for face in 0..self.n_faces() {
            let range = self.range(face);
            let (corners, sides) = (&self.loops[range.clone()], &self.sides[range]);
            values.clear();
            values.extend(corners.iter().map(|&k| distances[k as usize]));
            if values.iter().all(|v| sign * v >= 0.0) {
                continue;
            }
            let start = half.loops.len();
            on_plane.clear();
            for_each_kept::<D>(&values, sign, |kept| {
                let (old, k) = match kept {
                    Kept::Corner(k) => (corners[k] as usize, k),
                    Kept::Crossing(k) => {
                        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
                        let ends = (a.min(b), a.max(b));
                        let found = crossings.iter().position(|c| (c.0, c.1) == ends).unwrap_or(0);
                        (self.corners.len() + found, k)
                    }
                };
                if numbers[old] == u32::MAX {
                    numbers[old] = half.corners.len() as u32;
                    half.corners.push(match old.checked_sub(self.corners.len()) {
                        None => self.corners[old],
                        Some(found) => crossings[found].2,
                    });
                }
                half.loops.push(numbers[old]);
                half.sides.push(sides[k]);
                on_plane.push(old >= self.corners.len() || distances[old] == 0.0);
            });
            let label = self.labels[face];
            let n = on_plane.len();
            if D == 2 {
                // The half enters the plane where this edge ends, and leaves it where this edge begins.
                for k in (0..n).filter(|&k| on_plane[k]) {
                    section.push((half.loops[start + k], k as u32, label));
                }
            } else {
                for k in (0..n).filter(|&k| on_plane[k] && on_plane[(k + 1) % n]) {
                    half.sides[start + k] = by;
                    section.push((half.loops[start + (k + 1) % n], half.loops[start + k], label));
                }
            }
            half.close_face(label);
        }
        let polygon = half.close(section, by);
        (half, polygon)
    }

    /// Adds the face on a plane from its sides: in 3D edges (from, to, plane beyond), in 2D its two ends, the first one
    /// marked with 1.
    fn close(&mut self, mut section: Vec<(u32, u32, Plane)>, by: Plane) -> Polygon<D> {
        let mut polygon = Polygon { plane: by, corners: Vec::new(), sides: Vec::new() };
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
        for &(corner, _, side) in &section {
            polygon.corners.push(self.corners[corner as usize]);
            polygon.sides.push(side);
            self.loops.push(corner);
            self.sides.push(side);
        }
        self.close_face(by);
        polygon
    }

    /// Volume (area in 2D). Simplices that round-off turns inside out count nothing.
    pub(crate) fn volume(&self) -> f64 {
        let mut volume = 0.0;
        self.for_each_simplex(|points| volume += mesh::Simplex::new(points).volume().max(0.0));
        volume
    }

    /// Measure of the surface.
    pub(crate) fn surface(&self) -> f64 {
        (0..self.n_faces()).map(|face| self.face_measure(face)).sum()
    }

    /// Measure of the face on a plane, if there is one.
    pub(crate) fn measure_on(&self, plane: Plane) -> Option<f64> {
        let face = self.labels.iter().position(|label| *label == plane)?;
        Some(self.face_measure(face))
    }

    fn face_measure(&self, face: usize) -> f64 {
        let x = |k: u32| self.corners[k as usize].x;
        let corners = &self.loops[self.range(face)];
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
            let corners = &self.loops[self.range(face)];
            if corners.contains(&0) || corners.len() < D {
                continue;
            }
            simplex[1] = self.corners[corners[0] as usize].x;
            for k in 1..=corners.len() + 1 - D {
                for j in 0..D - 1 {
                    simplex[2 + j] = self.corners[corners[k + j] as usize].x;
                }
                visit(&simplex[..=D]);
            }
        }
    }

    /// The piece with rounded corners, faces labelled for the cell with the given facets.
    pub(crate) fn rounded(&self, cell_facets: &[mesh::FacetId]) -> Polytope<D> {
        let label = |plane: &Plane| match plane.kind() {
            PlaneKind::Facet(facet) | PlaneKind::Rim(facet, _) => FaceLabel::Facet(facet),
            PlaneKind::Mesh(id) => FaceLabel::Cell(cell_facets.iter().position(|&f| f == id).unwrap_or(0) as u8),
        };
        Polytope::new(
            self.corners.iter().map(|corner| corner.x).collect(),
            self.labels.iter().map(label).collect(),
            self.offsets.clone(),
            self.loops.clone(),
        )
    }
}

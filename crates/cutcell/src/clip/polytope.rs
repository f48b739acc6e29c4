//! Convex polygons and polyhedra that remember where each of their faces comes from.

use mesh::Point;

/// Where a face of a [`Polytope`] comes from.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FaceLabel {
    /// A piece of the local facet of the background cell.
    Cell(u8),
    /// A piece of the plane through a facet of a surface (index among all facets of an overlay).
    Facet(u32),
}

/// A convex polygon (D = 2) or polyhedron (D = 3).
///
/// Faces are loops of points: edges from one point to the next with the inside on the left (2D), polygons that
/// turn counter-clockwise as seen from outside (3D).
#[derive(Clone, Debug, Default)]
pub struct Polytope<const D: usize> {
    points: Vec<Point<D>>,
    labels: Vec<FaceLabel>,
    offsets: Vec<u32>,
    loops: Vec<u32>,
}

impl<const D: usize> Polytope<D> {
    pub(super) fn new(points: Vec<Point<D>>, labels: Vec<FaceLabel>, offsets: Vec<u32>, loops: Vec<u32>) -> Self {
        Self { points, labels, offsets, loops }
    }

    /// Points.
    pub fn points(&self) -> &[Point<D>] {
        &self.points
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        self.labels.len()
    }

    /// Label and points (indices) of a face.
    #[inline]
    pub fn face(&self, face: usize) -> (FaceLabel, &[u32]) {
        let start = if face == 0 { 0 } else { self.offsets[face - 1] as usize };
        (self.labels[face], &self.loops[start..self.offsets[face] as usize])
    }

    /// All faces in order.
    pub fn faces(&self) -> impl Iterator<Item = (FaceLabel, &[u32])> {
        (0..self.n_faces()).map(|f| self.face(f))
    }

    /// Positions of the points of a face.
    pub fn face_points(&self, face: usize) -> impl Iterator<Item = Point<D>> + '_ {
        self.face(face).1.iter().map(|&k| self.points[k as usize])
    }

    /// Calls `visit` with the points of each simplex of a decomposition into positively oriented simplices.
    pub fn for_each_simplex(&self, mut visit: impl FnMut(&[Point<D>])) {
        let mut simplex = [Point::<D>::zeros(); 4];
        simplex[0] = self.points[0];
        for (_, corners) in self.faces() {
            if corners.contains(&0) || corners.len() < D {
                continue;
            }
            simplex[1] = self.points[corners[0] as usize];
            // A fan over the face: one segment in 2D, triangles in 3D.
            for k in 1..=corners.len() + 1 - D {
                for j in 0..D - 1 {
                    simplex[2 + j] = self.points[corners[k + j] as usize];
                }
                visit(&simplex[..=D]);
            }
        }
    }

    /// Volume (area in 2D). Simplices that round-off turns inside out count nothing.
    pub fn volume(&self) -> f64 {
        let mut volume = 0.0;
        self.for_each_simplex(|points| volume += mesh::Simplex::new(points).volume().max(0.0));
        volume
    }

    /// A point in the inside: the mean of the points.
    pub fn inner_point(&self) -> Point<D> {
        self.points.iter().sum::<Point<D>>() / self.points.len() as f64
    }
}

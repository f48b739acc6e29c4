//! Convex polygons and polyhedra with the origin of each face.

use mesh::Point;

use crate::exact::signed_volume;

/// Origin of a face of a [`Polytope`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FaceLabel {
    /// A piece of the facet with this local number of the background cell.
    Cell(u8),
    /// A piece of the plane through a facet of a surface (index among all facets of an overlay).
    Facet(u32),
}

/// A convex polygon (D = 2) or polyhedron (D = 3) of a [`crate::CutMesh`].
///
/// Faces are loops of points: edges from one point to the next with the inside on the left (2D), polygons that
/// turn counter-clockwise as seen from outside (3D).
#[derive(Clone, Copy, Debug)]
pub struct Polytope<'a, const D: usize> {
    points: &'a [Point<D>],
    /// Label of each face, and the end of its loop.
    faces: &'a [(FaceLabel, u32)],
    loops: &'a [u32],
}

impl<'a, const D: usize> Polytope<'a, D> {
    /// Returns the points.
    pub fn points(&self) -> &'a [Point<D>] {
        self.points
    }

    /// Returns the number of faces.
    pub fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// Returns the label and points (indices) of a face.
    #[inline]
    pub fn face(&self, face: usize) -> (FaceLabel, &'a [u32]) {
        let start = if face == 0 { 0 } else { self.faces[face - 1].1 as usize };
        let (label, end) = self.faces[face];
        (label, &self.loops[start..end as usize])
    }

    /// Returns all faces in order.
    pub fn faces(self) -> impl Iterator<Item = (FaceLabel, &'a [u32])> {
        (0..self.n_faces()).map(move |f| self.face(f))
    }

    /// Returns the positions of the points of a face.
    pub fn face_points(self, face: usize) -> impl Iterator<Item = Point<D>> + 'a {
        self.face(face).1.iter().map(move |&k| self.points[k as usize])
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

    /// Returns the volume (area in 2D), without simplices that are inverted by round-off.
    pub fn volume(&self) -> f64 {
        let extent = self.points.iter().fold(0.0_f64, |extent, x| extent.max((x - self.points[0]).amax()));
        let doubt = 64.0 * f64::EPSILON * extent.powi(D as i32);
        let mut volume = 0.0;
        self.for_each_simplex(|points| volume += signed_volume(points, doubt).max(0.0));
        volume
    }
}

/// Polytopes, stored in four arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Polytopes<const D: usize> {
    points: Vec<Point<D>>,
    faces: Vec<(FaceLabel, u32)>,
    loops: Vec<u32>,
    /// Ends of each polytope in the other arrays.
    ends: Vec<[u32; 3]>,
}

impl<const D: usize> Polytopes<D> {
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.faces.clear();
        self.loops.clear();
        self.ends.clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// Adds a polytope. Ends of loops are relative to its own `loops`.
    pub(super) fn push(
        &mut self,
        points: impl Iterator<Item = Point<D>>,
        faces: impl Iterator<Item = (FaceLabel, u32)>,
        loops: impl Iterator<Item = u32>,
    ) {
        self.points.extend(points);
        self.faces.extend(faces);
        self.loops.extend(loops);
        self.ends.push([self.points.len() as u32, self.faces.len() as u32, self.loops.len() as u32]);
    }

    /// Adds a copy of a polytope.
    pub(crate) fn push_polytope(&mut self, polytope: Polytope<'_, D>) {
        let Polytope { points, faces, loops } = polytope;
        self.push(points.iter().copied(), faces.iter().copied(), loops.iter().copied());
    }

    /// Appends all polytopes of `others`.
    pub(crate) fn append(&mut self, others: &Self) {
        let shift = [self.points.len() as u32, self.faces.len() as u32, self.loops.len() as u32];
        self.points.extend_from_slice(&others.points);
        self.faces.extend_from_slice(&others.faces);
        self.loops.extend_from_slice(&others.loops);
        self.ends.extend(others.ends.iter().map(|end| std::array::from_fn(|k| end[k] + shift[k])));
    }

    pub(crate) fn get(&self, index: usize) -> Polytope<'_, D> {
        let start = if index == 0 { [0; 3] } else { self.ends[index - 1] };
        let end = self.ends[index];
        let range = |k: usize| start[k] as usize..end[k] as usize;
        Polytope { points: &self.points[range(0)], faces: &self.faces[range(1)], loops: &self.loops[range(2)] }
    }
}

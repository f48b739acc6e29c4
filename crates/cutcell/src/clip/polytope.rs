//! Convex polygons and polyhedra that remember where each of their faces comes from.

use mesh::{Point, Vector};

/// Where a face of a [`Polytope`] comes from.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FaceLabel {
    /// A piece of the local facet of the background cell.
    Cell(u8),
    /// A piece of the plane through a facet of a surface (index among all facets of an overlay).
    Plane {
        /// The facet.
        facet: u32,
        /// Whether this polytope lies in front of the facet, on the side that its normal points to.
        front: bool,
    },
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
    /// The simplex with the given `D + 1` points in positive orientation; face `i`, opposite to point `i`, is
    /// labelled `Cell(i)`.
    pub fn simplex(points: &[Point<D>]) -> Self {
        debug_assert_eq!(points.len(), D + 1);
        let mut polytope = Self { points: points.to_vec(), ..Self::default() };
        for opposite in 0..=D {
            let mut corners = [0_u32; 3];
            for (slot, k) in (0..D).zip((0..=D).filter(|&k| k != opposite)) {
                corners[slot] = k as u32;
            }
            if opposite % 2 == 1 {
                corners.swap(0, 1);
            }
            polytope.push_face(FaceLabel::Cell(opposite as u8), &corners[..D]);
        }
        polytope
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
            if corners.contains(&0) {
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

    /// Volume (area in 2D).
    pub fn volume(&self) -> f64 {
        let mut volume = 0.0;
        self.for_each_simplex(|points| volume += mesh::Simplex::new(points).volume());
        volume
    }

    /// A point in the inside: the mean of the points.
    pub fn inner_point(&self) -> Point<D> {
        self.points.iter().sum::<Point<D>>() / self.points.len() as f64
    }

    /// The points in which the polytope meets the plane, given the signed distances of its points to the plane
    /// (exactly zero for points that count as lying on it), ordered along the right-handed direction of the
    /// normal; they form a convex face of dimension `D - 1`.
    pub fn cross_section(&self, distances: &[f64], normal: &Vector<D>, section: &mut Vec<Point<D>>) {
        section.clear();
        section.extend(self.points.iter().zip(distances).filter(|(_, d)| **d == 0.0).map(|(x, _)| *x));
        for (_, corners) in self.faces() {
            for_each_edge::<D>(corners, |a, b| {
                // In 3D every edge belongs to two faces, once in either direction.
                if distances[a] * distances[b] < 0.0 && (D == 2 || a < b) {
                    section.push(self.crossing(distances, a, b));
                }
            });
        }
        sort_around(section, normal);
    }

    /// Whether points with distance zero lie only where a face passes from one side of the plane to the other.
    ///
    /// On a face that is almost in the plane, points within the tolerance may fill an area, with points on either side
    /// of the plane around it: both sides of a split would then claim that area.
    pub fn crosses_cleanly(&self, distances: &[f64]) -> bool {
        self.faces().all(|(_, corners)| {
            let n = corners.len();
            let sign = |k: usize| {
                let d = distances[corners[k % n] as usize];
                i32::from(d > 0.0) - i32::from(d < 0.0)
            };
            let straddles = (0..n).any(|k| sign(k) > 0) && (0..n).any(|k| sign(k) < 0);
            !straddles || (0..n).all(|k| sign(k) != 0 || sign(k + n - 1) * sign(k + 1) < 0)
        })
    }

    /// Splits by a plane into the part behind it (negative distances) and the part in front of it; points with
    /// distance zero belong to both. The new faces carry the facet of the plane.
    ///
    /// There must be points strictly on both sides.
    pub fn split(&self, distances: &[f64], normal: &Vector<D>, facet: u32) -> [Self; 2] {
        let mut section = Vec::new();
        self.cross_section(distances, normal, &mut section);
        [false, true].map(|front| {
            let sign = if front { 1.0 } else { -1.0 };
            let mut side = Self::default();
            let mut kept = vec![u32::MAX; self.points.len()];
            let mut crossings: Vec<(usize, usize, u32)> = Vec::new();
            let mut corners_kept = Vec::new();
            for (label, corners) in self.faces() {
                corners_kept.clear();
                let n = corners.len();
                let mut strictly_inside = false;
                for (i, &corner) in corners.iter().enumerate() {
                    let a = corner as usize;
                    if sign * distances[a] >= 0.0 {
                        strictly_inside |= distances[a] != 0.0;
                        if kept[a] == u32::MAX {
                            kept[a] = side.points.len() as u32;
                            side.points.push(self.points[a]);
                        }
                        corners_kept.push(kept[a]);
                    }
                    if D == 2 && i + 1 == n {
                        break;
                    }
                    let b = corners[(i + 1) % n] as usize;
                    if distances[a] * distances[b] < 0.0 {
                        let key = (a.min(b), a.max(b));
                        let known = crossings.iter().find(|c| (c.0, c.1) == key).map(|c| c.2);
                        let index = known.unwrap_or_else(|| {
                            side.points.push(self.crossing(distances, a, b));
                            let index = side.points.len() as u32 - 1;
                            crossings.push((key.0, key.1, index));
                            index
                        });
                        corners_kept.push(index);
                    }
                }
                if strictly_inside && corners_kept.len() >= D {
                    side.push_face(label, &corners_kept);
                }
            }
            corners_kept.clear();
            corners_kept
                .extend(section.iter().filter_map(|x| side.points.iter().position(|y| x == y)).map(|k| k as u32));
            corners_kept.dedup();
            if D == 2 && corners_kept.len() > 2 {
                // Three points within the tolerance of the plane: the face reaches from the first to the last.
                corners_kept.drain(1..corners_kept.len() - 1);
            }
            if front {
                corners_kept.reverse();
            }
            side.push_face(FaceLabel::Plane { facet, front }, &corners_kept);
            side
        })
    }

    fn push_face(&mut self, label: FaceLabel, corners: &[u32]) {
        self.labels.push(label);
        self.loops.extend_from_slice(corners);
        self.offsets.push(self.loops.len() as u32);
    }

    /// Where the edge between points `a` and `b`, on strictly different sides, meets the plane; the same number
    /// whichever way round the edge is given.
    fn crossing(&self, distances: &[f64], a: usize, b: usize) -> Point<D> {
        let (a, b) = (a.min(b), a.max(b));
        let t = distances[a] / (distances[a] - distances[b]);
        self.points[a] + (self.points[b] - self.points[a]) * t
    }
}

/// Edges of a face: one in 2D, where the face is an edge itself, a closed loop in 3D.
fn for_each_edge<const D: usize>(corners: &[u32], mut visit: impl FnMut(usize, usize)) {
    let n = corners.len();
    let n_edges = if D == 2 { 1 } else { n };
    for k in 0..n_edges {
        visit(corners[k] as usize, corners[(k + 1) % n] as usize);
    }
}

/// Orders the points of a convex face along the direction that has the inside of a body with outward normal
/// `normal` on its left (2D), or counter-clockwise around the normal (3D).
fn sort_around<const D: usize>(points: &mut [Point<D>], normal: &Vector<D>) {
    if D == 2 {
        let key = |x: &Point<D>| normal[0] * x[1] - normal[1] * x[0];
        points.sort_by(|a, b| key(a).total_cmp(&key(b)));
        return;
    }
    let Some(first) = points.first().copied() else { return };
    let centre = points.iter().sum::<Point<D>>() / points.len() as f64;
    let e = first - centre;
    let angle = |x: &Point<D>| {
        let r = x - centre;
        let mut cross = Vector::<D>::zeros();
        for k in 0..D {
            let (i, j) = ((k + 1) % D, (k + 2) % D);
            cross[k] = e[i] * r[j] - e[j] * r[i];
        }
        cross.dot(normal).atan2(e.dot(&r))
    };
    points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_split<const D: usize>() {
        let mut corners = vec![Point::<D>::zeros()];
        for k in 0..D {
            let mut x = Point::<D>::zeros();
            x[k] = 1.0;
            corners.push(x);
        }
        let mut pieces = vec![Polytope::simplex(&corners)];
        let volume = pieces[0].volume();
        for step in 0..6 {
            let mut normal = Vector::<D>::zeros();
            for k in 0..D {
                normal[k] = ((1 + step * D + k) as f64 * 1.7).sin();
            }
            normal /= normal.norm();
            let mut at = Point::<D>::zeros();
            at.fill(0.2 + 0.02 * step as f64);
            pieces = pieces
                .into_iter()
                .flat_map(|piece| {
                    let d: Vec<f64> = piece.points().iter().map(|x| normal.dot(&(x - at))).collect();
                    if d.iter().any(|d| *d > 0.0) && d.iter().any(|d| *d < 0.0) {
                        piece.split(&d, &normal, step as u32).to_vec()
                    } else {
                        vec![piece]
                    }
                })
                .collect();
        }
        assert!(pieces.len() > 6);
        assert!(pieces.iter().all(|p| p.volume() > 0.0));
        let sum: f64 = pieces.iter().map(Polytope::volume).sum();
        assert!((sum - volume).abs() < 1e-14, "{sum} {volume}");
        // Faces close each piece: the outward area vectors sum to zero.
        for piece in &pieces {
            let mut total = Vector::<D>::zeros();
            for f in 0..piece.n_faces() {
                let loop_points: Vec<_> = piece.face_points(f).collect();
                if D == 2 {
                    let t = loop_points[1] - loop_points[0];
                    total[0] += t[1];
                    total[1] -= t[0];
                } else {
                    for k in 1..loop_points.len() - 1 {
                        let (a, b) = (loop_points[k] - loop_points[0], loop_points[k + 1] - loop_points[0]);
                        for i in 0..3 {
                            total[i] += a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
                        }
                    }
                }
            }
            assert!(total.norm() < 1e-13, "{total}");
        }
    }

    #[test]
    fn splitting_keeps_the_volume_in_2d() {
        check_split::<2>();
    }

    #[test]
    fn splitting_keeps_the_volume_in_3d() {
        check_split::<3>();
    }
}

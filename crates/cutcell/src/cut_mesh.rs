//! A background mesh cut by closed surfaces.

use mesh::{Aabb, BodyId, CellId, FacetId, Point, QuadratureRule, SimplexMesh, SimplexRule, Vector, simplex_measure};
use smallvec::SmallVec;

use crate::clip::Polytopes;
use crate::report::SLIVER;
use crate::surface::{Facet, FacetPoint};
use crate::{CutReport, Polytope};

/// State of a background cell relative to the bodies.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CellState {
    /// Outside of all bodies: one part, the whole cell.
    Fluid,
    /// Inside the bodies: no part.
    Covered,
    /// Crossed by a surface: any number of parts.
    Cut,
}

/// A fluid part: a connected component of the fluid inside one cell. Parts are numbered in the order of their cells.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PartId(pub u32);

impl PartId {
    /// Returns the position in arrays over parts.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A piece of the fluid-structure interface in one background cell (or on its boundary) and on one facet: a simplex of
/// dimension `D - 1`, wet by one fluid part.
#[derive(Clone, Debug, PartialEq)]
pub struct InterfacePiece<const D: usize> {
    /// The cell of the fluid part.
    pub cell: CellId,
    /// The fluid part on the side of the normal.
    pub part: PartId,
    /// The body on the other side.
    pub body: BodyId,
    /// The facet of the body's surface.
    pub facet: FacetId,
    /// Corners; only the first `D` are used.
    pub points: [Point<D>; 3],
    /// Barycentric coordinates of the corners in the facet, also valid after the body has moved. Only the first `D`
    /// entries of the first `D` arrays are used.
    pub barycentric: [[f64; 3]; 3],
    /// Unit normal out of the body.
    pub normal: Vector<D>,
    /// Length (area in 3D).
    pub measure: f64,
}

/// The portion of an interior face of the background that is shared by two fluid parts, one in each cell.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PartFace {
    /// The face.
    pub facet: FacetId,
    /// Parts in the first and the second cell of the face.
    pub parts: [PartId; 2],
    /// Measure of the shared portion.
    pub measure: f64,
    /// Whether one of the two cells is cut: such faces carry ghost penalties.
    pub is_ghost: bool,
}

/// A piece of the boundary of the background, wet by one fluid part: a simplex of dimension `D - 1`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BoundaryPiece<const D: usize> {
    /// The boundary face.
    pub facet: FacetId,
    /// The fluid part.
    pub part: PartId,
    /// Corners; only the first `D` are used.
    pub points: [Point<D>; 3],
    /// Length (area in 3D).
    pub measure: f64,
}

/// A background mesh cut by the surfaces of bodies; immutable. See the crate's documentation for definitions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutMesh<const D: usize> {
    pub(crate) cell_to_state: Vec<CellState>,
    /// Offsets into the parts; one more entry than cells.
    pub(crate) cell_to_part: Vec<u32>,
    pub(crate) part_to_cell: Vec<CellId>,
    pub(crate) part_to_volume: Vec<f64>,
    /// Offsets into `pieces`; one more entry than parts. Parts of uncut cells have no pieces.
    pub(crate) part_to_piece: Vec<u32>,
    pub(crate) pieces: Polytopes<D>,
    /// Covered pieces of cut cells, and their cells.
    pub(crate) covered_pieces: Polytopes<D>,
    pub(crate) covered_to_cell: Vec<CellId>,
    pub(crate) interface: Vec<InterfacePiece<D>>,
    pub(crate) part_faces: Vec<PartFace>,
    pub(crate) boundary: Vec<BoundaryPiece<D>>,
    pub(crate) report: CutReport,
}

impl<const D: usize> CutMesh<D> {
    /// Returns the number of cells of the background.
    pub fn n_cells(&self) -> usize {
        self.cell_to_state.len()
    }

    /// Returns the state of a cell.
    #[inline]
    pub fn cell_state(&self, cell: CellId) -> CellState {
        self.cell_to_state[cell.index()]
    }

    /// Returns the fluid parts of a cell.
    #[inline]
    pub fn parts(&self, cell: CellId) -> impl ExactSizeIterator<Item = PartId> + use<D> {
        (self.cell_to_part[cell.index()]..self.cell_to_part[cell.index() + 1]).map(PartId)
    }

    /// Returns the number of fluid parts.
    pub fn n_parts(&self) -> usize {
        self.part_to_cell.len()
    }

    /// Returns all fluid parts in order.
    pub fn all_parts(&self) -> impl ExactSizeIterator<Item = PartId> + use<D> {
        (0..self.part_to_cell.len() as u32).map(PartId)
    }

    /// Returns the cell of a part.
    #[inline]
    pub fn part_cell(&self, part: PartId) -> CellId {
        self.part_to_cell[part.index()]
    }

    /// Returns the volume (area in 2D) of a part.
    #[inline]
    pub fn part_volume(&self, part: PartId) -> f64 {
        self.part_to_volume[part.index()]
    }

    /// Returns whether the part is the whole cell.
    #[inline]
    pub fn is_whole(&self, part: PartId) -> bool {
        self.cell_state(self.part_cell(part)) == CellState::Fluid
    }

    /// Returns the convex pieces of a part; empty if the part is the whole cell.
    pub fn part_pieces(&self, part: PartId) -> impl ExactSizeIterator<Item = Polytope<'_, D>> {
        let k = part.index();
        (self.part_to_piece[k] as usize..self.part_to_piece[k + 1] as usize).map(|piece| self.pieces.get(piece))
    }

    /// Returns the volume of the background that bodies cover (2D: area). It is a sum over whole cells and pieces, so
    /// that it is accurate for bodies that are small compared with their cells, unlike the difference from the volume
    /// of the fluid.
    pub fn covered_volume(&self, background: &SimplexMesh<D>) -> f64 {
        let whole = background.cells().filter(|&cell| self.cell_state(cell) == CellState::Covered);
        let volumes = whole.map(|cell| background.cell_volume(cell));
        // The sum of no numbers is -0.
        volumes.chain(self.covered_pieces().map(|(_, piece)| piece.volume())).fold(0.0, |sum, volume| sum + volume)
    }

    /// Returns the pieces of cut cells inside the bodies, with their cells.
    pub fn covered_pieces(&self) -> impl ExactSizeIterator<Item = (CellId, Polytope<'_, D>)> {
        self.covered_to_cell.iter().enumerate().map(|(k, &cell)| (cell, self.covered_pieces.get(k)))
    }

    /// Calls `visit` with the points of each simplex of a decomposition of a part into positively oriented simplices.
    /// Simplices without volume in rounded coordinates are left out.
    pub fn for_each_simplex(&self, background: &SimplexMesh<D>, part: PartId, mut visit: impl FnMut(&[Point<D>])) {
        if self.is_whole(part) {
            visit(background.simplex(self.part_cell(part)).points());
        } else {
            for piece in self.part_pieces(part) {
                piece.for_each_simplex(|points| {
                    // Weights of quadrature rules must not underflow.
                    if mesh::Simplex::new(points).volume() > f64::MIN_POSITIVE {
                        visit(points);
                    }
                });
            }
        }
    }

    /// Appends a quadrature rule on a part, composed of rules on simplices. Weights are positive, and points lie inside
    /// the part.
    pub fn part_quadrature(
        &self,
        background: &SimplexMesh<D>,
        part: PartId,
        rule: &SimplexRule,
        out: &mut QuadratureRule<D>,
    ) {
        self.for_each_simplex(background, part, |points| out.push_simplex(rule, points));
    }

    /// Returns the pieces of the fluid-structure interface, in the order of cells.
    pub fn interface(&self) -> &[InterfacePiece<D>] {
        &self.interface
    }

    /// Returns the part faces, in the order of the faces of the background.
    pub fn part_faces(&self) -> &[PartFace] {
        &self.part_faces
    }

    /// Returns the part faces next to a cut cell.
    pub fn ghost_faces(&self) -> impl Iterator<Item = &PartFace> {
        self.part_faces.iter().filter(|face| face.is_ghost)
    }

    /// Returns the wet pieces of the boundary of the background, in the order of faces.
    pub fn boundary(&self) -> &[BoundaryPiece<D>] {
        &self.boundary
    }

    /// Returns the volume of the fluid.
    pub fn fluid_volume(&self) -> f64 {
        // Compensated summation (Neumaier), since errors of many equal cells would add up.
        let (mut sum, mut lost) = (0.0_f64, 0.0);
        for &volume in &self.part_to_volume {
            let next = sum + volume;
            lost += (sum - next) + volume;
            sum = next;
        }
        sum + lost
    }

    /// Returns the same cut without some of its parts, given by a flag for each part. Their faces and pieces are left
    /// out as well, and the other parts are numbered again. The volume of the parts left out is neither fluid nor
    /// covered.
    #[must_use]
    pub fn without_parts(mut self, background: &SimplexMesh<D>, is_left_out: &[bool]) -> Self {
        let kept: Vec<PartId> = self.all_parts().filter(|part| !is_left_out[part.index()]).collect();
        let (mut pieces, mut piece_ends) = (Polytopes::default(), vec![0]);
        for part in &kept {
            self.part_pieces(*part).for_each(|piece| pieces.push_polytope(piece));
            piece_ends.push(pieces.len() as u32);
        }
        // Entry `k` is the number of kept parts before part `k`; the last entry is the number of all kept parts.
        let mut numbers = vec![0];
        is_left_out.iter().for_each(|left_out| numbers.push(numbers[numbers.len() - 1] + u32::from(!left_out)));
        let renumber = |part: &mut PartId| {
            let is_kept = !is_left_out[part.index()];
            part.0 = numbers[part.index()];
            is_kept
        };
        self.report.n_left_out += self.n_parts() - kept.len();
        self.cell_to_part.iter_mut().for_each(|first| *first = numbers[*first as usize]);
        self.part_to_cell = kept.iter().map(|part| self.part_to_cell[part.index()]).collect();
        self.part_to_volume = kept.iter().map(|part| self.part_to_volume[part.index()]).collect();
        (self.part_to_piece, self.pieces) = (piece_ends, pieces);
        self.interface.retain_mut(|piece| renumber(&mut piece.part));
        self.part_faces.retain_mut(|face| face.parts.iter_mut().all(renumber));
        self.boundary.retain_mut(|piece| renumber(&mut piece.part));
        let cells_and_volumes = self.part_to_cell.iter().zip(&self.part_to_volume);
        let fractions = cells_and_volumes.map(|(cell, volume)| volume / background.cell_volume(*cell));
        self.report.smallest_fraction = fractions.clone().fold(1.0, f64::min);
        self.report.n_slivers = fractions.filter(|fraction| *fraction < SLIVER).count();
        self.report.max_parts = background.cells().map(|cell| self.parts(cell).len()).max().unwrap_or(0);
        self
    }

    /// Returns the counts and quality measures of the cut.
    pub fn report(&self) -> &CutReport {
        &self.report
    }

    /// Computes the common volume of a part of this cut and a part of another cut of the same background.
    pub fn overlap_volume(&self, background: &SimplexMesh<D>, part: PartId, other: &Self, other_part: PartId) -> f64 {
        if self.part_cell(part) != other.part_cell(other_part) {
            return 0.0;
        }
        if self.is_whole(part) {
            return other.part_volume(other_part);
        }
        if other.is_whole(other_part) {
            return self.part_volume(part);
        }
        // A cell may have thousands of pieces, of which few meet.
        let mut opposite: SmallVec<[(Aabb<D>, [Point<D>; 4]); 8]> = SmallVec::new();
        other.for_each_simplex(background, other_part, |b| {
            opposite
                .push((Aabb::of_points(b), std::array::from_fn(|k| b.get(k).copied().unwrap_or_else(Point::zeros))));
        });
        let mut volume = 0.0;
        self.for_each_simplex(background, part, |a| {
            let Aabb { low, high } = Aabb::of_points(a);
            let meets = |b: &Aabb<D>| (0..D).all(|k| low[k] < b.high[k] && b.low[k] < high[k]);
            let near = opposite.iter().filter(|(bounds, _)| meets(bounds));
            near.for_each(|(_, b)| volume += simplex_overlap(a, &b[..=D]));
        });
        volume
    }
}

/// Computes the common volume of two positively oriented simplices.
fn simplex_overlap<const D: usize>(a: &[Point<D>], b: &[Point<D>]) -> f64 {
    let Some(gradients) = mesh::Simplex::new(b).barycentric_gradients() else { return 0.0 };
    // Inside `b`, all barycentric coordinates are positive.
    let mut planes = [(Vector::zeros(), Point::zeros()); 4];
    for (corner, plane) in planes[..=D].iter_mut().enumerate() {
        *plane = (-gradients[corner], b[(corner + 1) % (D + 1)]);
    }
    let mut corners = [Point::zeros(); 4];
    corners[..=D].copy_from_slice(a);
    volume_behind(corners, &planes[..=D])
}

/// Computes the volume of the part of a simplex behind all planes, each given by a normal and a point.
fn volume_behind<const D: usize>(corners: [Point<D>; 4], planes: &[(Vector<D>, Point<D>)]) -> f64 {
    let Some(((normal, origin), others)) = planes.split_first() else {
        return mesh::Simplex::new(&corners[..=D]).volume().max(0.0);
    };
    volume_behind_one(corners, corners.map(|x| normal.dot(&(x - origin))), others)
}

/// Computes the volume of [`volume_behind`], given the signed distances of the corners from the first plane.
/// Recursively divides edges that cross the plane, so that all pieces are simplices; the result is the exact volume for
/// a slightly perturbed plane.
fn volume_behind_one<const D: usize>(
    corners: [Point<D>; 4],
    distances: [f64; 4],
    others: &[(Vector<D>, Point<D>)],
) -> f64 {
    let (mut behind, mut front) = (0, 0);
    for k in 1..=D {
        if distances[k] < distances[behind] {
            behind = k;
        }
        if distances[k] > distances[front] {
            front = k;
        }
    }
    if distances[behind] >= 0.0 {
        return 0.0;
    }
    if distances[front] <= 0.0 {
        return volume_behind(corners, others);
    }
    let share = distances[behind] / (distances[behind] - distances[front]);
    let between = corners[behind] + (corners[front] - corners[behind]) * share;
    let part = |k: usize| {
        let (mut corners, mut distances) = (corners, distances);
        (corners[k], distances[k]) = (between, 0.0);
        volume_behind_one(corners, distances, others)
    };
    part(front) + part(behind)
}

impl<const D: usize> InterfacePiece<D> {
    /// Adds the simplices of a fan over a convex piece of a facet, except those without area.
    pub(crate) fn push_fan(
        cell: CellId,
        part: PartId,
        facet: &Facet<D>,
        corners: &[FacetPoint<D>],
        out: &mut Vec<Self>,
    ) {
        for_each_fan_simplex::<D>(corners.len(), |at| {
            let points = at.map(|k| k.map_or(Point::zeros(), |k| corners[k].x));
            let measure = simplex_measure(&points[..D]);
            if measure > 0.0 {
                let barycentric = at.map(|k| k.map_or([0.0; 3], |k| corners[k].barycentric));
                let (body, normal) = (facet.body, facet.normal);
                out.push(Self { cell, part, body, facet: facet.id, points, barycentric, normal, measure });
            }
        });
    }
}

/// Calls `visit` with the corners of each simplex of a fan over a convex face, except those without area.
pub(crate) fn for_each_face_simplex<const D: usize>(polygon: &[Point<D>], mut visit: impl FnMut([Point<D>; 3])) {
    for_each_fan_simplex::<D>(polygon.len(), |at| {
        let corners = at.map(|k| k.map_or(Point::zeros(), |k| polygon[k]));
        if simplex_measure(&corners[..D]) > 0.0 {
            visit(corners);
        }
    });
}

/// Calls `visit` with the `D` corner indices of each simplex of a fan over a convex face.
#[inline]
fn for_each_fan_simplex<const D: usize>(n_corners: usize, mut visit: impl FnMut([Option<usize>; 3])) {
    for k in 1..(n_corners + 2).saturating_sub(D) {
        visit([Some(0), Some(k), Some(k + 1)].map(|at| at.filter(|&at| at < k + D - 1)));
    }
}

/// Computes the measure of a convex face.
pub(crate) fn measure<const D: usize>(polygon: &[Point<D>]) -> f64 {
    let mut sum = 0.0;
    for_each_face_simplex(polygon, |corners| sum += simplex_measure(&corners[..D]));
    sum
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::SplitMix64;

    use super::*;

    /// Checks simplices whose corners lie on a few lines and planes up to round-off: slivers of all kinds.
    fn check_slivers<const D: usize>() {
        let mut generator = SplitMix64::seed_from_u64(7);
        let mut random = |n: u32| generator.random_range(0..n);
        let mut volumes = [0.0; 2];
        for _ in 0..20_000 {
            let [a, b] = [(); 2].map(|()| {
                let mut points = [Point::<D>::zeros(); 4];
                for x in &mut points[..=D] {
                    *x = Point::from_fn(|_, _| {
                        0.3 * random(4) as f64 + (random(5) as f64 - 2.0) * 1e-16 + (random(3) as f64) * 1e-9
                    });
                }
                if mesh::Simplex::new(&points[..=D]).volume() < 0.0 {
                    points.swap(0, 1);
                }
                points
            });
            let least = [a, b].map(|x| mesh::Simplex::new(&x[..=D]).volume()).into_iter().fold(1.0, f64::min);
            if least > 0.0 {
                let volume = [simplex_overlap(&a[..=D], &b[..=D]), simplex_overlap(&b[..=D], &a[..=D])];
                assert!(volume.iter().all(|v| *v >= 0.0 && *v <= least + 1e-15), "{volume:?} {least}");
                assert!((volume[0] - volume[1]).abs() < 1e-8, "{volume:?}");
                volumes[0] += volume[0];
                volumes[1] += f64::from(u8::from(least < 1e-14));
            }
        }
        assert!(volumes[0] > 1.0 && volumes[1] > 100.0, "{volumes:?}");
    }

    #[test]
    fn overlaps_of_slivers_are_not_larger_than_the_slivers() {
        check_slivers::<2>();
        check_slivers::<3>();
    }
}

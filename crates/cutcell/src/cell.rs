//! The cut of one background cell.

use mesh::{CellId, FacetId};

use crate::clip::{FacePoints, Polygon, Polygons, Polytopes, Side};
use crate::cutting::Cutting;
use crate::exact::{End, Plane, Planes, crossing};
use crate::surface::FacetPoint;
use crate::tree::{Tree, Wall};

/// Properties of a leaf: a convex piece of a cell that no facet crosses.
#[derive(Clone, Copy, Debug)]
struct Label {
    /// Number of bodies around the leaf.
    depth: i32,
    /// Index of the fluid part to which the leaf belongs; not used inside a body.
    part: u32,
}

/// Index of parts that are left out because they are too thin.
const THIN: u32 = u32::MAX;
/// Mark of a leaf whose number of bodies is not computed yet.
const UNKNOWN: i32 = i32::MIN;

impl Label {
    /// Returns the fluid part; `None` inside a body.
    fn part(self) -> Option<u32> {
        (self.depth <= 0).then_some(self.part)
    }

    /// Returns the fluid part; `None` inside a body, or if the part is left out.
    fn fluid_part(self) -> Option<u32> {
        self.part().filter(|&part| part != THIN)
    }
}

/// A piece of a facet with fluid in front of it and a body behind it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WetPiece {
    part: u32,
    pub(crate) facet: u32,
    polygon: Polygon,
}

/// A face of the background as seen from one cell.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum FaceView {
    /// Covered.
    Dry,
    /// Wet by one part, with the wet measure. The measure is computed by the first cell of the face, and zero in the
    /// other.
    Wet(u32, f64),
    /// All other cases: several parts, facets on the face, parts that are left out.
    Mixed,
}

/// Results of the cut of a number of touched cells, in ascending order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept<const D: usize> {
    pub(crate) cells: Vec<KeptCell>,
    /// Volume of each part.
    pub(crate) volumes: Vec<f64>,
    /// Convex pieces of the parts, except for undivided cells, and the end of the pieces of each part.
    pub(crate) pieces: Polytopes<D>,
    pub(crate) part_to_piece_end: Vec<u32>,
    /// Convex pieces inside bodies, with their cells.
    pub(crate) covered: Polytopes<D>,
    pub(crate) covered_to_cell: Vec<CellId>,
    /// Convex pieces of the interface inside the cells, and the corners of all of them.
    pub(crate) wet: Vec<KeptWet>,
    pub(crate) wet_corners: Vec<FacetPoint<D>>,
}

/// Result of the cut of one touched cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KeptCell {
    pub(crate) n_parts: u32,
    pub(crate) n_wet: u32,
    /// Whether no facet divides the cell.
    pub(crate) is_whole: bool,
    /// Number of parts that are left out.
    pub(crate) n_left_out: u32,
    /// The faces as seen from the cell.
    pub(crate) faces: [FaceView; 4],
}

/// A convex piece of a facet with fluid in front of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KeptWet {
    /// Index of the part, from zero in each cell.
    pub(crate) part: u32,
    pub(crate) facet: u32,
    pub(crate) n_corners: u32,
}

impl<const D: usize> Kept<D> {
    pub(crate) fn clear(&mut self) {
        self.cells.clear();
        self.volumes.clear();
        self.pieces.clear();
        self.part_to_piece_end.clear();
        self.covered.clear();
        self.covered_to_cell.clear();
        self.wet.clear();
        self.wet_corners.clear();
    }
}

/// The cut of a cell, in memory that is reused for other cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellCut<const D: usize> {
    tree: Tree<D>,
    polygons: Polygons<D>,
    walls: Vec<Wall>,
    /// One entry per leaf of the tree.
    labels: Vec<Label>,
    leaf_volumes: Vec<f64>,
    /// Volume of each part of the cell.
    volumes: Vec<f64>,
    wet: Vec<WetPiece>,
    /// Pieces of facets in front of which the fluid is left out.
    thin: Vec<WetPiece>,
    /// Number of parts that are left out.
    n_left_out: u32,
}

impl<const D: usize> CellCut<D> {
    /// Cuts the touched cell at position `k`. The result is deterministic.
    pub(crate) fn cut(&mut self, cutting: &Cutting<'_, D>, k: usize) {
        let (planes, cell, facets) = (&cutting.planes, cutting.touched.cells[k], cutting.touched.facets(k));
        let first = planes.background.cell(cell)[0];
        self.polygons.clear();
        self.tree.divide(planes, &mut self.polygons, cell, facets);
        self.tree.find_walls(planes, &mut self.polygons, &mut self.walls);
        let diameter = planes.background.simplex(cell).diameter();
        let doubt = 32.0 * f64::EPSILON * diameter.powi(D as i32);
        self.leaf_volumes.clear();
        self.leaf_volumes.extend(self.tree.leaves().iter().map(|leaf| leaf.volume(doubt)));
        // The mean of the corners of the thickest piece certainly lies inside of it.
        let (thickest, _) =
            self.leaf_volumes.iter().enumerate().fold((0, f64::NEG_INFINITY), |best, (leaf, &volume)| {
                if volume > best.1 { (leaf, volume) } else { best }
            });
        let start = planes.background.vertex(first);
        let at = self.tree.leaves()[thickest].inner_point();
        // The segment from the vertex lies in the cell.
        let step = |&f: &u32| crossing(&start, End::Point(&at), planes.facets[f as usize].points());
        let change: i32 = self.tree.near().iter().map(step).sum();
        self.spread(thickest, cutting.depth[first.index()] + change);
        let n_parts = self.number_parts();
        self.volumes.clear();
        self.volumes.resize(n_parts as usize, 0.0);
        for (label, volume) in self.labels.iter().zip(&self.leaf_volumes) {
            if let Some(part) = label.part() {
                self.volumes[part as usize] += volume;
            }
        }
        self.wet.clear();
        self.wet.extend(self.walls.iter().filter_map(|wall| wet_piece(&self.labels, wall)));
        self.thin.clear();
        self.n_left_out = 0;
        self.leave_out_thin_parts(diameter, cutting.thinnest);
        self.wet.sort_by_key(|wet| wet.facet);
    }

    /// Sets the result to an undivided cell: one part, or none.
    pub(crate) fn set_whole(&mut self, planes: &Planes<'_, D>, cell: CellId, is_fluid: bool) {
        self.polygons.clear();
        self.tree.set_whole(planes, cell);
        self.labels.clear();
        self.labels.push(Label { depth: i32::from(!is_fluid), part: 0 });
        self.wet.clear();
        self.thin.clear();
    }

    /// Computes the number of bodies around each leaf from the number around the leaf `from`.
    fn spread(&mut self, from: usize, depth: i32) {
        self.labels.clear();
        self.labels.resize(self.tree.leaves().len(), Label { depth: UNKNOWN, part: 0 });
        self.labels[from].depth = depth;
        let mut changed = true;
        while changed {
            changed = false;
            for wall in &self.walls {
                let (behind, front) = (wall.behind as usize, wall.front as usize);
                match (self.labels[behind].depth, self.labels[front].depth) {
                    (UNKNOWN, UNKNOWN) => continue,
                    (behind, UNKNOWN) => self.labels[front].depth = behind - wall.cover.step,
                    (UNKNOWN, front) => self.labels[behind].depth = front + wall.cover.step,
                    (behind, front) => {
                        debug_assert_eq!(behind, front + wall.cover.step, "walls agree");
                        continue;
                    }
                }
                changed = true;
            }
        }
        self.labels.iter_mut().filter(|label| label.depth == UNKNOWN).for_each(|label| label.depth = depth);
    }

    /// Numbers the connected sets of fluid leaves in the order of their first leaf; returns the count of sets.
    fn number_parts(&mut self) -> u32 {
        let labels = &mut self.labels;
        // First, each leaf is mapped to the lowest leaf of its set.
        labels.iter_mut().enumerate().for_each(|(leaf, label)| label.part = leaf as u32);
        let mut changed = true;
        while changed {
            changed = false;
            for wall in &self.walls {
                let (a, b) = (wall.behind as usize, wall.front as usize);
                if let (Some(first), Some(second)) = (labels[a].part(), labels[b].part()) {
                    let low = first.min(second);
                    changed |= first != second;
                    labels[a].part = low;
                    labels[b].part = low;
                }
            }
        }
        // Then, the lowest leaf is replaced by the index of the set.
        let mut n_parts = 0;
        for leaf in 0..labels.len() {
            if let Some(lowest) = labels[leaf].part() {
                labels[leaf].part = if lowest as usize == leaf {
                    n_parts += 1;
                    n_parts - 1
                } else {
                    labels[lowest as usize].part
                };
            }
        }
        n_parts
    }

    /// Adds the result to `kept`.
    pub(crate) fn keep(&self, planes: &Planes<'_, D>, cell: CellId, kept: &mut Kept<D>) {
        let ids = planes.background.cell_to_facet(cell);
        let view = |local: usize, id: FacetId| {
            let is_first = planes.background.facet_to_cell(id)[0] == Some(cell);
            self.view(local, id, is_first)
        };
        let faces = std::array::from_fn(|local| ids.get(local).map_or(FaceView::Dry, |&id| view(local, id)));
        let leaves = self.tree.leaves();
        let is_whole = leaves.len() == 1;
        for (part, &volume) in self.volumes.iter().enumerate() {
            let of_part = (0..leaves.len()).filter(|&leaf| !is_whole && self.fluid_part(leaf) == Some(part as u32));
            of_part.for_each(|leaf| leaves[leaf].round_into(&mut kept.pieces, ids));
            kept.volumes.push(volume);
            kept.part_to_piece_end.push(kept.pieces.len() as u32);
        }
        if !is_whole && !self.volumes.is_empty() {
            for leaf in (0..leaves.len()).filter(|&leaf| self.fluid_part(leaf).is_none()) {
                leaves[leaf].round_into(&mut kept.covered, ids);
                kept.covered_to_cell.push(cell);
            }
        }
        for &WetPiece { part, facet, polygon } in &self.wet {
            let sides = self.polygons.sides(polygon);
            let of = &planes.facets[facet as usize];
            kept.wet_corners.extend(sides.iter().map(|side| of.point(side.corner.x)));
            kept.wet.push(KeptWet { part, facet, n_corners: sides.len() as u32 });
        }
        kept.cells.push(KeptCell {
            n_parts: self.volumes.len() as u32,
            n_wet: self.wet.len() as u32,
            is_whole,
            n_left_out: self.n_left_out,
            faces,
        });
    }

    fn view(&self, local: usize, id: FacetId, is_first: bool) -> FaceView {
        if self.tree.is_aligned(local) || !self.thin.is_empty() {
            return FaceView::Mixed;
        }
        let mut view = FaceView::Dry;
        for (leaf, piece) in self.tree.leaves().iter().enumerate() {
            let Some(part) = self.fluid_part(leaf) else { continue };
            if let Some(face) = piece.face_on(Plane::mesh(id)) {
                let measure = if is_first { piece.face_measure(face) } else { 0.0 };
                view = match view {
                    FaceView::Dry => FaceView::Wet(part, measure),
                    FaceView::Wet(same, sum) if same == part => FaceView::Wet(part, sum + measure),
                    _ => return FaceView::Mixed,
                };
            }
        }
        view
    }

    fn leave_out_thin_parts(&mut self, diameter: f64, thinnest: f64) {
        // A box around the cell bounds the surface of every piece.
        let most = thinnest * (2 * D) as f64 * diameter.powi(D as i32 - 1);
        let mut is_thin: Vec<bool> = self.volumes.iter().map(|&volume| volume <= most).collect();
        if !is_thin.contains(&true) {
            return;
        }
        // The thickness of a part is that of its thickest piece, since even a small tip may be as wide as it is long.
        for ((label, leaf), &volume) in self.labels.iter().zip(self.tree.leaves()).zip(&self.leaf_volumes) {
            if let Some(part) = label.part()
                && is_thin[part as usize]
            {
                is_thin[part as usize] = volume <= 0.0 || volume <= 0.5 * thinnest * leaf.surface();
            }
        }
        if !is_thin.contains(&true) {
            return;
        }
        let number = |part: u32| match is_thin[part as usize] {
            true => THIN,
            false => is_thin[..part as usize].iter().filter(|thin| !**thin).count() as u32,
        };
        self.labels.iter_mut().filter(|label| label.depth <= 0).for_each(|label| label.part = number(label.part));
        self.wet.iter_mut().for_each(|piece| piece.part = number(piece.part));
        self.thin.extend(self.wet.extract_if(.., |piece| piece.part == THIN));
        self.n_left_out = is_thin.iter().filter(|thin| **thin).count() as u32;
        let mut part = 0;
        self.volumes.retain(|_| {
            part += 1;
            !is_thin[part - 1]
        });
    }

    /// Returns the leaves with a face on a plane, and the sides of that face.
    pub(crate) fn faces(&self, on: Plane) -> impl Iterator<Item = (usize, impl Iterator<Item = Side<D>>)> {
        self.tree.leaves().iter().enumerate().flat_map(move |(leaf, piece)| {
            (0..piece.n_faces()).filter(move |&f| piece.plane(f) == on).map(move |f| (leaf, piece.face(f)))
        })
    }

    /// Divides a polygon, given by its plane and its sides, among the leaves that it touches from one side; calls
    /// `visit` with each piece and the part that it touches.
    pub(crate) fn locate(
        &mut self,
        planes: &Planes<'_, D>,
        plane: Plane,
        sides: impl Iterator<Item = Side<D>>,
        mut visit: impl FnMut(FacePoints<D>, Option<u32>),
    ) {
        let Self { tree, polygons, labels, .. } = self;
        let polygon = polygons.push(plane, sides);
        tree.locate(planes, polygons, polygon, &mut |polygons, leaf, polygon| {
            visit(polygons.points(polygon), labels[leaf].fluid_part());
        });
        polygons.forget(polygon);
    }

    /// Returns the fluid part of a leaf; `None` inside a body, or if the part is left out.
    pub(crate) fn fluid_part(&self, leaf: usize) -> Option<u32> {
        self.labels[leaf].fluid_part()
    }

    /// Returns the pieces of facets in front of which the fluid is left out.
    pub(crate) fn thin(&self) -> impl Iterator<Item = (u32, FacePoints<D>)> {
        self.thin.iter().map(|wet| (wet.facet, self.polygons.points(wet.polygon)))
    }
}

/// Returns the interface piece on a wall between fluid and body.
fn wet_piece(labels: &[Label], wall: &Wall) -> Option<WetPiece> {
    let (part, facet) = match (labels[wall.behind as usize].part(), labels[wall.front as usize].part()) {
        (None, Some(part)) => (part, wall.cover.first[0]?),
        (Some(part), None) => (part, wall.cover.first[1]?),
        _ => return None,
    };
    Some(WetPiece { part, facet, polygon: wall.polygon })
}

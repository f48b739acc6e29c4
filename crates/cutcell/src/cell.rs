//! Cutting one background cell.

use mesh::{CellId, FacetId};

use crate::Polytope;
use crate::clip::{Piece, Points, Polygon};
use crate::exact::{End, Plane, Planes, crossing};
use crate::tree::{Tree, Wall};

/// What is known of a convex piece of a cell that no facet crosses.
#[derive(Clone, Copy, Debug)]
struct Label {
    /// Number of bodies around it.
    depth: i32,
    /// Fluid part of the cell that it belongs to; meaningless in a body.
    part: u32,
}

/// In place of the number of a part that is too thin to count.
const THIN: u32 = u32::MAX;

impl Label {
    /// The part of a piece of fluid.
    fn part(self) -> Option<u32> {
        (self.depth <= 0).then_some(self.part)
    }
}

/// A piece of a facet with fluid on the side of its normal and the body on the other.
#[derive(Clone, Debug)]
pub(crate) struct WetPiece<const D: usize> {
    pub(crate) part: u32,
    pub(crate) facet: u32,
    pub(crate) polygon: Points<D>,
}

/// What is kept of a cell that facets may cross.
#[derive(Clone, Debug)]
pub(crate) struct CellPieces<const D: usize> {
    /// Volume of each part.
    pub(crate) volumes: Vec<f64>,
    /// The pieces with their parts, in the order of the parts, the covered ones last; none if the cell is in one piece.
    pub(crate) pieces: Vec<(Option<u32>, Polytope<D>)>,
    pub(crate) wet: Vec<WetPiece<D>>,
    /// Number of parts that are too thin to count.
    pub(crate) n_left_out: usize,
    /// Measure of each face that is wet by one part only, with that part.
    pub(crate) faces: [FaceView; 4],
}

/// A face of the background as seen from one cell.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum FaceView {
    /// Covered.
    Dry,
    /// Wet by one part, over that measure.
    Wet(u32, f64),
    /// Anything else: several parts, facets on the face, parts that are too thin to count.
    Mixed,
}

/// A cell with everything that facets do to its inside.
#[derive(Clone, Debug)]
pub(crate) struct CellCut<const D: usize> {
    pub(crate) tree: Tree<D>,
    /// Of the leaves of the tree.
    labels: Vec<Label>,
    /// Volume of each part of the cell.
    pub(crate) volumes: Vec<f64>,
    pub(crate) wet: Vec<WetPiece<D>>,
    /// Pieces of facets in front of which the fluid is too thin to count.
    pub(crate) thin: Vec<WetPiece<D>>,
    /// Number of parts that are too thin to count.
    n_left_out: usize,
}

impl<const D: usize> CellCut<D> {
    /// Cuts a cell by the facets that may touch it. `depth` is the number of bodies around the first vertex of the
    /// cell; parts no thicker than `thinnest` do not count.
    pub(crate) fn new(planes: &Planes<'_, D>, cell: CellId, depth: i32, facets: &[u32], thinnest: f64) -> Self {
        let tree = Tree::new(planes, cell, facets);
        let walls = tree.walls(planes);
        let piece_volumes: Vec<f64> = tree.leaves().iter().map(Piece::volume).collect();
        // The thickest piece contains the mean of its corners beyond doubt.
        let (thickest, _) = piece_volumes
            .iter()
            .enumerate()
            .fold((0, f64::NEG_INFINITY), |best, (leaf, &volume)| if volume > best.1 { (leaf, volume) } else { best });
        let start = planes.background.vertex(planes.background.cell(cell)[0]);
        let at = tree.leaves()[thickest].inner_point();
        let change: i32 =
            facets.iter().map(|&f| crossing(&start, End::Point(&at), planes.facets[f as usize].points())).sum();
        let mut labels = spread(tree.leaves().len(), thickest, depth + change, &walls);
        let n_parts = number_parts(&mut labels, &walls);
        let mut volumes = vec![0.0; n_parts as usize];
        for (label, volume) in labels.iter().zip(piece_volumes) {
            if let Some(part) = label.part() {
                volumes[part as usize] += volume;
            }
        }
        let wet: Vec<WetPiece<D>> = walls.into_iter().filter_map(|wall| wet_piece(&labels, wall)).collect();
        let mut cut = Self { tree, labels, volumes, wet, thin: Vec::new(), n_left_out: 0 };
        cut.leave_out_thin_parts(planes.background.simplex(cell).diameter(), thinnest);
        cut
    }

    /// What to keep of the cell.
    pub(crate) fn into_pieces(self, planes: &Planes<'_, D>, cell: CellId) -> CellPieces<D> {
        let ids = planes.background.cell_to_facet(cell);
        let faces = std::array::from_fn(|local| ids.get(local).map_or(FaceView::Dry, |&id| self.view(local, id)));
        let leaves = self.tree.leaves();
        let mut pieces: Vec<(Option<u32>, Polytope<D>)> = Vec::new();
        if leaves.len() > 1 {
            pieces.reserve(leaves.len());
            for part in (0..self.volumes.len() as u32).map(Some).chain([None]) {
                let of_part = (0..leaves.len()).filter(|&leaf| self.fluid_part(leaf) == part);
                pieces.extend(of_part.map(|leaf| (part, leaves[leaf].rounded(ids))));
            }
        }
        CellPieces { volumes: self.volumes, pieces, wet: self.wet, n_left_out: self.n_left_out, faces }
    }

    fn view(&self, local: usize, id: FacetId) -> FaceView {
        if self.tree.is_aligned(local) || !self.thin.is_empty() {
            return FaceView::Mixed;
        }
        let mut view = FaceView::Dry;
        for (leaf, piece) in self.tree.leaves().iter().enumerate() {
            let Some(part) = self.fluid_part(leaf) else { continue };
            if let Some(measure) = piece.measure_on(Plane::mesh(id)) {
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
        // No piece has a larger surface than a box around the cell.
        let most = thinnest * (2 * D) as f64 * diameter.powi(D as i32 - 1);
        let mut is_thin: Vec<bool> = self.volumes.iter().map(|&volume| volume <= most).collect();
        if !is_thin.contains(&true) {
            return;
        }
        // A part is as thick as its thickest piece: thin ones may hang on a small tip that is as wide as it is long.
        for (label, leaf) in self.labels.iter().zip(self.tree.leaves()) {
            if let Some(part) = label.part()
                && is_thin[part as usize]
            {
                let volume = leaf.volume();
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
        self.thin = self.wet.extract_if(.., |piece| piece.part == THIN).collect();
        self.n_left_out = is_thin.iter().filter(|thin| **thin).count();
        let mut part = 0;
        self.volumes.retain(|_| {
            part += 1;
            !is_thin[part - 1]
        });
    }

    /// Leaves with their faces on a plane.
    pub(crate) fn faces(&self, on: Plane) -> impl Iterator<Item = (usize, Polygon<D>)> {
        self.tree.leaves().iter().enumerate().flat_map(move |(leaf, piece)| {
            (0..piece.n_faces()).filter(move |&f| piece.plane(f) == on).map(move |f| (leaf, piece.face(f)))
        })
    }

    /// The part of a leaf that counts as fluid.
    pub(crate) fn fluid_part(&self, leaf: usize) -> Option<u32> {
        self.labels[leaf].part().filter(|&part| part != THIN)
    }
}

/// The number of bodies around each leaf, from that around one of them.
fn spread<const D: usize>(n: usize, from: usize, depth: i32, walls: &[Wall<D>]) -> Vec<Label> {
    let mut depths: Vec<Option<i32>> = vec![None; n];
    depths[from] = Some(depth);
    let mut changed = true;
    while changed {
        changed = false;
        for wall in walls {
            match (depths[wall.behind], depths[wall.front]) {
                (Some(behind), None) => depths[wall.front] = Some(behind - wall.cover.step),
                (None, Some(front)) => depths[wall.behind] = Some(front + wall.cover.step),
                (Some(behind), Some(front)) => {
                    debug_assert_eq!(behind, front + wall.cover.step, "walls agree");
                    continue;
                }
                (None, None) => continue,
            }
            changed = true;
        }
    }
    depths.into_iter().map(|known| Label { depth: known.unwrap_or(depth), part: 0 }).collect()
}

/// Numbers the connected sets of fluid leaves in the order of their first leaf; returns how many there are.
fn number_parts<const D: usize>(labels: &mut [Label], walls: &[Wall<D>]) -> u32 {
    let mut lowest: Vec<usize> = (0..labels.len()).collect();
    let mut changed = true;
    while changed {
        changed = false;
        for wall in walls {
            let (a, b) = (wall.behind, wall.front);
            if labels[a].part().is_some() && labels[b].part().is_some() {
                let low = lowest[a].min(lowest[b]);
                changed |= lowest[a] != low || lowest[b] != low;
                lowest[a] = low;
                lowest[b] = low;
            }
        }
    }
    let mut n_parts = 0;
    for l in 0..labels.len() {
        if labels[l].part().is_some() {
            labels[l].part = if lowest[l] == l {
                n_parts += 1;
                n_parts - 1
            } else {
                labels[lowest[l]].part
            };
        }
    }
    n_parts
}

/// The piece of interface on a wall between fluid and body.
fn wet_piece<const D: usize>(labels: &[Label], wall: Wall<D>) -> Option<WetPiece<D>> {
    let (part, facet) = match (labels[wall.behind].part(), labels[wall.front].part()) {
        (None, Some(part)) => (part, wall.cover.first[0]?),
        (Some(part), None) => (part, wall.cover.first[1]?),
        _ => return None,
    };
    Some(WetPiece { part, facet, polygon: wall.polygon.points() })
}

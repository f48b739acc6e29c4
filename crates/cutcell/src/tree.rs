//! Binary space partition of a cell by facets, with convex pieces as leaves.

use mesh::{CellId, FacetId};
use smallvec::SmallVec;

use crate::clip::{Piece, Place, Polygon, Polygons, Side};
use crate::exact::{Corner, HalfSpace, Plane, Planes};

/// The subtree on one side of a node.
#[derive(Clone, Copy, Debug)]
enum Child {
    Node(u32),
    Leaf(u32),
}

impl Default for Child {
    fn default() -> Self {
        Self::Leaf(0)
    }
}

/// A convex region divided by the plane of a facet.
#[derive(Clone, Debug)]
struct InnerNode {
    plane: Plane,
    /// The section of the region by the plane.
    section: Polygon,
    /// Facets that cover a part of the section.
    cover: SmallVec<[Covering; 2]>,
    /// Subtrees behind the plane and in front of it.
    children: [Child; 2],
}

/// A facet that covers a part of the section of a node.
#[derive(Clone, Copy, Debug)]
struct Covering {
    facet: u32,
    /// Bit `i`: rim `i` of the facet bounds the covered part. The other rims do not divide the section.
    rims: u8,
}

/// A binary space partition of a cell. A plane divides only the regions that its facet crosses. All decisions are
/// exact.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree<const D: usize> {
    nodes: Vec<InnerNode>,
    leaves: Vec<Piece<D>>,
    /// Pieces whose memory is reused.
    spare: Vec<Piece<D>>,
    root: Child,
    /// Bit `i`: a facet lies on face `i` of the cell.
    aligned: u8,
    /// Facets that may have a point in common with the closed cell.
    near: Vec<u32>,
}

/// A polygon between two leaves, one behind it and one in front of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wall {
    pub(crate) behind: u32,
    pub(crate) front: u32,
    pub(crate) polygon: Polygon,
    pub(crate) cover: Cover,
}

/// Facets that lie on a wall.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Cover {
    /// Number of bodies behind the wall minus number in front of it, due to these facets.
    pub(crate) step: i32,
    /// The first facet whose normal points to the front, and the first one whose normal points to the back.
    pub(crate) first: [Option<u32>; 2],
}

/// Callback for each leaf that a polygon touches.
type Visit<'a, const D: usize> = &'a mut dyn FnMut(&mut Polygons<D>, usize, Polygon);

impl<const D: usize> Tree<D> {
    /// Divides a cell by the facets (indices) that may touch it.
    pub(crate) fn divide(&mut self, planes: &Planes<'_, D>, polygons: &mut Polygons<D>, cell: CellId, facets: &[u32]) {
        self.set_whole(planes, cell);
        let walls = cell_walls(planes, cell);
        for &facet in facets {
            let Some(crossed) = crossed_walls(planes, &walls, facet) else { continue };
            self.near.push(facet);
            if let Some(polygon) = clip_to_cell(planes, polygons, &crossed, facet, &mut self.aligned) {
                self.root = self.insert(planes, polygons, self.root, facet, polygon);
            }
        }
    }

    /// Resets the tree to the cell as the only leaf.
    pub(crate) fn set_whole(&mut self, planes: &Planes<'_, D>, cell: CellId) {
        self.nodes.clear();
        self.spare.append(&mut self.leaves);
        self.root = Child::Leaf(0);
        self.aligned = 0;
        self.near.clear();
        let ids = planes.background.cell_to_facet(cell);
        let mut faces = [Plane::mesh(ids[0]); 4];
        for (slot, &id) in faces.iter_mut().zip(ids) {
            *slot = Plane::mesh(id);
        }
        let mut whole = self.spare.pop().unwrap_or_default();
        whole.set_simplex(planes.background.simplex(cell).points(), faces);
        self.leaves.push(whole);
    }

    /// Returns whether a facet lies on a face (local number) of the cell.
    pub(crate) fn is_aligned(&self, face: usize) -> bool {
        self.aligned >> face & 1 == 1
    }

    /// Returns the facets that may have a point in common with the closed cell. Some of them are not in the tree.
    pub(crate) fn near(&self) -> &[u32] {
        &self.near
    }

    pub(crate) fn leaves(&self) -> &[Piece<D>] {
        &self.leaves
    }

    /// Divides the leaves below `at` that a piece of a facet crosses; returns the new subtree.
    fn insert(
        &mut self,
        planes: &Planes<'_, D>,
        polygons: &mut Polygons<D>,
        at: Child,
        facet: u32,
        polygon: Polygon,
    ) -> Child {
        match at {
            Child::Node(n) => {
                let n = n as usize;
                let plane = self.nodes[n].plane;
                match polygons.place(planes, polygon, plane, &planes.half_space(plane)) {
                    Place::On if self.nodes[n].cover.iter().any(|other| other.facet == facet) => {}
                    Place::On => self.nodes[n].cover.push(Covering { facet, rims: polygons.rims(polygon, facet) }),
                    Place::Behind => self.insert_below(planes, polygons, n, 0, facet, polygon),
                    Place::Front => self.insert_below(planes, polygons, n, 1, facet, polygon),
                    Place::Both(parts) => {
                        for (side, part) in parts.into_iter().enumerate() {
                            self.insert_below(planes, polygons, n, side, facet, part);
                        }
                    }
                }
                at
            }
            Child::Leaf(leaf) => {
                let plane = Plane::facet(facet);
                let mut parts: [Piece<D>; 2] = std::array::from_fn(|_| self.spare.pop().unwrap_or_default());
                let section = self.leaves[leaf as usize].split(planes, plane, polygons, parts.each_mut());
                let [mut behind, front] = parts;
                let Some(section) = section else {
                    self.spare.extend([behind, front]);
                    return at;
                };
                let children = [at, Child::Leaf(self.leaves.len() as u32)];
                std::mem::swap(&mut self.leaves[leaf as usize], &mut behind);
                self.spare.push(behind);
                self.leaves.push(front);
                let cover = SmallVec::from_iter([Covering { facet, rims: polygons.rims(polygon, facet) }]);
                self.nodes.push(InnerNode { plane, section, cover, children });
                Child::Node(self.nodes.len() as u32 - 1)
            }
        }
    }

    fn insert_below(
        &mut self,
        planes: &Planes<'_, D>,
        polygons: &mut Polygons<D>,
        node: usize,
        side: usize,
        facet: u32,
        polygon: Polygon,
    ) {
        let child = self.nodes[node].children[side];
        self.nodes[node].children[side] = self.insert(planes, polygons, child, facet, polygon);
    }

    /// Replaces `walls` by all walls between leaves.
    pub(crate) fn find_walls(&self, planes: &Planes<'_, D>, polygons: &mut Polygons<D>, walls: &mut Vec<Wall>) {
        walls.clear();
        for node in &self.nodes {
            let [behind, front] = node.children;
            self.for_each_cover(planes, polygons, node, |polygons, polygon, cover| {
                self.descend(planes, polygons, behind, polygon, &mut |polygons, behind, polygon| {
                    self.descend(planes, polygons, front, polygon, &mut |_, front, polygon| {
                        walls.push(Wall { behind: behind as u32, front: front as u32, polygon, cover });
                    });
                });
            });
        }
    }

    /// Divides the section of a node along the boundaries of its facets; calls `visit` with each piece and the facets
    /// that cover it.
    fn for_each_cover(
        &self,
        planes: &Planes<'_, D>,
        polygons: &mut Polygons<D>,
        node: &InnerNode,
        mut visit: impl FnMut(&mut Polygons<D>, Polygon, Cover),
    ) {
        let normal = planes.half_space(node.plane).normal;
        let mut pieces: SmallVec<[(Polygon, Cover); 8]> = SmallVec::new();
        let mut divided: SmallVec<[(Polygon, Cover); 8]> = SmallVec::new();
        pieces.push((node.section, Cover::default()));
        for &Covering { facet, rims } in &node.cover {
            let points_back = planes.facets[facet as usize].normal.dot(&normal) < 0.0;
            for (polygon, mut cover) in pieces.drain(..) {
                let mut rest = Some(polygon);
                for rim in (0..D).filter(|rim| rims >> rim & 1 == 1) {
                    let Some(polygon) = rest else { break };
                    let plane = Plane::rim(facet, rim);
                    rest = match polygons.place(planes, polygon, plane, &planes.half_space(plane)) {
                        Place::Behind => Some(polygon),
                        Place::On | Place::Front => {
                            divided.push((polygon, cover));
                            None
                        }
                        Place::Both([inside, outside]) => {
                            divided.push((outside, cover));
                            Some(inside)
                        }
                    };
                }
                if let Some(polygon) = rest {
                    cover.step += if points_back { -1 } else { 1 };
                    cover.first[usize::from(points_back)].get_or_insert(facet);
                    divided.push((polygon, cover));
                }
            }
            std::mem::swap(&mut pieces, &mut divided);
        }
        for (polygon, cover) in pieces {
            visit(polygons, polygon, cover);
        }
    }

    /// Divides a polygon among the leaves that it touches. On a dividing plane, these are the leaves behind the plane.
    pub(crate) fn locate(
        &self,
        planes: &Planes<'_, D>,
        polygons: &mut Polygons<D>,
        polygon: Polygon,
        visit: Visit<'_, D>,
    ) {
        self.descend(planes, polygons, self.root, polygon, visit);
    }

    fn descend(
        &self,
        planes: &Planes<'_, D>,
        polygons: &mut Polygons<D>,
        at: Child,
        polygon: Polygon,
        visit: Visit<'_, D>,
    ) {
        match at {
            Child::Leaf(leaf) => visit(polygons, leaf as usize, polygon),
            Child::Node(n) => {
                let InnerNode { plane, children: [behind, front], .. } = self.nodes[n as usize];
                match polygons.place(planes, polygon, plane, &planes.half_space(plane)) {
                    Place::On | Place::Behind => self.descend(planes, polygons, behind, polygon, visit),
                    Place::Front => self.descend(planes, polygons, front, polygon, visit),
                    Place::Both(parts) => {
                        for (part, child) in parts.into_iter().zip([behind, front]) {
                            self.descend(planes, polygons, child, part, visit);
                        }
                    }
                }
            }
        }
    }
}

/// Adds a facet as a polygon.
fn add_facet<const D: usize>(planes: &Planes<'_, D>, polygons: &mut Polygons<D>, facet: u32) -> Polygon {
    let plane = Plane::facet(facet);
    let of = &planes.facets[facet as usize];
    let rims: [Plane; 3] = std::array::from_fn(|k| Plane::rim(facet, k));
    let side = |k: usize| {
        let on = if D == 2 { [plane, rims[k], plane] } else { [plane, rims[k], rims[(k + 2) % 3]] };
        Side { corner: Corner::of_surface(of.points()[k], on, of.vertices[k]), beyond: rims[k] }
    };
    polygons.push(plane, (0..D).map(side))
}

/// A face of a cell (local number), and whether the cell lies in front of it.
#[derive(Clone, Copy)]
struct CellWall<const D: usize> {
    local: usize,
    plane: Plane,
    half_space: HalfSpace<D>,
    is_in_front: bool,
}

type CellWalls<const D: usize> = SmallVec<[CellWall<D>; 4]>;

fn cell_walls<const D: usize>(planes: &Planes<'_, D>, cell: CellId) -> CellWalls<D> {
    let background = planes.background;
    let wall = |(local, &face): (usize, &FacetId)| {
        // The normals of faces point out of their first cell.
        let plane = Plane::mesh(face);
        let is_in_front = background.facet_to_cell(face)[0] != Some(cell);
        CellWall { local, plane, half_space: planes.half_space(plane), is_in_front }
    };
    background.cell_to_facet(cell).iter().enumerate().map(wall).collect()
}

/// Returns the walls that a facet may cross or touch, or `None` if it lies strictly beyond one of them.
fn crossed_walls<'w, const D: usize>(
    planes: &Planes<'_, D>,
    walls: &'w [CellWall<D>],
    facet: u32,
) -> Option<SmallVec<[&'w CellWall<D>; 4]>> {
    let mut crossed = SmallVec::new();
    for wall in walls {
        let (mut is_beyond, mut is_within) = (true, true);
        for x in planes.facets[facet as usize].points() {
            let (distance, doubt) = wall.half_space.distance(x);
            let outwards = if wall.is_in_front { -distance } else { distance };
            is_beyond &= outwards > doubt;
            is_within &= outwards < -doubt;
        }
        if is_beyond {
            return None;
        }
        if !is_within {
            crossed.push(wall);
        }
    }
    Some(crossed)
}

/// Clips a facet to the walls of a cell. Returns `None` if it lies outside of the cell or on a wall. In the latter case
/// the bit of the wall is set in `aligned`.
fn clip_to_cell<const D: usize>(
    planes: &Planes<'_, D>,
    polygons: &mut Polygons<D>,
    walls: &[&CellWall<D>],
    facet: u32,
    aligned: &mut u8,
) -> Option<Polygon> {
    let whole = add_facet(planes, polygons, facet);
    let mut polygon = whole;
    for wall in walls {
        let is_in_front = wall.is_in_front;
        match (polygons.place_one(planes, polygon, wall.plane, &wall.half_space, is_in_front), is_in_front) {
            (Place::On, _) => {
                *aligned |= 1 << wall.local;
                polygons.forget(whole);
                return None;
            }
            (Place::Behind, false) | (Place::Front, true) => {}
            (Place::Behind, true) | (Place::Front, false) => {
                polygons.forget(whole);
                return None;
            }
            (Place::Both(within), _) => polygon = within,
        }
    }
    Some(polygon)
}

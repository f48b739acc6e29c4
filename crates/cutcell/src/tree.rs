//! A cell divided by facets: a tree of planes with convex pieces as its leaves.

use mesh::{CellId, FacetId};
use smallvec::SmallVec;

use crate::clip::{Piece, Place, Polygon};
use crate::exact::{Corner, HalfSpace, Plane, Planes};

/// What lies on one side of a node.
#[derive(Clone, Copy, Debug)]
enum Child {
    Node(u32),
    Leaf(u32),
}

/// A convex region divided by the plane of a facet.
#[derive(Clone, Debug)]
struct Node<const D: usize> {
    plane: Plane,
    /// The section of the region by the plane.
    section: Polygon<D>,
    /// Facets with an area on the section.
    cover: Vec<u32>,
    /// What lies behind the plane, and in front of it.
    children: [Child; 2],
}

/// A binary space partition of a cell, a plane only where its facet is. All decisions are exact.
#[derive(Clone, Debug)]
pub(crate) struct Tree<const D: usize> {
    nodes: Vec<Node<D>>,
    leaves: Vec<Piece<D>>,
    root: Child,
    /// Bit `i`: a facet lies on face `i` of the cell.
    aligned: u8,
}

/// Where two leaves touch: a polygon between the one behind it and the one in front of it.
#[derive(Clone, Debug)]
pub(crate) struct Wall<const D: usize> {
    pub(crate) behind: usize,
    pub(crate) front: usize,
    pub(crate) polygon: Polygon<D>,
    pub(crate) cover: Cover,
}

/// Facets that lie on a wall.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Cover {
    /// Bodies behind the wall less bodies in front of it, through these facets.
    pub(crate) step: i32,
    /// The first facet whose normal points to the front, and the first one whose normal points to the back.
    pub(crate) first: [Option<u32>; 2],
}

impl<const D: usize> Tree<D> {
    /// Divides a cell by the facets (indices) that may touch it.
    pub(crate) fn new(planes: &Planes<'_, D>, cell: CellId, facets: &[u32]) -> Self {
        let leaves = vec![whole_cell(planes, cell)];
        let mut tree = Self { nodes: Vec::new(), leaves, root: Child::Leaf(0), aligned: 0 };
        let walls = cell_walls(planes, cell);
        for &facet in facets {
            if let Some(polygon) = clip_to_cell(planes, &walls, facet, &mut tree.aligned) {
                tree.root = tree.insert(planes, tree.root, facet, polygon);
            }
        }
        tree
    }

    /// Whether a facet lies on a face (local number) of the cell.
    pub(crate) fn is_aligned(&self, face: usize) -> bool {
        self.aligned >> face & 1 == 1
    }

    pub(crate) fn leaves(&self) -> &[Piece<D>] {
        &self.leaves
    }

    /// Divides the leaves below `at` that a piece of a facet runs through.
    fn insert(&mut self, planes: &Planes<'_, D>, at: Child, facet: u32, polygon: Polygon<D>) -> Child {
        match at {
            Child::Node(n) => {
                let n = n as usize;
                let plane = self.nodes[n].plane;
                match polygon.place(planes, plane, &planes.half_space(plane)) {
                    Place::On if self.nodes[n].cover.contains(&facet) => {}
                    Place::On => self.nodes[n].cover.push(facet),
                    Place::Behind => self.insert_below(planes, n, 0, facet, polygon),
                    Place::Front => self.insert_below(planes, n, 1, facet, polygon),
                    Place::Both(parts) => {
                        for (side, part) in (*parts).into_iter().enumerate() {
                            self.insert_below(planes, n, side, facet, part);
                        }
                    }
                }
                at
            }
            Child::Leaf(leaf) => {
                let plane = Plane::facet(facet);
                let Some(([behind, front], section)) = self.leaves[leaf as usize].split(planes, plane) else {
                    return at;
                };
                let children = [at, Child::Leaf(self.leaves.len() as u32)];
                self.leaves[leaf as usize] = behind;
                self.leaves.push(front);
                self.nodes.push(Node { plane, section, cover: vec![facet], children });
                Child::Node(self.nodes.len() as u32 - 1)
            }
        }
    }

    fn insert_below(&mut self, planes: &Planes<'_, D>, node: usize, side: usize, facet: u32, polygon: Polygon<D>) {
        let child = self.nodes[node].children[side];
        self.nodes[node].children[side] = self.insert(planes, child, facet, polygon);
    }

    /// All walls between leaves.
    pub(crate) fn walls(&self, planes: &Planes<'_, D>) -> Vec<Wall<D>> {
        let mut walls = Vec::new();
        for node in &self.nodes {
            for (polygon, cover) in self.covered(planes, node) {
                self.descend(planes, node.children[0], polygon, &mut |behind, polygon| {
                    self.descend(planes, node.children[1], polygon, &mut |front, polygon| {
                        walls.push(Wall { behind, front, polygon, cover });
                    });
                });
            }
        }
        walls
    }

    /// The section of a node, divided into what facets cover and what they do not.
    fn covered(&self, planes: &Planes<'_, D>, node: &Node<D>) -> Vec<(Polygon<D>, Cover)> {
        let normal = planes.half_space(node.plane).normal;
        let mut pieces = vec![(node.section.clone(), Cover::default())];
        for &facet in &node.cover {
            let points_back = planes.facets[facet as usize].normal.dot(&normal) < 0.0;
            let mut divided = Vec::with_capacity(pieces.len() + D);
            for (polygon, mut cover) in pieces {
                let mut rest = Some(polygon);
                for rim in 0..D {
                    let Some(polygon) = rest else { break };
                    let plane = Plane::rim(facet, rim);
                    rest = match polygon.place(planes, plane, &planes.half_space(plane)) {
                        Place::Behind => Some(polygon),
                        Place::On | Place::Front => {
                            divided.push((polygon, cover));
                            None
                        }
                        Place::Both(parts) => {
                            let [inside, outside] = *parts;
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
            pieces = divided;
        }
        pieces
    }

    /// Divides a polygon among the leaves that it touches, from one side.
    pub(crate) fn locate(&self, planes: &Planes<'_, D>, polygon: Polygon<D>, mut visit: impl FnMut(usize, Polygon<D>)) {
        self.descend(planes, self.root, polygon, &mut visit);
    }

    fn descend(
        &self,
        planes: &Planes<'_, D>,
        at: Child,
        polygon: Polygon<D>,
        visit: &mut dyn FnMut(usize, Polygon<D>),
    ) {
        match at {
            Child::Leaf(leaf) => visit(leaf as usize, polygon),
            Child::Node(n) => {
                let Node { plane, children: [behind, front], .. } = self.nodes[n as usize];
                match polygon.place(planes, plane, &planes.half_space(plane)) {
                    Place::On | Place::Behind => self.descend(planes, behind, polygon, visit),
                    Place::Front => self.descend(planes, front, polygon, visit),
                    Place::Both(parts) => {
                        for (part, child) in (*parts).into_iter().zip([behind, front]) {
                            self.descend(planes, child, part, visit);
                        }
                    }
                }
            }
        }
    }
}

/// A cell in one piece.
pub(crate) fn whole_cell<const D: usize>(planes: &Planes<'_, D>, cell: CellId) -> Piece<D> {
    let ids = planes.background.cell_to_facet(cell);
    let mut faces = [Plane::mesh(ids[0]); 4];
    for (slot, &id) in faces.iter_mut().zip(ids) {
        *slot = Plane::mesh(id);
    }
    Piece::simplex(planes.background.simplex(cell).points(), faces)
}

/// A facet as a polygon.
fn facet_polygon<const D: usize>(planes: &Planes<'_, D>, facet: u32) -> Polygon<D> {
    let plane = Plane::facet(facet);
    let of = &planes.facets[facet as usize];
    let rims: [Plane; 3] = std::array::from_fn(|k| Plane::rim(facet, k));
    let corner = |k: usize| {
        let on = if D == 2 { [plane, rims[k], plane] } else { [plane, rims[k], rims[(k + 2) % 3]] };
        Corner::of_surface(of.points()[k], on, of.vertices[k])
    };
    let mut polygon = Polygon::on(plane);
    (0..D).for_each(|k| polygon.push(corner(k), rims[k]));
    polygon
}

/// A face of a cell, and whether the cell lies in front of it.
type CellWall<const D: usize> = (Plane, HalfSpace<D>, bool);

fn cell_walls<const D: usize>(planes: &Planes<'_, D>, cell: CellId) -> SmallVec<[CellWall<D>; 4]> {
    let background = planes.background;
    let wall = |&face: &FacetId| {
        // The normals of faces point out of their first cell.
        let plane = Plane::mesh(face);
        (plane, planes.half_space(plane), background.facet_to_cell(face)[0] != Some(cell))
    };
    background.cell_to_facet(cell).iter().map(wall).collect()
}

/// What of a facet lies inside a cell; notes if it lies on a face instead.
fn clip_to_cell<const D: usize>(
    planes: &Planes<'_, D>,
    walls: &[CellWall<D>],
    facet: u32,
    aligned: &mut u8,
) -> Option<Polygon<D>> {
    let mut polygon = facet_polygon(planes, facet);
    for (local, (plane, half_space, is_in_front)) in walls.iter().enumerate() {
        match (polygon.place(planes, *plane, half_space), *is_in_front) {
            (Place::On, _) => {
                *aligned |= 1 << local;
                return None;
            }
            (Place::Behind, false) | (Place::Front, true) => {}
            (Place::Behind, true) | (Place::Front, false) => return None,
            (Place::Both(parts), is_in_front) => {
                let [behind, front] = *parts;
                polygon = if is_in_front { front } else { behind };
            }
        }
    }
    Some(polygon)
}

//! Cutting one background cell.

use mesh::{Point, Vector};

use crate::clip::{FaceLabel, Polytope, face_difference, face_overlap};
use crate::predicates::{End, crossing};
use crate::surface::Facet;

/// A convex piece of a cell that no facet crosses.
#[derive(Clone, Debug)]
pub(crate) struct Leaf<const D: usize> {
    pub(crate) polytope: Polytope<D>,
    /// Number of bodies around it.
    pub(crate) depth: i32,
    /// Fluid part of the cell that it belongs to; meaningless in a body.
    pub(crate) part: u32,
}

impl<const D: usize> Leaf<D> {
    pub(crate) fn is_fluid(&self) -> bool {
        self.depth <= 0
    }
}

/// A piece of a facet with fluid on the side of its normal and the body on the other.
#[derive(Clone, Debug)]
pub(crate) struct WetPiece<const D: usize> {
    pub(crate) part: u32,
    pub(crate) facet: u32,
    pub(crate) polygon: Vec<Point<D>>,
}

/// A face between fluid and body that no facet covers.
///
/// The plane of a facet goes on behind the facet's end. Where it stays closer to another plane than the tolerance, it
/// cuts off a tail of no thickness, which belongs to a body but has fluid on both sides.
#[derive(Clone, Debug)]
pub(crate) struct Bare<const D: usize> {
    pub(crate) leaf: usize,
    /// Towards the fluid.
    pub(crate) normal: Vector<D>,
    pub(crate) polygon: Vec<Point<D>>,
}

/// A cell with everything that facets do to its inside.
#[derive(Clone, Debug)]
pub(crate) struct CellCut<const D: usize> {
    pub(crate) leaves: Vec<Leaf<D>>,
    pub(crate) n_parts: u32,
    pub(crate) wet: Vec<WetPiece<D>>,
    pub(crate) bare: Vec<Bare<D>>,
}

/// Cuts a cell by the facets (indices into `all`) that may touch it. `depth` is the number of bodies around the
/// first vertex of the cell.
pub(crate) fn cut_cell<const D: usize>(
    corners: &[Point<D>],
    depth: i32,
    facets: &[u32],
    all: &[Facet<D>],
    tolerance: f64,
) -> CellCut<D> {
    let polytopes = split_by_facets(corners, facets, all, tolerance);
    let mut leaves: Vec<Leaf<D>> = polytopes
        .into_iter()
        .map(|polytope| {
            let at = polytope.inner_point();
            let change: i32 =
                facets.iter().map(|&f| crossing(&corners[0], End::Point(&at), all[f as usize].points())).sum();
            Leaf { polytope, depth: depth + change, part: 0 }
        })
        .collect();
    let mut connected = Vec::new();
    let mut wet = Vec::new();
    let mut bare: Vec<Bare<D>> = Vec::new();
    for wall in walls(&leaves, all, tolerance) {
        // Behind the plane of one facet may lie fluid, and another body in front of it.
        let normal = all[wall.facet as usize].normal;
        let (leaf, normal) = match (leaves[wall.back].is_fluid(), leaves[wall.front].is_fluid()) {
            (false, true) => (wall.front, normal),
            (true, false) => (wall.back, -normal),
            (true, true) => {
                connected.push([wall.back, wall.front]);
                continue;
            }
            (false, false) => continue,
        };
        let rest = cover_by_facets(wall.polygon, &normal, facets, all, tolerance, |facet, polygon| {
            wet.push((leaf, facet, polygon));
        });
        bare.extend(rest.into_iter().map(|polygon| Bare { leaf, normal, polygon }));
    }
    pair_bare(&mut bare, tolerance, |a, b| connected.push([a, b]));
    let n_parts = number_parts(&mut leaves, &connected);
    let part = |leaf: usize| leaves[leaf].part;
    let wet = wet.into_iter().map(|(leaf, facet, polygon)| WetPiece { part: part(leaf), facet, polygon }).collect();
    CellCut { leaves, n_parts, wet, bare }
}

/// Joins the fluid on the two sides of tails of no thickness; keeps what has no partner in the cell.
fn pair_bare<const D: usize>(bare: &mut Vec<Bare<D>>, tolerance: f64, mut join: impl FnMut(usize, usize)) {
    let mut k = 0;
    while k < bare.len() {
        let (first, others) = bare.split_at(k + 1);
        let a = &first[k];
        let mut rest = vec![a.polygon.clone()];
        for b in others {
            if a.normal.dot(&b.normal) < 0.0 && a.leaf != b.leaf && subtract_facing(&mut rest, &a.normal, b, tolerance)
            {
                join(a.leaf, b.leaf);
            }
        }
        let (leaf, normal) = (a.leaf, a.normal);
        let replaced: Vec<Bare<D>> = rest.into_iter().map(|polygon| Bare { leaf, normal, polygon }).collect();
        let n = replaced.len();
        bare.splice(k..=k, replaced);
        k += n;
    }
}

/// Takes away from `polygons` what faces a bare face across no distance; returns whether there was anything.
pub(crate) fn subtract_facing<const D: usize>(
    polygons: &mut Vec<Vec<Point<D>>>,
    normal: &Vector<D>,
    bare: &Bare<D>,
    tolerance: f64,
) -> bool {
    let mut found = false;
    let mut overlap = Vec::new();
    let mut left = Vec::new();
    for polygon in polygons.drain(..) {
        let is_near = |x: &Point<D>| {
            normal.dot(&(x - polygon[0])).abs() <= REACH_OF_TAILS * tolerance
                && bare.normal.dot(&(x - bare.polygon[0])).abs() <= REACH_OF_TAILS * tolerance
        };
        if face_overlap(&polygon, &bare.polygon, normal, tolerance, &mut overlap) > 0.0 && overlap.iter().all(is_near) {
            found = true;
            face_difference(&polygon, &bare.polygon, normal, tolerance, &mut left);
        } else {
            left.push(polygon);
        }
    }
    *polygons = left;
    found
}

/// A tail is at most as thick as the snapping of the points at its ends.
const REACH_OF_TAILS: f64 = 16.0;

/// Splits a cell by the planes of the facets that cross it, each plane only through the pieces that its facet
/// really enters.
fn split_by_facets<const D: usize>(
    corners: &[Point<D>],
    facets: &[u32],
    all: &[Facet<D>],
    tolerance: f64,
) -> Vec<Polytope<D>> {
    let mut pieces = vec![Polytope::simplex(corners)];
    let mut distances = Vec::new();
    let mut section = Vec::new();
    let mut overlap = Vec::new();
    for &index in facets {
        let facet = &all[index as usize];
        let mut k = 0;
        while k < pieces.len() {
            let piece = &pieces[k];
            distances.clear();
            distances.extend(piece.points().iter().map(|x| facet.distance(x, tolerance)));
            if distances.iter().any(|d| *d < 0.0) && distances.iter().any(|d| *d > 0.0) {
                if !piece.crosses_cleanly(&distances) {
                    distances.clear();
                    distances.extend(piece.points().iter().map(|x| facet.distance(x, 0.0)));
                }
                piece.cross_section(&distances, &facet.normal, &mut section);
                if face_overlap(&section, facet.points(), &facet.normal, tolerance, &mut overlap) > 0.0 {
                    let [back, front] = piece.split(&distances, &facet.normal, index);
                    pieces[k] = back;
                    k += 1;
                    pieces.insert(k, front);
                }
            }
            k += 1;
        }
    }
    pieces
}

/// Where two leaves of a cell touch, on the plane of a facet.
struct Wall<const D: usize> {
    facet: u32,
    back: usize,
    front: usize,
    polygon: Vec<Point<D>>,
}

fn walls<const D: usize>(leaves: &[Leaf<D>], all: &[Facet<D>], tolerance: f64) -> Vec<Wall<D>> {
    let mut faces: Vec<(u32, bool, usize, usize)> = Vec::new();
    for (l, leaf) in leaves.iter().enumerate() {
        for (f, (label, _)) in leaf.polytope.faces().enumerate() {
            if let FaceLabel::Plane { facet, front } = label {
                faces.push((facet, front, l, f));
            }
        }
    }
    faces.sort_unstable();
    let mut walls = Vec::new();
    let mut overlap = Vec::new();
    for on_plane in faces.chunk_by(|a, b| a.0 == b.0) {
        let normal = &all[on_plane[0].0 as usize].normal;
        let n_back = on_plane.partition_point(|face| !face.1);
        for &(facet, _, back, back_face) in &on_plane[..n_back] {
            let a: Vec<Point<D>> = leaves[back].polytope.face_points(back_face).collect();
            for &(_, _, front, front_face) in &on_plane[n_back..] {
                let b: Vec<Point<D>> = leaves[front].polytope.face_points(front_face).collect();
                if face_overlap(&a, &b, normal, tolerance, &mut overlap) > 0.0 {
                    walls.push(Wall { facet, back, front, polygon: overlap.clone() });
                }
            }
        }
    }
    walls
}

/// Numbers the connected sets of fluid leaves in the order of their first leaf.
fn number_parts<const D: usize>(leaves: &mut [Leaf<D>], connected: &[[usize; 2]]) -> u32 {
    let mut lowest: Vec<usize> = (0..leaves.len()).collect();
    let mut changed = true;
    while changed {
        changed = false;
        for &[a, b] in connected {
            let low = lowest[a].min(lowest[b]);
            changed |= lowest[a] != low || lowest[b] != low;
            lowest[a] = low;
            lowest[b] = low;
        }
    }
    let mut n_parts = 0;
    for l in 0..leaves.len() {
        if leaves[l].is_fluid() {
            leaves[l].part = if lowest[l] == l {
                n_parts += 1;
                n_parts - 1
            } else {
                leaves[lowest[l]].part
            };
        }
    }
    n_parts
}

/// Hands each piece of a wet face to the facet that covers it, once, in the order of the facets; returns what no
/// facet covers.
pub(crate) fn cover_by_facets<const D: usize>(
    face: Vec<Point<D>>,
    normal: &Vector<D>,
    facets: &[u32],
    all: &[Facet<D>],
    tolerance: f64,
    mut visit: impl FnMut(u32, Vec<Point<D>>),
) -> Vec<Vec<Point<D>>> {
    let mut rest = vec![face];
    let mut overlap = Vec::new();
    for &index in facets {
        let facet = &all[index as usize];
        if facet.normal.dot(normal) <= 0.0 {
            continue;
        }
        let mut left = Vec::new();
        for polygon in rest {
            // The overlap must lie on both planes; the tolerance is wider than the one that put points on them.
            let lies_on_both = |x: &Point<D>| {
                facet.distance(x, 8.0 * tolerance) == 0.0 && normal.dot(&(x - polygon[0])).abs() <= 8.0 * tolerance
            };
            if face_overlap(&polygon, facet.points(), normal, tolerance, &mut overlap) > 0.0
                && overlap.iter().all(lies_on_both)
            {
                visit(index, overlap.clone());
                face_difference(&polygon, facet.points(), normal, tolerance, &mut left);
            } else {
                left.push(polygon);
            }
        }
        rest = left;
    }
    rest
}

//! Trees of boxes: the broad phase of every search, and the only file that names parry.

use parry2d_f64::bounding_volume::Aabb as PlanarBox;
use parry2d_f64::math::Vector as PlanarVector;
use parry2d_f64::partitioning::{self as planar, Bvh as PlanarTree, BvhBuildStrategy as PlanarStrategy};
use parry3d_f64::bounding_volume::Aabb as SpatialBox;
use parry3d_f64::math::Vector as SpatialVector;
use parry3d_f64::partitioning::{self as spatial, Bvh as SpatialTree, BvhBuildStrategy as SpatialStrategy};

use crate::Point;

/// Boxes are inflated by this fraction of their largest side or coordinate, so that round-off hides none.
const INFLATION: f64 = 1e-9;

/// A tree of axis-parallel boxes, numbered in the order in which they were given.
#[derive(Clone)]
pub(super) struct BoxTree<const D: usize> {
    tree: Tree,
}

#[derive(Clone)]
enum Tree {
    Planar(PlanarTree),
    Spatial(SpatialTree),
}

impl<const D: usize> BoxTree<D> {
    /// The tree of the boxes around the given sets of points.
    pub(super) fn around<'p>(sets: impl Iterator<Item = &'p [Point<D>]>) -> Self {
        let boxes = sets.map(box_around);
        let tree = match D {
            2 => {
                let leaves: Vec<_> = boxes.map(|(min, max)| planar_box(&min, &max)).collect();
                Tree::Planar(PlanarTree::from_leaves(PlanarStrategy::Binned, &leaves))
            }
            _ => {
                let leaves: Vec<_> = boxes.map(|(min, max)| spatial_box(&min, &max)).collect();
                Tree::Spatial(SpatialTree::from_leaves(SpatialStrategy::Binned, &leaves))
            }
        };
        Self { tree }
    }

    /// Visits every box that overlaps the one from `min` to `max`, and perhaps some that barely do not.
    pub(super) fn overlapping(&self, min: &Point<D>, max: &Point<D>, visit: impl FnMut(u32)) {
        match &self.tree {
            Tree::Planar(tree) => tree.intersect_aabb(&planar_box(min, max)).for_each(visit),
            Tree::Spatial(tree) => tree.intersect_aabb(&spatial_box(min, max)).for_each(visit),
        }
    }

    /// The box with the smallest `distance` of its content from `x`, which must be no less than the distance of the
    /// box; `None` without boxes.
    pub(super) fn nearest(&self, x: &Point<D>, distance: impl Fn(u32) -> f64) -> Option<u32> {
        match &self.tree {
            Tree::Planar(tree) => {
                let x = planar_vector(x);
                let to_box =
                    |node: &planar::BvhNode, _| (node.mins() - x).max(x - node.maxs()).max(PlanarVector::ZERO).length();
                tree.find_best(f64::MAX, to_box, |leaf, _| Some(distance(leaf))).map(|(leaf, _)| leaf)
            }
            Tree::Spatial(tree) => {
                let x = spatial_vector(x);
                let to_box = |node: &spatial::BvhNode, _| {
                    (node.mins() - x).max(x - node.maxs()).max(SpatialVector::ZERO).length()
                };
                tree.find_best(f64::MAX, to_box, |leaf, _| Some(distance(leaf))).map(|(leaf, _)| leaf)
            }
        }
    }
}

/// Corners of the slightly inflated box around the points.
fn box_around<const D: usize>(points: &[Point<D>]) -> (Point<D>, Point<D>) {
    let mut min = Point::<D>::repeat(f64::INFINITY);
    let mut max = -min;
    for x in points {
        min = min.inf(x);
        max = max.sup(x);
    }
    let margin = Point::repeat(INFLATION * (max - min).amax().max(min.amax()).max(max.amax()));
    (min - margin, max + margin)
}

fn planar_vector<const D: usize>(x: &Point<D>) -> PlanarVector {
    PlanarVector::new(x[0], x[1])
}

fn spatial_vector<const D: usize>(x: &Point<D>) -> SpatialVector {
    SpatialVector::new(x[0], x[1], x[2])
}

fn planar_box<const D: usize>(min: &Point<D>, max: &Point<D>) -> PlanarBox {
    PlanarBox::new(planar_vector(min), planar_vector(max))
}

fn spatial_box<const D: usize>(min: &Point<D>, max: &Point<D>) -> SpatialBox {
    SpatialBox::new(spatial_vector(min), spatial_vector(max))
}

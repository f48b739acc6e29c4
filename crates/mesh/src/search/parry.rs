//! Trees of bounding boxes: the broad phase of every search. The only file that depends on parry.

use parry2d_f64::bounding_volume::Aabb as PlanarBox;
use parry2d_f64::math::Vector as PlanarVector;
use parry2d_f64::partitioning::{self as planar, Bvh as PlanarTree, BvhBuildStrategy as PlanarStrategy};
use parry3d_f64::bounding_volume::Aabb as SpatialBox;
use parry3d_f64::math::Vector as SpatialVector;
use parry3d_f64::partitioning::{self as spatial, Bvh as SpatialTree, BvhBuildStrategy as SpatialStrategy};

use crate::{Aabb, Point};

/// Boxes are inflated by this fraction of their largest side or coordinate, so that round-off does not lose overlaps.
const INFLATION: f64 = 1e-9;

/// A tree of bounding boxes, numbered in the order in which they were given.
#[derive(Clone)]
pub(super) struct BoxTree<const D: usize> {
    tree: ParryTree,
}

#[derive(Clone)]
enum ParryTree {
    Planar(PlanarTree),
    Spatial(SpatialTree),
}

impl<const D: usize> BoxTree<D> {
    /// Builds the tree of the given boxes, slightly inflated.
    pub(super) fn new(boxes: impl Iterator<Item = Aabb<D>>) -> Self {
        let boxes = boxes.map(|b| b.expanded(INFLATION * b.extent().amax().max(b.low.amax()).max(b.high.amax())));
        let tree = match D {
            2 => {
                let leaves: Vec<_> = boxes.map(|b| planar_box(&b)).collect();
                ParryTree::Planar(PlanarTree::from_leaves(PlanarStrategy::Binned, &leaves))
            }
            _ => {
                let leaves: Vec<_> = boxes.map(|b| spatial_box(&b)).collect();
                ParryTree::Spatial(SpatialTree::from_leaves(SpatialStrategy::Binned, &leaves))
            }
        };
        Self { tree }
    }

    /// Visits every box that overlaps the region, and possibly some that are within round-off of it.
    pub(super) fn overlapping(&self, region: &Aabb<D>, visit: impl FnMut(u32)) {
        match &self.tree {
            ParryTree::Planar(tree) => tree.intersect_aabb(&planar_box(region)).for_each(visit),
            ParryTree::Spatial(tree) => tree.intersect_aabb(&spatial_box(region)).for_each(visit),
        }
    }

    /// Returns the box whose content has the smallest `distance` from `x`, or `None` if there are no boxes. The
    /// distance of the content must not be smaller than that of the box.
    pub(super) fn nearest(&self, x: &Point<D>, distance: impl Fn(u32) -> f64) -> Option<u32> {
        match &self.tree {
            ParryTree::Planar(tree) => {
                let x = planar_vector(x);
                let to_box =
                    |node: &planar::BvhNode, _| (node.mins() - x).max(x - node.maxs()).max(PlanarVector::ZERO).length();
                tree.find_best(f64::MAX, to_box, |leaf, _| Some(distance(leaf))).map(|(leaf, _)| leaf)
            }
            ParryTree::Spatial(tree) => {
                let x = spatial_vector(x);
                let to_box = |node: &spatial::BvhNode, _| {
                    (node.mins() - x).max(x - node.maxs()).max(SpatialVector::ZERO).length()
                };
                tree.find_best(f64::MAX, to_box, |leaf, _| Some(distance(leaf))).map(|(leaf, _)| leaf)
            }
        }
    }
}

fn planar_vector<const D: usize>(x: &Point<D>) -> PlanarVector {
    PlanarVector::new(x[0], x[1])
}

fn spatial_vector<const D: usize>(x: &Point<D>) -> SpatialVector {
    SpatialVector::new(x[0], x[1], x[2])
}

fn planar_box<const D: usize>(bounds: &Aabb<D>) -> PlanarBox {
    PlanarBox::new(planar_vector(&bounds.low), planar_vector(&bounds.high))
}

fn spatial_box<const D: usize>(bounds: &Aabb<D>) -> SpatialBox {
    SpatialBox::new(spatial_vector(&bounds.low), spatial_vector(&bounds.high))
}

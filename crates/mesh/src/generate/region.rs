//! Regions near which cells are finer than elsewhere.

use std::sync::Arc;

use super::size::{STEEPEST, Size, affordable};
use crate::search::SurfaceIndex;
use crate::{Aabb, ParameterError, Point, non_negative, positive, require};

/// A part of space in which cells have a given size. Outside, the size grows linearly with the distance from this part.
#[derive(Clone, Debug)]
pub struct Region<const D: usize> {
    /// The part of space.
    pub shape: RegionShape<D>,
    /// Size of the cells in this part, as in [`Size`].
    pub size: f64,
    /// Increase of the size per distance, at most one half.
    pub growth: f64,
}

/// A part of space.
#[derive(Clone, Debug)]
pub enum RegionShape<const D: usize> {
    /// All points within a distance of a segment; a ball if its ends coincide.
    Segment {
        /// Ends of the segment.
        ends: [Point<D>; 2],
        /// The distance, which may be zero.
        within: f64,
    },
    /// Box with its sides along the axes.
    Box(Aabb<D>),
    /// All points within a distance of a surface.
    Surface {
        /// The surface.
        index: Arc<SurfaceIndex<D>>,
        /// Whether the points inside the surface, which is then closed, belong to the region.
        is_filled: bool,
        /// The distance, which may be zero.
        within: f64,
    },
}

impl<const D: usize> RegionShape<D> {
    /// Returns the distance of a point, zero inside.
    fn distance(&self, x: &Point<D>) -> f64 {
        match self {
            Self::Segment { ends: [a, b], within } => {
                let along = b - a;
                let length_squared = along.norm_squared();
                let t = if length_squared > 0.0 { (x - a).dot(&along) / length_squared } else { 0.0 };
                ((x - a - along * t.clamp(0.0, 1.0)).norm() - within).max(0.0)
            }
            Self::Box(Aabb { low, high }) => (x - x.sup(low).inf(high)).norm(),
            Self::Surface { index, is_filled, within } => {
                let signed = index.signed_distance(x).unwrap_or(f64::INFINITY);
                let distance = if *is_filled { signed } else { signed.abs() };
                (distance - within).max(0.0)
            }
        }
    }
}

impl<const D: usize> Region<D> {
    /// Returns the size of cells at a point for this region.
    pub fn at(&self, x: &Point<D>) -> f64 {
        self.size + self.growth * self.shape.distance(x)
    }

    /// Checks the parameters for a background box with cells of size `coarse`.
    ///
    /// # Errors
    /// A size that is not positive or larger than the coarse one, growth out of its range, a box outside of the
    /// background, an end of a segment outside of it, or too many cells.
    pub fn check(&self, min: [f64; D], max: [f64; D], coarse: &Size) -> Result<(), ParameterError> {
        positive("size of the region", self.size)?;
        let is_finer = self.size <= coarse.coarsest();
        require(is_finer, "size of the region", self.size, "at most the size of the background around it")?;
        let can_follow = self.growth > 0.0 && self.growth <= STEEPEST;
        require(can_follow, "growth of the region", self.growth, "positive and at most 0.5")?;
        let n_cells = match &self.shape {
            &RegionShape::Segment { ends: [a, b], within } => {
                non_negative("radius of the region", within)?;
                for (k, x) in a.iter().enumerate().chain(b.iter().enumerate()) {
                    let is_inside = min[k] <= *x && *x <= max[k];
                    require(is_inside, "coordinate of the region", *x, "within the background")?;
                }
                ((b - a).norm() + within) / self.size * (within / self.size).max(1.0).powi(D as i32 - 1)
            }
            RegionShape::Surface { index, within, .. } => {
                let within = non_negative("distance from the surface", *within)?;
                let surface = index.surface();
                let area: f64 = surface.boundary().facets().map(|facet| surface.facet_measure(facet)).sum();
                area / self.size.powi(D as i32 - 1) * (within / self.size).max(1.0)
            }
            RegionShape::Box(Aabb { low, high }) => {
                let mut n_cells = 1.0;
                for k in 0..D {
                    require(low[k] <= high[k], "highest corner of the region", high[k], "above the lowest corner")?;
                    require(low[k] <= max[k], "lowest corner of the region", low[k], "within the background")?;
                    require(high[k] >= min[k], "highest corner of the region", high[k], "within the background")?;
                    n_cells *= ((high[k].min(max[k]) - low[k].max(min[k])) / self.size).max(1.0);
                }
                n_cells
            }
        };
        affordable(n_cells).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(shape: RegionShape<2>) -> Region<2> {
        Region { shape, size: 0.1, growth: 0.2 }
    }

    fn segment(a: [f64; 2], b: [f64; 2], within: f64) -> Region<2> {
        region(RegionShape::Segment { ends: [a.into(), b.into()], within })
    }

    fn boxed(low: [f64; 2], high: [f64; 2]) -> Region<2> {
        region(RegionShape::Box(Aabb { low: low.into(), high: high.into() }))
    }

    #[test]
    fn the_size_grows_with_the_distance() {
        let at = |region: &Region<2>, x: f64, y: f64| region.at(&Point::<2>::new(x, y));
        let line = segment([0.0, 0.0], [4.0, 0.0], 1.0);
        assert_eq!((at(&line, 2.0, 0.5), at(&line, 2.0, 3.0), at(&line, 7.0, 4.0)), (0.1, 0.5, 0.9));
        let ball = segment([1.0, 1.0], [1.0, 1.0], 2.0);
        assert_eq!((at(&ball, 2.0, 2.0), at(&ball, 1.0, 5.0)), (0.1, 0.5));
        let square = boxed([0.0, 0.0], [1.0, 2.0]);
        assert_eq!((at(&square, 0.5, 1.0), at(&square, 4.0, 6.0), at(&square, 0.5, 4.0)), (0.1, 1.1, 0.5));
    }

    #[test]
    fn the_distance_from_a_surface_counts_outside_and_where_it_is_not_filled_inside() {
        let mesh = crate::generate::structured_box([0.0, 0.0], [2.0, 2.0], [1, 1]).expect("a box");
        let surface = mesh.boundary();
        let index = Arc::new(SurfaceIndex::new(&crate::Placed::new(&surface, mesh.vertices())));
        let at = |is_filled, x: f64| {
            region(RegionShape::Surface { index: Arc::clone(&index), is_filled, within: 0.25 })
                .at(&Point::<2>::new(x, 1.0))
        };
        for (x, hollow, filled) in [(4.0, 0.45, 0.45), (2.1, 0.1, 0.1), (1.9, 0.1, 0.1), (1.25, 0.2, 0.1)] {
            assert!((at(false, x) - hollow).abs() < 1e-15 && (at(true, x) - filled).abs() < 1e-15, "{x}");
        }
    }

    #[test]
    fn invalid_regions_are_errors() {
        let error = |region: Region<2>| {
            region.check([0.0; 2], [1.0; 2], &Size::uniform(0.3)).err().map(|error| (error.what, error.value))
        };
        let good = segment([0.2, 0.2], [0.2, 0.2], 0.1);
        assert_eq!(error(good.clone()), None);
        assert_eq!(error(boxed([-1.0, 0.5], [0.1, 3.0])), None);
        for size in [0.0, -1.0, 0.4] {
            assert_eq!(error(Region { size, ..good.clone() }), Some(("size of the region", size)));
        }
        for growth in [0.0, 0.6] {
            assert_eq!(error(Region { growth, ..good.clone() }), Some(("growth of the region", growth)));
        }
        assert!(
            error(Region { size: f64::NAN, ..good.clone() }).is_some()
                && error(Region { growth: f64::NAN, ..good.clone() }).is_some()
        );
        assert_eq!(error(segment([0.2, 0.2], [0.2, 1.1], 0.1)), Some(("coordinate of the region", 1.1)));
        assert_eq!(error(segment([0.2, 0.2], [0.2, 0.2], -0.1)), Some(("radius of the region", -0.1)));
        assert!(error(segment([f64::NAN, 0.2], [0.2, 0.2], 0.1)).is_some());
        assert_eq!(error(boxed([0.5, 0.5], [0.4, 0.6])), Some(("highest corner of the region", 0.4)));
        assert_eq!(error(boxed([1.5, 0.5], [1.6, 0.6])), Some(("lowest corner of the region", 1.5)));
        assert_eq!(error(boxed([-1.5, 0.5], [-1.4, 0.6])), Some(("highest corner of the region", -1.4)));
        for tiny in [Region { size: 1e-6, ..good }, Region { size: 1e-6, ..boxed([0.2; 2], [0.3; 2]) }] {
            assert_eq!(error(tiny).map(|(what, _)| what), Some("number of cells"));
        }
    }
}

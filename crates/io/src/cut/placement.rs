//! Placement of surfaces on a background: a box around them, random rotations and shifts.

use mesh::generate::structured_box;
use mesh::nalgebra::{Quaternion, UnitQuaternion};
use mesh::{Aabb, Point, SimplexMesh};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

use crate::Error;
use crate::surface::Surface;

/// Free space on every side of the surfaces, as a fraction of their longest extent.
const MARGIN: f64 = 0.1;

/// Largest number of cubes along an axis: 20 million tetrahedra, which take about ten gigabytes.
const MOST_CUBES: usize = 150;

/// Returns a box of `n`³ cubes with the centre of the surfaces; `n` is at most [`MOST_CUBES`].
pub(super) fn grid_around(surfaces: &[Surface], n: usize) -> Result<SimplexMesh<3>, Error> {
    if !(1..=MOST_CUBES).contains(&n) {
        return Err(Error::GridSize { n, most: MOST_CUBES });
    }
    let bounds = bounds(surfaces);
    let half_edge = (0.5 + MARGIN) * bounds.extent().amax();
    let Aabb { low, high } = Aabb::of_points([&bounds.centre()]).expanded(half_edge);
    structured_box(low.into(), high.into(), [n; 3]).map_err(Error::Grid)
}

/// Turns the surfaces together about the centre of their box.
pub(super) fn rotate(surfaces: &mut [Surface], seed: u64) {
    let centre = bounds(surfaces).centre();
    let turn = rotation(&mut SplitMix64::seed_from_u64(seed));
    surfaces.iter_mut().for_each(|surface| *surface = surface.moved(|x| centre + turn * (x - centre)));
}

/// Shifts the surfaces together by up to half a cell along each axis. A cell is a cube of six mean tetrahedra.
pub(super) fn shift(surfaces: &mut [Surface], seed: u64, background: &SimplexMesh<3>) {
    let edge = (6.0 * background.volume() / background.n_cells() as f64).cbrt();
    let mut random = SplitMix64::seed_from_u64(seed);
    let shift = Point::from_fn(|_, _| edge * (random.random::<f64>() - 0.5));
    surfaces.iter_mut().for_each(|surface| *surface = surface.moved(|x| x + shift));
}

fn bounds(surfaces: &[Surface]) -> Aabb<3> {
    Aabb::of_points(surfaces.iter().flat_map(Surface::positions))
}

/// Returns a random rotation; all rotations are equally likely (Shoemake 1992).
fn rotation(random: &mut SplitMix64) -> UnitQuaternion<f64> {
    let (share, first, second) = (random.random::<f64>(), random.random::<f64>(), random.random::<f64>());
    let (sin_1, cos_1) = (std::f64::consts::TAU * first).sin_cos();
    let (sin_2, cos_2) = (std::f64::consts::TAU * second).sin_cos();
    let (a, b) = ((1.0 - share).sqrt(), share.sqrt());
    UnitQuaternion::from_quaternion(Quaternion::new(b * cos_2, a * sin_1, a * cos_1, b * sin_2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_determine_numbers_and_rotations_favour_no_direction() {
        let of_seed = |seed| rotation(&mut SplitMix64::seed_from_u64(seed));
        assert_eq!(of_seed(7), of_seed(7));
        assert_ne!(of_seed(7), of_seed(8));
        // SplitMix64 has a published definition, so that a seed gives the same rotation with every version.
        assert_eq!(SplitMix64::seed_from_u64(7).random::<f64>(), 0.389_829_748_391_271_5);
        let mut random = SplitMix64::seed_from_u64(1);
        let (mut mean, mut square) = (Point::<3>::zeros(), Point::<3>::zeros());
        let n = 4000;
        for _ in 0..n {
            let x = rotation(&mut random) * Point::<3>::x();
            mean += x / f64::from(n);
            square += x.component_mul(&x) / f64::from(n);
        }
        assert!(mean.amax() < 0.04, "{mean}");
        assert!(square.add_scalar(-1.0 / 3.0).amax() < 0.03, "{square}");
    }
}

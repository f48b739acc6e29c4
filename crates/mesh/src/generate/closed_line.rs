//! Closed lines that bound regions of the plane: polygons, smooth curves, circles and capsules.

use std::f64::consts::PI;

use nalgebra::{DMatrix, MatrixXx2};

use super::size::{MEAN_EDGE, divided};
use crate::{Error, positive, require};

/// Largest number of segments of one part of a line.
const MOST_SEGMENTS: f64 = 1e6;
/// Largest number of corners of a smooth line, whose spline is a dense system of equations.
const MOST_CORNERS: f64 = 2000.0;
/// Number of samples of the length of a spline between two corners.
const SAMPLES: usize = 64;

/// Closed line of straight segments that may follow a curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClosedLine {
    /// Beginnings of the segments, in order.
    pub points: Vec<[f64; 2]>,
    /// One per segment: middle of the part of the curve that the segment follows.
    pub middles: Vec<[f64; 2]>,
    /// One per segment: name of its part of the boundary.
    pub names: Vec<String>,
}

impl ClosedLine {
    /// Creates a polygon whose sides are divided into segments of length `h` at most. `name` maps the index of a side
    /// to its name; side `k` begins at corner `k`.
    ///
    /// # Errors
    /// [`Error::Parameter`]: fewer than three corners, coordinates that are not finite, a size that is not positive, or
    /// too many segments.
    pub fn polygon(corners: &[[f64; 2]], h: f64, name: impl Fn(usize) -> String) -> Result<Self, Error> {
        check(corners, h)?;
        let mut line = Self::default();
        for (k, (a, b)) in sides(corners).enumerate() {
            line.push(&name(k), (distance(a, b) / h).ceil(), |t| mix(a, b, t))?;
        }
        Ok(line)
    }

    /// Creates a line along the periodic cubic spline through corners. The parameter of the spline increases from
    /// corner to corner by their distance. The segments have equal lengths on the curve, `h` at most.
    ///
    /// # Errors
    /// As [`Self::polygon`]; corners that coincide, and more than 2000 corners.
    pub fn smooth(corners: &[[f64; 2]], h: f64, name: &str) -> Result<Self, Error> {
        check(corners, h)?;
        require(corners.len() as f64 <= MOST_CORNERS, "number of corners", corners.len() as f64, "at most 2000")?;
        let spline = ClosedSpline::through(corners)?;
        let mut line = Self::default();
        line.push(name, (spline.length() / h).ceil().max(3.0), |t| spline.at(t))?;
        Ok(line)
    }

    /// Creates a polygon whose sides are divided into segments whose length is about `h` at their position. The slope
    /// of `h` must be at most one half. `name` is as in [`Self::polygon`].
    ///
    /// # Errors
    /// As [`Self::polygon`].
    pub fn graded_polygon(
        corners: &[[f64; 2]],
        h: &dyn Fn([f64; 2]) -> f64,
        name: impl Fn(usize) -> String,
    ) -> Result<Self, Error> {
        check(corners, corners.iter().map(|x| h(*x)).fold(f64::INFINITY, f64::min))?;
        let mut line = Self::default();
        for (k, (a, b)) in sides(corners).enumerate() {
            line.push_graded(&name(k), (distance(a, b), 1), h, |t| mix(a, b, t))?;
        }
        Ok(line)
    }

    /// Creates a line along the spline of [`Self::smooth`] with segments whose length is about `h` at their position.
    /// The slope of `h` must be at most one half.
    ///
    /// # Errors
    /// As [`Self::smooth`].
    pub fn graded_smooth(corners: &[[f64; 2]], h: &dyn Fn([f64; 2]) -> f64, name: &str) -> Result<Self, Error> {
        check(corners, corners.iter().map(|x| h(*x)).fold(f64::INFINITY, f64::min))?;
        require(corners.len() as f64 <= MOST_CORNERS, "number of corners", corners.len() as f64, "at most 2000")?;
        let spline = ClosedSpline::through(corners)?;
        let mut line = Self::default();
        line.push_graded(name, (spline.length(), 3), h, |t| spline.at(t))?;
        Ok(line)
    }

    /// Creates a circle with segments of mean length `0.92 h`, as the cells of other generators have for the size `h`.
    ///
    /// # Errors
    /// [`Error::Parameter`]: a centre that is not finite, radius or size that are not positive, or too many segments.
    pub fn circle(centre: [f64; 2], radius: f64, h: f64, name: &str) -> Result<Self, Error> {
        check_round(&[centre], radius, h)?;
        let mut line = Self::default();
        let n = (2.0 * PI * radius / (MEAN_EDGE * h)).round().max(6.0);
        line.push(name, n, |t| on_circle(centre, radius, 2.0 * PI * t))?;
        Ok(line)
    }

    /// Creates the line at a distance `radius` from a segment: two straight sides and two half circles. The length of
    /// its segments is that of [`Self::circle`].
    ///
    /// # Errors
    /// As [`Self::circle`]; ends that coincide.
    pub fn capsule([a, b]: [[f64; 2]; 2], radius: f64, h: f64, name: &str) -> Result<Self, Error> {
        check_round(&[a, b], radius, h)?;
        let length = distance(a, b);
        positive("distance of the ends", length)?;
        let right = (b[1] - a[1]).atan2(b[0] - a[0]) - 0.5 * PI;
        let h = MEAN_EDGE * h;
        let (n_side, n_cap) = ((length / h).round().max(1.0), (PI * radius / h).round().max(3.0));
        let mut line = Self::default();
        for (from, to, angle) in [(a, b, right), (b, a, right + PI)] {
            let [begin, end] = [from, to].map(|x| on_circle(x, radius, angle));
            line.push(name, n_side, |t| mix(begin, end, t))?;
            line.push(name, n_cap, |t| on_circle(to, radius, angle + PI * t))?;
        }
        Ok(line)
    }

    /// Returns the area that the segments enclose, positive for a counter-clockwise line.
    pub fn area(&self) -> f64 {
        0.5 * sides(&self.points).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
    }

    /// Returns the line in the opposite direction.
    #[must_use]
    pub fn reversed(mut self) -> Self {
        // The first point stays the first one.
        self.points.reverse();
        self.points.rotate_right(1);
        self.middles.reverse();
        self.names.reverse();
        self
    }

    /// Appends at least `least` segments whose length is about `h` at their position along a curve over the parameters
    /// from 0 to 1.
    fn push_graded(
        &mut self,
        name: &str,
        (length, least): (f64, usize),
        h: &dyn Fn([f64; 2]) -> f64,
        at: impl Fn(f64) -> [f64; 2],
    ) -> Result<(), Error> {
        let parameters = divided(0.0, 1.0, |t| h(at(t)) / length)?;
        if parameters.len() <= least {
            return self.push(name, least as f64, at);
        }
        self.points.extend(parameters[1..].iter().zip(&parameters).map(|(_, t)| at(*t)));
        self.middles.extend(parameters[1..].iter().zip(&parameters).map(|(end, begin)| at(0.5 * (begin + end))));
        self.names.resize(self.points.len(), name.to_owned());
        Ok(())
    }

    /// Appends `n` segments along a curve over the parameters from 0 to 1.
    fn push(&mut self, name: &str, n: f64, at: impl Fn(f64) -> [f64; 2]) -> Result<(), Error> {
        require(
            (1.0..=MOST_SEGMENTS).contains(&n),
            "number of segments of a side",
            n,
            "from 1 to 1e6 (increase the size)",
        )?;
        self.points.extend((0..n as usize).map(|k| at(k as f64 / n)));
        self.middles.extend((0..n as usize).map(|k| at((k as f64 + 0.5) / n)));
        self.names.resize(self.points.len(), name.to_owned());
        Ok(())
    }
}

/// Periodic cubic spline in the plane, with samples of its length.
struct ClosedSpline {
    /// Parameters of the corners, and that of the first corner after one period.
    parameters: Vec<f64>,
    corners: Vec<[f64; 2]>,
    /// Second derivatives at the corners.
    curvatures: Vec<[f64; 2]>,
    /// Length up to each sample.
    lengths: Vec<f64>,
}

impl ClosedSpline {
    /// Creates the spline through corners.
    ///
    /// Source: de Boor 2001, A Practical Guide to Splines, ch. IV.
    fn through(corners: &[[f64; 2]]) -> Result<Self, Error> {
        let n = corners.len();
        let steps: Vec<f64> = sides(corners).map(|(a, b)| distance(a, b)).collect();
        for &step in &steps {
            positive("distance of two corners", step)?;
        }
        let (mut matrix, mut right) = (DMatrix::zeros(n, n), MatrixXx2::zeros(n));
        for k in 0..n {
            let (before, after) = ((k + n - 1) % n, (k + 1) % n);
            matrix[(k, before)] += steps[before];
            matrix[(k, k)] += 2.0 * (steps[before] + steps[k]);
            matrix[(k, after)] += steps[k];
            for axis in 0..2 {
                let slope = |i: usize, j: usize| (corners[j][axis] - corners[i][axis]) / steps[i];
                right[(k, axis)] = 6.0 * (slope(k, after) - slope(before, k));
            }
        }
        let reason = || Error::Triangulation { reason: "there is no spline through the corners".to_owned() };
        let solution = matrix.lu().solve(&right).ok_or_else(reason)?;
        let mut parameters = vec![0.0];
        parameters.extend(steps.iter().scan(0.0, |sum, step| {
            *sum += step;
            Some(*sum)
        }));
        let curvatures = (0..n).map(|k| [solution[(k, 0)], solution[(k, 1)]]).collect();
        let mut spline = Self { parameters, corners: corners.to_vec(), curvatures, lengths: vec![0.0] };
        let mut last = corners[0];
        for k in 1..=SAMPLES * n {
            let next = spline.sample(k);
            spline.lengths.push(spline.length() + distance(last, next));
            last = next;
        }
        Ok(spline)
    }

    fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    fn sample(&self, k: usize) -> [f64; 2] {
        self.in_span(k / SAMPLES % self.corners.len(), (k % SAMPLES) as f64 / SAMPLES as f64)
    }

    /// Returns the point at a fraction of the span after a corner.
    fn in_span(&self, k: usize, t: f64) -> [f64; 2] {
        let after = (k + 1) % self.corners.len();
        let (s, step) = (1.0 - t, self.parameters[k + 1] - self.parameters[k]);
        let [bend_s, bend_t] = [s, t].map(|t| (t.powi(3) - t) * step * step / 6.0);
        std::array::from_fn(|axis| {
            s * self.corners[k][axis]
                + t * self.corners[after][axis]
                + bend_s * self.curvatures[k][axis]
                + bend_t * self.curvatures[after][axis]
        })
    }

    /// Returns the point at a fraction of the length.
    fn at(&self, fraction: f64) -> [f64; 2] {
        let target = fraction * self.length();
        let k = self.lengths.partition_point(|length| *length <= target).clamp(1, self.lengths.len() - 1) - 1;
        let within = (target - self.lengths[k]) / (self.lengths[k + 1] - self.lengths[k]);
        self.in_span(k / SAMPLES, ((k % SAMPLES) as f64 + within) / SAMPLES as f64)
    }
}

fn check(corners: &[[f64; 2]], h: f64) -> Result<(), Error> {
    positive("size", h)?;
    require(corners.len() >= 3, "number of corners", corners.len() as f64, "at least 3")?;
    finite(corners)?;
    let shortest = sides(corners).map(|(a, b)| distance(a, b)).fold(f64::INFINITY, f64::min);
    require(shortest > 0.0, "distance of neighbouring corners", shortest, "positive (give each corner once)")?;
    Ok(())
}

fn check_round(centres: &[[f64; 2]], radius: f64, h: f64) -> Result<(), Error> {
    positive("size", h)?;
    positive("radius", radius)?;
    finite(centres)
}

fn finite(points: &[[f64; 2]]) -> Result<(), Error> {
    for &coordinate in points.as_flattened() {
        require(coordinate.is_finite(), "coordinate", coordinate, "finite")?;
    }
    Ok(())
}

fn sides(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

fn on_circle(centre: [f64; 2], radius: f64, angle: f64) -> [f64; 2] {
    [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
}

fn mix(a: [f64; 2], b: [f64; 2], t: f64) -> [f64; 2] {
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

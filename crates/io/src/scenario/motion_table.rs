//! Motions given by a table of positions over time.

use std::path::Path;

use mesh::{AXES, Vector};

use super::formula::Dual;
use crate::Error;
use crate::files::read_text;

/// Displacement and angle of a rigid body with their rates in time.
///
/// The body turns counter-clockwise in the plane of the first two axes; angles are in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose<const D: usize> {
    pub(super) displacement: [Dual; D],
    pub(super) angle: Dual,
}

impl<const D: usize> Default for Pose<D> {
    fn default() -> Self {
        Self { displacement: [Dual::default(); D], angle: Dual::default() }
    }
}

impl<const D: usize> Pose<D> {
    pub(super) fn offset(&self) -> Vector<D> {
        Vector::from_fn(|axis, _| self.displacement[axis].value)
    }
}

/// Motion through the rows of a table, by a natural cubic spline for each column. Position, velocity and acceleration
/// are continuous, and the acceleration is zero at the first and the last row. Two rows define a straight line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MotionTable<const D: usize> {
    times: Vec<f64>,
    displacement: [NaturalSpline; D],
    angle: Option<NaturalSpline>,
}

impl<const D: usize> MotionTable<D> {
    /// Reads a table whose header names `time`, the axes and, if the body turns, `angle`, in any order.
    ///
    /// # Errors
    /// A text with file, line, cause and remedy.
    pub(super) fn read(path: &Path) -> Result<Self, String> {
        let file = path.display().to_string();
        let text = read_text(path).map_err(|error| match error {
            Error::Read { source, .. } => {
                format!("{file}: the table cannot be read ({source}); check its path, relative to the scenario")
            }
            error => error.to_string(),
        })?;
        // Spreadsheets write a byte order mark first.
        Self::parse(&file, text.trim_start_matches('\u{feff}'))
    }

    fn parse(file: &str, text: &str) -> Result<Self, String> {
        let is_row = |line: &&str| !line.is_empty() && !line.starts_with('#');
        let lines = text.lines().map(str::trim).enumerate().map(|(k, line)| (format!("{file}:{}", k + 1), line));
        let mut lines = lines.filter(|(_, line)| is_row(line));
        let header = format!("time,{} and, if it turns, angle", AXES[..D].join(","));
        let empty = || format!("{file}: it is empty; begin with the header {header}");
        let (at, names) = lines.next().ok_or_else(empty)?;
        let names: Vec<&str> = names.split(',').map(str::trim).collect();
        for (k, name) in names.iter().enumerate() {
            if !["time", "angle"].iter().chain(&AXES[..D]).any(|known| known == name) {
                return Err(format!("{at}: `{name}` is not a column of a motion; the header is {header}"));
            }
            if names[..k].contains(name) {
                return Err(format!("{at}: the column `{name}` appears twice; take one out"));
            }
        }
        let column = |name: &str| names.iter().position(|found| *found == name);
        let needed = |name| column(name).ok_or_else(|| format!("{at}: the column `{name}` is missing; add it"));
        let time = needed("time")?;
        let axes = AXES[..D].iter().map(|name| needed(name)).collect::<Result<Vec<usize>, _>>()?;
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for (at, text) in lines {
            let words: Vec<&str> = text.split(',').map(str::trim).collect();
            if words.len() != names.len() {
                let (found, all) = (words.len(), names.len());
                return Err(format!("{at}: this row has {found} values, but the header names {all} columns"));
            }
            let number = |(word, name): (&&str, &&str)| match word.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(format!("{at}: `{word}` in the column `{name}` is not a finite number; correct it")),
            };
            let row: Vec<f64> = words.iter().zip(&names).map(number).collect::<Result<_, _>>()?;
            if let Some(before) = rows.last().map(|before| before[time]).filter(|before| *before >= row[time]) {
                let now = row[time];
                return Err(format!(
                    "{at}: time {now} is not after {before} of the previous row; sort the rows, and give a jump two times that differ"
                ));
            }
            rows.push(row);
        }
        if rows.len() < 2 {
            return Err(format!("{file}: it has {} rows; a motion needs two or more", rows.len()));
        }
        let values = |place: usize| rows.iter().map(|row| row[place]).collect::<Vec<f64>>();
        let times = values(time);
        let spline = |place| NaturalSpline::natural(&times, values(place));
        Ok(Self {
            displacement: std::array::from_fn(|axis| spline(axes[axis])),
            angle: column("angle").map(spline),
            times,
        })
    }

    pub(super) fn has_angle(&self) -> bool {
        self.angle.is_some()
    }

    /// Returns the times of the first and the last row.
    pub(super) fn range(&self) -> (f64, f64) {
        (self.times[0], self.times[self.times.len() - 1])
    }

    pub(super) fn at(&self, t: f64) -> Pose<D> {
        let interval = self.times.partition_point(|row| *row <= t).clamp(1, self.times.len() - 1) - 1;
        let ends = [self.times[interval], self.times[interval + 1]];
        Pose {
            displacement: self.displacement.each_ref().map(|spline| spline.at(interval, ends, t)),
            angle: self.angle.as_ref().map_or_else(Dual::default, |angle| angle.at(interval, ends, t)),
        }
    }
}

/// Cubic spline: values and second derivatives at the rows.
#[derive(Clone, Debug, PartialEq)]
struct NaturalSpline {
    values: Vec<f64>,
    curvatures: Vec<f64>,
}

impl NaturalSpline {
    /// Computes the spline whose second derivative is zero at its ends.
    ///
    /// Its first derivative is continuous if
    /// `h_{k-1} m_{k-1} + 2 (h_{k-1} + h_k) m_k + h_k m_{k+1} = 6 (s_k - s_{k-1})` with the steps `h`, the slopes `s`
    /// between rows and the second derivatives `m`: a tridiagonal system, solved by elimination.
    fn natural(times: &[f64], values: Vec<f64>) -> Self {
        let n = times.len();
        let step = |k: usize| times[k + 1] - times[k];
        let slope = |k: usize| (values[k + 1] - values[k]) / step(k);
        // After elimination: m_k = right_k - upper_k m_{k+1}.
        let (mut upper, mut right) = (vec![0.0; n], vec![0.0; n]);
        for k in 1..n - 1 {
            let pivot = 2.0 * (step(k - 1) + step(k)) - step(k - 1) * upper[k - 1];
            upper[k] = step(k) / pivot;
            right[k] = (6.0 * (slope(k) - slope(k - 1)) - step(k - 1) * right[k - 1]) / pivot;
        }
        let mut curvatures = vec![0.0; n];
        for k in (1..n - 1).rev() {
            curvatures[k] = right[k] - upper[k] * curvatures[k + 1];
        }
        Self { values, curvatures }
    }

    /// Computes value and rate in interval `k`.
    fn at(&self, k: usize, [begin, end]: [f64; 2], t: f64) -> Dual {
        let h = end - begin;
        let (a, b) = ((end - t) / h, (t - begin) / h);
        let ([y0, y1], [m0, m1]) = ([self.values[k], self.values[k + 1]], [self.curvatures[k], self.curvatures[k + 1]]);
        let value = a * y0 + b * y1 + h * h / 6.0 * ((a * a * a - a) * m0 + (b * b * b - b) * m1);
        let rate = (y1 - y0) / h + h / 6.0 * ((3.0 * b * b - 1.0) * m1 - (3.0 * a * a - 1.0) * m0);
        Dual { value, rate }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> MotionTable<2> {
        MotionTable::parse("a.csv", text).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn rows_are_interpolated_and_lines_are_exact() {
        let table = table("# by hand\ntime, y, x, angle\n-1,4,0,1\n\n0.5,1,3,1.5\n2,-2,6,2\n");
        for (t, x, y, angle) in
            [(-1.0, 0.0, 4.0, 1.0), (0.5, 3.0, 1.0, 1.5), (2.0, 6.0, -2.0, 2.0), (1.1, 4.2, -0.2, 1.7)]
        {
            let Pose { displacement: [found_x, found_y], angle: found_angle } = table.at(t);
            for (found, value, rate) in [(found_x, x, 2.0), (found_y, y, -2.0), (found_angle, angle, 1.0 / 3.0)] {
                assert!((found.value - value).abs() < 1e-14 && (found.rate - rate).abs() < 1e-14, "{found:?}");
            }
        }
        assert_eq!((table.range(), table.has_angle()), ((-1.0, 2.0), true));
    }

    #[test]
    fn a_sine_is_interpolated_to_fourth_order_with_continuous_velocity_and_acceleration() {
        // Unequal steps over a period.
        let sine = |n: usize| {
            let row = |k: usize| {
                let s = k as f64 / n as f64;
                let t = s + 0.3 * s * (1.0 - s);
                format!("{t},{},0\n", (std::f64::consts::TAU * t).sin())
            };
            table(&("time,x,y\n".to_owned() + &(0..=n).map(row).collect::<String>()))
        };
        let error = |n: usize| {
            let table = sine(n);
            let error = |t: f64| (table.at(t).displacement[0].value - (std::f64::consts::TAU * t).sin()).abs();
            (0..=1000).map(|k| error(f64::from(k) / 1000.0)).fold(0.0, f64::max)
        };
        // A sine over whole periods has no curvature at the ends.
        assert!(error(40) < error(20) / 12.0 && error(40) < 1e-5, "{} {}", error(20), error(40));
        let table = sine(20);
        let displacement = |t: f64| table.at(t).displacement[0].value;
        let velocity = |t: f64| table.at(t).displacement[0].rate;
        for row in &table.times[1..20] {
            let h = 1e-6;
            assert!((velocity(row + 1e-12) - velocity(row - 1e-12)).abs() < 1e-9);
            let acceleration = |t: f64| (velocity(t + 0.5 * h) - velocity(t - 0.5 * h)) / h;
            assert!((acceleration(row + h) - acceleration(row - h)).abs() < 2e-3, "{row}");
            let t = row + 0.01;
            assert!(((displacement(t + h) - displacement(t - h)) / (2.0 * h) - velocity(t)).abs() < 1e-8);
        }
    }

    #[test]
    fn errors_name_the_line() {
        for (text, message) in [
            ("", "a.csv: it is empty"),
            ("0,1,2\n1,2,3\n", "a.csv:1: `0` is not a column"),
            ("time,x\n0,1\n1,2\n", "a.csv:1: the column `y` is missing"),
            ("time,x,x,y\n", "a.csv:1: the column `x` appears twice"),
            ("time,x,y,z\n", "a.csv:1: `z` is not a column"),
            ("# c\n\ntime,x,y\n0,1,2\n1,2\n", "a.csv:5: this row has 2 values"),
            ("time,x,y\n0,1,2\n1,a,2\n", "a.csv:3: `a` in the column `x`"),
            ("time,x,y\n0,1,2\n1,nan,2\n", "a.csv:3: `nan` in the column `x` is not a finite number"),
            ("time,x,y\n0,1,2\n1,1,2\n1,1,2\n", "a.csv:4: time 1 is not after 1"),
            ("time,x,y\n0,1,2\n", "a.csv: it has 1 rows"),
        ] {
            let found = MotionTable::<2>::parse("a.csv", text).expect_err(text);
            assert!(found.starts_with(message), "{found}");
        }
    }
}

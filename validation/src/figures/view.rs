//! A rectangle of the plane as a part of an SVG picture, with a bar of colours.

use std::fmt::Write;

// Width of the bar with its labels, height of the title, and margin.
const BAR: f64 = 84.0;
const TITLE: f64 = 34.0;
const MARGIN: f64 = 12.0;
/// Colours of isolines, from the lowest to the highest value.
const COLOURS: [[f64; 3]; 5] =
    [[68.0, 1.0, 84.0], [59.0, 82.0, 139.0], [33.0, 145.0, 140.0], [94.0, 201.0, 98.0], [220.0, 190.0, 20.0]];

/// A rectangle of the plane on a picture. Lengths upwards may be stretched.
pub(super) struct View {
    low: [f64; 2],
    high: [f64; 2],
    scale: [f64; 2],
    mirror: Option<f64>,
    /// Elements inside the rectangle.
    inside: String,
    /// Elements around the rectangle.
    around: String,
}

impl View {
    /// Creates a view of the rectangle between two corners, with its longer side `longest` pixels long. Everything
    /// drawn is repeated behind the plane of symmetry `mirror`.
    pub(super) fn new(low: [f64; 2], high: [f64; 2], longest: f64, stretch: f64, mirror: Option<f64>) -> Self {
        let scale = longest / (high[0] - low[0]).max(high[1] - low[1]);
        Self { low, high, scale: [scale, scale * stretch], mirror, inside: String::new(), around: String::new() }
    }

    /// Returns a number of pixels as a length in the plane.
    pub(super) fn length(&self, pixels: f64) -> f64 {
        pixels / self.scale[0]
    }

    fn place(&self, x: [f64; 2]) -> [f64; 2] {
        [(x[0] - self.low[0]) * self.scale[0], (self.high[1] - x[1]) * self.scale[1]]
    }

    /// Draws polygons or lines in one style, and their mirror images.
    pub(super) fn draw<const N: usize>(&mut self, style: &str, lines: impl Iterator<Item = [[f64; 2]; N]>) {
        let lines: Vec<[[f64; 2]; N]> = lines.collect();
        let mut path = String::new();
        for mirror in [None].into_iter().chain(self.mirror.map(Some)) {
            for line in &lines {
                for (k, x) in line.iter().enumerate() {
                    let [a, b] = self.place([mirror.map_or(x[0], |plane| 2.0 * plane - x[0]), x[1]]);
                    // Writing to a string cannot fail.
                    let _ = write!(path, "{}{a:.1} {b:.1}", if k == 0 { 'M' } else { 'L' });
                }
            }
        }
        if !path.is_empty() {
            let _ = write!(self.inside, "<path {style} d=\"{path}\"/>");
        }
    }

    /// Draws isolines of values in triangles, if they vary, at about `n` levels, coloured by `range`; for odd values,
    /// such as the vorticity, the mirror images of positive levels are negative ones.
    pub(super) fn isolines(&mut self, triangles: &[[([f64; 2], f64); 3]], range: (f64, f64), n: f64, is_odd: bool) {
        if range.1 <= range.0 {
            return;
        }
        let step = nice_step(range.1 - range.0, n);
        let levels = ((range.0 / step).ceil() as i64)..=((range.1 / step).floor() as i64);
        let mirror = self.mirror;
        for level in levels.filter(|k| !(is_odd && *k == 0)).map(|k| k as f64 * step) {
            let segments = || triangles.iter().filter_map(move |corners| level_segment(*corners, level));
            let style = |level: f64| {
                let colour = colour((level - range.0) / (range.1 - range.0));
                format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\"")
            };
            if let (true, Some(plane)) = (is_odd, mirror) {
                self.mirror = None;
                self.draw(&style(level), segments());
                self.draw(&style(-level), segments().map(|s| s.map(|x| [2.0 * plane - x[0], x[1]])));
                self.mirror = mirror;
            } else {
                self.draw(&style(level), segments());
            }
        }
    }

    /// Draws the bar that explains the colours, if values vary.
    pub(super) fn bar(&mut self, range: (f64, f64), unit: &str) {
        if range.1 <= range.0 {
            return;
        }
        let size = self.size();
        let (x, n) = (size[0] + 16.0, 60);
        for k in 0..n {
            let (share, height) = (f64::from(k) / f64::from(n), size[1] / f64::from(n));
            let (y, colour) = (size[1] * (1.0 - share) - height, colour(share));
            let _ = write!(
                self.around,
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"12\" height=\"{:.1}\" fill=\"{colour}\"/>",
                height + 0.5
            );
        }
        let step = nice_step(range.1 - range.0, 6.0);
        for k in ((range.0 / step).ceil() as i64)..=((range.1 / step).floor() as i64) {
            let value = k as f64 * step;
            let y = size[1] * (1.0 - (value - range.0) / (range.1 - range.0)) + 4.0;
            let value = format!("{value:.4}");
            let value = value.trim_end_matches('0').trim_end_matches('.');
            let _ = write!(self.around, "<text x=\"{:.1}\" y=\"{y:.1}\">{value}</text>", x + 17.0);
        }
        let _ = write!(self.around, "<text x=\"{x:.1}\" y=\"-8\">{unit}</text>");
    }

    fn size(&self) -> [f64; 2] {
        [0, 1].map(|k| (self.high[k] - self.low[k]) * self.scale[k])
    }
}

/// Returns pictures one below the other, each with its title.
pub(super) fn picture(views: Vec<(String, View)>) -> String {
    let (mut text, mut top, mut width) = (String::new(), 0.0, 0.0_f64);
    for (title, view) in views {
        let [w, h] = view.size();
        let _ = write!(
            text,
            "<g transform=\"translate({MARGIN} {:.1})\"><text y=\"-10\" font-weight=\"bold\">{}</text>\
             <svg width=\"{w:.1}\" height=\"{h:.1}\">{}</svg>\
             <rect width=\"{w:.1}\" height=\"{h:.1}\" fill=\"none\" stroke=\"#282c34\"/>{}</g>",
            top + TITLE,
            cutwater::report::html::escape(&title),
            view.inside,
            view.around,
        );
        top += h + TITLE + MARGIN;
        width = width.max(w + 2.0 * MARGIN + BAR);
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {top:.0}\" width=\"{width:.0}\" \
         height=\"{top:.0}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#282c34\">\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>{text}</svg>\n"
    )
}

/// Returns the corners of the box around points and their mirror images.
pub(super) fn bounds(points: impl Iterator<Item = [f64; 2]>, mirror: Option<f64>) -> ([f64; 2], [f64; 2]) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for x in points {
        for image in [Some(x), mirror.map(|plane| [2.0 * plane - x[0], x[1]])].into_iter().flatten() {
            low = [0, 1].map(|k| low[k].min(image[k]));
            high = [0, 1].map(|k| high[k].max(image[k]));
        }
    }
    (low, high)
}

/// Returns a step of one, two or five times a power of ten that divides a length into at most about `n` parts.
fn nice_step(length: f64, n: f64) -> f64 {
    let raw = (length / n).max(f64::MIN_POSITIVE);
    let power = 10_f64.powf(raw.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|step| *step >= raw).unwrap_or(raw)
}

/// Returns the colour of a value from 0 to 1.
fn colour(share: f64) -> String {
    let at = share.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let k = (at as usize).min(COLOURS.len() - 2);
    let mix = |c: usize| (COLOURS[k][c] + (at - k as f64) * (COLOURS[k + 1][c] - COLOURS[k][c])).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// Returns the segment of a level in a triangle of corners and values; `None` if the level does not cross it.
fn level_segment(corners: [([f64; 2], f64); 3], level: f64) -> Option<[[f64; 2]; 2]> {
    let mut ends = Vec::with_capacity(2);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let ((a, va), (b, vb)) = (corners[i], corners[j]);
        let (va, vb) = (va - level, vb - level);
        if (va < 0.0) != (vb < 0.0) {
            let t = va / (va - vb);
            ends.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    <[[f64; 2]; 2]>::try_from(ends).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (length, n, step) in [(1.0, 6.0, 0.2), (97.0, 10.0, 10.0), (0.034, 7.0, 0.005)] {
            assert!((nice_step(length, n) - step).abs() < 1e-12 * step, "{length} {n}");
        }
    }

    #[test]
    fn a_line_appears_on_both_sides_of_a_plane_of_symmetry() {
        let mut view = View::new([-1.0, 0.0], [1.0, 1.0], 200.0, 1.0, Some(0.0));
        view.draw("x=\"y\"", [[[0.5, 0.0], [0.5, 1.0]]].into_iter());
        let text = picture(vec![("t".to_owned(), view)]);
        assert!(text.contains("M150.0 100.0L150.0 0.0M50.0 100.0L50.0 0.0"), "{text}");
    }

    #[test]
    fn a_level_crosses_a_triangle_on_two_edges() {
        let corners = [([0.0, 0.0], 0.0), ([1.0, 0.0], 1.0), ([0.0, 1.0], 0.0)];
        assert_eq!(level_segment(corners, 0.5), Some([[0.5, 0.0], [0.5, 0.5]]));
        assert_eq!(level_segment(corners, 2.0), None);
    }
}

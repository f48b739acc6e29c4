//! Line charts as small multiples: panels with curves, known events and known numbers.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::canvas::{Canvas, Drawn, GRID, INK, Picture, nice_step, text_of, tick_text};

/// Colours of curves and marks, in order; they differ also without colour vision.
const COLOURS: [RGBColor; 6] = [
    RGBColor(12, 86, 160),
    RGBColor(204, 85, 0),
    RGBColor(0, 128, 96),
    RGBColor(150, 60, 150),
    RGBColor(120, 120, 120),
    RGBColor(184, 134, 11),
];
/// Width and height of a panel in units.
const PANEL: (u32, u32) = (500, 352);
/// Height of a row of the legend in units.
const LEGEND: f64 = 24.0;
/// Mean width of a character of the legend in units, generously.
const CHARACTER: f64 = 7.6;

/// A curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Its name in the legend; empty for none.
    pub label: String,
    /// Number of its colour, from 0.
    pub colour: usize,
    /// Points; those with a number that is not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// Whether the points are marked as such.
    pub dots: bool,
}

impl Curve {
    /// A curve of the first colour without a name.
    pub fn plain(points: Vec<(f64, f64)>) -> Self {
        Self { points, ..Self::default() }
    }
}

/// A number known from elsewhere: a vertical line, and a ring if its value is known too.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Its name in the legend; empty for none.
    pub label: String,
    /// Number of its colour, from 0.
    pub colour: usize,
    /// Where.
    pub x: f64,
    /// Value there.
    pub y: Option<f64>,
}

/// One graph.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// What is shown, with its unit.
    pub title: String,
    /// What runs to the right, with its unit; time if empty.
    pub x_title: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Known numbers.
    pub events: Vec<Event>,
    /// Heights that are marked by a line: a contact offset.
    pub levels: Vec<f64>,
    /// What is shown of the horizontal axis; everything if none is given.
    pub x_range: Option<(f64, f64)>,
    /// Whether the horizontal axis is logarithmic.
    pub x_is_log: bool,
    /// Whether the vertical axis is logarithmic; points below zero are left out.
    pub y_is_log: bool,
}

/// Panels side by side, with one legend.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Panels in a row.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
}

/// An entry of the legend.
struct Entry {
    text: String,
    colour: usize,
    is_dashed: bool,
}

impl Chart {
    fn grid(&self) -> (usize, usize) {
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        (self.panels.len().div_ceil(columns).max(1), columns)
    }

    /// Names of curves and events, each once.
    fn legend(&self) -> Vec<Entry> {
        let mut entries: Vec<Entry> = Vec::new();
        let mut add = |text: String, label: &str, colour: usize, is_dashed: bool| {
            if !label.is_empty() && !entries.iter().any(|entry| entry.text == text) {
                entries.push(Entry { text, colour, is_dashed });
            }
        };
        for panel in &self.panels {
            for curve in &panel.curves {
                add(curve.label.clone(), &curve.label, curve.colour, false);
            }
        }
        for panel in &self.panels {
            for event in &panel.events {
                add(event.label.clone(), &event.label, event.colour, true);
            }
        }
        entries
    }

    /// The legend in rows, with the horizontal position of each entry in units.
    fn legend_rows(&self) -> Vec<Vec<(f64, Entry)>> {
        let width = f64::from(PANEL.0) * self.grid().1 as f64;
        let mut rows: Vec<Vec<(f64, Entry)>> = Vec::new();
        let mut x = f64::INFINITY;
        for entry in self.legend() {
            let length = 29.0 + CHARACTER * entry.text.chars().count() as f64 + 22.0;
            if x + length > width {
                rows.push(Vec::new());
                x = 62.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, entry));
            }
            x += length;
        }
        rows
    }
}

impl Picture for Chart {
    fn size(&self) -> (u32, u32) {
        let (rows, columns) = self.grid();
        let legend = (LEGEND * self.legend_rows().len() as f64).ceil() as u32;
        (PANEL.0 * columns as u32, PANEL.1 * rows as u32 + legend + 8)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let grid = self.grid();
        let (panels, legend) = canvas.area.split_vertically(canvas.px(f64::from(PANEL.1) * grid.0 as f64));
        for (panel, area) in self.panels.iter().zip(panels.split_evenly(grid)) {
            panel.draw(canvas, &area)?;
        }
        let style = canvas.font(13.0);
        let px = |length: f64| canvas.px(length) as i32;
        for (k, row) in self.legend_rows().iter().enumerate() {
            let top = LEGEND * k as f64 + 3.0;
            for (x, entry) in row {
                let dash = if entry.is_dashed { vec![(0.0, 9.0), (13.0, 22.0)] } else { vec![(0.0, 22.0)] };
                for (begin, end) in dash {
                    let line = vec![(px(x + begin), px(top + 5.0)), (px(x + end), px(top + 5.0))];
                    let stroke = colour(entry.colour).stroke_width(canvas.px(1.8));
                    legend.draw(&PathElement::new(line, stroke)).map_err(text_of)?;
                }
                legend.draw_text(&entry.text, &style, (px(x + 29.0), px(top))).map_err(text_of)?;
            }
        }
        Ok(())
    }
}

impl Panel {
    /// A graph over time.
    pub fn over_time(title: impl Into<String>, curves: Vec<Curve>) -> Self {
        Self { title: title.into(), curves, ..Self::default() }
    }

    fn abscissa(&self, x: f64) -> f64 {
        if self.x_is_log { x.log10() } else { x }
    }

    fn ordinate(&self, y: f64) -> f64 {
        if self.y_is_log { y.log10() } else { y }
    }

    /// Ranges of both axes; none if there is nothing to show.
    fn ranges(&self) -> Option<(Range<f64>, Range<f64>)> {
        let is_shown = |x: f64| self.x_range.is_none_or(|(a, b)| a <= x && x <= b);
        let points = || {
            let of_curves = self.curves.iter().flat_map(|curve| curve.points.iter().copied());
            of_curves.filter(|(x, y)| x.is_finite() && y.is_finite() && is_shown(*x))
        };
        let rings = self.events.iter().filter_map(|event| event.y.filter(|_| is_shown(event.x)));
        let extent = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
        };
        let heights = points().map(|(_, y)| y).chain(rings).chain(self.levels.iter().copied());
        let (low, high) = extent(&mut heights.map(|y| self.ordinate(y)).filter(|y| y.is_finite()));
        let (begin, end) = self.x_range.unwrap_or_else(|| extent(&mut points().map(|(x, _)| x)));
        if !(low.is_finite() && begin.is_finite()) {
            return None;
        }
        let margin = 0.07 * (high - low).max(1e-9 * high.abs()).max(1e-12);
        let (mut begin, mut end) = (self.abscissa(begin), self.abscissa(end));
        if self.x_is_log || self.curves.iter().any(|curve| curve.dots) {
            let margin = 0.05 * (end - begin);
            (begin, end) = (begin - margin, end + margin);
        } else if self.x_range.is_none() {
            begin = begin.min(0.0);
        }
        if end <= begin {
            (begin, end) = (begin - 0.5, begin + 0.5);
        }
        Some((begin..end, low - margin..high + margin))
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>, area: &DrawingArea<B, Shift>) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let Some((x_range, y_range)) = self.ranges() else { return Ok(()) };
        let mut chart = ChartBuilder::on(area)
            .margin(canvas.px(10.0))
            .margin_top(canvas.px(34.0))
            .margin_right(canvas.px(22.0))
            .x_label_area_size(canvas.px(38.0))
            .y_label_area_size(canvas.px(62.0))
            .build_cartesian_2d(x_range.clone(), y_range.clone())
            .map_err(text_of)?;
        self.draw_axes(canvas, area, &chart)?;
        let (low, high) = (y_range.start, y_range.end);
        let mut dashed = |from: (f64, f64), to: (f64, f64), colour: RGBColor| -> Drawn {
            let stroke = colour.stroke_width(canvas.px(1.2));
            let dashes = DashedLineSeries::new([from, to], canvas.px(5.0), canvas.px(4.0), stroke);
            chart.draw_series(dashes).map_err(text_of)?;
            Ok(())
        };
        for level in &self.levels {
            dashed((x_range.start, self.ordinate(*level)), (x_range.end, self.ordinate(*level)), INK)?;
        }
        for event in &self.events {
            let x = self.abscissa(event.x);
            if x_range.contains(&x) {
                dashed((x, low), (x, high), colour(event.colour))?;
            }
        }
        for curve in &self.curves {
            let points = || {
                let points = curve.points.iter().map(|(x, y)| (self.abscissa(*x), self.ordinate(*y)));
                points.filter(|(x, y)| y.is_finite() && x_range.contains(x) || *x == x_range.end)
            };
            let stroke = colour(curve.colour).stroke_width(canvas.px(1.8));
            chart.draw_series(LineSeries::new(points(), stroke)).map_err(text_of)?;
            if curve.dots {
                let fill = colour(curve.colour).filled();
                chart.draw_series(points().map(|at| Circle::new(at, canvas.px(3.6), fill))).map_err(text_of)?;
            }
        }
        for event in &self.events {
            let at = (self.abscissa(event.x), event.y.map_or(f64::NAN, |y| self.ordinate(y)));
            if x_range.contains(&at.0) && y_range.contains(&at.1) {
                let ring = Circle::new(at, canvas.px(4.5), colour(event.colour).stroke_width(canvas.px(1.8)));
                chart.draw_series(std::iter::once(ring)).map_err(text_of)?;
            }
        }
        Ok(())
    }

    /// Draws title, grid, axes and ticks.
    fn draw_axes<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        area: &DrawingArea<B, Shift>,
        chart: &ChartContext<'_, B, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
    ) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let (x_range, y_range) = (chart.x_range(), chart.y_range());
        let (left, top) = area.get_base_pixel();
        let on_area = |x: f64, y: f64| {
            let (a, b) = chart.backend_coord(&(x, y));
            (a - left, b - top)
        };
        let line = |from: (i32, i32), to: (i32, i32), style: RGBColor| {
            area.draw(&PathElement::new(vec![from, to], style.stroke_width(canvas.px(1.0)))).map_err(text_of)
        };
        let origin = on_area(x_range.start, y_range.start);
        let corner = on_area(x_range.end, y_range.end);
        let px = |length: f64| canvas.px(length) as i32;
        let style = canvas.font(12.5);
        let x_ticks: Vec<(f64, String)> =
            if self.x_is_log { decades(&x_range).collect() } else { ticks(&x_range, 6.0).collect() };
        for (t, text) in x_ticks {
            let (x, _) = on_area(t, y_range.start);
            line((x, origin.1), (x, corner.1), GRID)?;
            line((x, origin.1), (x, origin.1 + px(4.0)), INK)?;
            let (width, _) = area.estimate_text_size(&text, &style).map_err(text_of)?;
            area.draw_text(&text, &style, (x - width as i32 / 2, origin.1 + px(8.0))).map_err(text_of)?;
        }
        let y_ticks: Vec<(f64, String)> =
            if self.y_is_log { decades(&y_range).collect() } else { ticks(&y_range, 7.0).collect() };
        for (v, text) in y_ticks {
            let (_, y) = on_area(x_range.start, v);
            line((origin.0, y), (corner.0, y), GRID)?;
            line((origin.0 - px(4.0), y), (origin.0, y), INK)?;
            let (width, _) = area.estimate_text_size(&text, &style).map_err(text_of)?;
            // Digits are centred a quarter of the font size below their upper edge.
            area.draw_text(&text, &style, (origin.0 - px(8.0) - width as i32, y - px(3.4))).map_err(text_of)?;
        }
        line(origin, (corner.0, origin.1), INK)?;
        line(origin, (origin.0, corner.1), INK)?;
        area.draw_text(&self.title, &canvas.bold(15.0), (origin.0, px(12.0))).map_err(text_of)?;
        let x_title = if self.x_title.is_empty() { "time [s]" } else { &self.x_title };
        let (width, _) = area.estimate_text_size(x_title, &style).map_err(text_of)?;
        let middle = (origin.0 + corner.0 - width as i32) / 2;
        Ok(area.draw_text(x_title, &style, (middle, origin.1 + px(25.0))).map_err(text_of)?)
    }
}

/// Round numbers in a range, about `n` of them, with their texts.
fn ticks(range: &Range<f64>, n: f64) -> impl Iterator<Item = (f64, String)> + use<> {
    let step = nice_step(range.end - range.start, n);
    let end = range.end + 1e-9 * step;
    let first = (range.start / step - 1e-9).ceil() as i64;
    let values = (first..).map(move |k| k as f64 * step).take_while(move |v| *v <= end);
    values.map(move |v| (v, tick_text(v, step)))
}

/// Logarithms of 1, 2 and 5 times powers of ten in a range, with the texts of the numbers; of powers of ten alone where the
/// range has many.
fn decades(range: &Range<f64>) -> impl Iterator<Item = (f64, String)> + use<> {
    let (begin, end) = (range.start, range.end);
    let is_long = end - begin > 2.0;
    let powers = begin.floor() as i32..=end.ceil() as i32;
    let values = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|m| (m, power)));
    let logs = values.map(|(m, power): (f64, i32)| {
        let digits = usize::try_from(-power).unwrap_or(0);
        let text = if !(-4..=4).contains(&power) {
            format!("{m}e{power}")
        } else {
            format!("{:.digits$}", m * 10_f64.powi(power))
        };
        (m.log10() + f64::from(power), text)
    });
    let is_power = |at: f64| (at - at.round()).abs() < 1e-9;
    logs.filter(move |(at, _)| begin <= *at && *at <= end && (!is_long || is_power(*at)))
}

fn colour(k: usize) -> RGBColor {
    COLOURS[k % COLOURS.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithmic_ticks_are_the_numbers_themselves() {
        let texts: Vec<String> = decades(&(-3.1..-1.9)).map(|(_, text)| text).collect();
        assert_eq!(texts, ["0.001", "0.002", "0.005", "0.01"]);
        let texts: Vec<String> = decades(&(3.9..7.1)).map(|(_, text)| text).collect();
        assert_eq!(texts, ["10000", "1e5", "1e6", "1e7"]);
    }

    #[test]
    fn names_appear_once_and_wrap() {
        let curve = |label: &str| Curve { label: label.repeat(10), ..Curve::default() };
        let panel = Panel::over_time("x", vec![curve("abc"), curve("def"), curve("abc")]);
        let chart = Chart { columns: 1, panels: vec![panel] };
        let rows: Vec<usize> = chart.legend_rows().iter().map(Vec::len).collect();
        assert_eq!(rows, [1, 1]);
    }
}

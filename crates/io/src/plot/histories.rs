//! The four graphs of a bouncing body: distance, height, velocity and acceleration over time.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::canvas::{Canvas, Drawn, GRID, INK, Picture, nice_step, text_of, tick_text};
use crate::history::HistoryTable;
use crate::scenario::schema::Mark;

const CURVE: RGBColor = RGBColor(12, 86, 160);
const MARK: RGBColor = RGBColor(204, 85, 0);

/// Smallest distance, height of the body, velocity and acceleration of its lowest point, with known events marked.
pub(super) struct Histories<'a> {
    pub(super) table: &'a HistoryTable,
    /// Prefix of the columns of the body.
    pub(super) prefix: String,
    pub(super) marks: &'a [Mark],
}

struct Panel {
    title: &'static str,
    unit: &'static str,
    column: &'static str,
}

/// In the arrangement of the paper's Figure 8, row by row.
const PANELS: [Panel; 4] = [
    Panel { title: "smallest distance", unit: "cm", column: "d_min" },
    Panel { title: "velocity of the lowest point", unit: "cm/s", column: "lowest_velocity" },
    Panel { title: "height of the body", unit: "cm", column: "body_height" },
    Panel { title: "acceleration of the lowest point", unit: "cm/s²", column: "lowest_acceleration" },
];

impl Picture for Histories<'_> {
    fn size(&self) -> (u32, u32) {
        (1000, 740)
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let legend_height = if self.marks.is_empty() { 6.0 } else { 34.0 };
        let (width, height) = canvas.area.dim_in_pixel();
        let body = height - canvas.px(legend_height);
        let (panels, legend) = canvas.area.split_vertically(body);
        let times = self.table.column("time").unwrap_or_default();
        for (panel, area) in PANELS.iter().zip(panels.split_evenly((2, 2))) {
            let values = self.table.column(&format!("{}{}", self.prefix, panel.column)).unwrap_or_default();
            self.draw_panel(canvas, &area, panel, &times, &values)?;
        }
        if !self.marks.is_empty() {
            let style = canvas.font(13.0);
            let mut x = canvas.px(72.0) as i32;
            let y = canvas.px(8.0) as i32;
            for (k, mark) in self.marks.iter().enumerate() {
                let text = match mark.d_min {
                    Some(d) => format!("{}  {} s, {d} cm", mark.label, mark.time),
                    None => format!("{}  {} s", mark.label, mark.time),
                };
                let stroke = colour(k).stroke_width(canvas.px(1.6));
                let middle = y + canvas.px(8.0) as i32;
                let begin = x;
                x += canvas.px(22.0) as i32;
                legend.draw(&PathElement::new(vec![(begin, middle), (x, middle)], stroke)).map_err(text_of)?;
                x += canvas.px(7.0) as i32;
                legend.draw_text(&text, &style, (x, y)).map_err(text_of)?;
                let (text_width, _) = legend.estimate_text_size(&text, &style).map_err(text_of)?;
                x += text_width as i32 + canvas.px(30.0) as i32;
                if x > width as i32 {
                    break;
                }
            }
        }
        Ok(())
    }
}

impl Histories<'_> {
    fn draw_panel<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        area: &DrawingArea<B, Shift>,
        panel: &Panel,
        times: &[f64],
        values: &[f64],
    ) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.filter(|v| v.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
        };
        let of_marks = self.marks.iter().filter(|_| panel.column == "d_min").filter_map(|mark| mark.d_min);
        let (low, high) = range(&mut values.iter().copied().chain(of_marks));
        let (begin, end) = range(&mut times.iter().copied());
        if !(low.is_finite() && begin.is_finite()) {
            return Ok(());
        }
        let margin = 0.07 * (high - low).max(1e-9 * high.abs()).max(1e-12);
        let end = if end > begin { end } else { begin + 1.0 };
        let (low, high) = (low - margin, high + margin);
        let mut chart = ChartBuilder::on(area)
            .margin(canvas.px(10.0))
            .margin_top(canvas.px(34.0))
            .margin_right(canvas.px(22.0))
            .x_label_area_size(canvas.px(38.0))
            .y_label_area_size(canvas.px(62.0))
            .build_cartesian_2d(0.0_f64.min(begin)..end, low..high)
            .map_err(text_of)?;
        draw_axes(canvas, area, &chart, panel)?;
        for (k, mark) in self.marks.iter().enumerate() {
            let dashes = DashedLineSeries::new(
                [(mark.time, low), (mark.time, high)],
                canvas.px(5.0),
                canvas.px(4.0),
                colour(k).stroke_width(canvas.px(1.2)),
            );
            chart.draw_series(dashes).map_err(text_of)?;
        }
        let points = times.iter().copied().zip(values.iter().copied()).filter(|(_, v)| v.is_finite());
        chart.draw_series(LineSeries::new(points, CURVE.stroke_width(canvas.px(1.8)))).map_err(text_of)?;
        if panel.column == "d_min" {
            for (k, mark) in self.marks.iter().enumerate() {
                let Some(d) = mark.d_min else { continue };
                let ring = Circle::new((mark.time, d), canvas.px(4.5), colour(k).stroke_width(canvas.px(1.8)));
                chart.draw_series(std::iter::once(ring)).map_err(text_of)?;
            }
        }
        Ok(())
    }
}

/// Draws title, grid, axes and ticks.
fn draw_axes<B: DrawingBackend>(
    canvas: &Canvas<B>,
    area: &DrawingArea<B, Shift>,
    chart: &ChartContext<'_, B, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
    panel: &Panel,
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
    for (t, text) in ticks(&x_range, 6.0) {
        let (x, _) = on_area(t, y_range.start);
        line((x, origin.1), (x, corner.1), GRID)?;
        line((x, origin.1), (x, origin.1 + px(4.0)), INK)?;
        let (width, _) = area.estimate_text_size(&text, &style).map_err(text_of)?;
        area.draw_text(&text, &style, (x - width as i32 / 2, origin.1 + px(8.0))).map_err(text_of)?;
    }
    for (v, text) in ticks(&y_range, 7.0) {
        let (_, y) = on_area(x_range.start, v);
        line((origin.0, y), (corner.0, y), GRID)?;
        line((origin.0 - px(4.0), y), (origin.0, y), INK)?;
        let (width, _) = area.estimate_text_size(&text, &style).map_err(text_of)?;
        // Digits are centred a quarter of the font size below their upper edge.
        area.draw_text(&text, &style, (origin.0 - px(8.0) - width as i32, y - px(3.4))).map_err(text_of)?;
    }
    line(origin, (corner.0, origin.1), INK)?;
    line(origin, (origin.0, corner.1), INK)?;
    let title = format!("{} [{}]", panel.title, panel.unit);
    area.draw_text(&title, &canvas.bold(15.0), (origin.0, px(12.0))).map_err(text_of)?;
    let (width, _) = area.estimate_text_size("time [s]", &style).map_err(text_of)?;
    let middle = (origin.0 + corner.0 - width as i32) / 2;
    Ok(area.draw_text("time [s]", &style, (middle, origin.1 + px(25.0))).map_err(text_of)?)
}

/// Round numbers in a range, about `n` of them, with their texts.
fn ticks(range: &std::ops::Range<f64>, n: f64) -> impl Iterator<Item = (f64, String)> + use<> {
    let step = nice_step(range.end - range.start, n);
    let end = range.end + 1e-9 * step;
    let first = (range.start / step - 1e-9).ceil() as i64;
    let values = (first..).map(move |k| k as f64 * step).take_while(move |v| *v <= end);
    values.map(move |v| (v, tick_text(v, step)))
}

fn colour(k: usize) -> RGBColor {
    [MARK, RGBColor(0, 128, 96), RGBColor(150, 60, 150), RGBColor(120, 120, 120)][k % 4]
}

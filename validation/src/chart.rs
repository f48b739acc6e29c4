//! Charts as SVG, for the pages of the book.

use crate::outcome::Failure;
use cutwater::report::Chart;
use plotters::prelude::*;

/// Width and height of a chart.
const SIZE: (u32, u32) = (720, 430);
const FONT: &str = "sans-serif";

/// Returns a chart as the text of an SVG picture. If its horizontal axis is logarithmic, the vertical one is too.
/// Points that are not positive are then left out.
pub(crate) fn svg(chart: &Chart) -> Result<String, Failure> {
    let is_log = chart.x_is_log;
    let scale = |value: f64| if is_log { value.log10() } else { value };
    let label = |value: &f64| tick(if is_log { 10_f64.powf(*value) } else { *value });
    let curves: Vec<Vec<(f64, f64)>> = (chart.curves.iter())
        .map(|curve| curve.points.iter().map(|(x, y)| (scale(*x), scale(*y))))
        .map(|points| points.filter(|(x, y)| x.is_finite() && y.is_finite()).collect())
        .collect();
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let margin = if high > low { 0.05 * (high - low) } else { 0.5 };
        if low.is_finite() { low - margin..high + margin } else { 0.0..1.0 }
    };
    let x_range = range(&mut curves.iter().flatten().map(|point| point.0));
    let y_range = range(&mut curves.iter().flatten().map(|point| point.1));
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let mut axes = ChartBuilder::on(&area)
            .caption(&chart.title, (FONT, 17))
            .margin(12)
            .margin_right(24)
            .x_label_area_size(44)
            .y_label_area_size(72)
            .build_cartesian_2d(x_range, y_range)?;
        axes.configure_mesh()
            .x_desc(chart.x_label.as_str())
            .x_label_formatter(&label)
            .y_label_formatter(&label)
            .label_style((FONT, 13))
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.12))
            .draw()?;
        for (k, points) in curves.into_iter().enumerate() {
            let colour = Palette99::pick(k).to_rgba();
            let dots = if points.len() < 30 { 3 } else { 0 };
            let drawn = axes.draw_series(LineSeries::new(points, colour.stroke_width(2)).point_size(dots))?;
            if !chart.curves[k].label.is_empty() {
                let line = move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], colour.stroke_width(2));
                drawn.label(&chart.curves[k].label).legend(line);
            }
        }
        axes.configure_series_labels().background_style(WHITE.mix(0.85)).label_font((FONT, 13)).draw()?;
        area.present()?;
    }
    Ok(text)
}

/// Returns the text of a tick: up to four significant digits.
fn tick(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    match rounded.abs() {
        x if x != 0.0 && !(1e-3..1e5).contains(&x) => format!("{rounded:e}"),
        _ => format!("{rounded}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cutwater::report::Curve;

    #[test]
    fn ticks_are_short() {
        for (value, text) in [(0.1 + 0.2, "0.3"), (1e-4, "1e-4"), (-12.5, "-12.5"), (0.0, "0")] {
            assert_eq!(tick(value), text);
        }
    }

    #[test]
    fn a_point_that_a_logarithmic_axis_does_not_have_is_left_out() {
        let curve = Curve::new("c", vec![(1.0, 0.0), (2.0, 1.0), (3.0, 10.0)]);
        let text =
            svg(&Chart { x_is_log: true, ..Chart::new("a < b", "x", vec![curve]) }).unwrap_or_else(|e| panic!("{e}"));
        assert!(text.contains("<svg") && text.contains("a &lt; b") && !text.contains("inf") && !text.contains("NaN"));
    }
}

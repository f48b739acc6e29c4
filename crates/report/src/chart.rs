//! Charts as data, which uPlot draws in the browser.

use serde_json::{Value, json};

use crate::Error;
use crate::html::{data, escape};

/// A named sequence of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Name in the legend.
    pub label: String,
    /// The points, in ascending order of the first number.
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// Creates a curve from its name and points.
    pub fn new(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), points }
    }
}

/// Curves over a common axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Title, with the unit.
    pub title: String,
    /// Label of the horizontal axis.
    pub x_label: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Whether the horizontal axis is logarithmic.
    pub x_is_log: bool,
    /// Named positions on the horizontal axis, marked by vertical lines.
    pub marks: Vec<(String, f64)>,
    /// Heights that are marked by horizontal lines.
    pub levels: Vec<f64>,
    /// Part of the horizontal axis that is shown at first; everything if `None`.
    pub window: Option<(f64, f64)>,
    /// Text below the chart, as HTML.
    pub caption: String,
}

impl Chart {
    /// Creates a chart from its title, the label of its horizontal axis and its curves.
    pub fn new(title: impl Into<String>, x_label: impl Into<String>, curves: Vec<Curve>) -> Self {
        Self { title: title.into(), x_label: x_label.into(), curves, ..Self::default() }
    }

    /// Returns the chart as a figure; empty without a point to draw.
    ///
    /// # Errors
    /// [`Error::Json`].
    pub fn html(&self) -> Result<String, Error> {
        if !self.curves.iter().flat_map(|curve| &curve.points).any(|(_, y)| y.is_finite()) {
            return Ok(String::new());
        }
        let mut shared = Vec::new();
        let mut curves = Vec::new();
        for curve in &self.curves {
            let x: Vec<Value> = curve.points.iter().map(|(x, _)| short(*x)).collect();
            let y: Vec<Value> = curve.points.iter().map(|(_, y)| short(*y)).collect();
            // Curve without `x`: the script takes the positions of the previous curve, which are equal.
            if x == shared {
                curves.push(json!({ "label": curve.label, "y": y }));
            } else {
                curves.push(json!({ "label": curve.label, "x": x, "y": y }));
                shared = x;
            }
        }
        let data = data(&json!({
            "title": self.title, "x_label": self.x_label, "x_is_log": self.x_is_log,
            "marks": self.marks, "levels": self.levels, "window": self.window, "curves": curves,
        }))?;
        let caption = if self.caption.is_empty() { "" } else { &format!("<p>{}</p>", self.caption) };
        Ok(format!(
            "<figure class=\"chart\" aria-label=\"{0}\"><h4>{0}</h4><div></div>{caption}{data}</figure>",
            escape(&self.title)
        ))
    }
}

/// Returns a number with six significant digits; null if it is not finite.
fn short(x: f64) -> Value {
    format!("{x:.5e}").parse::<f64>().map_or(Value::Null, |x| json!(x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_positions_are_written_once_and_missing_numbers_as_none() {
        let curve = |label: &str, y: f64| Curve::new(label, vec![(0.0, 1.0 / 3.0), (1.0, y)]);
        let chart = Chart::new("a", "t", vec![curve("b", f64::NAN), curve("c", 2.0)]);
        let html = chart.html().unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(html.matches("\"x\":[0.0,1.0]").count(), 1);
        assert!(html.contains("\"y\":[0.333333,null]") && html.contains("\"y\":[0.333333,2.0]"), "{html}");
        assert_eq!(Chart::new("a", "t", vec![Curve::new("b", vec![(0.0, f64::NAN)])]).html().ok(), Some(String::new()));
    }
}

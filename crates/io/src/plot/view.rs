//! A rectangle of space on a picture, at equal scales, with a bar that explains its colours.

use mesh::Point;
use plotters::prelude::*;

use super::canvas::{Canvas, Drawn, INK, nice_step, text_of, tick_text};

/// Width of the bar with its labels, in units.
const BAR: f64 = 92.0;
/// Height of the title, in units.
const TITLE: f64 = 40.0;
const MARGIN: f64 = 14.0;

/// A rectangle of the plane and where it goes on a picture.
pub(super) struct View {
    low: [f64; 2],
    high: [f64; 2],
    /// Units per length.
    scale: f64,
}

impl View {
    /// The rectangle between two corners, with its longer side about `longest` units long.
    pub(super) fn new(low: [f64; 2], high: [f64; 2], longest: f64) -> Self {
        let scale = longest / (high[0] - low[0]).max(high[1] - low[1]);
        Self { low, high, scale }
    }

    /// Width and height of the picture in units.
    pub(super) fn size(&self) -> (u32, u32) {
        let extent = |k: usize| (self.high[k] - self.low[k]) * self.scale;
        ((extent(0) + 2.0 * MARGIN + BAR).ceil() as u32, (extent(1) + TITLE + MARGIN).ceil() as u32)
    }

    /// Position on the picture in units.
    pub(super) fn place(&self, x: [f64; 2]) -> [f64; 2] {
        [MARGIN + (x[0] - self.low[0]) * self.scale, TITLE + (self.high[1] - x[1]) * self.scale]
    }

    /// Position in pixels.
    pub(super) fn pixel<B: DrawingBackend>(&self, canvas: &Canvas<B>, x: [f64; 2]) -> (i32, i32) {
        let [a, b] = self.place(x);
        ((a * canvas.unit).round() as i32, (b * canvas.unit).round() as i32)
    }

    /// Draws lines between points.
    pub(super) fn polyline<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        points: &[[f64; 2]],
        colour: RGBAColor,
        width: f64,
    ) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let path: Vec<_> = points.iter().map(|x| self.pixel(canvas, *x)).collect();
        Ok(canvas.area.draw(&PathElement::new(path, colour.stroke_width(canvas.px(width)))).map_err(text_of)?)
    }

    /// Draws title, frame and the colours of the values from `range.0` to `range.1`.
    pub(super) fn decorate<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        title: &str,
        quantity: &str,
        range: (f64, f64),
        colour: &dyn Fn(f64) -> RGBColor,
    ) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let px = |length: f64| (length * canvas.unit).round() as i32;
        canvas.area.draw_text(title, &canvas.bold(16.0), (px(MARGIN), px(11.0))).map_err(text_of)?;
        let [right, top] = self.place([self.high[0], self.high[1]]);
        let [_, bottom] = self.place([self.high[0], self.low[1]]);
        let (left, width) = (right + 18.0, 14.0);
        let n = 240;
        for k in 0..n {
            let at = |k: i32| px(bottom + (top - bottom) * f64::from(k) / f64::from(n));
            let fill = colour((f64::from(k) + 0.5) / f64::from(n)).filled();
            let bar = Rectangle::new([(px(left), at(k + 1)), (px(left + width), at(k))], fill);
            canvas.area.draw(&bar).map_err(text_of)?;
        }
        let step = nice_step(range.1 - range.0, 6.0);
        let style = canvas.font(12.0);
        let mut value = (range.0 / step).ceil() * step;
        while value <= range.1 + 1e-9 * step {
            let y = bottom + (top - bottom) * (value - range.0) / (range.1 - range.0);
            let tick = PathElement::new(
                vec![(px(left + width), px(y)), (px(left + width + 4.0), px(y))],
                INK.stroke_width(canvas.px(1.0)),
            );
            canvas.area.draw(&tick).map_err(text_of)?;
            let text = tick_text(value, step);
            canvas.area.draw_text(&text, &style, (px(left + width + 8.0), px(y - 3.2))).map_err(text_of)?;
            value += step;
        }
        let (text_width, _) = canvas.area.estimate_text_size(quantity, &style).map_err(text_of)?;
        let x = px(right + 18.0 + BAR - MARGIN) - text_width as i32;
        canvas.area.draw_text(quantity, &style, (x.min(px(left)), px(top - 20.0))).map_err(text_of)?;
        let frame = [
            [self.low[0], self.low[1]],
            [self.high[0], self.low[1]],
            [self.high[0], self.high[1]],
            [self.low[0], self.high[1]],
            [self.low[0], self.low[1]],
        ];
        self.polyline(canvas, &frame, INK.into(), 1.0)
    }
}

/// A point of the plane.
pub(super) fn plane<const D: usize>(x: &Point<D>) -> [f64; 2] {
    [x[0], x[1]]
}

/// The plane as it is, or its reflection across a vertical line.
#[derive(Clone, Copy)]
pub(super) struct Image {
    mirror: Option<f64>,
}

impl Image {
    /// Where a point goes.
    pub(super) fn of(self, x: [f64; 2]) -> [f64; 2] {
        self.mirror.map_or(x, |plane| [2.0 * plane - x[0], x[1]])
    }
}

/// The images to be drawn: the plane itself, and its reflection if only a half is there.
pub(super) fn images(mirror: Option<f64>) -> impl Iterator<Item = Image> {
    std::iter::once(Image { mirror: None }).chain(mirror.map(|plane| Image { mirror: Some(plane) }))
}

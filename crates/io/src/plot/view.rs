//! A rectangle of space on a picture, at equal scales, with a bar that explains its colours.

use mesh::Point;
use plotters::prelude::*;
use solver::{Body, Setup};

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
    /// Units per length, to the right and up.
    scale: [f64; 2],
    /// Distance from the top of the picture in units.
    top: f64,
}

impl View {
    /// The rectangle between two corners, with its longer side about `longest` units long.
    pub(super) fn new(low: [f64; 2], high: [f64; 2], longest: f64) -> Self {
        let scale = longest / (high[0] - low[0]).max(high[1] - low[1]);
        Self { low, high, scale: [scale; 2], top: 0.0 }
    }

    /// The view with lengths upwards drawn this many times longer.
    pub(super) fn stretched(mut self, factor: f64) -> Self {
        self.scale[1] *= factor;
        self
    }

    /// The view below something of that height.
    pub(super) fn below(mut self, top: f64) -> Self {
        self.top = top;
        self
    }

    /// The two corners.
    pub(super) fn corners(&self) -> ([f64; 2], [f64; 2]) {
        (self.low, self.high)
    }

    /// A length on the picture as one in the plane, to the right.
    pub(super) fn length(&self, units: f64) -> f64 {
        units / self.scale[0]
    }

    /// Width and height of the picture in units.
    pub(super) fn size(&self) -> (u32, u32) {
        let extent = |k: usize| (self.high[k] - self.low[k]) * self.scale[k];
        ((extent(0) + 2.0 * MARGIN + BAR).ceil() as u32, (extent(1) + TITLE + MARGIN).ceil() as u32)
    }

    /// Where the view ends, from the top of the picture in units.
    pub(super) fn bottom(&self) -> f64 {
        self.top + f64::from(self.size().1)
    }

    /// Position on the picture in units.
    pub(super) fn place(&self, x: [f64; 2]) -> [f64; 2] {
        let down = (self.high[1] - x[1]) * self.scale[1];
        [MARGIN + (x[0] - self.low[0]) * self.scale[0], self.top + TITLE + down]
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

    /// Draws the part of a segment that is in view.
    pub(super) fn segment<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        [a, b]: [[f64; 2]; 2],
        colour: RGBAColor,
        width: f64,
    ) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let mut inside = (0.0_f64, 1.0_f64);
        for k in 0..2 {
            let along = b[k] - a[k];
            for (distance, slope) in [(a[k] - self.low[k], -along), (self.high[k] - a[k], along)] {
                if slope == 0.0 && distance < 0.0 {
                    return Ok(());
                }
                match slope {
                    s if s < 0.0 => inside.0 = inside.0.max(distance / s),
                    s if s > 0.0 => inside.1 = inside.1.min(distance / s),
                    _ => {}
                }
            }
        }
        if inside.0 >= inside.1 {
            return Ok(());
        }
        let at = |t: f64| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
        self.polyline(canvas, &[at(inside.0), at(inside.1)], colour, width)
    }

    /// Fills the part of a triangle that is in view.
    pub(super) fn triangle<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        corners: [[f64; 2]; 3],
        colour: RGBColor,
    ) -> Drawn
    where
        B::ErrorType: 'static,
    {
        let mut polygon = corners.to_vec();
        for k in 0..2 {
            for (side, limit) in [(1.0, self.low[k]), (-1.0, self.high[k])] {
                let depth = |x: [f64; 2]| side * (x[k] - limit);
                let mut kept = Vec::with_capacity(polygon.len() + 1);
                for (i, &a) in polygon.iter().enumerate() {
                    let b = polygon[(i + 1) % polygon.len()];
                    let (da, db) = (depth(a), depth(b));
                    if da >= 0.0 {
                        kept.push(a);
                    }
                    if (da < 0.0) != (db < 0.0) {
                        let t = da / (da - db);
                        kept.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
                    }
                }
                polygon = kept;
            }
        }
        if polygon.len() < 3 {
            return Ok(());
        }
        let path: Vec<_> = polygon.iter().map(|x| self.pixel(canvas, *x)).collect();
        Ok(canvas.area.draw(&Polygon::new(path, colour.filled())).map_err(text_of)?)
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
        canvas.area.draw_text(title, &canvas.bold(16.0), (px(MARGIN), px(self.top + 11.0))).map_err(text_of)?;
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

/// Corners of a box around points and their images.
pub(super) fn bounds<const D: usize>(points: &[Point<D>], mirror: Option<f64>) -> ([f64; 2], [f64; 2]) {
    let mut corners = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for image in images(mirror) {
        for x in points {
            let x = image.of(plane(x));
            for ((low, high), c) in corners.0.iter_mut().zip(&mut corners.1).zip(x) {
                *low = low.min(c);
                *high = high.max(c);
            }
        }
    }
    corners
}

/// Corners of the triangles of all elastic bodies.
pub(super) fn solid_triangles<'a, const D: usize>(
    setup: &'a Setup<D>,
    positions: &'a [Vec<Point<D>>],
) -> impl Iterator<Item = [[f64; 2]; 3]> + 'a {
    let bodies = setup.bodies.iter().zip(positions);
    bodies.filter_map(|(body, x)| Some((body.elastic()?.solid.mesh(), x))).flat_map(|(mesh, x)| {
        mesh.cells().map(|cell| {
            let corners = mesh.cell(cell);
            [0, 1, 2].map(|k| plane(&x[corners[k].index()]))
        })
    })
}

/// Edges of all bodies, without those on the plane of symmetry.
pub(super) fn outlines<'a, const D: usize>(
    setup: &'a Setup<D>,
    positions: &'a [Vec<Point<D>>],
    mirror: Option<f64>,
) -> impl Iterator<Item = [[f64; 2]; 2]> + 'a {
    setup.bodies.iter().zip(positions).flat_map(move |(body, x)| outline(body, x, mirror))
}

/// Edges of a body, without those on the plane of symmetry.
pub(super) fn outline<'a, const D: usize>(
    body: &'a Body<D>,
    positions: &'a [Point<D>],
    mirror: Option<f64>,
) -> impl Iterator<Item = [[f64; 2]; 2]> + 'a {
    let boundary = body.boundary();
    let on_plane = move |x: [f64; 2]| mirror.is_some_and(|plane| (x[0] - plane).abs() < 1e-9);
    let edges = boundary.facets().map(move |facet| {
        let ends = boundary.facet(facet);
        [0, 1].map(|k| plane(&positions[ends[k].index()]))
    });
    edges.filter(move |ends| !ends.iter().all(|x| on_plane(*x)))
}

/// The plane as it is, or its reflection across a vertical line.
#[derive(Clone, Copy)]
pub(super) struct Image {
    mirror: Option<f64>,
}

impl Image {
    /// Where a vector goes.
    pub(super) fn turn(self, u: [f64; 2]) -> [f64; 2] {
        if self.mirror.is_some() { [-u[0], u[1]] } else { u }
    }

    /// What becomes of a positive rotation.
    pub(super) fn sign(self) -> f64 {
        if self.mirror.is_some() { -1.0 } else { 1.0 }
    }

    /// Where a point goes.
    pub(super) fn of(self, x: [f64; 2]) -> [f64; 2] {
        self.mirror.map_or(x, |plane| [2.0 * plane - x[0], x[1]])
    }
}

/// The images to be drawn: the plane itself, and its reflection if only a half is there.
pub(super) fn images(mirror: Option<f64>) -> impl Iterator<Item = Image> {
    std::iter::once(Image { mirror: None }).chain(mirror.map(|plane| Image { mirror: Some(plane) }))
}

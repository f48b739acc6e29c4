//! Bitmaps and vector graphics with the same drawing code and a font of our own.

use std::path::Path;
use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::Error;
use crate::files::partial;

/// Font family; the names behind the first serve viewers of vector graphics.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";
/// Bitmaps are drawn this many times larger, then averaged.
const SUPERSAMPLING: u32 = 2;
/// Vector graphics have whole coordinates; this many of them make a unit.
const SUBDIVISION: u32 = 10;

/// Where to draw, and how many pixels a unit of length on paper has.
pub(super) struct Canvas<B: DrawingBackend> {
    /// The whole picture.
    pub(super) area: DrawingArea<B, Shift>,
    /// Pixels per unit: sizes of fonts and lines are multiples of it.
    pub(super) unit: f64,
}

impl<B: DrawingBackend> Canvas<B> {
    /// A length in pixels.
    pub(super) fn px(&self, length: f64) -> u32 {
        (length * self.unit).round().max(1.0) as u32
    }

    /// A font of a size in units.
    pub(super) fn font(&self, size: f64) -> TextStyle<'static> {
        (FAMILY, size * self.unit).into_font().color(&INK)
    }

    /// A bold font.
    pub(super) fn bold(&self, size: f64) -> TextStyle<'static> {
        (FAMILY, size * self.unit, FontStyle::Bold).into_font().color(&INK)
    }
}

/// Text and axes.
pub(super) const INK: RGBColor = RGBColor(40, 44, 52);
/// Grid lines.
pub(super) const GRID: RGBColor = RGBColor(228, 230, 234);

/// What drawing code reports.
pub(super) type Drawn = Result<(), Box<dyn std::error::Error + Send + Sync>>;

/// Something that can be drawn on any canvas.
pub(super) trait Picture {
    /// Width and height in units.
    fn size(&self) -> (u32, u32);

    /// Paints pixels before anything is drawn: red, green, blue, row by row, `unit` pixels per unit.
    fn paint(&self, pixels: &mut [u8], unit: f64) {
        let _ = unit;
        pixels.fill(255);
    }

    /// Draws.
    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn
    where
        B::ErrorType: 'static;
}

/// Draws a picture as PNG, with `pixels` pixels per unit; the file is complete when it appears.
pub(super) fn draw_png(path: &Path, picture: &impl Picture, pixels: u32) -> Result<(), Error> {
    write(path, |partial| {
        let (w, h) = picture.size();
        let (width, height) = (w * pixels, h * pixels);
        let fine = (width * SUPERSAMPLING, height * SUPERSAMPLING);
        let mut buffer = vec![255; (3 * fine.0 * fine.1) as usize];
        let unit = f64::from(pixels * SUPERSAMPLING);
        picture.paint(&mut buffer, unit);
        {
            let area = BitMapBackend::with_buffer(&mut buffer, fine).into_drawing_area();
            let canvas = Canvas { area, unit };
            picture.draw(&canvas)?;
            canvas.area.present().map_err(text_of)?;
        }
        let mut backend = BitMapBackend::new(partial, (width, height));
        backend.blit_bitmap((0, 0), (width, height), &averaged(&buffer, width, height)).map_err(text_of)?;
        backend.present().map_err(text_of)?;
        Ok(())
    })
}

/// Draws a picture as SVG; the file is complete when it appears.
pub(super) fn draw_svg(path: &Path, picture: &impl Picture) -> Result<(), Error> {
    write(path, |partial| Ok(std::fs::write(partial, svg_text(picture)?)?))
}

/// A picture as the text of an SVG file.
pub(super) fn svg_text(picture: &impl Picture) -> Result<String, Box<dyn std::error::Error + Send + Sync>> {
    register_fonts();
    let (width, height) = picture.size();
    let fine = (width * SUBDIVISION, height * SUBDIVISION);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, fine).into_drawing_area();
        area.fill(&WHITE).map_err(text_of)?;
        let canvas = Canvas { area, unit: f64::from(SUBDIVISION) };
        picture.draw(&canvas)?;
        canvas.area.present().map_err(text_of)?;
    }
    let size = |(width, height): (u32, u32)| format!("<svg width=\"{width}\" height=\"{height}\"");
    Ok(text.replacen(&size(fine), &size((width, height)), 1))
}

fn write(path: &Path, draw: impl FnOnce(&Path) -> Drawn) -> Result<(), Error> {
    register_fonts();
    let partial = partial(path);
    draw(&partial).map_err(|e| Error::Plot { path: path.to_owned(), message: e.to_string() })?;
    std::fs::rename(&partial, path).map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// The mean of each block of pixels.
fn averaged(fine: &[u8], width: u32, height: u32) -> Vec<u8> {
    let n = SUPERSAMPLING as usize;
    let (width, height) = (width as usize, height as usize);
    let mut coarse = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let sum: usize = (0..n * n)
                    .map(|k| usize::from(fine[3 * ((y * n + k / n) * width * n + x * n + k % n) + channel]))
                    .sum();
                coarse.push((sum / (n * n)) as u8);
            }
        }
    }
    coarse
}

fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let faces: [(FontStyle, &[u8]); 2] = [
            (FontStyle::Normal, include_bytes!("../../assets/DejaVuSans-subset.ttf")),
            (FontStyle::Bold, include_bytes!("../../assets/DejaVuSans-Bold-subset.ttf")),
        ];
        for (style, bytes) in faces {
            // A font that is refused shows up as an error of the first text drawn.
            let _ = plotters::style::register_font(FAMILY, style, bytes);
        }
    });
}

/// A sequence of colours from dark to light for values from 0 to 1, ordered also without colour vision (viridis).
pub(super) fn viridis(t: f64) -> RGBColor {
    const STOPS: [(u8, u8, u8); 9] = [
        (68, 1, 84),
        (71, 44, 122),
        (59, 81, 139),
        (44, 113, 142),
        (33, 144, 141),
        (39, 173, 129),
        (92, 200, 99),
        (170, 220, 50),
        (253, 231, 37),
    ];
    interpolated(&STOPS, t)
}

/// Pale at 0, deep blue at 1: speeds of a fluid.
pub(super) fn water(t: f64) -> RGBColor {
    const STOPS: [(u8, u8, u8); 7] = [
        (247, 251, 255),
        (219, 233, 246),
        (173, 208, 230),
        (107, 174, 214),
        (49, 130, 189),
        (12, 86, 160),
        (8, 40, 92),
    ];
    interpolated(&STOPS, t)
}

/// Blue at 0, grey in the middle, red at 1: rotation to the right and to the left.
pub(super) fn turning(t: f64) -> RGBColor {
    const STOPS: [(u8, u8, u8); 5] = [(16, 60, 150), (70, 140, 210), (170, 172, 176), (226, 112, 72), (160, 16, 32)];
    interpolated(&STOPS, t)
}

fn interpolated(stops: &[(u8, u8, u8)], t: f64) -> RGBColor {
    let at = t.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let k = (at as usize).min(stops.len() - 2);
    let mix = |a: u8, b: u8| (f64::from(a) + (at - k as f64) * (f64::from(b) - f64::from(a))).round() as u8;
    let (a, b) = (stops[k], stops[k + 1]);
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// A step of 1, 2 or 5 times a power of ten that divides a range into about `n` parts.
pub(super) fn nice_step(range: f64, n: f64) -> f64 {
    let raw = (range / n).max(f64::MIN_POSITIVE);
    let power = 10_f64.powf(raw.log10().floor());
    let nice = [1.0, 2.0, 5.0, 10.0].into_iter().find(|m| m * power >= raw * (1.0 - 1e-9)).unwrap_or(10.0);
    nice * power
}

/// A multiple of a step with the digits that the step needs.
pub(super) fn tick_text(value: f64, step: f64) -> String {
    let digits = (-step.log10() - 1e-9).ceil().max(0.0) as usize;
    // No negative zeros.
    let value = if value.abs() < 1e-6 * step { 0.0 } else { value };
    format!("{value:.digits$}").replace('-', "−")
}

/// Errors of the plotting library differ between canvases; their text does not.
pub(super) fn text_of<E: std::fmt::Display>(error: E) -> String {
    error.to_string()
}

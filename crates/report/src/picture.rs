//! The run as a picture in motion: an animated PNG.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use crate::frames::OUTSIDE;
use crate::{Error, Frames, Snapshot};

/// Number of pixels along the longer side.
const SIZE: f64 = 560.0;
/// Largest number of frames, which limits the size of the file.
const MOST: usize = 50;
/// Frames per second.
const RATE: u16 = 16;
/// Colours of the fluid, from rest to the largest speed. A few colours, because bands compress well.
const WATER: [[u8; 3]; 12] = [
    [247, 251, 255],
    [233, 242, 251],
    [219, 233, 246],
    [196, 221, 239],
    [173, 208, 230],
    [140, 191, 222],
    [107, 174, 214],
    [78, 152, 202],
    [49, 130, 189],
    [30, 108, 175],
    [12, 86, 160],
    [8, 40, 92],
];
/// Colours of bodies, of bodies in contact, and of outlines. Their indices in the palette follow.
const BODIES: [[u8; 3]; 3] = [[236, 170, 92], [214, 96, 77], [40, 44, 52]];
const FREE: u8 = WATER.len() as u8;
const TOUCHING: u8 = FREE + 1;
const INK: u8 = FREE + 2;
/// Colour of places outside the domain, and its index in the palette.
const WALL: [u8; 3] = [205, 205, 210];
const OUT: u8 = FREE + 3;

/// Writes the run as an animated PNG.
///
/// # Errors
/// [`Error::NoFrames`], [`Error::Frames`], [`Error::Picture`], [`Error::Results`].
pub fn write_picture(directory: &Path, path: &Path) -> Result<(), Error> {
    let frames = Frames::read(directory)?.filter(|frames| !frames.frames.is_empty());
    let frames = frames.ok_or_else(|| Error::NoFrames { path: directory.to_owned() })?;
    let file = File::create(path).map_err(|source| io::Error::Write { path: path.to_owned(), source })?;
    encode(&frames, BufWriter::new(file)).map_err(|source| Error::Picture { path: path.to_owned(), source })
}

fn encode(frames: &Frames, out: impl std::io::Write) -> Result<(), png::EncodingError> {
    let every = frames.frames.len().div_ceil(MOST);
    let shown: Vec<&Snapshot> = frames.frames.iter().step_by(every).collect();
    // The colours end at a quantile of the largest speeds: a few fast frames would leave no colours for the others.
    let mut speeds: Vec<f64> = shown.iter().map(|frame| frame.largest).collect();
    speeds.sort_by(f64::total_cmp);
    let largest = speeds[(speeds.len() - 1) * 7 / 10].max(1e-9);
    let canvas = Canvas::new(frames);
    let mut encoder = png::Encoder::new(out, canvas.width as u32, canvas.height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Four);
    encoder.set_palette(WATER.iter().chain(&BODIES).chain(&[WALL]).flatten().copied().collect::<Vec<u8>>());
    encoder.set_compression(png::Compression::Best);
    encoder.set_filter(png::FilterType::NoFilter);
    encoder.set_animated(shown.len() as u32, 0)?;
    encoder.set_frame_delay(1, RATE)?;
    let mut writer = encoder.write_header()?;
    for frame in shown {
        writer.write_image_data(&packed(&canvas.draw(frame, largest), canvas.width))?;
    }
    writer.finish()
}

/// Packs two pixels of four bits into each byte, row by row.
fn packed(pixels: &[u8], width: usize) -> Vec<u8> {
    let rows = pixels.chunks(width);
    rows.flat_map(|row| row.chunks(2).map(|pair| pair[0] << 4 | pair.get(1).copied().unwrap_or(0))).collect()
}

struct Canvas<'a> {
    frames: &'a Frames,
    /// Left side of the shown region, which includes the mirror image at a plane of symmetry.
    left: f64,
    /// Pixels per length.
    scale: f64,
    width: usize,
    height: usize,
}

impl<'a> Canvas<'a> {
    fn new(frames: &'a Frames) -> Self {
        let Frames { low, high, mirror, .. } = frames;
        let (left, right) =
            mirror.map_or((low[0], high[0]), |m| (low[0].min(2.0 * m - high[0]), high[0].max(2.0 * m - low[0])));
        let extent = [right - left, high[1] - low[1]];
        let scale = SIZE / extent[0].max(extent[1]);
        let [width, height] = extent.map(|length| (length * scale).round().max(1.0) as usize);
        Self { frames, left, scale, width, height }
    }

    /// Returns the colours of all pixels, row by row from above.
    fn draw(&self, frame: &Snapshot, largest: f64) -> Vec<u8> {
        let outlines: Vec<Vec<[f64; 2]>> = frame.outlines.iter().map(|o| self.frames.points(o).collect()).collect();
        let body = if frame.touches { TOUCHING } else { FREE };
        let mut pixels = vec![0; self.width * self.height];
        for row in 0..self.height {
            let y = self.frames.high[1] - (row as f64 + 0.5) / self.scale;
            let crossings: Vec<Vec<f64>> = outlines.iter().map(|points| crossings(points, y)).collect();
            for column in 0..self.width {
                let x = self.folded(self.left + (column as f64 + 0.5) / self.scale);
                let is_inside = |at: &Vec<f64>| at.iter().filter(|crossing| **crossing < x).count() % 2 == 1;
                pixels[row * self.width + column] = if crossings.iter().any(is_inside) {
                    body
                } else {
                    let band = |speed: f64| ((speed / largest * WATER.len() as f64) as usize).min(WATER.len() - 1);
                    speed(self.frames, frame, [x, y]).map_or(OUT, |speed| band(speed) as u8)
                };
            }
        }
        // An outline is a boundary between a body and anything else.
        let inner = pixels.clone();
        for k in (0..inner.len()).filter(|k| [FREE, TOUCHING].contains(&inner[*k])) {
            let (row, column) = (k / self.width, k % self.width);
            let rows = row.saturating_sub(1)..(row + 2).min(self.height);
            let columns = column.saturating_sub(1)..(column + 2).min(self.width);
            let is_other = |row: usize| {
                columns.clone().any(|column| ![FREE, TOUCHING].contains(&inner[row * self.width + column]))
            };
            if rows.into_iter().any(is_other) {
                pixels[k] = INK;
            }
        }
        pixels
    }

    /// Returns the mirror image of a position outside the computed half; other positions are unchanged.
    fn folded(&self, x: f64) -> f64 {
        match self.frames.mirror {
            Some(mirror) if x < self.frames.low[0] || x > self.frames.high[0] => 2.0 * mirror - x,
            _ => x,
        }
    }
}

/// Returns the places where a closed outline crosses a height, in ascending order.
fn crossings(points: &[[f64; 2]], y: f64) -> Vec<f64> {
    let ends = points.iter().zip(points.iter().cycle().skip(1));
    let crossed = ends.filter(|(a, b)| (a[1] < y) != (b[1] < y));
    let mut at: Vec<f64> = crossed.map(|(a, b)| a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])).collect();
    at.sort_by(f64::total_cmp);
    at
}

/// Interpolates the speed at a position bilinearly between the points of the raster that lie in the fluid; `None` if
/// none of the nearest points does.
fn speed(frames: &Frames, frame: &Snapshot, x: [f64; 2]) -> Option<f64> {
    let at = [0, 1].map(|k| (x[k] - frames.low[k]) / (frames.high[k] - frames.low[k]) * frame.n[k] as f64 - 0.5);
    let (mut sum, mut weights) = (0.0, 0.0);
    for corner in 0..4_i64 {
        let index = [at[0].floor() as i64 + corner % 2, at[1].floor() as i64 + corner / 2];
        let near = |k: usize| (1.0 - (at[k] - index[k] as f64).abs()).max(0.0);
        let [column, row] = [0, 1].map(|k| index[k].clamp(0, frame.n[k] as i64 - 1) as usize);
        let byte = frame.speed.0[row * frame.n[0] + column];
        if byte != OUTSIDE {
            sum += near(0) * near(1) * f64::from(byte);
            weights += near(0) * near(1);
        }
    }
    (weights > 0.0).then(|| sum / weights / 254.0 * frame.largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_outline_is_closed_by_a_line() {
        let half = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        assert_eq!(crossings(&half, 1.0), [0.0, 2.0]);
        assert!(crossings(&half, 3.0).is_empty());
    }

    #[test]
    fn pixels_are_packed_row_by_row() {
        assert_eq!(packed(&[1, 2, 3, 4, 5, 6], 3), [0x12, 0x30, 0x45, 0x60]);
    }
}

//! Frames of a run for its animation, and chosen moments: outlines of the bodies, and the speed of the fluid on a
//! raster.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use io::{Case, Watch, distance, leading_body};
use mesh::Aabb;
use serde::{Deserialize, Serialize};
use solver::{Observer, ObserverError, Setup, StepView};

use crate::Error;
use crate::plane::{mirror, outline};
use crate::raster::Raster;

/// File of the frames in a directory of results.
pub(crate) const FILE: &str = "frames.json";
/// Numbers of points of the raster along the longer side of the background, for the animation and for the moments.
const RESOLUTION: [f64; 2] = [90.0, 240.0];
/// Approximate number of frames of a run.
const FRAMES: usize = 150;
/// Number of units of the outlines along the longer side of the background.
const UNITS: f64 = 30_000.0;
/// Byte of the largest speed of a frame.
const LARGEST: u8 = 254;
/// Byte of points outside the fluid.
pub(crate) const OUTSIDE: u8 = 255;
/// Ratio by which the elastic energy must exceed the recorded maximum before a moment is recorded again (rasterising is
/// costly).
const RISE: f64 = 1.01;
/// Title of the moment of first contact.
const FIRST_CONTACT: &str = "First contact";

/// Frames of a run in the plane.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// Lower left corner of the background.
    pub low: [f64; 2],
    /// Upper right corner of the background.
    pub high: [f64; 2],
    /// Position of the vertical plane of symmetry, if only one half was computed.
    pub mirror: Option<f64>,
    /// Length of a unit of the outlines.
    pub unit: f64,
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// The frames, in order of time.
    pub frames: Vec<Snapshot>,
    /// Chosen moments by their titles, on a finer raster.
    pub moments: BTreeMap<String, Snapshot>,
    /// Elastic energy at the moment of largest deformation.
    #[serde(default)]
    pub elastic: f64,
    /// Step up to which frames are recorded.
    #[serde(default)]
    pub step: usize,
}

/// The problem at one time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Time.
    pub time: f64,
    /// Smallest distance of the leading body.
    pub distance: Option<f64>,
    /// Whether there is contact.
    pub touches: bool,
    /// Columns and rows of the raster.
    pub n: [usize; 2],
    /// Largest speed: byte 254 of the raster.
    pub largest: f64,
    /// Speed in bytes, row by row from below; 255 outside the fluid.
    pub speed: Packed,
    /// Outline of each body: pairs of 16-bit numbers in units from the lower left corner, lower byte first.
    pub outlines: Vec<Packed>,
}

impl Frames {
    /// Reads the frames of a run; `None` if none were recorded.
    ///
    /// # Errors
    /// [`Error::Results`], [`Error::Frames`].
    pub fn read(directory: &Path) -> Result<Option<Self>, Error> {
        let path = directory.join(FILE);
        if !path.is_file() {
            return Ok(None);
        }
        Self::parse(&io::read_text(&path)?).map(Some).map_err(|source| Error::Frames { path, source })
    }

    fn write(&self, path: &Path) -> Result<(), Error> {
        Ok(io::write_whole(path, serde_json::to_string(self)?.as_bytes())?)
    }

    fn parse(text: &str) -> Result<Self, serde_json::Error> {
        let frames: Self = serde_json::from_str(text)?;
        let fits = |frame: &Snapshot| {
            frame.n.iter().all(|n| *n > 0) && frame.n[0].checked_mul(frame.n[1]) == Some(frame.speed.0.len())
        };
        if frames.frames.iter().chain(frames.moments.values()).all(fits) {
            Ok(frames)
        } else {
            Err(serde::de::Error::custom("a raster does not have its number of columns and rows"))
        }
    }

    pub(crate) fn points<'a>(&self, outline: &'a Packed) -> impl Iterator<Item = [f64; 2]> + use<'a> {
        let (low, unit) = (self.low, self.unit);
        let place = move |bytes: &[u8], k: usize| {
            low[k] + unit * f64::from(i16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]))
        };
        outline.0.chunks_exact(4).map(move |bytes| [place(bytes, 0), place(bytes, 1)])
    }

    fn frame<const D: usize>(&self, view: &StepView<'_, D>, bottom: f64, longest: f64) -> Snapshot {
        let raster = Raster::new(self.low, self.high, longest);
        let fluid = view.setup.fluid.as_ref().zip(view.state.fluid.as_ref());
        let speeds = fluid.map_or_else(
            || vec![None; raster.n[0] * raster.n[1]],
            |(setup, fluid)| raster.speeds(&setup.background, fluid),
        );
        let largest = speeds.iter().flatten().copied().fold(0.0, f64::max);
        let byte = |speed: f64| (speed / largest.max(1e-12) * f64::from(LARGEST)).round() as u8;
        let bodies = view.setup.bodies.iter().zip(&view.state.bodies);
        let outlines = bodies.map(|(body, state)| {
            let positions = state.positions(body.reference());
            self.packed(&ordered(&outline(body.as_ref(), &positions, self.mirror)))
        });
        Snapshot {
            time: view.state.time,
            distance: leading_body(view.setup).and_then(|leading| distance(view, leading, bottom)),
            touches: touches(view),
            n: raster.n,
            largest,
            speed: Packed(speeds.iter().map(|speed| speed.map_or(OUTSIDE, byte)).collect()),
            outlines: outlines.collect(),
        }
    }

    fn packed(&self, points: &[[f64; 2]]) -> Packed {
        let units = |x: &[f64; 2]| [0, 1].map(|k| ((x[k] - self.low[k]) / self.unit).round() as i16);
        Packed(points.iter().flat_map(units).flat_map(i16::to_le_bytes).collect())
    }
}

/// Recorder of the frames of a run in 2D; in 3D it records nothing.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    frames: Option<Frames>,
    /// Directory to which frames are written at checkpoints.
    directory: Option<PathBuf>,
}

impl Recorder {
    /// Creates a recorder that also writes its frames at every checkpoint. A resumed run continues with these frames.
    pub fn new(directory: &Path) -> Self {
        Self { frames: None, directory: Some(directory.to_owned()) }
    }

    /// Writes the recorded data into the directory of the run.
    ///
    /// # Errors
    /// [`Error::Json`], [`Error::Results`].
    pub fn write(&self, directory: &Path) -> Result<(), Error> {
        self.frames.as_ref().map_or(Ok(()), |frames| frames.write(&directory.join(FILE)))
    }
}

impl Watch for Recorder {
    fn observer<const D: usize>(&mut self, case: &Case<D>) -> Option<Box<dyn Observer<D> + '_>> {
        if D != 2 {
            return None;
        }
        let (low, high) = bounds(&case.setup);
        let frames = self.frames.insert(Frames {
            low,
            high,
            mirror: mirror(&case.setup),
            unit: (high[0] - low[0]).max(high[1] - low[1]) / UNITS,
            bodies: case.setup.bodies.iter().map(|body| body.name().to_owned()).collect(),
            ..Frames::default()
        });
        let every = case.n_steps.div_ceil(FRAMES).max(1);
        let (n_steps, bottom) = (case.n_steps, case.bottom);
        let (directory, checkpoint_every) = (self.directory.as_deref(), case.checkpoint_every);
        Some(Box::new(FrameObserver { frames, n_steps, every, bottom, directory, checkpoint_every }))
    }
}

struct FrameObserver<'a> {
    frames: &'a mut Frames,
    n_steps: usize,
    /// Steps between two frames.
    every: usize,
    bottom: f64,
    /// Directory of the run, if frames are written at checkpoints.
    directory: Option<&'a Path>,
    /// Steps between two checkpoints.
    checkpoint_every: usize,
}

impl<const D: usize> Observer<D> for FrameObserver<'_> {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        let [coarse, fine] = RESOLUTION;
        let (step, touches) = (view.state.step, touches(view));
        if view.report.is_none() && step > 0 {
            if let Some(earlier) = self.directory.and_then(|directory| earlier(directory, step)) {
                *self.frames = earlier;
            }
            return Ok(());
        }
        let balances = view.report.iter().flat_map(|report| &report.bodies).filter_map(|body| body.balance.as_ref());
        let elastic: f64 = balances.map(|balance| balance.elastic_energy).sum();
        let is_largest = elastic > RISE * self.frames.elastic;
        let moments = [
            ("Start", view.report.is_none()),
            (FIRST_CONTACT, touches && !self.frames.moments.contains_key(FIRST_CONTACT)),
            ("Largest deformation", is_largest),
            ("End", step == self.n_steps && view.ends_step()),
        ];
        for (title, _) in moments.into_iter().filter(|(_, is_now)| *is_now) {
            let frame = self.frames.frame(view, self.bottom, fine);
            self.frames.moments.insert(title.to_owned(), frame);
        }
        if is_largest {
            self.frames.elastic = elastic;
        }
        if view.ends_step() && (step.is_multiple_of(self.every) || step == self.n_steps) {
            let frame = self.frames.frame(view, self.bottom, coarse);
            self.frames.frames.push(frame);
        }
        self.frames.step = step;
        let is_checkpoint = self.checkpoint_every > 0 && view.ends_step() && step.is_multiple_of(self.checkpoint_every);
        if let Some(directory) = self.directory.filter(|_| is_checkpoint) {
            let checkpoints = io::checkpoint_steps(directory);
            remove_stored(directory, |step| !checkpoints.contains(&step))?;
            self.frames.write(&directory.join(stored(step)))?;
        }
        Ok(())
    }
}

/// Returns the name of the file of frames at a checkpoint.
fn stored(step: usize) -> String {
    format!("frames-{step:08}.json")
}

/// Removes files of frames at checkpoints.
pub(crate) fn remove_stored(directory: &Path, is_removed: impl Fn(usize) -> bool) -> Result<(), Error> {
    for path in std::fs::read_dir(directory).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())) {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let step = name.strip_prefix("frames-").and_then(|name| name.strip_suffix(".json")?.parse().ok());
        if step.is_some_and(&is_removed) {
            std::fs::remove_file(&path).map_err(|source| io::Error::Write { path, source })?;
        }
    }
    Ok(())
}

/// Returns the frames of a run up to a step, if they were written after this step: at a checkpoint, or at the end.
fn earlier(directory: &Path, step: usize) -> Option<Frames> {
    let read = |name: &str| Frames::parse(&io::read_text(&directory.join(name)).ok()?).ok();
    read(&stored(step)).or_else(|| read(FILE)).filter(|frames| frames.step == step)
}

fn touches<const D: usize>(view: &StepView<'_, D>) -> bool {
    view.report.is_some_and(|report| report.contacts.iter().any(|contact| contact.is_active()))
}

/// Returns the corners of the box around the background; without a fluid, of a box around the bodies at the start with
/// room to move.
fn bounds<const D: usize>(setup: &Setup<D>) -> ([f64; 2], [f64; 2]) {
    let bounds = match &setup.fluid {
        Some(fluid) => Aabb::of_points(fluid.background.vertices()),
        None => {
            let starts = setup.bodies.iter().map(|body| body.initial().positions(body.reference()));
            let bounds = starts.map(|x| Aabb::of_points(&x)).fold(Aabb::empty(), |all, one| all.union(&one));
            bounds.expanded(0.5 * bounds.extent().max())
        }
    };
    (std::array::from_fn(|k| bounds.low[k]), std::array::from_fn(|k| bounds.high[k]))
}

/// Returns the points of an outline, from its edges in any order.
fn ordered(edges: &[[[f64; 2]; 2]]) -> Vec<[f64; 2]> {
    let key = |x: &[f64; 2]| x.map(f64::to_bits);
    let mut next: BTreeMap<[u64; 2], [f64; 2]> = edges.iter().map(|[from, to]| (key(from), *to)).collect();
    // An open outline begins where no edge ends.
    let ends: BTreeSet<[u64; 2]> = edges.iter().map(|[_, to]| key(to)).collect();
    let first = edges.iter().map(|[from, _]| from).find(|from| !ends.contains(&key(from)));
    let Some(&first) = first.or(edges.first().map(|[from, _]| from)) else { return Vec::new() };
    let mut points = vec![first];
    let mut at = first;
    while let Some(to) = next.remove(&key(&at)) {
        points.push(to);
        at = to;
    }
    points
}

/// Bytes that are written as text in base64.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Packed(pub Vec<u8>);

impl TryFrom<String> for Packed {
    type Error = base64::DecodeError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        STANDARD.decode(text).map(Self)
    }
}

impl From<Packed> for String {
    fn from(bytes: Packed) -> Self {
        STANDARD.encode(bytes.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_in_any_order_become_an_outline() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let edges = [2, 0, 3, 1].map(|k| [corners[k], corners[(k + 1) % 4]]);
        let points = ordered(&edges);
        assert_eq!((points.len(), points[0]), (5, points[4]));
        let open: Vec<_> = edges.into_iter().filter(|[from, _]| *from != [0.0, 1.0]).collect();
        assert_eq!(ordered(&open), corners);
    }

    #[test]
    fn frames_are_read_as_they_were_written() {
        let frames = Frames { low: [1.0, -2.0], unit: 1e-3, ..Frames::default() };
        let outlines = vec![frames.packed(&[[1.0, -2.0], [4.0, 3.5]])];
        let frame = Snapshot { n: [3, 1], speed: Packed(vec![0, 7, 255]), outlines, ..Snapshot::default() };
        let written = Frames { frames: vec![frame], ..frames };
        let text = serde_json::to_string(&written).unwrap_or_default();
        let read = Frames::parse(&text).unwrap_or_default();
        assert_eq!(read, written);
        assert!(Frames::parse(&text.replace("[3,1]", "[4,1]")).is_err());
        let points: Vec<_> = read.points(&read.frames[0].outlines[0]).collect();
        assert!(
            points.iter().zip([[1.0, -2.0], [4.0, 3.5]]).all(|(a, b)| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-3)
        );
    }
}

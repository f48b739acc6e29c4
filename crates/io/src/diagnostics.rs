//! `diagnostics.csv`: what a physicist asks for after every step.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use mesh::{Placed, Point, simplex_measure};
use solver::{Body, Setup, StepView};

use crate::Error;
use crate::forces::enclosed;
use crate::history::{column_prefix, number};
use crate::plot::PLATE;

/// Columns of the vertical forces on a body.
const FORCES: [&str; 7] = [
    "force_inertia",
    "force_gravity",
    "force_pressure",
    "force_viscous",
    "force_penalty",
    "force_contact",
    "force_remainder",
];
/// Column of the power of the fluid on a body.
const POWER: &str = "fluid_power";

/// Writes one row per step, or part of a step, beside the history; the file is complete after every row.
///
/// Columns: `time`; of each body, with the prefix of the history, `volume`, of a plate `min_thickness`, the vertical forces,
/// and the power of the fluid on the body (with the mean traction on each piece of the interface); then `fluid_volume` and `total_energy`. The remainder is what supports and contacts as master make up for:
/// for a body without them, the error of the balance.
pub(crate) struct Diagnostics {
    path: PathBuf,
    file: File,
    /// Whether each body is a plate.
    plates: Vec<bool>,
    has_header: bool,
}

impl Diagnostics {
    /// Diagnostics in a new file.
    pub(crate) fn create<const D: usize>(path: &Path, setup: &Setup<D>) -> Result<Self, Error> {
        let file = File::create(path).map_err(|source| Error::Write { path: path.to_owned(), source })?;
        let plates = setup.bodies.iter().map(is_plate).collect();
        Ok(Self { path: path.to_owned(), file, plates, has_header: false })
    }

    /// Writes the row of a step.
    pub(crate) fn write<const D: usize>(&mut self, view: &StepView<'_, D>) -> Result<(), Error> {
        let mut text = String::new();
        if !self.has_header {
            text = self.header(view) + "\n";
            self.has_header = true;
        }
        if let Some(row) = self.row(view) {
            text += &row.into_iter().map(number).collect::<Vec<_>>().join(",");
            text.push('\n');
        }
        let written = self.file.write_all(text.as_bytes()).and_then(|()| self.file.flush());
        written.map_err(|source| Error::Write { path: self.path.clone(), source })
    }

    fn header<const D: usize>(&self, view: &StepView<'_, D>) -> String {
        let mut names = vec!["time".to_owned()];
        for (index, is_plate) in self.plates.iter().enumerate() {
            let prefix = column_prefix(view.setup, index);
            let columns =
                ["volume"].into_iter().chain(is_plate.then_some("min_thickness")).chain(FORCES).chain([POWER]);
            names.extend(columns.map(|column| format!("{prefix}{column}")));
        }
        names.extend(["fluid_volume", "total_energy"].map(str::to_owned));
        names.join(",")
    }

    fn row<const D: usize>(&self, view: &StepView<'_, D>) -> Option<Vec<f64>> {
        let report = view.report?;
        let mut row = vec![view.state.time];
        for (index, body) in view.setup.bodies.iter().enumerate() {
            let positions = view.state.bodies[index].positions(body.reference());
            row.push(volume(body, &positions));
            if self.plates[index] {
                row.push(smallest_thickness(body, &positions));
            }
            let forces = report.bodies[index].forces.map_or([f64::NAN; FORCES.len()], |f| {
                let all = [f.inertia, f.body_force, f.pressure, f.viscous, f.penalty, f.contact, f.remainder()];
                all.map(|force| force[D - 1])
            });
            row.extend(forces);
            row.push(fluid_power(view, index));
        }
        row.extend([view.state.fluid.cut.fluid_volume(), report.total_energy()]);
        Some(row)
    }
}

/// Power of the fluid on body `index`, from the mean traction on each piece and the body's velocity in its middle.
fn fluid_power<const D: usize>(view: &StepView<'_, D>, index: usize) -> f64 {
    let Some(report) = view.report else { return f64::NAN };
    let boundary = view.setup.bodies[index].boundary();
    let velocities = &view.state.bodies[index].velocity;
    let pieces = view.state.fluid.cut.interface().iter().zip(&report.tractions);
    let of_body = pieces.filter(|(piece, _)| piece.body.index() == index);
    let power = of_body.map(|(piece, traction)| {
        let share = |vertex: usize| (0..D).map(|k| piece.barycentric[k][vertex]).sum::<f64>() / D as f64;
        let vertices = boundary.facet(piece.facet).iter().enumerate();
        let velocity = vertices.map(|(k, v)| velocities[v.index()] * share(k)).sum::<Point<D>>();
        piece.measure * traction.total().dot(&velocity)
    });
    power.sum()
}

/// Volume of a body at the given positions.
fn volume<const D: usize>(body: &Body<D>, positions: &[Point<D>]) -> f64 {
    let Some(elastic) = body.elastic() else { return enclosed(&Placed::new(body.boundary(), positions)).0 };
    let mesh = elastic.solid.mesh();
    let corners = |cell| mesh.cell(cell).iter().map(|v| positions[v.index()]).collect::<Vec<_>>();
    mesh.cells().map(|cell| simplex_measure(&corners(cell))).sum()
}

/// Whether a body is many times wider than high.
fn is_plate<const D: usize>(body: &Body<D>) -> bool {
    let extent = |k: usize| {
        let range = body
            .reference()
            .iter()
            .map(|x| x[k])
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        range.1 - range.0
    };
    // Of a plate cut by a plane of symmetry there is one half.
    (0..D - 1).all(|k| extent(k) > 0.5 * PLATE * extent(D - 1))
}

/// Smallest height of a body over its width: upper minus lower side, both straight between the vertices, so that the
/// smallest value is at one of them.
fn smallest_thickness<const D: usize>(body: &Body<D>, positions: &[Point<D>]) -> f64 {
    let boundary = body.boundary();
    let edges: Vec<[[f64; 2]; 2]> = boundary
        .facets()
        .map(|facet| boundary.facet(facet))
        .map(|ends| [0, 1].map(|k| [positions[ends[k].index()][0], positions[ends[k].index()][D - 1]]))
        .collect();
    let thickness = |x: f64| {
        let heights = edges.iter().filter(|[a, b]| a[0].min(b[0]) <= x && x <= a[0].max(b[0]) && a[0] != b[0]);
        let heights = heights.map(|[a, b]| a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
        high - low
    };
    let all = edges.iter().flatten().map(|x| thickness(x[0]));
    all.filter(|t| t.is_finite()).fold(f64::INFINITY, f64::min)
}

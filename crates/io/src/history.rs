//! `history.csv`: one row per step.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use solver::{Observer, ObserverError, Setup, StepView};

use crate::Error;
use crate::forces::FluidForce;
use crate::measures::BodyMeasures;

/// Names of the axes in columns.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Columns that every body has; those of [`FluidForce`] follow.
const BODY: [&str; 19] = [
    "d_min",
    "d_max",
    "body_height",
    "lowest_velocity",
    "lowest_acceleration",
    "centre_y",
    "centre_velocity",
    "contact_force",
    "contact_power",
    "max_penetration",
    "active_points",
    "energy_kinetic_solid",
    "energy_elastic",
    "energy_gravity",
    "centre_x",
    "centre_velocity_x",
    "angle",
    "angular_velocity",
    "contact_force_x",
];

/// Columns of the run as a whole.
const RUN: [&str; 14] = [
    "energy_kinetic_fluid",
    "energy_contact",
    "leak_net",
    "leak_absolute",
    "newton",
    "linear_iterations",
    "factorizations",
    "smallest_fraction",
    "dofs",
    "seconds_cut",
    "seconds_space",
    "seconds_assembly",
    "seconds_linear",
    "seconds_output",
];

/// Writes one row per step, or per part of a step that was divided; the file is complete after every row.
///
/// With one body the columns are `time`, those of the body, those of the run. With several, the columns of each body
/// carry its name as a prefix, `NAME_d_min`; the forces of the fluid are those of [`FluidForce`]. The energy of contacts is that of all contacts.
pub struct History {
    path: PathBuf,
    file: File,
    bottom: f64,
    has_header: bool,
}

impl History {
    /// A history in a new file; `bottom` is the height from which distances are measured without a contact.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn create(path: &Path, bottom: f64) -> Result<Self, Error> {
        let file = File::create(path).map_err(|source| Error::Write { path: path.to_owned(), source })?;
        Ok(Self { path: path.to_owned(), file, bottom, has_header: false })
    }

    /// Writes the row of a step, with the time that output took.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn write<const D: usize>(&mut self, view: &StepView<'_, D>, seconds_output: f64) -> Result<(), Error> {
        let mut text = String::new();
        if !self.has_header {
            text = header(view) + "\n";
            self.has_header = true;
        }
        if let Some(row) = row(view, self.bottom, seconds_output) {
            text += &row;
            text.push('\n');
        }
        let written = self.file.write_all(text.as_bytes()).and_then(|()| self.file.flush());
        written.map_err(|source| Error::Write { path: self.path.clone(), source })
    }
}

impl<const D: usize> Observer<D> for History {
    fn after_step(&mut self, view: &StepView<'_, D>) -> Result<(), ObserverError> {
        Ok(self.write(view, 0.0)?)
    }
}

/// What the columns of a body begin with: nothing if it is the only one.
pub(crate) fn column_prefix<const D: usize>(setup: &Setup<D>, body: usize) -> String {
    if setup.bodies.len() == 1 { String::new() } else { format!("{}_", setup.bodies[body].name) }
}

fn header<const D: usize>(view: &StepView<'_, D>) -> String {
    let mut names = vec!["time".to_owned()];
    for index in 0..view.setup.bodies.len() {
        let prefix = column_prefix(view.setup, index);
        names.extend(BODY.iter().map(|column| format!("{prefix}{column}")));
        names.extend(force_columns::<D>().into_iter().map(|column| format!("{prefix}{column}")));
    }
    names.extend(RUN.iter().map(|column| (*column).to_owned()));
    names.join(",")
}

/// Names of the columns of a [`FluidForce`].
fn force_columns<const D: usize>() -> Vec<String> {
    let of = |what: &str, axes: &[&str]| axes.iter().map(|axis| format!("{what}_{axis}")).collect::<Vec<_>>();
    let torque = match &AXES[turning::<D>()..] {
        [_] => vec!["torque".to_owned()],
        axes => of("torque", axes),
    };
    [of("force", &AXES[..D]), of("traction_force", &AXES[..D]), torque].concat()
}

/// The first axis about which a body can turn: as many as pairs of axes span planes.
fn turning<const D: usize>() -> usize {
    AXES.len() - D * (D - 1) / 2
}

fn row<const D: usize>(view: &StepView<'_, D>, bottom: f64, seconds_output: f64) -> Option<String> {
    let report = view.report?;
    let mut values = vec![number(view.state.time)];
    for index in 0..view.setup.bodies.len() {
        let body = BodyMeasures::new(view, index, bottom)?;
        let lengths = [body.d_min, body.d_max, body.body_height, body.lowest_velocity, body.lowest_acceleration];
        let forces =
            [body.centre_y, body.centre_velocity, body.contact_force, body.contact_power, body.max_penetration];
        values.extend(lengths.into_iter().chain(forces).map(number));
        values.push(body.active_points.to_string());
        values.extend([body.energy_kinetic, body.energy_elastic, body.energy_gravity].map(number));
        values.extend([body.centre_x, body.centre_velocity_x, body.angle, body.angular_velocity].map(number));
        values.push(number(body.contact_force_x));
        let force = FluidForce::new(view, index)?;
        values.extend(force.total.iter().chain(&force.traction).map(|f| number(*f)));
        values.extend(force.torque[turning::<D>()..].iter().map(|m| number(*m)));
    }
    let stored: f64 = report.contacts.iter().map(|contact| contact.stored_energy).sum();
    let flow = [report.fluid_kinetic_energy, stored, report.flow.leak_net, report.flow.leak_absolute];
    values.extend(flow.map(number));
    let newton = &report.newton;
    values.extend([newton.iterations, newton.linear_iterations, newton.factorizations].map(|n| n.to_string()));
    values.push(number(report.cut.smallest_fraction));
    values.push(report.n_dofs.to_string());
    let seconds = &report.seconds;
    let stages = [seconds.cut, seconds.space, seconds.assembly, seconds.linear, seconds_output];
    values.extend(stages.map(|s| format!("{s:.6}")));
    Some(values.join(","))
}

/// Shortest text that reads back as the same number.
pub(crate) fn number(value: f64) -> String {
    // No negative zeros.
    let value = value + 0.0;
    if value != 0.0 && (value.abs() < 1e-4 || value.abs() >= 1e12) { format!("{value:e}") } else { value.to_string() }
}

/// A history that was read back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HistoryTable {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl HistoryTable {
    /// Reads a history; an incomplete last row is left out.
    ///
    /// # Errors
    /// [`Error::Read`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
        let mut lines = text.lines();
        let names: Vec<String> = lines.next().unwrap_or_default().split(',').map(str::to_owned).collect();
        let rows = lines
            .map(|line| line.split(',').map(|value| value.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>())
            .filter(|row| row.len() == names.len())
            .collect();
        Ok(Self { names, rows })
    }

    /// Names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// A column; `None` if there is none of that name.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.names.iter().position(|n| n == name)?;
        Some(self.rows.iter().map(|row| row[index]).collect())
    }
}

//! `history.csv` and `diagnostics.csv`: one row per step, or per part of a step that was divided.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use solver::{FluidReport, ForceBalance, Setup, StepReport, StepView};

use crate::Error;
use crate::measures::BodyMeasures;

/// The file that a column belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Table {
    /// `history.csv`: motion, contact, energies, cost.
    History,
    /// `diagnostics.csv`: balances and volumes.
    Diagnostics,
}

/// How the number of a column follows from a step.
enum Value<const D: usize> {
    /// A number of a body: the column appears once for each body.
    Body(fn(&BodyMeasures<'_, D>) -> f64),
    /// A component of a vector of a body, with the number of the axis.
    Component(fn(&BodyMeasures<'_, D>, usize) -> f64, usize),
    /// A number of the whole run.
    Run(fn(&RunMeasures<'_, D>) -> f64),
}

/// A column of one of the files.
struct Column<const D: usize> {
    table: Table,
    name: String,
    value: Value<D>,
}

/// The run as a whole after a step.
struct RunMeasures<'a, const D: usize> {
    view: &'a StepView<'a, D>,
    step: &'a StepReport<D>,
    /// Wall-clock time of the output of the step.
    seconds_output: f64,
}

impl<const D: usize> RunMeasures<'_, D> {
    /// A quantity of the fluid; zero without a fluid.
    fn fluid(&self, of: impl FnOnce(&FluidReport<D>) -> f64) -> f64 {
        self.step.fluid.as_ref().map_or(0.0, of)
    }
}

/// All columns, in the order of the files. In a row the columns of the bodies stand before those of the run.
#[rustfmt::skip] // one line per column
fn columns<const D: usize>() -> Vec<Column<D>> {
    use Table::{Diagnostics, History};
    let column = |table, name: &str, value| Column { table, name: name.to_owned(), value };
    let body = |table, name, of| column(table, name, Value::Body(of));
    let component = |table, name: String, of, axis| Column { table, name, value: Value::Component(of, axis) };
    let run = |table, name, of| column(table, name, Value::Run(of));
    let mut all = vec![
        body(History, "d_min", |b| b.distance),
        body(History, "d_max", |b| b.distance + b.height()),
        body(History, "body_height", |b| b.height()),
        body(History, "lowest_velocity", |b| b.body().lowest_velocity[D - 1]),
        body(History, "lowest_acceleration", |b| b.body().lowest_acceleration[D - 1]),
        body(History, "centre_y", |b| b.centre[D - 1]),
        body(History, "centre_velocity", |b| b.centre_velocity[D - 1]),
        body(History, "contact_force", |b| b.contact_force[D - 1]),
        body(History, "contact_power", |b| b.contacts().map(|contact| contact.power).sum()),
        body(History, "max_penetration", |b| b.penetration()),
        body(History, "active_points", |b| b.active_points() as f64),
        body(History, "energy_kinetic_solid", |b| b.body().balance.as_ref().map_or(0.0, |e| e.kinetic_energy)),
        body(History, "energy_elastic", |b| b.body().balance.as_ref().map_or(0.0, |e| e.elastic_energy)),
        body(History, "energy_gravity", |b| b.body().balance.as_ref().map_or(0.0, |e| e.potential_energy)),
        body(History, "centre_x", |b| b.centre[0]),
        body(History, "centre_velocity_x", |b| b.centre_velocity[0]),
        body(History, "angle", |b| b.rotation[0]),
        body(History, "angular_velocity", |b| b.rotation[1]),
        body(History, "contact_force_x", |b| b.contact_force[0]),
        body(Diagnostics, "volume", |b| b.volume()),
        body(Diagnostics, "force_inertia", |b| vertical(b, |f| f.inertia[D - 1])),
        body(Diagnostics, "force_gravity", |b| vertical(b, |f| f.body_force[D - 1])),
        body(Diagnostics, "force_pressure", |b| vertical(b, |f| f.pressure[D - 1])),
        body(Diagnostics, "force_viscous", |b| vertical(b, |f| f.viscous[D - 1])),
        body(Diagnostics, "force_penalty", |b| vertical(b, |f| f.penalty[D - 1])),
        body(Diagnostics, "force_contact", |b| vertical(b, |f| f.contact[D - 1])),
        body(Diagnostics, "force_remainder", |b| vertical(b, |f| f.remainder()[D - 1])),
        body(Diagnostics, "fluid_power", |b| b.fluid_power()),
        run(History, "energy_kinetic_fluid", |r| r.fluid(|fluid| fluid.kinetic_energy)),
        run(History, "energy_contact", |r| r.step.contacts.iter().map(|contact| contact.stored_energy).sum()),
        run(History, "leak_net", |r| r.fluid(|fluid| fluid.flow.leak_net)),
        run(History, "leak_absolute", |r| r.fluid(|fluid| fluid.flow.leak_absolute)),
        run(History, "newton", |r| r.step.newton.iterations as f64),
        run(History, "linear_iterations", |r| r.step.newton.linear_iterations as f64),
        run(History, "factorizations", |r| r.step.newton.factorizations as f64),
        run(History, "smallest_fraction", |r| r.fluid(|fluid| fluid.cut.smallest_fraction)),
        run(History, "dofs", |r| r.step.n_dofs as f64),
        run(History, "seconds_cut", |r| microseconds(r.step.seconds.cut)),
        run(History, "seconds_space", |r| microseconds(r.step.seconds.space)),
        run(History, "seconds_assembly", |r| microseconds(r.step.seconds.assembly)),
        run(History, "seconds_linear", |r| microseconds(r.step.seconds.linear)),
        run(History, "seconds_output", |r| microseconds(r.seconds_output)),
        run(Diagnostics, "fluid_volume", |r| r.view.state.fluid.as_ref().map_or(0.0, |fluid| fluid.cut.fluid_volume())),
        run(Diagnostics, "total_energy", |r| r.step.total_energy()),
    ];
    const AXES: [&str; 3] = ["x", "y", "z"];
    for (axis, name) in AXES.iter().enumerate().take(D) {
        all.push(component(History, format!("force_{name}"), |b, axis| b.fluid.total[axis], axis));
    }
    for (axis, name) in AXES.iter().enumerate().take(D) {
        all.push(component(History, format!("traction_force_{name}"), |b, axis| b.fluid.traction[axis], axis));
    }
    // In the plane a body rotates about the third axis only.
    let rotation_axes = AXES.len() - D * (D - 1) / 2;
    for (axis, name) in AXES.iter().enumerate().skip(rotation_axes) {
        let name = if D == 2 { "torque".to_owned() } else { format!("torque_{name}") };
        all.push(component(History, name, |b, axis| b.fluid.torque[axis], axis));
    }
    all
}

/// A vertical force on a body; not a number if its motion is prescribed.
fn vertical<const D: usize>(body: &BodyMeasures<'_, D>, of: fn(&ForceBalance<D>) -> f64) -> f64 {
    body.body().forces.as_ref().map_or(f64::NAN, of)
}

/// A time rounded to a microsecond.
fn microseconds(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// Writes `history.csv` and `diagnostics.csv`; both are complete after every row.
///
/// A row has the time, the columns of each body, and those of the run. With several bodies the columns of a body carry its
/// name as a prefix: `NAME_d_min`.
pub(crate) struct History<const D: usize> {
    columns: Vec<Column<D>>,
    files: [(Table, PathBuf, File); 2],
}

impl<const D: usize> History<D> {
    /// Creates both files with their headers.
    pub(crate) fn create(directory: &Path, setup: &Setup<D>) -> Result<Self, Error> {
        let open = |table, name: &str| {
            let path = directory.join(name);
            let file = File::create(&path).map_err(|source| Error::Write { path: path.clone(), source })?;
            Ok::<_, Error>((table, path, file))
        };
        let files = [open(Table::History, "history.csv")?, open(Table::Diagnostics, "diagnostics.csv")?];
        let mut history = Self { columns: columns(), files };
        for k in 0..history.files.len() {
            let line = history.header(history.files[k].0, setup);
            history.push(k, &line)?;
        }
        Ok(history)
    }

    fn header(&self, table: Table, setup: &Setup<D>) -> String {
        let of_table = |column: &&Column<D>| column.table == table;
        let of_run = |column: &&Column<D>| matches!(column.value, Value::Run(_));
        let mut names = vec!["time".to_owned()];
        for body in 0..setup.bodies.len() {
            let prefix = column_prefix(setup, body);
            let columns = self.columns.iter().filter(|c| of_table(c) && !of_run(c));
            names.extend(columns.map(|column| format!("{prefix}{}", column.name)));
        }
        let columns = self.columns.iter().filter(|c| of_table(c) && of_run(c));
        names.extend(columns.map(|column| column.name.clone()));
        names.join(",")
    }

    /// Writes the rows of a step. `bodies` are the measures of all bodies, `seconds_output` the wall-clock time that output
    /// took.
    pub(crate) fn write(
        &mut self,
        view: &StepView<'_, D>,
        bodies: &[BodyMeasures<'_, D>],
        seconds_output: f64,
    ) -> Result<(), Error> {
        let Some(step) = view.report else { return Ok(()) };
        let run = RunMeasures { view, step, seconds_output };
        for k in 0..self.files.len() {
            let columns = || self.columns.iter().filter(|column| column.table == self.files[k].0);
            let mut row = vec![view.state.time];
            for body in bodies {
                row.extend(columns().filter_map(|column| match column.value {
                    Value::Body(of) => Some(of(body)),
                    Value::Component(of, axis) => Some(of(body, axis)),
                    Value::Run(_) => None,
                }));
            }
            row.extend(
                columns().filter_map(|column| if let Value::Run(of) = column.value { Some(of(&run)) } else { None }),
            );
            let line = row.into_iter().map(number).collect::<Vec<_>>().join(",");
            self.push(k, &line)?;
        }
        Ok(())
    }

    fn push(&mut self, file: usize, line: &str) -> Result<(), Error> {
        let (_, path, file) = &mut self.files[file];
        let written = file.write_all(format!("{line}\n").as_bytes()).and_then(|()| file.flush());
        written.map_err(|source| Error::Write { path: path.clone(), source })
    }
}

/// Prefix of the columns of a body: empty if it is the only one.
fn column_prefix<const D: usize>(setup: &Setup<D>, body: usize) -> String {
    if setup.bodies.len() == 1 { String::new() } else { format!("{}_", setup.bodies[body].name()) }
}

/// Shortest text that reads back as the same number.
fn number(value: f64) -> String {
    // Adding zero turns a negative zero into a positive one.
    let value = value + 0.0;
    if value != 0.0 && (value.abs() < 1e-4 || value.abs() >= 1e12) { format!("{value:e}") } else { value.to_string() }
}

/// A table of numbers that was read back from a CSV file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HistoryTable {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl HistoryTable {
    /// Reads a table. An incomplete last row, as a run that was stopped may leave, is ignored.
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

    /// The column of a name, if there is one.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.names.iter().position(|n| n == name)?;
        Some(self.rows.iter().map(|row| row[index]).collect())
    }
}

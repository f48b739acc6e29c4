//! `history.csv`, `diagnostics.csv` and `probes.csv`: one row per step, or per substep of a step that was divided.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use mesh::AXES;
use solver::{FluidReport, ForceBalance, Ledger, Setup, StepReport, StepView};

use crate::Error;
use crate::files::read_text;
use crate::measures::BodyMeasures;
use crate::probes::Probe;
use crate::summary::UnitLabels;

/// Returns the unit of a column; empty for pure numbers.
type UnitOf = fn(&UnitLabels) -> &str;

const LENGTH: UnitOf = |units| &units.length;
const VELOCITY: UnitOf = |units| &units.velocity;
const ACCELERATION: UnitOf = |units| &units.acceleration;
const FORCE: UnitOf = |units| &units.force;
const ENERGY: UnitOf = |units| &units.energy;
const MOMENT: UnitOf = |units| &units.moment;
const POWER: UnitOf = |units| &units.power;
const VOLUME: UnitOf = |units| &units.volume;
const FLOW: UnitOf = |units| &units.flow;
const ANGLE: UnitOf = |_| "rad";
const ANGULAR_VELOCITY: UnitOf = |units| &units.angular_velocity;
/// Unit of times of the clock.
const SECONDS: UnitOf = |_| "s";
const NUMBER: UnitOf = |_| "";

/// Name, unit and number of a column that appears once for each body.
type BodyColumn<const D: usize> = (String, UnitOf, Box<dyn Fn(&BodyMeasures<'_, D>) -> f64>);

type BodyNumber<const D: usize> = fn(&BodyMeasures<'_, D>) -> f64;

/// Name, unit and number of a column of the run as a whole.
type RunColumn<const D: usize> = (String, UnitOf, Box<dyn Fn(&RunMeasures<'_, D>) -> f64>);

type RunNumber<const D: usize> = fn(&RunMeasures<'_, D>) -> f64;

/// The run as a whole after a step.
struct RunMeasures<'a, const D: usize> {
    step: &'a StepReport<D>,
    /// Wall-clock time of the output of the step.
    seconds_output: f64,
}

impl<const D: usize> RunMeasures<'_, D> {
    /// Returns a quantity of the fluid; zero without a fluid.
    fn fluid(&self, of: impl FnOnce(&FluidReport<D>) -> f64) -> f64 {
        self.step.fluid.as_ref().map_or(0.0, of)
    }
}

/// Returns the columns of the bodies in `history.csv`: motion, contact, energies, forces of the fluid.
fn history_of_bodies<const D: usize>() -> Vec<BodyColumn<D>> {
    let columns: &[(&str, UnitOf, BodyNumber<D>)] = &[
        ("d_min", LENGTH, |b| b.distance),
        ("d_max", LENGTH, |b| b.distance + b.height()),
        ("body_height", LENGTH, |b| b.height()),
        ("lowest_velocity", VELOCITY, |b| b.body().lowest_velocity[D - 1]),
        ("lowest_acceleration", ACCELERATION, |b| b.body().lowest_acceleration[D - 1]),
        ("centre_y", LENGTH, |b| b.centre[1]),
        ("centre_velocity", VELOCITY, |b| b.centre_velocity[D - 1]),
        ("contact_force", FORCE, |b| b.contact_force[D - 1]),
        ("contact_power", POWER, |b| b.contact_power),
        ("max_penetration", LENGTH, |b| b.penetration()),
        ("active_points", NUMBER, |b| b.active_points() as f64),
        ("energy_kinetic_solid", ENERGY, |b| b.body().balance.as_ref().map_or(0.0, |e| e.kinetic_energy)),
        ("energy_elastic", ENERGY, |b| b.body().balance.as_ref().map_or(0.0, |e| e.elastic_energy)),
        ("energy_gravity", ENERGY, |b| b.body().balance.as_ref().map_or(0.0, |e| e.potential_energy)),
        ("centre_x", LENGTH, |b| b.centre[0]),
        ("centre_velocity_x", VELOCITY, |b| b.centre_velocity[0]),
        ("angle", ANGLE, |b| b.rotation[0]),
        ("angular_velocity", ANGULAR_VELOCITY, |b| b.rotation[1]),
        ("contact_force_x", FORCE, |b| b.contact_force[0]),
    ];
    let mut columns: Vec<BodyColumn<D>> = columns.iter().map(boxed).collect();
    let axes = || AXES.into_iter().enumerate();
    for (axis, name) in axes().take(D) {
        columns.push((format!("force_{name}"), FORCE, Box::new(move |b| b.fluid_force[axis])));
    }
    for (axis, name) in axes().take(D) {
        columns.push((format!("traction_force_{name}"), FORCE, Box::new(move |b| b.traction_force[axis])));
    }
    if D == 2 {
        columns.push(("torque".to_owned(), MOMENT, Box::new(|b| b.torque[2])));
    } else {
        for (axis, name) in axes() {
            columns.push((format!("torque_{name}"), MOMENT, Box::new(move |b| b.torque[axis])));
        }
        for (axis, name) in axes() {
            columns.push((format!("spin_{name}"), ANGULAR_VELOCITY, Box::new(move |b| b.spin[axis])));
        }
        columns.push(("centre_z".to_owned(), LENGTH, Box::new(|b| b.centre[2])));
        columns.push(("centre_velocity_y".to_owned(), VELOCITY, Box::new(|b| b.centre_velocity[1])));
        columns.push(("contact_force_y".to_owned(), FORCE, Box::new(|b| b.contact_force[1])));
    }
    columns
}

/// Returns the columns of the run in `history.csv`: energies, leaks, cost.
fn history_of_run<const D: usize>() -> Vec<RunColumn<D>> {
    let columns: &[(&str, UnitOf, RunNumber<D>)] = &[
        ("energy_kinetic_fluid", ENERGY, |r| r.fluid(|fluid| fluid.kinetic_energy)),
        ("energy_contact", ENERGY, |r| r.step.contacts.iter().map(|contact| contact.stored_energy).sum()),
        ("leak_net", FLOW, |r| r.fluid(|fluid| fluid.flow.leak_net)),
        ("leak_absolute", FLOW, |r| r.fluid(|fluid| fluid.flow.leak_absolute)),
        ("newton", NUMBER, |r| r.step.newton.iterations as f64),
        ("linear_iterations", NUMBER, |r| r.step.newton.linear_iterations as f64),
        ("factorizations", NUMBER, |r| r.step.newton.factorizations as f64),
        ("smallest_fraction", NUMBER, |r| r.fluid(|fluid| fluid.cut.smallest_fraction)),
        ("dofs", NUMBER, |r| r.step.n_dofs as f64),
        ("seconds_cut", SECONDS, |r| microseconds(r.step.seconds.cut)),
        ("seconds_space", SECONDS, |r| microseconds(r.step.seconds.space)),
        ("seconds_assembly", SECONDS, |r| microseconds(r.step.seconds.assembly)),
        ("seconds_linear", SECONDS, |r| microseconds(r.step.seconds.linear)),
        ("seconds_output", SECONDS, |r| microseconds(r.seconds_output)),
    ];
    columns.iter().map(of_run).collect()
}

/// Returns the columns of the bodies in `diagnostics.csv`: volumes and balances.
fn diagnostics_of_bodies<const D: usize>() -> Vec<BodyColumn<D>> {
    let columns: &[(&str, UnitOf, BodyNumber<D>)] = &[
        ("volume", VOLUME, |b| b.volume()),
        ("force_inertia", FORCE, |b| vertical(b, |f| f.inertia[D - 1])),
        ("force_gravity", FORCE, |b| vertical(b, |f| f.body_force[D - 1])),
        ("force_pressure", FORCE, |b| vertical(b, |f| f.pressure[D - 1])),
        ("force_viscous", FORCE, |b| vertical(b, |f| f.viscous[D - 1])),
        ("force_penalty", FORCE, |b| vertical(b, |f| f.penalty[D - 1])),
        ("force_exchange", FORCE, |b| vertical(b, |f| f.exchange[D - 1])),
        ("force_contact", FORCE, |b| vertical(b, |f| f.contact[D - 1])),
        ("force_remainder", FORCE, |b| vertical(b, |f| f.remainder()[D - 1])),
        ("fluid_power", POWER, |b| b.fluid_power()),
        ("smallest_volume_ratio", NUMBER, |b| b.body().balance.as_ref().map_or(1.0, |e| e.smallest_volume_ratio)),
    ];
    columns.iter().map(boxed).collect()
}

/// Returns the columns of the run in `diagnostics.csv`: volume, energy and the lines of the ledger. A line is the
/// energy that a part of the discrete problem takes in the step.
fn diagnostics_of_run<const D: usize>() -> Vec<RunColumn<D>> {
    let columns: &[(&str, UnitOf, RunNumber<D>)] = &[
        ("fluid_volume", VOLUME, |r| r.fluid(|fluid| fluid.volume)),
        ("total_energy", ENERGY, |r| r.step.total_energy()),
    ];
    let ledger = Ledger::default().lines().into_iter().enumerate();
    let line = |(k, (name, _)): (usize, (&str, f64))| -> RunColumn<D> {
        (format!("lost_{name}"), ENERGY, Box::new(move |r| r.step.ledger.lines()[k].1))
    };
    let defect: RunColumn<D> = ("lost_defect".to_owned(), ENERGY, Box::new(|r| r.step.ledger.defect()));
    columns.iter().map(of_run).chain(ledger.map(line)).chain([defect]).collect()
}

fn of_run<const D: usize>((name, unit, of): &(&str, UnitOf, RunNumber<D>)) -> RunColumn<D> {
    ((*name).to_owned(), *unit, Box::new(*of))
}

fn boxed<const D: usize>((name, unit, of): &(&str, UnitOf, BodyNumber<D>)) -> BodyColumn<D> {
    ((*name).to_owned(), *unit, Box::new(*of))
}

/// Returns a vertical force on a body; NaN if its motion is prescribed.
fn vertical<const D: usize>(body: &BodyMeasures<'_, D>, of: fn(&ForceBalance<D>) -> f64) -> f64 {
    body.body().forces.as_ref().map_or(f64::NAN, of)
}

/// Returns a time rounded to a microsecond.
fn microseconds(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// Names of the tables of a run. `probes.csv` is written only if there are probes.
pub const TABLES: [&str; 3] = ["history.csv", "diagnostics.csv", "probes.csv"];

/// Writer of `history.csv`, `diagnostics.csv` and, if there are probes, `probes.csv`.
///
/// A row has the time, the columns of each body, and the columns of the run. With several bodies the columns of a body
/// carry its name as a prefix. Units follow the names: `NAME_d_min [cm]`.
pub(crate) struct History<const D: usize> {
    tables: [(CsvFile, Columns<D>); 2],
    probes: Option<(CsvFile, Vec<Probe<D>>)>,
}

/// Columns of a table.
struct Columns<const D: usize> {
    of_bodies: Vec<BodyColumn<D>>,
    of_run: Vec<RunColumn<D>>,
}

/// Returns the columns of `history.csv` and `diagnostics.csv`.
fn tables<const D: usize>() -> [Columns<D>; 2] {
    [
        Columns { of_bodies: history_of_bodies(), of_run: history_of_run() },
        Columns { of_bodies: diagnostics_of_bodies(), of_run: diagnostics_of_run() },
    ]
}

/// Returns the names of the columns of `history.csv` and `diagnostics.csv` after the time, with units.
pub(crate) fn columns<const D: usize>(setup: &Setup<D>, units: &UnitLabels) -> Vec<String> {
    tables().iter().flat_map(|table: &Columns<D>| table.names(setup, units).into_iter().skip(1)).collect()
}

impl<const D: usize> Columns<D> {
    /// Returns the header.
    fn names(&self, setup: &Setup<D>, units: &UnitLabels) -> Vec<String> {
        let mut names = vec![with_unit("time", &units.time)];
        for body in &setup.bodies {
            let prefix = if setup.bodies.len() == 1 { String::new() } else { format!("{}_", body.name()) };
            names.extend(
                self.of_bodies.iter().map(|(name, unit, _)| with_unit(&format!("{prefix}{name}"), unit(units))),
            );
        }
        names.extend(self.of_run.iter().map(|(name, unit, _)| with_unit(name, unit(units))));
        names
    }
}

impl<const D: usize> History<D> {
    /// Creates the files with their headers, or opens them and cuts them back to the lengths at a checkpoint.
    ///
    /// # Errors
    /// [`Error::Write`]; [`Error::Checkpoint`]: the files are not those that the run wrote.
    pub(crate) fn open(
        directory: &Path,
        setup: &Setup<D>,
        (probes, units): (Vec<Probe<D>>, &UnitLabels),
        lengths: Option<[u64; 3]>,
    ) -> Result<Self, Error> {
        let [history, diagnostics] = tables();
        let open = |k: usize, names: &[String]| {
            CsvFile::open(directory.join(TABLES[k]), names, lengths.map(|lengths| lengths[k]))
        };
        let time = || std::iter::once(with_unit("time", &units.time));
        let names = || time().chain(probes.iter().flat_map(|probe| probe.names.clone()));
        let of_probes = (!probes.is_empty()).then(|| open(2, &names().collect::<Vec<String>>()));
        Ok(Self {
            tables: [
                (open(0, &history.names(setup, units))?, history),
                (open(1, &diagnostics.names(setup, units))?, diagnostics),
            ],
            probes: of_probes.transpose()?.map(|table| (table, probes)),
        })
    }

    /// Checks that no file was removed, replaced or shortened during the run.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub(crate) fn check(&self) -> Result<(), Error> {
        let mut tables = self.tables.iter().map(|(table, _)| table).chain(self.probes.iter().map(|(table, _)| table));
        tables.try_for_each(CsvFile::check)
    }

    /// Waits until the files are on the disk, and returns their lengths, bytes; 0 for probes without probes.
    pub(crate) fn lengths(&self) -> Result<[u64; 3], Error> {
        let [(a, _), (b, _)] = &self.tables;
        Ok([a.length()?, b.length()?, self.probes.as_ref().map_or(Ok(0), |(table, _)| table.length())?])
    }

    /// Writes the rows of a step. `bodies` are the measures of all bodies, `seconds_output` the wall-clock time that
    /// output took.
    pub(crate) fn write(
        &mut self,
        view: &StepView<'_, D>,
        bodies: &[BodyMeasures<'_, D>],
        seconds_output: f64,
    ) -> Result<(), Error> {
        let time = view.state.time;
        if let Some((table, probes)) = &mut self.probes {
            let values = probes.iter().flat_map(|probe| probe.values(view));
            let row: Vec<String> = [time].into_iter().chain(values).map(number).collect();
            table.push(&row)?;
        }
        let Some(step) = view.report else { return Ok(()) };
        let run = RunMeasures { step, seconds_output };
        for (table, columns) in &mut self.tables {
            let of_bodies = bodies.iter().flat_map(|body| columns.of_bodies.iter().map(move |(_, _, of)| of(body)));
            let of_run = columns.of_run.iter().map(|(_, _, of)| of(&run));
            let row: Vec<String> = [time].into_iter().chain(of_bodies).chain(of_run).map(number).collect();
            table.push(&row)?;
        }
        Ok(())
    }
}

/// A CSV file that grows by rows.
struct CsvFile {
    path: PathBuf,
    file: File,
}

impl CsvFile {
    fn open(path: PathBuf, names: &[String], length: Option<u64>) -> Result<Self, Error> {
        let unwritable = |source| Error::Write { path: path.clone(), source };
        let Some(length) = length else {
            let file = File::create(&path).map_err(unwritable)?;
            let mut table = Self { path, file };
            table.push(names)?;
            return Ok(table);
        };
        let mut found = String::new();
        let unreadable = |source| Error::Read { path: path.clone(), source };
        File::open(&path).and_then(|file| BufReader::new(file).read_line(&mut found)).map_err(unreadable)?;
        let found: Vec<&str> = found.trim_end().split(',').collect();
        if found.len() != names.len() || found.iter().zip(names).any(|(found, name)| !is_same(found, name)) {
            return Err(Error::Checkpoint { path, problem: "its columns are not those of this run".to_owned() });
        }
        let mut file = File::options().write(true).open(&path).map_err(unwritable)?;
        if file.metadata().map_err(unwritable)?.len() < length {
            return Err(Error::Checkpoint { path, problem: "it is shorter than at the checkpoint".to_owned() });
        }
        file.set_len(length).and_then(|()| file.seek(SeekFrom::End(0))).map_err(unwritable)?;
        Ok(Self { path, file })
    }

    fn check(&self) -> Result<(), Error> {
        let failed = |source| Error::Write { path: self.path.clone(), source };
        let written = self.file.metadata().map_err(failed)?.len();
        let visible = std::fs::metadata(&self.path).map_err(failed)?.len();
        let lost = || std::io::Error::other("it was replaced or shortened during the run");
        if visible < written { Err(failed(lost())) } else { Ok(()) }
    }

    fn length(&self) -> Result<u64, Error> {
        let synced = self.file.sync_data().and_then(|()| self.file.metadata());
        let metadata = synced.map_err(|source| Error::Write { path: self.path.clone(), source })?;
        Ok(metadata.len())
    }

    fn push(&mut self, row: &[String]) -> Result<(), Error> {
        let line = row.join(",") + "\n";
        self.file.write_all(line.as_bytes()).map_err(|source| Error::Write { path: self.path.clone(), source })
    }
}

fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") }
}

/// Returns a name of a header without its unit, and the unit if the header states it.
pub fn name_and_unit(name: &str) -> (&str, Option<&str>) {
    match name.split_once(" [") {
        Some((name, unit)) => (name, unit.strip_suffix(']')),
        None => (name, None),
    }
}

/// Returns whether two names, with or without units, denote the same column. Tables of earlier versions have no units.
fn is_same(one: &str, other: &str) -> bool {
    let ((one, unit), (other, other_unit)) = (name_and_unit(one), name_and_unit(other));
    one == other && (unit == other_unit || unit.is_none() || other_unit.is_none())
}

/// Returns the text of a table.
pub(crate) fn csv(names: &[String], rows: impl IntoIterator<Item = Vec<f64>>) -> String {
    let rows = rows.into_iter().map(|row| row.into_iter().map(number).collect::<Vec<String>>().join(",") + "\n");
    names.join(",") + "\n" + &rows.collect::<String>()
}

/// Returns the shortest text that reads back as the same number.
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
    /// [`Error::Read`]; [`Error::Damaged`] with the line.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = read_text(path)?;
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines().zip(1..);
        let names: Vec<String> = lines.next().map_or("", |(line, _)| line).split(',').map(str::to_owned).collect();
        let mut rows = Vec::new();
        for (line, number) in lines {
            let damaged = |problem| Error::Damaged { place: format!("{}:{number}", path.display()), problem };
            let values = |value: &str| match value.parse() {
                Ok(value) => Ok(value),
                Err(_) if value.is_empty() => Ok(f64::NAN),
                Err(_) => Err(damaged(format!("`{value}` is not a number"))),
            };
            let row = line.split(',').map(values).collect::<Result<Vec<f64>, _>>()?;
            if row.len() != names.len() {
                let (found, all) = (row.len(), names.len());
                return Err(damaged(format!("this row has {found} values, but the header names {all} columns")));
            }
            rows.push(row);
        }
        Ok(Self { names, rows })
    }

    /// Returns the names of the columns, with their units where the table states them.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the names of the columns without units.
    pub fn bare_names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(|name| name_and_unit(name).0)
    }

    /// Returns the number of rows.
    pub fn n_rows(&self) -> usize {
        self.rows.len()
    }

    /// Returns the values of a column, or `None` if the table has no column of this name. The unit may be left out. A
    /// column with another unit is not returned.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.names.iter().position(|found| is_same(found, name))?;
        Some(self.rows.iter().map(|row| row[index]).collect())
    }

    /// Returns a name in the header, with the unit if the table states it; `None` if there is no such column.
    pub(crate) fn heading(&self, name: &str) -> Option<&str> {
        self.names.iter().map(String::as_str).find(|found| is_same(found, name))
    }
}

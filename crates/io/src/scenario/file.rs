//! Top level of a scenario, and the scenario file.

use std::path::{Path, PathBuf};

use mesh::Coordinates;
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeValue, ValueDeserializer};

use super::background::Background;
use super::body::BodyKeys;
use super::contact::{ALL, ContactKeys, ContactLawChoice};
use super::error::{ErrorKind, Location, ScenarioError};
use super::fluid::{Fluid, Interface};
use super::motion::MotionChoice;
use super::overrides;
use super::probe::ProbeChoice;
use super::solver::{LinearSolverChoice, Solver, Time, TimeSchemeChoice};
use super::table::{At, Choose as _, Document, KeyValue, Named, Node, OrTable, choices, keys, parse};
use super::units::Units;
use crate::Error;
use crate::files::{extension, read, read_scenario, write_whole};

keys! {
    /// A scenario.
    pub struct Scenario {
        /// Name of the results: letters, digits, `-`, `_` and dots inside.
        name: At<String>,
        /// Source of the case, for reports.
        source: Option<At<String>>,
        /// Dimension of space.
        dimension: usize [between(2.0, 3.0)],
        /// Coordinates of meshes and vectors; Cartesian if left out.
        coordinates: Option<At<CoordinatesChoice>>,
        /// Units of all numbers: a system, or the names of three units.
        units: Units,
        /// Time steps.
        time: Time,
        /// The fluid.
        fluid: Option<Fluid>,
        /// Background mesh with the conditions on its boundary.
        background: Option<At<Background>>,
        /// Bodies.
        body: Vec<At<BodyKeys>>,
        /// Mortar between fluid and bodies.
        interface: Interface = {},
        /// Contacts, a table `[contact]` or several `[[contact]]`; bodies without a contact between them pass through
        /// each other.
        contact: Vec<At<ContactKeys>>,
        /// Output.
        output: Output = {},
        /// Solution of the equations.
        solver: Solver = {},
    }
}

choices! {
    /// Coordinates of a scenario.
    #[derive(Copy, Eq)]
    pub enum CoordinatesChoice {
        /// Cartesian coordinates; two dimensions are a plane problem, per unit depth.
        Cartesian = "cartesian",
        /// Radius and height `(r, z)` of a problem with rotational symmetry and without swirl, as `x` and `y` with
        /// `x >= 0`. Masses, forces and energies are those of the whole body.
        Axisymmetric = "axisymmetric",
    }
}

keys! {
    /// Output of a run.
    pub struct Output {
        /// Directory of the results, if the command line names none; `results/NAME` if left out.
        directory: Option<At<String>>,
        /// Steps between two sets of field files; 0 for none.
        vtk_every: usize = 10,
        /// Fields in the field files; all if left out. A series without any of them is not written. Numbers of bodies,
        /// facets and parts of the fluid are always written.
        fields: Vec<FieldChoice>,
        /// Level of compression of field files, 0 for none.
        compression: u32 [between(0.0, 9.0)] = 0,
        /// Steps between two checkpoints, from which a run that was stopped can be resumed, with the same bits at the end; 0 for none.
        checkpoint_every: usize = 0,
        /// Quantities of points, bodies and sections by name: columns of `probes.csv`.
        probes: Named<ProbeChoice>,
        /// Smallest wall-clock time between two checkpoints, minutes. After this time the next multiple of
        /// `checkpoint_every` steps (10 if left out) writes one.
        checkpoint_minutes: Option<f64> [non_negative],
    }
}

choices! {
    /// Field of the field files, by its name there.
    #[derive(Copy, Eq)]
    pub enum FieldChoice {
        /// Velocity of the fluid and of vertices of bodies.
        Velocity = "velocity",
        /// Pressure of the fluid; in bodies minus a third of the trace of the stress.
        Pressure = "pressure",
        /// Curl of the velocity of the fluid.
        Vorticity = "vorticity",
        /// Displacement of vertices of bodies.
        Displacement = "displacement",
        /// Cauchy stress of elastic bodies.
        CauchyStress = "cauchy_stress",
        /// Von Mises stress of elastic bodies.
        VonMises = "von_mises",
        /// Principal stresses of elastic bodies, the largest tension first; in 2D with that normal to the plane.
        PrincipalStress = "principal_stress",
        /// Traction of the fluid on bodies, with the penalty of the mortar: the traction of the equations.
        Traction = "traction",
        /// The same without the penalty, on pieces of the interface.
        FluidTraction = "fluid_traction",
        /// Velocity of the fluid minus that of the body, on pieces of the interface.
        VelocityJump = "velocity_jump",
        /// Normal out of the body, on pieces of the interface.
        Normal = "normal",
        /// Mean contact pressure on facets of bodies.
        ContactPressure = "contact_pressure",
    }
}

/// Number of steps between two steps at which `checkpoint_minutes` alone may write a checkpoint. The frames of the page
/// are written at all of these steps.
const STEPS_WITH_MINUTES: usize = 10;

impl Output {
    /// Returns the number of steps between two steps that may end with a checkpoint; 0 without checkpoints.
    pub(crate) fn checkpoint_interval(&self) -> usize {
        match self.checkpoint_every {
            0 if self.checkpoint_minutes.is_some() => STEPS_WITH_MINUTES,
            every => every,
        }
    }

    /// Returns whether a field is written, by its name.
    pub(crate) fn has_field(&self, name: &str) -> bool {
        self.fields.is_empty() || self.fields.iter().any(|field| field.word() == name)
    }
}

impl Scenario {
    /// Returns the coordinates.
    ///
    /// # Errors
    /// Axisymmetric coordinates in three dimensions.
    pub(super) fn coordinates(&self) -> Result<Coordinates, ScenarioError> {
        match &self.coordinates {
            Some(choice) if self.is_axisymmetric() => {
                if self.dimension != 2 {
                    return Err(choice.at.invalid(
                        "axisymmetric coordinates describe a body in space by a half plane, so they need dimension = 2",
                    ));
                }
                Ok(Coordinates::Axisymmetric)
            }
            _ => Ok(Coordinates::Cartesian),
        }
    }

    pub(crate) fn is_axisymmetric(&self) -> bool {
        self.coordinates.as_ref().is_some_and(|choice| **choice == CoordinatesChoice::Axisymmetric)
    }

    /// Returns the dimension of the domain of masses, forces, energies, volumes and flows of results: three in
    /// axisymmetric coordinates; two in 2D, where they are per unit depth.
    pub(crate) fn dimension_of_whole(&self) -> usize {
        if self.is_axisymmetric() { 3 } else { self.dimension }
    }

    /// Returns the bodies, each followed by its copies.
    pub(crate) fn bodies(&self) -> Vec<At<BodyKeys>> {
        self.body.iter().flat_map(At::with_copies).collect()
    }
}

/// A scenario that was read from a file.
#[derive(Clone, Debug)]
pub struct ScenarioFile {
    path: PathBuf,
    scenario: Scenario,
    /// The file with the changes applied.
    table: toml::Value,
}

impl ScenarioFile {
    /// Reads a scenario file and applies changes `KEY=VALUE`, such as `time.step=5e-4` or `body.0.density=2`.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::NotUtf8`], or [`Error::Scenario`] with file, line and key.
    pub fn read(path: &Path, sets: &[String]) -> Result<Self, Error> {
        if ["msh", "stl", "obj", "vtu", "vtk"].contains(&extension(path).as_str()) && path.is_file() {
            let at = Location { file: path.to_owned(), line: 1, ..Location::default() };
            let message = "this is a mesh or surface, not a scenario; name it as the `file` of a shape, or look into it with `cutwater mesh info`";
            return Err(at.invalid(message).into());
        }
        Self::parse(path, &read_scenario(path)?, sets)
    }

    /// Reads a scenario from text; `path` names it in errors.
    ///
    /// # Errors
    /// [`Error::Scenario`].
    pub fn parse(path: &Path, text: &str, sets: &[String]) -> Result<Self, Error> {
        let (file, text, arguments) = (path.to_owned(), text.to_owned(), Vec::new());
        let mut document = Document { file, text, arguments, dimension: 0 };
        let changes = overrides::read(&mut document, sets)?;
        let mut root = Spanned::new(0..0, DeValue::Table(parse(&document, &document.text)?));
        overrides::apply(&changes, &document, &mut root)?;
        let node = Node::root(&document, root.get_ref());
        document.dimension = node.table(Scenario::KEYS, None)?.get("dimension")?;
        let scenario = Scenario::read(&Node::root(&document, root.get_ref()))?;
        check(&scenario)?;
        let syntax = |error: toml::de::Error| document.locate(0, "").error(ErrorKind::Syntax(error.to_string()));
        let table = toml::Value::deserialize(ValueDeserializer::from(root)).map_err(syntax)?;
        Ok(Self { path: path.to_owned(), scenario, table })
    }

    /// Returns the scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Returns the scenario as a table in which the names of files are replaced. `name` returns the new name from the
    /// key of the table with the name, and the path.
    ///
    /// # Errors
    /// The first error of `name`.
    pub(crate) fn with_inputs(
        &self,
        mut name: impl FnMut(&str, &Path) -> Result<String, Error>,
    ) -> Result<toml::Value, Error> {
        let mut table = self.table.clone();
        let directory = self.path.parent().unwrap_or(Path::new(""));
        replace_inputs(&mut table, "", &mut |key, file| name(key, &directory.join(file)))?;
        Ok(table)
    }

    /// Returns the path of the file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn location(&self) -> Location {
        Location { file: self.path.clone(), line: 1, ..Location::default() }
    }

    /// Returns the scenario as text, with the changes applied.
    ///
    /// # Errors
    /// [`Error::Text`]: it cannot be written as TOML.
    pub fn to_toml(&self) -> Result<String, Error> {
        Ok(toml::to_string(&self.table)?)
    }

    /// Returns the number of steps.
    pub fn n_steps(&self) -> usize {
        self.scenario.time.n_steps()
    }

    /// Writes `scenario.toml` with copies of the files that it names, so that it can be run from the directory.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Write`], [`Error::Text`].
    pub(crate) fn write(&self, directory: &Path) -> Result<(), Error> {
        let table = self.with_inputs(|key, path| {
            let name = format!("{key}.{}", extension(path));
            write_whole(&directory.join(&name), &read(path)?)?;
            Ok(name)
        })?;
        write_whole(&directory.join("scenario.toml"), toml::to_string(&table)?.as_bytes())
    }
}

/// Replaces the values of all keys `file` of tables that have a key `kind`. Keys of tables are joined by `-`.
fn replace_inputs(
    value: &mut toml::Value,
    key: &str,
    name: &mut impl FnMut(&str, &str) -> Result<String, Error>,
) -> Result<(), Error> {
    let below = |part: &str| if key.is_empty() { part.to_owned() } else { format!("{key}-{part}") };
    match value {
        toml::Value::Table(table) => {
            // A part of a boundary may be named `file`, too.
            let has_kind = table.contains_key("kind");
            for (part, value) in table.iter_mut() {
                match value {
                    toml::Value::String(file) if has_kind && part == "file" => *file = name(key, file)?,
                    _ => replace_inputs(value, &below(part), name)?,
                }
            }
            Ok(())
        }
        toml::Value::Array(items) => {
            items.iter_mut().enumerate().try_for_each(|(k, item)| replace_inputs(item, &below(&k.to_string()), name))
        }
        _ => Ok(()),
    }
}

/// Returns whether a text may be the name of results: letters, digits, `-`, `_`, and dots inside.
pub fn is_name(text: &str) -> bool {
    is_plain(text) && !text.starts_with('.')
}

fn is_plain(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || "-_.".contains(c))
}

/// Checks that all keys that are given have an effect together.
fn check_effects(scenario: &Scenario, bodies: &[At<BodyKeys>]) -> Result<(), ScenarioError> {
    let alpha = &scenario.interface.alpha;
    if scenario.fluid.is_none() && **alpha != 1.0 {
        return Err(alpha.at.error(ErrorKind::NoEffect("a scenario without a fluid")));
    }
    if let Some(approach) = scenario.time.approach.as_ref().filter(|_| scenario.contact.is_empty()) {
        return Err(approach.smallest.at.error(ErrorKind::NoEffect("a scenario without contacts")));
    }
    let film = scenario.fluid.as_ref().and_then(|fluid| fluid.film.as_ref());
    if let Some(film) = film.filter(|_| scenario.body.is_empty()) {
        return Err(film.at.error(ErrorKind::NoEffect("a scenario without bodies")));
    }
    if *scenario.time.scheme != TimeSchemeChoice::QuasiStatic {
        return Ok(());
    }
    let of_body = |body: &At<BodyKeys>| {
        let spin = match body.motion.as_deref() {
            Some(MotionChoice::Free { initial_spin, .. }) => initial_spin.as_ref().map(|spin| spin.at.clone()),
            _ => None,
        };
        let velocity = body.initial_velocity.as_ref().map(|velocity| velocity.at.clone());
        velocity.or(spin).or(body.contact_mass.as_ref().map(|mass| mass.at.clone()))
    };
    let stabilisation = scenario.fluid.as_ref().map(|fluid| &fluid.stabilisation);
    let of_fluid = stabilisation.and_then(|stabilisation| match &**stabilisation {
        OrTable::Table(table) => table.time.map(|_| stabilisation.at.part("time")),
        OrTable::Plain(_) => None,
    });
    let collides = |contact: &&At<ContactKeys>| matches!(contact.law, ContactLawChoice::Collision { .. });
    if let Some(contact) = scenario.contact.iter().find(collides) {
        let message = "a collision reverses velocities, which have no inertia in quasi-static steps; use another law, or another scheme";
        return Err(contact.at.part("law").invalid(message));
    }
    let found = bodies.iter().find_map(of_body).or(of_fluid);
    found.map_or(Ok(()), |place| Err(place.error(ErrorKind::NoEffect("quasi-static steps, which have no inertia"))))
}

/// Checks combinations of values.
fn check(scenario: &Scenario) -> Result<(), ScenarioError> {
    scenario.time.check()?;
    scenario.units.check()?;
    scenario.fluid.as_ref().map_or(Ok(()), |fluid| fluid.check(&scenario.units, scenario.dimension))?;
    let refuse = |name: &At<String>, why| Err(name.at.invalid(format!("the name `{}` is {why}", name.as_str())));
    if !is_name(&scenario.name) {
        return refuse(&scenario.name, "not a file name: use letters, digits, -, _ and dots inside");
    }
    if let Some(directory) = scenario.output.directory.as_ref().filter(|directory| directory.trim().is_empty()) {
        return Err(directory.at.invalid("the name of the directory is empty; give one, or leave the key out"));
    }
    for text in [&scenario.source, &scenario.output.directory].into_iter().flatten() {
        if text.contains(char::is_control) {
            return Err(text.at.invalid("it has a character that cannot be printed; take it out"));
        }
    }
    for (name, probe) in &scenario.output.probes.0 {
        if !is_plain(name) {
            return refuse(&probe.map(|_| name.clone()), "not a column name: use letters, digits, -, _ and dots");
        }
    }
    let bodies = scenario.bodies();
    for (k, body) in bodies.iter().enumerate() {
        if !is_plain(&body.name) {
            return refuse(&body.name, "not a column name: use letters, digits, -, _ and dots");
        }
        if **body.name == *ALL {
            return refuse(&body.name, "the word for every body in a contact; give it another");
        }
        if bodies[..k].iter().any(|other| other.name == body.name) {
            return refuse(&body.name, "the name of another body; give each its own");
        }
        body.check()?;
    }
    check_effects(scenario, &bodies)?;
    scenario.solver.linear.as_ref().map_or(Ok(()), LinearSolverChoice::check)
}

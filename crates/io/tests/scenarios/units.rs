//! A scenario in other units has the same results in these units.

use crate::setting::*;
use io::ScenarioFile;
use io::scenario::key::{Choice, Form, Key};
use io::scenario::{Quantity, Scenario};
use toml::Value;

/// Returns the factor from SI to cgs of a quantity.
fn factor(quantity: Quantity) -> f64 {
    100.0_f64.powi(quantity.length.into()) * 1000.0_f64.powi(quantity.mass.into())
}

/// Factor of the number of a quantity.
type Factor = fn(Quantity) -> f64;

/// Converts the numbers of a table whose keys are declared.
fn convert_table(table: &mut toml::Table, keys: &[Key], by: Factor) {
    for (name, value) in table {
        if let Some(key) = keys.iter().find(|key| key.name == name) {
            convert(value, &key.form, by(key.quantity), by);
        }
    }
}

/// Returns a scenario with the numbers in other units.
fn converted(file: &ScenarioFile, units: &str, by: Factor) -> ScenarioFile {
    let mut table: toml::Table = file.to_toml().expect("text").parse().expect("a table");
    convert_table(&mut table, Scenario::KEYS, by);
    table.insert("units".to_owned(), Value::String(units.to_owned()));
    legal(&toml::to_string(&table).expect("text"), &[])
}

fn chosen<'k>(value: &Value, tag: Option<&str>, choices: &'k [Choice]) -> &'k [Key] {
    let word = tag.and_then(|tag| value.get(tag)?.as_str());
    choices.iter().find(|choice| Some(choice.word) == word).map_or(&[], |choice| choice.keys)
}

/// Multiplies the numbers of a value by a factor; those in tables have their own.
fn convert(value: &mut Value, form: &Form, factor: f64, by: Factor) {
    match (form, value) {
        (Form::Table(keys), Value::Table(table)) => convert_table(table, keys, by),
        (Form::Choice { tag, choices }, value @ Value::Table(_)) => {
            let keys = chosen(value, *tag, choices);
            value.as_table_mut().into_iter().for_each(|table| convert_table(table, keys, by));
        }
        (Form::Named(of), Value::Table(table)) => {
            table.iter_mut().for_each(|(_, value)| convert(value, of, factor, by))
        }
        (Form::OrTable(_, of) | Form::List(of), value @ Value::Table(_)) => convert(value, of, factor, by),
        (Form::List(of) | Form::Components(of), Value::Array(items)) => {
            items.iter_mut().for_each(|item| convert(item, of, factor, by));
        }
        (_, Value::Array(items)) => items.iter_mut().for_each(|item| convert(item, form, factor, by)),
        (_, Value::Float(number)) => *number *= factor,
        (_, value @ Value::Integer(_)) if factor != 1.0 => {
            *value = Value::Float(value.as_integer().map_or(f64::NAN, |number| number as f64 * factor));
        }
        _ => {}
    }
}

/// Returns the factor from SI to cgs of a column of a history. In 2D, forces, energies and flows are per unit depth.
fn factor_of(column: &str, dimension: i32) -> f64 {
    let depth = factor(Quantity::LENGTH).powi(3 - dimension);
    let quantities = [
        ("energy", factor(Quantity::ENERGY) / depth),
        ("power", factor(Quantity::POWER) / depth),
        ("force", factor(Quantity::FORCE) / depth),
        ("torque", factor(Quantity::ENERGY) / depth),
        ("leak", factor(Quantity::LENGTH).powi(dimension)),
        ("acceleration", factor(Quantity::ACCELERATION)),
        ("angular", factor(Quantity::RATE)),
        ("velocity", factor(Quantity::VELOCITY)),
        ("centre", factor(Quantity::LENGTH)),
        ("d_m", factor(Quantity::LENGTH)),
        ("height", factor(Quantity::LENGTH)),
        ("penetration", factor(Quantity::LENGTH)),
    ];
    quantities.iter().find(|(word, _)| column.contains(word)).map_or(1.0, |(_, factor)| *factor)
}

/// Compares the histories of a scenario in SI and in cgs, with the largest difference relative to the largest value of
/// each column. `smallest` is the value in SI below which a column vanishes by symmetry, but for round-off.
fn assert_same([si, cgs]: [&ScenarioFile; 2], name: &str, smallest: fn(&str) -> f64) {
    let histories = [(si, "si"), (cgs, "cgs")].map(|(file, units)| {
        let directory = fresh_directory(&format!("{name}-{units}"));
        results(file, &directory);
        history(&directory)
    });
    let dimension = si.scenario().dimension as i32;
    let [si, cgs] = &histories;
    assert!(si.bare_names().eq(cgs.bare_names()) && si.names() != cgs.names());
    assert!(si.column("active_points").is_some_and(|n| n.first() == Some(&0.0) && n.iter().any(|n| *n > 0.0)));
    let mut missed = Vec::new();
    // In the first step the number of corrections depends on the units, as the start has no pressure to which residuals
    // are relative.
    let is_work = |name: &str| name.starts_with("seconds") || name == "newton" || name == "factorizations";
    for name in si.bare_names().filter(|name| !is_work(name)) {
        let [si, cgs] = [si, cgs].map(|table| table.column(name).expect("a column"));
        let largest = si.iter().map(|value| value.abs()).fold(f64::MIN_POSITIVE, f64::max);
        let factor = factor_of(name, dimension);
        let worst = si.iter().zip(&cgs).map(|(si, cgs)| (si - cgs / factor).abs()).fold(0.0, f64::max);
        if worst > 1e-10 * largest.max(smallest(name)) {
            missed.push(format!("{name}: {worst:e} of {largest:e}"));
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// An elastic cube that sinks in a closed box and meets a plane.
#[test]
fn a_cube_that_meets_a_plane_is_the_same_in_cgs() {
    let elastic = "material = { kind = \"neo-hookean\", young = 1.0e3, poisson = 0.3 }";
    let sets = [
        "time.end=0.12",
        "background.size=0.3",
        "contact.0.offset=0.0795",
        "output.vtk_every=0",
        "solver.newton={ tolerance = 1.0e-12, max_iterations = 30 }",
    ];
    let si = legal(&(CUBE.replace(FREE_CUBE, elastic) + FLOOR), &[&sets]);
    assert_same([&si, &converted(&si, "cgs", factor)], "cube", |column| {
        let vanishing = ["force", "torque", "leak", "angle", "angular", "centre_velocity"];
        if vanishing.iter().any(|word| column.contains(word)) { 1.0 } else { 0.0 }
    });
}

/// The first case of the paper with coarse cells, from just above the barrier.
#[test]
fn the_virtual_barrier_is_the_same_in_si() {
    let sets = [
        "background.size={ coarse = 1.5, fine = 0.6, fine_until = 4.5, coarse_from = 10.0, axis = \"y\" }",
        "body.0.shape.size=0.8",
        "body.0.shape.centre=[0.0, 7.02]",
        "body.0.initial_velocity=[0.0, -20.0]",
        "time.end=0.02",
        "output.vtk_every=0",
        "solver.newton.tolerance=1e-12",
        "solver.linear=direct",
    ];
    // The viscosity of the paper's interior penalty is that of a length times a velocity: in the plane its parameter is
    // 0.7 cm.
    let parameter = |gamma_1: f64| {
        format!(
            "fluid.stabilisation={{ set = \"paper-44-2019\", cip = {{ profile = \"paper\", gamma_1 = {gamma_1} }} }}"
        )
    };
    let cgs = legal(BARRIER, &[&sets, &[&*parameter(0.7)]]);
    let si = converted(&cgs, "si", |quantity| 1.0 / factor(quantity));
    let si = legal(&si.to_toml().expect("text"), &[&[&*parameter(0.007)]]);
    assert_same([&si, &cgs], "barrier", |_| 0.0);
}

//! A scenario in other units has the same results in these units.

use crate::setting::*;
use io::scenario::key::{Choice, Form, Key};
use io::scenario::{Quantity, Scenario};
use toml::Value;

/// An elastic cube that sinks in a closed box and meets a plane.
const CASE: &str = r#"
name      = "cube"
dimension = 3
units     = "si"

[time]
step = 0.02
end  = 0.12

[fluid]
density    = 1.0
viscosity  = 0.1
body_force = [0.0, 0.0, -10.0]

[background]
kind     = "graded-box"
min      = [0.0, 0.0, 0.0]
max      = [1.0, 1.0, 1.0]
size     = 0.3
boundary = { left = "no-slip", right = "no-slip", front = "no-slip", back = "no-slip", bottom = "no-slip", top = "no-slip" }

[[body]]
name     = "cube"
shape    = { kind = "box", min = [0.31, 0.32, 0.53], max = [0.71, 0.72, 0.93], n = [2, 2, 2] }
material = { kind = "neo-hookean", young = 1.0e3, poisson = 0.3 }
density  = 1.5
gravity  = [0.0, 0.0, -10.0]

[contact]
body     = "cube"
law      = { kind = "penalty", gamma_contact_0 = 100.0 }
size     = 0.1
offset   = 0.0795
obstacle = { kind = "rigid-plane", point = [0.0, 0.0, 0.45], normal = [0.0, 0.0, -1.0] }

[output]
vtk_every = 0

[solver]
newton = { tolerance = 1.0e-12, max_iterations = 30 }
linear = "direct"
"#;

/// Returns the factor from SI to cgs of a quantity.
fn factor(quantity: Quantity) -> f64 {
    100.0_f64.powi(quantity.length.into()) * 1000.0_f64.powi(quantity.mass.into())
}

/// Converts the numbers of a table whose keys are declared.
fn convert_table(table: &mut toml::Table, keys: &[Key]) {
    for (name, value) in table {
        if let Some(key) = keys.iter().find(|key| key.name == name) {
            convert(value, &key.form, factor(key.quantity));
        }
    }
}

fn chosen<'k>(value: &Value, tag: Option<&str>, choices: &'k [Choice]) -> &'k [Key] {
    let word = tag.and_then(|tag| value.get(tag)?.as_str());
    choices.iter().find(|choice| Some(choice.word) == word).map_or(&[], |choice| choice.keys)
}

/// Multiplies the numbers of a value by a factor; those in tables have their own.
fn convert(value: &mut Value, form: &Form, factor: f64) {
    match (form, value) {
        (Form::Table(keys), Value::Table(table)) => convert_table(table, keys),
        (Form::Choice { tag, choices }, value @ Value::Table(_)) => {
            let keys = chosen(value, *tag, choices);
            value.as_table_mut().into_iter().for_each(|table| convert_table(table, keys));
        }
        (Form::Named(of), Value::Table(table)) => table.iter_mut().for_each(|(_, value)| convert(value, of, factor)),
        (Form::OrTable(_, of) | Form::List(of), value @ Value::Table(_)) => convert(value, of, factor),
        (Form::List(of) | Form::Components(of), Value::Array(items)) => {
            items.iter_mut().for_each(|item| convert(item, of, factor));
        }
        (_, Value::Array(items)) => items.iter_mut().for_each(|item| convert(item, form, factor)),
        (_, Value::Float(number)) => *number *= factor,
        (_, Value::Integer(number)) if factor != 1.0 => panic!("a whole number {number} with a unit"),
        _ => {}
    }
}

/// Returns the factor from SI to cgs of a column of a history.
fn factor_of(column: &str) -> f64 {
    let quantities = [
        ("energy", Quantity::ENERGY),
        ("power", Quantity::POWER),
        ("force", Quantity::FORCE),
        ("torque", Quantity::ENERGY),
        ("acceleration", Quantity::ACCELERATION),
        ("angular", Quantity::RATE),
        ("velocity", Quantity::VELOCITY),
        ("centre", Quantity::LENGTH),
        ("d_m", Quantity::LENGTH),
        ("height", Quantity::LENGTH),
        ("penetration", Quantity::LENGTH),
    ];
    if column.contains("leak") {
        return factor(Quantity::LENGTH).powi(3);
    }
    quantities.iter().find(|(word, _)| column.contains(word)).map_or(1.0, |(_, quantity)| factor(*quantity))
}

#[test]
fn a_cube_that_meets_a_plane_is_the_same_in_cgs() {
    let si = legal(CASE, &[]);
    let mut table: toml::Table = si.to_toml().expect("text").parse().expect("a table");
    convert_table(&mut table, Scenario::KEYS);
    table.insert("units".to_owned(), Value::String("cgs".to_owned()));
    let cgs = legal(&toml::to_string(&table).expect("text"), &[]);
    let histories = [(&si, "si"), (&cgs, "cgs")].map(|(file, name)| {
        let directory = fresh_directory(name);
        results(file, &directory);
        history(&directory)
    });
    let [si, cgs] = &histories;
    assert_eq!(si.names(), cgs.names());
    assert!(si.column("active_points").is_some_and(|n| n.first() == Some(&0.0) && n.iter().any(|n| *n > 0.0)));
    for name in si.names().iter().filter(|name| !name.starts_with("seconds")) {
        let [si, cgs] = [si, cgs].map(|table| table.column(name).expect("a column"));
        let largest = si.iter().map(|value| value.abs()).fold(f64::MIN_POSITIVE, f64::max);
        let factor = factor_of(name);
        let worst = si.iter().zip(&cgs).map(|(si, cgs)| (si - cgs / factor).abs()).fold(0.0, f64::max);
        assert!(worst <= 1e-10 * largest.max(smallest(name)), "{name}: {worst:e} of {largest:e}");
    }
}

/// Returns the size below which the values of a column are round-off: those that vanish by symmetry.
fn smallest(column: &str) -> f64 {
    let vanishing = ["force", "torque", "leak", "angle", "angular", "centre_velocity"];
    if vanishing.iter().any(|word| column.contains(word)) { 1.0 } else { 0.0 }
}

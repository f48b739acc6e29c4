//! Weights, buoyancies and warnings of a scenario.

use crate::setting::*;

/// An elastic disk and a free one in water, over the bottom of a box that is open at the top.
const DISKS: &str = r#"
name      = "disks"
dimension = 2
units     = "si"

[time]
step = 1.0e-3
end  = 0.05

[fluid]
density    = 1000.0
viscosity  = 1.0
body_force = [0.0, -10000.0]

[background]
kind = "graded-box"
min  = [0.0, 0.0]
max  = [1.0, 1.0]
size = 0.05

[background.boundary]
left   = "no-slip"
right  = "no-slip"
bottom = "no-slip"
top    = "free"

[[body]]
name     = "soft"
shape    = { kind = "ball", centre = [0.3, 0.5], radius = 0.1, size = 0.05, area_preserving = true }
material = { kind = "neo-hookean", mu = 4.0e5, lambda = 1.6e6 }
density  = 1500.0
gravity  = [0.0, -10.0]

[[body]]
name    = "stone"
shape   = { kind = "ball", centre = [0.7, 0.5], radius = 0.1, size = 0.05, area_preserving = true }
motion  = { kind = "free" }
density = 2500.0
gravity = [0.0, -10.0]
"#;
const CONTACT: &str = r#"
[contact]
body     = "stone"
obstacle = { kind = "wall", parts = ["bottom"] }
law      = { kind = "penalty", gamma_contact_0 = 1.0e5 }
size     = 0.02
offset   = 0.005
"#;

/// Returns the lines about a scenario with changes.
fn lines(text: &str, changes: &[&str]) -> Vec<String> {
    io::sizes(&legal(text, &[changes])).expect("sizes").lines
}

/// Returns the only warning.
fn warning(text: &str, changes: &[&str]) -> String {
    let lines = lines(text, changes);
    let warnings: Vec<_> = lines.iter().filter(|line| line.starts_with("warning")).collect();
    assert_eq!(warnings.len(), 1, "{lines:#?}");
    warnings[0].clone()
}

#[test]
fn weights_and_buoyancies_are_those_of_disks() {
    let lines = lines(DISKS, &[]);
    // π R² times density and gravity, to four digits.
    for line in [
        "body soft: mass 4.712e1 kg/m, weight [0.0, -471.2] N/m, buoyancy [0.0, 314.2] N/m",
        "body stone: mass 7.854e1 kg/m, weight [0.0, -785.4] N/m, buoyancy [0.0, 314.2] N/m",
    ] {
        assert!(lines.iter().any(|found| found == line), "{line}: {lines:#?}");
    }
    assert!(!lines.iter().any(|line| line.starts_with("warning")), "{lines:#?}");
}

#[test]
fn a_body_force_given_as_an_acceleration_is_a_warning() {
    let changes = ["fluid.body_force=[0.0, -10.0]", "body.0.gravity=[0.0, -0.01]"];
    let found = warning(DISKS, &changes);
    for words in ["`fluid.body_force` is [0.0, -10.0] at body stone", "[0.0, -10000.0]", "force per volume"] {
        assert!(found.contains(words), "{words}: {found}");
    }
}

#[test]
fn elastic_bodies_with_implicit_euler_are_a_warning() {
    assert!(warning(DISKS, &["time.scheme=implicit-euler"]).contains("changes its area"));
    let rigid = DISKS.replace("material = { kind = \"neo-hookean\", mu = 4.0e5, lambda = 1.6e6 }", "motion = \"free\"");
    assert!(!lines(&rigid, &["time.scheme=implicit-euler"]).iter().any(|line| line.starts_with("warning")));
}

#[test]
fn contacts_that_do_not_carry_a_weight_in_fluid_are_warnings() {
    let text = format!("{DISKS}{CONTACT}");
    assert!(warning(&text, &["contact.offset=0"]).contains("contact of stone has the offset 0 in a fluid without"));
    let film = |offset| warning(&text, &["fluid.film.roughness=0.01", offset]);
    assert!(film("contact.offset=0.005").contains("offset 0.005 m below the roughness 0.01 m"));
    assert!(!lines(&text, &["fluid.film.roughness=0.005"]).iter().any(|line| line.starts_with("warning")));
}

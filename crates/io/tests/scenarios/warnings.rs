//! Weights, buoyancies and warnings of a scenario.

use std::collections::HashMap;
use std::path::PathBuf;

use crate::setting::*;
use io::gmsh::{GmshFormat, GmshVersion, write};
use io::sizes;
use mesh::generate::structured_box;
use mesh::{SimplexMesh, VertexId};

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
    let weight = lines.iter().find(|line| line.starts_with("body soft: mass"));
    let formula = self::lines(DISKS, &["body.0.gravity=[0, \"-10\"]"]);
    assert!(weight.is_some_and(|weight| formula.contains(weight)), "{formula:#?}");
    // Forces that rise are also given for the end.
    let mut ramped = vec!["body.0.gravity=[0, \"-200*t\"]", "body.1.gravity=[0, \"-200*t\"]"];
    ramped.push("fluid.body_force=[0, \"-2e5*t\"]");
    let found = self::lines(DISKS, &ramped);
    let weight = "weight [0.0, 0.0] N/m at t = 0 s and [0.0, -471.2] N/m at t = 0.05 s, buoyancy [0.0, 0.0] N/m at t = 0 s and [0.0, 314.2] N/m at t = 0.05 s";
    assert!(found.iter().any(|line| line.ends_with(weight)), "{found:#?}");
    assert!(!found.iter().any(|line| line.starts_with("warning")), "{found:#?}");
    ramped[1] = "body.1.gravity=[0, \"-2*t\"]";
    assert!(warning(DISKS, &ramped).contains("at t = 0.05 `fluid.body_force` is [0.0, -10000.0] at body stone"));
}

#[test]
fn a_body_force_given_as_an_acceleration_is_a_warning() {
    let changes = ["fluid.body_force=[0.0, -10.0]", "body.0.gravity=[0.0, -0.01]"];
    let words = ["`fluid.body_force` is [0.0, -10.0] at body stone", "[0.0, -10000.0]", "force per volume"];
    check_words(&warning(DISKS, &changes), &words);
}

#[test]
fn elastic_bodies_with_implicit_euler_are_a_warning() {
    for coordinates in [&[][..], &["coordinates=cartesian"]] {
        let sets = [&["time.scheme=implicit-euler"], coordinates].concat();
        assert!(warning(DISKS, &sets).contains("changes its area"));
    }
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

/// Two halves of a square that share an edge, but no vertex.
#[test]
fn a_torn_body_is_a_warning() {
    let halves = [0.2, 0.3].map(|left| structured_box::<2>([left, 0.4], [left + 0.1, 0.6], [2, 4]).expect("a box"));
    let points: Vec<_> = halves.iter().flat_map(|half| half.vertices()).copied().collect();
    let cells = halves.iter().zip([0, halves[0].n_vertices()]).flat_map(|(half, first)| {
        let vertices = half.cells().flat_map(|cell| half.cell(cell));
        vertices.map(move |vertex| VertexId::new(first + vertex.index()))
    });
    let mesh = SimplexMesh::<2>::new(points, cells.collect()).expect("a mesh");
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("torn.msh");
    let format = GmshFormat { version: GmshVersion::V41, is_binary: false };
    write(&path, &mesh, &HashMap::new(), format).expect("a file");
    let ball = "{ kind = \"ball\", centre = [0.3, 0.5], radius = 0.1, size = 0.05, area_preserving = true }";
    let torn = DISKS.replace(ball, &format!("{{ kind = \"mesh\", file = \"{}\" }}", path.display()));
    assert!(warning(&torn, &[]).contains("body soft consists of 2 parts that share no vertex"));
}

#[test]
fn an_absolute_pressure_of_vapour_is_a_warning() {
    let film =
        |floor: &str| DISKS.replace("viscosity  = 1.0", &format!("viscosity = 1.0\nfilm = {{ floor = {floor} }}"));
    let of = |floor: &str| sizes(&legal(&film(floor), &[])).expect("sizes").warnings;
    assert!(of("2300.0").iter().any(|line| line.contains("fluid.film.floor is 2.3e3, above zero")));
    assert!(!of("-1e5").iter().any(|line| line.contains("floor")));
}

#[test]
fn bodies_without_contact_are_named() {
    let found = |text: &str| lines(text, &[]).into_iter().find(|line| line.starts_with("no contact between"));
    let all = "no contact between soft and stone, soft and the sides, stone and the sides";
    assert_eq!(found(DISKS).as_deref(), Some(all));
    let floor = format!("{DISKS}{CONTACT}");
    assert_eq!(found(&floor).as_deref(), Some("no contact between soft and stone, soft and the sides"));
    let obstacle = "body     = \"stone\"\nobstacle = { kind = \"wall\", parts = [\"bottom\"] }";
    let pair = floor.replace(obstacle, "pair = [\"soft\", \"stone\"]");
    assert_eq!(found(&pair).as_deref(), Some("no contact between soft and the sides, stone and the sides"));
    let copies = DISKS.replace(
        "[[body]]\nname     = \"soft\"",
        "[[body]]\ncopies = [[0.0, 0.25], [0.0, -0.25]]\nname     = \"soft\"",
    );
    // Six pairs of four bodies, and the sides.
    assert!(found(&copies).is_some_and(|line| line.ends_with(", and 4 more")), "{:?}", found(&copies));
}

#[test]
fn a_parabola_that_ends_at_a_plane_of_symmetry_is_a_warning() {
    let inflow = |more: &str| {
        let text = DISKS
            .replace("left   = \"no-slip\"", "left = { kind = \"inflow\", profile = \"parabolic\", maximum = 1.0 }");
        lines(&text.replace("bottom = \"no-slip\"", more), &[])
    };
    let is_about = |line: &&String| line.contains("side left ends at a plane of symmetry");
    assert_eq!(inflow("bottom = \"symmetry\"").iter().filter(is_about).count(), 1);
    assert_eq!(inflow("bottom = \"no-slip\"").iter().filter(is_about).count(), 0);
}

/// A stone of radius 0.1 that turns by 0.3 rad in a step of 0.01: the surface is up to 0.1 (0.3²)/2 too far out with
/// generalised-α. Points of free bodies turn.
#[test]
fn bodies_that_turn_too_fast_for_their_contacts_are_warnings() {
    let of_soft = CONTACT
        .replace("\"stone\"", "\"soft\"")
        .replace("\"wall\", parts = [\"bottom\"]", "\"body\", name = \"stone\"");
    let text = format!("{DISKS}{of_soft}");
    let with = |motion: &str| text.replace("{ kind = \"free\" }", motion);
    let spinning = with("{ kind = \"rotating\", centre = [0.7, 0.5], angular_velocity = 30.0 }")
        .replace("density = 2500.0\ngravity = [0.0, -10.0]\n", "");
    let found = warning(&spinning, &["time.step=0.01"]);
    assert!(found.contains("body stone turns so far in a step") && found.contains("e-3 m too far out"), "{found}");
    let is_silent =
        |text: &str, changes: &[&str]| !lines(text, changes).iter().any(|line| line.contains("turns so far"));
    assert!(is_silent(&spinning, &["time.step=1e-3"]));
    assert!(is_silent(&spinning, &["time.step=0.01", "time.scheme=implicit-euler"]));
    assert!(is_silent(&with("{ kind = \"free\", initial_spin = 30.0 }"), &["time.step=0.01"]));
}

#[test]
fn bodies_that_nothing_holds_without_inertia_are_warnings() {
    let start = DISKS.find("[fluid]").expect("a fluid")..DISKS.find("[[body]]").expect("a body");
    let mut dry = DISKS.to_owned();
    dry.replace_range(start, "");
    let of = |text: &str, changes: &[&str]| sizes(&legal(text, &[changes])).expect("sizes").warnings;
    let found = of(&dry, &["time.scheme=quasi-static"]);
    assert_eq!(found.len(), 2, "{found:?}");
    for (line, name) in found.iter().zip(["soft", "stone"]) {
        assert!(line.contains(&format!("no part of body {name} is held")), "{line}");
    }
    let held = |kind: &str| of(&dry, &["time.scheme=quasi-static", &format!("body.0.boundary.surface={kind}")]);
    assert_eq!(held("clamped").len(), 1);
    assert_eq!(held("{kind = \"traction\", value = [1.0, 0.0]}").len(), 2);
    let copied = ["time.scheme=quasi-static", "body.0.boundary.surface=clamped", "body.0.copies=[[0.0, 0.25]]"];
    let partly = dry.replace("\"free\" }", "\"free\", held = [\"x\"] }");
    assert_eq!(of(&partly, &copied).len(), 1, "the other motions are loose");
    let found = of(&dry, &copied);
    assert!(found.len() == 1 && found[0].contains("body stone is held") && found[0].contains("`body.motion.held`"));
    assert!(of(&dry.replace("\"free\" }", "\"free\", held = [\"x\", \"y\", \"rotation\"] }"), &copied).is_empty());
    for (text, changes) in [(&dry[..], &["time.scheme=implicit-euler"]), (DISKS, &["time.scheme=quasi-static"])] {
        assert!(!of(text, changes).iter().any(|line| line.contains("is held")));
    }
}

/// A disk of radius 0.1 that reaches through the floor, with its other vertices above it.
#[test]
fn a_body_does_not_begin_behind_its_wall() {
    let text = format!("{DISKS}{CONTACT}");
    refused(&text, &[&["body.1.shape.centre=[0.7, 0.05]"]], &["contact.obstacle", "`stone`", "behind this obstacle"]);
}

/// Checks the energy that the pressure on an elastic disk makes: an error of second order, summed over all steps.
#[test]
fn the_energy_that_steps_generate_falls_with_the_step() {
    let changes = [
        "background.boundary.top={ kind = \"pressure\", value = \"3e5*min(t/0.2, 1)\" }",
        "background.size=0.1",
        "fluid.body_force=[0, 0]",
        "body.0.gravity=[0, 0]",
        "body.1.gravity=[0, 0]",
        "time.end=0.24",
        "output.vtk_every=0",
    ];
    let generated = |step: &str| {
        let file = legal(DISKS, &[&changes, &[step]]);
        let summary = io::run(&file, &fresh_directory(step), &mut ()).unwrap_or_else(|e| panic!("{e}"));
        assert!(!summary.energy_monotone);
        summary.energy_generated.expect("a step")
    };
    let [coarse, fine] = ["time.step=0.02", "time.step=0.01"].map(generated);
    assert!(fine > 1e-8 && fine < 0.5 * coarse && coarse < 0.01, "{coarse:e} {fine:e}");
}

/// Checks a container that is shaken with a floating body in it: pressure balances all forces, and nothing moves.
/// Forces are zero at the start.
#[test]
fn fluid_at_rest_generates_no_energy() {
    let stone = DISKS.replace("density = 2500.0", "density = 1000.0");
    let (before, after) = (stone.find("[[body]]").expect("a body"), stone.rfind("[[body]]").expect("a body"));
    let text = stone[..before].to_owned() + &stone[after..];
    let changes = [
        "fluid.body_force=[0, \"-1e4*sin(60*t)\"]",
        "body.0.gravity=[0, \"-10*sin(60*t)\"]",
        "time.end=0.01",
        "output.vtk_every=0",
    ];
    let file = legal(&text, &[&changes]);
    let summary = io::run(&file, &fresh_directory("shaken"), &mut ()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(summary.energy_generated, Some(0.0));
    assert!(summary.energy_defect.is_some_and(|defect| defect < 1.0), "{:?}", summary.energy_defect);
}

#[test]
fn pressures_of_sides_are_compared_with_the_stiffness_of_bodies() {
    // Young's modulus is 4e5 (3 16 + 2 4)/(16 + 4) = 1.12e6.
    let top = |pressure: &str| format!("background.boundary.top={{ kind = \"pressure\", value = \"{pressure}\" }}");
    let rising = top("5.6e5*min(t/0.02, 1) - 2000");
    let found = lines(DISKS, &[&rising]);
    assert!(
        found
            .contains(&"side top: pressure -2e3 to 5.58e5 Pa, up to 0.4982 of Young's modulus of body soft".to_owned()),
        "{found:#?}"
    );
    assert!(!found.iter().any(|line| line.starts_with("warning")));
    assert!(warning(DISKS, &[&top("6e5")]).contains("0.5357 of Young's modulus of body soft in the first step"));
    let svk = DISKS.replace("neo-hookean", "saint-venant-kirchhoff");
    assert!(warning(&svk, &[&rising]).contains("may collapse"));
    let euler = lines(DISKS, &[&rising, "time.scheme=implicit-euler"]);
    assert!(euler.iter().any(|line| line.contains("with implicit-euler it may turn the body")), "{euler:#?}");
    // 1e4 N/m³ times 1 m.
    let hydrostatic = "fluid.body_force: hydrostatic pressure 1e4 Pa, up to 0.008929 of Young's modulus of body soft";
    assert!(lines(DISKS, &[]).contains(&hydrostatic.to_owned()), "{:#?}", lines(DISKS, &[]));
    let soft = DISKS.replace("mu = 4.0e5, lambda = 1.6e6", "mu = 4.0e3, lambda = 1.6e4");
    assert!(warning(&soft, &[]).contains("hydrostatic pressure of `fluid.body_force` is 0.8929 of Young's modulus"));
    let softer = DISKS.replace("mu = 4.0e5, lambda = 1.6e6", "mu = 4.0e2, lambda = 1.6e3");
    let found = lines(&softer, &[&top("6e5")]);
    assert!(found.iter().any(|line| line.contains("which crushes most bodies: check the units of both")), "{found:#?}");
    // Without a traction or a body force that is not zero there is no line.
    let weightless = DISKS.replace("[0.0, -10000.0]", "[0.0, 0.0]");
    assert!(!lines(&weightless, &[]).iter().any(|line| line.contains("pressure")));
}

/// Checks a heavy stone that is thrown through the bottom of the box, and that contact stops it.
#[test]
fn a_body_that_ends_in_a_wall_is_reported() {
    let thrown = [
        "body.1.shape.centre=[0.7, 0.115]",
        "body.1.density=1e5",
        "body.1.initial_velocity=[0.0, -2.0]",
        "time.end=0.02",
        "output.vtk_every=0",
    ];
    let outside = |text: &str, more: &[&str]| results(&legal(text, &[&thrown, more]), &fresh_directory("sink")).outside;
    let found = outside(DISKS, &[]);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("body stone reaches ") && found[0].contains("through side bottom"), "{found:?}");
    let stiff = ["contact.offset=0.01", "contact.law.gamma_contact_0=1e9"];
    assert_eq!(outside(&format!("{DISKS}{CONTACT}"), &stiff), [""; 0]);
}

#[test]
fn bodies_without_contact_that_overlap_at_the_end_are_reported() {
    let stone = "shape   = { kind = \"ball\", centre = [0.7, 0.5]";
    let text = DISKS.replace(stone, "shape   = { kind = \"ball\", centre = [0.3, 0.715]");
    let fast = "initial_velocity = [0.0, -2.0]\n\n[output]\nvtk_every = 0\n";
    let text = text.replace("end  = 0.05", "end  = 0.02") + fast;
    let overlapping = |more: &str| results(&legal(&format!("{text}{more}"), &[]), &fresh_directory("pass")).overlapping;
    let found = overlapping("");
    assert!(found.len() == 1 && found[0].starts_with("bodies soft and stone overlap by "), "{found:?}");
    let contact =
        "[contact]\npairs = \"all\"\nsize = 0.02\noffset = 0.01\nlaw = { kind = \"penalty\", gamma_contact_0 = 1e7 }\n";
    assert_eq!(overlapping(contact), [""; 0]);
}

#[test]
fn the_weight_of_the_fluid_along_an_open_side_needs_a_pressure() {
    let left = |condition: &str| format!("background.boundary.left={condition}");
    let pressure = |value: &str| left(&format!("{{ kind = \"pressure\", value = \"{value}\" }}"));
    let found = |sets: &[String]| {
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        let lines = lines(DISKS, &sets).into_iter();
        lines.filter(|line| line.contains("the fluid flows in or out there")).collect::<Vec<_>>()
    };
    // A force that is zero at the end counts, too.
    let swinging = "fluid.body_force=[0, \"-1e4*sin(pi*t/0.02)\"]".to_owned();
    for sets in [vec![left("free")], vec![left("parallel"), swinging], vec![pressure("2e3*(1 - y)")]] {
        let found = found(&sets);
        assert!(found.len() == 1 && found[0].contains("along side left the pressure changes by"), "{sets:?} {found:?}");
    }
    // Balanced, closed, a film on an inclined plane, whose weight the shear carries, and a force that is not uniform.
    let inclined = "fluid.body_force=[5e3, -8.66e3]".to_owned();
    let centrifugal = "fluid.body_force=[0, \"-1e4*(1 - y)\"]".to_owned();
    for sets in [
        vec![pressure("1e4*(1 - y)")],
        vec![left("no-slip")],
        vec![inclined],
        vec![pressure("5e3*(1 - y)^2"), centrifugal],
    ] {
        assert!(found(&sets).is_empty(), "{sets:?} {:?}", found(&sets));
    }
}

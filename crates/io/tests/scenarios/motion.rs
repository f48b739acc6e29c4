//! Bodies of prescribed motion: valid and invalid keys of a scenario, and the files of a run.

use std::fs;

use crate::setting::*;
use io::{Error, ScenarioFile, sizes};
use mesh::Point;
use solver::algebra::BlockLayout;
use solver::algebra::time::ImplicitEuler;
use solver::body::StepTime;

const COARSE: [&str; 4] =
    ["background.size=0.03", "body.0.shape.size=0.015", "background.boundary.left.ramp=0.1", "output.vtk_every=2"];
const MOTION: &str = r#"{ kind = "formula", displacement = ["0", "0.05*sin(2*pi*0.25*t)"] }"#;

/// An elastic bar downstream of the cylinder.
const BAR: &str = r#"
[[body]]
name     = "bar"
shape    = { kind = "box", min = [0.5, 0.15], max = [0.6, 0.25], n = [2, 2] }
material = { kind = "saint-venant-kirchhoff", mu = 10.0, lambda = 40.0 }
density  = 1.0
gravity  = [0.0, 0.0]
"#;

/// Returns the text of a contact of a body with an obstacle.
fn contact(body: &str, obstacle: &str) -> String {
    format!(
        "\n[[contact]]\nbody = \"{body}\"\nlaw = {{ kind = \"penalty\", gamma_contact_0 = 10.0 }}\nsize = 0.05\n\
         offset = 0.01\nobstacle = {obstacle}\n"
    )
}

/// Returns the text of the case with another motion in place of the formula, and with more text at its end.
fn with_motion(motion: &str, more: &str) -> String {
    assert!(CHANNEL.contains(MOTION));
    CHANNEL.replace(MOTION, motion) + more
}

/// Reads a scenario in the directory of all tests, to which the paths of tables are relative.
fn read(text: &str, sets: &[&str]) -> Result<ScenarioFile, Error> {
    parse_at(&in_folder("case.toml"), text, &[&COARSE, sets])
}

fn moving(motion: &str, more: &str, sets: &[&str]) -> ScenarioFile {
    read(&with_motion(motion, more), sets).unwrap_or_else(|e| panic!("{e}"))
}

/// Expects an error at a key, on the line of some text, with all the given words.
fn expect(motion: &str, more: &str, on: &str, key: &str, words: &[&str]) {
    let text = with_motion(motion, more);
    let begin = text.find(on).unwrap_or_else(|| panic!("{on}"));
    check_place(mistake(read(&text, &[])), &text, begin, key, words);
}

/// Returns reference, position and velocity of the vertices of the first body after a step from 0 to `t`. The velocity
/// of the surface in this step is that at the end.
fn moved(file: &ScenarioFile, t: f64) -> Vec<[Point<2>; 3]> {
    let case = planar_case(file);
    let body = &case.setup.bodies[0];
    let (start, mut layout) = (body.initial(), BlockLayout::new());
    let time = StepTime::new(&ImplicitEuler, t, t, true);
    let step = body.step(&start, &time, &mut layout);
    assert!(layout.is_empty() && step.surface().end.slope == 0.0);
    let end = step.end(&layout, &[]);
    let positions = end.positions(body.reference());
    assert_eq!(step.surface().end.predicted, positions);
    assert_eq!(step.surface().start, start.positions(body.reference()));
    let vertices = body.reference().iter().zip(&positions).zip(end.velocity());
    let at = |((reference, x), v): ((&Point<2>, &Point<2>), &Point<2>)| {
        assert_eq!(body.given_velocity(x, t), Some(*v));
        [*reference, *x, *v]
    };
    vertices.map(at).collect()
}

#[test]
fn each_kind_moves_the_body_as_documented() {
    let file = moving(r#"{ kind = "fixed" }"#, "", &[]);
    assert!(moved(&file, 3.0).iter().all(|[x, y, v]| x == y && v.norm() == 0.0));
    for (velocity, angle, rate) in [("2.0", 1.4, 2.0), ("\"3*cos(t)\"", 3.0 * 0.7_f64.sin(), 3.0 * 0.7_f64.cos())] {
        let motion = format!("{{ kind = \"rotating\", centre = [0.2, 0.2], angular_velocity = {velocity} }}");
        for [x, y, v] in moved(&moving(&motion, "", &[]), 0.7) {
            let (arm, turned) = (x - Point::<2>::new(0.2, 0.2), y - Point::<2>::new(0.2, 0.2));
            assert!((turned[1].atan2(turned[0]) - arm[1].atan2(arm[0]) - angle).sin().abs() < 1e-12);
            assert!((v - Point::<2>::new(-rate * turned[1], rate * turned[0])).norm() < 1e-13);
        }
    }
    let file = moving(MOTION, "", &[]);
    for [x, y, v] in moved(&file, 0.5) {
        let (sin, cos) = (std::f64::consts::FRAC_PI_4).sin_cos();
        assert!((y - x - Point::<2>::new(0.0, 0.05 * sin)).norm() < 1e-15);
        assert!((v - Point::<2>::new(0.0, 0.05 * 0.5 * std::f64::consts::PI * cos)).norm() < 1e-15);
    }
    let table = fresh_directory("tables").join("straight.csv");
    fs::write(&table, "time,x,y,angle\n0,0,0.01,0\n4,0.04,0.01,2\n8,0.08,0.01,4\n").expect("a writable directory");
    let file = moving(r#"{ kind = "table", file = "tables/straight.csv", centre = [0.2, 0.2] }"#, "", &[]);
    for [_, y, v] in moved(&file, 1.0) {
        let turned = y - Point::<2>::new(0.21, 0.21);
        assert!((turned.norm() - 0.05).abs() < 0.01);
        assert!((v - Point::<2>::new(0.01 - 0.5 * turned[1], 0.5 * turned[0])).norm() < 1e-13);
    }
}

/// Steps to states of equilibrium may be as long as a turn.
#[test]
fn turns_are_limited_in_steps_with_inertia_only() {
    let turning = r#"{ kind = "rotating", centre = [0.2, 0.2], angular_velocity = 1000.0 }"#;
    expect(turning, "", "motion = {", "body.0.motion.angular_velocity", &["rad in a step"]);
    moving(turning, "", &["time.scheme=quasi-static"]);
}

/// A shifted paddle turns about its centre, and its copy about the centre of the copy.
#[test]
fn shifted_bodies_and_copies_turn_about_centres_of_their_own() {
    let file = moving(
        r#"{ kind = "rotating", centre = [0.2, 0.2], angular_velocity = 2.0 }"#,
        "",
        &["body.0.shift=[0.1, 0.0]", "body.0.copies=[[0.5, 0.1]]"],
    );
    let case = planar_case(&file);
    let velocity = |body: usize, x: Point<2>| case.setup.bodies[body].given_velocity(&x, 0.3).expect("a given motion");
    for (body, centre) in [Point::<2>::new(0.3, 0.2), Point::<2>::new(0.8, 0.3)].into_iter().enumerate() {
        let turning = velocity(body, centre + Point::<2>::new(0.03, 0.0)) - Point::<2>::new(0.0, 0.06);
        assert!(velocity(body, centre).norm() < 1e-14 && turning.norm() < 1e-14, "body {body}");
    }
}

#[test]
fn motions_survive_writing_and_reading() {
    for motion in [
        r#"{ kind = "fixed" }"#,
        r#"{ kind = "rotating", centre = [0.2, 0.2], angular_velocity = -2 }"#,
        r#"{ kind = "rotating", centre = [0.2, 0.2], angular_velocity = "sin(t)" }"#,
        r#"{ kind = "formula", displacement = ["t", "0"], angle = "0.1*t", centre = [0.2, 0.2] }"#,
        r#"{ kind = "table", file = "motion.csv" }"#,
    ] {
        check_text(&moving(motion, "", &[]));
    }
    for more in [r#"held = ["x", "rotation"]"#, r#"held = ["y"], initial_spin = -2.0"#] {
        check_text(&moving(&free(more), "", &[]));
    }
}

#[test]
fn mistakes_in_a_motion_are_reported_with_line_and_key() {
    let folder = fresh_directory("wrong");
    for (name, rows) in [("row", "time,x,y\n0,0,0\n1,0\n"), ("late", "time,x,y\n0.1,0,0\n9,0,0\n")] {
        fs::write(folder.join(format!("{name}.csv")), rows).expect("a writable directory");
    }
    let check = |kind: &str, more: &str, key: &str, words: &[&str]| {
        expect(&format!("{{ kind = \"{kind}\"{more} }}"), "", "motion = {", &format!("body.0.motion{key}"), words);
    };
    check("fixd", "", ".kind", &["did you mean `fixed`?", "formula"]);
    check("fixed", ", centre = [0, 0]", ".centre", &["unknown key"]);
    check("rotating", ", centre = [0.2, 0.2]", "", &["`angular_velocity` is missing"]);
    check("rotating", ", centre = [0.2], angular_velocity = 1", ".centre", &["1 components"]);
    check("formula", r#", displacement = ["t"]"#, ".displacement", &["1 components"]);
    check("formula", r#", displacement = ["0", "0"], angle = "t""#, "", &["`centre` is missing"]);
    let words = ["no effect", "without an angle", "take it out"];
    check("formula", r#", displacement = ["0", "0"], centre = [0, 0]"#, ".centre", &words);
    for (formula, words) in [
        ("sin(x)", ["`x` is not known", "character 5", "cosh"]),
        ("sqrt(t)", ["derivative", "t = 0 is inf", "change it"]),
        ("ln(-t)", ["value", "`ln(-t)`", "change it"]),
    ] {
        check("formula", &format!(", displacement = [\"0\", \"{formula}\"]"), ".displacement.1", &words);
    }
    let table = |file: &str, key: &str, words: &[&str]| check("table", &format!(", file = \"{file}\""), key, words);
    table("wrong/row.csv", ".file", &["row.csv:3: ", "2 values"]);
    table("wrong/late.csv", ".file", &["late.csv: ", "0.1 to 9", "needs 0 to 8"]);
}

#[test]
fn what_only_elastic_bodies_have_is_refused() {
    for (key, value) in [
        ("material", r#"{ kind = "saint-venant-kirchhoff", mu = 1.0, lambda = 1.0 }"#),
        ("density", "1.0"),
        ("gravity", "[0.0, 0.0]"),
        ("boundary", r#"{ surface = "clamped" }"#),
        ("initial_displacement", "[0.0, 0.0]"),
        ("initial_velocity", "[0.0, 0.0]"),
    ] {
        let given = format!("{key} = {value}");
        let words = ["no effect with a motion that is given", "take it out"];
        expect(&format!("{MOTION}\n{given}"), "", &given, &format!("body.0.{key}"), &words);
    }
    for key in ["material", "density", "gravity"] {
        let line = BAR.lines().find(|line| line.starts_with(key)).expect("a key");
        let missing = format!("`{key}` is missing");
        expect(MOTION, &BAR.replace(line, ""), "[[body]]\nname     = \"bar\"", "body.1", &[&missing]);
    }
}

#[test]
fn contacts_in_which_nothing_yields_are_refused() {
    let plane = contact("cylinder", r#"{ kind = "rigid-plane", point = [0.0, 0.0], normal = [0.0, -1.0] }"#);
    expect(
        MOTION,
        &plane,
        "obstacle = ",
        "contact.0.obstacle",
        &["neither `cylinder`", "the obstacle is at rest", "elastic"],
    );
    let post = "\n[[body]]\nname = \"post\"\nshape = { kind = \"box\", min = [0.5, 0.0], max = [0.6, 0.1], n = [2, 2] }\n\
                motion = { kind = \"fixed\" }\n";
    let both = post.to_owned() + &contact("cylinder", r#"{ kind = "body", name = "post" }"#);
    expect(
        MOTION,
        &both,
        "obstacle = ",
        "contact.0.obstacle.name",
        &["both have a given motion", "take the contact out"],
    );
    // As an obstacle of an elastic body it is lowered.
    let file = moving(MOTION, &(BAR.to_owned() + &contact("bar", r#"{ kind = "body", name = "cylinder" }"#)), &[]);
    assert_eq!(planar_case(&file).setup.contacts.len(), 1);
}

/// The cylinder as a free body.
const FREE: &str = "{ kind = \"free\" }\ndensity = 1.5\ngravity = [0.0, -9.81]";

/// Returns the text of the cylinder as a free body, with more keys of its motion.
fn free(more: &str) -> String {
    FREE.replace(" }", &format!(", {more} }}"))
}

#[test]
fn free_bodies_need_a_mass_and_take_nothing_of_elastic_ones() {
    moving(FREE, "", &[]);
    moving(&format!("{FREE}\ninitial_velocity = [0.1, 0.0]"), "", &[]);
    let density = |text: &str| FREE.replace("density = 1.5", text);
    expect(&density("density = 0.0"), "", "density = 0.0", "body.0.density", &["positive"]);
    let clamped = r#"boundary = { surface = "clamped" }"#;
    let words = ["no effect with a body that does not deform", "take it out"];
    expect(&format!("{FREE}\n{clamped}"), "", clamped, "body.0.boundary", &words);
    let held = free(r#"held = ["x", "z"]"#);
    expect(&held, "", "held", "body.0.motion.held.1", &["no effect with two dimensions"]);
    expect(&free(r#"held = ["rotatoin"]"#), "", "held", "body.0.motion.held.0", &["rotatoin", "rotation"]);
    let thrown = free(r#"held = ["x"]"#) + "\ninitial_velocity = [0.1, 0.0]";
    expect(&thrown, "", "initial_velocity", "body.0.initial_velocity.0", &["no effect with an axis that is held"]);
    let spun = free(r#"held = ["rotation"], initial_spin = 1.0"#);
    expect(&spun, "", "initial_spin", "body.0.motion.initial_spin", &["no effect with a rotation that is held"]);
}

#[test]
fn a_free_cylinder_sinks_with_the_force_that_is_reported() {
    let directory = fresh_directory("free-cylinder");
    let sets = [
        "fluid.body_force=[0.0,-9.81]",
        "time.step=0.01",
        "time.scheme=implicit-euler",
        "time.end=0.1",
        "background.boundary.left=no-slip",
        "background.boundary.right=no-slip",
    ];
    let file = moving(FREE, "", &sets);
    let summary = results(&file, &directory);
    let (velocity, force) = (column(&directory, "centre_velocity"), column(&directory, "force_y"));
    let mass = 1.5 * std::f64::consts::PI * 0.05_f64.powi(2);
    let mut before = 0.0;
    for (v, f) in velocity.iter().zip(&force) {
        let inertia = mass * (v - before) / 0.01;
        assert!((inertia + mass * 9.81 - f).abs() < 1e-6 * mass * 9.81, "{inertia} {f}");
        before = *v;
    }
    // Buoyancy and added mass: the added mass is positive and less than the mass of the displaced fluid.
    let acceleration = -velocity[0] / 0.01;
    assert!(acceleration < 9.81 * 0.5 / 2.5 && acceleration > 9.81 * 0.5 / 3.5, "{velocity:?}");
    assert!(velocity.windows(2).all(|v| v[1] < v[0]), "{velocity:?}");
    assert_eq!(summary.leading.as_deref(), Some("cylinder"));
    assert!(directory.join("rigid.pvd").exists() && !directory.join("solid.pvd").exists());
}

#[test]
fn half_a_free_body_on_a_plane_of_symmetry_is_held_and_touches_nothing_there() {
    let half = r#"{ kind = "half-ball", centre = [0.0, 0.2], radius = 0.05, size = 0.015 }"#;
    let shape = format!("body.0.shape={half}");
    let plane = contact("cylinder", r#"{ kind = "rigid-plane", point = [0.0, 0.0], normal = [0.0, -1.0] }"#);
    let sets = [shape.as_str(), "background.boundary.left=symmetry"];
    let loose = moving(FREE, &plane, &sets);
    let message = sizes(&loose).expect_err("it may leave the plane").to_string();
    assert!(message.contains("body.0.motion") && message.contains(r#"held = ["x", "rotation"]"#), "{message}");
    let file = moving(&FREE.replace(" }", r#", held = ["x", "rotation"] }"#), &plane, &sets);
    let setup = planar_case(&file).setup;
    let (boundary, reference) = (setup.bodies[0].surface(), setup.bodies[0].reference());
    let on_plane = |f: &mesh::FacetId| boundary.facet(*f).iter().all(|v| reference[v.index()][0].abs() < 1e-12);
    let n_on_plane = boundary.facets().filter(on_plane).count();
    assert!(n_on_plane > 2 && setup.contacts[0].facets().len() + n_on_plane == boundary.n_facets());
    assert!(!setup.contacts[0].facets().iter().any(on_plane));
}

#[test]
fn a_cylinder_that_moves_as_prescribed_pushes_an_elastic_bar() {
    let directory = fresh_directory("pushed");
    let towards = r#"{ kind = "formula", displacement = ["0.5*t", "0"] }"#;
    let pair = BAR.replace("min = [0.5, 0.15], max = [0.6, 0.25]", "min = [0.27, 0.15], max = [0.37, 0.25]")
        + &contact("bar", r#"{ kind = "body", name = "cylinder" }"#);
    let sets = ["time.step=0.01", "time.end=0.15", "background.boundary.left=no-slip"];
    let file = moving(towards, &pair, &sets);
    let summary = results(&file, &directory);
    assert!(summary.contact_time.is_some(), "they touch");
    // Gap 0.02, offset 0.01, and the bar yields.
    let active = column(&directory, "bar_active_points");
    assert!(active[0] == 0.0 && active[14] > 0.0, "{active:?}");
    let velocity = column(&directory, "bar_contact_power");
    assert!(velocity.iter().all(|power| power.is_finite()));
}

#[test]
fn bodies_are_placed_where_they_are_at_the_start() {
    let away = r#"{ kind = "formula", displacement = ["3 + t", "0"] }"#;
    expect(away, "", "shape  = {", "body.0.shape", &["body `cylinder` is outside of the domain"]);
    let file = moving(r#"{ kind = "formula", displacement = ["0.35", "0"] }"#, BAR, &[]);
    assert!(sizes(&file).expect_err("on the bar").to_string().contains("overlap"));
}

#[test]
fn a_cylinder_in_a_channel_has_drag() {
    let directory = fresh_directory("fixed");
    // On the axis of the channel.
    let sets = ["time.end=0.5", "body.0.shape.centre=[0.3, 0.205]"];
    let file = moving(r#"{ kind = "fixed" }"#, "", &sets);
    let summary = results(&file, &directory);
    assert_eq!((summary.steps, summary.leading.as_deref()), (10, Some("cylinder")));
    let [drag, lift, traction, torque] =
        ["force_x", "force_y", "traction_force_x", "torque"].map(|name| column(&directory, name));
    for k in 5..10 {
        assert!(drag[k] > 5e-3 && drag[k] < 5e-2, "{drag:?}");
        assert!(lift[k].abs() < 0.1 * drag[k], "{lift:?}");
        assert!((traction[k] - drag[k]).abs() < 0.5 * drag[k], "{traction:?} {drag:?}");
        assert!(torque[k].abs() < 0.1 * drag[k] * 0.05, "{torque:?}");
    }
    assert!(column(&directory, "centre_y").iter().all(|y| (y - 0.205).abs() < 1e-12));
    for file in ["history.csv", "diagnostics.csv", "rigid.pvd", "fluid.pvd"] {
        assert!(fs::metadata(directory.join(file)).is_ok_and(|data| data.len() > 200), "{file}");
    }
    assert!(!directory.join("solid.pvd").exists());
    // The same again, digit by digit.
    let again = fresh_directory("fixed-again");
    results(&file, &again);
    assert_eq!((drag, torque), (column(&again, "force_x"), column(&again, "torque")));
}

#[test]
fn the_torque_on_a_rotating_cylinder_acts_against_its_rotation() {
    let directory = fresh_directory("rotating");
    let motion = r#"{ kind = "rotating", centre = [0.2, 0.2], angular_velocity = 4.0 }"#;
    let sets = [
        "background.size=0.015",
        "body.0.shape.size=0.0075",
        "fluid.viscosity=1.0",
        "time.end=0.2",
        "background.boundary.left=no-slip",
        "output.vtk_every=0",
    ];
    results(&moving(motion, "", &sets), &directory);
    let torque = column(&directory, "torque");
    assert!(torque.iter().all(|m| *m < 0.0), "{torque:?}");
    // Stokes flow around it without walls: 4 π μ r² ω. In a circle as wide as the channel it is 1.07 times that, and
    // the cells of this mesh, a third of the radius, add 12 %.
    let stokes = 4.0 * std::f64::consts::PI * 0.05_f64.powi(2) * 4.0;
    let last = torque[torque.len() - 1];
    assert!(-last > stokes && -last < 1.2 * stokes, "{torque:?} {stokes}");
}

#[test]
fn a_table_moves_a_body_beside_an_elastic_one() {
    let directory = fresh_directory("mixed");
    let table = directory.join("up.csv");
    fs::write(&table, "\u{feff}time,x,y\n0,0,0\n0.1,0,0.004\n0.2,0,0.016\n0.3,0,0.03\n").expect("a writable directory");
    let motion = r#"{ kind = "table", file = "mixed/up.csv" }"#;
    let first = directory.join("results");
    // What an older run has left goes, what is not of a run stays.
    fs::create_dir_all(first.join("vtk")).expect("a writable directory");
    let [old, other] = ["vtk/fluid_099999.vtu", "vtk/mine.vtu"].map(|name| first.join(name));
    for path in [&old, &other] {
        fs::write(path, "old").expect("a writable directory");
    }
    let file = moving(motion, BAR, &["time.end=0.2"]);
    let summary = results(&file, &first);
    assert_eq!(summary.leading.as_deref(), Some("bar"), "the first movable body");
    assert!(!old.exists() && other.exists());
    assert!(column(&first, "cylinder_angle").iter().all(|angle| angle.abs() < 1e-12));
    let height = column(&first, "cylinder_centre_y");
    assert!((height[3] - 0.216).abs() < 1e-12 && (height[1] - 0.204).abs() < 1e-12, "{height:?}");
    assert!(column(&first, "cylinder_centre_velocity").iter().all(|v| *v > 0.0));
    assert!(column(&first, "bar_force_x").iter().chain(&column(&first, "cylinder_force_y")).all(|f| f.is_finite()));
    for file in ["solid.pvd", "rigid.pvd", "interface.pvd"] {
        assert!(first.join(file).exists(), "{file}");
    }
    // A run can be continued from its checkpoint without the table that it was started with.
    fs::remove_file(&table).expect("the table");
    let left = ScenarioFile::read(&first.join("scenario.toml"), &[]).unwrap_or_else(|e| panic!("{e}"));
    results(&left, &directory.join("again"));
    assert_eq!(column(&directory.join("again"), "cylinder_force_x"), column(&first, "cylinder_force_x"));
}

#[test]
fn a_channel_without_bodies_is_a_run_too() {
    let directory = fresh_directory("empty");
    let (begin, end) = (CHANNEL.find("[[body]]").expect("a body"), CHANNEL.find("[output]").expect("a section"));
    let text = CHANNEL[..begin].to_owned() + &CHANNEL[end..];
    results(&legal(&text, &[&["background.size=0.1", "time.end=0.2", "output.vtk_every=2"]]), &directory);
    assert!(directory.join("fluid.pvd").exists());
    assert!(!directory.join("solid.pvd").exists() && !directory.join("interface.pvd").exists());
}

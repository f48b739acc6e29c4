//! Contacts of a scenario: pairs of bodies, slaves and masters, and obstacles at rest.

use std::f64::consts::TAU;

use crate::setting::*;
use io::RunTables;
use io::scenario::case::Case;

/// Two elastic bodies, a free one and one at rest, above a floor.
const BODIES: &str = r#"
name      = "four-bodies"
dimension = 2
units     = "si"

[time]
step = 1.0e-3
end  = 0.05

[[body]]
name     = "soft"
shape    = { kind = "ball", centre = [0.0, 0.3], radius = 0.1, size = 0.05 }
material = { kind = "neo-hookean", mu = 4.0e5, lambda = 1.6e6 }
density  = 1000.0
gravity  = [0.0, -10.0]

[[body]]
name     = "fine"
shape    = { kind = "ball", centre = [0.5, 0.3], radius = 0.1, size = 0.03 }
material = { kind = "neo-hookean", mu = 4.0e5, lambda = 1.6e6 }
density  = 1000.0
gravity  = [0.0, -10.0]

[[body]]
name    = "stone"
shape   = { kind = "ball", centre = [1.0, 0.3], radius = 0.1, size = 0.04 }
motion  = { kind = "free" }
density = 2500.0
gravity = [0.0, -10.0]

[[body]]
name   = "floor"
shape  = { kind = "box", min = [-1.0, -0.1], max = [2.0, 0.0], size = 0.1 }
motion = "fixed"

"#;
const LAW: &str = "law = { kind = \"penalty\", gamma_contact_0 = 1.0e5 }\nsize = 0.02\noffset = 0.005\n";

/// Returns the case of the bodies with the keys of one contact.
fn with(contact: &str) -> Case<2> {
    planar_case(&legal(&format!("{BODIES}[contact]\n{LAW}{contact}\n"), &[]))
}

fn refuse(contact: &str, words: &[&str]) {
    refused(&format!("{BODIES}[[contact]]\n{LAW}{contact}\n"), &[], words);
}

/// Returns the names of slave and master of each contact.
fn roles(case: &Case<2>) -> Vec<(&str, &str)> {
    let name = |id: mesh::BodyId| case.setup.bodies[id.index()].name();
    case.setup.contacts.iter().map(|c| (name(c.body()), c.master().map_or("-", name))).collect()
}

#[test]
fn all_pairs_that_can_meet_are_in_contact() {
    let expected = [
        ("soft", "soft"),
        ("fine", "soft"),
        ("stone", "soft"),
        ("soft", "floor"),
        ("fine", "fine"),
        ("fine", "stone"),
        ("fine", "floor"),
        ("stone", "floor"),
    ];
    assert_eq!(roles(&with("pairs = \"all\"")), expected);
    assert_eq!(roles(&with("pair = [\"floor\", \"stone\"]")), [("stone", "floor")]);
    assert_eq!(roles(&with("pair = [\"soft\", \"soft\"]")), [("soft", "soft")]);
    assert_eq!(roles(&with("body = \"soft\"\nobstacle = { kind = \"body\", name = \"fine\" }")), [("soft", "fine")]);
    let ball = "obstacle = { kind = \"ball\", centre = [0.0, 0.0], radius = 0.1 }";
    assert_eq!(roles(&with(&format!("body = \"all\"\n{ball}"))), [("soft", "-"), ("fine", "-"), ("stone", "-")]);
}

#[test]
fn roles_and_contacts_that_act_at_once_are_described() {
    let lines = |text: &str| io::sizes(&legal(text, &[])).expect("sizes").lines;
    // The stone is 0.2 above the floor, then 2 mm, which is within the offset.
    let apart = lines(&format!("{BODIES}[contact]\n{LAW}pair = [\"floor\", \"stone\"]\n"));
    assert!(apart.contains(&"contact pair: slave stone, master floor".to_owned()), "{apart:#?}");
    assert!(!apart.iter().any(|line| line.starts_with("warning")), "{apart:#?}");
    let near = BODIES.replace("centre = [1.0, 0.3]", "centre = [1.0, 0.102]");
    let near = lines(&format!("{near}[contact]\n{LAW}pair = [\"floor\", \"stone\"]\n"));
    let warning = near.iter().find(|line| line.starts_with("warning")).expect("a warning");
    let words = ["smallest gap of stone to floor is", "e-3 m", "below the offset 0.005 m", "acts from the first step"];
    check_words(warning, &words);
    let plane = "body = \"soft\"\nobstacle = { kind = \"rigid-plane\", point = [0, 0.198], normal = [0, -1] }";
    let plane = lines(&format!("{BODIES}[contact]\n{LAW}{plane}\n"));
    assert!(plane.iter().any(|line| line.contains("soft to its obstacle at rest")), "{plane:#?}");
}

#[test]
fn contacts_that_make_no_sense_are_refused() {
    refuse("", &["contact.0", "no bodies are named; add `pairs = \"all\"`"]);
    refuse("obstacle = { kind = \"wall\", parts = [\"bottom\"] }", &["contact.0", "`body` is missing"]);
    refuse("pairs = \"all\"\npair = [\"soft\", \"fine\"]", &["contact.0", "give one of pairs, pair"]);
    refuse("pairs = \"some\"", &["contact.0.pairs", "unknown value `some`"]);
    refuse("pair = [\"soft\", \"find\"]", &["contact.0.pair.1", "did you mean `fine`?"]);
    refuse("pair = [\"floor\", \"floor\"]", &["`floor` does not deform"]);
    let ball = "obstacle = { kind = \"ball\", centre = [0.0, 0.5], radius = 0.15 }";
    refuse(&format!("body = \"soft\"\n{ball}"), &["contact.0.obstacle", "`soft`", "behind this obstacle"]);
    refuse(&format!("body = \"floor\"\n{ball}"), &["contact.0.obstacle", "neither `floor`"]);
    let shape =
        "obstacle = { kind = \"shape\", shape = { kind = \"box\", min = [-1.0, 0.3], max = [2.0, 0.6], n = [2, 2] } }";
    refuse(&format!("body = \"soft\"\n{shape}"), &["`soft`", "behind this obstacle"]);
    let moved = BODIES.replace("[0.5, 0.3]", "[0.15, 0.3]");
    refused(
        &format!("{moved}[contact]\n{LAW}pairs = \"all\"\n"),
        &[],
        &["contact: body `fine`", "behind the surface of `soft`"],
    );
    refused(&BODIES.replace("\"soft\"", "\"all\""), &[], &["body.0.name", "every body in a contact"]);
}

/// A rigid disk that slides in a round container without friction: a pendulum.
#[test]
fn a_disk_in_a_round_container_is_a_pendulum() {
    let (arm, gravity, radius): (f64, f64, f64) = (0.4, 10.0, 0.1);
    let angle: f64 = 0.1;
    let period = TAU * (arm / gravity).sqrt();
    let centre = [arm * angle.sin(), -arm * angle.cos()];
    let end = 1.6;
    let text = format!(
        "name = \"pendulum\"\ndimension = 2\nunits = \"si\"\n[time]\nstep = 1e-3\nend = {end}\nscheme = {{ kind = \"generalised-alpha\", rho_inf = 1.0 }}\n\
         [[body]]\nname = \"disk\"\nshape = {{ kind = \"ball\", centre = {centre:?}, radius = {radius}, size = 0.004 }}\n\
         motion = {{ kind = \"free\", held = [\"rotation\"] }}\ndensity = 1000.0\ngravity = [0.0, -{gravity:?}]\n\
         [contact]\nbody = \"disk\"\nlaw = {{ kind = \"penalty\", gamma_contact_0 = 1e6 }}\nsize = 0.01\noffset = 0.0\n\
         obstacle = {{ kind = \"ball\", centre = [0.0, 0.0], radius = {}, hollow = true }}\n[output]\nvtk_every = 0\n",
        arm + radius,
    );
    let directory = fresh_directory("pendulum");
    results(&legal(&text, &[]), &directory);
    let (time, x) = (column(&directory, "time"), column(&directory, "centre_x"));
    let lowest = x.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map(|(k, _)| time[k]);
    // Half a period later the disk is on the other side. The period of a pendulum grows with its angle by angle²/16 of
    // it; the disk stands 0.3 mm deep in the container.
    let half = lowest.expect("a lowest value");
    assert!((half / (0.5 * period) - 1.0).abs() < 0.02, "{half} {period}");
    let swing = x.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((swing / -centre[0] - 1.0).abs() < 0.02, "{swing}");
}

/// Two equal disks without gravity exchange their momentum, whichever of them is the slave.
#[test]
fn disks_that_collide_exchange_their_momentum() {
    let text = BODIES.replace("[0.0, -10.0]", "[0.0, 0.0]").replace("[0.5, 0.3]", "[0.22, 0.3]");
    let text = text.replacen("density  = 1000.0", "density  = 1000.0\ninitial_velocity = [1.0, 0.0]", 1);
    let text = text.replace("end  = 0.05", "end  = 0.08\nscheme = { kind = \"generalised-alpha\", rho_inf = 1.0 }");
    let directory = fresh_directory("collision");
    results(&legal(&format!("{text}[contact]\n{LAW}pairs = \"all\"\n"), &[]), &directory);
    let [soft, fine] = ["soft_centre_velocity_x", "fine_centre_velocity_x"].map(|name| column(&directory, name));
    let last = |values: &[f64]| *values.last().expect("steps");
    // The polygons differ, so that the masses do by 1 %.
    assert!(last(&soft).abs() < 0.15 && (last(&fine) - 1.0).abs() < 0.15, "{} {}", last(&soft), last(&fine));
    let forces = ["soft_contact_force_x", "fine_contact_force_x"].map(|name| column(&directory, name));
    assert!(forces[1].iter().any(|force| *force > 1.0), "they touch");
    for (a, b) in forces[0].iter().zip(&forces[1]) {
        assert!((a + b).abs() <= 1e-9 * a.abs(), "{a} {b}");
    }
    let gap = column(&directory, "fine_d_min").iter().copied().fold(f64::INFINITY, f64::min);
    assert!(gap > -0.01 && gap < 0.005, "{gap}");
}

/// A shape that is shifted is the shape at the other place, with curved edges too, and copies are bodies of their own.
#[test]
fn copies_are_bodies_at_other_places() {
    let changes = ["body.0.order=2", "body.0.copies=[[0.0, 0.4], [0.0, 0.8]]", "body.0.shift=[0.1, 0.0]"];
    let text = format!("{BODIES}[contact]\n{LAW}pairs = \"all\"\n");
    let copied = planar_case(&legal(&text, &[&changes]));
    let names: Vec<&str> = copied.setup.bodies.iter().map(|body| body.name()).collect();
    assert_eq!(names, ["soft", "soft-2", "soft-3", "fine", "stone", "floor"]);
    let placed = planar_case(&legal(&text, &[&["body.0.order=2", "body.0.shape.centre=[0.1, 0.7]"]]));
    let [copy, place] = [copied.setup.bodies[1].reference(), placed.setup.bodies[0].reference()];
    assert!(copy.len() == place.len() && copy.iter().zip(place).all(|(a, b)| (a - b).norm() < 1e-14));
    // Each two of the five that can move, each of them but the stone with itself, and with the floor.
    assert_eq!(copied.setup.contacts.len(), 10 + 4 + 5);
    let clash = text.replace("\"stone\"", "\"soft-2\"");
    refused(&clash, &[&["body.0.copies=[[0.0, 0.4]]"]], &["body.2.name", "the name of another body"]);
    // All vertices of a copy at the same place are on the surface of the body.
    for by in ["0.05", "0.0"] {
        let copies = format!("body.0.copies=[[{by}, 0.0]]");
        refused(&text, &[&[&copies]], &["`soft`", "behind the surface of `soft-2`"]);
    }
    refused(&text, &[&["body.0.copies=[0.05]"]], &["body.0.copies.0", "a list with a number for each axis"]);
}

/// Returns a contact with Nitsche's law and its defaults.
const NITSCHE: &str = "law = \"nitsche\"\nsize = 0.02\noffset = 0.005\n";

#[test]
fn the_slave_of_a_law_with_stress_is_elastic() {
    for (pair, expected) in [(["floor", "soft"], "soft"), (["stone", "fine"], "fine"), (["soft", "fine"], "fine")] {
        let contact = format!("pair = [\"{}\", \"{}\"]", pair[0], pair[1]);
        let case = planar_case(&legal(&format!("{BODIES}[contact]\n{NITSCHE}{contact}\n"), &[]));
        assert_eq!(roles(&case)[0].0, expected, "{pair:?}");
        let form = case.setup.contacts[0].form();
        let at = contact::ContactPoint { gap: 0.004, stiffness: 2.0, ..Default::default() };
        // The number 10 of the default times stiffness and penetration.
        assert!((form.law.traction(&at).value[0] + 10.0 * 2.0 * 0.001).abs() < 1e-15);
    }
    let words = ["nitsche", "stone", "rigid"];
    refused(&format!("{BODIES}[[contact]]\n{NITSCHE}pair = [\"stone\", \"floor\"]\n"), &[], &words);
    refused(&format!("{BODIES}[[contact]]\n{NITSCHE}pairs = \"all\"\n"), &[], &words);
}

/// A free block put on a slope holds still at the offset by its friction, and slides if the friction is small.
#[test]
fn a_free_block_sticks_to_a_slope_or_slides() {
    let text = BOUNCING.replace(BOUNCING_MATERIAL, "motion = { kind = \"free\" }");
    let slope = [
        "time={ step = 0.01, end = 0.2 }",
        "body.0.shape={ kind = \"box\", min = [0.0, 0.001], max = [2.0, 0.501], n = [2, 1] }",
        "body.0.gravity=[5.0, -8.660254037844386]",
        "body.0.initial_velocity=[0.0, 0.0]",
        "contact.0.law={ kind = \"augmented-lagrangian\", gamma_contact_0 = 1e9, friction = 0.7 }",
        "contact.0.offset=0.001",
        "output.vtk_every=0",
    ];
    let last = |sets: &[&str], name: &str| {
        let directory = fresh_directory("slope");
        results(&legal(&text, &[&slope, sets]), &directory);
        *column(&directory, name).last().expect("steps")
    };
    let exact = 0.2 * (5.0 - 0.3 * 8.660254037844386);
    let small = "contact.0.law.friction=0.3";
    assert!((last(&[small], "centre_velocity_x") - exact).abs() < 1e-5);
    assert!(last(&[], "centre_velocity_x").abs() < 1e-5);
    assert!((last(&[], "d_min") - 0.001).abs() < 1e-6);
    // The limit of friction of a light block is not lost in the tolerance of the distance.
    let light = ["body.0.density=1", small, "contact.0.law.gamma_contact_0=1e6", "contact.0.law.tolerance=1e-5"];
    let velocity = last(&light, "centre_velocity_x");
    assert!((velocity - exact).abs() < 1e-4, "{velocity}");
    refused(&text, &[&slope, &["contact.0.law.tolerance=0"]], &["contact.0.law.tolerance", "must be positive"]);
}

/// The force of a collision is the rate of the momentum minus the other forces, also with a solver that iterates.
#[test]
fn the_force_of_a_collision_is_that_of_the_balance() {
    let contact = r#"
[contact]
body     = "ball"
obstacle = { kind = "wall", parts = ["bottom"] }
law      = { kind = "collision", restitution = 0.7 }
size     = 0.05
offset   = 0.05
"#;
    let sets = [
        "time={ step = 0.004, end = 0.032, scheme = \"implicit-euler\" }",
        "fluid.body_force=[0.0, -100.0]",
        "body.0.shape.centre=[0.0, 0.57]",
        "body.0.initial_velocity=[0.0, -3.0]",
        "output.vtk_every=0",
    ];
    let directory = fresh_directory("collision-in-fluid");
    results(&legal(&format!("{SPHERE}{contact}"), &[&sets]), &directory);
    let tables = RunTables::read(&directory).expect("tables");
    let column = |name: &str| tables.column(name).expect("a column").into_iter().map(|(_, value)| value);
    let largest = column("contact_force").fold(0.0, f64::max);
    assert!(largest > 30.0, "{largest}");
    column("force_remainder").for_each(|remainder| assert!(remainder.abs() < 1e-5 * largest, "{remainder} {largest}"));
}

/// Equilibrium is found again although the motion of the step before would continue out of contact.
#[test]
fn a_block_rests_by_contact_alone_in_every_quasi_static_step() {
    let rest = [
        "time={ step = 1.0, end = 4.0, scheme = \"quasi-static\" }",
        "body.0.density=2",
        "contact.0.size=0.01",
        "contact.0.offset=0.1",
        "output.vtk_every=0",
    ];
    let low = ["body.0.shape.min=[0.0, 0.05]", "body.0.shape.max=[1.0, 0.55]"];
    let forces = |text: &str, place: &[&str], law: &str| {
        let directory = fresh_directory("rest");
        results(&legal(text, &[&rest, place, &[&format!("contact.0.law={{ kind = {law} }}")]]), &directory);
        let tables = RunTables::read(&directory).expect("tables");
        let forces =
            ["contact_force", "block_contact_force"].iter().find_map(|name| tables.column(name)).expect("a column");
        assert_eq!(forces.len(), 4);
        forces.iter().for_each(|(time, force)| assert!((force - 10.0).abs() < 1e-4, "{time}: {force}"));
    };
    let (text, nitsche) = (BOUNCING.replace("initial_velocity = [0.0, -1.0]\n", ""), "\"nitsche\", friction = 0.5");
    let elastic = text.replace(BOUNCING_MATERIAL, "material = { kind = \"linear\", young = 1e3, poisson = 0.0 }");
    forces(&elastic, &low, nitsche);
    let rigid = text.replace(BOUNCING_MATERIAL, "motion = { kind = \"free\", held = [\"x\", \"rotation\"] }");
    forces(&rigid, &low, "\"augmented-lagrangian\", gamma_contact_0 = 1e4");
    // The multipliers of the first solve, 1e-6 times the parameter, are larger than the pressure under a light block.
    let top = r#"
[[body]]
name    = "top"
shape   = { kind = "box", min = [0.2, 0.6], max = [0.8, 1.1], n = [4, 2] }
motion  = { kind = "free", held = ["x", "rotation"] }
density = 1e-6
gravity = [0.0, -10.0]

[[contact]]
pair   = ["top", "block"]
law    = { kind = "augmented-lagrangian", gamma_contact_0 = 1e6 }
size   = 0.01
offset = 0.05
"#;
    let exactly = [low[0], low[1], "contact.0.offset=0.05"];
    forces(&format!("{rigid}{top}"), &exactly, "\"augmented-lagrangian\", gamma_contact_0 = 1e6");
    // A floor that recedes ever faster. Contact holds the block up to 2.5e-4 above the offset.
    let floor = r#"
[[body]]
name   = "floor"
shape  = { kind = "box", min = [-1.0, -0.5], max = [2.0, 0.0], n = [6, 1] }
motion = { kind = "formula", displacement = ["0", "-1e-4*t*(t-1)"] }

[[contact]]
pair     = ["block", "floor"]"#;
    let plane = "obstacle = { kind = \"rigid-plane\", point = [0.0, 0.0], normal = [0.0, -1.0] }\n";
    let sinking = elastic.replace("[[contact]]\nbody     = \"block\"", floor).replace(plane, "");
    forces(&sinking, &["body.0.shape.min=[0.0, 0.0999]", "body.0.shape.max=[1.0, 0.5999]"], nitsche);
}

/// At the rim, points of the upright sides are at the limit of contact, and change by round-off in every iteration.
#[test]
fn a_block_in_space_is_pressed_evenly_in_few_iterations() {
    let text = r#"
name      = "pressed"
dimension = 3
units     = "si"
time      = { step = 0.5, end = 1.0, scheme = "quasi-static" }

[[body]]
name     = "block"
shape    = { kind = "box", min = [0.0, 0.0, 0.01], max = [1.0, 1.0, 1.01], n = [3, 3, 2] }
material = { kind = "linear", young = 1e3, poisson = 0.0 }
density  = 1.0
gravity  = [0.0, 0.0, 0.0]
boundary = { top = { kind = "traction", value = [0.0, 0.0, "-10*t"] }, left = "symmetry", front = "symmetry" }

[[contact]]
body     = "block"
obstacle = { kind = "rigid-plane", point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, -1.0] }
law      = "nitsche"
size     = 0.1
offset   = 0.0101
"#;
    let directory = fresh_directory("pressed");
    let summary = results(&legal(text, &[&["output.vtk_every=0"]]), &directory);
    let forces = RunTables::read(&directory).expect("tables").column("contact_force").expect("a column");
    forces.iter().for_each(|(time, force)| assert!((force - 10.0 * time).abs() < 1e-8, "{time}: {force}"));
    assert!(summary.newton_iterations < 20 && summary.divided_steps == 0, "{summary:?}");
}

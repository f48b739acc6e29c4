//! Bodies without a fluid: a scenario that has neither `[fluid]` nor `[background]` nor `[interface]`.

use std::path::Path;
use std::sync::Arc;

use crate::setting::*;
use io::{RunTables, ScenarioFile, Summary, run, sizes};
use mesh::generate::structured_box;
use mesh::{BodyId, Point, Vector};
use solid_svk::{ElasticBody, ElasticOptions, LameParameters, SaintVenantKirchhoff, SolidForm, SolidMesh};
use solver::algebra::time::GeneralisedAlpha;
use solver::algebra::{NewtonSettings, Workspace};
use solver::body::Body;
use solver::contact::{ContactForm, PenaltyLaw, RigidPlane};
use solver::{Contact, ContactObstacle, Setup, State, StepReport, Substep, advance};

const DT: f64 = 1e-3;
const N_STEPS: usize = 60;

/// Returns the block of the scenario, built from the library.
fn block() -> Setup<2> {
    let mesh = structured_box([0.0, 0.01], [1.0, 0.51], [4, 2]).expect("a box");
    let material = SaintVenantKirchhoff::new(LameParameters { mu: 4e5, lambda: 1.6e6 });
    let form = SolidForm::new(1000.0, material, Vector::<2>::new(0.0, -10.0)).expect("a form");
    let options = ElasticOptions {
        initial_velocity: Some(Arc::new(|_| Vector::<2>::new(0.0, -1.0))),
        ..ElasticOptions::default()
    };
    let solid = SolidMesh::new(mesh).expect("a mesh");
    let body: Arc<dyn Body<2>> = Arc::new(ElasticBody::new("block", solid, form, options).expect("a body"));
    let facets = body.surface().facets().collect();
    let bodies = vec![body];
    let plane = RigidPlane::new(Point::<2>::zeros(), Vector::<2>::new(0.0, -1.0)).expect("a plane");
    let form = ContactForm::new(PenaltyLaw::new(1e6, 0.005).expect("a law"), 0.1).expect("a size");
    let contact = Contact::new(&bodies, BodyId(0), facets, form, ContactObstacle::Rigid(Box::new(plane)));
    let contacts = vec![contact.expect("a contact")];
    Setup {
        fluid: None,
        bodies,
        contacts,
        scheme: Arc::new(GeneralisedAlpha::new(0.0).expect("the scheme of a scenario without `time.scheme`")),
        dt: DT,
        most_halvings: 0,
        approach: None,
        newton: NewtonSettings::new(1e-10),
    }
}

fn reports(setup: &Setup<2>) -> Vec<StepReport<2>> {
    let (mut state, mut work) = (State::initial(setup).expect("a state"), Workspace::new());
    let mut step = || {
        let (next, report) = advance(setup, &state, Substep::whole(DT), &mut work).expect("a step");
        state = next;
        report
    };
    (0..N_STEPS).map(|_| step()).collect()
}

#[test]
fn a_block_without_a_fluid_moves_as_in_the_library() {
    let directory = fresh_directory("run");
    let summary = results(&legal(BOUNCING, &[]), &directory);
    let column = |name: &str| column(&directory, name);
    let reports = reports(&block());
    let check = |name: &str, of: fn(&StepReport<2>) -> f64| {
        assert_eq!(column(name), reports.iter().map(of).collect::<Vec<f64>>(), "{name}");
    };
    check("centre_y", |r| r.bodies[0].balance.as_ref().map_or(f64::NAN, |b| b.centre_of_mass[1]));
    check("energy_kinetic_solid", |r| r.bodies[0].balance.as_ref().map_or(f64::NAN, |b| b.kinetic_energy));
    check("energy_elastic", |r| r.bodies[0].balance.as_ref().map_or(f64::NAN, |b| b.elastic_energy));
    check("energy_gravity", |r| r.bodies[0].balance.as_ref().map_or(f64::NAN, |b| b.potential_energy));
    check("energy_contact", |r| r.contacts[0].stored_energy);
    check("contact_force", |r| r.contacts[0].force[1]);
    check("active_points", |r| r.contacts[0].n_active as f64);
    check("max_penetration", |r| r.contacts[0].largest_penetration);
    check("dofs", |r| r.n_dofs as f64);
    // There is no fluid.
    for name in ["energy_kinetic_fluid", "leak_net", "force_y", "torque", "smallest_fraction"] {
        assert!(column(name).iter().all(|value| *value == 0.0), "{name}");
    }
    // The block falls freely through the distance from gap to offset, is stopped, and thrown back.
    let force = column("contact_force");
    assert!(force[..4].iter().all(|f| *f == 0.0) && force.iter().any(|f| *f > 1e4), "{force:?}");
    let velocity = column("centre_velocity");
    assert!((velocity[0] + 1.0 + 10.0 * DT).abs() < 1e-9 && velocity[N_STEPS - 1] > 0.1, "{velocity:?}");
    let (contact, release) = (summary.contact_time.expect("contact"), summary.release_time.expect("release"));
    assert!(contact > 3.5e-3 && contact < 7e-3 && release > contact + 0.01 && release < 0.06, "{contact} {release}");
    assert!(summary.energy_monotone && summary.max_penetration > 0.0, "{summary:?}");
    assert_eq!((summary.steps, summary.divided_steps, summary.cells), (N_STEPS, 0, 0));
    assert_eq!(
        (summary.leading.as_deref(), summary.stabilisation.as_str(), summary.half_domain),
        (Some("block"), "", false)
    );
    assert_eq!((summary.dofs, summary.max_interface_leak), (2 * 15, None));
    assert_eq!(Summary::read(&directory.join("summary.json")).expect("a summary"), summary);
}

#[test]
fn generated_energy_is_that_of_the_tables_whatever_the_origin() {
    let generated = |height: f64| {
        let place = [
            format!("body.0.shape.min.1={}", 0.01 + height),
            format!("body.0.shape.max.1={}", 0.51 + height),
            format!("contact.0.obstacle.point.1={height}"),
        ];
        let set = place.each_ref().map(String::as_str);
        let directory = fresh_directory(&format!("moved-by-{height}"));
        let summary = results(
            &legal(BOUNCING, &[&set, &["time.scheme={ kind = \"generalised-alpha\", rho_inf = 0.9 }"]]),
            &directory,
        );
        (summary.energy_generated.expect("steps"), directory)
    };
    let (near, directory) = generated(0.0);
    let tables = RunTables::read(&directory).expect("tables");
    let column =
        |name: &str| -> Vec<f64> { tables.column(name).expect(name).into_iter().map(|(_, value)| value).collect() };
    // At the start the block has the mass 500 kg/m, the velocity 1 m/s and the height 0.26 m.
    let (kinetic, at_start) = (250.0, 1300.0);
    let energies = ["energy_kinetic_solid", "energy_elastic", "energy_contact", "energy_gravity"].map(column);
    let sum = |k: usize| energies[..3].iter().map(|of| of[k]).sum::<f64>() + (energies[3][k] - at_start).abs();
    let largest = (0..N_STEPS).map(sum).fold(kinetic, f64::max);
    let total = [vec![kinetic + at_start], column("total_energy")].concat();
    let stored = column("lost_scheme_storage");
    let gains = total.windows(2).zip(&stored).map(|(total, stored)| (total[1] - total[0] + stored).max(0.0));
    let expected = gains.sum::<f64>() / largest;
    assert!(expected > 1e-4 && (near / expected - 1.0).abs() < 1e-3, "{near} {expected}");
    // At a height of a kilometre the energy of gravity is 5e6 J/m.
    let (far, _) = generated(1000.0);
    assert!((far / near - 1.0).abs() < 1e-2, "{near} {far}");
}

#[test]
fn a_body_at_rest_generates_no_energy() {
    let set = [
        "body.0.shape.min.1=0.1",
        "body.0.shape.max.1=0.2",
        "contact.0.law={ kind = \"augmented-lagrangian\", gamma_contact_0 = 1e9 }",
        "contact.0.size=0.1",
        "contact.0.offset=0.1",
        "time.step=1e-3",
        "time.end=0.06",
    ];
    let directory = fresh_directory("at-rest");
    let summary = results(&legal(THIN, &[&set]), &directory);
    // Energies are round-off, and would be of the size of their own largest value.
    let kinetic = column(&directory, "energy_kinetic_solid").into_iter().fold(0.0, f64::max);
    assert!(kinetic < 1e-6, "{kinetic}");
    assert!(summary.energy_monotone && summary.energy_generated == Some(0.0), "{summary:?}");
    assert!(summary.energy_defect.is_some_and(|defect| defect < 10.0), "{summary:?}");
    let has_time = summary.timings.iter().any(|timing| timing.task == "multipliers" && timing.seconds > 0.0);
    assert!(has_time, "{summary:?}");
}

/// A rigid block over a thin plate at rest.
const THIN: &str = r#"
name      = "thin"
dimension = 2
units     = "si"

[time]
step = 0.002
end  = 0.6

[[body]]
name    = "block"
shape   = { kind = "box", min = [0.0, 0.5], max = [0.1, 0.6], n = [2, 2] }
motion  = { kind = "free" }
density = 1000.0
gravity = [0.0, -10.0]

[[contact]]
body     = "block"
law      = { kind = "penalty", gamma_contact_0 = 1.0e5 }
size     = 0.005
offset   = 0.001
obstacle = { kind = "shape", shape = { kind = "box", min = [-1.0, -0.01], max = [1.0, 0.0], n = [20, 1] } }

[output]
vtk_every = 0

[solver]
linear = { kind = "direct" }
"#;

#[test]
fn a_body_does_not_pass_through_a_thin_plate() {
    let law = "contact.0.law={ kind = \"collision\", restitution = 0.5 }";
    // The plate is 1 cm thick; the block falls 0.5 m and moves by up to 6 cm in a step.
    let directory = fresh_directory("thin");
    let summary = results(&legal(THIN, &[&[law, "time.step=0.02"]]), &directory);
    assert!(summary.divided_steps > 0, "{summary:?}");
    // A collision is not a loss by the time scheme.
    assert!(summary.energy_lost_in_contact.is_some_and(|lost| lost.abs() < 1e-9), "{summary:?}");
    assert!(column(&directory, "centre_y").iter().all(|y| *y > 0.04), "{:?}", column(&directory, "centre_y"));
    for law in [law, "contact.0.law={ kind = \"penalty\", gamma_contact_0 = 1e5 }"] {
        let file = legal(THIN, &[&[law, "time.step=0.05", "time.most_halvings=0"]]);
        let error = run(&file, &fresh_directory("through"), &mut ()).expect_err("a passage");
        let io::Error::Step(step) = &error else { panic!("{error}") };
        assert!(
            matches!(step.source, solver::Error::PassedThrough { contact: 0, motion, .. } if motion > 0.1),
            "{error:?}"
        );
    }
    // Short steps resolve the contact.
    let summary = results(&legal(THIN, &[&["time.step=5e-4"]]), &fresh_directory("resolved"));
    assert!(summary.divided_steps == 0 && summary.release_time.is_some(), "{summary:?}");
}

#[test]
fn energy_that_contact_stores_at_the_start_is_not_generated() {
    // The block weighs 100 N/m. Its contact has this force at the penetration 0.05 mm.
    let set = ["body.0.shape.min.1=9.5e-4", "body.0.shape.max.1=0.10095", "time.end=0.1"];
    let directory = fresh_directory("begins-in-contact");
    let summary = results(&legal(THIN, &[&set]), &directory);
    let stored = column(&directory, "energy_contact");
    assert!((stored[0] - 0.5 * 100.0 * 5e-5).abs() < 5e-5, "{stored:?}");
    let generated = summary.energy_generated.expect("steps");
    // The first steps are not exact, and move the block by micrometres.
    assert!(generated < 0.1, "{generated:e}");
}

/// Two elastic disks that collide off their centres.
const COLLISION: &str = r#"
name = "collision"
dimension = 2
units = "si"
time = { step = 1e-3, end = 0.025, scheme = { kind = "generalised-alpha", rho_inf = 1.0 } }
output = { vtk_every = 0 }

[[body]]
name = "left"
shape = { kind = "ball", centre = [-0.051, 0.0], radius = 0.05, size = 0.0125 }
material = { kind = "neo-hookean", young = 1e6, poisson = 0.3 }
density = 1000.0
gravity = [0.0, 0.0]
initial_velocity = [0.5, 0.0]

[[body]]
name = "right"
shape = { kind = "ball", centre = [0.051, 0.03], radius = 0.05, size = 0.0125 }
material = { kind = "neo-hookean", young = 1e6, poisson = 0.3 }
density = 1000.0
gravity = [0.0, 0.0]
initial_velocity = [-0.5, 0.0]

[[contact]]
pair = ["left", "right"]
law = { kind = "penalty", gamma_contact_0 = 1e7 }
size = 0.0125
offset = 0.0
"#;

/// Checks that a collision of two bodies keeps its energy with the penalty. Nitsche's law takes energy in the impact,
/// and what it gives back while the bodies part is not generated.
#[test]
fn a_collision_generates_no_energy() {
    let collision = |changes: &[&str], name: &str| {
        let directory = fresh_directory(name);
        let summary = results(&legal(COLLISION, &[changes]), &directory);
        assert!(summary.release_time.is_some(), "{summary:?}");
        let tables = RunTables::read(&directory).expect("tables");
        let column =
            |name: &str| -> Vec<f64> { tables.column(name).expect(name).into_iter().map(|(_, value)| value).collect() };
        let (total, stored) = (column("total_energy"), column("lost_scheme_storage"));
        let gains = total.windows(2).zip(&stored[1..]).map(|(total, stored)| (total[1] - total[0] + stored).max(0.0));
        let change = (total[total.len() - 1] - total[0]) / total[0];
        (change, gains.sum::<f64>() / total[0], summary.energy_generated.expect("steps"))
    };
    let (change, _, generated) = collision(&[], "penalty");
    assert!(change.abs() < 2e-3 && generated < 2e-3, "{change:e} {generated:e}");
    // The elasticity of the bodies generates 1.06e-4 in steps without contact, which the first bound, 1e-6, left out.
    let (change, gains, generated) = collision(&["contact.0.law=\"nitsche\""], "nitsche");
    assert!(change < 0.0 && gains > 5e-3 && generated < 1e-3, "{change:e} {gains:e} {generated:e}");
}

/// A flap that stands on the ground. Its foot is clamped there, and is not in contact.
#[test]
fn steps_do_not_follow_gaps_of_clamped_parts() {
    let sets = [
        "body.0.shape.min=[0.0, 0.0]",
        "body.0.initial_velocity=[0.0, 0.0]",
        "body.0.boundary.bottom=clamped",
        "time.approach.smallest=1e-6",
        "time.end=0.004",
    ];
    let directory = fresh_directory("flap");
    results(&legal(BOUNCING, &[&sets]), &directory);
    assert_eq!(column(&directory, "time").len(), 4);
}

#[test]
fn a_guided_body_has_the_motion_of_its_guide() {
    let guided = |velocity: &str, more: &str| {
        THIN.replace(
            "{ kind = \"free\" }",
            &format!("{{ kind = \"free\", guided = {{ until = 0.3, velocity = [\"{velocity}\", \"0\"] }}{more} }}"),
        )
    };
    let directory = fresh_directory("guided");
    results(&legal(&guided("2", ""), &[&["time.end=0.1"]]), &directory);
    let x = column(&directory, "centre_x");
    assert!((x[x.len() - 1] - 0.25).abs() < 1e-12, "{x:?}");
    let begins = "begins with the velocity of its guide";
    refused(&guided("2", ""), &[&["body.0.initial_velocity=[1, 0]"]], &["body.0.initial_velocity", begins]);
    refused(&guided("2", ", initial_spin = 1"), &[], &["initial_spin", begins]);
    // Only the velocity counts, until the release and the end of the step in which it is.
    legal(&guided("sqrt(0.35 - t)", ""), &[]);
    legal(&guided("min(t/0.0001, 1)", ""), &[]);
    refused(&guided("sqrt(0.25 - t)", ""), &[], &["guided.velocity.0", "NaN"]);
    legal(&guided("0", ", held = [\"x\", \"rotation\"]"), &[]);
}

#[test]
fn a_body_in_space_turns_about_the_axis_of_its_initial_spin() {
    let text = r#"
name      = "turning"
dimension = 3
units     = "si"
time      = { step = 0.05, end = 0.5 }
output    = { vtk_every = 0 }

[[body]]
name    = "cube"
shape   = { kind = "box", min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0], n = [1, 1, 1] }
motion  = { kind = "free", initial_spin = [1.0, -2.0, 2.0] }
density = 6.0
gravity = [0.0, 0.0, 0.0]
"#;
    let directory = fresh_directory("turning");
    let spin = |text: &str| {
        results(&legal(text, &[]), &directory);
        ["spin_x", "spin_y", "spin_z", "energy_kinetic_solid"].map(|name| column(&directory, name))
    };
    // A cube turns steadily about any axis; its moment of inertia is `m a²/6 = 1`.
    for (given, exact) in [("[1.0, -2.0, 2.0]", [1.0, -2.0, 2.0, 4.5]), ("3.0", [0.0, 0.0, 3.0, 4.5])] {
        for (found, exact) in spin(&text.replace("[1.0, -2.0, 2.0]", given)).iter().zip(exact) {
            assert!(found.len() == 10 && found.iter().all(|value| (value - exact).abs() < 1e-9), "{found:?}");
        }
    }
    let refuse = |given: &str, words: &[&str]| refused(&text.replace("[1.0, -2.0, 2.0]", given), &[], words);
    refuse("[1.0, 2.0]", &["body.0.motion.initial_spin", "2 components", "dimension = 3"]);
    refuse("\"3\"", &["body.0.motion.initial_spin", "a number, or in space a list with a number for each axis"]);
    refuse("[20, 0, 20]", &["body.0.motion.initial_spin", "turns by 1.41 rad in a step"]);
    refuse("[0, 1, 0], held = [\"rotation\"]", &["initial_spin", "no effect with a rotation that is held"]);
    refused(&THIN.replace("\"free\"", "\"free\", initial_spin = [0, 0]"), &[], &["initial_spin", "give a number"]);
}

#[test]
fn only_the_body_has_field_files() {
    let directory = fresh_directory("fields-of-dry-block");
    results(&legal(BOUNCING, &[]), &directory);
    for series in ["fluid", "rigid", "interface"] {
        assert!(!directory.join(format!("{series}.pvd")).exists(), "{series}");
    }
    let files = std::fs::read_dir(directory.join("vtk")).expect("a directory");
    let mut names: Vec<String> =
        files.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    let of_series = |series: &str| [0, 20, 40, 60].map(|step| format!("{series}_{step:06}.vtu"));
    assert_eq!(names, [of_series("solid"), of_series("surface")].concat());
    let index = std::fs::read_to_string(directory.join("solid.pvd")).expect("an index");
    assert_eq!(index.matches("file=").count(), 4);
    // The scenario that was left can be read again.
    let again = ScenarioFile::read(&directory.join("scenario.toml"), &[]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.scenario(), legal(BOUNCING, &[]).scenario());
}

#[test]
fn sizes_are_those_of_the_body() {
    let sizes = sizes(&legal(BOUNCING, &[])).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(sizes.bodies, [("block".to_owned(), 16, 15)]);
    assert_eq!((sizes.background_cells, sizes.background_vertices, sizes.cut_cells), (0, 0, 0));
    assert_eq!((sizes.dofs, sizes.n_steps, sizes.half_domain), (2 * 15, N_STEPS, false));
}

#[test]
fn a_body_does_not_begin_behind_its_obstacle() {
    let plane = "contact.0.obstacle.point=[0.0, 0.2]";
    refused(BOUNCING, &[&[plane]], &["contact.0.obstacle", "body `block` is 1.900e-1 m behind this obstacle"]);
    let wall = "[[body]]\nname = \"wall\"\nmotion = \"fixed\"\nshape = { kind = \"box\", min = [-1.0, 0.1], max = [0.0, 0.2], n = [1, 1] }";
    let (text, against) = (format!("{BOUNCING}{wall}"), "contact.0.obstacle={ kind = \"body\", name = \"wall\" }");
    assert!(sizes(&legal(&text, &[&[against]])).is_ok(), "they touch");
    // No vertex of the block lies in the wall.
    refused(&text, &[&[against, "body.1.shape.max.0=0.05"]], &["body `block` is 5.000e-2 m behind"]);
    assert!(sizes(&legal(&text, &[&["body.1.shape.max.0=0.05"]])).is_ok(), "no contact acts between them");
}

#[test]
fn gravity_is_a_number_a_formula_or_a_table_over_time() {
    let directory = fresh_directory("gravity");
    std::fs::write(directory.join("gravity.csv"), "t,x,g\n0,0,-10\n1,1,-10\n").expect("a writable directory");
    let run = |name: &str, gravity: &str| {
        let folder = directory.join(name);
        let text = BOUNCING.replace("gravity          = [0.0, -10.0]", &format!("gravity = [0.0, {gravity}]"));
        let file = parse_at(&directory.join("case.toml"), &text, &[]).unwrap_or_else(|error| panic!("{error}"));
        results(&file, &folder);
        ["centre_y", "energy_gravity"].map(|of| column(&folder, of))
    };
    let [height, potential] = run("number", "-10.0");
    for (name, gravity) in
        [("formula", "\"-10 + 0*t\""), ("table", "{ kind = \"table\", file = \"gravity.csv\", column = \"g\" }")]
    {
        let [found, none] = run(name, gravity);
        assert!(height.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-12), "{name}: {found:?} {height:?}");
        // A constant has a potential, all else is a load.
        assert!(none.iter().all(|energy| *energy == 0.0) && potential.iter().all(|energy| *energy != 0.0));
    }
    let [found, _] = run("upwards", "\"-10 + 1000*t\"");
    assert!(found.last() > height.last());
    for (gravity, words) in [
        ("\"-10*x\"", ["body.0.gravity", "`x`"]),
        ("\"-10/t\"", ["body.0.gravity.1", "the value of the formula `-10/t` at t = 0"]),
        (
            "{ kind = \"table\", file = \"gravity.csv\", column = \"g\", over = \"x\" }",
            ["body.0.gravity.1", "its table is over x"],
        ),
    ] {
        let text = BOUNCING.replace("-10.0]", &format!("{gravity}]"));
        check_words(&mistake(parse_at(&directory.join("case.toml"), &text, &[])).to_string(), &words);
    }
}

/// Checks the example of two bars on cells of five times its size: waves that pass 20 cells along a bar are smeared
/// over about one of them.
#[test]
fn equal_bars_that_collide_exchange_their_velocities() {
    const BARS: &str = include_str!("../../../../examples/colliding-bars.toml");
    let coarse = ["body.0.shape.size=0.05", "body.1.shape.size=0.05", "time.step=2e-4"];
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bars");
    let summary = run(&legal(BARS, &[&coarse]), &directory, &mut ()).expect("a run");
    let tables = RunTables::read(&directory).expect("its results");
    let column = |name: &str| tables.column(name).expect("a column");
    let last = |name: &str| column(name).last().expect("a step").1;
    assert!(last("left_centre_velocity_x").abs() < 0.02 * 0.1);
    assert!((last("right_centre_velocity_x") - 0.1).abs() < 0.02 * 0.1);
    let force = column("right_contact_force_x");
    let touching: Vec<_> = force.iter().filter(|(_, force)| *force != 0.0).collect();
    let duration = touching.last().expect("contact").0 - touching[0].0;
    assert!((duration - 0.02).abs() < 0.05 * 0.02, "{duration}");
    // Half the speed times impedance and cross section: 0.05 m/s · 1000 kg/m³ · 100 m/s · 0.1 m.
    let mean = touching.iter().map(|(_, force)| force).sum::<f64>() / touching.len() as f64;
    assert!((mean - 500.0).abs() < 0.05 * 500.0, "{mean}");
    assert!((tables.end() - 0.03).abs() < 1e-9);
    // Only the time scheme takes energy from the bars; it stores a part of it in accelerations.
    let parts =
        ["left_energy_kinetic_solid", "left_energy_elastic", "right_energy_kinetic_solid", "right_energy_elastic"];
    let energy = |time: f64| {
        let at = |name: &str| column(name).iter().rfind(|(t, _)| *t < time + 1e-9).expect("a step").1;
        parts.iter().chain(&["energy_contact"]).map(|name| at(name)).sum::<f64>()
    };
    let [before, after] = [touching[0].0 - 2e-4, touching[touching.len() - 1].0].map(energy);
    let lost = summary.energy_lost_in_contact.expect("inertia");
    assert!(lost > 1e-3 && (lost * before / (before - after) - 1.0).abs() < 0.15, "{lost} {before} {after}");
}

/// A block on wheels along the floor whose left side is clamped, and a half disk on its axis.
#[test]
fn held_parts_do_not_move_at_the_start() {
    let with = |shape: &str, more: &str| {
        let text = format!(
            "name = \"held\"\ndimension = 2\nunits = \"si\"\ntime = {{ step = 0.01, end = 0.05 }}\n{more}\n[[body]]\nname = \"block\"\nshape = {shape}\n\
             material = {{ kind = \"linear\", young = 1e3, poisson = 0.3 }}\ndensity = 1.0\ngravity = [0, 0]\ninitial_velocity = [1.0, 2.0]\n"
        );
        let case = planar_case(&legal(&text, &[]));
        let body = &case.setup.bodies[0];
        body.reference().iter().copied().zip(body.initial().velocity().to_vec()).collect::<Vec<_>>()
    };
    let block = "{ kind = \"box\", min = [0, 0], max = [1, 1], n = [2, 2] }\nboundary = { left = \"clamped\", bottom = \"symmetry\" }";
    for (x, v) in with(block, "") {
        let expected = [if x[0] == 0.0 { 0.0 } else { 1.0 }, if x[0] == 0.0 || x[1] == 0.0 { 0.0 } else { 2.0 }];
        assert_eq!(v.as_slice(), expected, "{x}");
    }
    let ball = "{ kind = \"half-ball\", centre = [0, 0], radius = 1, size = 0.5 }";
    for (x, v) in with(ball, "coordinates = \"axisymmetric\"") {
        assert_eq!(v[0], if x[0] == 0.0 { 0.0 } else { 1.0 }, "{x}");
    }
}

/// Positions in the formulas of a body are those before its shift.
#[test]
fn copies_have_the_formulas_of_the_first_body() {
    let text = r#"
name      = "copies"
dimension = 2
units     = "si"
time      = { step = 0.01, end = 0.03 }

[[body]]
name             = "block"
shape            = { kind = "box", min = [0, 0], max = [1, 1], n = [2, 2] }
material         = { kind = "linear", young = 1e3, poisson = 0.3 }
density          = 1.0
gravity          = [0, 0]
initial_velocity = ["x", "y"]
boundary         = { left = { kind = "displacement", value = ["y*t", "0"] }, right = { kind = "traction", value = ["x*y", "1"] } }
copies           = [[3, 5]]
"#;
    let directory = fresh_directory("copies");
    results(&legal(text, &[]), &directory);
    for name in ["centre_velocity_x", "centre_velocity", "energy_elastic"] {
        let [first, copy] = ["block", "block-2"].map(|body| column(&directory, &format!("{body}_{name}")));
        assert!(first[2].abs() > 1e-3 && (first[2] - copy[2]).abs() < 1e-10, "{name}: {} {}", first[2], copy[2]);
    }
}

/// The acceleration of a guide ends with it: a block at rest until 0.4 falls freely then, and keeps the speed that it
/// was given.
#[test]
fn a_released_body_moves_freely() {
    let guided = "{ kind = \"free\", guided = { until = 0.4, velocity = [\"t\", 0] } }";
    let text = THIN.replace("{ kind = \"free\" }", guided);
    let directory = fresh_directory("release");
    results(&legal(&text, &[&["time.step=0.05"]]), &directory);
    let last = |name: &str| *column(&directory, name).last().expect("a step");
    // The velocity of the guide ends at 0.4.
    assert!((last("centre_velocity_x") - 0.4).abs() < 1e-9, "{}", last("centre_velocity_x"));
    assert!((last("centre_velocity") + 2.0).abs() < 1e-9, "{}", last("centre_velocity"));
    assert!((last("centre_y") - (0.55 - 0.5 * 10.0 * 0.04)).abs() < 1e-9, "{}", last("centre_y"));
}

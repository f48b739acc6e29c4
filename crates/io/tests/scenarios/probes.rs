//! Probes: quantities with names of their own, compared with known flows and motions.

use crate::setting::*;
use io::{HistoryTable, name_and_unit};

/// A linear flow in a box, through which a body moves.
const FLOW: &str = r#"
name      = "probed"
dimension = 2
units     = "si"

[time]
step = 0.02
end  = 0.1

[fluid]
density          = 1.0
viscosity        = 1.0
convection       = "none"
initial_velocity = ["1 + 2*x", "3 - 2*y"]

[background]
kind     = "graded-box"
min      = [0.0, 0.0]
max      = [2.0, 1.0]
size     = 0.2
boundary = { left = VELOCITY, right = { kind = "traction", value = [4, 0] }, bottom = VELOCITY, top = VELOCITY }

[output]
vtk_every = 5

[output.probes]
middle  = { kind = "point", at = [1.0, 0.5] }
through = { kind = "flux", corner = [1.5, 0.0], sides = [[0.0, 1.0]] }
up      = { kind = "flux", corner = [1.5, 0.25], sides = [[-1.0, 0.0]], points = 50 }
along   = { kind = "line", from = [0.0, 0.5], to = [2.5, 0.5], points = 6 }
above   = { kind = "wall-force", parts = ["top"] }
before  = { kind = "wall-force", parts = ["left"], about = [0.0, 1.0] }
"#;

fn flow() -> String {
    FLOW.replace("VELOCITY", "{ kind = \"velocity\", value = [\"1 + 2*x\", \"3 - 2*y\"] }")
}

fn last(table: &HistoryTable, name: &str) -> f64 {
    let column = table.column(name).unwrap_or_else(|| panic!("no column {name} in {:?}", table.names()));
    column[column.len() - 1]
}

#[test]
fn points_sections_and_lines_see_the_flow() {
    let directory = fresh_directory("flow");
    results(&legal(&flow(), &[]), &directory);
    let probes = probes(&directory);
    // With the start.
    assert_eq!(probes.n_rows(), 6);
    let names =
        ["time [s]", "along_x [m]", "middle_velocity_x [m/s]", "middle_pressure [Pa]", "through_flux [m³/(s m)]"];
    assert!(probes.names().contains(&names[0].to_owned()) && !probes.names().contains(&names[1].to_owned()));
    assert!(names[2..].iter().all(|name| probes.names().contains(&(*name).to_owned())), "{:?}", probes.names());
    for (name, value) in [
        ("middle_velocity_x", 3.0),
        ("middle_velocity_y", 2.0),
        ("middle_pressure", 0.0),
        // To the right of the way up, and of the way to the left.
        ("through_flux", 4.0),
        ("up_flux", 2.5),
        // Minus the stress `diag(4, -4)` times the normal and the length; nothing from the sides at their ends.
        ("above_x", 0.0),
        ("above_y", 8.0),
        ("before_x", 4.0),
        ("before_y", 0.0),
        // Uniform tractions act in the middles of the sides.
        ("above_moment_z", 8.0),
        ("before_moment_z", 2.0),
    ] {
        assert!((last(&probes, name) - value).abs() < 1e-6, "{name}: {}", last(&probes, name));
    }
    let line = HistoryTable::read(&directory.join("lines/along_000005.csv")).unwrap_or_else(|e| panic!("{e}"));
    let column = |name: &str| line.column(name).unwrap_or_else(|| panic!("{name} in {:?}", line.names()));
    assert_eq!(column("x"), [0.0, 0.5, 1.0, 1.5, 2.0, 2.5]);
    let along = column("velocity_x");
    assert!((0..5).all(|k| (along[k] - (1.0 + k as f64)).abs() < 1e-6) && along[5].is_nan(), "{along:?}");
    // A run without probes leaves none of an earlier one.
    let (without, _) = FLOW.split_once("[output]").unwrap_or_else(|| panic!("an output"));
    let without = without.replace("VELOCITY", "{ kind = \"velocity\", value = [\"1 + 2*x\", \"3 - 2*y\"] }");
    let measured = directory.join("lines/measured_2020.csv");
    std::fs::write(&measured, "time,pressure\n0,1\n").expect("a writable directory");
    results(&legal(&without, &[]), &directory);
    assert!(!directory.join("probes.csv").exists() && !directory.join("lines/along_000005.csv").exists());
    assert!(measured.exists(), "files of others stay");
}

/// A flow through a tube by the pressure 6, on a coarse mesh, almost without inertia.
const TUBE: &str = r#"
name      = "tube"
dimension = 2
units     = "si"
time      = { step = 1.0, end = 2.0 }
fluid     = { density = 1e-10, viscosity = 1.0, convection = "none" }

[background]
kind     = "graded-box"
min      = [0.0, 0.0]
max      = [2.0, 1.0]
size     = 0.5
boundary = { left = { kind = "pressure", value = 6 }, right = "parallel", bottom = "no-slip", top = "no-slip" }

[output]
vtk_every = 0
probes.wall = { kind = "wall-force", parts = ["bottom", "top"] }
probes.half = { kind = "wall-force", parts = ["top"] }
"#;

/// Checks that the force on the wall is the drop of the pressure times the section, whatever the size of the cells.
#[test]
fn the_force_on_the_wall_of_a_tube_balances_the_pressure() {
    let round = [
        "coordinates=axisymmetric",
        "background.boundary={ bottom = { kind = \"pressure\", value = 6 }, top = \"parallel\", left = \"symmetry\", right = \"no-slip\" }",
        "output.probes.wall.parts=[\"right\"]",
        "output.probes.half.parts=[\"right\"]",
    ];
    let square = [
        "dimension=3",
        "background.min=[0, 0, 0]",
        "background.max=[2, 1, 1]",
        "background.boundary.front=no-slip",
        "background.boundary.back=no-slip",
        "output.probes.wall.parts=[\"bottom\", \"top\", \"front\", \"back\"]",
    ];
    let disk = 4.0 * std::f64::consts::PI;
    for (name, sets, along, [wall, half]) in [
        ("plane", &[][..], "x", [6.0, 3.0]),
        ("round", &round[..], "y", [6.0 * disk, 6.0 * disk]),
        ("square", &square[..], "x", [6.0, 1.5]),
    ] {
        let directory = fresh_directory(&format!("tube-{name}"));
        results(&legal(TUBE, &[sets]), &directory);
        let probes = probes(&directory);
        let found = ["wall", "half"].map(|probe| last(&probes, &format!("{probe}_{along}")));
        assert!((found[0] / wall - 1.0).abs() < 1e-7, "{name}: {found:?}");
        // The mesh is not symmetric, so that halves differ by the error of the cells.
        assert!((found[1] / half - 1.0).abs() < 0.1, "{name}: {found:?}");
    }
}

#[test]
fn stokes_flow_between_two_pressures_has_the_exact_flux_for_any_density() {
    let sets = [
        "time={ step = 1.0, end = 5.0, scheme = \"quasi-static\" }",
        "background.size=0.2",
        "background.boundary.right={ kind = \"pressure\", value = 0 }",
        "output.probes={ section = { kind = \"flux\", corner = [1.0, 0.0], sides = [[0.0, 1.0]] } }",
    ];
    let flux = |density: &str| {
        let directory = fresh_directory(density);
        results(&legal(TUBE, &[&sets, &[density]]), &directory);
        last(&probes(&directory), "section_flux")
    };
    let [heavy, light] = ["fluid.density=30.0", "fluid.density=3e-5"].map(flux);
    // The gradient of the pressure over twelve viscosities.
    let exact = 3.0 / 12.0;
    // The weights of stabilisations depend on the density, and make a difference of a percent on this mesh.
    assert!([heavy, light].iter().all(|flux| (flux / exact - 1.0).abs() < 0.05), "{heavy} {light} {exact}");
}

/// A uniform stream along the axis with the pressure `10 (1 - z)`, in which a ball is held.
const STREAM: &str = r#"
name        = "stream"
dimension   = 2
coordinates = "axisymmetric"
units       = "si"

[time]
step = 0.1
end  = 0.1

[fluid]
density          = 1.0
viscosity        = 1.0
convection       = "none"
initial_velocity = [0, 3]
body_force       = [0, -10]

[background]
kind     = "graded-box"
min      = [0.0, 0.0]
max      = [1.0, 1.0]
size     = 0.25
boundary = { left = "symmetry", right = STREAM, bottom = STREAM, top = "free" }

[output]
vtk_every = 0

[output.probes]
disk = { kind = "flux", corner = [0.8, 0.5], sides = [[-0.8, 0.0]] }
ring = { kind = "flux", corner = [1.0, 0.5], sides = [[-0.5, 0.0]] }
cone = { kind = "flux", corner = [1.0, 1.0], sides = [[-1.0, -1.0]], points = 100 }
"#;

fn stream() -> String {
    STREAM.replace("STREAM", "{ kind = \"velocity\", value = [0, 3] }")
}

#[test]
fn axisymmetric_sections_are_those_in_space() {
    let directory = fresh_directory("stream");
    let summary = results(&legal(&stream(), &[]), &directory);
    // Without bodies.
    let names = history(&directory).names().join(",");
    let expected = "time [s],energy_kinetic_fluid [J],energy_contact [J],leak_net [m³/s],leak_absolute [m³/s],newton";
    assert!(names.starts_with(expected), "{names}");
    let labels = [&summary.units.force, &summary.units.energy, &summary.units.volume, &summary.units.flow];
    assert_eq!(labels, ["N", "J", "m³", "m³/s"]);
    let probes = probes(&directory);
    assert!(probes.names().contains(&"disk_flux [m³/s]".to_owned()), "{:?}", probes.names());
    let pi = std::f64::consts::PI;
    // The mean of `10 (1 - r)` over the cone `z = r` has the weight `r`. The middles of 100 intervals give the integral
    // 1/3 - 1/(12 100²) of `r²`.
    let cone = 10.0 * (1.0 - 2.0 * (1.0 / 3.0 - 1.0 / 12e4));
    for (name, value) in [
        ("disk_flux", pi * 0.64 * 3.0),
        ("ring_flux", pi * (1.0 - 0.25) * 3.0),
        ("cone_flux", pi * 3.0),
        ("disk_pressure", 5.0),
        ("cone_pressure", cone),
    ] {
        assert!((last(&probes, name) - value).abs() < 1e-6, "{name}: {} {value}", last(&probes, name));
    }
}

#[test]
fn the_force_on_an_axisymmetric_body_is_along_the_axis() {
    let ball = stream()
        + r#"drag = { kind = "force", body = "ball", about = [0, 0.1] }
work = { kind = "strain-energy", body = "ball" }

[[body]]
name     = "ball"
shape    = { kind = "half-ball", centre = [0.0, 0.5], radius = 0.2, size = 0.1 }
material = { kind = "linear", young = 1.0e5, poisson = 0.3 }
density  = 1.0
gravity  = [0.0, 0.0]
boundary = { left = "symmetry" }
"#;
    let directory = fresh_directory("drag");
    results(&legal(&ball, &[]), &directory);
    let probes = probes(&directory);
    assert!(
        ["drag_y [N]", "drag_moment_z [N m]", "work_energy [J]"]
            .iter()
            .all(|name| probes.names().contains(&(*name).to_owned()))
    );
    assert_eq!([last(&probes, "drag_x"), last(&probes, "drag_moment_z")], [0.0, 0.0]);
    let force = column(&directory, "force_y");
    let force = force[force.len() - 1];
    assert!(force > 0.0 && (last(&probes, "drag_y") - force).abs() < 1e-12 * force, "{force}");
}

#[test]
fn probes_outside_of_the_background_are_warnings_or_errors() {
    let warnings = |text: &str, sets: &[&str]| -> Vec<String> {
        let lines = io::sizes(&legal(text, &[sets])).expect("sizes").lines;
        lines.into_iter().filter(|line| line.starts_with("warning")).collect()
    };
    let found = warnings(&flow(), &["output.probes.through.sides=[[0.0, 2.0]]"]);
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(found[0].contains("1 of 6 points of probe along are outside the background, the first at [2.5, 0.5]"));
    assert!(found[1].contains("100 of 200 points of probe through"), "{found:#?}");
    refused(&flow(), &[&["output.probes.through.corner=[2.1, 0.0]"]], &["output.probes.through", "outside"]);
    // A square with a hole.
    let sides = (1..=4).map(|side| format!("side-{side} = \"no-slip\"")).collect::<Vec<_>>().join(", ");
    let holed = format!(
        "background={{ kind = \"polygon\", corners = [[0, 0], [1, 0], [1, 1], [0, 1]], holes = [[[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]]], size = 0.2, boundary = {{ {sides}, hole-1 = \"no-slip\" }} }}"
    );
    let probe = |at| format!("output.probes={{ middle = {{ kind = \"point\", at = {at} }} }}");
    refused(&flow(), &[&[&holed, &probe("[0.5, 0.5]")]], &["output.probes.middle", "is outside the background"]);
    legal(&flow(), &[&[&holed, &probe("[0.5, 0.7]")]]);
    let marker =
        |x: f64| format!("output.probes={{ tip = {{ kind = \"marker\", body = \"cylinder\", at = [{x}, 0.2] }} }}");
    assert_eq!(warnings(CHANNEL, &[&marker(0.255)]), [""; 0]);
    let far = warnings(CHANNEL, &[&marker(9.0)]);
    assert!(far[0].contains("marker tip is 8.75") && far[0].contains("away from the surface of body cylinder"));
}

#[test]
fn markers_and_forces_follow_a_body() {
    let directory = fresh_directory("cylinder");
    let sets = [
        "background.size=0.1",
        "body.0.shape.size=0.02",
        "time.end=0.05",
        "output.probes={ tip = { kind = \"marker\", body = \"cylinder\", at = [9.0, 0.2] }, drag = { kind = \"force\", body = \"cylinder\", about = [1, 0] }, inside = { kind = \"point\", at = [0.2, 0.2] } }",
    ];
    let file = legal(CHANNEL, &[&sets]);
    results(&file, &directory);
    let probes = probes(&directory);
    // The nearest point of the surface is the rightmost one.
    let centre = column(&directory, "centre_x");
    let [first, end] = [0, centre.len() - 1].map(|k| centre[k]);
    let tips = probes.column("tip_x").unwrap_or_else(|| panic!("{:?}", probes.names()));
    assert!((tips[tips.len() - 1] - tips[1] - (end - first)).abs() < 1e-12, "{tips:?} {first} {end}");
    assert!(
        (last(&probes, "tip_velocity_x") - column(&directory, "centre_velocity_x")[centre.len() - 1]).abs() < 1e-12
    );
    for axis in ["x", "y"] {
        let force = column(&directory, &format!("force_{axis}"));
        assert!(
            (last(&probes, &format!("drag_{axis}")) - force[force.len() - 1]).abs()
                < 1e-12 * force[force.len() - 1].abs().max(1.0)
        );
    }
    assert!(last(&probes, "drag_moment_z").is_finite());
    assert!(last(&probes, "inside_pressure").is_nan());
}

#[test]
fn parts_and_energies_of_elastic_bodies_are_measured() {
    let box_in_fluid = flow()
        + r#"part = { kind = "force", body = "block", parts = ["left", "top"] }
rest = { kind = "force", body = "block", parts = ["right", "bottom"] }
all  = { kind = "force", body = "block" }
work = { kind = "strain-energy", body = "block" }

[[body]]
name     = "block"
shape    = { kind = "box", min = [0.8, 0.3], max = [1.1, 0.6], n = [3, 3] }
material = { kind = "linear", young = 1.0e3, poisson = 0.3 }
density  = 1.0
gravity  = [0.0, 0.0]
boundary = { bottom = "clamped" }
"#;
    let directory = fresh_directory("block");
    results(&legal(&box_in_fluid, &[]), &directory);
    let probes = probes(&directory);
    for name in ["x", "y", "moment_z"] {
        let [part, rest, all] = ["part", "rest", "all"].map(|probe| last(&probes, &format!("{probe}_{name}")));
        assert!(
            (part + rest - all).abs() < 1e-12 * all.abs() && part != 0.0 && rest != 0.0,
            "{name}: {part} {rest} {all}"
        );
    }
    let energy = column(&directory, "energy_elastic");
    assert_eq!(last(&probes, "work_energy"), energy[energy.len() - 1]);
    assert!(energy[energy.len() - 1] > 0.0);
    let refuse = |from: &str, to: &str, words: &[&str]| refused(&box_in_fluid.replace(from, to), &[], words);
    refuse(
        "parts = [\"left\", \"top\"]",
        "parts = [\"lid\"]",
        &["output.probes.part.parts.0", "unknown part of the surface `lid`"],
    );
    refuse(
        "sides = [[0.0, 1.0]]",
        "sides = [[0.0, 1.0], [1.0, 0.0]]",
        &["output.probes.through.sides", "needs 1 entries of `sides`"],
    );
    refuse("along   =", "\"a,b\" =", &["output.probes.a,b", "not a column name"]);
}

#[test]
fn probes_go_on_from_a_checkpoint() {
    let directory = fresh_directory("resumed");
    let text = flow().replace("vtk_every = 5", "vtk_every = 1\ncheckpoint_every = 1");
    results(&legal(&text, &[&["time.end=0.06"]]), &directory);
    let resumed = io::RunOptions { resumes: true, ..io::RunOptions::default() };
    resumed.run(&legal(&text, &[]), &directory, &mut ()).unwrap_or_else(|e| panic!("{e}"));
    let whole = fresh_directory("whole");
    results(&legal(&text, &[]), &whole);
    for name in ["probes.csv", "lines/along_000005.csv"] {
        assert_eq!(
            std::fs::read_to_string(directory.join(name)).ok(),
            std::fs::read_to_string(whole.join(name)).ok(),
            "{name}"
        );
    }
    // Tables of an earlier version have no units.
    for name in ["history.csv", "diagnostics.csv"] {
        let table = std::fs::read_to_string(directory.join(name)).unwrap_or_else(|e| panic!("{e}"));
        let (header, rows) = table.split_once('\n').unwrap_or_else(|| panic!("rows"));
        let bare: Vec<&str> = header.split(',').map(|name| name_and_unit(name).0).collect();
        assert_ne!(bare.join(","), header);
        // The checkpoint has the length of the table: spaces at the end of the header keep it.
        let line = format!("{:<1$}", bare.join(","), header.len());
        std::fs::write(directory.join(name), format!("{line}\n{rows}")).unwrap_or_else(|e| panic!("{e}"));
    }
    let sets = ["time.end=0.12"];
    resumed.run(&legal(&text, &[&sets]), &directory, &mut ()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(history(&directory).names()[0], "time");
    assert_eq!(column(&directory, "energy_kinetic_fluid").len(), 6);
    let other = text.replace("middle  =", "inner   =");
    let refused = resumed.run(&legal(&other, &[&["time.end=0.2"]]), &directory, &mut ()).expect_err("other columns");
    check_words(&refused.to_string(), &["probes.csv", "the probes are not those of the run"]);
}

/// The forces on the parts of a rigid body add up to that on all of it, for a shape with a mesh and one without.
#[test]
fn parts_of_rigid_bodies_are_measured() {
    let shapes = [
        r#"{ kind = "box", min = [0.8, 0.3], max = [1.2, 0.7], n = [2, 2] }"#,
        r#"{ kind = "polygon", corners = [[0.8, 0.3], [1.2, 0.3], [1.2, 0.7], [0.8, 0.7]], size = 0.2 }"#,
    ];
    for (shape, sides) in
        shapes.into_iter().zip([["left", "right", "bottom", "top"], ["side-1", "side-2", "side-3", "side-4"]])
    {
        let parts: String = sides
            .iter()
            .map(|side| format!("{side} = {{ kind = \"force\", body = \"block\", parts = [\"{side}\"] }}\n"))
            .collect();
        let block = format!(
            "all = {{ kind = \"force\", body = \"block\" }}\n{parts}\n[[body]]\nname = \"block\"\nshape = {shape}\nmotion = \"fixed\"\n"
        );
        let directory = fresh_directory("parts-of-rigid");
        results(&legal(&(flow() + &block), &[]), &directory);
        let probes = probes(&directory);
        for axis in ["x", "y"] {
            let whole = last(&probes, &format!("all_{axis}"));
            let of_parts = sides.map(|side| last(&probes, &format!("{side}_{axis}")));
            assert!(of_parts.iter().all(|force| force.abs() > 1e-3) && whole.abs() > 0.1, "{of_parts:?}");
            assert!((of_parts.iter().sum::<f64>() - whole).abs() < 1e-10 * whole.abs(), "{of_parts:?} {whole}");
        }
    }
}

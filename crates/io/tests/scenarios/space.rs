//! Scenarios in three dimensions: boxes that fall through a fluid in a closed box, free and elastic.

use crate::setting::*;
use io::ScenarioFile;

/// Returns the example with a coarser mesh.
fn case() -> String {
    CUBE.replacen("size = 0.1 ", "size = 0.3 ", 1)
}

#[test]
fn a_free_cube_falls_with_the_force_that_is_reported() {
    let directory = fresh_directory("free");
    let euler = ["time.scheme=implicit-euler"];
    results(&legal(&case(), &[&euler]), &directory);
    let [velocity, force, height] = ["centre_velocity", "force_z", "centre_z"].map(|name| column(&directory, name));
    let mass = 1.5 * 0.4_f64.powi(3);
    let (mut before, mut at) = (0.0, 0.73);
    for k in 0..5 {
        let inertia = mass * (velocity[k] - before) / 0.02;
        assert!((inertia + 10.0 * mass - force[k]).abs() < 1e-6 * 10.0 * mass, "{inertia} {force:?}");
        at += 0.02 * velocity[k];
        assert!((height[k] - at).abs() < 1e-9, "{height:?}");
        before = velocity[k];
    }
    // Slower than buoyancy alone allows, 10 (1 - 1/1.5), because fluid is accelerated as well.
    assert!(velocity[0] < 0.0 && -velocity[0] / 0.02 < 10.0 / 3.0, "{velocity:?}");
    assert!(velocity.windows(2).all(|v| v[1] < v[0]), "{velocity:?}");
    for file in ["fluid.pvd", "rigid.pvd", "interface.pvd", "vtk/fluid_000005.vtu", "vtk/rigid_000005.vtu"] {
        assert!(directory.join(file).exists(), "{file}");
    }
    let left = ScenarioFile::read(&directory.join("scenario.toml"), &[]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(left.scenario(), legal(&case(), &[&euler]).scenario());
}

#[test]
fn a_cube_lands_on_a_plane() {
    let sets = [
        "time.end=0.6",
        "time.scheme=implicit-euler",
        "background.size=0.2",
        "fluid.viscosity=0.01",
        "body.0.initial_velocity=[0.0, 0.0, -1.0]",
    ];
    let directory = fresh_directory("landing");
    results(&legal(&format!("{}{FLOOR}", case()), &[&sets]), &directory);
    let [gap, force, velocity] = ["d_min", "contact_force", "centre_velocity"].map(|name| column(&directory, name));
    for (gap, force) in gap.iter().zip(&force) {
        assert!((*gap < 0.05) == (*force > 0.0), "{gap} {force}");
    }
    // It comes to rest where the plane, 1000 N/m³ over 0.16 m², carries its weight without buoyancy, 0.32 N.
    assert!(gap[0] > 0.07 && velocity[0] < -0.4 && velocity[29].abs() < 0.01, "{gap:?} {velocity:?}");
    assert!((force[29] - 0.32).abs() < 0.1 * 0.32, "{force:?}");
    assert!((gap[29] - (0.05 - 0.002)).abs() < 0.001, "{gap:?}");
}

#[test]
fn an_elastic_cube_is_compressed_by_its_weight() {
    let elastic = "material = { kind = \"saint-venant-kirchhoff\", young = 1.0e4, poisson = 0.3 }\n\
                   boundary = { top = \"clamped\", left = \"symmetry\" }";
    let directory = fresh_directory("elastic");
    results(&legal(&case().replace(FREE_CUBE, elastic), &[&["time.end=0.04", "output.vtk_every=2"]]), &directory);
    let energy = column(&directory, "energy_elastic");
    assert!(energy.iter().all(|e| *e > 0.0), "{energy:?}");
    let height = column(&directory, "centre_z");
    assert!(height.iter().all(|y| *y < 0.73 && *y > 0.72), "the top is held: {height:?}");
    assert!(directory.join("vtk/solid_000002.vtu").exists());
}

#[test]
fn a_background_is_finer_near_regions() {
    let near = |region: &str| {
        let refine = format!("size = 0.3\nrefine = [{{ near = {{ {region} }}, size = 0.1, growth = 0.5 }}]");
        let case = case().replacen("size = 0.3", &refine, 1);
        io::sizes(&legal(&case, &[])).unwrap_or_else(|e| panic!("{e}")).background_cells
    };
    let coarse = io::sizes(&legal(&case(), &[])).unwrap_or_else(|e| panic!("{e}")).background_cells;
    let point = near("kind = \"point\", at = [0.2, 0.2, 0.2]");
    let line = near("kind = \"line\", from = [0.2, 0.2, 0.2], to = [0.2, 0.2, 0.8]");
    let ball = near("kind = \"ball\", centre = [0.2, 0.2, 0.2], radius = 0.4");
    let all = near("kind = \"box\", min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0]");
    assert!(coarse < point && point < line && line < ball && ball < all, "{coarse} {point} {line} {ball} {all}");
}

#[test]
fn planar_shapes_and_vectors_are_refused() {
    let text = case();
    let cube = text.lines().find(|line| line.starts_with("shape")).expect("a shape");
    for (shape, word) in [
        ("{ kind = \"half-ball\", centre = [0.5, 0.5, 0.7], radius = 0.2, size = 0.1 }", "dimension = 2"),
        ("{ kind = \"box\", min = [0.3, 0.3], max = [0.7, 0.7, 0.9], n = [2, 2, 2] }", "2 components"),
        ("{ kind = \"box\", min = [0.3, 0.3, 0.5], max = [0.7, 0.7, 0.9], n = [2, 2] }", "2 components"),
    ] {
        refused(&text.replace(cube, &format!("shape = {shape}")), &[], &["case.toml:", "body.0.shape", word]);
    }
    let front = ["background.boundary.front", "did you mean `free`?"];
    refused(&case(), &[&["background.boundary.front=fre"]], &front);
}

/// The parameter of the interior penalty is a length in 2D only.
#[test]
fn the_set_of_the_paper_is_available_with_all_units() {
    legal(&case(), &[&["fluid.stabilisation=paper-44-2019"]]);
}

//! Shapes of bodies and backgrounds: primitives, polygons, and files of one's own.

use std::collections::HashMap;
use std::f64::consts::PI;

use crate::setting::*;
use io::gmsh::{GmshFormat, GmshVersion, write as write_gmsh};
use io::scenario::Case;
use io::scenario::case::case;
use io::{Error, ScenarioFile};
use mesh::generate::{BallOptions, ball, structured_box};
use mesh::{Placed, Point, SimplexMesh, Vector, VertexId};
use solver::{FluidBoundary, Setup};

/// A body in vacuum; `SHAPE` stands for its shape and `MORE` for more keys.
const BODY: &str = r#"
name      = "own-shape"
dimension = 2
units     = "si"

[time]
step = 1.0e-3
end  = 1.0e-2

[[body]]
name     = "part"
shape    = SHAPE
material = { kind = "linear", young = 1.0e6, poisson = 0.3 }
density  = 2.0
gravity  = [0.0, -10.0]
MORE
"#;

fn text(shape: &str, more: &str) -> String {
    BODY.replace("SHAPE", shape).replace("MORE", more)
}

/// Reads a scenario in the folder of the tests, so that files in it are found.
fn read(text: &str) -> Result<ScenarioFile, Error> {
    parse_at(&in_folder("case.toml"), text, &[])
}

fn parsed(text: &str) -> ScenarioFile {
    read(text).unwrap_or_else(|e| panic!("{e}"))
}

fn setup(text: &str) -> Setup<2> {
    planar_case(&parsed(text)).setup
}

/// Returns mass and volume of the first body at the start.
fn mass_and_volume<const D: usize>(setup: &Setup<D>) -> (f64, f64) {
    let body = &setup.bodies[0];
    let mass = body.balance(&body.initial()).expect("an elastic body").mass;
    (mass, Placed::new(body.surface(), body.reference()).enclosed().volume)
}

#[track_caller]
fn expect(text: &str, words: &[&str]) {
    check_words(&mistake(read(text)).to_string(), words);
}

fn format(version: GmshVersion) -> GmshFormat {
    GmshFormat { version, is_binary: version == GmshVersion::V41 }
}

/// Writes a Gmsh file into the folder of the tests.
fn save<const D: usize>(name: &str, mesh: &SimplexMesh<D>, edge_nodes: &HashMap<[VertexId; 2], Point<D>>) {
    let path = write(name, "");
    write_gmsh(&path, mesh, edge_nodes, format(GmshVersion::V41)).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn round_shapes_have_their_areas() {
    for (shape, area) in [
        ("{ kind = \"annulus\", centre = [1, 2], outer = 1.0, inner = 0.5, size = 0.1 }", 0.75 * PI),
        ("{ kind = \"capsule\", from = [0, 0], to = [3, 4], radius = 0.5, size = 0.1 }", 5.0 + 0.25 * PI),
    ] {
        // Order 2 has an error of the fourth power of the size, in the mass and not in the polygon of the surface.
        for (order, tolerance) in [(1, 1e-2), (2, 1e-5)] {
            let (mass, volume) = mass_and_volume(&setup(&text(shape, &format!("order = {order}"))));
            assert!((mass / (2.0 * area) - 1.0).abs() < tolerance, "{shape} of order {order}: {mass} for {area}");
            assert!((volume / area - 1.0).abs() < 1e-2);
        }
    }
    let ring = setup(&text(
        "{ kind = \"annulus\", centre = [0, 0], outer = 1.0, inner = 0.5, size = 0.1 }",
        "boundary = { inner = \"clamped\", outer = { kind = \"traction\", value = [\"x\", \"y\"] } }",
    ));
    assert_eq!(ring.bodies.len(), 1);
}

#[test]
fn a_ball_in_space_has_its_mass() {
    let shape = "{ kind = \"ball\", centre = [0, 0, 1], radius = 0.5, size = 0.15 }";
    let ball =
        text(shape, "order = 2").replace("dimension = 2", "dimension = 3").replace("[0.0, -10.0]", "[0, 0, -10]");
    let case: Case<3> = case(&parsed(&ball)).unwrap_or_else(|e| panic!("{e}"));
    let (mass, _) = mass_and_volume(&case.setup);
    assert!((mass / (2.0 * PI / 6.0) - 1.0).abs() < 2e-4, "{mass}");
}

#[test]
fn polygons_have_holes_and_named_sides() {
    let corners = "corners = [[0, 0], [2, 0], [2, 1], [0, 1]]";
    let hole = "holes = [[[0.5, 0.25], [1.0, 0.25], [1.0, 0.75], [0.5, 0.75]]]";
    let plate = format!("{{ kind = \"polygon\", {corners}, {hole}, size = 0.1 }}");
    let boundary = "boundary = { side-4 = \"clamped\", hole-1 = { kind = \"traction\", value = [1, 0] } }";
    let setup = setup(&text(&plate, boundary));
    let (mass, volume) = mass_and_volume(&setup);
    assert!((mass - 3.5).abs() < 1e-12 && (volume - 1.75).abs() < 1e-12);
    expect(&text(&plate, "boundary = { side-5 = \"clamped\" }"), &["body.0.boundary.side-5", "side-4", "hole-1"]);
    // A body that does not deform has the same surface.
    let rigid = text(&plate, "motion = { kind = \"free\" }").replace("material", "# material");
    let rigid = planar_case(&parsed(&rigid)).setup;
    let surface = Placed::new(rigid.bodies[0].surface(), rigid.bodies[0].reference()).enclosed().volume;
    assert!((surface - 1.75).abs() < 1e-12);
    expect(
        &text("{ kind = \"polygon\", corners = [[0, 0], [1, 0]], size = 0.2 }", ""),
        &["body.0.shape.corners", "at least 3"],
    );
}

#[test]
fn smooth_polygons_follow_a_spline() {
    let corner = |k: usize| (2.0 * PI * k as f64 / 24.0).sin_cos();
    let corners: Vec<String> = (0..24).map(corner).map(|(s, c)| format!("[{}, {s}]", 2.0 * c)).collect();
    let ellipse = format!("{{ kind = \"polygon\", corners = [{}], size = 0.2, smooth = true }}", corners.join(", "));
    let boundary = "boundary = { surface = { kind = \"traction\", value = [0, 1] } }";
    let mass = |order: usize| mass_and_volume(&setup(&text(&ellipse, &format!("order = {order}\n{boundary}")))).0;
    let [linear, quadratic] = [1, 2].map(|order| (mass(order) / (4.0 * PI) - 1.0).abs());
    assert!(linear < 1e-2 && quadratic < 1e-4 && quadratic < 0.1 * linear, "{linear} {quadratic}");
}

/// A disk stretched to an ellipse, with its middle cells in a group.
fn ellipse() -> SimplexMesh<2> {
    let disk = ball::<2>([0.0; 2], 1.0, 0.3, &BallOptions::default()).expect("a mesh");
    let mesh = disk.mapped(|x| Point::<2>::new(2.0 * x[0], x[1])).expect("a mesh");
    let is_inner: Vec<bool> = mesh.cells().map(|cell| mesh.simplex(cell).centroid().norm() < 0.7).collect();
    mesh.with_cell_tags(|cell| Some(if is_inner[cell.index()] { "core" } else { "shell" }))
}

#[test]
fn bodies_come_from_gmsh_files() {
    let mesh = ellipse();
    // Nodes on the ellipse: the ends are at known angles.
    let surface = mesh.boundary();
    let mut nodes = HashMap::new();
    for facet in surface.facets() {
        let [a, b] = [0, 1].map(|k| surface.facet(facet)[k]);
        let middle = [a, b]
            .map(|v| mesh.vertex(v))
            .iter()
            .fold(Point::<2>::zeros(), |sum, x| sum + Point::<2>::new(x[0] / 2.0, x[1]));
        let middle = middle.normalize();
        nodes.insert([a.min(b), a.max(b)], Point::<2>::new(2.0 * middle[0], middle[1]));
    }
    save("ellipse.msh", &mesh, &nodes);
    let shape = "{ kind = \"mesh\", file = \"ellipse.msh\", scale = 0.5 }";
    let boundary = "boundary = { surface = { kind = \"traction\", value = [0, 1] } }";
    let mass = |more: &str| mass_and_volume(&setup(&text(shape, &format!("{more}\n{boundary}")))).0;
    let area = 0.5 * PI;
    assert!((mass("order = 2") / (2.0 * area) - 1.0).abs() < 1e-4);
    let polygon = mass("order = 1") / 2.0;
    assert!((polygon - 0.25 * mesh.volume()).abs() < 1e-12);
    // Groups have densities of their own.
    let core: f64 =
        mesh.cells().filter(|cell| mesh.cell_tag(*cell) == mesh.tag("core")).map(|cell| mesh.cell_volume(cell)).sum();
    let heavy =
        mass("groups.core = { density = 10.0, material = { kind = \"neo-hookean\", young = 1e7, poisson = 0.3 } }");
    assert!((heavy - (2.0 * polygon + 8.0 * 0.25 * core)).abs() < 1e-12);
    expect(&text(shape, "groups.kern = { density = 1.0 }"), &["body.0.groups.kern", "core, shell"]);
    expect(&text(shape, "boundary = { core = \"clamped\" }"), &["body.0.boundary.core", "unknown part of the surface"]);
    expect(
        &text(&shape.replace("ellipse", "missing"), ""),
        &["body.0.shape.file", "missing.msh", "relative to the scenario"],
    );
    write("broken.msh", "$MeshFormat\n1.0 0 8\n");
    expect(
        &text(&shape.replace("ellipse", "broken"), ""),
        &["body.0.shape.file", "broken.msh: line 2", "save the mesh as 4.1 or 2.2"],
    );
    let in_space = text(shape, "").replace("dimension = 2", "dimension = 3").replace("[0.0, -10.0]", "[0, 0, -10]");
    expect(&in_space, &["body.0.shape", "is open at"]);
}

#[test]
fn surfaces_are_bodies_that_do_not_deform() {
    let cube = structured_box([0.0; 3], [1.0; 3], [1; 3]).expect("a mesh").boundary();
    let corners = structured_box([0.0; 3], [1.0; 3], [1; 3]).expect("a mesh").vertices().to_vec();
    let points: String = corners.iter().map(|x| format!("v {} {} {}\n", x[0], x[1], x[2])).collect();
    // Inwards, which is turned.
    let faces: String = cube
        .facets()
        .map(|f| cube.facet(f).to_vec())
        .map(|f| format!("f {} {} {}\n", f[1].0 + 1, f[0].0 + 1, f[2].0 + 1))
        .collect();
    write("cube.obj", points + &faces);
    let shape = "{ kind = \"mesh\", file = \"cube.obj\", scale = 2.0 }";
    let text = text(shape, "motion = { kind = \"free\" }").replace("material", "# material");
    let text = text.replace("dimension = 2", "dimension = 3").replace("[0.0, -10.0]", "[0, 0, -10]");
    let case: Case<3> = case(&parsed(&text)).unwrap_or_else(|e| panic!("{e}"));
    assert!((mass_and_volume(&case.setup).1 - 8.0).abs() < 1e-12);
}

#[test]
fn surfaces_whose_parts_overlap_are_refused() {
    let shape = CUBE.lines().find(|line| line.starts_with("shape")).expect("a shape");
    let sets = ["background.min=[-1, -1, -1]", "background.max=[3, 3, 3]", "background.size=1.0"];
    let cubes = |file: &str, shift: f64| {
        let (mut points, mut faces) = (String::new(), String::new());
        for (k, shift) in [0.0, shift].into_iter().enumerate() {
            let mesh = structured_box([shift, 0.0, 0.0], [shift + 0.7, 0.8, 0.9], [1; 3]).expect("a mesh");
            mesh.vertices().iter().for_each(|x| points += &format!("v {} {} {}\n", x[0], x[1], x[2]));
            let cube = mesh.boundary();
            for facet in cube.facets() {
                let [a, b, c] = [0, 1, 2].map(|i| cube.facet(facet)[i].index() + 8 * k + 1);
                faces += &format!("f {a} {b} {c}\n");
            }
        }
        write(file, points + &faces);
        let text = CUBE.replace(shape, &format!("shape = {{ kind = \"mesh\", file = \"{file}\" }}"));
        parse_at(&in_folder("case.toml"), &text, &[&sets])
    };
    cubes("apart.obj", 1.1).and_then(|file| io::sizes(&file)).unwrap_or_else(|e| panic!("{e}"));
    let refused = mistake(cubes("overlapping.obj", 0.4)).to_string();
    check_words(&refused, &["body.0", "the surface of body `cube` encloses 1.008", "but covers 7.9", "unite them"]);
}

/// A fluid without its background.
const FLUID: &str = r#"
name      = "own-background"
dimension = 2
units     = "si"

[time]
step = 0.05
end  = 0.2

[fluid]
density          = 1.0
viscosity        = 1.0
convection       = "none"
initial_velocity = ["1 + 2*x - 3*y", "4*x - 2*y"]

"#;
/// A trapezium with oblique walls.
const TRAPEZIUM: &str = r#"[background]
kind     = "mesh"
file     = "trapezium.msh"
boundary = { wall = { kind = "velocity", value = ["1 + 2*x - 3*y", "4*x - 2*y"] }, end = { kind = "traction", value = TRACTION } }
"#;

/// A square sheared so that its sides are oblique, in which one side is an end and the others are walls.
fn trapezium() -> SimplexMesh<2> {
    let square = structured_box([0.0; 2], [1.0; 2], [6; 2]).expect("a mesh");
    let mesh = square.mapped(|x| Point::<2>::new(x[0] * (2.0 - x[1]) + 0.3 * x[1], x[1] + 0.2 * x[0])).expect("a mesh");
    let name = |facet| if square.facet_tag(facet) == square.tag("right") { "end" } else { "wall" };
    let names: Vec<&str> = square.facets().map(name).collect();
    mesh.with_facet_tags(|facet| Some(names[facet.index()]))
}

#[test]
fn a_linear_flow_in_a_background_of_any_shape_is_exact() {
    let mesh = trapezium();
    save("trapezium.msh", &mesh, &HashMap::new());
    // The stress 2 mu D of the flow without pressure, on the oblique end.
    let normal = mesh.tag_normal(mesh.tag("end").expect("a tag")).expect("a plane end");
    let traction = [4.0 * normal[0] + normal[1], normal[0] - 4.0 * normal[1]];
    let text = FLUID.to_owned() + &TRAPEZIUM.replace("TRACTION", &format!("{traction:?}"));
    let case = planar_case(&parsed(&text));
    let fluid = case.setup.fluid.as_ref().expect("a fluid");
    assert_eq!((fluid.background.n_cells(), fluid.boundary.len()), (mesh.n_cells(), 2));
    let mut workspace = case.workspace;
    let mut state = solver::State::initial(&case.setup).unwrap_or_else(|e| panic!("{e}"));
    for _ in 0..4 {
        let step = solver::Substep::whole(case.setup.dt);
        state = solver::advance(&case.setup, &state, step, &mut workspace).unwrap_or_else(|e| panic!("{e}")).0;
    }
    let flow = state.fluid.as_ref().expect("a fluid");
    for (vertex, u) in flow.space.vertices().iter().zip(&flow.velocity) {
        let x = mesh.vertex(*vertex);
        let exact = Vector::<2>::new(1.0 + 2.0 * x[0] - 3.0 * x[1], 4.0 * x[0] - 2.0 * x[1]);
        assert!((u - exact).norm() < 1e-8, "{u} for {exact}");
    }
}

#[test]
fn a_background_may_be_a_polygon() {
    let background = FLUID.to_owned()
        + r#"[background]
kind     = "polygon"
corners  = [[0, 0], [2, 0], [2, 1], [3, 1], [3, 2], [0, 2]]
holes    = [[[0.5, 0.5], [1, 0.5], [1, 1]]]
size     = 0.2
boundary = { side-1 = "no-slip", side-2 = "no-slip", side-3 = "no-slip", side-4 = "free", side-5 = "no-slip", side-6 = "no-slip", hole-1 = "no-slip" }
"#;
    let case = planar_case(&parsed(&background));
    let fluid = case.setup.fluid.as_ref().expect("a fluid");
    assert!((fluid.background.volume() - 4.875).abs() < 1e-12 && fluid.boundary.len() == 7);
    expect(&background.replace(", hole-1 = \"no-slip\"", ""), &["background.boundary", "side `hole-1` is missing"]);
    expect(&background.replace("size     = 0.2", "size     = 1e-5"), &["background.size", "GiB of memory"]);
    expect(&background.replace("[1, 1]]]", "[9, 1]]]"), &["background", "cross or touch"]);
    let in_space = background.replace("dimension = 2", "dimension = 3");
    assert!(read(&in_space).is_err());
}

#[test]
fn a_polygon_may_be_finer_near_regions_and_smooth() {
    let text = FLUID.to_owned()
        + r#"[background]
kind     = "polygon"
corners  = [[-2, 0], [0, -1], [2, 0], [0, 1]]
holes    = [[[0.9, 0], [1.1, 0.2], [1.3, 0], [1.1, -0.2]]]
size     = 0.2
smooth   = true
refine   = [{ near = { kind = "ball", centre = [-1, 0], radius = 0.1 }, size = 0.02, growth = 0.2 }]
boundary = { surface = "no-slip", hole-1 = "free" }
"#;
    let mesh_of = |text: &str| planar_case(&parsed(text)).setup.fluid.map(|fluid| fluid.background).expect("a fluid");
    let mesh = mesh_of(&text);
    let diameter = |at: [f64; 2]| {
        let near = |cell: &mesh::CellId| (mesh.simplex(*cell).centroid() - Point::<2>::from(at)).norm() < 0.1;
        let cells: Vec<f64> = mesh.cells().filter(near).map(|cell| mesh.simplex(cell).diameter()).collect();
        cells.iter().sum::<f64>() / cells.len() as f64
    };
    assert!((0.017..0.023).contains(&diameter([-1.0, 0.0])) && (0.15..0.25).contains(&diameter([1.7, 0.0])));
    // The spline bulges out of the polygon; its hole, too.
    assert!((4.5..6.0).contains(&mesh.volume()), "{}", mesh.volume());
    let sharp = text.replace("smooth   = true", "smooth   = false").replace(
        "surface = \"no-slip\"",
        "side-1 = \"no-slip\", side-2 = \"no-slip\", side-3 = \"no-slip\", side-4 = \"no-slip\"",
    );
    assert!((mesh_of(&sharp).volume() - 3.92).abs() < 1e-12);
    expect(&text.replace("[-1, 0], radius", "[-3, 0], radius"), &["background.refine.0", "within the background"]);
    expect(&text.replace("size = 0.02", "size = 1e-6"), &["background.refine.0", "number of cells"]);
    expect(&text.replace("[-2, 0], [0, -1]", "[-2, 0, 1], [0, -1]"), &["background.corners.0", "3 components"]);
}

#[test]
fn conditions_on_planes_follow_an_oblique_channel() {
    // A channel of length 2 and width 0.5 along (0.8, 0.6).
    let text = FLUID.to_owned()
        + r#"[background]
kind     = "polygon"
corners  = [[0, 0], [1.6, 1.2], [1.3, 1.6], [-0.3, 0.4]]
size     = 0.2
boundary = { side-1 = "symmetry", side-2 = "parallel", side-3 = "no-slip", side-4 = { kind = "inflow", profile = "parabolic", maximum = 3 } }
"#;
    let case = planar_case(&parsed(&text));
    let fluid = case.setup.fluid.as_ref().expect("a fluid");
    let (along, across) = (Vector::<2>::new(0.8, 0.6), Vector::<2>::new(-0.6, 0.8));
    let condition = |name: &str| {
        let tag = fluid.background.tag(name);
        fluid.boundary.iter().find(|(other, _)| Some(*other) == tag).map(|(_, condition)| condition)
    };
    let is_along = |found: &Vector<2>, wanted: Vector<2>| (found.dot(&wanted).abs() - 1.0).abs() < 1e-14;
    assert!(matches!(condition("side-1"), Some(FluidBoundary::Symmetry { normal }) if is_along(normal, across)));
    assert!(matches!(condition("side-2"), Some(FluidBoundary::Parallel { normal, .. }) if is_along(normal, along)));
    let Some(FluidBoundary::Velocity(inflow)) = condition("side-4") else { panic!("an inflow") };
    for s in [0.0, 0.2, 0.5, 1.0] {
        let u = inflow(&(across * (0.5 * s)), 0.0);
        assert!((u - along * (12.0 * s * (1.0 - s))).norm() < 1e-14, "{u}");
    }
    let normal = |n: &str| text.replace("\"symmetry\"", &format!("{{ kind = \"symmetry\", normal = {n} }}"));
    parsed(&normal("[6, -8]"));
    expect(&normal("[6, -8.1]"), &["background.boundary.side-1.normal", "across the normal"]);
}

#[test]
fn backgrounds_that_cannot_be_used_are_refused() {
    let mesh = trapezium();
    save("trapezium-2.msh", &mesh, &HashMap::new());
    let text = FLUID.to_owned() + &TRAPEZIUM.replace("trapezium", "trapezium-2").replace("TRACTION", "[0, 0]");
    parsed(&text);
    expect(
        &text.replace(", end = { kind = \"traction\", value = [0, 0] }", ""),
        &["background.boundary", "side `end` is missing"],
    );
    let names: Vec<bool> = mesh.facets().map(|facet| mesh.facet_tag(facet) == mesh.tag("end")).collect();
    save("bare.msh", &mesh.with_facet_tags(|facet| names[facet.index()].then_some("end")), &HashMap::new());
    let words = ["background.file", "18 facets of the boundary belong to no physical group", "give every part"];
    expect(&text.replace("trapezium-2", "bare"), &words);
}

#[test]
fn results_have_copies_of_all_files() {
    save("copied.msh", &ellipse(), &HashMap::new());
    let shape = "{ kind = \"mesh\", file = \"copied.msh\", scale = 0.5 }";
    let wall = "{ kind = \"shape\", shape = { kind = \"mesh\", file = \"copied.msh\", scale = 10.0 }, hollow = true }";
    let contact = format!(
        "\n[[contact]]\nbody = \"part\"\nobstacle = {wall}\nlaw = {{ kind = \"penalty\", gamma_contact_0 = 1e3 }}\nsize = 0.1\noffset = 0.1\n"
    );
    let file = parsed(&text(shape, &contact));
    let directory = fresh_directory("copied");
    results(&file, &directory);
    for name in ["body-0-shape.msh", "contact-0-obstacle-shape.msh"] {
        assert!(directory.join(name).is_file(), "{name}");
    }
    let again = ScenarioFile::read(&directory.join("scenario.toml"), &[]).unwrap_or_else(|e| panic!("{e}"));
    let other = fresh_directory("copied-again");
    results(&again, &other);
    assert_eq!(column(&directory, "centre_y"), column(&other, "centre_y"));
}

//! Fields, boundary conditions and surfaces of scenarios, as they arrive in the problem.

use crate::setting::*;
use algebra::{BlockLayout, Constraints};
use io::Error;
use io::scenario::Case;
use mesh::{Placed, Point, Vector};
use solver::algebra::time::ImplicitEuler;
use solver::body::StepTime;
use solver::{FluidBoundary, FluidSetup};

const COARSE_CHANNEL: [&str; 2] = ["background.size=0.1", "body.0.shape.size=0.02"];
const COARSE_BALL: [&str; 2] = ["background.size=1.0", "body.0.shape.size=1.0"];

fn problem(text: &str, sets: &[&[&str]]) -> Case<2> {
    planar_case(&legal(text, sets))
}

/// Returns the fluid of a case that has one.
fn wet(case: &Case<2>) -> &FluidSetup<2> {
    case.setup.fluid.as_ref().unwrap_or_else(|| panic!("a fluid"))
}

/// Returns the condition on a side.
fn side<'c>(case: &'c Case<2>, name: &str) -> &'c FluidBoundary<2> {
    let tag = wet(case).background.tag(name).unwrap_or_else(|| panic!("{name}"));
    let found = wet(case).boundary.iter().find(|(other, _)| *other == tag);
    &found.unwrap_or_else(|| panic!("{name}")).1
}

#[test]
fn fields_are_numbers_or_formulas_of_position_and_time() {
    let sets = [
        "fluid.body_force=[\"x*t\", 2]",
        "fluid.initial_velocity=[\"y^2\", \"-x\"]",
        "background.boundary.top={ kind = \"velocity\", value = [\"sin(pi*x)*t\", 0] }",
        "background.boundary.bottom={ kind = \"traction\", value = [0, \"x + y\"] }",
    ];
    let case = problem(CHANNEL, &[&COARSE_CHANNEL, &sets]);
    let x = Point::<2>::new(0.5, 0.3);
    let fluid = wet(&case);
    assert_eq!(fluid.body_force.as_ref().map(|f| f(&x, 3.0)), Some(Vector::<2>::new(1.5, 2.0)));
    assert_eq!(fluid.initial_velocity.as_ref().map(|u| u(&x)), Some(Vector::<2>::new(0.09, -0.5)));
    let FluidBoundary::Velocity(velocity) = side(&case, "top") else { panic!("a velocity") };
    assert!((velocity(&x, 2.0) - Vector::<2>::new(2.0, 0.0)).norm() < 1e-15);
    let FluidBoundary::Open { traction: Some(traction), .. } = side(&case, "bottom") else { panic!("a traction") };
    assert_eq!(traction(&x, &Vector::<2>::new(0.0, -1.0), 0.0), Vector::<2>::new(0.0, 0.8));
    for pressure in ["kind = \"pressure\", value", "kind = \"parallel\", pressure"] {
        let pressure = format!("background.boundary.bottom={{ {pressure} = \"x*t\" }}");
        let case = problem(CHANNEL, &[&COARSE_CHANNEL, &[&pressure]]);
        let traction = side(&case, "bottom").traction().unwrap_or_else(|| panic!("{pressure}"));
        assert_eq!(traction(&x, &Vector::<2>::new(0.0, -1.0), 3.0), Vector::<2>::new(0.0, 1.5));
    }

    let displaced = "body.0.initial_displacement=[\"0.1*x\", \"0.2\"]";
    let case = problem(BARRIER, &[&COARSE_BALL, &[displaced]]);
    let body = &case.setup.bodies[0];
    for (x, displacement) in body.reference().iter().zip(body.initial().displacement()) {
        assert!((displacement - Vector::<2>::new(0.1 * x[0], 0.2)).norm() < 1e-15);
    }
}

#[test]
fn fields_that_cannot_be_evaluated_are_refused() {
    let expect = |set: &str, words: &[&str]| refused(CHANNEL, &[&COARSE_CHANNEL, &[set]], words);
    expect("fluid.body_force=[\"1/x\", 0]", &["fluid.body_force.0", "`1/x` is inf", "[0.0, 0.0]", "change it"]);
    expect("fluid.body_force=[0, \"1/(8 - t)\"]", &["fluid.body_force.1", "t = 8"]);
    expect("fluid.body_force=[0, true]", &["fluid.body_force.1", "the boolean `true`", "a number or a formula"]);
    expect("fluid.body_force=[0]", &["fluid.body_force", "1 components"]);
    let pressure = "background.boundary.bottom={ kind = \"pressure\", value = \"1/x\" }";
    expect(pressure, &["background.boundary.bottom.value", "`1/x` is inf", "[0.0, 0.0]"]);
    let traction = "body.0.boundary.surface={ kind = \"traction\", value = [0, \"1/x\"] }";
    refused(BARRIER, &[&COARSE_BALL, &[traction]], &["body.0.boundary.surface.value.1", "`1/x` is inf"]);
}

#[test]
fn symmetry_and_inflow_take_their_direction_from_the_facets() {
    let sets = [
        "background.boundary.top={ kind = \"inflow\", profile = \"parabolic\", maximum = 2 }",
        "background.boundary.bottom={ kind = \"symmetry\", normal = [0, -2] }",
    ];
    let case = problem(CHANNEL, &[&COARSE_CHANNEL, &sets]);
    assert!(!case.half_domain, "the cylinder does not stand on the plane");
    let outflow = ["background.boundary.right=symmetry", "background.boundary.top=free"];
    let right = problem(CHANNEL, &[&COARSE_CHANNEL, &outflow]);
    assert!(matches!(side(&right, "right"), FluidBoundary::Symmetry { normal } if normal[0] == 1.0));
    assert!(matches!(side(&case, "bottom"), FluidBoundary::Symmetry { normal } if normal[1] == 1.0));
    let parallel = problem(CHANNEL, &[&COARSE_CHANNEL, &["background.boundary.right=parallel"]]);
    assert!(matches!(side(&parallel, "right"), FluidBoundary::Parallel { normal, .. } if normal[0] == 1.0));
    let FluidBoundary::Velocity(velocity) = side(&case, "top") else { panic!("an inflow") };
    assert!((velocity(&Point::<2>::new(1.1, 0.41), 0.0) - Vector::<2>::new(0.0, -2.0)).norm() < 1e-15);
    let FluidBoundary::Velocity(velocity) = side(&case, "left") else { panic!("an inflow") };
    assert!((velocity(&Point::<2>::new(0.0, 0.205), 5.0) - Vector::<2>::new(0.3, 0.0)).norm() < 1e-15);
    let pulsed = "background.boundary.left={ kind = \"inflow\", profile = \"parabolic\", maximum = \"1 + t\" }";
    let pulsed = problem(CHANNEL, &[&COARSE_CHANNEL, &[pulsed]]);
    let FluidBoundary::Velocity(velocity) = side(&pulsed, "left") else { panic!("an inflow") };
    assert!((velocity(&Point::<2>::new(0.0, 0.205), 5.0) - Vector::<2>::new(6.0, 0.0)).norm() < 1e-14);
    // The diameter of the half ball is a plane of symmetry, its arc is not plane.
    let case = problem(BARRIER, &[&COARSE_BALL]);
    let (body, mut layout, mut held) = (&case.setup.bodies[0], BlockLayout::new(), Constraints::new());
    let start = body.initial();
    body.step(&start, &StepTime::new(&ImplicitEuler, 1.0, 1.0, true), &mut layout).constrain(&layout, &mut held);
    let velocity = layout.fields().next().unwrap_or_else(|| panic!("a velocity"));
    for (node, x) in body.reference().iter().enumerate() {
        let found: Vec<_> = layout.node(velocity, node).map(|dof| held.get(dof)).collect();
        assert_eq!(found, [(x[0] == 0.0).then_some(0.0), None], "{x}");
    }
    let expect = |set: &str, words: &[&str]| refused(BARRIER, &[&COARSE_BALL, &[set]], words);
    let left = |normal: &str| format!("background.boundary.left={{ kind = \"symmetry\", normal = {normal} }}");
    expect(&left("[1, 1]"), &["background.boundary.left.normal", "across the normal"]);
    expect(&left("[0, 1]"), &["background.boundary.left.normal", "across the normal", "`parallel`"]);
    expect(&left("[0, 0]"), &["background.boundary.left.normal", "zero"]);
}

#[test]
fn polygons_are_surfaces_of_bodies() {
    let corners = ["[0.2, 0.1]", "[0.4, 0.2]", "[0.2, 0.3]"];
    let shape = |corners: &[&str]| {
        format!("body.0.shape={{ kind = \"polygon\", corners = [{}], size = 0.05 }}", corners.join(", "))
    };
    let [a, b, c] = corners;
    for order in [[a, b, c], [c, b, a]] {
        let case = problem(CHANNEL, &[&COARSE_CHANNEL[..1], &[&shape(&order)]]);
        let body = &case.setup.bodies[0];
        let placed = Placed::new(body.surface(), body.reference());
        // Sides of 0.224, 0.224 and 0.2 have 5, 5 and 4 segments.
        assert_eq!((body.surface().n_facets(), body.reference().len()), (14, 14));
        assert!((placed.enclosed().volume - 0.02).abs() < 1e-15);
    }
    let expect = |shape: String, words: &[&str]| refused(CHANNEL, &[&COARSE_CHANNEL[..1], &[&shape]], words);
    let bow = [a, b, "[0.2, 0.2]", "[0.4, 0.1]", c];
    expect(shape(&bow), &["body.0.shape", "intersects itself"]);
    let elastic = |corners: &[&str]| format!("body.0.{}", &shape(corners)["body.0.".len()..]);
    refused(
        BARRIER,
        &[&COARSE_BALL[..1], &[&elastic(&bow)]],
        &["body.0.shape", "the lines touch each other, or themselves"],
    );
}

#[test]
fn units_are_a_system_or_three_names() {
    for set in ["units=cgs", "units=si", "units=mm-g-s", "units={ length = \"mm\", mass = \"g\", time = \"ms\" }"] {
        legal(CHANNEL, &[&[set]]);
    }
    let own = "fluid.stabilisation={ set = \"paper-44-2019\", cip = { profile = \"paper\", gamma_1 = 0.007 } }";
    legal(BARRIER, &[&["units=si", own]]);
    refused(BARRIER, &[&["units=3"]], &["units", "the number `3`", "\"cgs\" or \"si\" or \"mm-g-s\" or a table"]);
}

#[test]
fn a_word_may_stand_for_a_table_with_its_kind() {
    let short = legal(CHANNEL, &[&["body.0.motion=fixed"]]);
    let long = legal(CHANNEL, &[&["body.0.motion={ kind = \"fixed\" }"]]);
    assert_eq!(short.scenario(), long.scenario());
    refused(
        CHANNEL,
        &[&["body.0.motion=rotating"]],
        &["body.0.motion", "rotating\", centre = ..., angular_velocity = ..."],
    );
    let material = "body.0.material=saint-venant-kirchhoff";
    refused(
        BARRIER,
        &[&[material]],
        &["body.0.material", "alone is not enough: write { kind = ", ", mu = ..., lambda = ... }"],
    );
    refused(CHANNEL, &[&["body.0.motion={ file = \"a.csv\" }"]], &["body.0.motion", "`kind` is missing"]);
}

#[test]
fn a_closed_domain_takes_in_as_much_as_it_gives() {
    let sides = |left: &str, right: &str| {
        let velocity =
            |side: &str, u: &str| format!("background.boundary.{side}={{ kind = \"velocity\", value = [{u}, 0] }}");
        let walls = ["bottom", "top"].map(|side| format!("background.boundary.{side}=no-slip"));
        [velocity("left", left), velocity("right", right)].into_iter().chain(walls).collect::<Vec<_>>()
    };
    let read_with = |left: &str, right: &str, motion: &str| {
        let sets = sides(left, right);
        let sets: Vec<&str> = sets.iter().map(String::as_str).chain([motion]).collect();
        parse(CHANNEL, &[&COARSE_CHANNEL, &sets]).and_then(|file| io::sizes(&file))
    };
    let read = |left: &str, right: &str| read_with(left, right, "body.0.motion={ kind = \"fixed\" }");
    let inflow = "\"6*y*(0.41-y)/0.41^2\"";
    read(inflow, inflow).expect("what comes in goes out");
    // Velocities that vanish together, up to round-off.
    read("\"y*(0.41-y)*0.5*(1-cos(2*pi*t))\"", "\"y*(0.41-y)*sin(pi*t)^2\"").expect("the same flow");
    let leaves = "body.0.motion={ kind = \"formula\", displacement = [\"0.1*t\", \"0\"] }";
    read_with("0.1", "0", leaves).expect("a body that may leave makes room");
    // Walls come first where they meet an inflow, so that the second flow is smaller than it says.
    for (left, right) in [(inflow, "0"), ("1", inflow), ("0", "\"0.1*t\""), ("-1", "1")] {
        let error = read(left, right).expect_err("a closed domain").to_string();
        assert!(error.contains("no side is open") && error.contains("background.boundary"), "{error}");
    }
}

const WALL: &str = "\"no-slip\"";
const FREE: &str = "\"free\"";
const SYMMETRY: &str = "\"symmetry\"";

/// Returns the scenario of a fluid and bodies, given by the text of their tables.
fn in_fluid(tables: &str) -> String {
    let head = "name = \"fluid\"\ndimension = 2\nunits = \"si\"\ntime = { step = 0.1, end = 1 }\nfluid = { density = 1, viscosity = 1 }\n";
    format!("{head}{tables}")
}

/// Builds a fluid and bodies.
fn built(tables: &str) -> Result<io::Sizes, Error> {
    parse(&in_fluid(tables), &[]).and_then(|file| io::sizes(&file))
}

/// Returns a square background with conditions on its left, right, lower and upper side.
fn square([left, right, bottom, top]: [&str; 4]) -> String {
    format!(
        "[background]\nkind = \"graded-box\"\nmin = [0, 0]\nmax = [4, 4]\nsize = 0.5\n\
         boundary = {{ left = {left}, right = {right}, bottom = {bottom}, top = {top} }}\n"
    )
}

/// Builds a block in a square of fluid.
fn in_square(sides: [&str; 4], shape: &str, block: &str) -> Result<io::Sizes, Error> {
    let shape = format!("shape = {{ kind = \"box\", {shape} }}");
    built(&format!("{}[[body]]\nname = \"block\"\n{shape}\n{block}\n", square(sides)))
}

/// A block whose free surface lies in the domain would be compressed.
#[test]
fn a_closed_domain_with_an_elastic_body_takes_in_no_more_than_it_gives() {
    let inflow = "{ kind = \"velocity\", value = [\"y*(4 - y)\", 0] }";
    let with = |min: &str, motion: &str, right: &str| {
        in_square([inflow, right, WALL, WALL], &format!("min = {min}, max = [3, 3], n = [2, 4]"), motion)
    };
    let elastic = "material = { kind = \"linear\", young = 100, poisson = 0.3 }\ndensity = 1\ngravity = [0, 0]\n";
    let clamped = format!("{elastic}boundary = {{ bottom = \"clamped\" }}");
    let moved = format!("{elastic}boundary = {{ bottom = {{ kind = \"displacement\", value = [0, \"-0.1*t\"] }} }}");
    for (min, motion) in [("[1, 1]", elastic), ("[1, 1]", &clamped), ("[1, 0]", &clamped)] {
        let error = with(min, motion, WALL).expect_err("a closed domain").to_string();
        assert!(error.contains("no side is open") && error.contains("background.boundary"), "{error}");
        with(min, motion, FREE).expect("an open side");
    }
    // These may leave the domain.
    for (min, motion) in [("[1, 0]", elastic), ("[1, -1]", &clamped), ("[1, 0]", &moved)] {
        with(min, motion, WALL).expect("a body that may make room");
    }
}

/// A box with four walls, and a piston with a given motion that starts in the left wall.
#[test]
fn a_given_motion_into_a_closed_domain_is_refused() {
    let with = |right: &str, motion: &str, more: &str| {
        in_square(
            [WALL, right, WALL, WALL],
            "min = [-1, 1], max = [1, 3], n = [2, 2]",
            &format!("motion = {motion}\n{more}"),
        )
    };
    let moving = |x: &str, y: &str| format!("{{ kind = \"formula\", displacement = [\"{x}\", \"{y}\"] }}");
    let error = with(WALL, &moving("0.5*t", "0"), "").expect_err("no room").to_string();
    let words = ["body.0.motion", "no side is open", "`block`", "at the time 3.444e-2", "3.444e-2 more of the domain"];
    check_words(&error, &words);
    with(FREE, &moving("0.5*t", "0"), "").expect("an open side");
    // Along the wall, inside, and together with a second piston that makes room, or may make room.
    with(WALL, &moving("0", "0.5*t"), "").expect("the same volume");
    with(WALL, &moving("2 + 0.5*t", "0"), "").expect("inside");
    let other = "[[body]]\nname = \"other\"\nshape = { kind = \"box\", min = [3, 1], max = [5, 3], n = [2, 2] }\n";
    let leaves = format!("{other}motion = {}", moving("0.5*t", "0"));
    with(WALL, &moving("0.5*t", "0"), &leaves).expect("as much in as out");
    let free = format!("{other}motion = {{ kind = \"free\" }}\ndensity = 1\ngravity = [0, 0]");
    with(WALL, &moving("0.5*t", "0"), &free).expect("a free piston");
}

/// An elastic box next to a plane of symmetry, which a condition, a contact with the plane or a wall on it holds.
#[test]
fn a_part_on_a_plane_of_symmetry_is_held() {
    let material = "material = { kind = \"neo-hookean\", mu = 100, lambda = 100 }\ndensity = 1\ngravity = [0, 0]";
    let with = |boundary: &str, contact: &str, corner: &str| {
        let block = format!("{material}\n{boundary}\n{contact}");
        in_square([SYMMETRY, FREE, WALL, WALL], &format!("min = {corner}, max = [1, 2], n = [2, 2]"), &block)
    };
    let contact = |obstacle: &str| {
        let law = "law = { kind = \"penalty\", gamma_contact_0 = 1e3 }\nsize = 0.1\noffset = 0.0";
        format!("[[contact]]\nbody = \"block\"\nobstacle = {obstacle}\n{law}\n")
    };
    let plane = |normal: &str| contact(&format!("{{ kind = \"rigid-plane\", point = [0, 0], normal = {normal} }}"));
    for loose in [String::new(), plane("[0, -1]"), contact("{ kind = \"wall\", parts = [\"bottom\"] }")] {
        let error = with("", &loose, "[0, 1]").expect_err("a loose part").to_string();
        assert!(error.contains("body.0.shape") && error.contains("plane of symmetry"), "{error}");
    }
    for stopped in [plane("[-1, 0]"), contact("{ kind = \"wall\", parts = [\"left\"] }")] {
        with("", &stopped, "[0, 1]").expect("a contact with the plane");
    }
    with("boundary = { left = \"symmetry\" }", "", "[0, 1]").expect("a condition");
    with("", "", "[0.5, 1]").expect("a box inside");
}

/// An elastic box at the height of a plane of symmetry, which ends to the left of it.
#[test]
fn a_plane_of_symmetry_ends_with_its_side() {
    let with = |corners: &str| {
        built(&format!(
            "[background]\nkind = \"polygon\"\ncorners = [[0, 0], [4, 0], [4, 4], [2, 4], [2, 2], [0, 2]]\nsize = 0.3\n\
             boundary = {{ side-1 = \"no-slip\", side-2 = \"free\", side-3 = \"no-slip\", side-4 = \"no-slip\", side-5 = \"symmetry\", \
             side-6 = \"no-slip\" }}\n[[body]]\nname = \"box\"\nshape = {{ kind = \"box\", {corners}, n = [2, 2] }}\n\
             material = {{ kind = \"neo-hookean\", mu = 100, lambda = 100 }}\ndensity = 1\ngravity = [0, 0]\n"
        ))
    };
    with("min = [2.5, 1], max = [3.5, 2]").expect("a box away from the side");
    assert!(with("min = [0.5, 1], max = [1.5, 2]").is_err());
}

/// A rod on the axis that enters a closed cylinder.
#[test]
fn a_rod_does_not_enter_a_closed_cylinder() {
    let with = |right: &str, y: &str| {
        let fluid = square([SYMMETRY, right, WALL, WALL]);
        built(&format!(
            "coordinates = \"axisymmetric\"\n{fluid}[[body]]\nname = \"rod\"\nshape = {{ kind = \"box\", min = [0, 3], max = [1, 5], n = [2, 2] }}\n\
             motion = {{ kind = \"formula\", displacement = [0, \"{y}\"] }}\n"
        ))
    };
    // The volume π 1² 0.5 t.
    let error = with(WALL, "-0.5*t").expect_err("no room").to_string();
    let words = ["body.0.motion", "no side is open", "`rod`", "at the time 3.444e-2", "5.410e-2 more of the domain"];
    check_words(&error, &words);
    with(FREE, "-0.5*t").expect("an open side");
    with(WALL, "-1.5 - 0.5*t").expect("inside");
    let ball = "-0.5*t\"] }\n[[body]]\nname = \"ball\"\nmotion = \"fixed\"\n\
                shape = { kind = \"half-ball\", centre = [0, 1], radius = 0.5, size = 0.25 } #";
    assert!(with(WALL, ball).expect_err("no room").to_string().contains("no side is open"));
}

#[test]
fn the_number_of_cells_is_known_before_the_mesh() {
    for (text, sets) in [(CHANNEL, &["background.size=0.02"][..]), (BARRIER, &COARSE_BALL)] {
        let file = legal(text, &[sets]);
        let expected = io::scenario::expected_cells(&file)[0].unwrap_or_else(|| panic!("a background"));
        let found = wet(&planar_case(&file)).background.n_cells() as f64;
        assert!((expected / found - 1.0).abs() < 0.15, "{expected} {found}");
    }
}

#[test]
fn elements_of_order_2_follow_the_circle() {
    let of_order = |order: &str| problem(BARRIER, &[&COARSE_BALL, &["body.0.shape.area_preserving=false", order]]);
    let [linear, quadratic] = ["body.0.order=1", "body.0.order=2"].map(of_order);
    let [body, round] = [&linear, &quadratic].map(|case| &case.setup.bodies[0]);
    // Edges on the plane of symmetry are straight.
    let facets: Vec<_> = round.surface().facets().collect();
    for node in round.surface().vertices_of(&facets) {
        let x = round.reference()[node.index()];
        assert!(x[0] == 0.0 || ((x - Point::<2>::new(0.0, 10.0)).norm() - 4.0).abs() < 1e-12, "{x}");
    }
    assert_eq!(round.surface().n_facets(), 2 * body.surface().n_facets());
    assert!(round.reference().len() > 3 * body.reference().len());
    let area = ["body.0.shape.area_preserving=true", "body.0.order=2"];
    refused(BARRIER, &[&COARSE_BALL, &area], &["area_preserving", "no effect with elements of order 2"]);
    refused(BARRIER, &[&COARSE_BALL, &["body.0.order=3"]], &["order", "from 1 to 2"]);
}

#[test]
fn axisymmetric_coordinates_make_a_ball_of_a_half_disk() {
    let sets = ["coordinates=axisymmetric"];
    let case = problem(BARRIER, &[&COARSE_BALL, &sets]);
    assert!(!case.half_domain);
    let (body, fluid) = (&case.setup.bodies[0], case.setup.fluid.as_ref().unwrap_or_else(|| panic!("a fluid")));
    assert!(fluid.background.coordinates().radial().is_some() && body.surface().coordinates().radial().is_some());
    // The ball of the case has the radius 4 and the density 1; its polygon lies inside of the circle.
    let mass = body.balance(&body.initial()).map_or(0.0, |balance| balance.mass);
    let whole = 4.0 / 3.0 * std::f64::consts::PI * 64.0;
    assert!(mass < whole && mass > 0.9 * whole, "{mass} {whole}");
    let expect = |set: &str, words: &[&str]| refused(BARRIER, &[&COARSE_BALL, &sets, &[set]], words);
    expect("background.boundary.left=no-slip", &["background.boundary", "side `left`", "axis of rotation", "symmetry"]);
    expect("body.0.shape.centre=[-1, 6]", &["body.0.shape", "x is the radius", "half-ball"]);
    expect("background.min=[-1, 0]", &["background", "radius -1"]);
}

#[test]
fn axisymmetric_rigid_bodies_move_along_the_axis_only() {
    problem(SPHERE, &[&["body.0.initial_velocity=[0.0, 5.0]"]]);
    refused(SPHERE, &[&["body.0.initial_velocity=[5.0, 0.0]"]], &["body.0.initial_velocity", "along the axis only"]);
    let motion = |given: &str| {
        let text = SPHERE.replace("{ kind = \"free\" }", given);
        refused(&text, &[], &["body.0.motion", "along the axis only"]);
    };
    motion("{ kind = \"free\", initial_spin = 3.0 }");
    for held in ["x", "rotation"] {
        let text = SPHERE.replace("{ kind = \"free\" }", &format!("{{ kind = \"free\", held = [\"{held}\"] }}"));
        refused(&text, &[], &["body.0.motion.held.0", "no effect with axisymmetric coordinates"]);
    }
    motion("{ kind = \"free\", guided = { until = 0.1, velocity = [\"2\", \"0\"] } }");
    let given = |given: &str| {
        let text = SPHERE.replace("motion  = { kind = \"free\" }", &format!("motion = {given}"));
        let text = text.replace("density = 2.0\ngravity = [0.0, -100.0]\n", "");
        refused(&text, &[], &["body.0.motion", "along the axis only"]);
    };
    given("{ kind = \"formula\", displacement = [\"0.1*t\", \"0\"] }");
    given("{ kind = \"formula\", displacement = [\"0\", \"0\"], angle = \"t\", centre = [0, 1.5] }");
    given("{ kind = \"rotating\", centre = [0, 1.5], angular_velocity = 1.0 }");
    let table = write("sideways.csv", "time,x,y\n0,0,0\n0.05,0.1,0\n");
    let text =
        SPHERE.replace("motion  = { kind = \"free\" }", "motion = { kind = \"table\", file = \"sideways.csv\" }");
    let text = text.replace("density = 2.0\ngravity = [0.0, -100.0]\n", "");
    let refused = mistake(parse_at(&table.with_file_name("case.toml"), &text, &[])).to_string();
    check_words(&refused, &["body.0.motion.file", "along the axis only"]);
}

/// The profile of a pipe with its axis on the left side.
#[test]
fn inflow_has_its_largest_velocity_on_the_axis() {
    let text = SPHERE
        .replace("bottom = \"no-slip\"", "bottom = { kind = \"inflow\", profile = \"parabolic\", maximum = 3.0 }");
    let case = problem(&text, &[]);
    let FluidBoundary::Velocity(velocity) = side(&case, "bottom") else { panic!("a velocity") };
    for radius in [0.0, 1.0, 2.0] {
        let found = velocity(&Point::<2>::new(radius, 0.0), 0.0);
        assert!(
            (found - Vector::<2>::new(0.0, 3.0 * (1.0 - radius * radius / 4.0))).norm() < 1e-12,
            "{radius} {found}"
        );
    }
}

/// A piston of given motion over the height of a channel: fluid behind it has no way out.
#[test]
fn a_closed_region_that_is_pressed_together_is_reported() {
    let piston = "[[body]]\nname = \"piston\"\n\
                  shape = { kind = \"box\", min = [1.83, -0.1], max = [2.27, 4.1], n = [2, 12] }\n\
                  motion = { kind = \"formula\", displacement = [\"-0.6*t\", 0] }\n";
    let change = |left: &str, name: &str| {
        let text = in_fluid(&(square([left, FREE, WALL, WALL]) + piston));
        let sets = ["time.step=0.02", "time.end=0.1", "fluid.viscosity=0.1", "output.vtk_every=0"];
        results(&legal(&text, &[&sets]), &fresh_directory(name)).closed_volume_change
    };
    // A length of 1.83 is shortened by 0.06.
    let found = change(WALL, "piston").expect("a closed region");
    assert!((found / (1.0_f64 - 0.06 / 1.83).ln() - 1.0).abs() < 0.02, "{found}");
    assert_eq!(change(FREE, "piston-open"), None);
}

/// A leaf that is clamped below a frictionless floor, a box beyond one corner of it, and a disk on it.
#[test]
fn bodies_reach_through_a_plane_of_symmetry_only_where_they_are_clamped() {
    let with = |body: &str| {
        let fluid = square([WALL, FREE, SYMMETRY, WALL]);
        built(&format!("{fluid}[[body]]\nname = \"leaf\"\ndensity = 1\ngravity = [0, 0]\n{body}\n"))
    };
    let leaf = |from: f64, n: usize, bottom: &str| {
        with(&format!(
            "shape = {{ kind = \"box\", min = [2, {from}], max = [2.2, 1], n = [1, {n}] }}\nmaterial = {{ kind = \"linear\", young = 1e3, poisson = 0.3 }}\n{bottom}"
        ))
    };
    let clamped = "boundary = { bottom = \"clamped\" }";
    leaf(-0.15, 1, clamped).expect("a root");
    let through = |found: Result<io::Sizes, Error>| {
        check_words(&found.expect_err("a body across").to_string(), &["body.0.shape", "crosses a plane of symmetry"])
    };
    through(leaf(-0.15, 1, ""));
    // Vertices on the plane, and beyond it without a clamp.
    through(leaf(-1.0, 2, ""));
    through(leaf(-1.0, 4, clamped));
    let disk = |y: f64| {
        with(&format!(
            "shape = {{ kind = \"ball\", centre = [2, {y}], radius = 0.3, size = 0.1 }}\nmotion = {{ kind = \"free\", held = [\"y\", \"rotation\"] }}"
        ))
    };
    through(disk(0.0));
    disk(0.3 + 1e-9).expect("a disk on the plane");
}

/// A leaf that is clamped above the frictionless ceiling of the low part of an L. The middle of the background is above
/// this ceiling, too.
#[test]
fn the_outside_of_a_plane_of_symmetry_is_that_of_its_side() {
    let leaf = |boundary: &str| {
        built(&format!(
            "[background]\nkind = \"polygon\"\nsize = 0.5\ncorners = [[0, 0], [4, 0], [4, 10], [2, 10], [2, 2], [0, 2]]\n[background.boundary]\n\
             side-1 = \"no-slip\"\nside-2 = \"no-slip\"\nside-3 = \"free\"\nside-4 = \"no-slip\"\nside-5 = \"symmetry\"\nside-6 = \"no-slip\"\n\
             [[body]]\nname = \"leaf\"\ndensity = 1\ngravity = [0, 0]\nshape = {{ kind = \"box\", min = [1, 1], max = [1.2, 2.15], n = [1, 1] }}\n\
             material = {{ kind = \"linear\", young = 1e3, poisson = 0.3 }}\nboundary = {{ {boundary} = \"clamped\" }}\n"
        ))
    };
    leaf("top").expect("clamped above the ceiling");
    check_words(
        &leaf("bottom").expect_err("a loose top").to_string(),
        &["body.0.shape", "crosses a plane of symmetry"],
    );
}

/// A jet into a chamber, by a given velocity and by a pressure: its kinetic energy comes from outside.
#[test]
fn the_energy_of_an_inflow_is_not_generated_by_steps() {
    for inlet in
        ["kind = \"inflow\", profile = \"parabolic\", maximum = 3.0, ramp = 0.1", "kind = \"parallel\", pressure = 6.0"]
    {
        let text = format!(
            "name = \"jet\"\ndimension = 2\nunits = \"si\"\ntime = {{ step = 0.02, end = 0.4 }}\n\
             fluid = {{ density = 1.0, viscosity = 0.002 }}\noutput = {{ vtk_every = 0 }}\n[background]\nkind = \"polygon\"\nsize = 0.2\n\
             corners = [[0, 0], [1, 0], [1, -1], [3, -1], [3, 1.5], [1, 1.5], [1, 0.5], [0, 0.5]]\n[background.boundary]\nside-8 = {{ {inlet} }}\n\
             side-4 = \"free\"\nside-1 = \"no-slip\"\nside-2 = \"no-slip\"\nside-3 = \"no-slip\"\nside-5 = \"no-slip\"\nside-6 = \"no-slip\"\n\
             side-7 = \"no-slip\"\n"
        );
        let summary = results(&legal(&text, &[]), &fresh_directory("jet"));
        assert!(
            summary.energy_generated.is_some_and(|generated| generated < 1e-3),
            "{inlet} {:?}",
            summary.energy_generated
        );
    }
}

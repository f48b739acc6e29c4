//! Errors in scenario files name file, line, key and remedy; most mistakes are in the table of the messages.

use std::path::Path;

use crate::setting::*;
use io::{Error, ScenarioFile, sizes};

const COARSE: [&str; 2] = ["background.size=1.0", "body.0.shape.size=1.0"];

/// Returns the text of the virtual barrier with `from` replaced by `to`, and the offset of the replacement.
fn with(from: &str, to: &str) -> (String, usize) {
    let at = BARRIER.find(from).unwrap_or_else(|| panic!("the case contains {from}"));
    (BARRIER.replacen(from, to, 1), at)
}

/// Replaces `from` by `to`, and expects an error at that line and key whose text contains all the given words.
fn expect(from: &str, to: &str, key: &str, words: &[&str]) {
    let (text, begin) = with(from, to);
    expect_at(&text, begin, key, words);
}

fn expect_at(text: &str, begin: usize, key: &str, words: &[&str]) {
    // A change of the size would hide a mistake in it.
    let sets = if key.starts_with("background.size") { &COARSE[1..] } else { &COARSE };
    check_place(mistake(parse(text, &[sets])), text, begin, key, words);
}

#[test]
fn unknown_keys() {
    expect("radius = 4.0", "radios = 4.0", "body.0.shape.radios", &["did you mean `radius`?"]);
    let cip = |key| format!("{{ cip = {{ profile = \"paper\"{key} }} }}\n");
    let place = "fluid.stabilisation.cip";
    expect("\"paper-44-2019\"\n", &cip(", gamma_2 = 0.7"), &format!("{place}.gamma_2"), &["did you mean `gamma_1`?"]);
    expect("fine_until = 4.5", "fine_untill = 4.5", "background.size.fine_untill", &["did you mean `fine_until`?"]);
    expect("mu = 2.0e6", "nu = 2.0e6", "body.0.material.nu", &["did you mean `mu`?"]);
    expect("size     = 0.1  ", "sizes = 0.1", "contact.0.sizes", &["did you mean `size`?"]);
}

#[test]
fn a_number_after_a_single_table_is_no_key() {
    let single = BARRIER.replace("[[contact]]", "[contact]");
    let error = parse(&single, &[&["contact.0.size=0.2"]]).map(drop).expect_err("a mistake").to_string();
    assert!(error.contains("`contact` is one table here, not a list: write contact.size"), "{error}");
    assert!(error.starts_with("--set contact.0.size=0.2: contact.0"), "{error}");
    legal(&single, &[&["contact.size=0.2"]]);
}

#[test]
fn unknown_values() {
    expect("\"half-ball\"", "\"half-bal\"", "body.0.shape.kind", &["did you mean `half-ball`?"]);
    expect("\"penalty\"", "\"springs\"", "contact.0.law.kind", &["unknown value `springs`", "penalty"]);
    expect("axis = \"y\"", "axis = \"w\"", "background.size.axis", &["unknown value `w`"]);
}

#[test]
fn missing_values() {
    let cip = "{ cip = { profile = \"paper\" } }\n";
    expect("\"paper-44-2019\"\n", cip, "fluid.stabilisation.cip", &["`gamma_1` is missing"]);
    expect("radius = 4.0, ", "", "body.0.shape", &["`radius` is missing"]);
}

#[test]
fn the_solver_may_be_left_out() {
    let without = &BARRIER[..BARRIER.find("[solver]").expect("the last section")];
    let sizes = |text: &str| sizes(&parse(text, &[&COARSE]).expect("a scenario")).expect("sizes");
    let newton = |text: &str| parse(text, &[]).expect("a scenario").scenario().solver.newton.clone();
    assert_eq!(newton(without), newton(BARRIER));
    assert_eq!(sizes(without).linear, "gmres, lagged-lu (matrices change little from step to step)");
    assert_eq!(sizes(BARRIER).linear, "gmres, lagged-lu (given in the scenario)");
}

#[test]
fn wrong_types() {
    expect("radius = 4.0", "radius = true", "body.0.shape.radius", &["boolean `true`", "a number"]);
    expect("max_iterations = 30", "max_iterations = 2.5", "solver.newton.max_iterations", &["a whole number"]);
    expect("bottom = \"no-slip\"", "bottom = 3", "background.boundary.bottom", &["\"no-slip\"", "a table with a kind"]);
}

#[test]
fn numbers_out_of_range() {
    expect("density  = 1.0 ", "density = -1.0", "body.0.density", &["-1", "positive"]);
    expect("gamma_contact_0 = 1.0e8", "gamma_contact_0 = 0.0", "contact.0.law.gamma_contact_0", &["positive"]);
    expect("units     =", "interface = { alpha = 1.5 }\nunits =", "interface.alpha", &["from 0 to 1"]);
    expect("min  = [0.0, 0.0]", "min = [0.0, 0.0, 0.0]", "background.min", &["3 components", "dimension = 2 needs 2"]);
}

#[test]
fn regions_of_the_background() {
    let refine = |near: &str, more: &str, key: &str, words: &[&str]| {
        let key = format!("background.refine.0{key}");
        let region = format!("refine = [{{ near = {{ {near} }}, {more} }}] #");
        expect("# mirrored = true", &region, &key, words);
    };
    let ball = "kind = \"ball\", centre = [2.0, 3.0], radius = 1.0";
    refine(ball, "size = 0.0", ".size", &["positive"]);
    refine(ball, "size = 0.1, growth = 0.9", ".growth", &["from 0.01 to 0.5"]);
    refused(BARRIER, &[&["background.size=1e-3"]], &["background.size", "cells need at least", "GiB are available"]);
    refine(
        &ball.replace("2.0", "-2.0"),
        "size = 0.1",
        "",
        &["coordinate of the region is -2.0", "within the background"],
    );
    refine("kind = \"line\", from = [2.0, 1.0], to = [2.0]", "size = 0.1", ".near.to", &["1 components"]);
    let outside = "kind = \"box\", min = [22.0, 1.0], max = [23.0, 2.0]";
    refine(outside, "size = 0.1", "", &["lowest corner of the region is 22.0", "within the background"]);
    refine("kind = \"sphere\"", "size = 0.1", ".near.kind", &["unknown value `sphere`", "ball"]);
}

#[test]
fn a_step_that_divides_to_round_off_is_accepted() {
    legal(&with("step = 1.0e-3", "step = 0.000333333333333333").0, &[]);
}

#[test]
fn blocks_of_a_preconditioner() {
    let key = |key: &str| format!("solver.linear.{key}");
    let lagged = "\"lagged-lu\" }";
    let sweep = |more: &str| format!("\"block-gauss-seidel\", {more} }}");
    let blocks = "blocks = { fluid = \"lu\", bodies = \"ilut\" }";
    for more in ["restart = 30", blocks, &format!("restart = 30, {blocks}")] {
        legal(&with(lagged, &sweep(more)).0, &[]);
    }
    let fluid = "blocks = { fluid = \"cholesky\", bodies = \"lu\" }";
    expect(lagged, &sweep(fluid), &key("blocks.fluid"), &["unknown value `cholesky`", "ilut"]);
    expect(lagged, &sweep("blocks = { fluid = \"lu\" }"), &key("blocks"), &["`bodies` is missing"]);
    expect(lagged, &sweep("restart = 0"), &key("restart"), &["at least 1"]);
    expect(lagged, "\"lagged-lu\", restart = 30 }", &key("restart"), &["no effect", "lagged-lu"]);
}

#[test]
fn unknown_names() {
    let body = "obstacle = { kind = \"body\", name = \"ground\" } #";
    expect("obstacle = {", body, "contact.0.obstacle.name", &["unknown body `ground`", "ball"]);
    expect("right = \"free\"", "rigth = \"free\"", "background.boundary.rigth", &["did you mean `right`?"]);
}

const SECOND: &str = r#"
[[body]]
name     = "block"
shape    = { kind = "box", min = [3.0, 6.5], max = [9.0, 8.5], size = 1.0 }
material = { kind = "saint-venant-kirchhoff", young = 5.6e6, poisson = 0.4 }
density  = 1.0
gravity  = [0.0, 0.0]
"#;

#[test]
fn a_body_inside_of_another_overlaps_it() {
    let text = format!("{BARRIER}{SECOND}")
        .replace("min = [3.0, 6.5], max = [9.0, 8.5]", "min = [1.0, 9.0], max = [2.0, 11.0]");
    let begin = text.rfind("shape ").expect("a shape");
    expect_at(&text, begin, "body.1.shape", &["overlap"]);
}

#[test]
fn bodies_may_stick_out() {
    let apart = format!("{BARRIER}{SECOND}")
        .replace("min = [3.0, 6.5], max = [9.0, 8.5]", "min = [5.0, 1.0], max = [12.0, 2.0]");
    let found = sizes(&legal(&apart, &[&COARSE])).expect("legal");
    assert!(
        found.bodies.len() == 2 && found.warnings.is_empty(),
        "the side is open, and the ball stands on a plane of symmetry"
    );
    let walls = sizes(&legal(&apart, &[&COARSE, &["background.boundary.right=no-slip"]])).expect("legal");
    assert!(
        matches!(&walls.warnings[..], [line] if line.contains("body block reaches 2.000e0 cm through side right")),
        "{:?}",
        walls.warnings
    );
    assert!(walls.lines.contains(&walls.warnings[0]));
}

/// A ball in the notch of a domain that is shaped like an L.
#[test]
fn bodies_beside_a_domain_that_is_not_convex_are_away() {
    let text = "name = \"notch\"\ndimension = 2\nunits = \"si\"\n[time]\nstep = 0.1\nend = 0.1\n[fluid]\ndensity = 1\n\
                viscosity = 1\n[background]\nkind = \"polygon\"\nsize = 0.2\n\
                corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]\n\
                boundary = { side-1 = \"no-slip\", side-2 = \"parallel\", side-3 = \"no-slip\", side-4 = \"no-slip\", \
                side-5 = \"no-slip\", side-6 = \"no-slip\" }\n\
                [[body]]\nname = \"ball\"\nmotion = \"free\"\ndensity = 2\ngravity = [0, -1]\n\
                shape = { kind = \"ball\", centre = [1.6, 1.6], radius = 0.2, size = 0.1 }\n";
    let error = sizes(&legal(text, &[])).expect_err("in the notch").to_string();
    assert!(error.contains("case.toml:20: body.0.shape: body `ball` is outside of the domain"), "{error}");
    assert!(sizes(&legal(&text.replace("[1.6, 1.6]", "[0.5, 1.6]"), &[])).is_ok());
}

#[test]
fn extents_are_printed_with_their_unit() {
    let apart = format!("{BARRIER}{SECOND}").replace("min = [3.0, 6.5]", "min = [7.0, 6.5]");
    let lines = sizes(&legal(&apart, &[&COARSE])).expect("sizes").lines;
    let line = |begin: &str| lines.iter().find(|line| line.starts_with(begin)).expect("a line");
    assert!(line("body block: ").contains(" 2.0 x 2.0 cm, "), "{lines:#?}");
    assert!(line("background: ").contains(" cm, "), "{lines:#?}");
}

#[test]
fn changes_from_the_command_line() {
    let changes = [
        "time.step=5e-4",
        "body.0.density=2",
        "fluid.stabilisation={cip={profile=\"consistent\", gamma_u=0.2}}",
        "background.boundary.left=free",
        "output.vtk_every=3",
        "background.mirrored=true",
    ];
    let file = legal(BARRIER, &[&changes]);
    let scenario = file.scenario();
    assert_eq!(
        (*scenario.time.step, *scenario.body[0].density.clone().expect("given"), file.n_steps()),
        (5e-4, 2.0, 500)
    );
    assert_eq!(scenario.output.vtk_every, 3);
    // A section that is not in the file is made.
    let text = BARRIER.replace("[output]  ", "#").replace("vtk_every   = 10", "#").replace("compression = 0", "#");
    let file = legal(&text, &[&["output.vtk_every=7"]]);
    assert_eq!((file.scenario().output.vtk_every, file.scenario().output.compression), (7, 0));
}

#[test]
fn mistakes_on_the_command_line_name_the_argument() {
    for (set, key, word) in [
        ("time.step=7e-4", "time.step", "does not divide"),
        ("body.0.shape.radius=nan", "body.0.shape.radius", "finite"),
        ("contact.0.obstacle.normal=[0.0, 0.0]", "contact.0.obstacle.normal", "direction"),
    ] {
        let error = mistake(parse(BARRIER, &[&COARSE, &[set]]));
        let message = error.to_string();
        let Error::Scenario(error) = error else { panic!("not an error of the scenario: {message}") };
        assert_eq!((error.at.argument.as_deref(), error.at.key.as_str()), (Some(set), key), "{message}");
        assert!(message.starts_with(&format!("--set {set}")) && message.contains(word), "{message}");
    }
}

#[test]
fn every_scenario_survives_writing_and_reading() {
    let folders = ["validation/cases", "examples"].map(|f| Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(f));
    let mut n = 0;
    for entry in folders.iter().flat_map(|folder| std::fs::read_dir(folder).expect("the cases")) {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        check_text(&ScenarioFile::read(&path, &[]).unwrap_or_else(|e| panic!("{e}")));
        n += 1;
    }
    assert!(n > 0);
}

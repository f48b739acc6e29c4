//! The space dimension: one const parameter without bounds, with literal values in a few files only.

use super::source::words;
use super::tree::{Finding, SourceTree};

/// Files that may contain a literal dimension outside of tests.
const LEAVES: &[&str] = &[
    "crates/mesh/src/tensor.rs",
    "crates/mesh/src/simplex.rs",
    "crates/mesh/src/simplex_mesh.rs",
    "crates/mesh/src/search/parry.rs",
    "crates/mesh/src/generate/graded_box.rs",
    "crates/mesh/src/generate/ball.rs",
    "crates/mesh/src/generate/inside.rs",
    "crates/solid-rigid/src/modes.rs",
    "crates/solid-svk/src/deformation.rs",
    "crates/solid-svk/src/material/mod.rs",
    "crates/contact/src/frame.rs",
    "crates/report/src/frames.rs",
    "crates/cutcell/src/surface.rs",
    "crates/cutcell/src/soundness.rs",
    "crates/cutcell/src/tree.rs",
    "crates/cutcell/src/exact/crossing.rs",
    "crates/cutcell/src/exact/plane.rs",
    "crates/cutcell/src/exact/planes.rs",
    "crates/cutcell/src/clip/face.rs",
    "crates/cutcell/src/clip/piece.rs",
    "crates/cutcell/src/clip/polygon.rs",
    "crates/io/src/scenario/background.rs",
    "crates/io/src/scenario/case.rs",
    "crates/io/src/scenario/geometry.rs",
    "crates/io/src/vtk/mod.rs",
    "crates/io/src/vtk/fluid.rs",
    "crates/io/src/history.rs",
    "crates/io/src/surface/mod.rs",
    "crates/io/src/gmsh/mesh.rs",
    "crates/io/src/mesh_file.rs",
    "crates/io/src/cut/mod.rs",
    "crates/io/src/cut/background.rs",
    "crates/io/src/cut/placement.rs",
];

/// Files of dense blocks, which have the sizes of their fields: numbers of components, not of dimensions.
const BLOCKS: &[&str] = &["crates/algebra/src/layout.rs", "crates/algebra/src/local_system.rs"];

/// Forms of a literal dimension.
const LITERALS: &[&str] =
    &["match D ", "D == 1", "D == 2", "D == 3", "D != 2", "D != 3", "D < 3", "D > 2", "<2>", "<3>", "D >= 3", "D <= 2"];

/// File of this list.
const LIST: &str = "xtask/src/tidy/dimensions.rs";

/// Folder of the packages with one dimension parameter.
const GENERIC: &str = "crates/";

/// Finds bounds on the dimension, second dimension parameters and literal dimensions.
pub(super) fn check(tree: &SourceTree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for source in tree.rust.iter().filter(|source| source.path.starts_with(GENERIC) && source.is_src()) {
        let code = source.code();
        for offset in words(code, "where") {
            let clause = code[offset..].split("{").flat_map(|part| part.split(";\n")).next().unwrap_or_default();
            if words(clause, "D").next().is_some() {
                let advice = "a where-clause with D: use a run-time length or `match D`";
                findings.push(Finding::new(&source.path, source.line_at(offset), advice));
            }
        }
        let is_leaf = LEAVES.contains(&source.path.as_str());
        let mut has_literal = false;
        for (number, line) in source.code_lines() {
            let is_other = !line.contains("const D: usize") && line.contains(": usize>") && line.contains("const ");
            if is_other && !BLOCKS.contains(&source.path.as_str()) {
                let advice = "a const parameter other than `const D: usize`: D + 1 is a run-time length";
                findings.push(Finding::new(&source.path, number, advice));
            }
            let Some(literal) = LITERALS.iter().find(|literal| line.contains(*literal)) else { continue };
            has_literal = true;
            if !is_leaf {
                let advice =
                    format!("literal dimension `{}`: use a function of one of the files in {LIST}", literal.trim());
                findings.push(Finding::new(&source.path, number, advice));
            }
        }
        if is_leaf && !has_literal {
            let advice = format!("no literal dimension: remove the file from the list in {LIST}");
            findings.push(Finding::new(&source.path, 1, advice));
        }
    }
    findings
}

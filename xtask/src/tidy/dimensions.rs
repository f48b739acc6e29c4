//! Dimension is one const parameter without bounds; only leaves know its values.

use super::source::words;
use super::{Finding, Workspace};

/// Files that may contain a literal dimension outside of tests. The shorter, the better.
const LEAVES: [&str; 23] = [
    "crates/mesh/src/tensor.rs",
    "crates/mesh/src/simplex.rs",
    "crates/mesh/src/simplex_mesh.rs",
    "crates/mesh/src/placement.rs",
    "crates/mesh/src/search/parry.rs",
    "crates/mesh/src/generate/graded_box.rs",
    "crates/solid-rigid/src/modes.rs",
    "crates/cutcell/src/surface.rs",
    "crates/cutcell/src/soundness.rs",
    "crates/cutcell/src/tree.rs",
    "crates/cutcell/src/exact/crossing.rs",
    "crates/cutcell/src/exact/planes.rs",
    "crates/cutcell/src/clip/face.rs",
    "crates/cutcell/src/clip/piece.rs",
    "crates/cutcell/src/clip/polygon.rs",
    "crates/io/src/scenario/lower.rs",
    "crates/io/src/vtk/cut.rs",
    "crates/io/src/vtk/fluid.rs",
    "crates/io/src/plot/mod.rs",
    "crates/io/src/surface/mod.rs",
    "crates/io/src/cut/mod.rs",
    "crates/io/src/cut/background.rs",
    "crates/io/src/cut/placement.rs",
];

/// What a literal dimension looks like.
const LITERALS: [&str; 12] =
    ["match D ", "D == 1", "D == 2", "D == 3", "D != 2", "D != 3", "D < 3", "D > 2", "<2>", "<3>", "D >= 3", "D <= 2"];

/// Where the list of leaves is.
const LIST: &str = "xtask/src/tidy/dimensions.rs";

/// Packages with libraries of one dimension parameter.
const GENERIC: &str = "crates/";

/// Looks for bounds on the dimension, second dimension parameters and literal dimensions.
pub(super) fn check(workspace: &Workspace) -> Vec<Finding> {
    let mut findings = Vec::new();
    for source in workspace.rust.iter().filter(|source| source.path.starts_with(GENERIC) && source.is_src()) {
        let code = source.code();
        for offset in words(code, "where") {
            let clause = code[offset..].split("{").flat_map(|part| part.split(";\n")).next().unwrap_or_default();
            if words(clause, "D").next().is_some() {
                let advice = "a where-clause with D: use a run-time length or `match D` in a leaf";
                findings.push(Finding::new(&source.path, source.line_at(offset), advice));
            }
        }
        let is_leaf = LEAVES.contains(&source.path.as_str());
        let mut has_literal = false;
        for (number, line) in source.code_lines() {
            if line.matches("const D: usize").count() == 0 && line.contains(": usize>") && line.contains("const ") {
                let advice = "a const parameter other than `const D: usize`: D + 1 is a run-time length";
                findings.push(Finding::new(&source.path, number, advice));
            }
            let Some(literal) = LITERALS.iter().find(|literal| line.contains(*literal)) else { continue };
            has_literal = true;
            if !is_leaf {
                let advice = format!("literal dimension `{}`: ask a leaf ({LIST})", literal.trim());
                findings.push(Finding::new(&source.path, number, advice));
            }
        }
        if is_leaf && !has_literal {
            let advice = format!("no literal dimension any more: take the file off the list of leaves in {LIST}");
            findings.push(Finding::new(&source.path, 1, advice));
        }
    }
    findings
}

//! Folders and files that may use each third-party crate.

use super::source::words;
use super::tree::{Finding, SourceTree};

/// Third-party crates with the folders and files that may use them. Tests and benchmarks may use every dependency of
/// their manifest.
const ALLOWED: &[(&str, &[&str])] = &[
    ("nalgebra", &["crates"]),
    ("parry2d-f64", &["crates/mesh/src/search/parry.rs"]),
    ("parry3d-f64", &["crates/mesh/src/search/parry.rs"]),
    ("spade", &["crates/mesh/src/generate/triangulate.rs", "crates/mesh/src/generate/inside.rs"]),
    ("robust", &["crates/mesh/src", "crates/cutcell/src/exact/crossing.rs"]),
    ("smallvec", &["crates/cutcell/src"]),
    ("sprs", &["crates/algebra/src"]),
    ("faer", &["crates/algebra/src/linear"]),
    ("pulp", &["crates/algebra/src/linear/static_factors.rs"]),
    (
        "rayon",
        &[
            "crates/algebra/src/scatter",
            "crates/cutcell/src/cutter.rs",
            "crates/cutcell/src/touched.rs",
            "crates/cutcell/src/soundness.rs",
            "crates/xfem-space/src",
            "validation/src/workers.rs",
        ],
    ),
    ("rand", &["crates/io/src/cut/placement.rs", "crates/solid-svk/src/material/check.rs", "validation/src/verify"]),
    (
        "rand_xoshiro",
        &["crates/io/src/cut/placement.rs", "crates/solid-svk/src/material/check.rs", "validation/src/verify"],
    ),
    ("thiserror", &["crates", "validation"]),
    (
        "serde",
        &[
            "crates/io/src/checkpoint.rs",
            "crates/io/src/energies.rs",
            "crates/io/src/summary.rs",
            "crates/io/src/cut",
            "crates/io/src/scenario/file.rs",
            "crates/report/src",
            "validation/src",
        ],
    ),
    (
        "serde_json",
        &["crates/io/src", "crates/report/src", "crates/cutwater/src/commands", "validation/src", "xtask/src"],
    ),
    ("toml", &["crates/io/src", "validation/src"]),
    ("strsim", &["crates/io/src/scenario/error.rs"]),
    ("vtkio", &["crates/io/src"]),
    ("plotters", &["validation/src/chart.rs"]),
    ("base64", &["crates/report/src/frames.rs"]),
    ("clap", &["crates/cutwater/src/main.rs", "crates/cutwater/src/commands", "validation/src", "xtask/src"]),
    ("ctrlc", &["crates/cutwater/src/commands/run.rs"]),
    ("signal-hook", &["crates/cutwater/src/commands/run.rs"]),
    ("crc32fast", &["crates/io/src/checkpoint.rs"]),
    ("indicatif", &["crates/cutwater/src", "validation/src"]),
    ("criterion", TESTS_ONLY),
    ("proptest", TESTS_ONLY),
    ("libtest-mimic", TESTS_ONLY),
    ("i_overlay", TESTS_ONLY),
    ("png", &["crates/report/src"]),
];

const TESTS_ONLY: &[&str] = &[];

/// The package without nalgebra: it has no space dimension.
const WITHOUT_NALGEBRA: &str = "crates/algebra/";

/// Compares manifests and code with the table.
pub(super) fn check(tree: &SourceTree) -> Vec<Finding> {
    let mut findings = Vec::new();
    let ours: Vec<&str> = tree.manifests().map(|(name, ..)| name).collect();
    for (name, manifest, dependencies) in tree.manifests() {
        let folder = manifest.trim_end_matches("Cargo.toml").to_owned();
        for (dependency, kind) in dependencies {
            if ours.contains(&dependency) {
                continue;
            }
            let line = tree.manifest_line(&manifest, dependency);
            let Some((_, places)) = ALLOWED.iter().find(|(package, _)| *package == dependency) else {
                let advice =
                    format!("`{dependency}` is not in the list of third_party.rs: use a crate of the list, or add it");
                findings.push(Finding::new(&manifest, line, advice));
                continue;
            };
            let is_allowed =
                places.iter().any(|place| place.starts_with(&folder) || folder.starts_with(&format!("{place}/")));
            if kind == "normal" && (!is_allowed || (dependency == "nalgebra" && folder == WITHOUT_NALGEBRA)) {
                let advice = format!("`{name}` must not depend on `{dependency}`: allowed in {}", places.join(", "));
                findings.push(Finding::new(&manifest, line, advice));
            }
        }
    }
    for source in tree.rust.iter().filter(|source| source.is_src()) {
        for (package, places) in ALLOWED {
            let is_allowed = |place: &&str| source.path == *place || source.path.starts_with(&format!("{place}/"));
            if places.iter().any(is_allowed) {
                continue;
            }
            let name = package.replace('-', "_");
            let offset = words(source.code(), &name).find(|&offset| is_path(source.code(), offset, name.len()));
            if let Some(offset) = offset {
                let advice = format!("`{package}` must not be used in this file: use it only in {}", places.join(", "));
                findings.push(Finding::new(&source.path, source.line_at(offset), advice));
            }
        }
    }
    findings
}

/// Returns whether the word at an offset begins a path: `name::...` or `use name;`, but not `#[name(...)]`.
fn is_path(code: &str, offset: usize, len: usize) -> bool {
    let before = code[..offset].trim_end();
    let is_first = !before.ends_with("::") && !before.ends_with("mod") && !before.ends_with('.');
    let after = &code[offset + len..];
    is_first && (after.starts_with("::") || (before.ends_with("use") && after.starts_with([';', ' '])))
}

//! Allowed dependencies between the packages.

use super::tree::{Finding, SourceTree};

/// Every package with the packages that it may use, and the ones that only its tests may use.
const LAYERS: &[(&str, &str, &str)] = &[
    ("mesh", "", ""),
    ("algebra", "", ""),
    ("cutcell", "mesh", ""),
    ("xfem-space", "mesh cutcell", ""),
    ("fluid-ns", "mesh cutcell xfem-space algebra", ""),
    ("body", "mesh algebra", ""),
    ("solid-rigid", "mesh algebra body", ""),
    ("solid-svk", "mesh algebra body", ""),
    ("interface-dg", "mesh cutcell xfem-space algebra body fluid-ns", ""),
    ("contact", "mesh algebra body", "solid-svk"),
    ("solver", "mesh algebra body cutcell xfem-space fluid-ns interface-dg contact", "solid-rigid solid-svk"),
    ("io", SIMULATION, ""),
    ("report", "mesh solver io", ""),
    ("cutwater", EVERYTHING, ""),
    ("validation", "cutwater benchmarks", ""),
    ("benchmarks", SIMULATION, ""),
    ("xtask", "", ""),
];

const SIMULATION: &str =
    "mesh algebra body cutcell xfem-space fluid-ns solid-rigid solid-svk interface-dg contact solver";
const EVERYTHING: &str =
    "mesh algebra body cutcell xfem-space fluid-ns solid-rigid solid-svk interface-dg contact solver io report";

/// Compares the manifests with the table.
pub(super) fn check(tree: &SourceTree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (name, manifest, dependencies) in tree.manifests() {
        let Some((_, uses, tests_use)) = LAYERS.iter().find(|(package, ..)| *package == name) else {
            let advice =
                format!("`{name}` is not in xtask/src/tidy/layers.rs: list there the packages that it may use");
            findings.push(Finding::new(&manifest, 1, advice));
            continue;
        };
        for (dependency, kind) in dependencies {
            let is_ours = LAYERS.iter().any(|(package, ..)| *package == dependency);
            let lists = |packages: &str| packages.split(' ').any(|package| package == dependency);
            let is_allowed = lists(uses) || (kind == "dev" && lists(tests_use));
            if is_ours && !is_allowed {
                let line = tree.manifest_line(&manifest, dependency);
                let advice = format!(
                    "`{name}` must not use `{dependency}` ({kind}): move the shared code below both, or change the design \
                     first (docs/ARCHITECTURE.md, xtask/src/tidy/layers.rs)"
                );
                findings.push(Finding::new(&manifest, line, advice));
            }
        }
    }
    for (package, ..) in LAYERS {
        if !tree.manifests().any(|(name, ..)| name == *package) {
            findings.push(Finding::new("Cargo.toml", 1, format!("`{package}` is in the layers, not in the workspace")));
        }
    }
    findings
}

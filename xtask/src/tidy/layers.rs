//! Who may depend on whom inside of the workspace.

use super::{Finding, Workspace};

/// Every package with the packages that it may use; any package may use the third list in its tests only.
const LAYERS: [(&str, &[&str], &[&str]); 15] = [
    ("mesh", &[], &[]),
    ("algebra", &[], &[]),
    ("cutcell", &["mesh"], &[]),
    ("xfem-space", &["mesh", "cutcell", "algebra"], &[]),
    ("fluid-ns", &["mesh", "cutcell", "xfem-space", "algebra"], &[]),
    ("solid-rigid", &["mesh", "algebra"], &[]),
    ("solid-svk", &["mesh", "algebra"], &[]),
    ("interface-dg", &["mesh", "cutcell", "xfem-space", "algebra", "fluid-ns", "solid-svk"], &[]),
    ("contact", &["mesh", "algebra"], &["solid-svk"]),
    ("solver", NUMERICS, &[]),
    ("io", SIMULATION, &[]),
    ("cutwater", EVERYTHING, &[]),
    ("validation", &["cutwater", "benchmarks"], &[]),
    ("benchmarks", SIMULATION, &[]),
    ("xtask", &[], &[]),
];

const NUMERICS: &[&str] =
    &["mesh", "algebra", "cutcell", "xfem-space", "fluid-ns", "solid-rigid", "solid-svk", "interface-dg", "contact"];
const SIMULATION: &[&str] = &[
    "mesh",
    "algebra",
    "cutcell",
    "xfem-space",
    "fluid-ns",
    "solid-rigid",
    "solid-svk",
    "interface-dg",
    "contact",
    "solver",
];
const EVERYTHING: &[&str] = &[
    "mesh",
    "algebra",
    "cutcell",
    "xfem-space",
    "fluid-ns",
    "solid-rigid",
    "solid-svk",
    "interface-dg",
    "contact",
    "solver",
    "io",
];

/// Compares the manifests with the table.
pub(super) fn check(workspace: &Workspace) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (name, manifest, dependencies) in workspace.manifests() {
        let Some((_, uses, tests_use)) = LAYERS.iter().find(|(package, ..)| *package == name) else {
            let advice = format!("`{name}` is not in xtask/src/tidy/layers.rs: say there what it may use");
            findings.push(Finding::new(&manifest, 1, advice));
            continue;
        };
        for (dependency, kind) in dependencies {
            let is_ours = LAYERS.iter().any(|(package, ..)| *package == dependency);
            let is_allowed = uses.contains(&dependency) || (kind == "dev" && tests_use.contains(&dependency));
            if is_ours && !is_allowed {
                let line = workspace.manifest_line(&manifest, dependency);
                let advice = format!(
                    "`{name}` must not use `{dependency}` ({kind}): move what you need below both, or change the \
                     design first (docs/ARCHITECTURE.md, xtask/src/tidy/layers.rs)"
                );
                findings.push(Finding::new(&manifest, line, advice));
            }
        }
    }
    for (package, ..) in LAYERS {
        if !workspace.manifests().any(|(name, ..)| name == package) {
            findings.push(Finding::new("Cargo.toml", 1, format!("`{package}` is in the layers, not in the workspace")));
        }
    }
    findings
}

//! `cargo xtask package`: the archives of all library crates, as they would be published.

use crate::process::{Outcome, cargo, succeeds};

/// The crates in the order in which they are published: each after those that it uses.
const ORDER: [&str; 14] = [
    "mesh",
    "algebra",
    "body",
    "cutcell",
    "xfem-space",
    "fluid-ns",
    "solid-rigid",
    "solid-svk",
    "interface-dg",
    "contact",
    "solver",
    "io",
    "report",
    "cutwater",
];

/// Flags of the task.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Compile each crate from its archive too.
    #[arg(long)]
    verify: bool,
}

/// Makes the archives of all crates. With `verify`, Cargo compiles each crate against the archives of the others, since
/// they are not in a registry.
pub(crate) fn run(arguments: &Arguments) -> Outcome {
    // The archives are for inspection, also of changes that are not committed yet.
    let mut command = cargo(&["package", "--allow-dirty"]);
    if !arguments.verify {
        command.arg("--no-verify");
    }
    ORDER.iter().for_each(|name| _ = command.args(["--package", name]));
    let is_done = succeeds(&mut command)?;
    if is_done {
        println!("package: {} archives in target/package; publish in the order {}", ORDER.len(), ORDER.join(", "));
    }
    Ok(is_done)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn has_key(manifest: &str, key: &str) -> bool {
        let begins = [format!("{key}.workspace"), format!("{key} =")];
        manifest.lines().any(|line| begins.iter().any(|begin| line.starts_with(begin)))
    }

    #[test]
    fn all_crates_are_listed_in_their_order() {
        let root = crate::process::root();
        let folders = std::fs::read_dir(root.join("crates")).expect("the crates");
        let mut names: Vec<String> =
            folders.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        let mut listed = ORDER.map(str::to_owned).to_vec();
        listed.sort();
        assert_eq!(names, listed);
        for (k, name) in ORDER.iter().enumerate() {
            let manifest =
                std::fs::read_to_string(root.join("crates").join(name).join("Cargo.toml")).expect("a manifest");
            for key in ["description", "license", "readme", "keywords", "categories"] {
                assert!(has_key(&manifest, key), "{name} has no {key}");
            }
            let needed = manifest.split("[dev-dependencies]").next().unwrap_or_default();
            // No crate depends on itself or on a crate that is published after it.
            for later in &ORDER[k..] {
                assert!(!has_key(needed, later), "{name} uses {later}");
            }
        }
    }
}

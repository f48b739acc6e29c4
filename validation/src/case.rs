//! Cases and their expected numbers: the files in `reference/`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde::de::DeserializeOwned;

/// A case: a scenario, changes to it, and the expected numbers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Reference {
    /// One line about the case.
    pub(crate) title: String,
    /// Name of the scenario in `cases/`.
    pub(crate) scenario: String,
    /// Source of the case.
    pub(crate) source: String,
    /// Changes of the scenario, as for `cutwater run --set`.
    #[serde(default)]
    pub(crate) set: Vec<String>,
    /// Name of the same case with a larger time step, which must not have a later contact or a higher rebound.
    pub(crate) larger_step: Option<String>,
    #[serde(rename = "comparison")]
    pub(crate) comparisons: Vec<Comparison>,
    pub(crate) quick: Quick,
}

/// A quantity with the number of the paper and the band of accepted numbers.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Comparison {
    /// The quantity in words.
    pub(crate) quantity: String,
    /// Its key in `summary.json`.
    pub(crate) key: String,
    #[serde(default)]
    pub(crate) unit: String,
    /// The paper's number.
    pub(crate) paper: Option<f64>,
    /// Place in the paper.
    pub(crate) place: Option<String>,
    /// Interval of accepted numbers. Without it, the number is shown with that of the paper and not checked.
    pub(crate) band: Option<[f64; 2]>,
    /// The expected value of a property, instead of a band.
    pub(crate) expected: Option<bool>,
    /// Reason for the width of the band.
    pub(crate) reason: String,
}

/// Changes that make a case short.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Quick {
    /// Changes of the scenario after those of the case.
    pub(crate) set: Vec<String>,
}

/// Stored values of this program on coarse meshes: case to key to value; properties are 0 or 1.
pub(crate) type QuickValues = BTreeMap<String, BTreeMap<String, f64>>;

fn package() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn scenario_path(name: &str) -> PathBuf {
    package().join("cases").join(name).with_extension("toml")
}

/// Returns the path of an example.
pub(crate) fn example_path(name: &str) -> PathBuf {
    package().join("../examples").join(name).with_extension("toml")
}

/// Returns the path of the stored values of the short versions.
pub(crate) fn quick_values_path() -> PathBuf {
    package().join("reference/quick/values.toml")
}

/// Returns the names of all cases, in order.
pub(crate) fn names() -> std::io::Result<Vec<String>> {
    stems("reference")
}

/// Returns the names of the TOML files in a folder of this package, in order.
pub(crate) fn stems(folder: &str) -> std::io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(package().join(folder))? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == "toml")
            && let Some(stem) = path.file_stem()
        {
            names.push(stem.to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}

/// Reads the reference of a case.
pub(crate) fn read(name: &str) -> Result<Reference, String> {
    read_named("reference", "case", name)
}

/// Reads the TOML file of a name in a folder of this package.
///
/// # Errors
/// No file of this kind has that name, or it is invalid.
pub(crate) fn read_named<T: DeserializeOwned>(folder: &str, kind: &str, name: &str) -> Result<T, String> {
    let known = stems(folder).unwrap_or_default();
    if !known.iter().any(|k| k == name) {
        return Err(format!("there is no {kind} {name:?}; there are {}", known.join(", ")));
    }
    parse(&package().join(folder).join(format!("{name}.toml")))
}

/// Reads the stored values of the short versions; empty if there is no file.
pub(crate) fn read_quick_values() -> Result<QuickValues, String> {
    let path = quick_values_path();
    if path.is_file() { parse(&path) } else { Ok(QuickValues::new()) }
}

fn parse<T: DeserializeOwned>(path: &Path) -> Result<T, String> {
    let text = fs::read_to_string(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    toml::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use cutwater::io::{ScenarioFile, sizes};

    use super::*;

    /// Coarse meshes, so that the test is fast.
    const COARSE: [&str; 3] = ["background.size.fine=0.5", "background.size.coarse=1.0", "body.0.shape.size=0.5"];

    #[test]
    fn scenarios_of_all_cases_are_read_and_have_meshes() {
        let mut n = 0;
        for entry in fs::read_dir(package().join("cases")).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "toml") {
                let file = ScenarioFile::read(&path, &COARSE.map(str::to_owned)).unwrap();
                let sizes = sizes(&file).unwrap();
                assert!(sizes.n_steps > 0 && sizes.cut_cells > 0 && sizes.dofs > 0, "{}: {sizes:?}", path.display());
                assert_eq!(Some(file.scenario().name.as_str()), path.file_stem().and_then(|stem| stem.to_str()));
                n += 1;
            }
        }
        assert!(n > 0, "no scenarios");
    }

    #[test]
    fn all_references_are_complete() {
        for name in names().unwrap() {
            let reference = read(&name).unwrap();
            assert!(scenario_path(&reference.scenario).is_file(), "{name}: no scenario {}", reference.scenario);
            for comparison in reference.comparisons {
                let Comparison { quantity, paper, place, band, expected, reason, .. } = comparison;
                assert_eq!(paper.is_some(), place.is_some(), "{name}: {quantity}: a number without a place");
                let n_expected = [band.is_some(), expected.is_some()].into_iter().filter(|given| *given).count();
                let is_shown = paper.is_some() && n_expected == 0;
                assert!(
                    is_shown || n_expected == 1,
                    "{name}: {quantity}: a band, an expectation, or a number of the paper"
                );
                assert!(band.is_none_or(|[low, high]| low < high), "{name}: {quantity}: an empty band");
                assert!(!reason.is_empty(), "{name}: {quantity}: a band without a reason");
            }
        }
        read_quick_values().unwrap();
    }
}

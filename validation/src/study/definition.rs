//! Definitions of studies: the files in `studies/`.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::case;

/// A study: series of runs.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Definition {
    pub(super) title: String,
    /// Conclusions, as paragraphs.
    #[serde(default)]
    pub(super) note: Vec<String>,
    /// Changes of the scenario that all runs share, as for `cutwater run --set`.
    #[serde(default)]
    set: Vec<String>,
    /// Largest spread of speed and height over the coefficients, %.
    #[serde(default = "largest_spread")]
    pub(super) largest_spread: f64,
    pub(super) series: Vec<StudySeries>,
}

/// Runs of one scenario with one number changed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StudySeries {
    /// Name, unique in the study.
    pub(super) name: String,
    /// The varied quantity, with its unit.
    pub(super) parameter: String,
    /// Name of the scenario in `cases/`.
    pub(super) scenario: String,
    /// Changes of the scenario that the runs of the series share.
    #[serde(default)]
    set: Vec<String>,
    /// Keys of the scenario that are varied, with the factor on the value for each.
    pub(super) vary: BTreeMap<String, f64>,
    pub(super) values: Vec<f64>,
    /// Whether the values tend to zero at a constant ratio and limits are extrapolated.
    #[serde(default)]
    pub(super) limit: bool,
    /// Required order of speed and height of the rebound.
    pub(super) required_order: Option<f64>,
    /// Whether the quantity is a coefficient of the discretisation, on which results should not depend.
    #[serde(default)]
    pub(super) coefficient: bool,
}

/// Returns the largest spread if a study gives none: measured rebounds scatter by a few percent.
fn largest_spread() -> f64 {
    5.0
}

impl Definition {
    /// Returns the changes of the scenario for a value of a series.
    pub(super) fn changes(&self, series: &StudySeries, value: f64) -> Vec<String> {
        let vary = series.vary.iter().map(|(key, factor)| format!("{key}={:?}", factor * value));
        self.set.iter().chain(&series.set).cloned().chain(vary).collect()
    }
}

/// Folder of the definitions.
const FOLDER: &str = "studies";

/// Returns the names of all studies, in order.
pub(crate) fn names() -> std::io::Result<Vec<String>> {
    case::stems(FOLDER)
}

impl StudySeries {
    /// Returns the directory of a run, unique in the study.
    pub(super) fn stem(&self, k: usize) -> String {
        format!("{}-{}", self.name.replace(|c: char| !c.is_ascii_alphanumeric(), "-"), self.values[k])
    }
}

/// Reads a study.
pub(super) fn read(name: &str) -> Result<Definition, String> {
    case::read_named(FOLDER, "study", name)
}

#[cfg(test)]
mod tests {
    use cutwater::io::ScenarioFile;

    use super::*;

    #[test]
    fn changes_of_a_series_follow_those_of_the_study() {
        let text = "title = 'T'\nset = ['a=1']\n[[series]]\nname = 's'\nparameter = 'k'\nscenario = 'x'\nset = ['b=2']\n\
                    vary = { k = 3.0 }\nvalues = [2.0]";
        let definition: Definition = toml::from_str(text).unwrap();
        assert_eq!(definition.changes(&definition.series[0], 2.0), ["a=1", "b=2", "k=6.0"]);
    }

    #[test]
    fn every_run_of_every_study_is_a_scenario() {
        for name in names().unwrap() {
            let definition = read(&name).unwrap();
            let mut stems = std::collections::BTreeSet::new();
            for series in &definition.series {
                assert!(
                    (0..series.values.len()).all(|k| stems.insert(series.stem(k))),
                    "{name}: two runs in one directory"
                );
                for &value in &series.values {
                    let path = case::scenario_path(&series.scenario);
                    let file = ScenarioFile::read(&path, &definition.changes(series, value));
                    assert!(file.is_ok(), "{name}, {}, {value}: {}", series.name, file.unwrap_err());
                }
            }
        }
    }
}

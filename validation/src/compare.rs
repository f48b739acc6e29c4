//! Verdicts: computed numbers compared with expected ones.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::case::Comparison;
use crate::outcome::Failure;

/// Relative width that round-off may add to a band.
const ROUND_OFF: f64 = 1e-9;
/// Relative deviation from our own stored values that counts as a change.
const QUICK_TOLERANCE: f64 = 2e-2;

// Values of [`Compared::verdict`].
const PASS: &str = "pass";
const FAIL: &str = "fail";
const SHOWN: &str = "-";
/// File of the comparisons in a directory of results.
const FILE: &str = "comparisons.json";

/// A computed number and a known one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Compared {
    /// The quantity, with its unit.
    pub(crate) quantity: String,
    /// The known number: of the paper, or stored.
    pub(crate) known: Option<f64>,
    pub(crate) computed: Option<f64>,
    /// The computed number minus the known one.
    pub(crate) deviation: Option<f64>,
    pub(crate) band: Option<[f64; 2]>,
    /// Whether the computed number lies in it: `pass` or `fail`; `-` for a number without a band, which is only shown.
    verdict: String,
    /// Whether the number stands for no (0) or yes (1).
    #[serde(skip)]
    pub(crate) is_property: bool,
    /// Reason for the band.
    #[serde(skip)]
    pub(crate) reason: String,
}

impl Compared {
    pub(crate) fn passes(&self) -> bool {
        self.verdict != FAIL
    }

    fn new(
        asked: &Comparison,
        computed: Option<&Value>,
        known: Option<f64>,
        band: Option<[f64; 2]>,
        reason: String,
    ) -> Self {
        let is_property = asked.expected.is_some();
        let computed = computed.filter(|value| value.is_boolean() == is_property).and_then(as_number);
        let passes = computed.zip(band).is_some_and(|(value, band)| is_inside(value, band));
        let quantity = match asked.unit.as_str() {
            "" => asked.quantity.clone(),
            unit => format!("{}, {unit}", asked.quantity),
        };
        let deviation = computed.zip(known).map(|(computed, known)| computed - known);
        let verdict = if passes { PASS } else { FAIL }.to_owned();
        Self { quantity, known, computed, deviation, band, verdict, is_property, reason }
    }
}

/// Returns a metric as a number; a property is 0 or 1.
pub(crate) fn as_number(metric: &Value) -> Option<f64> {
    metric.as_f64().or(metric.as_bool().map(|property| f64::from(u8::from(property))))
}

/// Writes comparisons into the directory of a run.
pub(crate) fn write(directory: &Path, rows: &[Compared]) -> Result<(), Failure> {
    Ok(std::fs::write(directory.join(FILE), serde_json::to_string_pretty(rows)? + "\n")?)
}

/// Removes the comparisons from the directory of a run.
pub(crate) fn remove(directory: &Path) -> Result<(), Failure> {
    match std::fs::remove_file(directory.join(FILE)) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error.into()),
        _ => Ok(()),
    }
}

/// Reads the comparisons of a run; none if it was not compared.
pub(crate) fn read(directory: &Path) -> Result<Vec<Compared>, Failure> {
    let path = directory.join(FILE);
    if path.is_file() { Ok(serde_json::from_str(&std::fs::read_to_string(path)?)?) } else { Ok(Vec::new()) }
}

pub(crate) fn with_paper(asked: &Comparison, computed: Option<&Value>) -> Compared {
    let band = asked.band.or(asked.expected.map(|property| [f64::from(u8::from(property)); 2]));
    let reason = match &asked.place {
        Some(place) => format!("{} (paper: {place})", asked.reason),
        None => asked.reason.clone(),
    };
    let compared = Compared::new(asked, computed, asked.paper, band, reason);
    match (compared.computed, band) {
        (Some(_), None) => Compared { verdict: SHOWN.to_owned(), ..compared },
        _ => compared,
    }
}

/// Compares a quick run with the value that was stored for it.
pub(crate) fn with_stored(asked: &Comparison, computed: Option<&Value>, stored: Option<f64>) -> Compared {
    let band = stored.map(|value| {
        let width = if asked.expected.is_some() { 0.0 } else { QUICK_TOLERANCE * value.abs() };
        [value - width, value + width]
    });
    let reason = match stored {
        Some(_) => "stored value of the same coarse run",
        None => "no value is stored; store one with the flag --regenerate of the validation binary",
    };
    Compared::new(asked, computed, stored, band, reason.to_owned())
}

fn is_inside(value: f64, [low, high]: [f64; 2]) -> bool {
    let slack = ROUND_OFF * value.abs();
    low - slack <= value && value <= high + slack
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn asked(band: Option<[f64; 2]>, expected: Option<bool>) -> Comparison {
        Comparison {
            quantity: "time".to_owned(),
            key: "t".to_owned(),
            unit: "s".to_owned(),
            paper: Some(0.111),
            place: Some("Sec. 4.1".to_owned()),
            band,
            expected,
            reason: String::new(),
        }
    }

    #[test]
    fn ends_belong_to_the_band_and_missing_values_fail() {
        let asked = asked(Some([0.108, 0.114]), None);
        let passes = |value: Value| with_paper(&asked, Some(&value)).passes();
        assert!(passes(json!(0.108)) && passes(json!(0.114 + 1e-15)));
        // JSON has no NaN, so that one is missing.
        assert!(!passes(json!(0.1141)) && !passes(json!(f64::NAN)) && !with_paper(&asked, None).passes());
    }

    #[test]
    fn a_number_without_a_band_is_shown() {
        let asked = asked(None, None);
        assert_eq!(with_paper(&asked, Some(&json!(0.2))).verdict, SHOWN);
        assert!(!with_paper(&asked, None).passes());
    }

    #[test]
    fn properties_are_compared_as_such() {
        let passes = |value: Value| with_paper(&asked(None, Some(true)), Some(&value)).passes();
        assert!(passes(json!(true)) && !passes(json!(false)) && !passes(json!(1.0)));
    }

    #[test]
    fn quick_runs_are_compared_with_stored_values() {
        let asked = asked(Some([0.108, 0.114]), None);
        let passes = |value: f64, stored| with_stored(&asked, Some(&json!(value)), stored).passes();
        assert!(passes(0.2, Some(0.2)));
        assert!(!passes(0.11, Some(0.2)) && !passes(0.11, None));
    }
}

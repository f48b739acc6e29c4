//! Verdicts: computed numbers compared with expected ones.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::case::Comparison;
use crate::metrics::Metric;

/// Relative width that round-off may add to a band.
const ROUND_OFF: f64 = 1e-9;
/// Relative deviation from our own stored values that counts as a change.
const QUICK_TOLERANCE: f64 = 2e-2;

/// Values of [`Compared::verdict`].
const PASS: &str = "pass";
const FAIL: &str = "fail";
/// File of the comparisons in a directory of results.
const FILE: &str = "comparisons.json";

/// A computed number and a known one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Compared {
    /// The quantity, with its unit.
    pub(crate) quantity: String,
    /// The known number: of the paper, or stored.
    pub(crate) known: Option<f64>,
    /// The computed number.
    pub(crate) computed: Option<f64>,
    /// The computed number minus the known one.
    pub(crate) deviation: Option<f64>,
    /// The accepted interval.
    pub(crate) band: Option<[f64; 2]>,
    /// Whether the computed number lies in it: `pass` or `fail`.
    verdict: String,
}

impl Compared {
    /// Whether the computed number lies in the band.
    pub(crate) fn passes(&self) -> bool {
        self.verdict == PASS
    }
}

/// Writes comparisons into the directory of a run.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn write(directory: &Path, rows: &[Row]) -> Result<(), Box<dyn std::error::Error>> {
    let comparisons: Vec<&Compared> = rows.iter().map(|row| &row.comparison).collect();
    Ok(std::fs::write(directory.join(FILE), serde_json::to_string_pretty(&comparisons)? + "\n")?)
}

/// Reads the comparisons of a run; none if it was not compared.
///
/// # Errors
/// The file is malformed.
pub(crate) fn read(directory: &Path) -> Result<Vec<Compared>, Box<dyn std::error::Error>> {
    let path = directory.join(FILE);
    if path.is_file() { Ok(serde_json::from_str(&std::fs::read_to_string(path)?)?) } else { Ok(Vec::new()) }
}

/// A row of the table.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// The numbers.
    pub(crate) comparison: Compared,
    /// Whether the number stands for no (0) or yes (1).
    pub(crate) is_property: bool,
    /// Why the band is as it is.
    pub(crate) reason: String,
}

impl Row {
    /// Whether the computed number is as expected.
    pub(crate) fn passes(&self) -> bool {
        self.comparison.passes()
    }

    fn new(
        asked: &Comparison,
        computed: Option<Metric>,
        known: Option<f64>,
        band: Option<[f64; 2]>,
        reason: String,
    ) -> Self {
        let is_property = asked.expected.is_some();
        let computed = computed.filter(|metric| metric.is_property == is_property).map(|metric| metric.value);
        let passes = computed.zip(band).is_some_and(|(value, band)| is_inside(value, band));
        let quantity = match asked.unit.as_str() {
            "" => asked.quantity.clone(),
            unit => format!("{}, {unit}", asked.quantity),
        };
        let comparison = Compared {
            quantity,
            known,
            computed,
            deviation: computed.zip(known).map(|(computed, known)| computed - known),
            band,
            verdict: if passes { PASS } else { FAIL }.to_owned(),
        };
        Self { comparison, is_property, reason }
    }
}

/// Compares a run with the paper.
pub(crate) fn with_paper(asked: &Comparison, computed: Option<Metric>) -> Row {
    let band = asked.band.or(asked.expected.map(|property| [f64::from(u8::from(property)); 2]));
    let reason = match &asked.place {
        Some(place) => format!("{} (paper: {place})", asked.reason),
        None => asked.reason.clone(),
    };
    Row::new(asked, computed, asked.paper, band, reason)
}

/// Compares a quick run with the value that was stored for it.
pub(crate) fn with_stored(asked: &Comparison, computed: Option<Metric>, stored: Option<f64>) -> Row {
    let band = stored.map(|value| {
        let width = if asked.expected.is_some() { 0.0 } else { QUICK_TOLERANCE * value.abs() };
        [value - width, value + width]
    });
    let reason = match stored {
        Some(_) => "stored value of the same coarse run",
        None => "no value is stored; store one with the flag --regenerate of the validation binary",
    };
    Row::new(asked, computed, stored, band, reason.to_owned())
}

fn is_inside(value: f64, [low, high]: [f64; 2]) -> bool {
    let slack = ROUND_OFF * value.abs();
    low - slack <= value && value <= high + slack
}

#[cfg(test)]
mod tests {
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
        let passes = |value: Option<f64>| with_paper(&asked, value.map(Metric::number)).passes();
        assert!(passes(Some(0.108)) && passes(Some(0.114 + 1e-15)));
        assert!(!passes(Some(0.1141)) && !passes(Some(f64::NAN)) && !passes(None));
    }

    #[test]
    fn properties_are_compared_as_such() {
        let asked = asked(None, Some(true));
        assert!(with_paper(&asked, Some(Metric::property(true))).passes());
        assert!(!with_paper(&asked, Some(Metric::property(false))).passes());
        assert!(!with_paper(&asked, Some(Metric::number(1.0))).passes());
    }

    #[test]
    fn quick_runs_are_compared_with_stored_values() {
        let asked = asked(Some([0.108, 0.114]), None);
        let passes = |value, stored| with_stored(&asked, Some(Metric::number(value)), stored).passes();
        assert!(passes(0.2, Some(0.2)));
        assert!(!passes(0.11, Some(0.2)) && !passes(0.11, None));
    }
}

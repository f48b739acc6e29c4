//! The outcome of a check: numbers with verdicts, curves and notes.

use std::path::PathBuf;

use cutwater::report::{Chart, Curve};
use serde::Serialize;

use super::short;

/// A number with its reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct RecordRow {
    pub(crate) check: String,
    pub(crate) quantity: String,
    /// Value of the quantity; `None` if it is not finite.
    pub(crate) computed: Option<f64>,
    /// The expected value, or the bound.
    pub(crate) reference: Option<f64>,
    /// Comparison of `computed` with `reference`, in words.
    pub(crate) tolerance: String,
    /// `pass`, `FAIL`, or `-` for a number without a bound.
    pub(crate) verdict: String,
}

impl RecordRow {
    pub(crate) fn holds(&self) -> bool {
        self.verdict != "FAIL"
    }
}

/// Numbers with names.
pub(super) type NamedNumbers = Vec<(String, f64)>;
/// Points of a curve.
pub(crate) type Points = Vec<(f64, f64)>;

/// A table of texts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TextTable {
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

/// The outcome of a check or of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Record {
    pub(crate) check: String,
    /// Subject of the check, in a sentence.
    pub(crate) about: String,
    /// Whether the long version was run.
    pub(crate) full: bool,
    /// Folder of the results of the runs of the check.
    pub(crate) directory: PathBuf,
    /// Wall-clock time of the check, s; if its runs may be of earlier commands, the sum of their times.
    pub(crate) seconds: f64,
    pub(crate) rows: Vec<RecordRow>,
    pub(crate) tables: Vec<TextTable>,
    /// Curves of measured numbers; both axes are logarithmic if the horizontal one is.
    pub(crate) figures: Vec<Chart>,
    /// Settings, and reasons for missed bounds.
    pub(crate) notes: Vec<String>,
}

impl Record {
    pub(crate) fn new(check: &str, about: &str, full: bool) -> Self {
        Self { check: check.to_owned(), about: about.to_owned(), full, ..Self::default() }
    }

    pub(crate) fn holds(&self) -> bool {
        self.rows.iter().all(RecordRow::holds)
    }

    /// Adds a number that must be within `tolerance` of a reference.
    pub(crate) fn near(&mut self, quantity: impl Into<String>, computed: f64, reference: f64, tolerance: f64) {
        let holds = (computed - reference).abs() <= tolerance;
        self.push(quantity.into(), computed, Some(reference), format!("± {}", short(tolerance)), Some(holds));
    }

    /// Adds a number that must be within a fraction of a reference.
    pub(crate) fn near_relative(&mut self, quantity: impl Into<String>, computed: f64, reference: f64, fraction: f64) {
        let holds = (computed - reference).abs() <= fraction * reference.abs();
        self.push(quantity.into(), computed, Some(reference), format!("± {} %", short(100.0 * fraction)), Some(holds));
    }

    pub(crate) fn at_most(&mut self, quantity: impl Into<String>, computed: f64, bound: f64) {
        self.push(quantity.into(), computed, Some(bound), "at most".to_owned(), Some(computed <= bound));
    }

    pub(crate) fn at_least(&mut self, quantity: impl Into<String>, computed: f64, bound: f64) {
        self.push(quantity.into(), computed, Some(bound), "at least".to_owned(), Some(computed >= bound));
    }

    /// Adds a number that must be at most some times as large as a reference.
    pub(crate) fn at_most_times(&mut self, quantity: impl Into<String>, computed: f64, reference: f64, factor: f64) {
        let tolerance = format!("at most {} times", short(factor));
        self.push(quantity.into(), computed, Some(reference), tolerance, Some(computed <= factor * reference));
    }

    /// Adds a number that must be in a band, with a known one if there is one.
    pub(crate) fn within(
        &mut self,
        quantity: impl Into<String>,
        computed: f64,
        known: Option<f64>,
        band: Option<[f64; 2]>,
    ) {
        let tolerance = band.map_or(String::new(), |[low, high]| format!("{} to {}", short(low), short(high)));
        let holds = band.map(|[low, high]| low <= computed && computed <= high);
        self.push(quantity.into(), computed, known, tolerance, holds);
    }

    /// Adds a number without a bound, with a known one if there is one.
    pub(crate) fn show(&mut self, quantity: impl Into<String>, computed: f64, reference: Option<f64>) {
        self.push(quantity.into(), computed, reference, String::new(), None);
    }

    pub(crate) fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }

    /// Adds curves with names over a common axis.
    pub(crate) fn figure<L: Into<String>>(
        &mut self,
        title: impl Into<String>,
        x_label: &str,
        curves: Vec<(L, Points)>,
    ) {
        let curves = curves.into_iter().map(|(label, points)| Curve::new(label, points)).collect();
        self.figures.push(Chart::new(title, x_label, curves));
    }

    /// Adds curves with names over a common axis, with logarithmic axes.
    pub(crate) fn log_figure<L: Into<String>>(
        &mut self,
        title: impl Into<String>,
        x_label: &str,
        curves: Vec<(L, Points)>,
    ) {
        self.figure(title, x_label, curves);
        if let Some(figure) = self.figures.last_mut() {
            figure.x_is_log = true;
        }
    }

    fn push(
        &mut self,
        quantity: String,
        computed: f64,
        reference: Option<f64>,
        tolerance: String,
        holds: Option<bool>,
    ) {
        let verdict = holds.map_or("-", |holds| if holds { "pass" } else { "FAIL" }).to_owned();
        let computed = Some(computed).filter(|value| value.is_finite());
        self.rows.push(RecordRow { check: self.check.clone(), quantity, computed, reference, tolerance, verdict });
    }

    /// Adds observed orders of convergence between neighbours of a sequence of sizes and errors, of which the last must
    /// be at least `order`, and all positive: every refinement reduces the error. The errors are shown.
    pub(crate) fn order(&mut self, quantity: &str, unit: &str, errors: &[(f64, f64)], order: f64) {
        let [last, least] = self.show_errors(quantity, unit, errors);
        let reduces = Some(least > 0.0);
        self.push(
            format!("order of {quantity} in {unit}, the least of all"),
            least,
            Some(0.0),
            "above".to_owned(),
            reduces,
        );
        self.at_least(format!("order of {quantity} in {unit}"), last, order);
    }

    /// Adds observed orders of convergence without a required one.
    pub(crate) fn show_order(&mut self, quantity: &str, unit: &str, errors: &[(f64, f64)]) {
        let [last, _] = self.show_errors(quantity, unit, errors);
        self.show(format!("order of {quantity} in {unit}"), last, None);
    }

    /// Shows errors; returns the last observed order and the least.
    fn show_errors(&mut self, quantity: &str, unit: &str, errors: &[(f64, f64)]) -> [f64; 2] {
        for (size, error) in errors {
            self.show(format!("{quantity} at {unit} = {}", short(*size)), *error, None);
        }
        let mut observed = errors.windows(2).map(|w| (w[0].1 / w[1].1).ln() / (w[0].0 / w[1].0).ln());
        let last = observed.next_back().unwrap_or(f64::NAN);
        // NaN is smaller than all numbers.
        [last, observed.fold(last, |least, order| if order < least || order.is_nan() { order } else { least })]
    }
}

/// Returns the larger one of two numbers. NaN is larger than all numbers, and violates every bound.
pub(crate) fn worse(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_their_bounds() {
        let mut record = Record::new("x", "", false);
        record.near("a", 1.05, 1.0, 0.1);
        record.at_most("b", 2.0, 2.0);
        record.at_most_times("b", 2.3, 2.0, 1.2);
        record.within("b", 2.0, None, Some([2.0, 2.1]));
        record.show("c", 7.0, None);
        assert!(record.holds());
        for fail in [
            |r: &mut Record| r.near("a", 1.2, 1.0, 0.1),
            |r: &mut Record| r.near_relative("a", -103.0, -100.0, 0.02),
            |r: &mut Record| r.at_most("b", f64::NAN, 2.0),
            |r: &mut Record| r.within("b", 2.2, Some(2.0), Some([2.0, 2.1])),
            |r: &mut Record| r.within("b", f64::NAN, None, Some([2.0, 2.1])),
            |r: &mut Record| r.at_most_times("b", 2.5, 2.0, 1.2),
            |r: &mut Record| r.at_least("b", 1.0, 2.0),
            |r: &mut Record| r.order("e", "h", &[(0.2, 4.0), (0.1, 2.0)], 1.9),
            |r: &mut Record| r.order("e", "h", &[(0.4, 4.0), (0.2, 4.0), (0.1, 1.0)], 1.9),
            |r: &mut Record| r.order("e", "h", &[(0.4, f64::NAN), (0.2, 4.0), (0.1, 1.0)], 1.9),
        ] {
            let mut other = record.clone();
            fail(&mut other);
            assert!(!other.holds(), "{other:?}");
        }
    }

    #[test]
    fn what_is_not_a_number_is_the_worst() {
        assert_eq!([0.5, 2.0, 1.0].into_iter().fold(0.0, worse), 2.0);
        assert!([1.0, f64::NAN, 2.0].into_iter().fold(0.0, worse).is_nan());
    }

    #[test]
    fn the_last_order_counts_if_all_are_positive() {
        let mut record = Record::new("x", "", false);
        record.order("e", "h", &[(0.4, 5.0), (0.2, 4.0), (0.1, 1.0)], 1.99);
        assert!(record.holds());
        assert_eq!(record.rows.last().and_then(|row| row.computed), Some(2.0));
    }
}

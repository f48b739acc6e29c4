//! The numbers of a run, by the names that references use.

use std::path::Path;

use cutwater::io::{HistoryTable, Summary};

use crate::case::Comparison;

/// Whole steps in units of a factorisation of their matrix; not in `summary.json`.
pub(crate) const REFACTORIZATIONS_PER_STEP: &str = "refactorizations_per_step";
/// Whether the run reached its end; not in `summary.json`.
const FINISHED: &str = "finished";

/// A number, or a property as 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Metric {
    /// The number.
    pub(crate) value: f64,
    /// Whether it stands for a property.
    pub(crate) is_property: bool,
}

impl Metric {
    /// A number.
    pub(crate) fn number(value: f64) -> Self {
        Self { value, is_property: false }
    }

    /// A property.
    pub(crate) fn property(value: bool) -> Self {
        Self { value: f64::from(u8::from(value)), is_property: true }
    }
}

/// What a run has to say.
pub(crate) struct Metrics {
    summary: serde_json::Value,
    finished: bool,
    refactorizations_per_step: Option<f64>,
}

impl Metrics {
    /// The metrics of a run from its summary, and whether it reached its end.
    ///
    /// # Errors
    /// The summary has no JSON form.
    pub(crate) fn new(summary: &Summary, finished: bool) -> Result<Self, serde_json::Error> {
        Ok(Self { summary: serde_json::to_value(summary)?, finished, refactorizations_per_step: None })
    }

    /// Compares the median step of a run with a factorisation of its last matrix.
    ///
    /// # Errors
    /// The history cannot be read.
    pub(crate) fn measure_cost(&mut self, summary: &Summary, directory: &Path) -> Result<(), cutwater::io::Error> {
        let Some(step) = median_step_seconds(&HistoryTable::read(&directory.join("history.csv"))?) else {
            return Ok(());
        };
        let Some(refactorization) = summary.refactorization_seconds else { return Ok(()) };
        println!("  median step {:.1} ms, refactorisation {:.1} ms", 1e3 * step, 1e3 * refactorization);
        self.refactorizations_per_step = Some(step / refactorization);
        Ok(())
    }

    /// The metric that a comparison asks for, if the run has it.
    pub(crate) fn get(&self, asked: &Comparison) -> Option<Metric> {
        match asked.key.as_str() {
            REFACTORIZATIONS_PER_STEP => self.refactorizations_per_step.map(Metric::number),
            FINISHED => Some(Metric::property(self.finished)),
            key => {
                let value = &self.summary[key];
                value.as_f64().map(Metric::number).or(value.as_bool().map(Metric::property))
            }
        }
    }
}

/// Median over the steps of the time of all stages together.
fn median_step_seconds(history: &HistoryTable) -> Option<f64> {
    let stages = ["cut", "space", "assembly", "linear", "output"];
    let columns: Option<Vec<Vec<f64>>> =
        stages.iter().map(|stage| history.column(&format!("seconds_{stage}"))).collect();
    let columns = columns?;
    let mut steps: Vec<f64> = (0..columns[0].len()).map(|k| columns.iter().map(|column| column[k]).sum()).collect();
    median(&mut steps)
}

/// The median; none of nothing.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

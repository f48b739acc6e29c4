//! The part of the page about runs that differ in their time step: Table 1 of the paper.

use cutwater::report::html::{number, optional, table, verdict};

use super::case_result::CaseResult;
use crate::metrics::Rebound;
use crate::units::cgs;

/// Returns the table of contact and rebound of runs of one scenario and profile, from large to small time steps. `None`
/// if all have the same step.
pub(super) fn table_of_steps(runs: &[&CaseResult]) -> Option<String> {
    let mut runs = runs.to_vec();
    let dt = |case: &CaseResult| case.results.summary.dt;
    runs.sort_by(|a, b| dt(b).total_cmp(&dt(a)));
    if dt(runs.first()?) == dt(runs.last()?) {
        return None;
    }
    let height = |case: &CaseResult| Rebound::new(&case.results).map(|rebound| rebound.height);
    let row = |case: &&CaseResult| {
        let paper = |key: &str| case.reference.comparisons.iter().find(|c| c.key == key).and_then(|c| c.paper);
        let summary = &case.results.summary;
        vec![
            number(summary.dt),
            optional(paper("contact_time")),
            optional(summary.contact_time),
            optional(paper("max_height_time")),
            optional(Rebound::new(&case.results).map(|rebound| rebound.time)),
            optional(height(case)),
            optional(summary.min_distance),
        ]
    };
    let head = [
        "Δt [s]",
        "contact, paper [s]",
        "contact [s]",
        "highest point, paper [s]",
        "highest point [s]",
        &cgs("highest [<length>]"),
        &cgs("smallest distance [<length>]"),
    ];
    let rows: Vec<Vec<String>> = runs.iter().map(row).collect();
    let grows = |value: &dyn Fn(&CaseResult) -> Option<f64>| {
        verdict(runs.windows(2).all(|pair| value(pair[0]).zip(value(pair[1])).is_some_and(|(a, b)| a <= b)))
    };
    let verdicts = format!(
        "<p>Contact times do not decrease as the time step falls: {}. The rebound rises: {}.</p>",
        grows(&|case| case.results.summary.contact_time),
        grows(&height),
    );
    Some(table("", &head, &rows) + &verdicts)
}

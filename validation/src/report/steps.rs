//! The part of the page about runs that differ in their time step: Table 1 of the paper.

use cutwater::io::report::CaseResult;
use cutwater::io::report::html::{number, optional, table, verdict};

use crate::case::{Comparison, Reference};

/// A run with the reference that it was compared with.
pub(super) type Compared<'a> = (&'a CaseResult, &'a Reference);

/// Contact and rebound of runs of one scenario and profile, from large to small time steps; none if they share one step.
pub(super) fn table_of_steps(runs: &[Compared<'_>]) -> Option<String> {
    let mut runs = runs.to_vec();
    runs.sort_by(|a, b| b.0.summary.dt.total_cmp(&a.0.summary.dt));
    if runs.first()?.0.summary.dt == runs.last()?.0.summary.dt {
        return None;
    }
    let row = |(case, reference): &Compared<'_>| {
        let paper = |key: &str| reference.comparisons.iter().find(|c| c.key == key).and_then(|c: &Comparison| c.paper);
        let summary = &case.summary;
        vec![
            number(summary.dt),
            optional(paper("contact_time")),
            optional(summary.contact_time),
            optional(paper("max_height_time")),
            optional(summary.max_height_time),
            optional(summary.max_height),
            optional(summary.min_distance),
        ]
    };
    let head = [
        "Δt [s]",
        "contact, paper [s]",
        "contact [s]",
        "highest point, paper [s]",
        "highest point [s]",
        "highest [cm]",
        "smallest distance [cm]",
    ];
    let rows: Vec<Vec<String>> = runs.iter().map(row).collect();
    let grows = |value: &dyn Fn(&CaseResult) -> Option<f64>| {
        verdict(runs.windows(2).all(|pair| value(pair[0].0).zip(value(pair[1].0)).is_some_and(|(a, b)| a <= b)))
    };
    let verdicts = format!(
        "<p>Contact times do not decrease as the time step falls: {}. The rebound rises: {}.</p>",
        grows(&|case| case.summary.contact_time),
        grows(&|case| case.summary.max_height),
    );
    Some(table("", &head, &rows) + &verdicts)
}

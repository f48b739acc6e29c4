//! Results of the cases as pages of the book.

use std::path::Path;

use cutwater::io::Summary;
use cutwater::report::Results;

use crate::bounds::potential::{arrival, gaps};
use crate::case::Reference;
use crate::compare;
use crate::metrics::Rebound;
use crate::outcome::Failure;
use crate::units::cgs;
use crate::verify::record::{Record, TextTable, worse};
use crate::verify::{document, missed};

/// Largest number of contacts that are shown.
const SHOWN: usize = 3;

/// Returns the record of a case from its directory of results and those of other cases in `out`.
///
/// # Errors
/// The case was not run.
pub(crate) fn record(name: &str, reference: &Reference, out: &Path) -> Result<Record, Failure> {
    let directory = out.join(name);
    let results = Results::read(&directory)?;
    let compared = compare::read(&directory)?;
    if compared.is_empty() {
        return Err(format!("{name} was not compared with its reference").into());
    }
    let mut record = Record::new(name, &reference.title, true);
    record.seconds = results.summary.wall_seconds;
    for row in &compared {
        record.within(row.quantity.clone(), row.computed.unwrap_or(f64::NAN), row.known, row.band);
    }
    for (k, (begin, end)) in results.summary.contact_intervals.iter().take(SHOWN).enumerate() {
        record.show(format!("contact {}: begin, s", k + 1), *begin, None);
        if let Some(end) = end {
            record.show(format!("contact {}: end, s", k + 1), *end, None);
        }
    }
    add_energies(&[&results.summary], &mut record);
    record.show(cgs("smallest distance, <length>"), results.summary.min_distance.unwrap_or(f64::NAN), None);
    let contact = |results: &Results| results.summary.contact_time.unwrap_or(f64::NAN);
    if let Some((start, offset)) = gaps(&results.scenario) {
        let bound = arrival(start, offset).time;
        record.at_least("first contact (end of its step), and contact in an ideal fluid, s", contact(&results), bound);
    }
    if let Some(larger) = &reference.larger_step {
        if out.join(larger).is_dir() {
            let other = Results::read(&out.join(larger))?;
            let highest = |results: &Results| Rebound::new(results).map_or(f64::NAN, |rebound| rebound.height);
            record.at_least(format!("first contact, and that of {larger}, s"), contact(&results), contact(&other));
            record.at_least(
                cgs(&format!("highest point, and that of {larger}, <length>")),
                highest(&results),
                highest(&other),
            );
        } else {
            record.note(format!("Skipped: the comparison with {larger}, which was not run."));
        }
    }
    let head = ["quantity", "reason for the band"].map(str::to_owned).into();
    let reasons = reference.comparisons.iter().map(|asked| vec![asked.quantity.clone(), asked.reason.clone()]);
    record.tables.push(TextTable { head, rows: reasons.collect() });
    record.note(format!("Reference: {}.", reference.source));
    missed::mark(&mut record)?;
    Ok(record)
}

/// Largest energy of a step that is in no line of the ledger, in tolerances of Newton's method.
const LARGEST_DEFECT: f64 = 10.0;

/// Adds verdicts on the energies of runs: the ledger of every step is balanced, and no step generates energy.
pub(crate) fn add_energies(runs: &[&Summary], record: &mut Record) {
    let defect = runs.iter().map(|run| run.energy_defect.unwrap_or(f64::NAN)).fold(0.0, worse);
    record.at_most("energy of a step that no line of the ledger explains, in tolerances", defect, LARGEST_DEFECT);
    let makers = runs.iter().filter(|run| !run.energy_monotone).count();
    record.at_most("runs with steps that make energy", makers as f64, 0.0);
}

/// Writes the page of a record.
pub(crate) fn write(record: &Record) -> Result<(), Failure> {
    let command = format!("cargo xtask validate {} --document", record.check);
    document::write(document::RESULTS, record, &command, &document::version())
}

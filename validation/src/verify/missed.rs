//! Targets that are known to be missed. They are shown, and do not make a run fail.

use serde::Deserialize;

use super::{Failure, Record};

/// Verdict of a target that is missed and listed.
pub(crate) const MISSED: &str = "MISSED";

/// The list, `validation/missed.toml`.
#[derive(Deserialize)]
struct List {
    missed: Vec<Target>,
}

/// A target with the reason why it is missed.
#[derive(Deserialize)]
struct Target {
    check: String,
    quantity: String,
    reason: String,
    /// Version, short or full, that misses the target; both if left out.
    only: Option<Version>,
}

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Version {
    Full,
    Short,
}

/// Marks failed rows that are listed. A listed row that holds fails, so that it is removed from the list.
///
/// # Errors
/// The list cannot be read.
pub(crate) fn mark(record: &mut Record) -> Result<(), Failure> {
    let list: List = toml::from_str(include_str!("../../missed.toml"))?;
    let check = record.check.clone();
    let version = if record.full { Version::Full } else { Version::Short };
    let applies = |target: &&Target| target.check == check && target.only.is_none_or(|only| only == version);
    for target in list.missed.iter().filter(applies) {
        if !record.rows.iter().any(|row| row.quantity == target.quantity) {
            record.at_most(format!("{}; listed as missed, but not measured", target.quantity), f64::NAN, 0.0);
        }
        for row in record.rows.iter_mut().filter(|row| row.quantity == target.quantity) {
            if row.holds() {
                row.tolerance = format!("{}; listed as missed, but holds", row.tolerance);
                "FAIL".clone_into(&mut row.verdict);
            } else {
                MISSED.clone_into(&mut row.verdict);
                record.notes.push(format!("Missed: {}. {}", target.quantity, target.reason));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_of_one_version_are_not_asked_of_the_other() {
        for (check, missed_by_full) in [("bouncing-sphere", true), ("bouncing-sphere-viscous", false)] {
            for full in [false, true] {
                let mut record = Record::new(check, "", full);
                mark(&mut record).expect("a list");
                assert_eq!(record.rows.is_empty(), full != missed_by_full, "{check} {full}");
            }
        }
    }

    #[test]
    fn listed_targets_are_marked_and_must_be_missed() {
        let quantity = "N = 128, error of u, each with its own forms";
        let mark = |computed: f64| {
            let mut record = Record::new("peer", "", false);
            record.at_most_times(quantity, computed, 1.0, 1.2);
            record.at_most_times("another quantity", computed, 1.0, 1.2);
            mark(&mut record).expect("a list");
            record
        };
        let (missed, holds) = (mark(1.3), mark(1.1));
        assert_eq!((missed.rows[0].verdict.as_str(), missed.notes.len()), (MISSED, 1));
        assert!(!missed.rows[1].holds() && !holds.rows[0].holds() && holds.rows[1].holds());
    }
}

//! `cutwater compare`

use cutwater::io::{Error, RunTables};

use super::print;
use crate::CompareArguments;

/// Largest relative difference of equal times.
const ROUND_OFF: f64 = 1e-9;

/// Prints the largest differences between the columns of two runs.
pub(crate) fn compare(arguments: &CompareArguments) -> Result<(), Error> {
    let directories = [&arguments.first, &arguments.second].map(|directory| directory.as_path());
    let [first, second] = directories.map(RunTables::read);
    let (first, second) = (first?, second?);
    let differences = first.differences(&second, directories, &arguments.columns)?;
    let (different, equal): (Vec<_>, Vec<_>) = differences.iter().partition(|found| found.largest > 0.0);
    if !different.is_empty() {
        print(&format!("{:<40} {:>12} {:>12} {:>12}", "column", "difference", "scale", "relative"))?;
    }
    for found in &different {
        let (largest, scale, relative) = (found.largest, found.scale, found.relative());
        print(&format!("{:<40} {largest:>12.3e} {scale:>12.3e} {relative:>12.3e}", found.column))?;
    }
    print(&format!("{} columns are equal, {} differ", equal.len(), different.len()))?;
    let ends = [&first, &second].map(RunTables::end);
    let end_together = (ends[0] - ends[1]).abs() <= ROUND_OFF * ends[0].abs().max(ends[1].abs());
    if !end_together {
        print(&format!("compared until {:e}: the runs end at {:e} and {:e}", ends[0].min(ends[1]), ends[0], ends[1]))?;
    }
    match (different.first(), arguments.tolerance) {
        (Some(found), Some(tolerance)) if found.relative() > tolerance => {
            Err(Error::Differ { column: found.column.clone(), difference: found.relative(), tolerance })
        }
        (_, Some(_)) if !end_together => Err(Error::Ends { ends }),
        _ => Ok(()),
    }
}

//! `cutwater compare`

use cutwater::io::{Error, RunTables};

use super::print;
use crate::CompareArguments;

/// Prints the largest differences between the columns of two runs.
pub(crate) fn compare(arguments: &CompareArguments) -> Result<(), Error> {
    let directories = [&arguments.first, &arguments.second].map(|directory| directory.as_path());
    let [first, second] = directories.map(RunTables::read);
    let differences = first?.differences(&second?, directories, &arguments.columns)?;
    let (different, equal): (Vec<_>, Vec<_>) = differences.iter().partition(|found| found.largest > 0.0);
    if !different.is_empty() {
        print(&format!("{:<40} {:>12} {:>12} {:>12}", "column", "difference", "scale", "relative"))?;
    }
    for found in &different {
        let (largest, scale, relative) = (found.largest, found.scale, found.relative());
        print(&format!("{:<40} {largest:>12.3e} {scale:>12.3e} {relative:>12.3e}", found.column))?;
    }
    print(&format!("{} columns are equal, {} differ", equal.len(), different.len()))?;
    match (different.first(), arguments.tolerance) {
        (Some(found), Some(tolerance)) if found.relative() > tolerance => {
            Err(Error::Differ { column: found.column.clone(), difference: found.relative(), tolerance })
        }
        _ => Ok(()),
    }
}

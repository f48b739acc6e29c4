//! `cutwater report`

use cutwater::report::{write, write_picture};

use super::{Failure, print};
use crate::ReportArguments;

/// Writes the page of a run again, or the run as an animated PNG.
pub(crate) fn report(arguments: &ReportArguments) -> Result<(), Failure> {
    match &arguments.picture {
        Some(path) => {
            write_picture(&arguments.directory, path)?;
            print(&path.display().to_string())?;
        }
        None => print(&write(&arguments.directory)?.display().to_string())?,
    }
    Ok(())
}

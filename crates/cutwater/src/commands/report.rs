//! `cutwater report`

use cutwater::io;
use cutwater::report::{self, write, write_picture};

use super::{Failure, print};
use crate::ReportArguments;

/// Writes the page of a run again, or the run as an animated PNG.
pub(crate) fn report(arguments: &ReportArguments) -> Result<(), Failure> {
    match &arguments.picture {
        Some(path) => {
            let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
            if !extension.is_some_and(|extension| extension == "png" || extension == "apng") {
                let problem = "the picture is an animated PNG; give a name that ends in .png";
                let source = std::io::Error::new(std::io::ErrorKind::InvalidInput, problem);
                return Err(report::Error::from(io::Error::Write { path: path.clone(), source }).into());
            }
            write_picture(&arguments.directory, path)?;
            print(&path.display().to_string())?;
        }
        None => print(&write(&arguments.directory)?.display().to_string())?,
    }
    Ok(())
}

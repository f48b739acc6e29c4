//! `cutwater check`

use cutwater::io::{Error, ScenarioFile, sizes};

use super::{building, print, print_or_ignore};
use crate::ScenarioArguments;

/// Reads a scenario, builds its meshes and the first cut, and prints a summary: sizes, conditions and methods.
pub(crate) fn check(arguments: &ScenarioArguments) -> Result<(), Error> {
    let file = ScenarioFile::read(&arguments.file, &arguments.sets)?;
    print_or_ignore(&building(&file));
    sizes(&file)?.lines.iter().try_for_each(|line| print(line))
}

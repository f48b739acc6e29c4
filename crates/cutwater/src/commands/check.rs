//! `cutwater check`

use cutwater::io::{Error, ScenarioFile, sizes};

use super::{building, print, tell};
use crate::ScenarioArguments;

/// Reads a scenario, builds its meshes and prints how it is understood.
pub(crate) fn check(arguments: &ScenarioArguments) -> Result<(), Error> {
    let file = ScenarioFile::read(&arguments.file, &arguments.sets)?;
    tell(&building(&file));
    sizes(&file)?.lines.iter().try_for_each(|line| print(line))
}

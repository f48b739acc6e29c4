//! `cutwater schema`

use cutwater::io::{Error, scenario};

use super::print;

/// Prints the schema of scenarios.
pub(crate) fn schema() -> Result<(), Error> {
    print(&format!("{:#}", scenario::schema()))
}

//! Results of commands.

use std::error::Error;

/// An error of any kind; commands print it with its sources.
pub(crate) type Failure = Box<dyn Error + Send + Sync>;
/// Whether all checks of a command hold.
pub(crate) type Outcome = Result<bool, Failure>;

/// Returns the causes of an error, the nearest one first.
pub(crate) fn causes(error: &dyn Error) -> impl Iterator<Item = &(dyn Error + 'static)> {
    std::iter::successors(error.source(), |cause| (*cause).source())
}

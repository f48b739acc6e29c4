//! Results of commands.

/// An error of any kind; commands print it with its sources.
pub(crate) type Failure = Box<dyn std::error::Error>;
/// Whether all checks of a command hold.
pub(crate) type Outcome = Result<bool, Failure>;

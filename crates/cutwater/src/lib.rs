//! cutwater.

//! cutcell.

//! solid-svk.

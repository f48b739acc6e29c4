//! Flags and processes.
fn main() {}

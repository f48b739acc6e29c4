//! A solid alone: tangents, exact static states, balances in time.

#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod dynamics;
mod setting;
mod statics;
mod tangents;
mod time_schemes;

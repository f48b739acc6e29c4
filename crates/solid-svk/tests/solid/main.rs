//! A solid alone: tangents, exact static states, balances in time.

mod dynamics;
mod setting;
mod statics;
mod tangents;

//! Contact of elastic bodies with a rigid plane and with each other, without any fluid.

#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod deformable;
mod dynamics;
mod own;
mod patch;
mod rigid;
mod setting;

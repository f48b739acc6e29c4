//! Contact of elastic bodies with a rigid plane and with each other, without any fluid.

mod deformable;
mod dynamics;
mod patch;
mod rigid;
mod setting;

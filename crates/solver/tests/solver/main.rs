//! Steps of the coupled problem against exact solutions, conservation laws and second methods.

mod axisymmetric;
mod collisions;
mod dry;
mod film_edges;
mod films;
mod fixture;
mod invariance;
mod ledger;
mod oblique;
mod patch;
mod rigid;
mod rigid_in_space;
mod setups;
mod step_control;
mod tangents;

//! Scenarios and files: reading, problems that are built, runs, and results. One program, because each one compiles the
//! solver anew.

mod conditions;
mod contacts;
mod cut;
mod dry;
mod errors;
mod fields;
mod geometry;
mod gmsh;
mod motion;
mod probes;
mod results;
mod schema;
mod setting;
mod space;
mod surfaces;
mod units;
mod warnings;

//! Mutated files of every format: each parser returns a result or an error, in little time and memory.
//!
//! A test of a few seconds by default.
//! `MUTATION_MINUTES=10 cargo test -p io --test mutations -- --test-threads=1 --nocapture gmsh` runs a parser for
//! longer, and `MUTATION_SEED=2` changes the inputs, which follow from the seed and the number of the input alone. An
//! input that fails is kept as a file.
#![allow(clippy::print_stderr)] // the numbers of a long run

mod campaign;
mod mutate;
mod parsers;

use campaign::campaign;

#[test]
fn scenario() {
    campaign("scenario", 1000, parsers::scenario_seeds(), parsers::scenario);
}

#[test]
fn formula() {
    campaign("formula", 1000, parsers::formula_seeds(), parsers::formula);
}

#[test]
fn gmsh() {
    campaign("gmsh", 15_000, parsers::gmsh_seeds(), parsers::gmsh);
}

#[test]
fn stl() {
    campaign("stl", 1000, parsers::stl_seeds(), |bytes| parsers::surface("stl", bytes));
}

#[test]
fn obj() {
    campaign("obj", 1000, parsers::obj_seeds(), |bytes| parsers::surface("obj", bytes));
}

#[test]
fn checkpoint() {
    campaign("checkpoint", 1000, parsers::checkpoint_seeds(), parsers::checkpoint);
}

//! Shared settings of the property tests: number of cases, and coordinates of degenerate positions.

use proptest::prelude::*;

/// Returns a short run with a fixed seed, unless `CUTCELL_CASES` and `CUTCELL_SEED` are set.
pub(crate) fn config(usual: u32) -> ProptestConfig {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse().ok());
    ProptestConfig {
        cases: number("CUTCELL_CASES").map_or(usual, |cases| cases as u32),
        // Long runs reject many shifts.
        max_local_rejects: u32::MAX,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(number("CUTCELL_SEED").unwrap_or(7)),
        ..ProptestConfig::default()
    }
}

/// Generates shifts of either sign: zero, tiny, or small.
pub(crate) fn shift() -> impl Strategy<Value = f64> {
    let sizes = prop_oneof![6 => Just(0.0), 10 => (1..18_i32).prop_map(|k| 10.0_f64.powi(-k)), 1 => Just(1.0)];
    (sizes, prop::bool::ANY).prop_map(|(size, negative)| if negative { -size } else { size })
}

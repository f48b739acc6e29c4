//! What is known exactly, one file each.

mod files;
mod symmetry;

use std::path::Path;

use crate::Outcome;

/// Something to verify: whether in full, and where results go.
type Check = fn(bool, &Path) -> Outcome;

/// Everything there is, by name. What only prepares data for another program runs when it is asked for by name.
const CHECKS: [(&str, Check, bool); 2] = [("symmetry", symmetry::check, true), ("files", files::check, false)];

/// Runs the named checks, or all; true if all hold.
///
/// # Errors
/// There is no check of that name, or one of them cannot be done.
pub(crate) fn run(names: &[String], full: bool, out: &Path) -> Outcome {
    if let Some(name) = names.iter().find(|name| !CHECKS.iter().any(|(known, ..)| known == name)) {
        let known: Vec<&str> = CHECKS.iter().map(|(known, ..)| *known).collect();
        return Err(format!("there is no check {name:?}; there are {}", known.join(", ")).into());
    }
    let mut holds = true;
    for (name, check, is_standard) in CHECKS {
        if (names.is_empty() && is_standard) || names.iter().any(|n| n == name) {
            println!("# {name}");
            let this = check(full, &out.join(name))?;
            println!("  {}", if this { "pass" } else { "FAIL" });
            holds &= this;
        }
    }
    Ok(holds)
}

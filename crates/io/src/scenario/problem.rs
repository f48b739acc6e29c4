//! What can be wrong with a scenario file, and where.

use std::fmt;
use std::path::PathBuf;

use super::motion::{FormulaError, TableError};

/// A place in a scenario: file and line, or the command-line argument that set the value, and the key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// The argument of `--set`, if the value came from there.
    pub argument: Option<String>,
    /// Path of the key, such as `body.0.shape.radius`; empty for the file as a whole.
    pub key: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.argument {
            Some(argument) => write!(f, "--set {argument}")?,
            None => write!(f, "{}:{}", self.file.display(), self.line)?,
        }
        if self.key.is_empty() { Ok(()) } else { write!(f, ": {}", self.key) }
    }
}

/// A scenario that cannot be run.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct ScenarioError {
    /// Where.
    pub place: Box<Place>,
    /// What.
    pub problem: Problem,
}

/// What is wrong, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The text is not TOML.
    #[error("not valid TOML: {message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// An argument of `--set` without a key and a value.
    #[error("expected KEY=VALUE, such as time.step=5e-4 or body.0.density=2")]
    Argument,
    /// An argument of `--set` that names an entry that is not there.
    #[error("there is no entry `{segment}` here to be set")]
    NoEntry {
        /// The part of the path.
        segment: String,
    },
    /// A key that is not known.
    #[error("unknown key{} Known here: {}", suggestion(.nearest), .known.join(", "))]
    UnknownKey {
        /// The nearest known key, if one is near.
        nearest: Option<String>,
        /// All known keys.
        known: Vec<String>,
    },
    /// A word that is not known.
    #[error("unknown value `{found}`{} Known here: {}", suggestion(.nearest), .known.join(", "))]
    UnknownValue {
        /// The word.
        found: String,
        /// The nearest known word, if one is near.
        nearest: Option<String>,
        /// All known words.
        known: Vec<String>,
    },
    /// A key that is not there.
    #[error("the key `{key}` is missing; add it")]
    Missing {
        /// The key.
        key: String,
    },
    /// A value of another type.
    #[error("this is {found}, but must be {expected}")]
    WrongType {
        /// What it is.
        found: String,
        /// What it should be.
        expected: String,
    },
    /// Anything else that does not fit the schema.
    #[error("{message}")]
    Schema {
        /// What serde says.
        message: String,
    },
    /// NaN or infinite.
    #[error("this is not a finite number; give a finite one")]
    NotFinite,
    /// A number out of its range.
    #[error("this is {value}, but must be {must}")]
    Range {
        /// The number.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// A list of the wrong length.
    #[error("this has {found} components, but dimension = {dimension} needs {dimension}")]
    Components {
        /// Its length.
        found: usize,
        /// The dimension.
        dimension: usize,
    },
    /// A vector without direction.
    #[error("this vector is zero, but must give a direction")]
    ZeroVector,
    /// A dimension that does not exist.
    #[error("this is {found}, but must be 2 or 3")]
    Dimension {
        /// The number.
        found: usize,
    },
    /// Something that is planned.
    #[error("{what} is not available yet; {instead}")]
    NotAvailable {
        /// What.
        what: &'static str,
        /// What to use instead.
        instead: &'static str,
    },
    /// A step so short, or an end so late, that no run gets there.
    #[error("the step {step:e} needs more than {limit:e} steps to the end {end:e}; check the exponents of both")]
    TooManySteps {
        /// The step.
        step: f64,
        /// The end.
        end: f64,
        /// Most steps.
        limit: f64,
    },
    /// A step that does not divide the end time.
    #[error("the step {step} does not divide the end time {end}; use step = {step_below} or end = {end_below}")]
    Indivisible {
        /// The step.
        step: f64,
        /// The end time.
        end: f64,
        /// The nearest shorter step that does.
        step_below: f64,
        /// The nearest end time that is a multiple of the step.
        end_below: f64,
    },
    /// A weight of the traction other than one.
    #[error(
        "this is {alpha}, but must be 1: with a share of the solid's traction the mortar is stable only if gamma_sigma * \
         viscosity ({have:e}) exceeds about step * (2 mu + lambda) ({need:e}), and its adjoint is not built"
    )]
    Alpha {
        /// The weight.
        alpha: f64,
        /// `γ_Σ μ`.
        have: f64,
        /// `dt (2 μ_s + λ_s)`.
        need: f64,
    },
    /// A value that nothing would look at.
    #[error("this has no effect with {with}: take it out")]
    NoEffect {
        /// What it does not go with.
        with: &'static str,
    },
    /// Two keys of which exactly one is needed.
    #[error("give either {a} or {b}")]
    Either {
        /// One.
        a: &'static str,
        /// The other.
        b: &'static str,
    },
    /// A name that nothing has.
    #[error("there is no {what} `{name}`{} There are: {}", suggestion(.nearest), .known.join(", "))]
    UnknownName {
        /// What is named.
        what: &'static str,
        /// The name.
        name: String,
        /// The nearest one.
        nearest: Option<String>,
        /// All of them.
        known: Vec<String>,
    },
    /// A name that is taken, or cannot be part of a file name.
    #[error("the name `{name}` is {why}")]
    Name {
        /// The name.
        name: String,
        /// Why it cannot be used.
        why: &'static str,
    },
    /// Two bodies that share space at the start.
    #[error("bodies `{a}` and `{b}` overlap at the start by {overlap:.3e} (area or volume); move one of them")]
    Overlap {
        /// One body.
        a: String,
        /// The other.
        b: String,
        /// What they share.
        overlap: f64,
    },
    /// A body that the domain does not know of.
    #[error("no vertex of body `{name}` lies in the domain; move it, or enlarge the background")]
    OutsideDomain {
        /// The body.
        name: String,
    },
    /// A formula that has no value, or no rate of change, at some time of the run.
    #[error(
        "the {what} of the formula `{formula}` at t = {time} is {number}; change it so that it moves smoothly through the \
         whole run"
    )]
    FormulaValue {
        /// The formula.
        formula: String,
        /// Value or derivative.
        what: &'static str,
        /// What it is.
        number: f64,
        /// When.
        time: f64,
    },
    /// A formula that is none.
    #[error(transparent)]
    Formula(#[from] FormulaError),
    /// A table that is no motion of the body.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A contact in which nothing can yield.
    #[error(
        "neither `{body}` nor its obstacle can yield: {why}; take the contact out, or make `{body}` elastic or free"
    )]
    NothingYields {
        /// What must not touch.
        body: String,
        /// Why.
        why: &'static str,
    },
    /// Half of a free body on a plane of symmetry that may leave it.
    #[error(
        "body `{name}` stands on a plane of symmetry, so it must not leave it: add held = [\"{axis}\", \"rotation\"]"
    )]
    Unheld {
        /// The body.
        name: String,
        /// The axis across the plane.
        axis: &'static str,
    },
    /// A mesh that cannot be made.
    #[error(transparent)]
    Mesh(#[from] mesh::Error),
    /// A body that cannot be made.
    #[error(transparent)]
    Solid(#[from] solid_svk::Error),
    /// A rigid body that cannot be made.
    #[error(transparent)]
    Rigid(#[from] solver::solid_rigid::Error),
    /// A contact that cannot be made.
    #[error(transparent)]
    Contact(#[from] contact::Error),
    /// Bodies that cannot cut the background.
    #[error("the bodies cannot cut the background: {0}")]
    Cut(#[from] cutcell::Error),
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(|| ".".to_owned(), |name| format!("; did you mean `{name}`?"))
}

/// The known word nearest to a word, if it is a likely slip: at most a third of its letters differ.
pub(crate) fn nearest<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> Option<String> {
    known
        .into_iter()
        .map(|candidate| (distance(word, candidate), candidate))
        .min_by_key(|(d, _)| *d)
        .filter(|(d, candidate)| 3 * d <= word.len().max(candidate.len()).max(3))
        .map(|(_, candidate)| candidate.to_owned())
}

/// Least number of insertions, deletions, substitutions and swaps of neighbours between two words.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut table = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            if i == 0 || j == 0 {
                table[i][j] = i + j;
                continue;
            }
            let substituted = table[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = substituted.min(table[i - 1][j] + 1).min(table[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(table[i - 2][j - 2] + 1);
            }
            table[i][j] = least;
        }
    }
    table[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised() {
        assert_eq!(nearest("viscosty", ["density", "viscosity"]).as_deref(), Some("viscosity"));
        assert_eq!(nearest("radios", ["centre", "radius"]).as_deref(), Some("radius"));
        assert_eq!(nearest("rigth", ["left", "right"]).as_deref(), Some("right"));
        assert_eq!(nearest("colour", ["centre", "radius"]), None);
    }
}

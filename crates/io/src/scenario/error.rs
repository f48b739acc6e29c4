//! Errors in a scenario, with their place.

use std::fmt;
use std::path::PathBuf;

use super::formula::FormulaError;

/// Place of a key or value: the file and line, or the command-line argument that set the value, and the path of the
/// key.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location {
    /// Scenario file.
    pub file: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Argument of `--set`, if the value came from there.
    pub argument: Option<String>,
    /// Path of the key, such as `body.0.shape.radius`; empty for the file as a whole.
    pub key: String,
}

impl Location {
    pub(super) fn error(&self, kind: impl Into<ErrorKind>) -> ScenarioError {
        ScenarioError { at: Box::new(self.clone()), kind: kind.into() }
    }

    /// Returns an error of the kind [`ErrorKind::Invalid`]; the message states cause and remedy.
    pub(super) fn invalid(&self, message: impl Into<String>) -> ScenarioError {
        self.error(ErrorKind::Invalid(message.into()))
    }

    /// Returns an error about a name that is not among the known ones.
    pub(super) fn unknown<'k>(
        &self,
        what: &'static str,
        found: &str,
        known: impl IntoIterator<Item = &'k str>,
    ) -> ScenarioError {
        let known: Vec<&str> = known.into_iter().collect();
        let advice = advice(found, &known);
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        self.error(ErrorKind::Unknown { what, found: found.to_owned(), advice, known })
    }

    /// Returns the location of a part, on the same line.
    pub(super) fn part(&self, key: impl fmt::Display) -> Self {
        Self { key: format!("{}.{key}", self.key), ..self.clone() }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.argument {
            Some(argument) => write!(f, "--set {argument}")?,
            None => write!(f, "{}:{}", self.file.display(), self.line)?,
        }
        if self.key.is_empty() { Ok(()) } else { write!(f, ": {}", self.key) }
    }
}

/// Error of a scenario that cannot be run.
#[derive(Debug, thiserror::Error)]
#[error("{at}: {kind}")]
pub struct ScenarioError {
    /// Location.
    pub at: Box<Location>,
    /// Cause and remedy.
    pub kind: ErrorKind,
}

/// Cause of an error, with the remedy.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "fields are named after what they contain")]
pub enum ErrorKind {
    /// The text is not TOML.
    #[error("not valid TOML: {0}")]
    Syntax(String),
    /// An argument of `--set` that cannot be applied: cause and remedy.
    #[error("{0}")]
    Override(String),
    /// A key, value or name that does not exist.
    #[error("unknown {what} `{found}`{advice} Known here: {known}")]
    Unknown {
        what: &'static str,
        found: String,
        /// End of the sentence, with the nearest known name if one is near.
        advice: String,
        known: String,
    },
    /// A missing key.
    #[error("the key `{0}` is missing; add it")]
    Missing(&'static str),
    /// A missing key whose declaration is known.
    #[error("the key `{key}` is missing; add it: {value}")]
    Needed {
        key: &'static str,
        /// Type, range and unit of its value, and its meaning.
        value: String,
    },
    /// A value of the wrong type.
    #[error("this is {found}, but must be {expected}")]
    Type {
        /// Type and value found.
        found: String,
        /// Types that are accepted.
        expected: String,
    },
    /// A number out of its range, infinite or NaN.
    #[error("this is {}, but must be {must}", shown(*.value))]
    Range { value: f64, must: String },
    /// A vector of the wrong length.
    #[error("this has {found} components, but dimension = {dimension} needs {dimension}")]
    Components { found: usize, dimension: usize },
    /// A key that has no effect with another setting.
    #[error("this has no effect with {0}: take it out")]
    NoEffect(&'static str),
    /// Neither or both of two alternatives, of which exactly one must be given.
    #[error("give either {0} or {1}")]
    Either(&'static str, &'static str),
    /// A combination of values that cannot be run: cause and remedy.
    #[error("{0}")]
    Invalid(String),
    /// A text that is not a formula.
    #[error(transparent)]
    Formula(#[from] FormulaError),
    /// A mesh that cannot be generated.
    #[error(transparent)]
    Mesh(#[from] mesh::Error),
    /// Invalid data of an elastic body.
    #[error(transparent)]
    Solid(#[from] solid_svk::Error),
    /// Invalid data of a rigid body.
    #[error(transparent)]
    Rigid(#[from] solid_rigid::Error),
    /// Invalid data of a contact.
    #[error(transparent)]
    Contact(#[from] contact::Error),
    /// Surfaces of bodies that cannot cut the background.
    #[error("the bodies cannot cut the background: {0}")]
    Cut(#[from] cutcell::Error),
}

/// Formats a number, with an exponent if it is very small or very large.
pub(super) fn shown(value: f64) -> String {
    let is_plain = value == 0.0 || !value.is_finite() || (1e-6..1e16).contains(&value.abs());
    if is_plain { value.to_string() } else { format!("{value:e}") }
}

/// Sorts names of parts. Numbers at the ends of names are compared by value: `side-3` is before `side-10`.
pub(super) fn sorted(mut names: Vec<&str>) -> Vec<&str> {
    names.sort_by_key(|name| {
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        (stem, name[stem.len()..].parse::<u64>().ok())
    });
    names
}

/// Returns the end of a sentence about an unknown word, with the nearest known one if one is near.
pub(crate) fn advice(found: &str, known: &[&str]) -> String {
    nearest(found, known).map_or(".".to_owned(), |name| format!("; did you mean `{name}`?"))
}

/// Returns the known word nearest to a word if at most a third of the letters differ. Case is ignored.
fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    let word = word.to_lowercase();
    let distance = |candidate: &str| strsim::osa_distance(&word, &candidate.to_lowercase());
    let distances = known.iter().map(|candidate| (distance(candidate), *candidate));
    let nearest = distances.min_by_key(|(distance, _)| *distance);
    nearest.filter(|(d, candidate)| 3 * d <= word.len().max(candidate.len()).max(3)).map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    #[test]
    fn names_of_parts_are_sorted_by_their_numbers() {
        let names = vec!["side-3", "side-10", "hole-1", "wall", "side-1", "end"];
        assert_eq!(super::sorted(names), ["end", "hole-1", "side-1", "side-3", "side-10", "wall"]);
    }
}

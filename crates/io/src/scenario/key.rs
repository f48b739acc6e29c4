//! Declarations of keys, from which the reader, its error messages and the reference page are made.

use std::fmt;

use super::error::{ErrorKind, Location, ScenarioError, shown};
pub use super::quantity::Quantity;

/// Declaration of a key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Name.
    pub name: &'static str,
    /// Meaning, for the reference page and messages.
    pub about: &'static str,
    /// Type of the value.
    pub form: Form,
    /// Physical dimension of its numbers.
    pub quantity: Quantity,
    /// Range of its numbers.
    pub range: Range,
    /// Whether it may be left out.
    pub is_optional: bool,
    /// Index of its group, if exactly one of several groups of optional keys is needed.
    pub group: Option<usize>,
    /// Value if it is left out, as TOML.
    pub default: Option<&'static str>,
}

impl Key {
    pub(super) const fn new(
        name: &'static str,
        about: &'static str,
        form: Form,
        is_optional: bool,
        default: Option<&'static str>,
    ) -> Self {
        let is_optional = is_optional || default.is_some();
        Self { name, about, form, quantity: Quantity::NUMBER, range: Range::Any, is_optional, group: None, default }
    }

    /// Describes the value: type, words of a choice, range and unit, and the first sentence of its meaning.
    pub(super) fn described(&self) -> String {
        let words = match self.form {
            Form::Choice { tag: Some(_), choices } => format!(" ({})", words(choices)),
            _ => String::new(),
        };
        let range = if self.range == Range::Any { String::new() } else { format!(", {}", self.range) };
        let [cgs, si] = [0, 1].map(|system| self.quantity.label_in(system));
        let unit = match (cgs.as_str(), cgs == si) {
            ("", _) => String::new(),
            (_, true) => format!(", in {cgs}"),
            _ => format!(", in {cgs} (cgs) or {si} (si)"),
        };
        let sentence = self.about.trim().split_inclusive(". ").next().unwrap_or_default().trim_end();
        format!("{}{words}{range}{unit}. {sentence}", self.form)
    }

    /// Adds the key to a group of keys. Exactly one of the groups is needed.
    pub(super) const fn group(self, number: usize) -> Self {
        Self { group: Some(number), ..self }
    }

    /// Sets the physical dimension of the numbers.
    pub(super) const fn unit(self, quantity: Quantity) -> Self {
        Self { quantity, ..self }
    }

    /// Requires positive numbers.
    pub(super) const fn positive(self) -> Self {
        Self { range: Range::Positive, ..self }
    }

    /// Requires numbers that are zero or positive.
    pub(super) const fn non_negative(self) -> Self {
        Self { range: Range::NonNegative, ..self }
    }

    /// Requires numbers from `low` to `high`.
    pub(super) const fn between(self, low: f64, high: f64) -> Self {
        Self { range: Range::Between(low, high), ..self }
    }
}

/// Returns an error about a missing key, with the value that its declaration requires.
pub(super) fn missing(at: &Location, keys: &[Key], name: &'static str) -> ScenarioError {
    let key = keys.iter().find(|key| key.name == name);
    at.error(key.map_or(ErrorKind::Missing(name), |key| ErrorKind::Needed { key: name, value: key.described() }))
}

/// Range of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Any,
    /// Larger than zero.
    Positive,
    /// Zero or larger.
    NonNegative,
    /// Between two numbers, both included; the upper one may be infinite.
    Between(f64, f64),
}

impl Range {
    /// Returns whether a number lies in the range; infinity and NaN do not.
    pub(super) fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::Positive => value > 0.0,
                Self::NonNegative => value >= 0.0,
                Self::Between(low, high) => low <= value && value <= high,
            }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Any => f.write_str("finite"),
            Self::Positive => f.write_str("positive and finite"),
            Self::NonNegative => f.write_str("zero or positive, and finite"),
            Self::Between(low, f64::INFINITY) => write!(f, "at least {}", shown(low)),
            Self::Between(low, high) => write!(f, "from {} to {}", shown(low), shown(high)),
        }
    }
}

/// Type of a value.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// Number.
    Number,
    /// Whole number that is not negative.
    Whole,
    /// `true` or `false`.
    Flag,
    /// Text.
    Text,
    /// Formula with the given variables, a number, or a table of the given type with values from a file.
    Field(&'static str, &'static Form),
    /// One value for each axis.
    Components(&'static Form),
    /// Angular velocity: a number, or in space one value for each axis.
    Spin,
    /// List of values.
    List(&'static Form),
    /// Table whose keys are names, each with a value.
    Named(&'static Form),
    /// Table with these keys.
    Table(&'static [Key]),
    /// One of several words, or a table in which the key `tag` selects the further keys.
    ///
    /// A word alone stands for a table with the tag only.
    Choice {
        /// Key that holds the word; `None` if no word has further keys.
        tag: Option<&'static str>,
        /// The words.
        choices: &'static [Choice],
    },
    /// Value, or a table.
    OrTable(&'static Form, &'static Form),
}

/// Word of a [`Form::Choice`].
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// The word.
    pub word: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// Further keys of a table with this word.
    pub keys: &'static [Key],
}

impl Choice {
    /// Returns whether the word may stand alone, since all of its keys are optional.
    pub fn stands_alone(&self) -> bool {
        self.needed().next().is_none()
    }

    /// Returns the names of the required keys, and of the keys of the first group.
    pub(super) fn needed(&self) -> impl Iterator<Item = &'static str> {
        self.keys.iter().filter(|key| !key.is_optional || key.group == Some(0)).map(|key| key.name)
    }
}

/// Returns the words of a choice as a list.
pub(super) fn words(choices: &[Choice]) -> String {
    choices.iter().map(|choice| choice.word).collect::<Vec<_>>().join(", ")
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number => f.write_str("a number"),
            Self::Whole => f.write_str("a whole number that is not negative"),
            Self::Flag => f.write_str("true or false"),
            Self::Text => f.write_str("a string"),
            Self::Field(variables, _) => write!(f, "a number or a formula in {variables} or a table of values"),
            Self::Components(of) => write!(f, "a list with {of} for each axis"),
            Self::Spin => f.write_str("a number, or in space a list with a number for each axis"),
            Self::List(Self::Table(_)) => f.write_str("a table or a list of tables"),
            Self::List(of) => write!(f, "a list; each item is {of}"),
            Self::Named(_) => f.write_str("a table of names"),
            Self::Table(_) => f.write_str("a table"),
            Self::Choice { tag, choices } => {
                let words = choices.iter().filter(|choice| choice.stands_alone()).map(|c| format!("\"{}\"", c.word));
                let table = tag.map(|tag| format!("a table with a {tag}"));
                let all: Vec<String> = words.chain(table).collect();
                write!(f, "{}", all.join(" or "))
            }
            Self::OrTable(plain, _) => write!(f, "{plain} or a table"),
        }
    }
}

//! Declarations of keys. The reader, its error messages and the reference page all follow from them.

use std::fmt;

use super::error::shown;

/// Dimension of a quantity: exponents of length, mass and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Exponent of length.
    pub length: i8,
    /// Exponent of mass.
    pub mass: i8,
    /// Exponent of time.
    pub time: i8,
}

#[allow(missing_docs)] // each constant is the quantity that it names
impl Quantity {
    pub const NUMBER: Self = Self::new(0, 0, 0);
    pub const LENGTH: Self = Self::new(1, 0, 0);
    pub const MASS: Self = Self::new(0, 1, 0);
    pub const TIME: Self = Self::new(0, 0, 1);
    pub const VELOCITY: Self = Self::new(1, 0, -1);
    pub const ACCELERATION: Self = Self::new(1, 0, -2);
    /// Angular velocity.
    pub const RATE: Self = Self::new(0, 0, -1);
    pub const DENSITY: Self = Self::new(-3, 1, 0);
    /// Dynamic viscosity.
    pub const VISCOSITY: Self = Self::new(-1, 1, -1);
    pub const FORCE: Self = Self::new(1, 1, -2);
    /// Force per area: pressure, traction, stiffness.
    pub const PRESSURE: Self = Self::new(-1, 1, -2);
    /// Force per volume.
    pub const FORCE_DENSITY: Self = Self::new(-2, 1, -2);
    pub const ENERGY: Self = Self::new(2, 1, -2);
    pub const POWER: Self = Self::new(2, 1, -3);
    /// Volume per time.
    pub const FLUX: Self = Self::new(3, 0, -1);

    const fn new(length: i8, mass: i8, time: i8) -> Self {
        Self { length, mass, time }
    }
}

/// Declaration of a key.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Name.
    pub name: &'static str,
    /// One sentence.
    pub about: &'static str,
    /// Type of the value.
    pub form: Form,
    /// Dimension of its numbers.
    pub quantity: Quantity,
    /// Range of its numbers.
    pub range: Range,
    /// Whether it may be left out.
    pub is_optional: bool,
    /// Number of its group, if exactly one of several groups of optional keys is needed.
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

    /// Makes this a key of one of several groups, of which exactly one is needed.
    pub(super) const fn group(self, number: usize) -> Self {
        Self { group: Some(number), ..self }
    }

    /// Sets the dimension of the numbers.
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
    /// Formula with the given variables, a number, or a table with values from a file.
    Field(&'static str, &'static Form),
    /// One value for each axis.
    Components(&'static Form),
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
    /// Keys that come with it.
    pub keys: &'static [Key],
}

impl Choice {
    /// Returns whether the word may stand alone, since all of its keys are optional.
    pub fn stands_alone(&self) -> bool {
        self.needed().next().is_none()
    }

    /// Returns the names of keys that are needed, those of the first group among them.
    pub(super) fn needed(&self) -> impl Iterator<Item = &'static str> {
        self.keys.iter().filter(|key| !key.is_optional || key.group == Some(0)).map(|key| key.name)
    }
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

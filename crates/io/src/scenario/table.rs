//! Typed cursor over a TOML document: values with their location, and tables whose keys are declared.
//!
//! [`keys!`] declares a table and [`choices!`] an enumeration of words, each with its reader. The type of a field is
//! the type of its key, and its comment is the text of the reference page.

use std::ops::Deref;
use std::path::PathBuf;

use solid_rigid::Spin;
use solid_rigid::modes::n_rotations;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{ErrorKind, Location, ScenarioError, shown};
use super::key::{Choice, Form, Key, missing, words};

/// Text of a scenario, for the conversion of offsets to lines.
#[derive(Clone, Debug)]
pub(super) struct Document {
    /// Scenario file.
    pub(super) file: PathBuf,
    /// Its text.
    pub(super) text: String,
    /// Arguments of `--set`, each with its offset as if it followed the text.
    pub(super) arguments: Vec<(usize, String)>,
    /// Dimension of space, the length of vectors.
    pub(super) dimension: usize,
}

impl Document {
    pub(super) fn locate(&self, offset: usize, key: &str) -> Location {
        let argument = self.arguments.iter().rev().find(|(start, _)| *start <= offset).map(|(_, set)| set.clone());
        let line = self.text.bytes().take(offset).filter(|b| *b == b'\n').count() + 1;
        Location { file: self.file.clone(), line, argument, key: key.to_owned() }
    }
}

/// A TOML value with its key and its place in the file, before it is read.
#[derive(Clone)]
pub(super) struct Node<'d> {
    pub(super) document: &'d Document,
    pub(super) value: &'d DeValue<'d>,
    /// Offset of the key, or of the value in a list.
    start: usize,
    key: String,
}

impl<'d> Node<'d> {
    pub(super) fn root(document: &'d Document, value: &'d DeValue<'d>) -> Self {
        Self { document, value, start: 0, key: String::new() }
    }

    pub(super) fn at(&self) -> Location {
        self.document.locate(self.start, &self.key)
    }

    fn below(&self, key: &str, start: usize, value: &'d DeValue<'d>) -> Self {
        let key = if self.key.is_empty() { key.to_owned() } else { format!("{}.{key}", self.key) };
        Self { document: self.document, value, start, key }
    }

    /// Returns the items of a list; `None` for another value.
    pub(super) fn items(&self) -> Option<Vec<Node<'d>>> {
        let DeValue::Array(items) = self.value else { return None };
        let item = |(k, item): (usize, &'d Spanned<DeValue<'d>>)| {
            self.below(&k.to_string(), item.span().start, item.get_ref())
        };
        Some(items.iter().enumerate().map(item).collect())
    }

    /// Returns the entries of a table, in the order of their names; `None` for another value.
    pub(super) fn entries(&self) -> Option<Vec<(&'d str, Node<'d>)>> {
        let DeValue::Table(table) = self.value else { return None };
        let entry = |(key, value): (&'d Spanned<_>, &'d Spanned<DeValue<'d>>)| {
            let name: &'d std::borrow::Cow<'d, str> = key.get_ref();
            (name.as_ref(), self.below(name, key.span().start, value.get_ref()))
        };
        Some(table.iter().map(entry).collect())
    }

    /// Returns an error about the type of the value.
    pub(super) fn refuse(&self, expected: &Form) -> ScenarioError {
        let found = match self.value {
            DeValue::String(text) => format!("the string \"{text}\""),
            DeValue::Boolean(value) => format!("the boolean `{value}`"),
            DeValue::Integer(found) if whole(self.value).is_none() => {
                format!("the whole number `{}`, which is too large", found.as_str())
            }
            DeValue::Integer(_) | DeValue::Float(_) => {
                format!("the number `{}`", shown(number(self.value).unwrap_or(f64::NAN)))
            }
            DeValue::Datetime(_) => "a date".to_owned(),
            DeValue::Array(_) => "a list".to_owned(),
            DeValue::Table(_) => "a table".to_owned(),
        };
        self.at().error(ErrorKind::Type { found, expected: expected.to_string() })
    }

    /// Checks the range of the number, or of all numbers of the list.
    fn check(&self, key: &Key) -> Result<(), ScenarioError> {
        if let Some(value) = number(self.value).filter(|value| !key.range.contains(*value)) {
            return Err(self.at().error(ErrorKind::Range { value, must: key.range.to_string() }));
        }
        self.items().into_iter().flatten().try_for_each(|item| item.check(key))
    }

    /// Opens the value as a table with declared keys and, if given, a tag.
    ///
    /// # Errors
    /// Another type, or a key that is not declared.
    pub(super) fn table(&self, keys: &'static [Key], tag: Option<&'static str>) -> Result<Table<'d>, ScenarioError> {
        let entries = self.entries().ok_or_else(|| self.refuse(&Form::Table(keys)))?;
        let mut names = tag.into_iter().chain(keys.iter().map(|key| key.name));
        if let Some((name, node)) = entries.iter().find(|(name, _)| !names.clone().any(|known| known == *name)) {
            if name.parse::<usize>().is_ok() && !self.key.is_empty() {
                let key = &self.key;
                let below =
                    node.entries().and_then(|entries| entries.first().map(|(below, _)| *below)).unwrap_or("KEY");
                return Err(node.at().invalid(format!("`{key}` is one table here, not a list: write {key}.{below}")));
            }
            return Err(node.at().unknown("key", name, names.by_ref()));
        }
        Ok(Table { node: self.clone(), entries, keys })
    }

    /// Reads the word of a choice and opens the table that comes with it.
    pub(super) fn choice(
        &self,
        tag: Option<&'static str>,
        choices: &'static [Choice],
    ) -> Result<(&'static str, Table<'d>), ScenarioError> {
        let (word, node) = match (self.value, tag) {
            (DeValue::String(word), _) => (word, self.clone()),
            (DeValue::Table(_), Some(tag)) => {
                let mut entries = self.entries().into_iter().flatten();
                let found = entries.find(|(name, _)| *name == tag);
                let (_, node) = found.ok_or_else(|| {
                    self.at().error(ErrorKind::Needed { key: tag, value: format!("one of {}", words(choices)) })
                })?;
                match node.value {
                    DeValue::String(word) => (word, node),
                    _ => return Err(node.refuse(&Form::Text)),
                }
            }
            _ => return Err(self.refuse(&Form::Choice { tag, choices })),
        };
        let Some(choice) = choices.iter().find(|choice| choice.word == word.as_ref()) else {
            return Err(node.at().unknown("value", word, choices.iter().map(|choice| choice.word)));
        };
        let table = match (self.value, tag) {
            (DeValue::Table(_), _) => self.table(choice.keys, tag)?,
            (_, Some(tag)) if !choice.stands_alone() => {
                let keys: String = choice.needed().map(|key| format!(", {key} = ...")).collect();
                let table = format!("{{ {tag} = \"{word}\"{keys} }}");
                return Err(self.at().invalid(format!("the word alone is not enough: write {table}")));
            }
            _ => Table { node: self.clone(), entries: Vec::new(), keys: choice.keys },
        };
        Ok((choice.word, table))
    }
}

/// Returns a value as a number. Whole numbers may have the prefix of a base.
fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(number) => Some(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Integer(number) => {
            // A whole number beyond i128 is out of every range.
            let value = i128::from_str_radix(number.as_str(), number.radix());
            Some(value.map_or(f64::INFINITY, |value| value as f64))
        }
        _ => None,
    }
}

/// Returns a whole number; `None` for another value, and if it is too large for TOML.
fn whole(value: &DeValue<'_>) -> Option<i64> {
    value.as_integer().and_then(|number| i64::from_str_radix(number.as_str(), number.radix()).ok())
}

/// A table with declared keys.
pub(super) struct Table<'d> {
    node: Node<'d>,
    entries: Vec<(&'d str, Node<'d>)>,
    keys: &'static [Key],
}

impl Table<'_> {
    /// Reads the value of a declared key.
    ///
    /// # Errors
    /// A missing key, a wrong type, or a number out of the declared range.
    pub(super) fn get<T: KeyValue>(&self, name: &'static str) -> Result<T, ScenarioError> {
        let key = self.keys.iter().find(|key| key.name == name);
        if let Some((_, node)) = self.entries.iter().find(|(found, _)| *found == name) {
            key.map_or(Ok(()), |key| node.check(key))?;
            return T::read(node);
        }
        if let Some(default) = key.and_then(|key| key.default).and_then(|text| DeValue::parse(text).ok()) {
            // A default has the location of the table.
            return T::read(&Node { value: default.get_ref(), ..self.node.clone() });
        }
        T::ABSENT.map(|absent| absent()).ok_or_else(|| missing(&self.node.at(), self.keys, name))
    }
}

/// A value of a scenario.
pub(super) trait KeyValue: Sized {
    /// Form of the value, for messages and the reference page.
    const FORM: Form;
    /// The value of a key that was left out, if that is allowed.
    const ABSENT: Option<fn() -> Self> = None;

    /// Reads the value.
    fn read(node: &Node<'_>) -> Result<Self, ScenarioError>;
}

/// One of several words.
pub(crate) trait Choose {
    /// Returns the word.
    fn word(&self) -> &'static str;
}

/// A value with its location; equal to another one if the values are.
#[derive(Clone, Debug)]
pub struct At<T> {
    value: T,
    /// The location.
    pub at: Location,
}

impl<T> At<T> {
    /// Creates a value without a location.
    #[cfg(test)]
    pub(super) fn nowhere(value: T) -> Self {
        Self { value, at: Location::default() }
    }

    /// Returns a value that is computed from this one, with the same location.
    pub(super) fn map<U>(&self, value: impl FnOnce(&T) -> U) -> At<U> {
        At { value: value(&self.value), at: self.at.clone() }
    }
}

impl<T> Deref for At<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: PartialEq> PartialEq for At<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T: KeyValue> KeyValue for At<T> {
    const FORM: Form = T::FORM;

    fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
        Ok(Self { value: T::read(node)?, at: node.at() })
    }
}

impl<T: KeyValue> KeyValue for Option<T> {
    const FORM: Form = T::FORM;
    const ABSENT: Option<fn() -> Self> = Some(|| None);

    fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
        T::read(node).map(Some)
    }
}

impl<T: KeyValue> KeyValue for Vec<T> {
    const FORM: Form = Form::List(&T::FORM);
    const ABSENT: Option<fn() -> Self> = Some(Vec::new);

    fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
        // A table alone is a list of one.
        if let (Form::Table(_), DeValue::Table(_)) = (T::FORM, node.value) {
            return Ok(vec![T::read(node)?]);
        }
        node.items().ok_or_else(|| node.refuse(&Self::FORM))?.iter().map(T::read).collect()
    }
}

/// Values with names, in the order of the names.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T>(pub Vec<(String, At<T>)>);

impl<T: KeyValue> KeyValue for Named<T> {
    const FORM: Form = Form::Named(&T::FORM);
    const ABSENT: Option<fn() -> Self> = Some(|| Self(Vec::new()));

    fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
        let entries = node.entries().ok_or_else(|| node.refuse(&Self::FORM))?;
        let read = |(name, node): &(&str, Node<'_>)| Ok(((*name).to_owned(), At::read(node)?));
        Ok(Self(entries.iter().map(read).collect::<Result<_, _>>()?))
    }
}

/// One value for each axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Components<T>(Vec<T>);

impl<T> Deref for Components<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.0
    }
}

impl Components<f64> {
    /// Returns the sum with a vector of the same dimension.
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self(self.iter().zip(other.iter()).map(|(a, b)| a + b).collect())
    }
}

impl<T: KeyValue> KeyValue for Components<T> {
    const FORM: Form = Form::Components(&T::FORM);

    fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
        let items = node.items().ok_or_else(|| node.refuse(&Self::FORM))?;
        let (found, dimension) = (items.len(), node.document.dimension);
        if found != dimension {
            return Err(node.at().error(ErrorKind::Components { found, dimension }));
        }
        Ok(Self(items.iter().map(T::read).collect::<Result<_, _>>()?))
    }
}

impl Components<f64> {
    /// Returns the vector; `D` is the dimension of the scenario.
    pub fn vector<const D: usize>(&self) -> mesh::Vector<D> {
        mesh::Vector::from_fn(|axis, _| self.0[axis])
    }
}

impl KeyValue for Spin {
    const FORM: Form = Form::Spin;

    fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
        let (mut spin, dimension) = ([0.0; 3], node.document.dimension);
        match node.items() {
            Some(_) if n_rotations(dimension) == 1 => {
                return Err(node.at().invalid("a body in the plane has one angular velocity: give a number"));
            }
            Some(_) => spin.copy_from_slice(&Components::<f64>::read(node)?),
            // A number is the rate about the third axis, the only one in the plane.
            None => {
                spin[n_rotations(dimension) - 1] = number(node.value).ok_or_else(|| node.refuse(&Self::FORM))?;
            }
        }
        Ok(spin)
    }
}

/// A value, or a table with further keys.
#[derive(Clone, Debug, PartialEq)]
pub enum OrTable<T, K> {
    /// The value.
    Plain(T),
    /// The table.
    Table(K),
}

impl<T: KeyValue, K: KeyValue> KeyValue for OrTable<T, K> {
    const FORM: Form = Form::OrTable(&T::FORM, &K::FORM);

    fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
        match node.value {
            DeValue::Table(_) => K::read(node).map(Self::Table),
            _ => T::read(node).map(Self::Plain).map_err(|error| match error.kind {
                ErrorKind::Type { .. } => node.refuse(&Self::FORM),
                _ => error,
            }),
        }
    }
}

/// Implements [`KeyValue`] for types that one kind of TOML value represents.
macro_rules! plain_values {
    ($($Type:ty, $form:ident, $of:expr;)+) => {$(
        impl KeyValue for $Type {
            const FORM: Form = Form::$form;

            fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
                let of: fn(&DeValue<'_>) -> Option<Self> = $of;
                of(node.value).ok_or_else(|| node.refuse(&Self::FORM))
            }
        }
    )+};
}

plain_values! {
    f64, Number, number;
    bool, Flag, |value| value.as_bool();
    String, Text, |value| value.as_str().map(str::to_owned);
    usize, Whole, |value| whole(value).and_then(|n| n.try_into().ok());
    u32, Whole, |value| whole(value).and_then(|n| n.try_into().ok());
}

/// Declares a table of a scenario and derives its reader.
///
/// A field is a key: `name: type [unit(..), range] = default`, with one sentence as its comment. The default is TOML.
macro_rules! keys {
    (
        $(#[doc = $doc:literal])+
        pub struct $Name:ident { $(
            $(#[doc = $about:literal])+
            $field:ident : $Type:ty $([$($spec:ident $(($($argument:expr),*))?),*])? $(= $default:tt)?
        ),* $(,)? }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $Name { $($(#[doc = $about])+ pub $field: $Type),* }

        impl $Name {
            /// Declarations of the keys.
            pub const KEYS: &'static [$crate::scenario::key::Key] = &[$($crate::scenario::table::key!(
                [$($about)+] $field, $Type, [$($($spec $(($($argument),*))?),*)?], $($default)?
            )),*];
        }

        const _: () = {
            use $crate::scenario::{ScenarioError, key::Form, table::{KeyValue, Node, Table}};

            impl $Name {
                /// Reads the keys of an open table.
                pub(super) fn of(table: &Table<'_>) -> Result<Self, ScenarioError> {
                    Ok(Self { $($field: table.get(stringify!($field))?),* })
                }
            }

            impl KeyValue for $Name {
                const FORM: Form = Form::Table(Self::KEYS);

                fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
                    Self::of(&node.table(Self::KEYS, None)?)
                }
            }
        };
    };
}

/// Declares an enumeration of words and derives its reader. A word may have further keys, or a table of keys.
macro_rules! choices {
    (
        $(#[doc = $doc:literal])+
        $(#[derive($($derive:ident),*)])?
        pub enum $Name:ident $([$tag:literal])? { $(
            $(#[doc = $about_word:literal])+
            $Word:ident $(($Keys:ident))? = $word:literal $({ $(
                $(#[doc = $about:literal])+
                $field:ident : $Type:ty $([$($spec:ident $(($($argument:expr),*))?),*])? $(= $default:tt)?
            ),* $(,)? })?
        ),* $(,)? }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq $(, $($derive),*)?)]
        pub enum $Name {
            $($(#[doc = $about_word])+ $Word $({ $($(#[doc = $about])+ $field: $Type),* })? $(($Keys))?),*
        }

        const _: () = {
            use $crate::scenario::{ScenarioError, key::{Choice, Form}, table::{KeyValue, Node}};

            const TAG: Option<&str> = [$(Some($tag),)? None][0];
            const CHOICES: &[Choice] = &[$(Choice {
                word: $word,
                about: concat!($($about_word),+),
                keys: [$($Keys::KEYS,)? &[$($($crate::scenario::table::key!(
                    [$($about)+] $field, $Type, [$($($spec $(($($argument),*))?),*)?], $($default)?
                )),*)?]][0],
            }),*];

            impl $crate::scenario::table::Choose for $Name {
                fn word(&self) -> &'static str {
                    match self { $(Self::$Word { .. } => $word),* }
                }
            }

            impl KeyValue for $Name {
                const FORM: Form = Form::Choice { tag: TAG, choices: CHOICES };

                fn read(node: &Node<'_>) -> Result<Self, ScenarioError> {
                    let (word, _table) = node.choice(TAG, CHOICES)?;
                    match word {
                        $($word => {
                            Ok(Self::$Word $({ $($field: _table.get(stringify!($field))?),* })? $(($Keys::of(&_table)?))?)
                        })*
                        _ => Err(node.refuse(&Self::FORM)),
                    }
                }
            }
        };
    };
}

/// Declaration of one key, from a field of [`keys!`] or [`choices!`].
macro_rules! key {
    ([$($about:literal)+] $field:ident, $Type:ty, [$($spec:ident $(($($argument:expr),*))?),*], $($default:tt)?) => {
        $crate::scenario::key::Key::new(
            stringify!($field),
            concat!($($about),+),
            <$Type as $crate::scenario::table::KeyValue>::FORM,
            <$Type as $crate::scenario::table::KeyValue>::ABSENT.is_some(),
            [$(Some(stringify!($default)),)? None][0],
        )$(.$spec($($($argument),*)?))*
    };
}

pub(super) use {choices, key, keys};

pub(super) fn parse<'t>(document: &Document, text: &'t str) -> Result<DeTable<'t>, ScenarioError> {
    DeTable::parse(text).map(Spanned::into_inner).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        let is_number = error.message().contains("mantissa") || error.message().contains("fraction");
        let remedy =
            if is_number { "; a number has digits before and after its point, such as 0.5 or 1.0" } else { "" };
        document.locate(offset, "").error(ErrorKind::Syntax(error.message().to_owned() + remedy))
    })
}

//! The text of a scenario with the changes of the command line, and where each value stands.

use std::borrow::Cow;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde::de::IntoDeserializer;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::problem::{Place, Problem, ScenarioError, nearest};
use super::schema::Scenario;

/// Where each key and value of a scenario stands.
#[derive(Clone, Debug)]
pub(super) struct Document {
    file: PathBuf,
    text: String,
    /// Start of each argument in the virtual text, with the argument.
    arguments: Vec<(usize, String)>,
    /// In the order of the text.
    entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
struct Entry {
    path: String,
    key: Range<usize>,
    value: Range<usize>,
    /// The value as serde names it in errors.
    described: String,
    is_finite: bool,
}

impl Document {
    /// Reads a scenario and applies changes `KEY=VALUE` to it.
    pub(super) fn parse(file: &Path, text: &str, sets: &[String]) -> Result<(Self, Scenario), ScenarioError> {
        let mut document =
            Self { file: file.to_owned(), text: text.to_owned(), arguments: Vec::new(), entries: Vec::new() };
        // Each argument is parsed behind as many blanks as there is text before it, so that all spans are distinct.
        let mut end = text.len() + 1;
        let mut changes = Vec::new();
        for set in sets {
            document.arguments.push((end, set.clone()));
            changes.push(document.change(set, end)?);
            end += set.len() + 3;
        }
        let mut table = DeTable::parse(text).map_err(|e| document.syntax(&e))?;
        for (change, argument) in changes.iter().zip(&document.arguments) {
            let parsed = DeTable::parse(&change.text).map_err(|e| document.syntax(&e))?.into_inner();
            if let Err(problem) = insert(table.get_mut(), parsed, change.depth) {
                return Err(document.error_at(argument.0, String::new(), problem));
            }
        }
        document.index(table.get_ref(), "");
        document.entries.sort_by_key(|entry| entry.key.start);
        if let Some(entry) = document.entries.iter().find(|e| !e.is_finite) {
            return Err(document.error_at(entry.value.start, entry.path.clone(), Problem::NotFinite));
        }
        let scenario = Scenario::deserialize(table.into_deserializer()).map_err(|e| document.explain(&e))?;
        Ok((document, scenario))
    }

    /// The file that it was read from.
    pub(super) fn file(&self) -> &Path {
        &self.file
    }

    /// The place of a key, or of the nearest table around it that is there.
    pub(super) fn place(&self, path: &str) -> Place {
        let mut known = path;
        loop {
            if let Some(entry) = self.entries.iter().find(|e| e.path == known) {
                return self.place_at(entry.key.start, path.to_owned());
            }
            match known.rsplit_once('.') {
                Some((outer, _)) => known = outer,
                None => return self.place_at(0, path.to_owned()),
            }
        }
    }

    fn place_at(&self, offset: usize, key: String) -> Place {
        let argument = self.arguments.iter().rev().find(|(start, _)| *start <= offset).map(|(_, set)| set.clone());
        let line = self.text.bytes().take(offset).filter(|b| *b == b'\n').count() + 1;
        Place { file: self.file.clone(), line, argument, key }
    }

    fn error_at(&self, offset: usize, key: String, problem: Problem) -> ScenarioError {
        ScenarioError { place: Box::new(self.place_at(offset, key)), problem }
    }

    fn syntax(&self, error: &toml::de::Error) -> ScenarioError {
        let offset = error.span().map_or(0, |span| span.start);
        self.error_at(offset, String::new(), Problem::Syntax { message: error.message().to_owned() })
    }

    /// An argument as TOML behind blanks, and the number of segments of its key.
    fn change(&self, set: &str, blanks: usize) -> Result<Change, ScenarioError> {
        let refuse = || self.error_at(blanks, String::new(), Problem::Argument);
        let (key, value) = set.split_once('=').ok_or_else(refuse)?;
        let depth = DeTable::parse(&format!("{key}=0")).map(|t| depth(t.get_ref())).map_err(|_| refuse())?;
        let blanks = " ".repeat(blanks);
        let plain = format!("{blanks}{set}");
        // A bare word is a string.
        let text = if DeTable::parse(&plain).is_ok() { plain } else { format!("{blanks}{key}='{value}'") };
        Ok(Change { text, depth })
    }

    /// Collects keys and values below a table.
    fn index(&mut self, table: &DeTable<'_>, prefix: &str) {
        for (key, value) in table {
            let path =
                if prefix.is_empty() { key.get_ref().to_string() } else { format!("{prefix}.{}", key.get_ref()) };
            self.index_value(value, path, key.span());
        }
    }

    fn index_value(&mut self, value: &Spanned<DeValue<'_>>, path: String, key: Range<usize>) {
        let (described, is_finite) = describe(value.get_ref());
        self.entries.push(Entry { path: path.clone(), key, value: value.span(), described, is_finite });
        match value.get_ref() {
            DeValue::Table(table) => self.index(table, &path),
            DeValue::Array(items) => {
                for (k, item) in items.iter().enumerate() {
                    self.index_value(item, format!("{path}.{k}"), item.span());
                }
            }
            _ => {}
        }
    }

    /// Says where an error of serde comes from, in our words.
    ///
    /// Serde buffers tagged tables and forgets where their parts stand, so the part is looked up below the table.
    fn explain(&self, error: &toml::de::Error) -> ScenarioError {
        let message = error.message();
        let span = error.span().unwrap_or(0..0);
        let around =
            self.entries.iter().find(|e| e.value == span).or_else(|| self.entries.iter().find(|e| e.key == span));
        let outer = around.map_or("", |entry| entry.path.as_str());
        let below = |accept: &dyn Fn(&Entry) -> bool| {
            self.entries.iter().find(|e| (outer.is_empty() || e.path == outer || is_below(&e.path, outer)) && accept(e))
        };
        let words: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        let found = words.first().copied().unwrap_or_default();
        let known: Vec<String> = words.iter().skip(1).map(|w| (*w).to_owned()).collect();
        let near = nearest(found, known.iter().map(String::as_str));
        let (entry, problem) = if message.starts_with("unknown field") {
            (below(&|e| last(&e.path) == found), Problem::UnknownKey { nearest: near, known })
        } else if message.starts_with("unknown variant") {
            let described = describe(&DeValue::String(Cow::Borrowed(found))).0;
            let problem = Problem::UnknownValue { found: found.to_owned(), nearest: near, known };
            (below(&|e| e.described == described), problem)
        } else if message.starts_with("missing field") {
            (around, Problem::Missing { key: found.to_owned() })
        } else if let Some((found, expected)) =
            message.strip_prefix("invalid type: ").and_then(|m| m.split_once(", expected "))
        {
            let problem = Problem::WrongType { found: found.to_owned(), expected: in_words(expected).to_owned() };
            (below(&|e| e.described == found), problem)
        } else {
            (around, Problem::Schema { message: message.to_owned() })
        };
        match entry.or(around) {
            Some(entry) => self.error_at(entry.key.start, entry.path.clone(), problem),
            None => self.error_at(span.start, String::new(), problem),
        }
    }
}

struct Change {
    text: String,
    depth: usize,
}

/// Number of segments of the first key.
fn depth(table: &DeTable<'_>) -> usize {
    match table.values().next().map(Spanned::get_ref) {
        Some(DeValue::Table(inner)) => 1 + depth(inner),
        _ => 1,
    }
}

/// Moves the value at the end of a key of `depth` segments into a table.
fn insert<'t>(target: &mut DeTable<'t>, change: DeTable<'t>, depth: usize) -> Result<(), Problem> {
    let Some((key, value)) = change.into_iter().next() else { return Err(Problem::Argument) };
    if depth == 1 {
        target.remove(key.get_ref().as_ref());
        target.insert(key, value);
        return Ok(());
    }
    let missing = || Problem::NoEntry { segment: key.get_ref().to_string() };
    let DeValue::Table(inner) = value.get_ref() else { return Err(missing()) };
    let inner = inner.clone();
    match target.get_mut(key.get_ref().as_ref()).map(Spanned::get_mut) {
        None => {
            target.insert(key, value);
            Ok(())
        }
        Some(DeValue::Table(table)) => insert(table, inner, depth - 1),
        Some(DeValue::Array(items)) => insert_into_array(items, inner, depth - 1),
        Some(_) => Err(missing()),
    }
}

fn insert_into_array<'t>(items: &mut [Spanned<DeValue<'t>>], change: DeTable<'t>, depth: usize) -> Result<(), Problem> {
    let Some((key, value)) = change.into_iter().next() else { return Err(Problem::Argument) };
    let missing = || Problem::NoEntry { segment: key.get_ref().to_string() };
    let item = key.get_ref().parse::<usize>().ok().and_then(|k| items.get_mut(k)).ok_or_else(missing)?;
    if depth == 1 {
        *item = value;
        return Ok(());
    }
    match (item.get_mut(), value.into_inner()) {
        (DeValue::Table(table), DeValue::Table(inner)) => insert(table, inner, depth - 1),
        _ => Err(missing()),
    }
}

/// A value as serde names it when its type is wrong, and whether it is a finite number if it is a number.
fn describe(value: &DeValue<'_>) -> (String, bool) {
    use serde::de::Unexpected;
    match value {
        DeValue::String(text) => (Unexpected::Str(text).to_string(), true),
        DeValue::Integer(number) => {
            let value = i64::from_str_radix(number.as_str(), number.radix()).unwrap_or_default();
            (Unexpected::Signed(value).to_string(), true)
        }
        DeValue::Float(number) => {
            let value = number.as_str().parse::<f64>().unwrap_or(f64::NAN);
            (Unexpected::Float(value).to_string(), value.is_finite())
        }
        DeValue::Boolean(value) => (Unexpected::Bool(*value).to_string(), true),
        DeValue::Datetime(_) => (Unexpected::Other("datetime").to_string(), true),
        DeValue::Array(_) => (Unexpected::Seq.to_string(), true),
        DeValue::Table(_) => (Unexpected::Map.to_string(), true),
    }
}

fn in_words(expected: &str) -> &str {
    match expected {
        "f64" | "f32" => "a number",
        "usize" | "u32" | "u64" => "a whole number that is not negative",
        "a string" => "a string",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        tagged if tagged.starts_with("internally tagged enum") => "a table with a kind",
        other => other,
    }
}

fn last(path: &str) -> &str {
    path.rsplit_once('.').map_or(path, |(_, last)| last)
}

fn is_below(path: &str, outer: &str) -> bool {
    path.strip_prefix(outer).is_some_and(|rest| rest.starts_with('.'))
}

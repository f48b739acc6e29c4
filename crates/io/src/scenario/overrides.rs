//! Changes of single values of a scenario: `--set KEY=VALUE`.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{ErrorKind, Location, ScenarioError};
use super::table::{Document, parse};

/// Arguments of `--set` as TOML.
///
/// Each argument is parsed behind as many blanks as there is text before it, so that all offsets are distinct.
pub(super) struct Overrides(Vec<Change>);

struct Change {
    text: String,
    /// Offset of the argument.
    start: usize,
    /// Number of segments of its key.
    depth: usize,
}

impl Overrides {
    /// Reads arguments and appends them to the document.
    pub(super) fn read(document: &mut Document, arguments: &[String]) -> Result<Self, ScenarioError> {
        let mut start = document.text.len() + 1;
        let mut changes = Vec::with_capacity(arguments.len());
        for argument in arguments {
            document.arguments.push((start, argument.clone()));
            let refuse = || no_argument(&document.locate(start, ""));
            let (key, value) = argument.split_once('=').ok_or_else(refuse)?;
            let depth = DeTable::parse(&format!("{key}=0")).map(|t| depth(t.get_ref())).map_err(|_| refuse())?;
            let blanks = " ".repeat(start);
            let plain = format!("{blanks}{argument}");
            // A bare word is a string.
            let text = if DeTable::parse(&plain).is_ok() { plain } else { format!("{blanks}{key}='{value}'") };
            changes.push(Change { text, start, depth });
            start += argument.len() + 3;
        }
        Ok(Self(changes))
    }

    /// Applies the changes to a table.
    pub(super) fn apply<'t>(&'t self, document: &Document, table: &mut DeTable<'t>) -> Result<(), ScenarioError> {
        for change in &self.0 {
            insert(table, parse(document, &change.text)?, change.depth, &document.locate(change.start, ""))?;
        }
        Ok(())
    }
}

fn no_argument(at: &Location) -> ScenarioError {
    let message = "expected KEY=VALUE, such as time.step=5e-4 or body.0.density=2".to_owned();
    at.error(ErrorKind::Override(message))
}

fn no_entry(at: &Location, segment: &str) -> ScenarioError {
    at.error(ErrorKind::Override(format!("there is no entry `{segment}` to be set; check the key")))
}

/// Returns the number of segments of the first key.
fn depth(table: &DeTable<'_>) -> usize {
    match table.values().next().map(Spanned::get_ref) {
        Some(DeValue::Table(inner)) => 1 + depth(inner),
        _ => 1,
    }
}

/// Moves the value at the end of a key of `depth` segments into a table.
fn insert<'t>(target: &mut DeTable<'t>, change: DeTable<'t>, depth: usize, at: &Location) -> Result<(), ScenarioError> {
    let Some((key, value)) = change.into_iter().next() else { return Err(no_argument(at)) };
    let name = key.get_ref().to_string();
    if depth == 1 {
        target.remove(name.as_str());
        target.insert(key, value);
        return Ok(());
    }
    let Some(found) = target.get_mut(name.as_str()) else {
        target.insert(key, value);
        return Ok(());
    };
    let DeValue::Table(inner) = value.into_inner() else { return Err(no_entry(at, &name)) };
    match found.get_mut() {
        DeValue::Table(table) => insert(table, inner, depth - 1, at),
        DeValue::Array(items) => insert_into_list(items, inner, depth - 1, at),
        _ => Err(no_entry(at, &name)),
    }
}

fn insert_into_list<'t>(
    items: &mut [Spanned<DeValue<'t>>],
    change: DeTable<'t>,
    depth: usize,
    at: &Location,
) -> Result<(), ScenarioError> {
    let Some((key, value)) = change.into_iter().next() else { return Err(no_argument(at)) };
    let missing = || no_entry(at, key.get_ref());
    let item = key.get_ref().parse::<usize>().ok().and_then(|k| items.get_mut(k)).ok_or_else(missing)?;
    if depth == 1 {
        *item = value;
        return Ok(());
    }
    match (item.get_mut(), value.into_inner()) {
        (DeValue::Table(table), DeValue::Table(inner)) => insert(table, inner, depth - 1, at),
        _ => Err(missing()),
    }
}

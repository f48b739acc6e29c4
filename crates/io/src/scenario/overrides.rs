//! Changes of single values of a scenario: `--set KEY=VALUE`.

use std::borrow::Cow;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{ErrorKind, ScenarioError};
use super::table::{Document, parse};

pub(super) struct Change<'a> {
    /// Segments of the key.
    path: Vec<&'a str>,
    /// The assignment `_ = VALUE` after blanks, so that its offsets lie behind those of the file and of earlier
    /// arguments, and identify the argument.
    text: String,
    /// Offset of the argument.
    start: usize,
}

/// Reads arguments and appends them to the document.
pub(super) fn read<'a>(document: &mut Document, arguments: &'a [String]) -> Result<Vec<Change<'a>>, ScenarioError> {
    let mut start = document.text.len() + 1;
    let mut changes = Vec::with_capacity(arguments.len());
    for argument in arguments {
        document.arguments.push((start, argument.clone()));
        let (key, value) = argument.split_once('=').unwrap_or_default();
        let path: Vec<&str> = key.split('.').map(str::trim).collect();
        if path.iter().any(|segment| segment.is_empty()) {
            let message = "expected KEY=VALUE, such as time.step=5e-4 or body.0.density=2".to_owned();
            return Err(document.locate(start, "").error(ErrorKind::Override(message)));
        }
        let blanks = " ".repeat(start);
        let plain = format!("{blanks}_={value}");
        // A bare word is a string.
        let text = if DeTable::parse(&plain).is_ok() { plain } else { format!("{blanks}_='{value}'") };
        changes.push(Change { path, text, start });
        start += argument.len() + 5;
    }
    Ok(changes)
}

pub(super) fn apply<'t>(
    changes: &'t [Change<'_>],
    document: &Document,
    root: &mut Spanned<DeValue<'t>>,
) -> Result<(), ScenarioError> {
    for Change { path, text, start } in changes {
        let table = parse(document, text)?;
        if table.len() > 1 {
            let message = "has more than one line; give each change its own --set".to_owned();
            return Err(document
                .locate(*start, "")
                .error(ErrorKind::Override(format!("`{}` {message}", path.join(".")))));
        }
        let Some((_, value)) = table.into_iter().next() else { continue };
        set(root, (path, 0), value)
            .map_err(|problem| document.locate(*start, "").error(ErrorKind::Override(problem)))?;
    }
    Ok(())
}

/// Sets the value at the end of a path whose first `depth` segments lead to the target. Creates missing tables.
///
/// # Errors
/// A text with cause and remedy, if the path does not exist.
fn set<'t>(
    target: &mut Spanned<DeValue<'t>>,
    (path, depth): (&[&str], usize),
    value: Spanned<DeValue<'t>>,
) -> Result<(), String> {
    let Some(&name) = path.get(depth) else {
        *target = value;
        return Ok(());
    };
    let key = || path[..depth].join(".");
    let deeper = (path, depth + 1);
    match target.get_mut() {
        DeValue::Table(table) => {
            let (key, mut entry) = match table.remove_entry(name) {
                Some(found) if depth + 1 < path.len() => found,
                _ => {
                    let key = Spanned::new(value.span(), Cow::Owned(name.to_owned()));
                    (key, Spanned::new(value.span(), DeValue::Table(DeTable::new())))
                }
            };
            let done = set(&mut entry, deeper, value);
            table.insert(key, entry);
            done
        }
        DeValue::Array(items) => {
            let n = items.len();
            let entries = if n == 1 { "entry" } else { "entries" };
            let number = name.parse::<usize>();
            let has_tables = items.first().is_some_and(|item| matches!(item.get_ref(), DeValue::Table(_)));
            if number.is_err() && has_tables {
                let is_named =
                    |item: &&DeValue<'_>| item.get("name").and_then(|of| of.get_ref().as_str()) == Some(name);
                let named = items.iter().position(|item| is_named(&item.get_ref()));
                let (key, rest) = (key(), path[depth + usize::from(named.is_some())..].join("."));
                let k = named.unwrap_or(0);
                return Err(format!("`{key}` is a list of {n} {entries}, counted from 0: write {key}.{k}.{rest}"));
            }
            let problem = || {
                format!("`{}` has {n} {entries}, counted from 0, and there is no entry `{name}`; check the key", key())
            };
            set(number.ok().and_then(|k| items.get_mut(k)).ok_or_else(problem)?, deeper, value)
        }
        _ => Err(format!("`{}` is a value, not a table, and has no entry `{name}`; check the key", key())),
    }
}

//! Changes of single values of a scenario: `--set KEY=VALUE`.

use std::borrow::Cow;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{ErrorKind, ScenarioError};
use super::table::{Document, parse};

pub(super) struct Change<'a> {
    /// Segments of the key.
    path: Vec<&'a str>,
    /// The assignment `_ = VALUE`, padded with blanks to the length of all earlier text, so that an offset identifies its
    /// argument.
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
        set(root, path, value).map_err(|(below, problem)| {
            let key = path[..path.len() - below].join(".");
            document.locate(*start, "").error(ErrorKind::Override(format!("`{key}` {problem}; check the key")))
        })?;
    }
    Ok(())
}

/// Sets the value at the end of a path and makes tables that are missing.
///
/// # Errors
/// The number of segments below the value that the path does not fit, and the cause.
fn set<'t>(
    target: &mut Spanned<DeValue<'t>>,
    path: &[&str],
    value: Spanned<DeValue<'t>>,
) -> Result<(), (usize, String)> {
    let Some((&name, rest)) = path.split_first() else {
        *target = value;
        return Ok(());
    };
    match target.get_mut() {
        DeValue::Table(table) => {
            let (key, mut entry) = match table.remove_entry(name) {
                Some(found) if !rest.is_empty() => found,
                _ => {
                    let key = Spanned::new(value.span(), Cow::Owned(name.to_owned()));
                    (key, Spanned::new(value.span(), DeValue::Table(DeTable::new())))
                }
            };
            let done = set(&mut entry, rest, value);
            table.insert(key, entry);
            done
        }
        DeValue::Array(items) => {
            let n = items.len();
            let item = name.parse::<usize>().ok().and_then(|k| items.get_mut(k));
            let entries = if n == 1 { "entry" } else { "entries" };
            let problem = || format!("has {n} {entries}, counted from 0, and there is no entry `{name}`");
            set(item.ok_or_else(|| (path.len(), problem()))?, rest, value)
        }
        _ => Err((path.len(), format!("is a value, not a table, and has no entry `{name}`"))),
    }
}

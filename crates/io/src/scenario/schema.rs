//! JSON Schema of scenarios, by which editors complete and check keys.

use serde_json::{Map, Value, json};

use super::file::Scenario;
use super::key::{Choice, Form, Key, Range};

/// Returns the schema of scenario files, draft 7, from the declarations of the keys.
///
/// It has types, ranges, words, required keys, defaults and the texts of the reference page. Alternative keys are
/// checked by the reader of scenarios only.
pub fn schema() -> Value {
    let mut schema = of_table(Scenario::KEYS, None);
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["title"] = json!("cutwater scenario");
    schema
}

fn of_table(keys: &[Key], word: Option<(&str, &Choice)>) -> Value {
    let mut properties: Map<String, Value> = Map::new();
    let mut needed: Vec<&str> = Vec::new();
    if let Some((tag, choice)) = word {
        properties.insert(tag.to_owned(), json!({ "const": choice.word, "description": choice.about.trim() }));
        needed.push(tag);
    }
    for key in keys {
        properties.insert(key.name.to_owned(), of_key(key));
    }
    needed.extend(keys.iter().filter(|key| !key.is_optional).map(|key| key.name));
    json!({ "type": "object", "properties": properties, "required": needed, "additionalProperties": false })
}

fn of_key(key: &Key) -> Value {
    let mut schema = of_form(&key.form, key.range);
    schema["description"] = json!(key.about.trim());
    let default = key.default.and_then(|default| toml::from_str::<toml::Table>(&format!("key = {default}")).ok());
    if let Some(default) = default.and_then(|table| serde_json::to_value(&table["key"]).ok()) {
        schema["default"] = default;
    }
    schema
}

fn of_form(form: &Form, range: Range) -> Value {
    match form {
        Form::Number => of_number("number", range),
        Form::Whole => match range {
            Range::Any => json!({ "type": "integer", "minimum": 0 }),
            _ => of_number("integer", range),
        },
        Form::Flag => json!({ "type": "boolean" }),
        Form::Text => json!({ "type": "string" }),
        Form::Field(_, table) => {
            json!({ "anyOf": [json!({ "type": ["number", "string"] }), of_form(table, Range::Any)] })
        }
        Form::Components(of) => json!({ "type": "array", "items": of_form(of, range), "minItems": 2, "maxItems": 3 }),
        Form::Spin => {
            let rate = of_number("number", range);
            json!({ "anyOf": [rate, json!({ "type": "array", "items": rate, "minItems": 3, "maxItems": 3 })] })
        }
        Form::List(of) => {
            let item = of_form(of, range);
            let list = json!({ "type": "array", "items": item });
            if matches!(of, Form::Table(_)) { json!({ "anyOf": [list, item] }) } else { list }
        }
        Form::Named(of) => json!({ "type": "object", "additionalProperties": of_form(of, range) }),
        Form::Table(keys) => of_table(keys, None),
        Form::Choice { tag, choices } => {
            let alone: Vec<&str> =
                choices.iter().filter(|choice| choice.stands_alone()).map(|choice| choice.word).collect();
            let words = (!alone.is_empty()).then(|| json!({ "type": "string", "enum": alone }));
            let tables =
                tag.iter().flat_map(|tag| choices.iter().map(|choice| of_table(choice.keys, Some((tag, choice)))));
            json!({ "anyOf": words.into_iter().chain(tables).collect::<Vec<Value>>() })
        }
        Form::OrTable(plain, table) => json!({ "anyOf": [of_form(plain, range), of_form(table, Range::Any)] }),
    }
}

fn of_number(kind: &str, range: Range) -> Value {
    let mut schema = json!({ "type": kind });
    match range {
        Range::Any => {}
        Range::Positive => schema["exclusiveMinimum"] = json!(0),
        Range::NonNegative => schema["minimum"] = json!(0),
        Range::Between(low, high) => {
            schema["minimum"] = json!(low);
            if high.is_finite() {
                schema["maximum"] = json!(high);
            }
        }
    }
    schema
}

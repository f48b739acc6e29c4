//! The JSON Schema of scenarios: scenarios of the repository are valid, and wrong ones are not.

use std::path::Path;

use io::scenario::schema;
use serde_json::{Value, json};

/// Checks a value against the parts of JSON Schema that occur here; an error is the path of the first defect.
fn check(schema: &Value, value: &Value, path: &str) -> Result<(), String> {
    let is_type = |kind: &str| match kind {
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => panic!("type {kind}"),
    };
    let refuse = |what: &str| Err(format!("{path}: {what}"));
    for (keyword, of) in schema.as_object().expect("a schema") {
        match keyword.as_str() {
            "type" => {
                let kinds: Vec<&str> = of
                    .as_array()
                    .map_or_else(|| vec![of], |all| all.iter().collect())
                    .into_iter()
                    .filter_map(Value::as_str)
                    .collect();
                if !kinds.iter().any(|kind| is_type(kind)) {
                    return refuse(&format!("not of type {kinds:?}"));
                }
            }
            "anyOf" => {
                let errors: Vec<String> =
                    of.as_array().expect("a list").iter().filter_map(|one| check(one, value, path).err()).collect();
                if errors.len() == of.as_array().expect("a list").len() {
                    return refuse(&errors.join(" or "));
                }
            }
            "enum" if !of.as_array().expect("a list").contains(value) => return refuse("not one of the words"),
            "const" if of != value => return refuse("another word"),
            "minimum" if value.as_f64() < of.as_f64() => return refuse("too small"),
            "exclusiveMinimum" if value.as_f64() <= of.as_f64() => return refuse("not above the minimum"),
            "maximum" if value.as_f64() > of.as_f64() => return refuse("too large"),
            "minItems" if (value.as_array().map_or(0, Vec::len) as u64) < of.as_u64().expect("a number") => {
                return refuse("too short");
            }
            "maxItems" if (value.as_array().map_or(0, Vec::len) as u64) > of.as_u64().expect("a number") => {
                return refuse("too long");
            }
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(of, item, &format!("{path}.{k}"))?;
                }
            }
            "required" => {
                let missing = of
                    .as_array()
                    .expect("a list")
                    .iter()
                    .filter_map(Value::as_str)
                    .find(|key| value.get(key).is_none());
                if let Some(key) = missing.filter(|_| value.is_object()) {
                    return refuse(&format!("`{key}` is missing"));
                }
            }
            "properties" | "additionalProperties" => {
                for (key, item) in value.as_object().into_iter().flatten() {
                    let declared = schema.get("properties").and_then(|declared| declared.get(key));
                    match (keyword.as_str(), declared) {
                        ("properties", Some(declared)) => check(declared, item, &format!("{path}.{key}"))?,
                        ("additionalProperties", None) if of == &json!(false) => {
                            return refuse(&format!("unknown key `{key}`"));
                        }
                        ("additionalProperties", None) => check(of, item, &format!("{path}.{key}"))?,
                        _ => {}
                    }
                }
            }
            "enum" | "const" | "minimum" | "exclusiveMinimum" | "maximum" | "minItems" | "maxItems" | "description"
            | "default" | "title" | "$schema" => {}
            other => panic!("keyword {other}"),
        }
    }
    Ok(())
}

fn verdict(text: &str) -> Result<(), String> {
    let table: toml::Table = toml::from_str(text).expect("TOML");
    check(&schema(), &serde_json::to_value(table).expect("JSON"), "")
}

#[test]
fn the_scenarios_of_the_repository_conform() {
    let mut n = 0;
    for folder in ["examples", "validation/cases"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder);
        for entry in std::fs::read_dir(folder).expect("a folder").filter_map(|entry| Some(entry.ok()?.path())) {
            if entry.extension().is_some_and(|extension| extension == "toml") {
                let text = std::fs::read_to_string(&entry).expect("a text");
                assert_eq!(verdict(&text), Ok(()), "{}", entry.display());
                n += 1;
            }
        }
    }
    assert!(n >= 7, "{n}");
}

#[test]
fn wrong_scenarios_do_not() {
    let text = crate::setting::CHANNEL;
    for (from, to, words) in [
        ("[time]", "[tiem]", "unknown key `tiem`"),
        ("dimension = 2", "dimension = 4", ".dimension: too large"),
        ("viscosity", "viscossity", "viscossity"),
        ("kind = \"graded-box\"", "kind = \"grated-box\"", "another word"),
        ("radius = 0.05", "radius = 0.0", "not above the minimum"),
        ("radius = 0.05", "radius = \"thin\"", "not of type"),
        ("centre = [0.2, 0.2]", "centre = [0.2]", "too short"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        let error = verdict(&changed).expect_err(to);
        assert!(error.contains(words), "{to}: {error}");
    }
}

#[test]
fn keys_have_their_sentences_and_defaults() {
    let schema = schema();
    let output = &schema["properties"]["output"]["properties"];
    assert_eq!(output["vtk_every"]["default"], json!(10));
    assert!(
        output["vtk_every"]["description"].as_str().is_some_and(|about| about.starts_with("Steps between two sets"))
    );
}

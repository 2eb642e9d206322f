//! What is generated from the tables: the reference page and the JSON schema.

use serde_json::{Value, json};
use sphcut_scenario::{reference, schema, taplo};
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Compares a committed file with its generated text; `UPDATE_GENERATED=1` writes it anew.
fn is_current(path: &str, text: &str) {
    let path = here(path);
    if std::env::var_os("UPDATE_GENERATED").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == text,
        "{} is not current: run `UPDATE_GENERATED=1 cargo test -p sphcut-scenario --test generated`",
        path.display()
    );
}

#[test]
fn the_reference_page_is_current() {
    is_current("../../docs/scenario.md", &reference());
}

#[test]
fn the_committed_schema_is_current() {
    let text = format!("{}\n", serde_json::to_string_pretty(&schema()).unwrap());
    is_current("../../scenarios/scenario.schema.json", &text);
    is_current("../../.taplo.toml", &taplo("scenarios/scenario.schema.json"));
}

#[test]
fn the_reference_has_every_key_of_every_law() {
    let page = reference();
    for entry in sphcut_physics::catalogue::entries() {
        for parameter in entry.parameters {
            assert!(page.contains(&format!("| `{}` |", parameter.key)), "{}", parameter.key);
        }
    }
    assert!(DeTable::parse(&taplo("schema.json")).is_ok());
}

/// TOML as JSON, for the schema.
fn as_json(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => json!(text),
        DeValue::Integer(number) => json!(number.to_string().parse::<i64>().unwrap_or(i64::MAX)),
        DeValue::Float(number) => json!(number.to_string().parse::<f64>().unwrap()),
        DeValue::Boolean(switch) => json!(switch),
        DeValue::Datetime(date) => json!(date.to_string()),
        DeValue::Array(list) => list.iter().map(|entry| as_json(entry.get_ref())).collect(),
        DeValue::Table(table) => table_as_json(table),
    }
}

fn table_as_json(table: &DeTable<'_>) -> Value {
    let entries =
        table.iter().map(|(key, value)| (key.get_ref().to_string(), as_json(value.get_ref())));
    Value::Object(entries.collect())
}

fn document(path: &Path) -> Option<Value> {
    let text = std::fs::read_to_string(path).unwrap();
    DeTable::parse(&text).ok().map(|table| table_as_json(table.get_ref()))
}

/// The keywords of draft-07 that the schema uses; any other is a mistake of this test or of the
/// schema. `pattern` is checked only as far as it asks for a leading number.
fn valid(schema: &Value, value: &Value) -> bool {
    schema.as_object().unwrap().iter().all(|(keyword, rule)| match keyword.as_str() {
        "$schema" | "title" | "description" | "default" | "examples" | "properties" => true,
        "type" => is_type(rule, value),
        "enum" => rule.as_array().unwrap().contains(value),
        "const" => rule == value,
        "required" => {
            rule.as_array().unwrap().iter().all(|key| value.get(key.as_str().unwrap()).is_some())
        }
        "additionalProperties" => properties(schema, rule, value),
        "items" => value.as_array().is_none_or(|list| list.iter().all(|entry| valid(rule, entry))),
        "minItems" => {
            value.as_array().is_none_or(|list| list.len() as u64 >= rule.as_u64().unwrap())
        }
        "maxItems" => {
            value.as_array().is_none_or(|list| list.len() as u64 <= rule.as_u64().unwrap())
        }
        "minimum" => value.as_f64().is_none_or(|number| number >= rule.as_f64().unwrap()),
        "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > rule.as_f64().unwrap()),
        "maximum" => value.as_f64().is_none_or(|number| number <= rule.as_f64().unwrap()),
        "pattern" => value.as_str().is_none_or(|text| {
            text.trim_start().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        }),
        "oneOf" => rule.as_array().unwrap().iter().filter(|one| valid(one, value)).count() == 1,
        "anyOf" => rule.as_array().unwrap().iter().any(|one| valid(one, value)),
        other => panic!("unexpected keyword {other}"),
    })
}

fn is_type(rule: &Value, value: &Value) -> bool {
    let names: Vec<&str> = match rule {
        Value::String(name) => vec![name],
        other => other.as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect(),
    };
    names.iter().any(|name| match *name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        other => panic!("unexpected type {other}"),
    })
}

fn properties(schema: &Value, additional: &Value, value: &Value) -> bool {
    let Some(object) = value.as_object() else { return true };
    object.iter().all(|(key, entry)| match schema.get("properties").and_then(|all| all.get(key)) {
        Some(property) => valid(property, entry),
        None if additional.is_object() => valid(additional, entry),
        None => additional.as_bool().unwrap(),
    })
}

fn toml_files(folder: &str) -> Vec<PathBuf> {
    std::fs::read_dir(here(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .filter(|path| path.file_name().is_some_and(|name| name != "beside.toml"))
        .filter(|path| !path.to_string_lossy().ends_with("_sweep.toml"))
        .collect()
}

#[test]
fn every_good_and_shipped_scenario_satisfies_the_schema() {
    let schema = schema();
    for folder in ["tests/good", "../../scenarios"] {
        for path in toml_files(folder) {
            assert!(valid(&schema, &document(&path).unwrap()), "{}", path.display());
        }
    }
}

/// What a schema can know: keys, types, words and the ranges of pure numbers.
#[test]
fn the_schema_refuses_what_it_can_judge() {
    let schema = schema();
    let judged = [
        "unknown_key",
        "unknown_section",
        "unknown_physics_key",
        "unknown_law_key",
        "unknown_override_key",
        "wrong_type_text",
        "wrong_type_switch",
        "wrong_type_section",
        "missing_unit",
        "no_number",
        "out_of_range_parameter",
        "out_of_range_count",
        "unknown_choice",
        "unknown_law",
        "unknown_boundary",
        "missing_law",
        "missing_law_parameter",
        "body_velocity_field",
        "body_single_brackets",
    ];
    for name in judged {
        let path = here("tests/bad").join(format!("{name}.toml"));
        assert!(!valid(&schema, &document(&path).unwrap()), "{name}");
    }
}

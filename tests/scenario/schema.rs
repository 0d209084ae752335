//! The JSON Schema of scenario files says what the reader and the checks do: names, units, defaults, ranges.

use boon::{Compiler, SchemaIndex, Schemas};
use gaitway::Scenario;
use gaitway::scenario::json_schema;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// A scenario with every key that can stand beside the others.
const EVERY_KEY: &str = include_str!("every_key.toml");
/// Those that cannot: where the area is text, there are no bounds.
const APART: [&str; 4] = ["walkable_wkt", "walkable_plane", "walkable_file", "walkable_node"];

/// A key: its names from the root, without indices.
type Key = Vec<String>;

/// Calls `see` with every key below a table of the schema, the schema of its value, and whether it must be given.
fn keys(table: &Value, above: &Key, see: &mut impl FnMut(&Key, &Map<String, Value>, bool)) {
    for (name, property) in table["properties"].as_object().unwrap() {
        let key: Key = above.iter().chain([name]).cloned().collect();
        let is_required = table["required"].as_array().is_some_and(|names| names.contains(&json!(name)));
        see(&key, property.as_object().unwrap(), is_required);
        for inner in [property, &property["items"]] {
            if inner.get("properties").is_some() {
                keys(inner, &key, see);
            }
        }
    }
}

fn every(mut see: impl FnMut(&Key, &Map<String, Value>, bool)) {
    keys(&json_schema(), &Key::new(), &mut see);
}

/// The schemas of what a value is made of, or is one of.
fn parts(schema: &Value) -> impl Iterator<Item = &Value> {
    let below = ["items", "additionalProperties"].into_iter().filter_map(|part| schema.get(part));
    let choices = ["anyOf", "oneOf", "prefixItems"]
        .into_iter()
        .filter_map(|part| schema.get(part)?.as_array())
        .flatten();
    below.chain(choices).filter(|part| part.get("properties").is_none())
}

/// Whether a value is a number, or made of numbers.
fn is_number(schema: &Value) -> bool {
    schema["type"] == "number" || schema["type"] == "integer" || parts(schema).any(is_number)
}

/// Least and greatest of the numbers of a key.
fn range(schema: &Value) -> Option<[f64; 2]> {
    let own = schema["minimum"].as_f64().zip(schema["maximum"].as_f64());
    own.map(Into::into).or_else(|| parts(schema).find_map(range))
}

/// All places of a document that a key names: the tables that hold it.
fn tables<'a>(root: &'a mut Value, key: &[String]) -> Vec<&'a mut Map<String, Value>> {
    let mut found: Vec<&mut Value> = vec![root];
    for name in &key[..key.len() - 1] {
        let below = found.into_iter().filter_map(|value| value.get_mut(name));
        found = below
            .flat_map(|value| match value {
                Value::Array(items) => items.iter_mut().collect(),
                other => vec![other],
            })
            .collect();
    }
    found.into_iter().filter_map(Value::as_object_mut).collect()
}

fn document() -> Value {
    serde_json::to_value(toml::from_str::<toml::Table>(EVERY_KEY).unwrap()).unwrap()
}

fn toml_of(document: &Value) -> String {
    toml::to_string(document).unwrap()
}

#[test]
fn every_key_has_a_description_a_unit_a_range_and_a_default() {
    let (mut count, mut wrong) = (0, Vec::new());
    every(|key, schema, is_required| {
        count += 1;
        let name = key.join(".");
        let about = schema.get("description").and_then(Value::as_str).unwrap_or_default();
        let value = Value::Object(schema.clone());
        let mut must = |holds: bool, what: &str| {
            if !holds {
                wrong.push(format!("{name}: {what}; it says: {about}"));
            }
        };
        must(about.len() > 2 && !about.contains("[`") && !about.contains('\n'), "no plain description");
        must(!about.contains("::"), "a word of the source");
        // of a seed every number is as good as another
        if is_number(&value) && name != "seed" {
            must(schema.get("unit").and_then(Value::as_str).is_some_and(|unit| !unit.is_empty()), "no unit");
            must(range(&value).is_some_and(|[least, greatest]| least < greatest), "no range");
        }
        let has_default = schema.contains_key("default");
        must(is_required || has_default || about.contains("eft out"), "what holds if it is left out?");
        must(!(is_required && has_default), "required with a default");
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count > 150, "{count} keys");
}

#[test]
fn a_key_that_is_left_out_has_its_default_and_one_that_is_required_is_missed() {
    let mut checked = 0;
    every(|key, schema, is_required| {
        let (mut given, mut left_out) = (document(), document());
        let name = key.last().unwrap();
        if APART.contains(&name.as_str()) {
            return;
        }
        let default = schema.get("default");
        let mut places = 0;
        for table in tables(&mut given, key).into_iter().filter(|table| table.contains_key(name)) {
            places += 1;
            default.map(|default| table.insert(name.clone(), default.clone()));
        }
        assert!(places > 0, "every_key.toml lacks {}", key.join("."));
        tables(&mut left_out, key).into_iter().for_each(|table| drop(table.remove(name)));
        let read = |document: &Value| toml::from_str::<Scenario>(&toml_of(document));
        match (default, read(&left_out)) {
            (Some(default), Ok(left_out)) => {
                assert!(read(&given).unwrap() == left_out, "{key:?}: not {default}");
            }
            (None, Err(error)) => {
                assert!(is_required && error.to_string().contains(name.as_str()), "{key:?}: {error}");
            }
            (None, Ok(_)) => assert!(!is_required, "{key:?} may be left out"),
            (Some(default), Err(error)) => panic!("{key:?} = {default}: {error}"),
        }
        checked += 1;
    });
    assert!(checked > 150, "{checked}");
}

#[test]
fn a_number_beyond_its_range_is_refused_by_the_schema_and_by_the_check() {
    Scenario::parse(EVERY_KEY, "every_key.toml").unwrap();
    let (schemas, schema) = compiled();
    assert!(schemas.validate(&document(), schema).is_ok());
    let mut checked = BTreeSet::new();
    every(|key, value, _| {
        let value = Value::Object(value.clone());
        let Some([least, greatest]) = range(&value).filter(|_| is_number(&value)) else { return };
        let name = key.last().unwrap();
        for beyond in [least - 1.0 - least.abs() * 0.01, greatest + 1.0 + greatest * 0.01] {
            let mut wrong = document();
            let mut table = tables(&mut wrong, key).into_iter().find(|table| table.contains_key(name));
            let is_whole = value.to_string().contains("integer");
            let beyond = if is_whole { json!(beyond.round() as i64) } else { json!(beyond) };
            put(table.as_mut().unwrap().get_mut(name).unwrap(), &beyond);
            let text = toml_of(&wrong);
            assert!(schemas.validate(&wrong, schema).is_err(), "the schema takes {key:?} = {beyond}");
            let error = Scenario::parse(&text, "wrong.toml").map(drop).unwrap_err().to_string();
            assert!(error.contains(name.as_str()), "{key:?} = {beyond}: {error}");
        }
        checked.insert(key.join("."));
    });
    assert!(checked.len() > 100, "{checked:?}");
}

/// Puts a number into the place of the first one in a value.
fn put(value: &mut Value, number: &Value) {
    match value {
        Value::Array(items) => put(items.iter_mut().find(|item| !item.is_string()).unwrap(), number),
        Value::Object(entries) => {
            // of a normal distribution an end: its mean has no limits of its own
            let name = if entries.contains_key("least") { "least" } else { entries.keys().next().unwrap() };
            let name = name.to_owned();
            put(entries.get_mut(&name).unwrap(), number);
        }
        other => *other = number.clone(),
    }
}

fn compiled() -> (Schemas, SchemaIndex) {
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("scenario.schema.json", json_schema()).unwrap();
    let index = compiler.compile("scenario.schema.json", &mut schemas).unwrap();
    (schemas, index)
}

#[test]
fn every_scenario_of_the_project_is_right_by_the_schema_and_wrong_ones_are_not() {
    let (schemas, schema) = compiled();
    let mut files = 0;
    for folder in ["assets/scenes", "assets/starters"] {
        for file in std::fs::read_dir(folder).unwrap() {
            let path = file.unwrap().path();
            let text = std::fs::read_to_string(&path).unwrap();
            let document = serde_json::to_value(toml::from_str::<toml::Table>(&text).unwrap()).unwrap();
            let found = schemas.validate(&document, schema);
            assert!(found.is_ok(), "{}: {}", path.display(), found.unwrap_err());
            Scenario::load(&path).unwrap();
            files += 1;
        }
    }
    assert!(files >= 9, "{files}");
    for (key, wrong) in [
        ("navigation", json!({ "patiense": 1.0 })),
        ("condition", json!("eva-x")),
        ("seed", json!(1.5)),
        ("seed", json!(-1)),
        ("bounds", json!([[0, 0, 0]])),
        ("population", json!({ "emotions": { "glad": 1 } })),
        ("routes", json!([{ "waypoints": [[0, 0], [1, 1]] }])),
    ] {
        let mut document = document();
        document[key] = wrong;
        assert!(schemas.validate(&document, schema).is_err(), "the schema takes {key}");
    }
}

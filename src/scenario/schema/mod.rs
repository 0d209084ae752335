//! The JSON Schema of scenario files, for editors and other programs, and the page of all keys that is made from it.
//!
//! Names, descriptions and choices come from the types that read the file, units and ranges from the table that
//! [`Scenario::validate`] checks by.

mod page;

#[cfg(feature = "cli")]
pub(crate) use page::reference;

use super::file::{Limits, Scenario, limits};
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

/// The JSON Schema (draft 2020-12) of a scenario file. Every key has a `description`; a number has its `unit`, a `minimum` and a
/// `maximum`; what may be left out has its `default`, or says what then holds.
///
/// Nothing in it is a reference, so that a key's place in the file is its place in the schema.
pub fn json_schema() -> Value {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<Scenario>().to_value();
    if let Some(root) = schema.as_object_mut() {
        root.insert("title".to_owned(), json!("gaitway scenario"));
    }
    finish(&mut schema, "", None);
    schema
}

/// Puts limits and defaults in, and takes out what TOML does not have. `around` are the limits of the key that an object stands at.
fn finish(schema: &mut Value, key: &str, around: Option<&Limits>) {
    let Some(schema) = schema.as_object_mut() else { return };
    schema.remove("format");
    ["minimum", "maximum"].iter().for_each(|end| schema.get_mut(*end).map_or((), decimals));
    if let Some(Value::String(text)) = schema.get_mut("description") {
        *text = plain(text);
    }
    let own = limits(key);
    if let Some(own) = own.filter(|_| schema.contains_key("description")) {
        schema.insert("unit".to_owned(), json!(own.unit));
    }
    if let Some(limits) = own.or(around)
        && schema.get("type").is_some_and(|kind| kind == "number" || kind == "integer")
    {
        bound(schema, limits.least, limits.greatest);
    }
    for part in ["items", "additionalProperties"] {
        if let Some(inner) = schema.get_mut(part) {
            finish(inner, key, own.or(around));
        }
    }
    for part in ["anyOf", "oneOf", "prefixItems"] {
        let choices = schema.get_mut(part).and_then(Value::as_array_mut);
        choices.into_iter().flatten().for_each(|choice| finish(choice, key, own.or(around)));
    }
    let required: Vec<Value> = schema.get("required").and_then(Value::as_array).cloned().unwrap_or_default();
    let properties = schema.get_mut("properties").and_then(Value::as_object_mut);
    for (name, property) in properties.into_iter().flatten() {
        let below = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
        let is_optional = property.as_object_mut().is_some_and(drop_null);
        match own.or(around) {
            // a normal distribution: its key's limits are those of its ends
            Some(limits) => spread(property, name, limits),
            None => finish(property, &below, None),
        }
        if !is_optional && !required.iter().any(|required| required == name) {
            default(property);
        }
    }
}

/// Part of a normal distribution, whose ends have these limits.
fn spread(property: &mut Value, name: &str, limits: &Limits) {
    finish(property, "", None);
    let Some(property) = property.as_object_mut() else { return };
    property.insert("unit".to_owned(), json!(limits.unit));
    match name {
        "deviation" => bound(property, 0.0, limits.greatest - limits.least),
        "mean" => {}
        _ => bound(property, limits.least, limits.greatest),
    }
}

fn bound(schema: &mut Map<String, Value>, least: f32, greatest: f32) {
    schema.insert("minimum".to_owned(), number(least));
    schema.insert("maximum".to_owned(), number(greatest));
}

/// The number as it is written in decimals, not the nearest f64 of the f32.
fn number(value: f32) -> Value {
    let text = value.to_string();
    text.parse::<i64>().map_or_else(|_| json!(text.parse::<f64>().unwrap_or_default()), |whole| json!(whole))
}

/// TOML has no null: what may be left out is not in `required`. Returns whether there was one.
fn drop_null(schema: &mut Map<String, Value>) -> bool {
    let is_null = |value: &Value| {
        value.is_null() || value == "null" || value.get("type").is_some_and(|kind| kind == "null")
    };
    let mut is_optional = false;
    for part in ["type", "enum", "anyOf"] {
        if let Some(Value::Array(choices)) = schema.get_mut(part) {
            is_optional |= choices.iter().any(is_null);
            choices.retain(|choice| !is_null(choice));
        }
    }
    schema.retain(|name, value| name != "default" || !value.is_null());
    if let Some([kind]) = schema.get("type").and_then(Value::as_array).map(Vec::as_slice) {
        schema.insert("type".to_owned(), kind.clone());
    }
    if let Some([Value::Object(only)]) = schema.get("anyOf").and_then(Value::as_array).map(Vec::as_slice) {
        let only = only.clone();
        schema.remove("anyOf");
        for (name, value) in only {
            schema.entry(name).or_insert(value);
        }
    }
    is_optional
}

/// A default that the types do not give, since it is not written, is the empty value.
fn default(property: &mut Value) {
    let Some(property) = property.as_object_mut() else { return };
    if let Some(default) = property.get_mut("default") {
        decimals(default);
        return;
    }
    let empty = match property.get("type").and_then(Value::as_str) {
        Some("array") => json!([]),
        Some("boolean") => json!(false),
        Some("integer" | "number") => json!(0),
        Some("object") => json!({}),
        Some("string") => json!(""),
        _ => return,
    };
    property.insert("default".to_owned(), empty);
}

/// Rewrites the f32 in a default as they are written in decimals.
#[allow(clippy::cast_possible_truncation, reason = "it was an f32")]
fn decimals(value: &mut Value) {
    match value {
        Value::Number(found) if found.is_f64() => {
            if let Some(exact) = found.as_f64() {
                *value = number(exact as f32);
            }
        }
        Value::Array(items) => items.iter_mut().for_each(decimals),
        Value::Object(entries) => entries.values_mut().for_each(decimals),
        _ => {}
    }
}

/// A comment of the source without line breaks and links.
fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("[`") {
        plain.push_str(before);
        let Some((name, after)) = after.split_once("`]") else { break };
        plain.push_str(&format!("`{}`", name.rsplit("::").next().unwrap_or(name)));
        rest = match after.strip_prefix('(').and_then(|link| link.split_once(')')) {
            Some((_, after)) => after,
            None => after,
        };
    }
    plain.push_str(rest);
    plain.replace('\n', " ")
}

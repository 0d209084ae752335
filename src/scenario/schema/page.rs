//! The page of all keys, in Markdown: one section a table of the file.

use super::json_schema;
use serde_json::{Map, Value};
use std::fmt::Write as _;

const BEGINNING: &str = "\
# The scenario file

Every key of a scenario file: what it may be, its default and its range. `gaitway scene schema --format markdown` writes this page.
`gaitway scene schema` writes the same as JSON Schema, which editors complete and explain keys by.
`gaitway scene new` writes a file to begin with, and `gaitway scene check` says what is wrong with one.

A scenario is a TOML file. Lengths are metres, times seconds, angles degrees about +y. Points are `[x, z]` on the ground: x to the
right, z down on a plan. The ends of a range belong to it. A key without a default says what holds if it is
left out, and a bold key must be given. Ratios, shares and indices have the unit 1.
";

/// The page of all keys.
pub(crate) fn reference() -> String {
    let schema = json_schema();
    let mut page = BEGINNING.to_owned();
    if let Some(root) = schema.as_object() {
        section(&mut page, root, "", false);
    }
    page
}

/// One table of the file and all below it.
fn section(page: &mut String, table: &Map<String, Value>, key: &str, is_repeated: bool) {
    let Some(properties) = table.get("properties").and_then(Value::as_object) else { return };
    let heading = match (key, is_repeated) {
        ("", _) => "At the top".to_owned(),
        (key, true) => format!("`[[{key}]]`"),
        (key, false) => format!("`[{key}]`"),
    };
    let _ = write!(page, "\n## {heading}\n\n");
    let about = text(table, "description");
    if !key.is_empty() && !about.is_empty() {
        let _ = write!(page, "{about}\n\n");
    }
    page.push_str(
        "| key | what | unit | default | range | meaning |\n| --- | --- | --- | --- | --- | --- |\n",
    );
    let required = table.get("required").and_then(Value::as_array);
    let is_required = |name: &String| required.is_some_and(|names| names.iter().any(|one| one == name));
    for (name, property) in properties {
        let Some(property) = property.as_object() else { continue };
        row(page, name, property, is_required(name));
    }
    for (name, property) in properties {
        let below = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
        let item = property.get("items").and_then(Value::as_object);
        let is_table = |table: &&Map<String, Value>| table.contains_key("properties");
        if let Some(item) = item.filter(is_table) {
            section(page, item, &below, true);
        } else if let Some(inner) = property.as_object().filter(is_table) {
            section(page, inner, &below, false);
        }
    }
}

fn row(page: &mut String, name: &str, property: &Map<String, Value>, is_required: bool) {
    let name = if is_required { format!("**`{name}`**") } else { format!("`{name}`") };
    let unit = text(property, "unit");
    let unit = if unit == "1" { "" } else { unit };
    let default = match property.get("default") {
        // a table's keys have their own
        Some(Value::Object(entries)) if entries.is_empty() || entries.len() > 4 => String::new(),
        Some(default) => format!("`{}`", written(default)),
        None => String::new(),
    };
    let range = range(property).unwrap_or_default();
    let mut meaning = text(property, "description").to_owned();
    for choice in choices(property) {
        let about = text(choice, "description");
        if !about.is_empty() && choice.contains_key("const") {
            let _ = write!(meaning, " {}: {about}", form(choice));
        }
    }
    let cells = [name, form(property), unit.to_owned(), default, range, meaning];
    let _ = writeln!(page, "| {} |", cells.map(|cell| cell.replace('|', "\\|")).join(" | "));
}

fn text<'a>(schema: &'a Map<String, Value>, name: &str) -> &'a str {
    schema.get(name).and_then(Value::as_str).unwrap_or_default()
}

/// What a key may be one of.
fn choices(schema: &Map<String, Value>) -> impl Iterator<Item = &Map<String, Value>> {
    let lists = ["oneOf", "anyOf"].into_iter().filter_map(|part| schema.get(part).and_then(Value::as_array));
    lists.flatten().filter_map(Value::as_object)
}

/// What a value looks like.
fn form(schema: &Map<String, Value>) -> String {
    if let Some(only) = schema.get("const") {
        return format!("`{only}`");
    }
    if let Some(names) = schema.get("enum").and_then(Value::as_array) {
        return names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    }
    let joined = |with| choices(schema).map(form).collect::<Vec<_>>().join(with);
    match choices(schema).next() {
        Some(first) if first.contains_key("const") => return joined(", "),
        Some(_) => return joined(" or "),
        None => {}
    }
    let below = |part: &str| schema.get(part).and_then(Value::as_object);
    match text(schema, "type") {
        "integer" => "whole number".to_owned(),
        "boolean" => "`true`, `false`".to_owned(),
        "string" => "text".to_owned(),
        "array" => {
            let each = schema
                .get("prefixItems")
                .and_then(Value::as_array)
                .and_then(|items| items.first()?.as_object());
            let item = below("items").or(each).map(form).unwrap_or_default();
            let [least, most] = ["minItems", "maxItems"].map(|part| schema.get(part).and_then(Value::as_u64));
            match (least, most) {
                (Some(least), Some(most)) if least == most => {
                    let items = (0..most).map(|_| item.as_str());
                    format!("[{}]", items.collect::<Vec<_>>().join(", "))
                }
                _ => format!("list of {item}"),
            }
        }
        "object" => match (below("properties"), below("additionalProperties")) {
            (None, Some(value)) => format!("table of names and {}", form(value)),
            (Some(keys), _) if keys.len() < 5 => {
                format!("{{ {} }}", keys.keys().cloned().collect::<Vec<_>>().join(", "))
            }
            _ => "table".to_owned(),
        },
        other => other.to_owned(),
    }
}

/// Ranges of the numbers of a key: one, or that of each.
fn range(schema: &Map<String, Value>) -> Option<String> {
    if let (Some(least), Some(greatest)) = (schema.get("minimum"), schema.get("maximum")) {
        return Some(format!("{least} to {greatest}"));
    }
    if let Some(items) = schema.get("prefixItems").and_then(Value::as_array) {
        return Some(
            items.iter().filter_map(Value::as_object).filter_map(range).collect::<Vec<_>>().join(", "),
        );
    }
    let inner =
        ["items", "additionalProperties"].into_iter().filter_map(|part| schema.get(part)?.as_object());
    let own = |inner: &Map<String, Value>| !inner.contains_key("properties");
    inner.chain(choices(schema)).filter(|inner| own(inner)).find_map(range)
}

/// A value as TOML has it.
fn written(value: &Value) -> String {
    let joined = |parts: Vec<String>| parts.join(", ");
    match value {
        Value::Array(items) => format!("[{}]", joined(items.iter().map(written).collect())),
        Value::Object(entries) => {
            let entries = entries.iter().map(|(name, value)| format!("{name} = {}", written(value)));
            format!("{{ {} }}", joined(entries.collect()))
        }
        other => other.to_string(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn the_page_in_the_repository_is_that_of_the_schema() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/scenario.md");
        if std::env::var_os("GAITWAY_UPDATE_ASSETS").is_some() {
            std::fs::write(path, reference()).unwrap();
        }
        let hint = "GAITWAY_UPDATE_ASSETS=1 cargo test --lib the_page_in_the_repository";
        assert_eq!(std::fs::read_to_string(path).unwrap(), reference(), "docs/scenario.md is old: {hint}");
    }
}

//! The built-in scenes in a list.

use super::output::{say_json, table};
use crate::Error;
use crate::scenario::Scenario;
use serde::Serialize;

#[derive(Debug, Serialize)]
struct Listing {
    scenes: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    name: String,
    /// As many as in the paper.
    agents: u32,
    what: &'static str,
}

/// Prints them.
pub(super) fn list(is_json: bool) -> Result<bool, Error> {
    let row = |name| {
        let scenario = Scenario::builtin(name)?;
        Ok::<_, Error>(Row { name: scenario.name, agents: scenario.population.agents, what: what(name) })
    };
    let scenes = Scenario::builtin_names().into_iter().map(row).collect::<Result<Vec<_>, _>>()?;
    if is_json {
        say_json(&Listing { scenes })?;
        return Ok(true);
    }
    let words = |row: &Row| vec![row.name.clone(), row.agents.to_string(), row.what.to_owned()];
    table(&["scene", "agents", "what"], &scenes.iter().map(words).collect::<Vec<_>>());
    Ok(true)
}

fn what(name: &str) -> &'static str {
    match name {
        "crossing" => "a scramble crossing in a city",
        "garden" => "a formal garden about a fountain",
        "parking" => "a car park in front of stores",
        "scifi" => "a settlement of residential pods",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_described() {
        for name in Scenario::builtin_names() {
            assert!(!what(name).is_empty(), "{name}");
        }
    }
}

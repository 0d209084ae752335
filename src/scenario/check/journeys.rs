//! Whether stages, journeys and sources can be walked.

use super::ranges::{count, outline, point, within, within_from};
use crate::scenario::error::Error;
use crate::scenario::file::{
    Journey, Layout, MOST_WAYS, Point, SPACING, Scenario, Source, Stage, StageKind, journey_names,
    route_names, stage_names,
};
use crate::scenario::polygon;
use crate::spelling::nearest;
use glam::Vec2;
use std::collections::BTreeMap;

/// Most stages, journeys and sources of a scenario, each.
const MOST: usize = 1000;
/// Most stages of one journey.
const MOST_LEGS: usize = 64;

/// Checks stages, journeys and sources.
pub(super) fn check(scenario: &Scenario) -> Result<(), Error> {
    few("stages", scenario.stages.len())?;
    few("journeys", scenario.journeys.len())?;
    few("sources", scenario.sources.len())?;
    let names = stage_names(&scenario.stages);
    for (index, item) in scenario.stages.iter().enumerate() {
        unique(&format!("stages[{index}].name"), &item.name, names.get(item.name.as_str()) == Some(&index))?;
        stage(&format!("stages[{index}]"), item)?;
    }
    let journeys = journey_names(&scenario.journeys);
    for (index, item) in scenario.journeys.iter().enumerate() {
        let is_unique = journeys.get(item.name.as_str()) == Some(&index);
        unique(&format!("journeys[{index}].name"), &item.name, is_unique)?;
        journey(&format!("journeys[{index}]"), item, &names, &scenario.stages)?;
    }
    for (index, spawn) in scenario.spawns.iter().enumerate() {
        known(&format!("spawns[{index}].journeys"), &spawn.journeys, &journeys, "journey")?;
        if !spawn.journeys.is_empty() && !spawn.routes.is_empty() {
            let hint = "make two spawn regions of it";
            let key = format!("spawns[{index}].routes");
            return Err(Error::value(key, "[..]", "left out where journeys are given", hint));
        }
    }
    for (index, item) in scenario.sources.iter().enumerate() {
        source(&format!("sources[{index}]"), item, scenario)?;
        known(&format!("sources[{index}].journeys"), &item.journeys, &journeys, "journey")?;
        for (other, before) in scenario.sources[..index].iter().enumerate() {
            if overlap(&item.polygon, &before.polygon) {
                let found = format!("overlaps sources[{other}].polygon");
                let hint = "two people could appear in one place: move one of them";
                return Err(Error::value(format!("sources[{index}].polygon"), found, "apart from it", hint));
            }
        }
    }
    present(scenario)
}

fn few(key: &str, count: usize) -> Result<(), Error> {
    if count <= MOST {
        return Ok(());
    }
    Err(Error::value(key, format!("{count} tables"), format!("at most {MOST}"), "leave some out"))
}

fn unique(key: &str, name: &str, is_unique: bool) -> Result<(), Error> {
    if is_unique && !name.is_empty() && name.len() <= 64 {
        return Ok(());
    }
    let allowed = "1 to 64 bytes that no other has as its name";
    Err(Error::value(key, format!("{name:?}"), allowed, "rename it"))
}

fn known(key: &str, wanted: &[String], names: &BTreeMap<&str, usize>, what: &str) -> Result<(), Error> {
    match wanted.iter().position(|name| !names.contains_key(name.as_str())) {
        None => Ok(()),
        Some(index) => Err(unknown(format!("{key}[{index}]"), &wanted[index], names, what)),
    }
}

fn unknown(key: String, name: &str, names: &BTreeMap<&str, usize>, what: &str) -> Error {
    let all: Vec<&str> = names.keys().copied().collect();
    let hint = match nearest(name, &all) {
        Some(near) => format!("did you mean {near:?}?"),
        None if all.is_empty() => format!("there is none: add a [[{what}s]] table"),
        None => format!("there are {}", all[..all.len().min(12)].join(", ")),
    };
    Error::value(key, format!("{name:?}"), format!("the name of a {what}"), hint)
}

/// A key that this kind of stage does not read.
fn idle(key: String, is_given: bool, hint: &str) -> Result<(), Error> {
    if is_given { Err(Error::value(key, "..", "left out for this kind of stage", hint)) } else { Ok(()) }
}

fn stage(key: &str, stage: &Stage) -> Result<(), Error> {
    let of = |field: &str| format!("{key}.{field}");
    let queues = stage.kind == StageKind::Queue;
    let is_region = !queues && stage.kind != StageKind::Waypoint;
    let waits = stage.kind == StageKind::Waiting;
    point(&of("position"), stage.position)?;
    idle(of("size"), !is_region && stage.size.is_some(), "a waypoint has a radius, a queue places")?;
    idle(of("radius"), is_region && stage.radius.is_some(), "a region has a size = [width, depth]")?;
    idle(of("places"), !queues && stage.places.is_some(), "kind = \"queue\" has places")?;
    idle(of("spacing"), !queues && stage.spacing.is_some(), "kind = \"queue\" has places")?;
    idle(of("service_time"), !queues && stage.service_time.is_some(), "kind = \"queue\" serves")?;
    if queues {
        let Some(service) = stage.service_time else {
            let hint = "seconds for which the first is served";
            return Err(Error::value(of("service_time"), "none", "given for a queue", hint));
        };
        within(&of("service_time"), service)?;
        count(&of("places"), stage.places.unwrap_or(0))?;
        within(&of("spacing"), stage.spacing.unwrap_or(SPACING))?;
    }
    idle(of("wait"), !waits && stage.wait != 0.0, "kind = \"waiting\" waits")?;
    idle(of("until"), !waits && stage.until != 0.0, "kind = \"waiting\" waits")?;
    if let Some(radius) = stage.radius {
        within(&of("radius"), radius)?;
    }
    match stage.size {
        None if is_region => {
            let hint = "metres along x and z, before heading_deg turns it";
            return Err(Error::value(of("size"), "none", "[width, depth]", hint));
        }
        None => {}
        Some(size) => {
            for (i, length) in size.into_iter().enumerate() {
                within(&format!("{key}.size[{i}]"), length)?;
            }
        }
    }
    within(&of("heading_deg"), stage.heading_deg)?;
    within(&of("wait"), stage.wait)?;
    within(&of("until"), stage.until)?;
    if waits && stage.wait == 0.0 && stage.until == 0.0 {
        let hint = "or set until = SECONDS, or kind = \"goal\"";
        return Err(Error::value(of("wait"), 0, "above 0 for a waiting area", hint));
    }
    Ok(())
}

fn journey(
    key: &str,
    journey: &Journey,
    names: &BTreeMap<&str, usize>,
    stages: &[Stage],
) -> Result<(), Error> {
    let legs = journey.stages.len();
    let least = if journey.repeat { 2 } else { 1 };
    if !(least..=MOST_LEGS).contains(&legs) {
        let allowed = format!("{least} to {MOST_LEGS} stages");
        return Err(Error::value(
            format!("{key}.stages"),
            format!("{legs} stages"),
            allowed,
            "list them in order",
        ));
    }
    let mut ways = 1_usize;
    for (index, leg) in journey.stages.iter().enumerate() {
        let key = format!("{key}.stages[{index}]");
        let choices = leg.choices();
        for &(name, share) in &choices {
            let Some(&stage) = names.get(name) else { return Err(unknown(key, name, names, "stage")) };
            let is_last = index + 1 == legs && !journey.repeat;
            if stages[stage].kind == StageKind::Exit && !is_last {
                let found = format!("{name:?}");
                let hint = "who has left goes nowhere: put it last, and leave repeat out";
                return Err(Error::value(key, found, "no exit before the last stage", hint));
            }
            if stages[stage].kind == StageKind::Queue && is_last {
                let hint = "put an exit or a goal behind it";
                return Err(Error::value(key, format!("{name:?}"), "no queue as the last stage", hint));
            }
            within(&format!("{key}.{name}"), share)?;
        }
        if choices.iter().all(|(_, share)| *share <= 0.0) {
            return Err(Error::value(key, "all 0", "a sum of shares above 0", "give one of them a share"));
        }
        ways = ways.saturating_mul(choices.iter().filter(|(_, share)| *share > 0.0).count());
    }
    if ways > MOST_WAYS {
        let found = format!("{ways} ways");
        let allowed = format!("at most {MOST_WAYS} ways through the shares of its stages");
        return Err(Error::value(format!("{key}.stages"), found, allowed, "make several journeys of it"));
    }
    within(&format!("{key}.weight"), journey.weight)
}

fn source(key: &str, source: &Source, scenario: &Scenario) -> Result<(), Error> {
    let of = |field: &str| format!("{key}.{field}");
    outline(&of("polygon"), &source.polygon, "the corners of the region")?;
    match (source.rate, source.schedule.is_empty()) {
        (Some(rate), true) => within(&of("rate"), rate)?,
        (None, false) => {}
        (Some(_), false) => {
            let hint = "make two sources of it, or put everything into the schedule";
            return Err(Error::value(of("rate"), "..", "left out where a schedule is given", hint));
        }
        (None, true) => {
            let hint = "agents a second; or schedule = [{ time = 0, count = 10 }]";
            return Err(Error::value(of("rate"), "none", "given where there is no schedule", hint));
        }
    }
    within(&of("begin"), source.begin)?;
    if let Some(end) = source.end {
        within_from(&of("end"), end, source.begin)?;
    }
    if !source.schedule.is_empty() && (source.end.is_some() || source.begin != 0.0) {
        let name = if source.end.is_some() { "end" } else { "begin" };
        let hint = "the schedule says when";
        return Err(Error::value(of(name), "..", "left out where a schedule is given", hint));
    }
    let mut last = 0.0;
    for (index, arrivals) in source.schedule.iter().enumerate() {
        let of = |field: &str| format!("{key}.schedule[{index}].{field}");
        within_from(&of("time"), arrivals.time, last)?;
        count(&of("count"), arrivals.count)?;
        last = arrivals.time;
    }
    if let Some(share) = source.share {
        within(&of("share"), share)?;
    }
    if !source.journeys.is_empty() && !source.routes.is_empty() {
        let hint = "make two sources of it";
        return Err(Error::value(of("routes"), "[..]", "left out where journeys are given", hint));
    }
    if scenario.layout == Layout::Custom {
        let routes = route_names(&scenario.routes);
        known(&of("routes"), &source.routes, &routes, "route")?;
    }
    Ok(())
}

fn overlap(a: &[Point], b: &[Point]) -> bool {
    let vectors = |points: &[Point]| points.iter().copied().map(Vec2::from).collect::<Vec<_>>();
    let (a, b) = (vectors(a), vectors(b));
    let meets = |(p, q)| polygon::edges(&b).any(|(r, s)| polygon::segments_meet(p, q, r, s));
    polygon::edges(&a).any(meets)
        || a.first().is_some_and(|corner| polygon::contains(&b, *corner))
        || b.first().is_some_and(|corner| polygon::contains(&a, *corner))
}

/// Checks the share of the agents that start in the scene, and that there is a place for them.
fn present(scenario: &Scenario) -> Result<(), Error> {
    let has_sources = !scenario.sources.is_empty();
    let key = "population.present";
    match scenario.population.present {
        Some(share) => within(key, share)?,
        None if has_sources && !scenario.spawns.is_empty() => {
            let hint =
                "the share of the agents that starts in the spawn regions; the rest comes from the sources";
            return Err(Error::value(key, "none", "given where there are both spawns and sources", hint));
        }
        None => {}
    }
    if !has_sources && scenario.population.present.is_some_and(|share| share < 1.0) {
        let found = scenario.population.present.unwrap_or(1.0);
        return Err(Error::value(key, found, "1 where there is no source", "add a [[sources]] table"));
    }
    if !scenario.journeys.is_empty() && scenario.spawns.is_empty() && !has_sources {
        let hint = "add a [[spawns]] or [[sources]] table";
        return Err(Error::value("journeys", "[..]", "begun in a spawn region or source", hint));
    }
    let starts = scenario.population.present.unwrap_or(if has_sources { 0.0 } else { 1.0 }) > 0.0;
    let is_custom = scenario.layout == Layout::Custom;
    let has_agents = scenario.population.agents > 0;
    if has_agents && is_custom && starts && scenario.spawns.is_empty() && scenario.routes.is_empty() {
        let hint = "add a [[spawns]] table: where those stand who are there from the start";
        return Err(Error::value("spawns", "[]", "one region or more where there is no route", hint));
    }
    Ok(())
}

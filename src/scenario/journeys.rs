//! Journeys in scenario files: stages with names, journeys through them, sources of people; and their allowed ranges.

use super::crowd::{Stop, StopKind};
use super::error::Error;
use super::load::nearest;
use super::polygon;
use super::schema::{Point, Scenario};
use super::validate::{outline, point, within};
use glam::Vec2;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::collections::BTreeMap;

/// Most stages, journeys and sources of a scenario, each.
const MOST: usize = 1000;
/// Most stages of one journey.
const MOST_LEGS: usize = 64;
/// Most ways through one journey.
const MOST_WAYS: usize = 256;
/// A day, s.
const DAY: f32 = 86_400.0;
/// Radius of a waypoint that says none, m.
const WAYPOINT_RADIUS: f32 = 1.0;
/// Distance between two places of a queue that says none, m.
const SPACING: f32 = 0.8;
/// Most places of a queue.
const MOST_PLACES: u32 = 1000;

/// What a stage is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StageKind {
    /// A point to pass within `radius`.
    Waypoint,
    /// A region: everyone walks to a place of their own in it; passed on entering it. As the last stage, people stay there.
    Goal,
    /// A region in which everyone goes to a place of their own and stays for `wait` seconds and at least to the time `until`.
    Waiting,
    /// A line of places: people stand in it one behind the other in the order in which they came to its end; the first is served for
    /// `service_time`, then goes on to the next stage, and the others move up. Who finds it full waits behind it.
    Queue,
    /// A region in which people leave the scene; only as the last stage.
    Exit,
}

/// A place on a journey.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Unique name.
    pub name: String,
    /// What it is.
    pub kind: StageKind,
    /// The waypoint, the middle of the region, or the first place of the queue, m.
    pub position: Point,
    /// Width and depth of the region (along x and z before it is turned), m; not for waypoints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Point>,
    /// Turn of the region about +y, degrees; of a queue: where its end is, 0 towards +z, 90 towards +x.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub heading_deg: f32,
    /// Distance at which a waypoint counts as reached, or from the end of a queue at which people join it, m; left out: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f32>,
    /// Least time in a waiting area, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub wait: f32,
    /// Time of the simulation before which nobody leaves a waiting area, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub until: f32,
    /// Places in a queue.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub places: Option<u32>,
    /// Distance from one place of a queue to the next, m; left out: 0.8.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spacing: Option<f32>,
    /// How long the first in a queue is served once it stands at its place, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub service_time: Option<f32>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(value: &f32) -> bool {
    *value == 0.0
}

/// One step of a journey: a stage, or one of several by shares.
#[derive(Debug, Clone, PartialEq)]
pub enum Leg {
    /// Everyone goes to this stage.
    All(String),
    /// Everyone goes to one of these stages, drawn at the start by shares (any scale).
    OneOf(BTreeMap<String, f32>),
}

impl Leg {
    /// The stages it may lead to, with their shares.
    fn choices(&self) -> Vec<(&str, f32)> {
        match self {
            Self::All(name) => vec![(name, 1.0)],
            Self::OneOf(shares) => shares.iter().map(|(name, share)| (name.as_str(), *share)).collect(),
        }
    }
}

impl Serialize for Leg {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::All(name) => serializer.serialize_str(name),
            Self::OneOf(shares) => {
                let mut map = serializer.serialize_map(Some(shares.len()))?;
                for (name, share) in shares {
                    map.serialize_entry(name, share)?;
                }
                map.end()
            }
        }
    }
}

impl<'de> Deserialize<'de> for Leg {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Choice;

        impl<'de> de::Visitor<'de> for Choice {
            type Value = Leg;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(
                    "the name of a stage, or a table of names and shares such as { left = 2, right = 1 }",
                )
            }
            fn visit_str<E>(self, name: &str) -> Result<Leg, E> {
                Ok(Leg::All(name.to_owned()))
            }
            fn visit_map<A: de::MapAccess<'de>>(self, mut map: A) -> Result<Leg, A::Error> {
                let mut shares = BTreeMap::new();
                while let Some((name, share)) = map.next_entry()? {
                    shares.insert(name, share);
                }
                Ok(Leg::OneOf(shares))
            }
        }
        deserializer.deserialize_any(Choice)
    }
}

/// A way through stages.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Journey {
    /// Unique name.
    pub name: String,
    /// The stages in order; a table of names and shares where people part ways.
    pub stages: Vec<Leg>,
    /// From the last stage on to the first again.
    #[serde(default, skip_serializing_if = "is_false")]
    pub repeat: bool,
    /// Share of the agents, relative to the other journeys that start at the same spawn region or source.
    #[serde(default = "one")]
    pub weight: f32,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_false(value: &bool) -> bool {
    !*value
}

const fn one() -> f32 {
    1.0
}

/// People who come in together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arrivals {
    /// Time of the simulation, s.
    pub time: f32,
    /// How many.
    pub count: u32,
}

/// Where people come in while the simulation runs: by rate, or by schedule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Corners in order, at least 3: they appear somewhere in it, where there is room.
    pub polygon: Vec<Point>,
    /// Names of the journeys that begin here; none here and in `routes`: any journey, or any route if there is no journey.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub journeys: Vec<String>,
    /// Names of the routes walked from here.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub routes: Vec<String>,
    /// Agents a second, at even distances of time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<f32>,
    /// Time of the first agent of `rate`, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub begin: f32,
    /// Time at which `rate` ends, s; left out: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<f32>,
    /// How many come in when, in order of time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub schedule: Vec<Arrivals>,
    /// Share of `population.agents` kept for this source, 0 to 1; left out: what it needs of those that are left.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<f32>,
}

impl Stage {
    /// Half axes of the region along its width and its depth, m; 0 for a waypoint.
    pub fn half_axes(&self) -> [Vec2; 2] {
        let Some(size) = self.size else { return [Vec2::ZERO; 2] };
        let corners = polygon::rectangle(Vec2::ZERO, Vec2::from(size), self.heading_deg.to_radians());
        [(corners[1] - corners[0]) * 0.5, (corners[2] - corners[1]) * 0.5]
    }

    /// From one place of a queue to the next, m.
    pub(super) fn to_next_place(&self) -> Vec2 {
        let (sin, cos) = self.heading_deg.to_radians().sin_cos();
        Vec2::new(sin, cos) * self.spacing.unwrap_or(SPACING)
    }

    /// The stage as agents meet it; `queue` is the number of queues before it.
    pub(super) fn stop(&self, number: u32, queue: u32, time_step: f32) -> Stop {
        let is_queue = self.kind == StageKind::Queue;
        let time = if is_queue { self.service_time.unwrap_or(0.0) } else { self.wait };
        Stop {
            kind: match self.kind {
                StageKind::Waypoint => StopKind::Waypoint,
                StageKind::Goal => StopKind::Goal,
                StageKind::Waiting => StopKind::Waiting,
                StageKind::Queue => StopKind::Queue { number: queue, places: self.places.unwrap_or(1) },
                StageKind::Exit => StopKind::Exit,
            },
            position: Vec2::from(self.position),
            radius: self.radius.unwrap_or(WAYPOINT_RADIUS),
            half_axes: if is_queue { [self.to_next_place(), Vec2::ZERO] } else { self.half_axes() },
            wait: steps(f64::from(time), time_step),
            until: steps(f64::from(self.until), time_step),
            number,
            field: None,
        }
    }
}

/// The first step that does not begin before a time, s.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped: times are at most some days"
)]
pub(super) fn steps(time: f64, time_step: f32) -> u32 {
    // A thousandth of a step less, so that 2 s are 60 steps of 1/30 s although 1/30 is rounded.
    (time / f64::from(time_step) - 1e-3).ceil().clamp(0.0, 1e9) as u32
}

impl Journey {
    /// Every way through the journey: numbers of its stages, and its share of the agents.
    pub(super) fn ways(&self, names: &BTreeMap<&str, usize>) -> Vec<(Vec<usize>, f32)> {
        let mut ways: Vec<(Vec<usize>, f32)> = vec![(Vec::new(), 1.0)];
        for leg in &self.stages {
            let choices = leg.choices();
            let total: f32 = choices.iter().map(|(_, share)| share).sum();
            let longer = ways.iter().flat_map(|(way, share)| {
                choices.iter().filter(|(_, part)| *part > 0.0).filter_map(move |(name, part)| {
                    let stage = *names.get(name)?;
                    Some(([way.as_slice(), &[stage]].concat(), share * part / total))
                })
            });
            ways = longer.take(MOST_WAYS).collect();
        }
        ways
    }
}

/// Names of stages: name to number.
pub(super) fn stage_names(stages: &[Stage]) -> BTreeMap<&str, usize> {
    stages.iter().enumerate().map(|(index, stage)| (stage.name.as_str(), index)).collect()
}

/// Names of journeys: name to number.
pub(super) fn journey_names(journeys: &[Journey]) -> BTreeMap<&str, usize> {
    journeys.iter().enumerate().map(|(index, journey)| (journey.name.as_str(), index)).collect()
}

/// Checks stages, journeys and sources.
pub(super) fn validate(scenario: &Scenario) -> Result<(), Error> {
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
            return Err(Error::value(of("service_time"), "none", format!("0 to {DAY} for a queue"), hint));
        };
        within(&of("service_time"), service, 0.0, DAY, "seconds; a day is the most")?;
        let places = stage.places.unwrap_or(0);
        if !(1..=MOST_PLACES).contains(&places) {
            let (found, allowed) = (places, format!("1 to {MOST_PLACES} for a queue"));
            return Err(Error::value(of("places"), found, allowed, "how many people can stand in it"));
        }
        within(&of("spacing"), stage.spacing.unwrap_or(SPACING), 0.3, 10.0, "metres; 0.8 is usual")?;
    }
    idle(of("wait"), !waits && stage.wait != 0.0, "kind = \"waiting\" waits")?;
    idle(of("until"), !waits && stage.until != 0.0, "kind = \"waiting\" waits")?;
    if let Some(radius) = stage.radius {
        within(&of("radius"), radius, 0.1, 50.0, "metres; 1 to 3 is usual")?;
    }
    match stage.size {
        None if is_region => {
            let hint = "metres along x and z, before heading_deg turns it";
            return Err(Error::value(of("size"), "none", "[width, depth]", hint));
        }
        None => {}
        Some(size) => {
            for (i, length) in size.into_iter().enumerate() {
                within(&format!("{key}.size[{i}]"), length, 0.2, 10_000.0, "metres")?;
            }
        }
    }
    within(&of("heading_deg"), stage.heading_deg, -360.0, 360.0, "degrees about +y")?;
    within(&of("wait"), stage.wait, 0.0, DAY, "seconds; a day is the most")?;
    within(&of("until"), stage.until, 0.0, DAY, "seconds since the start; a day is the most")?;
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
    let count = journey.stages.len();
    let least = if journey.repeat { 2 } else { 1 };
    if !(least..=MOST_LEGS).contains(&count) {
        let allowed = format!("{least} to {MOST_LEGS} stages");
        return Err(Error::value(
            format!("{key}.stages"),
            format!("{count} stages"),
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
            let is_last = index + 1 == count && !journey.repeat;
            if stages[stage].kind == StageKind::Exit && !is_last {
                let found = format!("{name:?}");
                let hint = "who has left goes nowhere: put it last, and leave repeat out";
                return Err(Error::value(key, found, "no exit before the last stage", hint));
            }
            if stages[stage].kind == StageKind::Queue && is_last {
                let hint = "put an exit or a goal behind it";
                return Err(Error::value(key, format!("{name:?}"), "no queue as the last stage", hint));
            }
            within(&format!("{key}.{name}"), share, 0.0, 1e6, "shares are relative: 1 and 1 is half each")?;
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
    within(&format!("{key}.weight"), journey.weight, 0.0, 1e6, "1 is as many as of the other journeys")
}

fn source(key: &str, source: &Source, scenario: &Scenario) -> Result<(), Error> {
    let of = |field: &str| format!("{key}.{field}");
    outline(&of("polygon"), &source.polygon, "the corners of the region")?;
    match (source.rate, source.schedule.is_empty()) {
        (Some(rate), true) => within(&of("rate"), rate, 1e-4, 1000.0, "agents a second")?,
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
    within(&of("begin"), source.begin, 0.0, DAY, "seconds since the start")?;
    if let Some(end) = source.end {
        within(&of("end"), end, source.begin, DAY, "seconds since the start, after begin")?;
    }
    if !source.schedule.is_empty() && (source.end.is_some() || source.begin != 0.0) {
        let name = if source.end.is_some() { "end" } else { "begin" };
        let hint = "the schedule says when";
        return Err(Error::value(of(name), "..", "left out where a schedule is given", hint));
    }
    let mut last = 0.0;
    for (index, arrivals) in source.schedule.iter().enumerate() {
        let key = format!("{key}.schedule[{index}].time");
        within(&key, arrivals.time, last, DAY, "seconds since the start, in order")?;
        last = arrivals.time;
    }
    if let Some(share) = source.share {
        within(&of("share"), share, 0.0, 1.0, "of population.agents")?;
    }
    if !source.journeys.is_empty() && !source.routes.is_empty() {
        let hint = "make two sources of it";
        return Err(Error::value(of("routes"), "[..]", "left out where journeys are given", hint));
    }
    if scenario.layout == super::schema::Layout::Custom {
        let routes = super::schema::route_names(&scenario.routes);
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

/// Who is there from the start, and whether there is a place for them.
fn present(scenario: &Scenario) -> Result<(), Error> {
    let has_sources = !scenario.sources.is_empty();
    let key = "population.present";
    match scenario.population.present {
        Some(share) => within(key, share, 0.0, 1.0, "share of the agents that are there from the start")?,
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
    let is_custom = scenario.layout == super::schema::Layout::Custom;
    let has_agents = scenario.population.agents > 0;
    if has_agents && is_custom && starts && scenario.spawns.is_empty() && scenario.routes.is_empty() {
        let hint = "add a [[spawns]] table: where those stand who are there from the start";
        return Err(Error::value("spawns", "[]", "one region or more where there is no route", hint));
    }
    Ok(())
}

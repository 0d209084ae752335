//! Profiles, generators, and the places where agents start.

use super::report::Report;
use super::xml::{Source, children, count, kind, maybe, need, place, tag, wrong};
use crate::scenario::error::Error;
use crate::scenario::file::MAX_AGENTS;
use crate::scenario::random::{Purpose, unit};
use glam::Vec2;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;
use std::sync::Arc;

/// How far profiles may inherit.
const DEPTH: usize = 32;
/// Elements of models of Menge's other than ORCA: they say nothing to us.
const OTHER_MODELS: [&str; 10] = [
    "OpenSteer",
    "GCF",
    "Helbing",
    "Johansson",
    "Karamouzas",
    "Zanlungo",
    "Dummy",
    "PedVO",
    "Tordeux",
    "Agents",
];

/// What agents of a kind are like, by Menge's names and with its defaults.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Profile {
    pub(super) radius: Value,
    pub(super) speed: Value,
    pub(super) neighbour_distance: f32,
    pub(super) neighbour_cap: u32,
    pub(super) horizon: f32,
    pub(super) horizon_obstacles: f32,
    /// Classes of obstacles that it heeds, as bits.
    pub(super) obstacle_set: u32,
}

impl Default for Profile {
    fn default() -> Self {
        Self {
            radius: Value::Constant(0.19),
            speed: Value::Constant(1.04),
            neighbour_distance: 5.0,
            neighbour_cap: 10,
            horizon: 2.5,
            horizon_obstacles: 0.15,
            obstacle_set: u32::MAX,
        }
    }
}

impl Profile {
    /// What a scenario has once for all agents.
    pub(super) fn shared(&self) -> [u32; 4] {
        let bits = f32::to_bits;
        [bits(self.neighbour_distance), self.neighbour_cap, bits(self.horizon), bits(self.horizon_obstacles)]
    }
}

/// A number, or where it is drawn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value {
    Constant(f32),
    Uniform(f32, f32),
    Normal(f32, f32),
}

impl Value {
    /// The value for an agent; `draw` tells its draws apart.
    pub(super) fn of(self, seed: u64, agent: u32, draw: u32) -> f32 {
        let u = |k: u32| unit(seed, agent, Purpose::Start, 8 * draw + k);
        match self {
            Self::Constant(value) => value,
            Self::Uniform(low, high) => low + (high - low) * u(0),
            // Box and Muller; 1 - u is never 0.
            Self::Normal(mean, deviation) => {
                let radius = (-2.0 * libm::logf(1.0 - u(0))).sqrt();
                mean + deviation * radius * libm::cosf(std::f32::consts::TAU * u(1))
            }
        }
    }

    /// Reads `dist`, `value`, `min`, `max`, `mean`, `stddev`, all with a prefix.
    pub(super) fn read(source: &Source, node: &Node<'_, '_>, prefix: &str) -> Result<Option<Self>, Error> {
        let get = |name: &str| need(source, node, &format!("{prefix}{name}"));
        Ok(Some(match node.attribute(format!("{prefix}dist").as_str()) {
            None => return Ok(None),
            Some("c") => Self::Constant(get("value")?),
            Some("u") => Self::Uniform(get("min")?, get("max")?),
            Some("n") => Self::Normal(get("mean")?, get("stddev")?),
            Some(other) => {
                return Err(wrong(source, node, format!("{prefix}dist={other:?}; c, u and n are known")));
            }
        }))
    }
}

/// An agent at its start.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placed {
    /// In Menge's plane, m.
    pub(super) position: Vec2,
    /// Shared by the agents of a group, who may be many.
    pub(super) profile: Arc<Profile>,
    /// First state of its behaviour.
    pub(super) state: Arc<str>,
    pub(super) radius: f32,
    pub(super) speed: f32,
}

/// Reads all agents of a scene.
pub(super) fn read(
    source: &Source,
    document: &Document<'_>,
    seed: u64,
    report: &mut Report,
) -> Result<Vec<Placed>, Error> {
    let root = document.root_element();
    let profiles = profiles(source, &root, report)?;
    let mut agents = Vec::new();
    for node in children(&root) {
        match tag(&node) {
            "AgentGroup" => group(source, &node, &profiles, seed, &mut agents, report)?,
            "AgentProfile" | "ObstacleSet" => {}
            "Common" => report.note("Menge's time step is not taken over: ours is navigation.time_step"),
            "SpatialQuery" | "Elevation" => report.note(format!(
                "<{}> is not needed: neighbours and height are found another way, on flat ground",
                tag(&node)
            )),
            name if OTHER_MODELS.contains(&name) => other_model(report),
            name => report.unsupported(&place(source, &node), &format!("<{name}>")),
        }
    }
    Ok(agents)
}

fn other_model(report: &mut Report) {
    report.note("parameters of Menge's other models are left out");
}

fn profiles(
    source: &Source,
    root: &Node<'_, '_>,
    report: &mut Report,
) -> Result<BTreeMap<String, Arc<Profile>>, Error> {
    let nodes: Vec<_> = children(root).filter(|node| tag(node) == "AgentProfile").collect();
    let mut found: BTreeMap<String, Arc<Profile>> = BTreeMap::new();
    for node in &nodes {
        let name = node.attribute("name").unwrap_or("");
        // The chain of ancestors, eldest first.
        let mut chain = vec![*node];
        while let Some(parent) = chain.last().and_then(|node| node.attribute("inherits")) {
            let Some(ancestor) = nodes.iter().find(|node| node.attribute("name") == Some(parent)) else {
                return Err(wrong(
                    source,
                    node,
                    format!("profile {name:?} inherits from {parent:?}, which is not there"),
                ));
            };
            chain.push(*ancestor);
            if chain.len() > DEPTH {
                return Err(wrong(
                    source,
                    node,
                    format!("profile {name:?} inherits from itself, or over {DEPTH} profiles"),
                ));
            }
        }
        let mut profile = Profile::default();
        for ancestor in chain.iter().rev() {
            extend(source, ancestor, &mut profile, report)?;
        }
        found.insert(name.to_owned(), Arc::new(profile));
    }
    Ok(found)
}

fn extend(
    source: &Source,
    node: &Node<'_, '_>,
    profile: &mut Profile,
    report: &mut Report,
) -> Result<(), Error> {
    for part in children(node) {
        match tag(&part) {
            "Common" => common(source, &part, profile, report)?,
            "ORCA" => {
                profile.horizon = maybe(source, &part, "tau")?.unwrap_or(profile.horizon);
                profile.horizon_obstacles =
                    maybe(source, &part, "tauObst")?.unwrap_or(profile.horizon_obstacles);
                if profile.horizon_obstacles < 0.1 {
                    report.note(format!(
                        "tauObst {} became 0.1 s, the least there is",
                        profile.horizon_obstacles
                    ));
                }
            }
            name if OTHER_MODELS.contains(&name) => other_model(report),
            name => report.unsupported(&place(source, &part), &format!("<{name}> of an agent profile")),
        }
    }
    Ok(())
}

fn common(
    source: &Source,
    node: &Node<'_, '_>,
    profile: &mut Profile,
    report: &mut Report,
) -> Result<(), Error> {
    for attribute in node.attributes() {
        let number = || need(source, node, attribute.name());
        match attribute.name() {
            "r" => profile.radius = Value::Constant(number()?),
            "pref_speed" => profile.speed = Value::Constant(number()?),
            "max_speed" => {
                number()?;
                report.note(
                    "max_speed is left out: it is navigation.max_speed_factor times the preferred speed",
                );
            }
            "neighbor_dist" => profile.neighbour_distance = number()?,
            "max_neighbors" => profile.neighbour_cap = count(source, node, "max_neighbors", 10_000)?,
            "class" => {}
            "obstacleSet" => profile.obstacle_set = count(source, node, "obstacleSet", u32::MAX)?,
            "max_angle_vel" | "max_accel" => {
                report.note(
                    "max_angle_vel and max_accel are left out: agents here turn and speed up as they walk",
                );
            }
            "priority" => {
                if number()? != 0.0 {
                    report.unsupported(&place(source, node), "priority");
                }
            }
            name => report.unsupported(&place(source, node), &format!("attribute {name} of <Common>")),
        }
    }
    for property in children(node) {
        let Some(value) = Value::read(source, &property, "")? else {
            return Err(wrong(source, &property, "a <Property> without dist"));
        };
        match property.attribute("name").unwrap_or("") {
            "r" => profile.radius = value,
            "pref_speed" => profile.speed = value,
            name => report.unsupported(&place(source, &property), &format!("<Property name={name:?}>")),
        }
    }
    Ok(())
}

/// One group: whose profile, which state, where.
fn group(
    source: &Source,
    node: &Node<'_, '_>,
    profiles: &BTreeMap<String, Arc<Profile>>,
    seed: u64,
    agents: &mut Vec<Placed>,
    report: &mut Report,
) -> Result<(), Error> {
    let (mut profile, mut state) = (None, Arc::from(""));
    for part in children(node).filter(|part| matches!(tag(part), "ProfileSelector" | "StateSelector")) {
        if kind(&part) != "const" {
            report.approximate(source, &part, "the first name in it is taken for all");
        }
        let inner = part.descendants().find_map(|inner| inner.attribute("name")).unwrap_or("");
        if tag(&part) == "StateSelector" {
            state = Arc::from(inner);
        } else {
            let Some(found) = profiles.get(inner) else {
                return Err(wrong(source, &part, format!("there is no profile {inner:?}")));
            };
            profile = Some(Arc::clone(found));
        }
    }
    let profile = profile.ok_or_else(|| wrong(source, node, "an <AgentGroup> without a profile"))?;
    for part in children(node) {
        match tag(&part) {
            "ProfileSelector" | "StateSelector" => {}
            "Generator" => {
                let places = generate(source, &part, report)?;
                if agents.len() + places.len() > MAX_AGENTS as usize {
                    return Err(wrong(source, &part, format!("more than {MAX_AGENTS} agents")));
                }
                let shift = Value::read(source, &part, "displace_")?;
                for position in places {
                    let agent = u32::try_from(agents.len()).unwrap_or(u32::MAX);
                    let shift = shift.map_or(Vec2::ZERO, |shift| {
                        let direction = unit(seed, agent, Purpose::Start, 100) * std::f32::consts::TAU;
                        Vec2::from_angle(direction) * shift.of(seed, agent, 0)
                    });
                    let draw = |value: Value, draw: u32, low: f32, high: f32| {
                        value.of(seed, agent, draw).clamp(low, high)
                    };
                    agents.push(Placed {
                        position: position + shift,
                        radius: draw(profile.radius, 1, 0.05, 2.0),
                        speed: draw(profile.speed, 2, 0.05, 5.0),
                        profile: Arc::clone(&profile),
                        state: Arc::clone(&state),
                    });
                }
            }
            name => report.unsupported(&place(source, &part), &format!("<{name}> of an agent group")),
        }
    }
    Ok(())
}

/// The places of a generator, before they are displaced.
fn generate(source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<Vec<Vec2>, Error> {
    match kind(node) {
        "explicit" => {
            let agent =
                |node: Node<'_, '_>| Ok(Vec2::new(need(source, &node, "p_x")?, need(source, &node, "p_y")?));
            children(node).filter(|part| tag(part) == "Agent").map(agent).collect()
        }
        "rect_grid" => rect_grid(source, node),
        "hex_lattice" => hex_lattice(source, node, report),
        other => {
            report.unsupported(
                &place(source, node),
                &format!("<Generator type={other:?}>: its agents are left out"),
            );
            Ok(Vec::new())
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts of at most a thousand a side")]
fn rect_grid(source: &Source, node: &Node<'_, '_>) -> Result<Vec<Vec2>, Error> {
    let get = |name| need(source, node, name);
    let anchor = Vec2::new(get("anchor_x")?, get("anchor_y")?);
    let offset = Vec2::new(get("offset_x")?, get("offset_y")?);
    let (columns, rows) = (count(source, node, "count_x", 1000)?, count(source, node, "count_y", 1000)?);
    let turn = Vec2::from_angle(maybe(source, node, "rotation")?.unwrap_or(0.0).to_radians());
    let at = |x: u32, y: u32| anchor + turn.rotate(offset * Vec2::new(x as f32, y as f32));
    Ok((0..columns).flat_map(|x| (0..rows).map(move |y| (x, y))).map(|(x, y)| at(x, y)).collect())
}

/// A lattice of equilateral triangles in rows across `width`, filled from the anchor on until all have a place. Before it
/// is turned by `rotation` it grows along +y, and the anchor is the middle, the left or the right end of its first row.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "at most as many places as there may be agents"
)]
fn hex_lattice(source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<Vec<Vec2>, Error> {
    let get = |name| need(source, node, name);
    let anchor = Vec2::new(get("anchor_x")?, get("anchor_y")?);
    let (density, width) = (get("density")?, get("width")?);
    let population = count(source, node, "population", MAX_AGENTS)?;
    if !(density > 0.0 && width > 0.0) {
        return Err(wrong(source, node, "density and width of a lattice must be greater than 0"));
    }
    // A triangle of side d holds half an agent: density = 2 / (sqrt(3) d^2).
    let side = (2.0 / (3_f32.sqrt() * density)).sqrt();
    let is_along = node.attribute("row_direction") == Some("y");
    let (across, along) =
        if is_along { (side * 0.75_f32.sqrt(), side) } else { (side, side * 0.75_f32.sqrt()) };
    let columns = ((width / across).floor() as u32).clamp(1, 100_000);
    let middle = match node.attribute("alignment").unwrap_or("center") {
        "center" => 0.5 * (columns - 1) as f32,
        "near" => 0.0,
        "far" => (columns - 1) as f32,
        other => {
            report.approximate(source, node, format!("alignment={other:?} became center"));
            0.5 * (columns - 1) as f32
        }
    };
    report.note(
        "hex_lattice: rows grow along +y before they are turned (read from its scenes, not from Menge)",
    );
    let turn = Vec2::from_angle(maybe(source, node, "rotation")?.unwrap_or(0.0).to_radians());
    let mut places = Vec::with_capacity(population as usize);
    let mut row = 0_u32;
    while places.len() < population as usize {
        let odd = row % 2 == 1;
        // rows along x: every other one is shifted by half a side and one agent shorter
        let here = if odd && !is_along { (columns - 1).max(1) } else { columns };
        for column in 0..here.min(population - places.len() as u32) {
            let mut at = Vec2::new((column as f32 - middle) * across, row as f32 * along);
            if is_along && column % 2 == 1 {
                at.y += 0.5 * along;
            } else if odd && !is_along && columns > 1 {
                at.x += 0.5 * across;
            }
            places.push(anchor + turn.rotate(at));
        }
        row += 1;
    }
    Ok(places)
}

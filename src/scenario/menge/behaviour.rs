//! The behaviour: states with a goal and a way of getting there, transitions between them.

use super::super::error::Error;
use super::super::random::{Purpose, index};
use super::super::schema::RouteMode;
use super::super::walkers::{Teleport, Walker};
use super::Report;
use super::agents::Placed;
use super::nav::NavMesh;
use super::roads::Roads;
use super::xml::{Source, children, kind, maybe, need, place, tag, wrong};
use glam::Vec2;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// Most states that one agent's way is followed through.
const MAX_STATES: usize = 1000;
/// The corners of a box on our ground, least first.
fn corners(low: Vec2, high: Vec2) -> [[f32; 2]; 2] {
    let (a, b) = (Vec2::from(super::ground(low)), Vec2::from(super::ground(high)));
    [a.min(b).to_array(), a.max(b).to_array()]
}

/// How near somebody must come to a place on the way, m: road maps and meshes are made to be followed closely.
const ON_THE_WAY: f32 = 0.4;

/// Where a goal is, in Menge's plane, m.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Point(Vec2),
    Circle(Vec2, f32),
    /// Least and greatest corner.
    Box(Vec2, Vec2),
}

impl Place {
    /// The nearest point of it.
    fn nearest(self, to: Vec2) -> Vec2 {
        match self {
            Self::Point(at) => at,
            Self::Circle(at, radius) => at + (to - at).clamp_length_max(radius),
            Self::Box(low, high) => to.clamp(low, high),
        }
    }

    fn middle(self) -> Vec2 {
        match self {
            Self::Point(at) | Self::Circle(at, _) => at,
            Self::Box(low, high) => (low + high) * 0.5,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Selector {
    Identity,
    Mirror(Vec2),
    Explicit(usize, usize),
    Nearest(usize),
    Farthest(usize),
    Random(usize),
}

#[derive(Debug, Clone, PartialEq)]
enum Means {
    Stand,
    Straight,
    Roads(usize),
    Mesh(usize),
}

#[derive(Debug, Clone, PartialEq)]
struct State {
    is_final: bool,
    selector: Selector,
    means: Means,
    teleport: Option<(Vec2, Vec2)>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Condition {
    /// Within that distance of the goal.
    Reached(f32),
    /// In a box.
    Inside(Vec2, Vec2),
    /// At once, or after a while.
    Auto,
}

#[derive(Debug, Clone, PartialEq)]
struct Transition {
    from: Vec<String>,
    to: String,
    condition: Condition,
}

/// The behaviour of a scene.
#[derive(Debug, Default)]
pub(super) struct Machine {
    states: BTreeMap<String, State>,
    transitions: Vec<Transition>,
    /// Goal sets by id: goals by id.
    goals: BTreeMap<usize, BTreeMap<usize, Place>>,
    roads: Vec<Roads>,
    meshes: Vec<NavMesh>,
    files: BTreeMap<String, usize>,
}

impl Machine {
    pub(super) fn read(source: &Source, document: &Document<'_>, report: &mut Report) -> Result<Self, Error> {
        let mut machine = Self::default();
        for node in children(&document.root_element()) {
            match tag(&node) {
                "GoalSet" => machine.goal_set(source, &node, report)?,
                "State" => machine.state(source, &node, report)?,
                "Transition" => machine.transition(source, &node, report)?,
                name => report.unsupported(&place(source, &node), &format!("<{name}>")),
            }
        }
        Ok(machine)
    }

    fn goal_set(&mut self, source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<(), Error> {
        let set = super::xml::count(source, node, "id", u32::MAX)? as usize;
        for goal in children(node).filter(|goal| tag(goal) == "Goal") {
            let id = super::xml::count(source, &goal, "id", u32::MAX)? as usize;
            let get = |name| need(source, &goal, name);
            let found = match kind(&goal) {
                "point" => Place::Point(Vec2::new(get("x")?, get("y")?)),
                "circle" => Place::Circle(Vec2::new(get("x")?, get("y")?), get("radius")?.max(0.0)),
                "AABB" => {
                    let (a, b) =
                        (Vec2::new(get("min_x")?, get("min_y")?), Vec2::new(get("max_x")?, get("max_y")?));
                    Place::Box(a.min(b), a.max(b))
                }
                other => {
                    report.unsupported(&place(source, &goal), &format!("<Goal type={other:?}>: left out"));
                    continue;
                }
            };
            self.goals.entry(set).or_default().insert(id, found);
        }
        Ok(())
    }

    fn state(&mut self, source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<(), Error> {
        let mut state = State {
            is_final: matches!(node.attribute("final"), Some("1" | "true")),
            selector: Selector::Identity,
            means: Means::Stand,
            teleport: None,
        };
        for part in children(node) {
            match tag(&part) {
                "GoalSelector" => state.selector = self.selector(source, &part, report)?,
                "VelComponent" => state.means = self.means(source, &part, report)?,
                "Action" if kind(&part) == "teleport" && part.attribute("dist") == Some("u") => {
                    let get = |name| need(source, &part, name);
                    let (a, b) =
                        (Vec2::new(get("min_x")?, get("min_y")?), Vec2::new(get("max_x")?, get("max_y")?));
                    state.teleport = Some((a.min(b), a.max(b)));
                }
                "Action" => {
                    let property = part.attribute("property").unwrap_or("");
                    let what = format!("<Action type={:?} property={property:?}>", kind(&part));
                    report.unsupported(&place(source, &part), &what);
                }
                name => report.unsupported(&place(source, &part), &format!("<{name}> of a state")),
            }
        }
        self.states.insert(node.attribute("name").unwrap_or("").to_owned(), state);
        Ok(())
    }

    fn selector(&self, source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<Selector, Error> {
        let set = || -> Result<usize, Error> {
            let set = super::xml::count(source, node, "goal_set", u32::MAX)? as usize;
            if self.goals.get(&set).is_none_or(BTreeMap::is_empty) {
                return Err(wrong(source, node, format!("there is no goal set {set}, or it is empty")));
            }
            Ok(set)
        };
        Ok(match kind(node) {
            "identity" => Selector::Identity,
            "mirror" => {
                let sign = |name| if node.attribute(name) == Some("1") { -1.0 } else { 1.0 };
                Selector::Mirror(Vec2::new(sign("mirror_x"), sign("mirror_y")))
            }
            "explicit" => {
                let (set, goal) = (set()?, super::xml::count(source, node, "goal", u32::MAX)? as usize);
                if self.goals.get(&set).is_none_or(|goals| !goals.contains_key(&goal)) {
                    return Err(wrong(source, node, format!("goal set {set} has no goal {goal}")));
                }
                Selector::Explicit(set, goal)
            }
            "nearest" | "nearest_nav_mesh" => Selector::Nearest(set()?),
            "farthest" | "farthest_nav_mesh" => Selector::Farthest(set()?),
            "random" => Selector::Random(set()?),
            "weighted" => {
                report.unsupported(&place(source, node), "weights of goals: all are alike");
                Selector::Random(set()?)
            }
            other => {
                report
                    .unsupported(&place(source, node), &format!("<GoalSelector type={other:?}>: they stay"));
                Selector::Identity
            }
        })
    }

    fn means(&mut self, source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<Means, Error> {
        let name = node.attribute("file_name").unwrap_or("").to_owned();
        Ok(match kind(node) {
            "goal" | "const" => Means::Straight,
            "zero" => Means::Stand,
            "road_map" => {
                let next = self.roads.len();
                let place = *self.files.entry(format!("roads {name}")).or_insert(next);
                if place == next {
                    self.roads.push(Roads::parse(&Source::read(&source.path.with_file_name(&name))?)?);
                }
                Means::Roads(place)
            }
            "nav_mesh" => {
                let next = self.meshes.len();
                let place = *self.files.entry(format!("mesh {name}")).or_insert(next);
                if place == next {
                    self.meshes.push(NavMesh::read(source, node)?);
                }
                Means::Mesh(place)
            }
            other => {
                report.unsupported(
                    &place(source, node),
                    &format!("<VelComponent type={other:?}>: straight instead"),
                );
                Means::Straight
            }
        })
    }

    fn transition(&mut self, source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<(), Error> {
        let names = |text: &str| text.split(',').map(|name| name.trim().to_owned()).collect();
        let mut to = node.attribute("to").unwrap_or("").to_owned();
        let mut condition = None;
        for part in children(node) {
            match (tag(&part), kind(&part)) {
                ("Condition", "goal_reached") => {
                    condition = Some(Condition::Reached(maybe(source, &part, "distance")?.unwrap_or(0.5)));
                }
                ("Condition", "AABB") if part.attribute("inside") != Some("0") => {
                    let get = |name| need(source, &part, name);
                    let (a, b) =
                        (Vec2::new(get("min_x")?, get("min_y")?), Vec2::new(get("max_x")?, get("max_y")?));
                    condition = Some(Condition::Inside(a.min(b), a.max(b)));
                }
                ("Condition", "auto") => condition = Some(Condition::Auto),
                ("Condition", "timer") => {
                    report.unsupported(&place(source, &part), "timer: they go on at once");
                    condition = Some(Condition::Auto);
                }
                ("Target", _) => {
                    let first = part.descendants().find_map(|inner| inner.attribute("name"));
                    report.unsupported(&place(source, &part), "a choice of targets: the first is taken");
                    first.unwrap_or("").clone_into(&mut to);
                }
                (name, kind) => {
                    report.unsupported(
                        &place(source, &part),
                        &format!("<{name} type={kind:?}> of a transition"),
                    );
                }
            }
        }
        if let Some(condition) = condition {
            let from = names(node.attribute("from").unwrap_or(""));
            self.transitions.push(Transition { from, to, condition });
        }
        Ok(())
    }

    /// Walks the machine for every agent.
    pub(super) fn walk(
        &self,
        agents: &[Placed],
        walls: &[Vec<Vec2>],
        seed: u64,
        report: &mut Report,
    ) -> Result<Vec<Walker>, Error> {
        let mut walkers = Vec::with_capacity(agents.len());
        let mut takers: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        let mut in_boxes: BTreeMap<(usize, usize), u32> = BTreeMap::new();
        for (number, agent) in (0_u32..).zip(agents) {
            let mut walker = Walker {
                position: super::ground(agent.position),
                arrival: ON_THE_WAY,
                radius: Some(agent.radius),
                speed: Some(agent.speed),
                ..Walker::default()
            };
            let way = self.follow(number, agent, walls, seed, &mut in_boxes, &mut walker, report)?;
            if walker.mode == RouteMode::Once
                && let Some(goal) = way.last()
            {
                takers.entry([goal.x.to_bits(), goal.y.to_bits()]).or_default().push(walkers.len());
            }
            walker.waypoints = way.into_iter().map(super::ground).collect();
            walkers.push(walker);
        }
        // Only one can stand on a point.
        for who in takers.values().filter(|who| who.len() > 1) {
            for &walker in who {
                let Some(walker) = walkers.get_mut(walker) else { continue };
                #[allow(clippy::cast_precision_loss, reason = "a number of people")]
                let room = 1.2 * walker.radius.unwrap_or(0.25) * (2.0 * who.len() as f32).sqrt();
                walker.goal_arrival = walker.goal_arrival.map(|distance| distance + room);
            }
            report.note(
                "a goal shared by several people counts as reached within the room that they need about it",
            );
        }
        Ok(walkers)
    }

    /// The places that one agent walks to.
    #[allow(clippy::too_many_arguments, reason = "one agent of a scene, with the scene")]
    fn follow(
        &self,
        number: u32,
        agent: &Placed,
        walls: &[Vec<Vec2>],
        seed: u64,
        in_boxes: &mut BTreeMap<(usize, usize), u32>,
        walker: &mut Walker,
        report: &mut Report,
    ) -> Result<Vec<Vec2>, Error> {
        let (mut at, mut name, mut way) = (agent.position, agent.state.clone(), Vec::new());
        let mut seen: Vec<String> = Vec::new();
        for _ in 0..MAX_STATES {
            let Some(state) = self.states.get(&name) else {
                report.note(format!("there is no state {name:?}; who is to be in it stands"));
                break;
            };
            if seen.contains(&name) {
                if seen.first() != Some(&name) {
                    report.note(format!(
                        "the circle of states that begins with {name:?} is walked from the first state on"
                    ));
                }
                walker.mode = RouteMode::Loop;
                break;
            }
            seen.push(name.clone());
            let transition = self.transitions.iter().find(|t| t.from.contains(&name));
            let next = transition.and_then(|transition| self.states.get(&transition.to));
            if state.means != Means::Stand && state.selector != Selector::Identity {
                let place = self.goal(state.selector, at, (number, seed));
                let mut goal = match place {
                    Place::Box(..) => self.spread(state.selector, place, at, agent.radius, in_boxes),
                    _ => place.nearest(at),
                };
                match transition.map(|transition| transition.condition) {
                    Some(Condition::Reached(distance)) => {
                        walker.goal_arrival = Some(distance.clamp(0.02, 50.0));
                    }
                    Some(Condition::Inside(low, high)) => {
                        let to = next.and_then(|next| next.teleport);
                        walker.teleport =
                            to.map(|to| Teleport { from: corners(low, high), to: corners(to.0, to.1) });
                        if to.is_none() {
                            // They turn away at the edge of the box, which lies in all its directions.
                            goal = at.clamp(low, high);
                            walker.goal_arrival = Some(0.3);
                        }
                    }
                    _ => {}
                }
                self.go(state, at, goal, agent.radius, walls, &mut way, report);
                at = goal;
                if walker.teleport.is_some() {
                    break; // from there on it begins again
                }
            } else if state.teleport.is_some() {
                report
                    .note(format!("the teleport of {name:?} is left out: nobody comes to it through a box"));
            }
            match transition {
                Some(next) if !state.is_final => next.to.clone_into(&mut name),
                _ => break,
            }
        }
        Ok(way)
    }

    fn goal(&self, selector: Selector, at: Vec2, (agent, seed): (u32, u64)) -> Place {
        let goals = |set: usize| self.goals.get(&set).into_iter().flat_map(BTreeMap::values).copied();
        let distance = |place: &Place| place.nearest(at).distance(at);
        let found = match selector {
            Selector::Identity => None,
            Selector::Mirror(sign) => Some(Place::Point(at * sign)),
            Selector::Explicit(set, goal) => self.goals.get(&set).and_then(|goals| goals.get(&goal)).copied(),
            Selector::Nearest(set) => goals(set).min_by(|a, b| distance(a).total_cmp(&distance(b))),
            Selector::Farthest(set) => goals(set).max_by(|a, b| distance(a).total_cmp(&distance(b))),
            Selector::Random(set) => {
                let all: Vec<Place> = goals(set).collect();
                all.get(index(seed, agent, Purpose::Lane, 0, all.len().max(1))).copied()
            }
        };
        found.unwrap_or(Place::Point(at))
    }

    /// A place of one's own in a box that many go to: one after another, in rows from its middle row on.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "places of a box, at most as many as people"
    )]
    fn spread(
        &self,
        selector: Selector,
        place: Place,
        at: Vec2,
        radius: f32,
        in_boxes: &mut BTreeMap<(usize, usize), u32>,
    ) -> Vec2 {
        let Place::Box(low, high) = place else { return place.nearest(at) };
        let (set, goal) = match selector {
            Selector::Explicit(set, goal) => (set, goal),
            Selector::Nearest(set) | Selector::Farthest(set) | Selector::Random(set) => {
                let goals = self.goals.get(&set);
                let found = goals.and_then(|goals| goals.iter().find(|(_, found)| **found == place));
                (set, found.map_or(0, |(id, _)| *id))
            }
            Selector::Identity | Selector::Mirror(_) => return place.middle(),
        };
        let taken = in_boxes.entry((set, goal)).or_insert(0);
        let inner = (high - low - 2.0 * radius).max(Vec2::ZERO);
        let pitch = 3.0 * radius;
        let counts = (inner / pitch).floor().max(Vec2::ZERO) + 1.0;
        let (columns, rows) = (counts.x as u32, counts.y as u32);
        let number = *taken % (columns * rows).max(1);
        *taken += 1;
        // from the far side on, so that the first do not stand in the way of the last
        let (column, row) = (number % columns, number / columns);
        let step = inner / Vec2::new((columns.max(2) - 1) as f32, (rows.max(2) - 1) as f32);
        let from_low = place.middle().y < at.y;
        let row = if from_low { row } else { rows - 1 - row };
        low + radius.min(0.5 * (high - low).min_element()) + step * Vec2::new(column as f32, row as f32)
    }

    /// Appends the way to a goal.
    #[allow(clippy::too_many_arguments, reason = "one leg of a way, with the scene")]
    fn go(
        &self,
        state: &State,
        at: Vec2,
        goal: Vec2,
        radius: f32,
        walls: &[Vec<Vec2>],
        way: &mut Vec<Vec2>,
        report: &mut Report,
    ) {
        let found = match state.means {
            Means::Roads(roads) => self.roads.get(roads).and_then(|r| r.way(at, goal, walls, radius)),
            Means::Mesh(mesh) => self.meshes.get(mesh).and_then(|m| m.way(at, goal, radius)),
            Means::Stand | Means::Straight => Some(vec![goal]),
        };
        match found {
            Some(found) => way.extend(found),
            None => {
                report.note("somebody sees no way along the roads or the mesh and goes straight");
                way.push(goal);
            }
        }
    }
}

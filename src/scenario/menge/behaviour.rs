//! The behaviour: states with a goal and a way of getting there, transitions between them.

use super::agents::Placed;
use super::field::Field;
use super::goals::{Draw, Goals, Place, Selector, Taken, corners};
use super::nav::NavMesh;
use super::report::Report;
use super::roads::Roads;
use super::xml::{Source, children, element, kind, maybe, place, tag};
use crate::scenario::error::Error;
use crate::scenario::file::{RouteMode, Teleport, Walker, Way};
use glam::Vec2;
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// Most states that one agent's way is followed through.
const MAX_STATES: usize = 1000;
/// The corners of a box on our ground, least first.
fn on_ground(low: Vec2, high: Vec2) -> [[f32; 2]; 2] {
    let (a, b) = (Vec2::from(ground(low)), Vec2::from(ground(high)));
    [a.min(b).to_array(), a.max(b).to_array()]
}

/// How near an agent must come to a place on the way, m: road maps and meshes are made to be followed closely.
const ON_THE_WAY: f32 = 0.4;

#[derive(Debug, Clone, PartialEq)]
enum Means {
    Stand,
    Straight,
    Roads(usize),
    Mesh(usize),
    /// By way-finding; the vector field that stands for, if its file is there.
    Field(Option<usize>),
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

impl Condition {
    /// The condition of an element; none if it is unknown.
    fn read(source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<Option<Self>, Error> {
        Ok(match kind(node) {
            _ if tag(node) != "Condition" => None,
            "goal_reached" => Some(Self::Reached(maybe(source, node, "distance")?.unwrap_or(0.5))),
            "AABB" if node.attribute("inside") != Some("0") => {
                let (low, high) = corners(source, node)?;
                Some(Self::Inside(low, high))
            }
            "auto" => Some(Self::Auto),
            "timer" => {
                report.approximate(source, node, "they go on at once");
                Some(Self::Auto)
            }
            "and" | "or" => {
                let mut found = None;
                for part in children(node) {
                    let known = Self::read(source, &part, report)?;
                    // of an agent that walks, a place says more than a time
                    found = match (found, known) {
                        (None | Some(Self::Auto), Some(known)) => Some(known),
                        (found, _) => found,
                    };
                }
                if found.is_some() {
                    report.approximate(source, node, "one of its conditions alone");
                }
                found
            }
            _ => None,
        })
    }
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
    goals: Goals,
    roads: Vec<Roads>,
    meshes: Vec<NavMesh>,
    fields: Vec<Field>,
    files: BTreeMap<String, usize>,
}

impl Machine {
    pub(super) fn read(source: &Source, document: &Document<'_>, report: &mut Report) -> Result<Self, Error> {
        let mut machine = Self::default();
        let root = document.root_element();
        // states may stand before the goal sets that they name
        for node in children(&root).filter(|node| tag(node) == "GoalSet") {
            machine.goals.add(source, &node, report)?;
        }
        for node in children(&root) {
            match tag(&node) {
                "GoalSet" => {}
                "State" => machine.state(source, &node, report)?,
                "Transition" => machine.transition(source, &node, report)?,
                name => report.unsupported(&place(source, &node), &format!("<{name}>")),
            }
        }
        Ok(machine)
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
                "GoalSelector" => state.selector = self.goals.selector(source, &part, report)?,
                "VelComponent" => state.means = self.means(source, &part, report)?,
                "Action" if kind(&part) == "teleport" && part.attribute("dist") == Some("u") => {
                    state.teleport = Some(corners(source, &part)?);
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
            "vel_field" => Means::Field(self.field(source, node, &name, report)?),
            _ => {
                report.approximate(source, node, "straight");
                Means::Straight
            }
        })
    }

    /// A vector field: way-finding stands for it; its file says where it ends, if it is there.
    fn field(
        &mut self,
        source: &Source,
        node: &Node<'_, '_>,
        name: &str,
        report: &mut Report,
    ) -> Result<Option<usize>, Error> {
        let path = source.path.with_file_name(name);
        if name.is_empty() || !path.is_file() {
            let what = format!("way-finding to the goal round the obstacles; there is no file {name:?}");
            report.approximate(source, node, what);
            return Ok(None);
        }
        let next = self.fields.len();
        let number = *self.files.entry(format!("field {name}")).or_insert(next);
        if number == next {
            self.fields.push(Field::parse(&Source::read(&path)?)?);
        }
        if let Some(field) = self.fields.get(number) {
            let size = format!("{} by {} cells of {} m", field.rows, field.columns, field.cell);
            let what =
                format!("way-finding to the goal round the obstacles, not the vectors of {name} ({size})");
            report.approximate(source, node, what);
        }
        Ok(Some(number))
    }

    fn transition(&mut self, source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<(), Error> {
        let names = |text: &str| text.split(',').map(|name| name.trim().to_owned()).collect();
        let mut to = node.attribute("to").unwrap_or("").to_owned();
        let mut condition = None;
        for part in children(node) {
            if tag(&part) == "Target" {
                let first = part.descendants().find_map(|inner| inner.attribute("name"));
                let first = first.unwrap_or("");
                report.approximate(source, &part, format!("the first target is taken: {first:?}"));
                first.clone_into(&mut to);
                continue;
            }
            match Condition::read(source, &part, report)? {
                Some(found) => condition = Some(found),
                None => {
                    let what = format!("{} of a transition", element(&part));
                    report.unsupported(&place(source, &part), &what);
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
    ) -> Vec<Walker> {
        let mut walkers = Vec::with_capacity(agents.len());
        let mut takers: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        let mut taken = Taken::default();
        for (number, agent) in (0..).zip(agents) {
            let mut walker = Walker {
                position: ground(agent.position),
                arrival: ON_THE_WAY,
                radius: Some(agent.radius),
                speed: Some(agent.speed),
                ..Walker::default()
            };
            let way =
                self.follow(Draw { seed, agent: number }, agent, walls, &mut taken, &mut walker, report);
            if walker.mode == RouteMode::Once
                && let Some(goal) = way.last()
            {
                takers.entry([goal.x.to_bits(), goal.y.to_bits()]).or_default().push(walkers.len());
            }
            walker.waypoints = way.into_iter().map(ground).collect();
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
        walkers
    }

    /// The places that one agent walks to.
    fn follow(
        &self,
        draw: Draw,
        agent: &Placed,
        walls: &[Vec<Vec2>],
        taken: &mut Taken,
        walker: &mut Walker,
        report: &mut Report,
    ) -> Vec<Vec2> {
        let (mut at, mut name, mut way) = (agent.position, agent.state.to_string(), Vec::new());
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
            let condition = transition.map(|transition| transition.condition);
            if let Some(place) = self.goal(state, condition, at, draw) {
                let finds = matches!(state.means, Means::Field(_));
                // one field leads all who go there
                let mut goal = if finds { place.middle() } else { taken.next(place, at, agent.radius) };
                let reach = if finds { place.reach() } else { 0.0 };
                walker.way = walker.way.or(finds.then_some(Way::Auto));
                match condition {
                    Some(Condition::Reached(distance)) => {
                        walker.goal_arrival = Some((distance + reach).clamp(0.02, 50.0));
                    }
                    Some(Condition::Inside(low, high)) => {
                        let to = next.and_then(|next| next.teleport);
                        walker.teleport =
                            to.map(|to| Teleport { from: on_ground(low, high), to: on_ground(to.0, to.1) });
                        if to.is_none() && finds {
                            walker.goal_arrival = Some(reach.clamp(0.3, 50.0));
                        } else if to.is_none() {
                            // They turn away at the edge of the box, which lies in all its directions.
                            goal = at.clamp(low, high);
                            walker.goal_arrival = Some(0.3);
                        }
                    }
                    _ => {}
                }
                let leg = self.leg(state, at, goal, agent.radius, walls).unwrap_or_else(|| {
                    report.note("an agent that sees no way along the roads or the mesh goes straight");
                    vec![goal]
                });
                way.extend(leg);
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
        way
    }

    /// Where an agent in a state goes; nowhere if it stands. A field leads an agent without a goal of its own to the box in which
    /// the state ends, or to where the field itself ends.
    fn goal(&self, state: &State, condition: Option<Condition>, at: Vec2, draw: Draw) -> Option<Place> {
        if state.means == Means::Stand {
            return None;
        }
        let of = |name: &str| self.states.get(name).map(|state| &state.selector);
        self.goals.choose(&state.selector, of, at, draw).or(match (&state.means, condition) {
            (Means::Field(_), Some(Condition::Inside(low, high))) => Some(Place::Box(low, high)),
            (Means::Field(Some(field)), _) => {
                self.fields.get(*field).map(|field| Place::Point(field.end(at)))
            }
            _ => None,
        })
    }

    /// The way to a goal; none where it has to go along roads or a mesh that do not lead there.
    fn leg(
        &self,
        state: &State,
        at: Vec2,
        goal: Vec2,
        radius: f32,
        walls: &[Vec<Vec2>],
    ) -> Option<Vec<Vec2>> {
        match state.means {
            Means::Roads(roads) => self.roads.get(roads).and_then(|r| r.way(at, goal, walls, radius)),
            Means::Mesh(mesh) => self.meshes.get(mesh).and_then(|m| m.way(at, goal, radius)),
            Means::Stand | Means::Straight | Means::Field(_) => Some(vec![goal]),
        }
    }
}

/// Menge's plane as our ground.
pub(super) fn ground(place: Vec2) -> [f32; 2] {
    [place.x, 0.0 - place.y]
}

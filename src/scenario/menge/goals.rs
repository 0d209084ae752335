//! Goals of a behaviour, and how an agent chooses one.

use super::report::Report;
use super::xml::{Source, children, count, element, kind, maybe, need, place, tag, wrong};
use crate::scenario::error::Error;
use crate::scenario::random::{Purpose, index};
use glam::Vec2;
use roxmltree::Node;
use std::collections::BTreeMap;

/// Most states whose goal is shared from one to the next.
const DEPTH: usize = 8;

/// Where a goal is, in Menge's plane, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    Point(Vec2),
    Circle(Vec2, f32),
    /// Least and greatest corner.
    Box(Vec2, Vec2),
    /// The corner it is turned about, size, and the direction of its first side.
    Turned(Vec2, Vec2, Vec2),
}

impl Place {
    /// The nearest point of it.
    pub(super) fn nearest(self, to: Vec2) -> Vec2 {
        match self {
            Self::Point(at) => at,
            Self::Circle(at, radius) => at + (to - at).clamp_length_max(radius),
            Self::Box(low, high) => to.clamp(low, high),
            Self::Turned(corner, size, along) => {
                let own = Vec2::new((to - corner).dot(along), (to - corner).dot(along.perp()));
                corner + along.rotate(own.clamp(Vec2::ZERO, size))
            }
        }
    }

    pub(super) fn middle(self) -> Vec2 {
        match self {
            Self::Point(at) | Self::Circle(at, _) => at,
            Self::Box(low, high) => (low + high) * 0.5,
            Self::Turned(corner, size, along) => corner + along.rotate(size * 0.5),
        }
    }

    /// The largest circle about its middle that lies in it, m.
    pub(super) fn reach(self) -> f32 {
        match self {
            Self::Point(_) => 0.0,
            Self::Circle(_, radius) => radius,
            Self::Box(low, high) => (high - low).min_element() * 0.5,
            Self::Turned(_, size, _) => size.min_element() * 0.5,
        }
    }

    /// A goal of its element; none if its kind is unknown.
    fn read(source: &Source, node: &Node<'_, '_>, report: &mut Report) -> Result<Option<Self>, Error> {
        let get = |name| need(source, node, name);
        let point = |node: &Node<'_, '_>| -> Result<Vec2, Error> {
            Ok(Vec2::new(need(source, node, "x")?, need(source, node, "y")?))
        };
        Ok(Some(match kind(node) {
            "point" => Self::Point(point(node)?),
            "circle" => Self::Circle(point(node)?, get("radius")?.max(0.0)),
            "AABB" => {
                let (low, high) = corners(source, node)?;
                Self::Box(low, high)
            }
            "OBB" => {
                let size = Vec2::new(get("width")?, get("height")?).max(Vec2::ZERO);
                let angle = maybe(source, node, "angle")?.unwrap_or(0.0).to_radians();
                Self::Turned(point(node)?, size, Vec2::new(libm::cosf(angle), libm::sinf(angle)))
            }
            "path" => {
                let Some(first) = children(node).find(|part| tag(part) == "Point") else {
                    return Err(wrong(source, node, "a goal that moves along a path of no <Point>"));
                };
                report.approximate(source, node, "the goal stays at the first point of its path");
                Self::Point(point(&first)?)
            }
            _ => {
                report.unsupported(&place(source, node), &format!("{}: left out", element(node)));
                return Ok(None);
            }
        }))
    }
}

/// The least and the greatest corner of a box.
pub(super) fn corners(source: &Source, node: &Node<'_, '_>) -> Result<(Vec2, Vec2), Error> {
    let get = |name| need(source, node, name);
    let (a, b) = (Vec2::new(get("min_x")?, get("min_y")?), Vec2::new(get("max_x")?, get("max_y")?));
    Ok((a.min(b), a.max(b)))
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Selector {
    Identity,
    Mirror(Vec2),
    Explicit(usize, usize),
    Nearest(usize),
    SecondNearest(usize),
    Farthest(usize),
    Random(usize),
    /// As the state of that name chooses.
    Shared(String),
}

/// Goal sets by id: goals by id.
#[derive(Debug, Default)]
pub(super) struct Goals {
    sets: BTreeMap<usize, BTreeMap<usize, Place>>,
}

impl Goals {
    /// Adds a set; sets of one id are one set.
    pub(super) fn add(
        &mut self,
        source: &Source,
        node: &Node<'_, '_>,
        report: &mut Report,
    ) -> Result<(), Error> {
        let set = count(source, node, "id", u32::MAX)? as usize;
        for part in children(node) {
            if tag(&part) != "Goal" {
                report.unsupported(&place(source, &part), &format!("{}: left out", element(&part)));
                continue;
            }
            let id = count(source, &part, "id", u32::MAX)? as usize;
            let Some(place) = Place::read(source, &part, report)? else { continue };
            let capacity = maybe(source, &part, "capacity")?.unwrap_or(f32::INFINITY);
            if capacity < 100.0 {
                report.approximate(
                    source,
                    &part,
                    "its capacity is not heeded: any number of people choose it",
                );
            }
            self.sets.entry(set).or_default().insert(id, place);
        }
        Ok(())
    }

    pub(super) fn selector(
        &self,
        source: &Source,
        node: &Node<'_, '_>,
        report: &mut Report,
    ) -> Result<Selector, Error> {
        let set = || -> Result<usize, Error> {
            let set = count(source, node, "goal_set", u32::MAX)? as usize;
            if self.sets.get(&set).is_none_or(BTreeMap::is_empty) {
                let known: Vec<String> = self.sets.keys().map(ToString::to_string).collect();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                let message =
                    format!("there is no goal set {set}, or it is empty; goal sets with goals: {known}");
                return Err(wrong(source, node, message));
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
                let (set, goal) = (set()?, count(source, node, "goal", u32::MAX)? as usize);
                if self.sets.get(&set).is_none_or(|goals| !goals.contains_key(&goal)) {
                    return Err(wrong(source, node, format!("goal set {set} has no goal {goal}")));
                }
                Selector::Explicit(set, goal)
            }
            "nearest" => Selector::Nearest(set()?),
            "second_nearest" => Selector::SecondNearest(set()?),
            "farthest" => Selector::Farthest(set()?),
            "nearest_nav_mesh" => {
                report.approximate(source, node, "the nearest in a straight line");
                Selector::Nearest(set()?)
            }
            "farthest_nav_mesh" => {
                report.approximate(source, node, "the farthest in a straight line");
                Selector::Farthest(set()?)
            }
            "random" => Selector::Random(set()?),
            "weighted" => {
                report.approximate(source, node, "weights of goals are not heeded: all are alike");
                Selector::Random(set()?)
            }
            "shared" => Selector::Shared(node.attribute("state_name").unwrap_or("").to_owned()),
            _ => {
                report.unsupported(&place(source, node), &format!("{}: they stay", element(node)));
                Selector::Identity
            }
        })
    }

    /// The goal that an agent at a place chooses; `of` are the selectors of states, for goals that are shared. None: it
    /// has none, and stays.
    pub(super) fn choose<'a>(
        &self,
        mut selector: &'a Selector,
        of: impl Fn(&str) -> Option<&'a Selector>,
        at: Vec2,
        draw: Draw,
    ) -> Option<Place> {
        for _ in 0..DEPTH {
            let Selector::Shared(name) = selector else { break };
            selector = of(name)?;
        }
        let goals = |set: &usize| self.sets.get(set).into_iter().flat_map(BTreeMap::values).copied();
        let distance = |place: &Place| place.nearest(at).distance(at);
        let nearer = |a: &Place, b: &Place| distance(a).total_cmp(&distance(b));
        match selector {
            Selector::Identity | Selector::Shared(_) => None,
            Selector::Mirror(sign) => Some(Place::Point(at * *sign)),
            Selector::Explicit(set, goal) => self.sets.get(set).and_then(|goals| goals.get(goal)).copied(),
            Selector::Nearest(set) => goals(set).min_by(nearer),
            Selector::SecondNearest(set) => {
                let mut all: Vec<Place> = goals(set).collect();
                all.sort_by(nearer);
                all.get(1).or(all.first()).copied()
            }
            Selector::Farthest(set) => goals(set).max_by(nearer),
            Selector::Random(set) => {
                let all: Vec<Place> = goals(set).collect();
                all.get(index(draw.seed, draw.agent, Purpose::Lane, 0, all.len().max(1))).copied()
            }
        }
    }
}

/// Whose draw it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw {
    pub(super) seed: u64,
    pub(super) agent: u32,
}

/// Places of their own for the many who go to one box: one after another, in rows.
#[derive(Debug, Default)]
pub(super) struct Taken {
    /// How many have a place, by the box.
    boxes: BTreeMap<[u32; 4], u32>,
}

impl Taken {
    /// The next place in a box for an agent that comes from `at`, in rows from the far side on, so that the first do not
    /// stand in the way of the last; of another goal its nearest point.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "places of a box, at most as many as people"
    )]
    pub(super) fn next(&mut self, place: Place, at: Vec2, radius: f32) -> Vec2 {
        let Place::Box(low, high) = place else { return place.nearest(at) };
        let key = [low.x, low.y, high.x, high.y].map(f32::to_bits);
        let taken = self.boxes.entry(key).or_insert(0);
        let inner = (high - low - 2.0 * radius).max(Vec2::ZERO);
        let pitch = 3.0 * radius;
        let counts = (inner / pitch).floor().max(Vec2::ZERO) + 1.0;
        let (columns, rows) = (counts.x as u32, counts.y as u32);
        let number = *taken % (columns * rows).max(1);
        *taken += 1;
        let (column, row) = (number % columns, number / columns);
        let step = inner / Vec2::new((columns.max(2) - 1) as f32, (rows.max(2) - 1) as f32);
        let from_low = place.middle().y < at.y;
        let row = if from_low { row } else { rows - 1 - row };
        low + radius.min(0.5 * (high - low).min_element()) + step * Vec2::new(column as f32, row as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_box_is_reached_at_its_side_and_has_its_middle_inside() {
        let place = Place::Turned(Vec2::new(1.0, 0.0), Vec2::new(4.0, 2.0), Vec2::Y);
        assert!(place.nearest(Vec2::new(5.0, 2.0)).distance(Vec2::new(1.0, 2.0)) < 1e-6);
        assert!(place.nearest(Vec2::new(0.0, 3.0)).distance(Vec2::new(0.0, 3.0)) < 1e-6, "inside");
        assert!(place.middle().distance(Vec2::new(0.0, 2.0)) < 1e-6);
        assert!((place.reach() - 1.0).abs() < 1e-6);
    }
}

//! The agents of a trajectory file: the table `agents`.

use crate::emotion::Emotion;
use crate::ground::is_absent;
use crate::scenario::{AgentStart, Crowd, ExternalKind, Scenario};
use crate::sim::{AvatarSet, setup};
use glam::Vec2;

/// What an agent of a trajectory file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum AgentKind {
    /// A pedestrian: simulated, recorded or tracked.
    #[default]
    Person,
    /// A robot.
    Robot,
    /// A vehicle.
    Vehicle,
}

impl AgentKind {
    /// `person`, `robot` or `vehicle`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Person => "person",
            Self::Robot => "robot",
            Self::Vehicle => "vehicle",
        }
    }
}

/// What is known of an agent beside its trajectory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AgentInfo {
    /// What it is.
    pub kind: AgentKind,
    /// Whether it goes where a recording, a path or a program says.
    pub led: bool,
    /// Weights of the emotions at the start, sum 1, in the order of [`Emotion::ALL`].
    pub emotion: Option<[f32; 4]>,
    /// Name of the gait, of several the one of the greatest weight.
    pub gait: Option<String>,
    /// Name or path of the avatar.
    pub avatar: Option<String>,
    /// Name of the class of the population.
    pub class: Option<String>,
    /// Index of the first member of the group that it walks with.
    pub group: Option<u32>,
    /// Disc radius, m.
    pub radius: Option<f32>,
    /// Preferred speed, m/s.
    pub preferred_speed: Option<f32>,
    /// Age, years, where the body was drawn for one.
    pub age: Option<f32>,
    /// Stature, m, where the body has one of its own.
    pub stature: Option<f32>,
    /// Weight, kg, likewise.
    pub weight: Option<f32>,
}

impl AgentInfo {
    /// Everyone of a crowd, by index; from `recorded` on they are people of a recording.
    pub fn of_crowd(
        scenario: &Scenario,
        crowd: &Crowd,
        cast: &AvatarSet,
        recorded: Option<u32>,
    ) -> Vec<Self> {
        let people = (0_u32..).zip(&crowd.agents).map(|(index, agent)| {
            let others = agent.companions.iter().filter(|other| **other != u32::MAX);
            let is_led = recorded.is_some_and(|first| index >= first);
            let class = scenario.class_of(index).map(|class| class.name.clone());
            Self {
                led: is_led,
                class: class.filter(|name| !name.is_empty()),
                group: others.copied().min().map(|other| other.min(index)),
                ..Self::of_person(scenario, agent, cast)
            }
        });
        let outsiders = crowd.external.iter().zip(&scenario.outsiders).map(|(agent, outsider)| {
            let kind = match outsider.kind {
                ExternalKind::Robot => AgentKind::Robot,
                ExternalKind::Vehicle => AgentKind::Vehicle,
                ExternalKind::Person => {
                    let person = Self::of_person(scenario, agent, cast);
                    return Self { led: true, preferred_speed: None, ..person };
                }
            };
            Self { kind, led: true, radius: Some(agent.radius), ..Self::default() }
        });
        people.chain(outsiders).collect()
    }

    fn of_person(scenario: &Scenario, agent: &AgentStart, cast: &AvatarSet) -> Self {
        let gait = agent.gaits[strongest(agent.gait_weights)];
        Self {
            emotion: Some(agent.emotion),
            gait: cast.gait_name(gait).map(str::to_owned),
            avatar: scenario.population.avatars.get(agent.avatar as usize).cloned(),
            radius: Some(agent.radius),
            preferred_speed: Some(setup::preferred_speed(agent, cast)),
            age: agent.build.size.and_then(|size| size.age),
            stature: agent.build.size.map(|size| size.stature),
            weight: agent.build.size.map(|size| size.weight),
            ..Self::default()
        }
    }
}

/// Place of the greatest weight, the first of equal ones.
fn strongest(weights: [f32; 4]) -> usize {
    (0..4).fold(0, |best, i| if weights[i] > weights[best] { i } else { best })
}

/// The emotion of the greatest weight.
pub(super) fn strongest_emotion(weights: [f32; 4]) -> Emotion {
    Emotion::ALL[strongest(weights)]
}

/// The first and the last frame in which an agent is present.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Presence {
    pub(super) first: u32,
    pub(super) last: u32,
}

impl Presence {
    /// When an agent entered, and when it had left, s; none for one that is there in the last of these frames.
    pub(super) fn times(self, frames: u32, frame_rate: f64) -> (f64, Option<f64>) {
        let time = |frame: u32| f64::from(frame) / frame_rate;
        (time(self.first), (self.last + 1 < frames).then(|| time(self.last + 1)))
    }
}

/// Who is there, and has been.
#[derive(Debug, Default)]
pub(super) struct Attendance {
    known: Vec<Option<Presence>>,
    /// Who was there in the last frame. Only comings and goings are noted, so a frame costs a look at each.
    there: Vec<bool>,
}

/// An agent, by number, that has come, or gone.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    agent: usize,
    is_there: bool,
}

/// What a part of a frame shows.
#[derive(Debug)]
pub(super) struct Seen {
    /// How many are there.
    pub(super) present: usize,
    pub(super) changes: Vec<Change>,
}

impl Attendance {
    /// Notes who comes and goes with a frame.
    pub(super) fn see(&mut self, frame: u32, positions: &[Vec2]) {
        let seen = self.compare(0, positions);
        self.apply(frame, positions.len(), &seen.changes);
    }

    /// Who of a part of a frame, from an agent on, is there, and was not in the last frame, or the other way round.
    pub(super) fn compare(&self, first: usize, positions: &[Vec2]) -> Seen {
        let known = self.there.get(first..).unwrap_or_default();
        let was = known.iter().copied().chain(std::iter::repeat(false));
        let mut seen = Seen { present: 0, changes: Vec::new() };
        for ((agent, place), was) in (first..).zip(positions).zip(was) {
            let is_there = !is_absent(place.to_array());
            seen.present += usize::from(is_there);
            if is_there != was {
                seen.changes.push(Change { agent, is_there });
            }
        }
        seen
    }

    /// Notes changes of a frame of so many agents. Others have gone.
    pub(super) fn apply(&mut self, frame: u32, agents: usize, changes: &[Change]) {
        let all = self.there.len().max(agents);
        self.there.resize(all, false);
        self.known.resize(all, None);
        let others = (agents..all).map(|agent| Change { agent, is_there: false });
        for Change { agent, is_there } in changes.iter().copied().chain(others) {
            if self.there[agent] != is_there {
                self.there[agent] = is_there;
                note(&mut self.known[agent], frame, is_there);
            }
        }
    }

    /// When each was there, if ever, of so many frames.
    pub(super) fn finish(mut self, frames: u32) -> Vec<Option<Presence>> {
        let still = self.known.iter_mut().zip(&self.there).filter(|(_, is)| **is);
        still.for_each(|(known, _)| note(known, frames, false));
        self.known
    }
}

/// Notes that an agent is there from a frame on, or is no more.
#[cold]
fn note(known: &mut Option<Presence>, frame: u32, is_there: bool) {
    let known = known.get_or_insert(Presence { first: frame, last: frame });
    if !is_there {
        known.last = frame.saturating_sub(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ground::ABSENT;

    #[test]
    fn a_frame_in_parts_shows_what_the_whole_shows() {
        let place = |is_there: bool| Vec2::splat(if is_there { 1.0 } else { ABSENT });
        // the fourth is shorter: others have gone
        let frame = |number: u32, agents: u32| -> Vec<Vec2> {
            (0..agents).map(|agent| place(!(agent * 7 + number * 3).is_multiple_of(5))).collect()
        };
        let frames = [frame(0, 50), frame(1, 50), frame(2, 60), frame(3, 40), frame(4, 60)];
        let (mut whole, mut parts) = (Attendance::default(), Attendance::default());
        for (number, positions) in (0..).zip(&frames) {
            whole.see(number, positions);
            let seen: Vec<Seen> =
                (0..).zip(positions.chunks(7)).map(|(part, own)| parts.compare(part * 7, own)).collect();
            let present: usize = seen.iter().map(|seen| seen.present).sum();
            assert_eq!(present, positions.iter().filter(|place| place.x < 2.0).count());
            let changes: Vec<Change> = seen.into_iter().flat_map(|seen| seen.changes).collect();
            parts.apply(number, positions.len(), &changes);
        }
        let (whole, parts) = (whole.finish(5), parts.finish(5));
        assert_eq!(whole, parts);
        for agent in [3, 45, 55] {
            let is_there = |frame: &Vec<Vec2>| frame.get(agent).is_some_and(|place| place.x < 2.0);
            let there: Vec<u32> =
                (0..).zip(&frames).filter(|(_, frame)| is_there(frame)).map(|(number, _)| number).collect();
            let presence = whole[agent].unwrap();
            assert_eq!((presence.first, presence.last), (there[0], there[there.len() - 1]));
        }
    }
}

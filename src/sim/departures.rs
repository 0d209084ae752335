//! When people leave, in total and by exit: times of evacuation and the n-t curve.

use super::measure::time_of;
use crate::ground::is_absent;
use crate::kernels::Store;
use crate::kernels::layout::{Route, Seen};
use crate::scenario::{Crowd, Entry, Scenario, StopKind};
use serde::Serialize;
use std::collections::BTreeMap;

/// When how many people had left.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evacuation {
    /// People who are to leave: all but people without a time at a source. Robots and vehicles do not count.
    pub people: u32,
    /// How many of them have left for good.
    pub left: u32,
    /// When 50 % of them had left, s; `None`: not yet.
    pub time_50: Option<f64>,
    /// When 95 % had left, s.
    pub time_95: Option<f64>,
    /// When all had left, s.
    pub time_100: Option<f64>,
    /// By exit, in the order of the scenario's stages; only exits that people took.
    pub exits: Vec<ExitTimes>,
    /// The n-t curve: times, s, and how many had left by then; one entry for every time of a departure.
    pub n_t: Vec<(f64, u32)>,
}

/// When people left by one exit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExitTimes {
    /// Name of the stage.
    pub exit: String,
    /// How many took it.
    pub left: u32,
    /// When 50 % of them had left, s.
    pub time_50: Option<f64>,
    /// When 95 % had left, s.
    pub time_95: Option<f64>,
    /// When all of them had left, s.
    pub time_100: Option<f64>,
}

/// An agent as last seen.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Whereabouts {
    /// Not come yet.
    Outside,
    There,
    /// Gone since a time, s, by a stage that is an exit, or otherwise.
    Gone(f64, Option<u32>),
}

/// Watches people leave.
#[derive(Debug, Clone)]
pub struct Departures {
    people: Vec<Whereabouts>,
    /// How many of them never come in.
    never: u32,
    /// Of every stop of the crowd the number of the stage, if it is an exit.
    exits: Vec<Option<u32>>,
    /// Names of the stages.
    names: Vec<String>,
}

impl Departures {
    /// The people of a crowd before its first step.
    pub fn new(scenario: &Scenario, crowd: &Crowd) -> Self {
        let never = crowd.agents.iter().filter(|agent| agent.entry == Entry::Never).count();
        Self {
            people: vec![Whereabouts::Outside; crowd.agents.len()],
            never: never as u32,
            exits: crowd
                .stages
                .iter()
                .map(|stop| (stop.kind == StopKind::Exit).then_some(stop.number))
                .collect(),
            names: scenario.stages.iter().map(|stage| stage.name.clone()).collect(),
        }
    }

    /// Whether there is a way out.
    pub fn has_exits(&self) -> bool {
        self.exits.iter().any(Option::is_some)
    }

    /// Notes which agents are there now, after `steps` steps.
    pub fn observe(&mut self, store: &Store, steps: u32) {
        let now = time_of(steps, store.step.time_step);
        for (agent, state) in self.people.iter_mut().enumerate() {
            let is_there = !is_absent(store.position[agent]);
            *state = match *state {
                _ if is_there => Whereabouts::There,
                Whereabouts::There => Whereabouts::Gone(now, exit_of(&self.exits, store.route[agent])),
                other => other,
            };
        }
    }

    /// Notes what was seen of each agent in all steps up to now; `store` is the present state.
    pub(crate) fn see(&mut self, seen: &[Seen], store: &Store) {
        for (agent, (state, own)) in self.people.iter_mut().zip(seen).enumerate() {
            *state = match (own.is_there, own.gone) {
                (0, 0) => *state,
                (0, steps) => {
                    let time = time_of(steps, store.step.time_step);
                    Whereabouts::Gone(time, exit_of(&self.exits, store.route[agent]))
                }
                _ => Whereabouts::There,
            };
        }
    }

    /// How many people are there or still to come.
    pub fn remaining(&self) -> u32 {
        self.people.len() as u32 - self.never - self.gone().count() as u32
    }

    fn gone(&self) -> impl Iterator<Item = (f64, Option<u32>)> + '_ {
        self.people.iter().filter_map(|state| match state {
            Whereabouts::Gone(time, exit) => Some((*time, *exit)),
            _ => None,
        })
    }

    /// The observed evacuation; `None` where no agent can leave and none has.
    pub fn evacuation(&self) -> Option<Evacuation> {
        let mut times: Vec<f64> = self.gone().map(|(time, _)| time).collect();
        if times.is_empty() && !self.has_exits() {
            return None;
        }
        times.sort_unstable_by(f64::total_cmp);
        let mut n_t: Vec<(f64, u32)> = Vec::new();
        for (time, count) in times.iter().zip(1..) {
            match n_t.last_mut().filter(|last| last.0 >= *time) {
                Some(last) => last.1 = count,
                None => n_t.push((*time, count)),
            }
        }
        let mut by_exit: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        for (time, exit) in self.gone() {
            if let Some(exit) = exit {
                by_exit.entry(exit).or_default().push(time);
            }
        }
        let exits = by_exit.into_iter().map(|(stage, mut times)| {
            times.sort_unstable_by(f64::total_cmp);
            let [time_50, time_95, time_100] = quantiles(&times, times.len());
            let exit = self.names.get(stage as usize).cloned().unwrap_or_else(|| format!("stage {stage}"));
            ExitTimes { exit, left: times.len() as u32, time_50, time_95, time_100 }
        });
        let people = self.people.len() - self.never as usize;
        let [time_50, time_95, time_100] = quantiles(&times, people);
        Some(Evacuation {
            people: people as u32,
            left: times.len() as u32,
            time_50,
            time_95,
            time_100,
            exits: exits.collect(),
            n_t,
        })
    }
}

/// When 50, 95 and 100 % of `people` had left, given the sorted times at which some did.
fn quantiles(times: &[f64], people: usize) -> [Option<f64>; 3] {
    [50, 95, 100].map(|percent| {
        let count = (people * percent).div_ceil(100);
        times.get(count.checked_sub(1)?).copied()
    })
}

/// The exit through which an agent with this route has gone: the stage before its present one.
fn exit_of(exits: &[Option<u32>], route: Route) -> Option<u32> {
    let last = if route.next == 0 { route.length() } else { route.next }.checked_sub(1)?;
    exits.get((route.first + last) as usize).copied().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_all_people_and_rounded_up() {
        let times: Vec<f64> = (1..=10).map(f64::from).collect();
        assert_eq!(quantiles(&times, 10), [Some(5.0), Some(10.0), Some(10.0)]);
        assert_eq!(quantiles(&times, 11), [Some(6.0), None, None]);
        assert_eq!(quantiles(&[], 0), [None; 3]);
    }
}

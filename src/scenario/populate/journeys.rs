//! Stages as agents meet them, and the ways through journeys.

use super::crowd::{Stop, StopKind};
use crate::scenario::file::{Journey, MOST_WAYS, Stage, StageKind};
use glam::Vec2;
use std::collections::BTreeMap;

/// Radius of a waypoint that says none, m.
const WAYPOINT_RADIUS: f32 = 1.0;

impl Stage {
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
            elevation: self.elevation,
            way: None,
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

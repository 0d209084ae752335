//! The last two snapshots of a crowd that frames interpolate, and the interpolation between them.
//!
//! Frames come at the display's rate, steps at their own. A frame shows the crowd one step late: between the last two
//! snapshots, never beyond the newest. So no agent is ever shown at a place where it will not have been.

use super::bodies::SMALLEST_STORAGE_RANGE;
use super::{Simulation, order};
use crate::kernels::layout::{BetweenUniforms, FrameUniforms, Snapshot};
use crate::kernels::{BufferId, Dispatch, Op, Store};

/// An agent that seems faster than this did not walk, m/s: it was set to another place, came in, or went.
const FASTEST: f64 = 10.0;

/// When the two snapshots were, and where they are kept.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Snapshots {
    /// Times of the snapshots at the two places, s.
    times: [f64; 2],
    newest: usize,
    count: u32,
}

impl Snapshots {
    /// Records the present snapshot as the newest, at `time` (s). Returns the place that `keep_snapshot` must write.
    pub fn keep(&mut self, time: f64) -> u32 {
        self.newest = if self.count == 0 { 0 } else { 1 - self.newest };
        self.times[self.newest] = time;
        self.count = (self.count + 1).min(2);
        self.newest as u32
    }

    /// Time of the newest snapshot, s.
    pub fn newest(&self) -> Option<f64> {
        (self.count > 0).then(|| self.times[self.newest])
    }

    /// What `interpolate` needs to show the crowd as it was at `time`, s, or at the nearest time there is.
    pub fn at(&self, time: f64, agent_count: u32) -> BetweenUniforms {
        let (newest, before) = (self.times[self.newest], self.times[1 - self.newest]);
        let span = newest - before;
        // of one snapshot, or two at the wrong way round, the newest
        let is_span = self.count > 1 && span > 0.0 && time.is_finite();
        let share = if is_span { ((time - before) / span).clamp(0.0, 1.0) } else { 1.0 };
        let reach = (FASTEST * span.clamp(0.0, 10.0)) as f32;
        BetweenUniforms { agent_count, newest: self.newest as u32, share: share as f32, reach }
    }
}

/// Makes room for two snapshots. The call must come before the engine is made. A crowd whose snapshots would be larger than
/// every device can bind gets none: its frames show the newest snapshot.
pub fn make_room(store: &mut Store) {
    let elements = 2 * store.step.agent_count as usize;
    if (elements * size_of::<Snapshot>()) as u64 <= SMALLEST_STORAGE_RANGE {
        store.snapshots = vec![Snapshot::default(); elements];
    }
}

impl Simulation {
    /// Prepares bodies as [`Simulation::animate`] does, between two snapshots. With `keep` it first keeps the present snapshot at
    /// that place. [`Simulation::restore`] must follow once the frame is drawn. The crowd needs [`make_room`] first.
    ///
    /// # Errors
    /// When the device fails.
    pub fn animate_between(
        &mut self,
        frame: FrameUniforms,
        between: BetweenUniforms,
        keep: Option<u32>,
    ) -> Result<(), crate::Error> {
        self.store.frame = frame;
        let dispatches = order::between_dispatches(between.agent_count, keep);
        self.run_between(dispatches.into_iter().chain(order::frame_dispatches(&frame)), &frame, &between)?;
        self.check()
    }

    /// Restores the present snapshot, the newest of those kept.
    ///
    /// # Errors
    /// When the device fails.
    pub fn restore(&mut self, between: BetweenUniforms) -> Result<(), crate::Error> {
        let between = BetweenUniforms { share: 1.0, ..between };
        let frame = self.store.frame;
        self.run_between(order::between_dispatches(between.agent_count, None).into_iter(), &frame, &between)
    }

    fn run_between(
        &mut self,
        dispatches: impl Iterator<Item = Dispatch>,
        frame: &FrameUniforms,
        between: &BetweenUniforms,
    ) -> Result<(), crate::Error> {
        let sets = [Op::Set(BufferId::Between), Op::Set(BufferId::Frame)];
        let ops: Vec<Op> = sets.into_iter().chain(dispatches.map(Op::Dispatch)).collect();
        self.run(&ops, |_, buffer| match buffer {
            BufferId::Between => bytemuck::bytes_of(between).to_vec(),
            _ => bytemuck::bytes_of(frame).to_vec(),
        })
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "limits are exact")]
mod tests {
    use super::*;

    #[test]
    fn a_picture_lies_between_the_last_two_moments_and_never_beyond_the_newest() {
        let mut snapshots = Snapshots::default();
        assert_eq!(snapshots.at(3.0, 7).share, 1.0);
        assert_eq!(snapshots.keep(1.0), 0);
        assert_eq!(snapshots.at(0.5, 7).share, 1.0);
        assert_eq!(snapshots.keep(1.5), 1);
        let at = |time| snapshots.at(time, 7);
        assert_eq!([0.0, 1.0, 1.25, 1.5, 9.0, f64::NAN].map(|t| at(t).share), [0.0, 0.0, 0.5, 1.0, 1.0, 1.0]);
        assert_eq!((at(1.25).newest, at(1.25).agent_count, at(1.25).reach), (1, 7, 5.0));
        assert_eq!(snapshots.keep(1.4), 0);
        assert_eq!(snapshots.at(1.45, 7).share, 1.0);
    }
}

//! A take made ready, and one stride cut out of it.

use super::refusal::Refusal;
use super::support::Feet;
use super::take::{Cut, Take};
use super::{MAX_CRAB_DEG, MAX_RATE, REPEATS, SPEED, Stride, frames, pose_at, walk, wrap};
use crate::gait::{Gait, JOINT_COUNT, Joint, Pose, Recording, norm};
use crate::ground::{ground_from_world, heading_from_ground};
use glam::{Quat, Vec3};

pub(super) fn prepare(recording: &Recording) -> Take {
    let mut poses = recording.poses.clone();
    let mut cycle = None;
    if recording.cyclic {
        // The step from the last frame to the first is not known; the mean of its neighbours is the best guess.
        let last = poses.len() - 1;
        let mut end = poses[0];
        for (joint, point) in end.iter_mut().enumerate() {
            let step =
                (poses[1][joint] - poses[0][joint] + poses[last][joint] - poses[last - 1][joint]) / 2.0;
            *point = poses[last][joint] + step;
        }
        let gap = closing_gap(&poses[0], &end);
        let count = poses.len() as f32;
        for (index, pose) in poses.iter_mut().enumerate() {
            spread(pose, &gap, index as f32 / count);
        }
        cycle = Some((poses.len(), rms(&gap)));
        poses = std::iter::repeat_n(&poses, REPEATS).flatten().copied().collect();
    }
    let on_the_spot = walk::is_on_the_spot(&poses, recording.frame_rate);
    if on_the_spot {
        walk::restore_travel(&mut poses, recording.frame_rate);
    }
    Take { poses, rate: recording.frame_rate, on_the_spot, cycle }
}

/// From the start of a cycle to its end, per joint.
fn closing_gap(start: &Pose, end: &Pose) -> Pose {
    std::array::from_fn(|joint| end[joint] - start[joint])
}

/// Subtracts from a pose its part of the gap, by its fraction of the cycle. The middle of the cycle stays in place.
fn spread(pose: &mut Pose, gap: &Pose, share: f32) {
    for (point, gap) in pose.iter_mut().zip(gap) {
        *point -= *gap * (share - 0.5);
    }
}

fn rms(gap: &Pose) -> f32 {
    (gap.iter().map(|d| d.length_squared()).sum::<f32>() / JOINT_COUNT as f32).sqrt()
}

/// The way of the root over one stride, on the ground.
struct Way {
    start: Vec3,
    /// Heading from start to end.
    heading: f32,
    /// Turn to the left, radians.
    turn: f32,
    /// Length of the arc, m.
    travel: f32,
}

impl Way {
    /// Where the root is at a share of the stride, if it goes evenly, and the heading there.
    fn at(&self, share: f32) -> (Vec3, f32) {
        let centre = self.start + along_arc(self.heading, self.turn, self.travel, share);
        (centre, self.heading + self.turn * (share - 0.5))
    }
}

impl Take {
    /// The pose at a fractional frame.
    fn at(&self, frame: f32) -> Pose {
        pose_at(&self.poses, frame)
    }

    /// Mean direction of the body over some frames, as a heading.
    fn heading(&self, from: f32, to: f32) -> f32 {
        let (from, to) = (frames(from), frames(to).max(frames(from)) + 1);
        let end = to.min(self.poses.len());
        let sum: Vec3 = self.poses[from.min(end)..end].iter().map(walk::facing_now).sum();
        heading_from_ground(ground_from_world(sum))
    }

    /// Turn of the body from one frame to a later one of the same phase, radians to the left.
    fn turn(&self, from: f32, to: f32) -> f32 {
        // Averaged over a few frames at either end, as far as there are any.
        let span = (0.05 * self.rate).min(from).min((self.poses.len() - 1) as f32 - to).max(0.0);
        wrap(self.heading(to - span, to + span) - self.heading(from - span, from + span))
    }

    fn way(&self, cut: &Cut) -> Way {
        let root = |frame: f32| self.at(frame)[Joint::Root as usize].with_y(0.0);
        let (start, end) = (root(cut.from), root(cut.to));
        let chord = end - start;
        let turn = if self.cycle.is_some() { 0.0 } else { self.turn(cut.from, cut.to) };
        // The arc over a chord of the same turn; a straight line where there is no turn.
        let half = turn / 2.0;
        let travel = chord.length() * if half.abs() > 1e-4 { half / libm::sinf(half) } else { 1.0 };
        Way { start, heading: heading_from_ground(ground_from_world(chord)), turn, travel }
    }

    /// One stride as a gait; the reason if it cannot be used. With `feet`, whether it is a walk is
    /// judged.
    pub(super) fn stride(
        &self,
        recording: &Recording,
        cut: &Cut,
        max_turn_deg: f32,
        feet: Option<&Feet>,
    ) -> Result<Stride, Refusal> {
        let duration = (cut.to - cut.from) / self.rate;
        let way = self.way(cut);
        if way.turn.abs() > max_turn_deg.to_radians() {
            return Err(Refusal::Turn { degrees: way.turn.to_degrees(), most: max_turn_deg });
        }
        let speed = way.travel / duration;
        let crab = wrap(self.heading(cut.from, cut.to) - way.heading).to_degrees();
        // A body that hardly moves has no direction, and on the spot the feet tell more.
        let crab = if SPEED.contains(&speed) && crab.abs() > MAX_CRAB_DEG { Some(crab) } else { None };
        if let (Some(degrees), false) = (crab, self.on_the_spot) {
            return Err(Refusal::Crab { degrees });
        }
        let support = feet.zip(cut.between).map(|(feet, between)| feet.support(cut, between, speed));
        // A cycle is a walk by declaration.
        if let (Some(support), None) = (support, self.cycle) {
            support.check()?;
        }
        if !SPEED.contains(&speed) {
            return Err(Refusal::Speed { speed });
        }
        if let Some(degrees) = crab {
            return Err(Refusal::Crab { degrees });
        }
        let (mut poses, gap) = self.cycle_of(cut, &way);
        norm::complete(&mut poses, recording.missing);
        let begin = match self.cycle {
            Some((frames, _)) => (cut.from % frames as f32) / self.rate,
            None => cut.from / self.rate,
        };
        let gait = Gait {
            name: recording.name.clone(),
            frame_rate: poses.len() as f32 / duration,
            poses,
            speed,
            provenance: recording.provenance.clone(),
            acted: recording.acted.clone(),
            ratings: None,
            label: recording.label,
            missing: recording.missing,
        };
        let mismatch = self.cycle.map_or_else(|| rms(&gap), |(_, mismatch)| mismatch);
        let on_the_spot = self.on_the_spot;
        Ok(Stride { gait, begin, foot: cut.foot, duration, turn: way.turn, mismatch, on_the_spot, support })
    }

    /// The poses of one stride on the spot, closed, from the left strike on; and the gap that closing took away.
    fn cycle_of(&self, cut: &Cut, way: &Way) -> (Vec<Pose>, Pose) {
        let seconds = (cut.to - cut.from) / self.rate;
        let count = frames((seconds * self.rate.min(MAX_RATE)).round()).max(8);
        let on_the_spot = |frame: f32, share: f32| {
            let (centre, heading) = way.at(share);
            let pose = self.at(frame);
            pose.map(|point| Quat::from_rotation_y(-heading) * (point - centre))
        };
        let gap = closing_gap(&on_the_spot(cut.from, 0.0), &on_the_spot(cut.to, 1.0));
        let first = cut.phase_of_left_strike();
        let mut poses: Vec<Pose> = (0..count)
            .map(|i| {
                let share = first + i as f32 / count as f32;
                let share = if share < 1.0 { share } else { share - 1.0 };
                let mut pose = on_the_spot(cut.from + share * (cut.to - cut.from), share);
                spread(&mut pose, &gap, share);
                pose
            })
            .collect();
        stand_at_origin(&mut poses);
        (poses, gap)
    }

    /// The whole cycle of a cyclic recording, from the left foot's strike (or, without any, from where the left
    /// foot is lowest in front).
    pub(super) fn whole_cycle(
        &self,
        recording: &Recording,
        strikes: &walk::Strikes,
    ) -> Result<Option<Stride>, Refusal> {
        let Some((count, _)) = self.cycle else { return Ok(None) };
        let second = count as f32..2.0 * count as f32;
        let begin = strikes.of_foot[0].iter().copied().find(|t| second.contains(t)).unwrap_or_else(|| {
            let heading = walk::facing(&self.poses, self.rate);
            let reach = |i: usize| {
                let pose = &self.poses[i];
                (pose[Joint::LeftFoot as usize] - pose[Joint::Root as usize]).dot(heading[i])
            };
            let furthest = (count..2 * count).max_by(|&a, &b| reach(a).total_cmp(&reach(b)));
            furthest.unwrap_or(count) as f32
        });
        let cut = Cut::left(begin, begin + count as f32);
        self.stride(recording, &cut, super::MAX_TURN_DEG, None).map(Some)
    }
}

/// Where the walker is at a share of a stride of `travel` metres whose heading turns evenly by `turn` about the
/// heading of its chord; from its start, m, on the ground.
fn along_arc(chord_heading: f32, turn: f32, travel: f32, share: f32) -> Vec3 {
    if turn.abs() < 1e-4 {
        return Vec3::new(libm::sinf(chord_heading), 0.0, libm::cosf(chord_heading)) * (travel * share);
    }
    let (from, to) = (chord_heading - turn / 2.0, chord_heading + turn * (share - 0.5));
    Vec3::new(libm::cosf(from) - libm::cosf(to), 0.0, libm::sinf(to) - libm::sinf(from)) * (travel / turn)
}

/// Puts the root's mean above the origin and the lowest point of the foot joints at y = 0.
fn stand_at_origin(poses: &mut [Pose]) {
    let root: Vec3 = poses.iter().map(|pose| pose[Joint::Root as usize]).sum::<Vec3>() / poses.len() as f32;
    let feet = poses.iter().flat_map(|pose| walk::FEET.map(|foot| pose[foot as usize].y));
    let ground = feet.fold(f32::MAX, f32::min);
    for point in poses.iter_mut().flatten() {
        *point -= Vec3::new(root.x, ground, root.z);
    }
}

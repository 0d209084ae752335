//! Gaits as bodies are drawn with them at other speeds than their own, by the kernels `integrate`, `pose` and `feet`.

use crate::avatar::Avatar;
use crate::avatar::kinematics::{Walk, picture};
use crate::gait::{Gait, JOINT_COUNT, Pose};
use crate::kernels::shared::body::index::POSE_STRIDE;
use crate::kernels::{Phase, Store};
use crate::reference;
use crate::scenario::{AgentStart, Crowd, Scenario};
use crate::sim::{AvatarSet, bodies, setup};
use glam::{Quat, Vec2, Vec4};

/// Pictures of a second: between two of them joints move on nearly straight lines.
const PICTURES: f32 = 120.0;

/// Between the people, to the side, m.
const APART: f32 = 6.0;

/// Time before a stride is looked at, and most time for it, s.
const WARM_UP: f32 = 1.0;
const LONGEST: f32 = 6.0;

/// Places of a stride that are measured, at equal steps of its phase.
const PLACES: usize = 100;

/// What the phase is counted in.
const CYCLE: f64 = 4_294_967_296.0;

/// Everybody walks straight on at `speed`, m/s, on the body that `body` gives by the number of an avatar. One stride of each.
///
/// # Errors
/// A gait that cannot drive a body; a speed at which no stride ends in time.
pub(crate) fn strides_at(
    speed: f32,
    gaits: &[Gait],
    avatars: Vec<Avatar>,
    body: impl Fn(&Gait) -> u32,
) -> Result<Vec<Walk>, crate::Error> {
    let scenario = Scenario::builtin("crossing")?;
    let cast = AvatarSet::new(gaits, avatars)?;
    let mut crowd = Crowd::default();
    for (number, gait) in (0_u16..).zip(gaits) {
        crowd.agents.push(AgentStart {
            gaits: [u32::from(number); 4],
            avatar: body(gait),
            speed: Some(speed),
            ..AgentStart::at(Vec2::new(f32::from(number) * APART, 0.0))
        });
    }
    let mut store = setup::store(&scenario, &scenario.geometry(), &crowd, &cast);
    bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
    store.step.time_step = 1.0 / PICTURES;
    let mut seen: Vec<Seen> = gaits.iter().map(|_| Seen::default()).collect();
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some seconds of pictures")]
    let [warm_up, most] = [WARM_UP, WARM_UP + LONGEST].map(|seconds| (seconds * PICTURES) as u32);
    for step in 0..most {
        walk_on(&mut store, speed);
        if step >= warm_up {
            for (agent, seen) in seen.iter_mut().enumerate() {
                seen.look(&store, agent, &cast);
            }
        }
    }
    let walks: Option<Vec<Walk>> = seen.iter().map(|seen| seen.walk(speed)).collect();
    walks.ok_or_else(|| crate::Error::Usage {
        message: format!("at {speed} m/s no stride ends within {LONGEST} s"),
        hint: "measure at a walking speed".to_owned(),
    })
}

/// One picture later.
fn walk_on(store: &mut Store, speed: f32) {
    for (agent, slot) in (0_u32..).zip(&mut store.agent_slot) {
        *slot = agent;
    }
    store.new_velocity.fill([0.0, speed]);
    for (agent, place) in (0_u32..).zip(store.visible.iter_mut().take(store.position.len())) {
        *place = agent;
    }
    for phase in [Phase::Integrate, Phase::Pose, Phase::Feet] {
        reference::run(phase, store, 0);
    }
}

/// What was seen of one person: phases in cycles since the first picture, and the body there.
#[derive(Default)]
struct Seen {
    phases: Vec<f64>,
    pictures: Vec<(Pose, [f32; 2])>,
    before: u32,
}

impl Seen {
    fn look(&mut self, store: &Store, agent: usize, cast: &AvatarSet) {
        let phase = store.stance[agent].phase;
        let at = match self.phases.last() {
            None => f64::from(phase) / CYCLE,
            Some(last) => last + f64::from(phase.wrapping_sub(self.before)) / CYCLE,
        };
        self.before = phase;
        let pose = &store.local_rotations[agent * POSE_STRIDE..][..POSE_STRIDE];
        let rotations = std::array::from_fn(|joint| Quat::from_array(pose[joint]));
        let avatar = &cast.avatars()[store.appearance[agent].avatar() as usize];
        let root = Vec4::from_array(pose[JOINT_COUNT]).truncate();
        self.phases.push(at);
        self.pictures.push(picture(&avatar.model_from_joint(&rotations, root), avatar));
    }

    /// The stride from the first strike of the left foot to the next.
    fn walk(&self, speed: f32) -> Option<Walk> {
        let from = self.phases.first()?.ceil();
        let places: Option<Vec<(Pose, [f32; 2])>> =
            (0_u8..).take(PLACES).map(|k| self.at(from + f64::from(k) / 100.0)).collect();
        let (poses, foot_pitch) = places?.into_iter().unzip();
        let cycle_time = self.time(from + 1.0)? - self.time(from)?;
        Some(Walk { poses, foot_pitch, cycle_time, travel: speed * cycle_time })
    }

    /// The pictures beside a phase, and how far on the way from the one to the other.
    fn beside(&self, phase: f64) -> Option<([usize; 2], f32)> {
        let after = self.phases.iter().position(|at| *at >= phase)?;
        let before = after.saturating_sub(1);
        let step = self.phases[after] - self.phases[before];
        #[allow(clippy::cast_possible_truncation, reason = "a share")]
        let way = if step > 0.0 { ((phase - self.phases[before]) / step) as f32 } else { 0.0 };
        Some(([before, after], way))
    }

    fn at(&self, phase: f64) -> Option<(Pose, [f32; 2])> {
        let ([before, after], way) = self.beside(phase)?;
        let [(from, pitch), (to, next)] = [before, after].map(|picture| &self.pictures[picture]);
        let pose = std::array::from_fn(|joint| from[joint].lerp(to[joint], way));
        Some((pose, [0, 1].map(|side| pitch[side] + (next[side] - pitch[side]) * way)))
    }

    /// Seconds since the first picture.
    fn time(&self, phase: f64) -> Option<f32> {
        let ([before, _], way) = self.beside(phase)?;
        #[allow(clippy::cast_precision_loss, reason = "a number of pictures")]
        let pictures = before as f32;
        Some((pictures + way) / PICTURES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Emotion;
    use crate::avatar::{Sex, generated};
    use crate::gait::walker;

    fn at(share: f32) -> (Gait, Walk) {
        let gait = walker::person(Emotion::Neutral, walker::Sex::Male, 3, 1).unwrap();
        let bodies = vec![generated(Sex::Male)];
        let speed = crate::avatar::retarget(&gait, &bodies[0]).unwrap().speed;
        let [walk] = strides_at(share * speed, std::slice::from_ref(&gait), bodies, |_| 0)
            .unwrap()
            .try_into()
            .unwrap();
        (gait, walk)
    }

    #[test]
    fn at_its_own_speed_a_gait_is_drawn_as_it_is() {
        let (gait, walk) = at(1.0);
        assert!((walk.cycle_time / gait.cycle_time() - 1.0).abs() < 0.01, "{}", walk.cycle_time);
        assert!((walk.travel / walk.cycle_time / gait.speed - 1.0).abs() < 0.1, "{}", walk.travel);
        assert_eq!((walk.poses.len(), walk.foot_pitch.len()), (PLACES, PLACES));
        let steps = walk.poses.iter().zip(walk.poses.iter().cycle().skip(1));
        let most = steps.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| a.distance(*b))).fold(0.0, f32::max);
        assert!(most < 0.06, "the stride is closed, and nothing jumps: {most} m");
        let body = generated(Sex::Male);
        let clip = crate::avatar::retarget(&gait, &body).unwrap();
        for (place, frame) in [(0, 0), (25, 16), (50, 32)] {
            let frame = &clip.frames[frame];
            let (pose, pitch) = picture(&body.model_from_joint(&frame.rotations, frame.root), &body);
            let apart = pose.iter().zip(&walk.poses[place]).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            let turned = (pitch[0] - walk.foot_pitch[place][0]).abs();
            assert!(apart < 0.01 && turned < 2.0, "at {place} %: {apart} m, {turned} degrees");
        }
    }

    #[test]
    fn steps_share_a_change_of_speed_between_length_and_time() {
        let ((_, usual), (_, slow)) = (at(1.0), at(0.5));
        for ratio in [slow.travel / usual.travel, usual.cycle_time / slow.cycle_time] {
            assert!((ratio - 0.5_f32.sqrt()).abs() < 0.01, "{ratio}");
        }
    }

    #[test]
    fn nobody_ends_a_stride_who_hardly_moves() {
        let gait = walker::person(Emotion::Neutral, walker::Sex::Male, 3, 1).unwrap();
        let error = strides_at(0.001, &[gait], vec![generated(Sex::Male)], |_| 0).unwrap_err();
        assert!(error.to_string().contains("no stride ends"), "{error}");
    }
}

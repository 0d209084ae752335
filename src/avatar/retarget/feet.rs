//! Where the feet go: stance detection on the gait, and a plan that keeps the planted foot still.
//!
//! During stance a foot is flat on the ground and moves backwards in model space at exactly the clip's travel;
//! it lands on its heel and leaves over its toe, each of which stands still while it is the pivot. During swing
//! the ankle follows the gait, corrected by a cubic so that it meets both ends of the stance.

use super::cycle::{at_phase, hermite, smooth_above};
use super::rig::Sole;
use crate::gait::{Joint, Pose};
use glam::{Quat, Vec3};
use std::f32::consts::PI;

/// Shares of the stance: the foot is flat between them.
const FLAT: [f32; 2] = [0.16, 0.64];

/// Toe lift at the strike and heel rise at toe-off of a usual stride (ours), radians.
const STRIKE_PITCH: f32 = 0.25;
const LEAVE_PITCH: f32 = -0.62;

/// Most heel rise for the sake of reach, radians.
const MOST_RISE: f32 = 0.8;

/// Travel per cycle over leg length of a usual walk, for which the two pitches hold.
const USUAL_STRIDE: f32 = 1.55;

/// When a foot stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stance {
    /// Phase of the foot strike.
    pub(super) strike: f32,
    /// Length of the stance in cycles.
    pub(super) share: f32,
}

/// Finds the stance of `foot`. It begins after the foot's most forward point, when the foot has come to rest on
/// the ground (its speed over the ground falls under half the walking speed), and ends at its rearmost point.
/// Neither height nor velocity thresholds are needed, so styles that drag or stamp their feet do not confuse it.
/// `travel` in metres per cycle.
pub(super) fn stance(poses: &[Pose], foot: Joint, travel: f32) -> Stance {
    let count = poses.len();
    let z = |i: usize| poses[i % count][foot as usize].z;
    let best = |better: fn(f32, f32) -> bool| {
        (1..count).fold(0, |best, i| if better(z(i), z(best)) { i } else { best })
    };
    let (front, rear) = (best(|a, b| a > b), best(|a, b| a < b));
    // Speed over the ground in metres per cycle.
    let speed = |i: usize| (z(i + 1) - z(i + count - 1)) * 0.5 * count as f32 + travel;
    let mut strike = front as f32;
    if travel > 1e-3 {
        for i in front..front + count / 6 {
            let (now, next) = (speed(i), speed(i + 1));
            if next < 0.5 * travel {
                strike = i as f32 + ((now - 0.5 * travel) / (now - next).max(1e-6)).clamp(0.0, 1.0);
                break;
            }
            strike = i as f32 + 1.0;
        }
    }
    let strike = strike / count as f32;
    let share = (rear as f32 / count as f32 - strike).rem_euclid(1.0);
    // A walk always has a foot on the ground; below 0.42 it is a run.
    let share = if share < 0.42 { share.max(0.3) } else { share.clamp(0.52, 0.72) };
    Stance { strike: strike.rem_euclid(1.0), share }
}

/// The plan of one foot.
#[derive(Debug, Clone)]
pub(super) struct FootPlan<'a> {
    /// Resampled gait.
    pub(super) poses: &'a [Pose],
    /// Foot joint in the gait.
    pub(super) foot: Joint,
    /// When it stands.
    pub(super) stance: Stance,
    /// Avatar metres per gait metre.
    pub(super) scale: f32,
    /// Avatar metres per cycle.
    pub(super) travel: f32,
    /// Travel over leg length.
    pub(super) relative_stride: f32,
    /// Ankle height above the ground of the flat foot: gait, avatar, m.
    pub(super) ankle: [f32; 2],
    /// Added to the scaled gait's x, m (hips of another width).
    pub(super) shift: f32,
    pub(super) sole: Sole,
    /// How far the whole stance is moved back so that the leg reaches the strike, m.
    pub(super) set_back: f32,
    /// Leg length of the avatar, m.
    pub(super) leg: f32,
    /// Further heel rise per frame of the clip, radians (see [`Self::rise_to_reach`]); empty for none.
    pub(super) rise: Vec<f32>,
}

/// Ankle position and foot pitch (toe up is positive, radians).
#[derive(Debug, Clone, Copy)]
pub(super) struct FootTarget {
    pub(super) ankle: Vec3,
    pub(super) pitch: f32,
    /// On the ground; a swinging foot may fall short of its target, a planted one may not.
    pub(super) planted: bool,
}

/// Turn of a foot by `pitch`, toe up.
pub(super) fn pitched(pitch: f32) -> Quat {
    Quat::from_rotation_x(-pitch)
}

fn ease(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A maximum with a rounded corner of about `round`.
fn soft_max(a: f32, b: f32, round: f32) -> f32 {
    0.5 * (a + b + ((a - b) * (a - b) + round * round).sqrt())
}

impl FootPlan<'_> {
    /// The gait's own ankle, scaled to the avatar, standing on the avatar's ground.
    fn follow(&self, phase: f32) -> Vec3 {
        let p = at_phase(self.poses, self.foot, phase);
        Vec3::new(
            p.x * self.scale + self.shift,
            (p.y - self.ankle[0]) * self.scale + self.ankle[1],
            p.z * self.scale,
        )
    }

    /// Where the flat foot stands `u` cycles after its strike: a line straight back.
    fn planted(&self, u: f32) -> Vec3 {
        const SAMPLES: usize = 16;
        let middle = self.stance.share * 0.5 * (FLAT[0] + FLAT[1]);
        let mut mean = Vec3::ZERO;
        for k in 0..SAMPLES {
            let t = (k as f32 + 0.5) / SAMPLES as f32;
            let at = self.stance.share * (FLAT[0] + (FLAT[1] - FLAT[0]) * t);
            mean += self.follow(self.stance.strike + at) + Vec3::Z * self.travel * (at - middle);
        }
        mean /= SAMPLES as f32;
        Vec3::new(mean.x, self.ankle[1], mean.z - self.set_back - self.travel * (u - middle))
    }

    fn stance_pitch(&self, u: f32) -> f32 {
        let t = u / self.stance.share;
        let vigour = (self.relative_stride / USUAL_STRIDE).clamp(0.0, 1.25);
        let rise = ((t - FLAT[1]) / (1.0 - FLAT[1])).clamp(0.0, 1.0);
        let pitch = vigour * (STRIKE_PITCH * (1.0 - ease(t / FLAT[0])) + LEAVE_PITCH * rise * rise);
        let Some(count) = Some(self.rise.len()).filter(|&count| count > 0) else { return pitch };
        let at = (self.stance.strike + u).rem_euclid(1.0) * count as f32;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 <= at <= count, taken modulo count"
        )]
        let first = at as usize % count;
        let (a, b) = (self.rise[first], self.rise[(first + 1) % count]);
        // The more of the two rises: the profile's, or what the leg needs.
        pitch.max(0.0) - (-pitch).max(0.0).max(a + (b - a) * at.fract())
    }

    /// How far the foot strikes out of reach of a hip that may dip a little, m; `hips` per frame of the clip.
    pub(super) fn strikes_beyond(&self, hips: &[Vec3], reach: f32) -> f32 {
        const DIP: f32 = 0.025;
        let ankle = self.standing(0.0).ankle;
        let nearest = |frame: &usize| {
            let apart = (*frame as f32 / hips.len() as f32 - self.stance.strike).rem_euclid(1.0);
            (apart.min(1.0 - apart) * 1e4).round()
        };
        let frame = (0..hips.len()).min_by(|a, b| nearest(a).total_cmp(&nearest(b))).unwrap_or(0);
        let hip = hips[frame];
        let (height, aside) = (hip.y - DIP * self.leg - ankle.y, hip.x - ankle.x);
        let ahead = (reach * reach - height * height - aside * aside).max(0.0).sqrt();
        (ankle.z - hip.z - ahead).clamp(0.0, 0.4 * self.travel * self.stance.share)
    }

    /// Makes the heel rise as early and as far as the leg needs to reach its foot behind it, so that the hips
    /// need not drop. `hips`: the hip joint per frame of the clip; `reach`: the leg's greatest length, m.
    pub(super) fn rise_to_reach(&mut self, hips: &[Vec3], reach: f32) {
        let count = hips.len();
        // The foot leaves the ground early when even a raised heel does not help; a walk keeps its double support.
        let unreachable = |u: f32| {
            let at = (self.stance.strike + u).rem_euclid(1.0) * count as f32;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 <= at <= count")]
            let hip = hips[at as usize % count];
            let ankle = self.rolled(self.planted(u), self.sole.toe, -0.8 * MOST_RISE);
            ankle.z < hip.z && ankle.distance(hip) > reach
        };
        let share = self.stance.share;
        let earliest = share.min(0.53);
        let steps = (0..16_u8).map(|k| earliest + (share - earliest) * f32::from(k) / 16.0);
        self.stance.share = steps.into_iter().find(|&u| unreachable(u)).unwrap_or(share);
        let mut rise = vec![0.0; count];
        for (frame, (rise, hip)) in rise.iter_mut().zip(hips).enumerate() {
            let u = (frame as f32 / count as f32 - self.stance.strike).rem_euclid(1.0);
            let flat = self.planted(u);
            let behind = u > 0.4 * self.stance.share && u < self.stance.share + 0.08;
            let short = |pitch: f32| self.rolled(flat, self.sole.toe, pitch).distance(*hip) > reach;
            if !behind || flat.z > hip.z || !short(0.0) {
                continue;
            }
            let (mut low, mut high) = (0.0, MOST_RISE);
            for _ in 0..12 {
                let middle = 0.5 * (low + high);
                if short(-middle) { low = middle } else { high = middle }
            }
            *rise = high;
        }
        self.rise = smooth_above(&rise);
    }

    fn standing(&self, u: f32) -> FootTarget {
        let pitch = self.stance_pitch(u);
        let pivot = if pitch > 0.0 { self.sole.heel } else { self.sole.toe };
        FootTarget { ankle: self.rolled(self.planted(u), pivot, pitch), pitch, planted: true }
    }

    /// The ankle after rolling over `pivot` by `pitch`, from where the foot stood flat.
    fn rolled(&self, flat: Vec3, pivot: Vec3, pitch: f32) -> Vec3 {
        // The height follows from the sole's outline, so that curved shoes neither sink nor float.
        (flat + pivot - pitched(pitch) * pivot).with_y(-self.sole.lowest(pitch))
    }

    fn swinging(&self, u: f32) -> FootTarget {
        const STEP: f32 = 1.0 / 256.0;
        let (share, strike) = (self.stance.share, self.stance.strike);
        let length = 1.0 - share;
        let t = (u - share) / length;
        let [leave, land] = [self.standing(share), self.standing(0.0)];
        // Slopes just inside the stance, per cycle.
        let slope = |a: FootTarget, b: FootTarget| ((b.ankle - a.ankle) / STEP, (b.pitch - a.pitch) / STEP);
        let (leave_slope, pitch_slope) = slope(self.standing(share - STEP), leave);
        // A foot that is off the ground starts forward at once, it does not drift on with the ground.
        let leave_slope = leave_slope.with_z(leave_slope.z.max(-0.7 * self.travel));
        let (land_slope, _) = slope(land, self.standing(STEP));
        // One-sided, from within the swing: captured feet stop abruptly.
        let follow_slope = |a: f32, b: f32| (self.follow(b) - self.follow(a)) / (b - a);
        let (start, end) = (strike + share, strike);
        let correction = hermite(
            leave.ankle - self.follow(start),
            (leave_slope - follow_slope(start, start + 4.0 * STEP)) * length,
            land.ankle - self.follow(end),
            (land_slope - follow_slope(end - 4.0 * STEP, end)) * length,
            t,
        );
        let pitch = hermite(leave.pitch, 0.5 * pitch_slope * length, land.pitch, 0.0, t);
        let mut ankle = self.follow(strike + u) + correction;
        // Neither toe nor heel may touch the ground on the way.
        let lowest = self.sole.lowest(pitch);
        // A foot leaves and meets the ground steeply: what is low must not move along it.
        let arch = libm::sinf(PI * t).max(0.0);
        let clearance = 0.034 * self.leg * libm::powf(arch, 0.6);
        let rounding = 0.02 * self.leg * arch;
        ankle.y = soft_max(ankle.y, clearance - lowest, rounding);
        FootTarget { ankle, pitch, planted: false }
    }

    /// Where the foot is at `phase`.
    pub(super) fn at(&self, phase: f32) -> FootTarget {
        let u = (phase - self.stance.strike).rem_euclid(1.0);
        if u <= self.stance.share { self.standing(u) } else { self.swinging(u) }
    }
}

/// Height of the gait's ankles while their feet are flat, m.
pub(super) fn ankle_height(poses: &[Pose], feet: [(Joint, Stance); 2]) -> f32 {
    let mut sum = 0.0;
    let mut count = 0.0;
    for (foot, stance) in feet {
        for k in 0..8_u8 {
            let t = FLAT[0] + (FLAT[1] - FLAT[0]) * f32::from(k) / 8.0;
            sum += at_phase(poses, foot, stance.strike + stance.share * t).y;
            count += 1.0;
        }
    }
    sum / count
}

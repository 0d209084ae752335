//! Where a foot goes, so that the leg keeps the bend that it has in the gait.
//!
//! A gait has no feet: its legs end at the ankles. The pitch of the foot is therefore free, and it is what makes the leg
//! fit: a planted foot rolls over its heel, stands, and rolls over its ball just as far as the knee's angle asks for. The
//! point of contact stands still on the ground, which passes at exactly the clip's travel. In swing the leg keeps the
//! gait's length and direction, but for a correction that begins and ends where the stance does.

use super::cycle::{between, hermite};
use super::feet::Stance;
use super::rig::Sole;
use glam::{Quat, Vec3};
use std::f32::consts::PI;
use std::ops::Range;

/// Farthest that toes are up at the strike, and that the heel is up at the end, radians.
const MOST_UP: f32 = 0.5;
const MOST_DOWN: f32 = -1.15;
/// Pitch down to which the ball of the foot stays on the ground; beyond it the foot rolls over the tips of the toes.
const TOES_BENT: f32 = -0.75;

/// Pitch of the foot in people's stance, radians toe up, by share of the stance (0, 1/8, ... 1): ours, by the usual figures
/// of heel, flat foot and push-off.
const USUAL: [f32; 9] = [0.33, 0.06, -0.02, -0.03, -0.05, -0.08, -0.19, -0.45, -1.05];
/// Travel per cycle over leg length for which those pitches hold.
const USUAL_STRIDE: f32 = 1.55;
/// Share of the stance from which on the foot rolls over its ball; before it, over its heel.
const TURNS_OVER: f32 = 0.2;
/// Shares of the stance between which the hips take up what flat feet cannot.
const CARRIES: Range<f32> = 0.2..0.62;
/// Most that hips move for it, m.
pub(super) const MOST_SHIFT: f32 = 0.01;

/// Frames for which a planted foot is planned beyond its stance.
const EDGE: f32 = 3.0;

/// Dorsiflexion of the ankle in mid swing, radians.
const SWING_ANKLE: f32 = 0.06;
/// Height that the sole keeps above the ground in mid swing, in leg lengths.
const CLEARANCE: f32 = 0.012;
const LEAST_CLEARANCE: f32 = 0.012; // m
/// How far a foot is turned towards flat for it, radians.
const MOST_PULL: f32 = 0.3;

/// The leg of a gait at one phase, as long as the avatar's leg is with this bend of the knee.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leg {
    /// The avatar's hip joint, m.
    pub(super) hip: Vec3,
    /// From there to the ankle, m.
    pub(super) to_ankle: Vec3,
}

/// The plan of one foot, by frame of the clip.
#[derive(Debug, Clone)]
pub(super) struct FootPlan<'a> {
    pub(super) legs: Vec<Leg>,
    pub(super) stance: Stance,
    /// Avatar metres per cycle.
    pub(super) travel: f32,
    /// Lengths of the avatar's thigh and shin, m.
    pub(super) bones: [f32; 2],
    pub(super) sole: &'a Sole,
    /// Where the ankle of the flat foot would be at the strike, m.
    pub(super) at_strike: Vec3,
    /// Pitch of the planted foot, radians; frames in swing hold those of its ends.
    pub(super) pitch: Vec<f32>,
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

impl std::ops::Mul<f32> for Leg {
    type Output = Self;

    fn mul(self, share: f32) -> Self {
        Self { hip: self.hip * share, to_ankle: self.to_ankle * share }
    }
}

impl std::ops::Add for Leg {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { hip: self.hip + other.hip, to_ankle: self.to_ankle + other.to_ankle }
    }
}

impl Leg {
    fn ankle(self) -> Vec3 {
        self.hip + self.to_ankle
    }
}

impl<'a> FootPlan<'a> {
    /// The foot stands where the gait's ankle is, on average, while it is flat.
    pub(super) fn new(legs: Vec<Leg>, stance: Stance, travel: f32, bones: [f32; 2], sole: &'a Sole) -> Self {
        let mut plan = Self { legs, stance, travel, bones, sole, at_strike: Vec3::ZERO, pitch: Vec::new() };
        let places: Vec<Vec3> =
            plan.carrying().map(|(frame, u)| plan.legs[frame].ankle() + Vec3::Z * travel * u).collect();
        let middle = places.iter().sum::<Vec3>() / places.len().max(1) as f32;
        plan.at_strike = middle.with_y(-sole.lowest(0.0));
        plan
    }

    /// Frames in which the foot is flat and carries the body, and the cycles since its strike.
    fn carrying(&self) -> impl Iterator<Item = (usize, f32)> {
        let count = self.legs.len() as f32;
        let since = move |frame: usize| self.stance.since(frame as f32 / count);
        (0..self.legs.len())
            .map(move |frame| (frame, since(frame)))
            .filter(|(_, u)| CARRIES.contains(&(u / self.stance.share)))
    }

    /// By frame, how much higher than planned the hip is when the leg carries it as in the gait, m.
    pub(super) fn carried(&self) -> impl Iterator<Item = (usize, f32)> {
        self.carrying().map(|(frame, u)| {
            let leg = self.legs[frame];
            let away = self.planted(u, self.usual(u)) - leg.hip;
            let flat = away.x * away.x + away.z * away.z;
            let up = (leg.to_ankle.length_squared() - flat).max(0.0).sqrt();
            (frame, away.y + up)
        })
    }

    fn leg_length(&self) -> f32 {
        self.bones[0] + self.bones[1]
    }

    /// How far a foot is toe up when the ankle is straight, radians: the way from hip to ankle, less what the knee stands
    /// before it.
    fn shank_pitch(&self, to_ankle: Vec3) -> f32 {
        let [thigh, shin] = self.bones;
        let length = to_ankle.length();
        let cosine = (shin * shin + length * length - thigh * thigh) / (2.0 * shin * length).max(1e-6);
        libm::atan2f(to_ankle.z, -to_ankle.y) - libm::acosf(cosine.clamp(-1.0, 1.0))
    }

    /// Pitch of a usual foot `u` cycles after its strike.
    fn usual(&self, u: f32) -> f32 {
        let vigour = (self.travel / self.leg_length() / USUAL_STRIDE).clamp(0.0, 1.25);
        let at = (u / self.stance.share).clamp(0.0, 1.0) * (USUAL.len() - 1) as f32;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 8")]
        let first = (at as usize).min(USUAL.len() - 2);
        let t = at - first as f32;
        vigour * (USUAL[first] * (1.0 - t) + USUAL[first + 1] * t)
    }

    /// The ankle of the planted foot `u` cycles after its strike, at a pitch.
    fn planted(&self, u: f32, pitch: f32) -> Vec3 {
        let flat = self.at_strike - Vec3::Z * self.travel * u;
        let pivot = if pitch > 0.0 { self.sole.heel } else { self.sole.ball };
        let lifted = if pitch < TOES_BENT {
            let (sine, cosine) = libm::sincosf(TOES_BENT - pitch);
            Vec3::new(0.0, sine, 1.0 - cosine) * self.sole.toes
        } else {
            Vec3::ZERO
        };
        // The height follows from the sole's outline, so that curved shoes neither sink nor float.
        (flat + pivot - pitched(pitch) * pivot).with_y(-self.sole.lowest(pitch)) + lifted
    }

    /// The pitch at which the planted foot leaves the leg as long as it is in the gait, `u` cycles after the strike; and how
    /// much too long or too short the leg still is, m.
    fn fitting(&self, u: f32) -> (f32, f32) {
        let leg = between(&self.legs, self.stance.strike + u);
        let wanted = leg.to_ankle.length();
        let excess = |pitch: f32| self.planted(u, pitch).distance(leg.hip) - wanted;
        let most = self.most_pitch(u);
        let (mut low, mut high) = (0.0, most);
        for _ in 0..14 {
            let middle = 0.5 * (low + high);
            if excess(middle) > 0.0 { low = middle } else { high = middle }
        }
        (low, excess(low))
    }

    /// The greatest pitch, up or down: less and less towards the time at which the foot turns from its heel to its ball.
    fn most_pitch(&self, u: f32) -> f32 {
        let t = u / self.stance.share;
        if t < TURNS_OVER {
            MOST_UP * (1.0 - t / TURNS_OVER).min(1.0)
        } else {
            MOST_DOWN * ((t - TURNS_OVER) / TURNS_OVER).min(1.0)
        }
    }

    /// Sets the foot down where the legs keep their lengths best: within 6 % of a leg, to 0.8 %.
    pub(super) fn settle(&mut self) {
        const STEPS: [f32; 3] = [0.032, 0.016, 0.008]; // leg lengths
        let mut best = (self.at_strike.z, self.misfit());
        for step in STEPS {
            let from = best.0;
            for side in [-1.0, 1.0] {
                self.at_strike.z = from + side * step * self.leg_length();
                let misfit = self.misfit();
                if misfit < best.1 {
                    best = (self.at_strike.z, misfit);
                }
            }
        }
        self.at_strike.z = best.0;
    }

    /// Finds the pitches of the foot while it is planted. It leaves the ground early where no pitch lets it stay there.
    pub(super) fn roll(&mut self) {
        let count = self.legs.len() as f32;
        let earliest = self.stance.share.min(0.53);
        let frames = (0..self.legs.len()).map(|frame| earliest + frame as f32 / count);
        let lifted = |u: &f32| *u < self.stance.share && self.fitting(*u).1 > 0.002;
        self.stance.share =
            frames.take_while(|u| *u < self.stance.share).find(lifted).unwrap_or(self.stance.share);
        let edge = EDGE / count;
        let of = |frame: usize| {
            let u = self.stance.since(frame as f32 / count);
            let after = u.min(self.stance.share + edge);
            self.fitting(if u > 1.0 - edge { u - 1.0 } else { after }).0
        };
        self.pitch = (0..self.legs.len()).map(of).collect();
    }

    /// How badly the planted foot fits: mean squares of what the leg's length is off, and of how unusual the pitch is.
    fn misfit(&self) -> f32 {
        const RADIAN: f32 = 0.02; // as bad as so many metres
        let count = self.legs.len() as f32;
        (0..self.legs.len())
            .map(|frame| self.stance.since(frame as f32 / count))
            .filter(|u| *u <= self.stance.share)
            .map(|u| {
                let (pitch, excess) = self.fitting(u);
                let unusual = RADIAN * (pitch - self.usual(u));
                excess * excess + unusual * unusual
            })
            .sum()
    }

    /// By how much the planted leg has less room than it has in the gait, m; 0 in swing.
    pub(super) fn short(&self, frame: usize) -> f32 {
        let u = self.stance.since(frame as f32 / self.legs.len() as f32);
        if u > self.stance.share { 0.0 } else { (-self.fitting(u).1).max(0.0) }
    }

    fn standing(&self, u: f32) -> FootTarget {
        let pitch = between(&self.pitch, self.stance.strike + u);
        FootTarget { ankle: self.planted(u, pitch), pitch, planted: true }
    }

    fn swinging(&self, u: f32) -> FootTarget {
        const STEP: f32 = 1.0 / 256.0;
        let (share, strike) = (self.stance.share, self.stance.strike);
        let length = 1.0 - share;
        let t = (u - share) / length;
        // how far the planted foot is from the gait's, and how that changes within the stance
        let off = |u: f32| self.standing(u).ankle - between(&self.legs, strike + u).ankle();
        let [leave, land] = [off(share), off(0.0)];
        let slopes = [(leave - off(share - STEP)) / STEP, (off(STEP) - land) / STEP];
        let correction = hermite(leave, slopes[0] * length, land, slopes[1] * length, t);
        let leg = between(&self.legs, strike + u);
        let free = leg.to_ankle + correction;
        // it turns the leg; its length is the gait's, up to what the ends need
        let stretch = |u: f32| {
            let leg = between(&self.legs, strike + u);
            self.standing(u).ankle.distance(leg.hip) - leg.to_ankle.length()
        };
        let stretched = hermite(stretch(share), 0.0, stretch(0.0), 0.0, t);
        let to_ankle = free.normalize_or(Vec3::NEG_Y) * (leg.to_ankle.length() + stretched);
        let ankle = leg.hip + to_ankle;
        let free = self.swing_pitch(t, to_ankle);
        let arch = libm::powf(libm::sinf(PI * t).max(0.0), 0.35);
        let wanted = (CLEARANCE * self.leg_length()).max(LEAST_CLEARANCE) * arch;
        let clear = |pitch: f32| {
            let height = ankle.y + self.sole.lowest(pitch);
            // the tips of the toes reach half the way down
            let tips = (height + self.sole.toes * libm::sinf(pitch)).max(0.5 * height);
            if pitch < 0.0 { tips } else { height }
        };
        // first it is turned towards flat, then it is lifted
        let pull = (-free).clamp(-MOST_PULL, MOST_PULL);
        let (mut low, mut high) = (0.0, if clear(free) < wanted { 1.0 } else { 0.0 });
        for _ in 0..8 {
            let middle = 0.5 * (low + high);
            if clear(free + middle * pull) < wanted { low = middle } else { high = middle }
        }
        let pitch = free + high * pull;
        let missing = (wanted - clear(pitch)).max(0.0);
        let ankle = ankle + Vec3::Y * missing;
        FootTarget { ankle, pitch, planted: false }
    }

    /// The pitch of a swinging foot: the ankle goes from push-off to its middle position and on to that of the strike.
    fn swing_pitch(&self, t: f32, to_ankle: Vec3) -> f32 {
        let (share, strike) = (self.stance.share, self.stance.strike);
        let dorsiflexion = |u: f32| {
            let leg = between(&self.legs, strike + u);
            let foot = self.standing(u);
            foot.pitch - self.shank_pitch(foot.ankle - leg.hip)
        };
        let ends = [dorsiflexion(share), dorsiflexion(0.0)];
        let half = |from: f32, to: f32, t: f32| from + (to - from) * t * t * (3.0 - 2.0 * t);
        let ankle = if t < 0.5 {
            half(ends[0], SWING_ANKLE, 2.0 * t)
        } else {
            half(SWING_ANKLE, ends[1], 2.0 * t - 1.0)
        };
        ankle + self.shank_pitch(to_ankle)
    }

    /// Where the foot is at `phase`.
    pub(super) fn at(&self, phase: f32) -> FootTarget {
        let u = self.stance.since(phase);
        if u <= self.stance.share { self.standing(u) } else { self.swinging(u) }
    }
}

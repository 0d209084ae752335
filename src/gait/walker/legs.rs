//! Feet, then legs: the path of the ankle over one stride, the height of the pelvis it allows, and the knee.

use super::style::WalkerStyle;
use super::{Pelvis, Turn};
use glam::DVec3;

/// Longest hip-to-ankle distance, as a share of the straight leg: the knee keeps about 11 degrees of flexion.
const LONGEST: f64 = 0.995;

/// The same around toe-off, when knees are folding already: about 22 degrees. (A leg that is nearly straight there
/// would have to fold within a frame.)
const LONGEST_PUSHING: f64 = 0.982;

/// Phases, from the foot's strike, between which [`LONGEST_PUSHING`] holds.
const PUSHING: (f64, f64) = (0.54, 0.75);

/// Share of the stride after which the heel leaves the ground.
pub(super) const HEEL_OFF: f64 = 0.36;

/// How much the foot's roll over its ball speeds up towards toe-off.
const PUSH_OFF: f64 = 1.0;

/// Share of the swing after which the ankle is highest (the knee folds early, the foot then reaches forward).
const LIFT_PEAK: f64 = 0.30;

/// Ankle ahead of the pelvis at foot strike, as a share of the travel per stride. Below a quarter, because the
/// rear foot rolls over its ball and so ends further back than the front one starts.
const STRIKE_AHEAD: f64 = 0.215;

/// Braking of the foot just before it strikes, in travels per stride per phase^2: it reaches
/// `1 / (2 BRAKING)` of the travel beyond its strike and comes back with the ground.
const BRAKING: f64 = 30.0;

/// Acceleration of the foot over the ground just after toe-off, in travels per stride per phase^2, beyond that of
/// rolling: the hip flexors pull it forward, so that it passes the other foot before the middle of the swing.
const PULL: f64 = 20.0;

/// Braking of the foot's fall, in lifts per phase^2.
const FALL_BRAKING: f64 = 30.0;

/// Phases at which the pelvis height is bounded; finer than the frames, so that no frame lies between two bounds.
const BOUND_STEPS: u32 = 256;

/// Position, velocity and acceleration along one axis at one instant, per unit of phase.
#[derive(Clone, Copy)]
struct Key {
    phase: f64,
    at: f64,
    velocity: f64,
    acceleration: f64,
}

/// The path of one ankle: planted, rolling over the ball of the foot, swinging.
pub(super) struct FootPath {
    /// Ankle ahead of the pelvis at foot strike, m.
    strike: f64,
    /// Ground passed per stride, m.
    travel: f64,
    duty: f64,
    heel_rise: f64,
    /// Ankle behind and above the ball of the foot, m.
    behind: f64,
    above: f64,
    lift: f64,
    landing: f64,
}

impl FootPath {
    pub(super) fn new(style: &WalkerStyle) -> Self {
        let travel = style.speed * style.cycle_time;
        Self {
            strike: STRIKE_AHEAD * travel,
            travel,
            duty: style.duty,
            heel_rise: style.heel_rise,
            behind: style.body.ball_ahead(),
            above: style.body.ankle_height(),
            lift: style.foot_lift,
            landing: style.stomp,
        }
    }

    /// Ankle of `side` (+1 left, -1 right) at `phase` of the cycle, model space, m.
    pub(super) fn ankle(&self, style: &WalkerStyle, side: f64, phase: f64) -> DVec3 {
        let own = if side > 0.0 { phase } else { (phase + 0.5).rem_euclid(1.0) };
        let (z, y) = self.sagittal(own);
        DVec3::new(side * 0.5 * style.step_width, y, z)
    }

    /// (z, y) at the foot's own phase: 0 is its strike.
    fn sagittal(&self, phase: f64) -> (f64, f64) {
        if phase < HEEL_OFF {
            return (self.strike - self.travel * phase, 0.0);
        }
        if phase < self.duty {
            let (z, y) = self.rolled(phase);
            return (z.at, y.at);
        }
        let (z0, y0) = self.rolled(self.duty);
        // Interpolated on the passing ground, where the foot ends at rest, then moved back to the walker.
        let from = Key {
            at: z0.at + self.travel * self.duty,
            velocity: z0.velocity + self.travel,
            acceleration: z0.acceleration + PULL * self.travel,
            ..z0
        };
        let strike = Key {
            phase: 1.0,
            at: self.strike + self.travel,
            velocity: 0.0,
            acceleration: -BRAKING * self.travel,
        };
        let z = quintic(from, strike, phase) - self.travel * phase;
        (z, self.swing_height(y0, phase))
    }

    /// The foot turning over its ball, which stands still on the ground: (z, y) with derivatives.
    fn rolled(&self, phase: f64) -> (Key, Key) {
        let span = self.duty - HEEL_OFF;
        let u = (phase - HEEL_OFF) / span;
        // theta = rise (u^2 + c u^3) / (1 + c): the heel leaves the ground without a jerk and is fastest at toe-off.
        let rise = self.heel_rise / (1.0 + PUSH_OFF);
        let turn = Turn::new(rise * u * u * (1.0 + PUSH_OFF * u));
        let rate = rise * u * (2.0 + 3.0 * PUSH_OFF * u) / span;
        let rate_of_rate = rise * (2.0 + 6.0 * PUSH_OFF * u) / (span * span);
        let ahead = self.above * turn.sin - self.behind * turn.cos;
        let up = self.above * turn.cos + self.behind * turn.sin;
        let z = Key {
            phase,
            at: self.strike + self.behind - self.travel * phase + ahead,
            velocity: up * rate - self.travel,
            acceleration: up * rate_of_rate - ahead * rate * rate,
        };
        let y = Key {
            phase,
            at: up - self.above,
            velocity: -ahead * rate,
            acceleration: -ahead * rate_of_rate - up * rate * rate,
        };
        (z, y)
    }

    fn swing_height(&self, toe_off: Key, phase: f64) -> f64 {
        let swing = 1.0 - self.duty;
        let peak_phase = self.duty + LIFT_PEAK * swing;
        let peak = Key {
            phase: peak_phase,
            at: self.lift,
            velocity: 0.0,
            acceleration: -8.0 * self.lift / (swing * swing),
        };
        let strike = Key { phase: 1.0, at: 0.0, velocity: 0.0, acceleration: FALL_BRAKING * self.lift };
        if phase < peak_phase {
            return quintic(toe_off, peak, phase);
        }
        // A stomp holds the foot up and then sets it down hard: a bump late in the swing that ends at rest.
        let u = (phase - peak_phase) / (1.0 - peak_phase);
        let bump = 27.0 / 4.0 * u * u * (1.0 - u);
        quintic(peak, strike, phase) + self.landing * bump * bump
    }
}

/// The fifth-degree polynomial through two keys with their velocities and accelerations.
fn quintic(from: Key, to: Key, phase: f64) -> f64 {
    let span = to.phase - from.phase;
    let u = (phase - from.phase) / span;
    let (v0, v1) = (from.velocity * span, to.velocity * span);
    let (a0, a1) = (from.acceleration * span * span, to.acceleration * span * span);
    let rise = to.at - from.at;
    let c3 = 10.0 * rise - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
    let c4 = -15.0 * rise + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
    let c5 = 6.0 * rise - 3.0 * v0 - 3.0 * v1 - 0.5 * a0 + 0.5 * a1;
    from.at + u * (v0 + u * (0.5 * a0 + u * (c3 + u * (c4 + u * c5))))
}

/// The largest mean height of the root joint for which neither leg is ever stretched beyond [`LONGEST`], less the
/// crouch; `None` if some step is out of reach.
pub(super) fn pelvis_height(style: &WalkerStyle, feet: &FootPath) -> Option<f64> {
    let mut height = f64::INFINITY;
    for step in 0..BOUND_STEPS {
        let phase = f64::from(step) / f64::from(BOUND_STEPS);
        let pelvis = Pelvis::at(style, phase, 0.0);
        for side in [1.0, -1.0] {
            let own = if side > 0.0 { phase } else { (phase + 0.5).rem_euclid(1.0) };
            let share = if (PUSHING.0..PUSHING.1).contains(&own) { LONGEST_PUSHING } else { LONGEST };
            let longest = share * style.body.leg();
            let ankle = feet.ankle(style, side, phase);
            let hip = pelvis.hip(&style.body, side);
            let (x, z) = (hip.x - ankle.x, hip.z - ankle.z);
            let rise_squared = longest * longest - x * x - z * z;
            if rise_squared < 0.25 * longest * longest {
                return None;
            }
            // hip.y is relative to a mean height of 0 and has the bob in it already.
            height = height.min(ankle.y + rise_squared.sqrt() - hip.y);
        }
    }
    Some(height - style.crouch)
}

/// The knee between hip and ankle, bending forwards and a little outwards.
pub(super) fn knee(style: &WalkerStyle, side: f64, hip: DVec3, ankle: DVec3) -> DVec3 {
    let (thigh, shank) = (style.body.thigh(), style.body.shank());
    let span = ankle - hip;
    let distance = span.length();
    let along = span / distance;
    let reach = (thigh * thigh - shank * shank + distance * distance) / (2.0 * distance);
    let bend = (thigh * thigh - reach * reach).max(0.0).sqrt();
    let forward = DVec3::new(side * style.toe_out, 0.0, 1.0);
    let out = (forward - along * forward.dot(along)).normalize();
    hip + along * reach + out * bend
}

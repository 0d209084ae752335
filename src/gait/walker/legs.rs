//! Legs: planted feet that roll over heel and ball, a pelvis that they carry, and swings by angles of thigh and knee.
//!
//! In stance the foot decides: its ankle goes where heel, sole and ball take it on ground that passes at the style's
//! speed, and the knee bends as far as the pelvis asks for. In swing the angles decide, and a correction that is gone in
//! between leads from the end of the stance to its beginning.

use super::style::WalkerStyle;
use super::{Pelvis, Turn, USUAL_STRIDE, cos, sin};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Longest hip-to-ankle distance, as a share of the straight leg: the knee keeps 6 degrees of flexion.
const LONGEST: f64 = 0.9982;

/// Values of an angle by twentieths of the own stride, from the strike on, degrees.
type Values = [f64; 20];

/// Angles of people's legs at a usual speed: ours, by key values of Perry and Burnfield ("Gait Analysis", 2010) and Winter
/// ("The Biomechanics and Motor Control of Human Gait", 1991).
#[rustfmt::skip]
const THIGH: Values = [
    23.5, 23.0, 21.0, 17.0, 12.0, 6.5, 1.0, -4.5, -9.0, -13.0,
    -15.0, -13.5, -8.0, 1.5, 12.0, 20.0, 24.5, 26.5, 26.0, 24.5,
];
#[rustfmt::skip]
const KNEE: Values = [
    6.0, 13.0, 19.0, 20.0, 17.5, 13.5, 10.5, 9.0, 9.0, 11.5,
    16.5, 26.0, 41.0, 56.0, 64.0, 63.0, 54.0, 37.0, 18.0, 6.5,
];
/// Harmonics in which they are held.
const HARMONICS: usize = 6;

/// Share of the stance in the stride for which the angles hold.
const USUAL_DUTY: f64 = 0.60;

/// Pitch of the foot at the strike of a usual stride, radians, and the phase at which it is flat.
const STRIKE_PITCH: f64 = 0.31;
const FLAT: f64 = 0.1;

/// Share of the stride after which the heel leaves the ground.
pub(super) const HEEL_OFF: f64 = 0.28;

/// How much the foot's roll over its ball speeds up towards toe-off.
const PUSH_OFF: f64 = 3.0;

/// How much farther than usual the heel rises, as a share of the style's rise at toe-off; so late after the foot is flat.
const SPARE_RISE: f64 = 0.25;
const RISES: f64 = 0.15;

/// Pitch down to which the ball of the foot stays on the ground, radians; beyond it the foot rolls over the tips of the toes.
const TOES_BENT: f64 = 0.75;

/// Ankle of the flat foot ahead of the pelvis at foot strike, as a share of the travel per stride. Below a quarter, because
/// the rear foot rolls over its ball and so ends further back than the front one starts.
const STRIKE_AHEAD: f64 = 0.24;

/// Ankle height at the top of the swing for which the knee's angles hold, m.
const USUAL_LIFT: f64 = 0.15;

/// Phase at which a stomping foot begins to be held up.
const HELD: f64 = 0.72;

/// Phases of half a stride at which the leading leg says how high it carries the pelvis.
const CARRIED: u32 = 32;

/// Half the height through which the pelvis of a usual walk goes up and down, m.
const USUAL_BOUNCE: f64 = 0.018;

/// Longest swinging leg, as a share of the straight one. How near to it a leg straightens more slowly, and how near to the
/// ground its foot comes down so, m.
const STRAIGHT: f64 = 0.9990;
const STRAIGHTENS: f64 = 0.001;
const TOUCHES: f64 = 0.004;

/// Share of the slopes of the leg's length that a swing takes over from the stance: with all of them the knee locks before
/// the strike, with none it jerks at it.
const LENGTH_SLOPE: f64 = 0.35;

/// Phase over which slopes are taken.
const STEP: f64 = 1.0 / 4096.0;

/// An angle over the stride: a mean and harmonics, radians.
#[derive(Debug, Clone, Copy)]
struct Curve {
    mean: f64,
    /// Amplitudes of cosine and sine.
    waves: [[f64; 2]; HARMONICS],
}

impl Curve {
    fn through(degrees: &Values) -> Self {
        let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
            (0_u32..).zip(degrees).map(|(k, value)| value.to_radians() * of(f64::from(k) / 20.0)).sum()
        };
        let mut harmonic = 0.0;
        let waves = std::array::from_fn(|_| {
            harmonic += 1.0;
            [sum(&|at| cos(TAU * harmonic * at)) / 10.0, sum(&|at| sin(TAU * harmonic * at)) / 10.0]
        });
        Self { mean: sum(&|_| 0.05), waves }
    }

    fn at(&self, phase: f64) -> f64 {
        let waves = (1_u32..).zip(self.waves).map(|(harmonic, [cosine, sine])| {
            let turn = Turn::new(TAU * f64::from(harmonic) * phase);
            cosine * turn.cos + sine * turn.sin
        });
        self.mean + waves.sum::<f64>()
    }
}

/// How high the pelvis is carried: a mean, and three harmonics of a step, m.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lift {
    mean: f64,
    /// Amplitudes of cosine and sine.
    waves: [[f64; 2]; 3],
}

impl Lift {
    /// At a phase of the stride.
    pub(super) fn at(&self, phase: f64) -> f64 {
        let waves = [2.0, 4.0, 6.0].into_iter().zip(self.waves).map(|(harmonic, [cosine, sine])| {
            let turn = Turn::new(TAU * harmonic * phase);
            cosine * turn.cos + sine * turn.sin
        });
        self.mean + waves.sum::<f64>()
    }
}

/// A place in the sagittal plane, m: ahead and up.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    ahead: f64,
    up: f64,
}

impl Place {
    /// From a joint to it, in the sagittal plane.
    fn from(self, joint: DVec3) -> DVec2 {
        DVec2::new(self.ahead - joint.z, self.up - joint.y)
    }
}

/// The path of the ankles.
pub(super) struct FootPath {
    thigh: Curve,
    knee: Curve,
    /// Ankle of the flat foot ahead of the pelvis at foot strike, m.
    strike: f64,
    /// Ground passed per stride, m.
    travel: f64,
    /// The same against [`USUAL_STRIDE`].
    vigour: f64,
    duty: f64,
    heel_rise: f64,
    flexion: f64,
    landing: f64,
    /// Height of the root joint.
    pub(super) lift: Lift,
}

impl FootPath {
    /// `None` if some step is out of reach.
    pub(super) fn new(style: &WalkerStyle) -> Option<Self> {
        let travel = style.speed * style.cycle_time;
        let vigour = travel / (USUAL_STRIDE * style.body.leg());
        let mut path = Self {
            thigh: Curve::through(&THIGH),
            knee: Curve::through(&KNEE),
            strike: STRIKE_AHEAD * travel,
            travel,
            vigour,
            duty: style.duty,
            heel_rise: style.heel_rise,
            flexion: style.knee_flexion,
            landing: style.stomp,
            lift: Lift::default(),
        };
        path.lift = path.carried(style)?;
        Some(path)
    }

    /// Ankle of `side` (+1 left, -1 right) at `phase` of the cycle, model space, m.
    pub(super) fn ankle(&self, style: &WalkerStyle, side: f64, phase: f64) -> DVec3 {
        let own = if side > 0.0 { phase } else { (phase + 0.5).rem_euclid(1.0) };
        let place =
            if own < self.duty { self.planted(style, side, own) } else { self.swinging(style, side, own) };
        DVec3::new(side * 0.5 * style.step_width, place.up, place.ahead)
    }

    /// The ankle while the foot stands, at its own phase: 0 is its strike.
    fn planted(&self, style: &WalkerStyle, side: f64, own: f64) -> Place {
        if own < FLAT {
            return self.rolled(style, own, self.usual_pitch(own));
        }
        // the heel rises as far as the knee asks for
        let hip = self.hip(style, side, own);
        let wanted = self.length(style, own);
        let is_long = |rise: f64| {
            let ankle = self.rolled(style, own, -rise);
            let (x, up, ahead) =
                (hip.x - side * 0.5 * style.step_width, hip.y - ankle.up, hip.z - ankle.ahead);
            x * x + up * up + ahead * ahead > wanted * wanted
        };
        let most = (1.0 + SPARE_RISE) * self.heel_rise * ((own - FLAT) / RISES).min(1.0);
        let (mut low, mut high) = (0.0, most.min(SPARE_RISE * self.heel_rise - self.usual_pitch(own)));
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if is_long(middle) { low = middle } else { high = middle }
        }
        self.rolled(style, own, -low)
    }

    /// Pitch of a usual foot while it stands, radians, toes up.
    fn usual_pitch(&self, own: f64) -> f64 {
        if own < FLAT {
            let left = 1.0 - own / FLAT;
            return STRIKE_PITCH * self.vigour.min(1.3) * left * left;
        }
        // the heel leaves the ground without a jerk and is fastest at toe-off
        let u = ((own - HEEL_OFF) / (self.duty - HEEL_OFF)).max(0.0);
        -self.heel_rise / (1.0 + PUSH_OFF) * u * u * (1.0 + PUSH_OFF * u)
    }

    /// The ankle over a foot that is pitched (toes up) about its heel, or about its ball.
    fn rolled(&self, style: &WalkerStyle, own: f64, pitch: f64) -> Place {
        let body = &style.body;
        let behind = if pitch > 0.0 { body.heel_behind() } else { -body.ball_ahead() };
        let (turn, above) = (Turn::new(pitch), body.ankle_height());
        let beyond = Turn::new((-pitch - TOES_BENT).max(0.0));
        let ahead = behind * turn.cos - above * turn.sin + body.toes() * (1.0 - beyond.cos);
        let up = behind * turn.sin + above * turn.cos + body.toes() * beyond.sin;
        Place { ahead: self.strike - self.travel * own - behind + ahead, up: up - above }
    }

    /// The phase of a usual stride that corresponds to one of this stride: its foot leaves the ground when usual feet do.
    fn usual_phase(&self, own: f64) -> f64 {
        if own < self.duty {
            own * USUAL_DUTY / self.duty
        } else {
            USUAL_DUTY + (own - self.duty) * (1.0 - USUAL_DUTY) / (1.0 - self.duty)
        }
    }

    /// Flexion of the knee. It gives way less under the load of a short stride.
    fn knee_at(&self, own: f64) -> f64 {
        let phase = self.usual_phase(own);
        let [loaded, free] = [0.5 + 0.5 * self.vigour, 0.8 + 0.2 * self.vigour];
        let t = ((phase - 0.35) / 0.3).clamp(0.0, 1.0);
        (self.knee.at(phase) * (loaded + (free - loaded) * t) + self.flexion).max(0.0)
    }

    /// The leg from hip to ankle by the angle of its knee, m.
    fn length(&self, style: &WalkerStyle, own: f64) -> f64 {
        let (upper, lower) = (style.body.thigh(), style.body.shank());
        let squared = upper * upper + lower * lower + 2.0 * upper * lower * cos(self.knee_at(own));
        squared.sqrt().min(LONGEST * style.body.leg())
    }

    /// The ankle of a swinging foot.
    fn swinging(&self, style: &WalkerStyle, side: f64, own: f64) -> Place {
        let hip = self.hip(style, side, own);
        let apart = |at: f64| {
            let (planted, free) = (self.planted(style, side, at), self.free(style, side, at));
            let hip = self.hip(style, side, at);
            let stretched = planted.from(hip).length() - free.from(hip).length();
            [planted.ahead - free.ahead, planted.up - free.up, stretched]
        };
        // the strike is at 1 as at 0, where the foot has just come down
        let [leaves, before, lands, after] = [self.duty, self.duty - STEP, 0.0, STEP].map(apart);
        let length = 1.0 - self.duty;
        let t = (own - self.duty) / length;
        let [ahead, up, stretched] = [(0, 1.0), (1, 1.0), (2, LENGTH_SLOPE)].map(|(part, share)| {
            let [leaving, landing] = [leaves[part] - before[part], after[part] - lands[part]]
                .map(|rise| share * rise / STEP * length);
            hermite(leaves[part], leaving, lands[part], landing, t)
        });
        let free = self.free(style, side, own);
        let turned = Place { ahead: free.ahead + ahead, up: free.up + up };
        // The correction turns the leg. Its length stays the knee's, but for what the ends need.
        let wanted = soft_min(free.from(hip).length() + stretched, STRAIGHT * style.body.leg(), STRAIGHTENS);
        let leg = turned.from(hip) * (wanted / turned.from(hip).length());
        // A stomp holds the foot up and then sets it down hard: a bump late in the swing that ends at rest.
        let u = ((own - HELD) / (1.0 - HELD)).max(0.0);
        let bump = 27.0 / 4.0 * u * u * (1.0 - u);
        let up = -soft_min(-hip.y - leg.y, 0.0, TOUCHES);
        Place { ahead: hip.z + leg.x, up: up + self.landing * bump * bump }
    }

    /// The hip of `side` at its own phase.
    fn hip(&self, style: &WalkerStyle, side: f64, own: f64) -> DVec3 {
        let phase = if side > 0.0 { own } else { own + 0.5 };
        Pelvis::at(style, phase, &self.lift).hip(&style.body, side)
    }

    /// The ankle by the angles of thigh and knee, from the hip that `side` has at its own phase.
    fn free(&self, style: &WalkerStyle, side: f64, own: f64) -> Place {
        let hip = self.hip(style, side, own);
        let middle = self.thigh.mean;
        let thigh = middle + (self.thigh.at(self.usual_phase(own)) - middle) * self.vigour.min(1.3);
        let lifted = 1.0 + 0.6 * (style.foot_lift / USUAL_LIFT - 1.0);
        let shank = thigh - self.knee_at(own) * lifted;
        let (thigh, shank) = (Turn::new(thigh), Turn::new(shank));
        let (upper, lower) = (style.body.thigh(), style.body.shank());
        Place {
            ahead: hip.z + upper * thigh.sin + lower * shank.sin,
            up: hip.y - upper * thigh.cos - lower * shank.cos,
        }
    }

    /// The height at which the leading leg, from its strike to that of the other, has the usual knee, less the crouch.
    fn carried(&self, style: &WalkerStyle) -> Option<Lift> {
        let (count, half) = (f64::from(CARRIED), 0.5 / f64::from(CARRIED));
        let mut lift = Lift::default();
        let mut reached = Vec::new();
        for step in 0..CARRIED {
            let own = f64::from(step) * half;
            let hip = Pelvis::at(style, own, &Lift::default()).hip(&style.body, 1.0);
            let ankle = self.rolled(style, own, self.usual_pitch(own));
            let (x, z, length) =
                (hip.x - 0.5 * style.step_width, hip.z - ankle.ahead, self.length(style, own));
            let squared = length * length - x * x - z * z;
            if squared < 0.25 * length * length {
                return None;
            }
            let height = ankle.up + squared.sqrt() - hip.y;
            let longest = LONGEST * style.body.leg();
            reached.push((own, ankle.up + (longest * longest - x * x - z * z).sqrt() - hip.y));
            lift.mean += height / count;
            for (harmonic, [cosine, sine]) in [2.0, 4.0, 6.0].into_iter().zip(&mut lift.waves) {
                let turn = Turn::new(TAU * harmonic * own);
                *cosine += 2.0 * height * turn.cos / count;
                *sine += 2.0 * height * turn.sin / count;
            }
        }
        // longer strides bob more by themselves, and bent knees at the strike would have to pay for any more
        let share =
            1.0 + (style.bounce / USUAL_BOUNCE - 1.0) / (self.vigour * self.vigour * self.vigour).max(1.0);
        lift.waves.as_flattened_mut().iter_mut().for_each(|wave| *wave *= share);
        // never so high that the leading leg would have to be longer than it can be
        let above = |(own, highest): &(f64, f64)| lift.at(*own) - highest;
        lift.mean -= reached.iter().map(above).fold(0.0, f64::max);
        lift.mean -= style.crouch;
        Some(lift)
    }
}

/// The smaller of two, with a corner that is rounded over about `round`.
fn soft_min(a: f64, b: f64, round: f64) -> f64 {
    0.5 * (a + b - ((a - b) * (a - b) + round * round).sqrt())
}

/// Cubic from `a` with slope `m0` at t = 0 to `b` with slope `m1` at t = 1.
fn hermite(a: f64, m0: f64, b: f64, m1: f64, t: f64) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    a * (2.0 * t3 - 3.0 * t2 + 1.0) + m0 * (t3 - 2.0 * t2 + t) + b * (3.0 * t2 - 2.0 * t3) + m1 * (t3 - t2)
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

//! Twin of `shaders/shared/footing.wgsl`: feet stay where they are while they are on the ground.

use super::exact::{dot2, greater, lesser, sin_cos, unit_f32, unless_faint, wrap};
use super::quaternion::limit;
use super::standing::{eased, left_ahead, own_draw, stance_of};
use crate::kernels::layout::{Body, Stance};
use crate::kernels::shared::footing::{
    FIRST_FOOT, HALF, LEAST_STRIDE, LEFT_LEAVES, LEG, MOST_APART, MOST_TURNED, NEARLY_ALL, ON_GROUND,
    RIGHT_LEAVES, SETTLED, SETTLED_TURN, STEP_AT, STEP_AT_TURN,
};

/// How an agent walks at one moment, as far as its feet are concerned.
#[derive(Debug)]
pub struct Going {
    phase: u32,
    /// By how much it walks, m.
    stride: f32,
    /// Where the left foot comes down, m; the right one does so on the other side.
    aside: f32,
    /// How far ahead the left foot comes down, m.
    left: f32,
    right: f32,
    /// Sine and cosine.
    heading: [f32; 2],
}

/// What an agent's stance and heading, rad, say.
pub fn going_of(agent: u32, own: &Stance, heading: f32, body: &Body) -> Going {
    let stride = own.stride * own.walk_weight;
    let share = stride / greater(body.stride_at(body.preferred_speed), LEAST_STRIDE);
    let missing = 1.0 - share;
    let ([down_aside, down_ahead], [stands_aside, stands_ahead]) =
        (Body::foot_at(body.foot_down), Body::foot_at(body.foot_stands));
    let left = left_ahead(stance_of(agent)) * LEG;
    Going {
        phase: own.phase,
        stride,
        aside: down_aside + (stands_aside - down_aside) * greater(missing, 0.0),
        left: down_ahead * share + (stands_ahead + left) * missing,
        right: down_ahead * share + (stands_ahead - left) * missing,
        heading: sin_cos(heading),
    }
}

/// The phase of a foot since it came down: `side` is 1 for the left foot and -1 for the right one.
pub fn since_strike(phase: u32, side: f32) -> u32 {
    if side > 0.0 { phase } else { phase.wrapping_add(HALF) }
}

pub fn is_lifted(since: u32) -> bool {
    unit_f32(since) >= ON_GROUND
}

/// Where the gait has a foot on the ground, or where it will put it down, from the body, m.
pub fn foothold(going: &Going, side: f32) -> [f32; 2] {
    let since = since_strike(going.phase, side);
    let to_come = if is_lifted(since) { 1.0 } else { 0.0 };
    let aside = side * going.aside;
    let down = if side > 0.0 { going.left } else { going.right };
    let along = down + going.stride * (to_come - unit_f32(since));
    let [sine, cosine] = going.heading;
    [cosine * aside + sine * along, cosine * along - sine * aside]
}

/// Whether an agent that does not walk takes a step to have its feet under it.
pub fn takes_a_step(own: &Stance) -> bool {
    let begins = !(own.walk_weight > 0.0);
    let far = if begins { STEP_AT } else { SETTLED };
    let far_turned = if begins { STEP_AT_TURN } else { SETTLED_TURN };
    let apart = greater(dot2(own.left, own.left), dot2(own.right, own.right));
    let [left, right] = own.turns;
    apart > far * far
        || greater(left.abs(), right.abs()) > far_turned
        || (!begins && (is_lifted(own.phase) || is_lifted(own.phase.wrapping_add(HALF))))
}

/// The phase from which an agent that stands sets off: the foot that is farther off goes first.
pub fn ready_phase(agent: u32, own: &Stance) -> u32 {
    let (left, right) = (dot2(own.left, own.left), dot2(own.right, own.right));
    let drawn = own_draw(agent, FIRST_FOOT, 0) >> 31 == 1;
    if left > right || (left == right && drawn) { LEFT_LEAVES } else { RIGHT_LEAVES }
}

/// What is left of a swing, 1 to 0, by the phase of a foot; without speed at either end.
fn left_of_swing(since: u32) -> f32 {
    1.0 - eased(greater(unit_f32(since) - ON_GROUND, 0.0) / (1.0 - ON_GROUND))
}

/// The share that is left of how far a foot is off: 1 on the ground, 0 when it has just come down.
pub fn left_over(before: u32, after: u32) -> f32 {
    if !is_lifted(after) {
        return if is_lifted(before) { 0.0 } else { 1.0 };
    }
    lesser(left_of_swing(after) / greater(left_of_swing(before), 1e-6), NEARLY_ALL)
}

/// How far a foot is off, m, when where the gait has it went on by `way`.
pub fn stays(off: [f32; 2], way: [f32; 2], share: f32) -> [f32; 2] {
    let now = if share >= 1.0 {
        [off[0] - way[0], off[1] - way[1]]
    } else {
        off.map(|part| unless_faint(part * share))
    };
    let far = dot2(now, now).sqrt();
    if far > MOST_APART { now.map(|part| part * (MOST_APART / greater(far, MOST_APART))) } else { now }
}

/// The same of where it points to, rad.
pub fn stays_turned(off: f32, turned: f32, share: f32) -> f32 {
    let now = if share >= 1.0 { wrap(off - turned) } else { unless_faint(off * share) };
    limit(now, -MOST_TURNED, MOST_TURNED)
}

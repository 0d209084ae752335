//! Twin of `shaders/shared/footing.wgsl`: feet stay where they are while they are on the ground.

use super::exact::{dot2, greater, unit_f32, wrap};
use crate::kernels::layout::Stance;
use crate::kernels::shared::footing::{
    AHEAD, HALF, MOST_APART, MOST_TURNED, NARROW, ON_GROUND, SETTLED, SETTLED_TURN, STEP_AT, STEP_AT_TURN,
    WIDE,
};

fn is_lifted(since_strike: u32) -> bool {
    unit_f32(since_strike) >= ON_GROUND
}

/// Whether an agent that does not walk takes a step to have its feet under it.
pub fn takes_a_step(own: &Stance, phase: u32) -> bool {
    let begins = !(own.walk_weight > 0.0);
    let far = if begins { STEP_AT } else { SETTLED };
    let far_turned = if begins { STEP_AT_TURN } else { SETTLED_TURN };
    let apart = greater(dot2(own.left, own.left), dot2(own.right, own.right));
    let [left, right] = own.turns;
    apart > far * far
        || greater(left.abs(), right.abs()) > far_turned
        || (!begins && (is_lifted(phase) || is_lifted(phase.wrapping_add(HALF))))
}

/// Where the gait has a foot on the ground, from the body, m: `side` is 1 for the left foot and -1 for the right one, `ahead` how
/// far the left foot is ahead in a stand; `missing` the share that a stride lacks; the heading as (sine, cosine).
pub fn ground_of(
    since_strike: u32,
    stride: f32,
    missing: f32,
    side: f32,
    ahead: f32,
    [sine, cosine]: [f32; 2],
) -> [f32; 2] {
    let aside = side * (NARROW + (WIDE - NARROW) * missing);
    let along = stride * (AHEAD - unit_f32(since_strike)) + side * ahead * missing;
    [cosine * aside + sine * along, cosine * along - sine * aside]
}

/// The share that is left of how far a foot is off: 1 on the ground, 0 when it has just come down.
pub fn left_over(before: u32, after: u32, stands: bool) -> f32 {
    if stands || before == after {
        return 1.0;
    }
    let since = unit_f32(after);
    if since < ON_GROUND {
        return if is_lifted(before) { 0.0 } else { 1.0 };
    }
    (1.0 - since) / (1.0 - greater(unit_f32(before), ON_GROUND))
}

/// How far a foot is off, m, when where the gait has it went on by `way`.
pub fn stays(off: [f32; 2], way: [f32; 2], share: f32) -> [f32; 2] {
    let now = if share >= 1.0 { [off[0] - way[0], off[1] - way[1]] } else { off.map(|part| part * share) };
    let far = dot2(now, now).sqrt();
    if far > MOST_APART { now.map(|part| part * (MOST_APART / greater(far, MOST_APART))) } else { now }
}

/// The same of where it points to, rad.
pub fn stays_turned(off: f32, turned: f32, share: f32) -> f32 {
    let now = if share >= 1.0 { wrap(off - turned) } else { off * share };
    if now > MOST_TURNED {
        MOST_TURNED
    } else if now < -MOST_TURNED {
        -MOST_TURNED
    } else {
        now
    }
}

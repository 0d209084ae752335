// uses: exact, agent, standing
// Feet stay where they are while they are on the ground. What a body does beside the walk of its gait, it turns, stops, goes
// aside, takes it away from them; Stance keeps how far. In its next swing a foot comes back to where the gait has it.
// Twin: reference::footing.
const HALF: u32 = 0x80000000u; // of a stride: the right foot comes down so much later than the left one
const ON_GROUND: f32 = 0.6;    // share of a stride in which a foot is on the ground
const AHEAD: f32 = 0.3;        // share of a stride that a foot is ahead when it comes down
const NARROW: f32 = 0.05;      // m that a foot is to its side in strides of the usual length
const WIDE: f32 = 0.095;       // m that it is there in a stand
const LEG: f32 = 0.87;         // m
const MOST_APART: f32 = 0.5;   // m: farther off a foot slides
const MOST_TURNED: f32 = 1.0;  // rad

// Who stands takes steps when a foot is so far off, until both are nearly where they belong.
const STEP_AT: f32 = 0.1;        // m
const STEP_AT_TURN: f32 = 0.6;   // rad
const SETTLED: f32 = 0.02;       // m
const SETTLED_TURN: f32 = 0.1;   // rad
const STEP_RATE: f32 = 0.9;      // strides a second

fn is_lifted(since_strike: u32) -> bool {
    return unit_f32(since_strike) >= ON_GROUND;
}

fn takes_a_step(own: Stance, phase: u32) -> bool {
    let begins = !(own.walk_weight > 0.0);
    let far = select(SETTLED, STEP_AT, begins);
    let apart = max(dot2(own.left, own.left), dot2(own.right, own.right));
    let turned = max(abs(own.turns.x), abs(own.turns.y));
    return apart > far * far || turned > select(SETTLED_TURN, STEP_AT_TURN, begins)
        || (!begins && (is_lifted(phase) || is_lifted(phase + HALF)));
}

// Where the gait has a foot on the ground, from the body, m: `side` is 1 for the left foot and -1 for the right one, `ahead` how far
// the left foot is ahead in a stand; `missing` the share that a stride lacks; the heading as (sine, cosine).
fn ground_of(since_strike: u32, stride: f32, missing: f32, side: f32, ahead: f32, heading: vec2<f32>) -> vec2<f32> {
    let aside = side * (NARROW + (WIDE - NARROW) * missing);
    let along = stride * (AHEAD - unit_f32(since_strike)) + side * ahead * missing;
    return vec2<f32>(heading.y * aside + heading.x * along, heading.y * along - heading.x * aside);
}

// The share that is left of how far a foot is off: 1 on the ground, 0 when it has just come down.
fn left_over(before: u32, after: u32, stands: bool) -> f32 {
    if stands || before == after {
        return 1.0;
    }
    let since = unit_f32(after);
    if since < ON_GROUND {
        return select(1.0, 0.0, is_lifted(before));
    }
    return (1.0 - since) / (1.0 - max(unit_f32(before), ON_GROUND));
}

// How far a foot is off when where the gait has it went on by `way`.
fn stays(off: vec2<f32>, way: vec2<f32>, share: f32) -> vec2<f32> {
    let now = select(off * share, off - way, share >= 1.0);
    let far = sqrt(dot2(now, now));
    return select(now, now * (MOST_APART / max(far, MOST_APART)), far > MOST_APART);
}

// The same of where it points to.
fn stays_turned(off: f32, turned: f32, share: f32) -> f32 {
    let now = select(off * share, exact_wrap(off - turned), share >= 1.0);
    return select(select(now, -MOST_TURNED, now < -MOST_TURNED), MOST_TURNED, now > MOST_TURNED);
}

// uses: exact, agent, standing
// Feet stay where they are while they are on the ground. What a body does beside the walk of its gait (it turns, stops, goes
// aside) takes it away from them; Stance keeps how far. In its next swing a foot comes back to where the gait has it.
// Twin: reference::footing.
const HALF: u32 = 0x80000000u; // of a stride: the right foot comes down so much later than the left one
const ON_GROUND: f32 = 0.6;    // share of a stride in which a foot is on the ground
const LEG: f32 = 0.87;         // m
const NEARLY_ALL: f32 = 0.999999; // the most that is left of a foot in the air
const LEAST_STRIDE: f32 = 0.1; // m
const MOST_APART: f32 = 0.5;   // m: farther off a foot slides
const MOST_TURNED: f32 = 1.0;  // rad

// Who stands takes steps when a foot is so far off, until both are nearly where they belong.
const STEP_AT: f32 = 0.1;       // m
const STEP_AT_TURN: f32 = 0.6;  // rad
const SETTLED: f32 = 0.02;      // m
const SETTLED_TURN: f32 = 0.1;  // rad
const STEP_RATE: f32 = 0.9;     // strides a second

// Phases at which the left or the right foot is about to leave the ground.
const LEFT_LEAVES: u32 = 0x99999900u;
const RIGHT_LEAVES: u32 = 0x19999900u;
const FIRST_FOOT: u32 = 0xf1450000u; // what an agent draws its first foot for

// How an agent walks at one moment, as far as its feet are concerned.
struct Going {
    phase: u32,
    stride: f32,        // m, by how much it walks
    aside: f32,         // m: where the left foot comes down; the right one does so on the other side
    left: f32,          // m: how far ahead the left foot comes down
    right: f32,
    heading: vec2<f32>, // (sine, cosine)
}

fn going_of(agent: u32, own: Stance, heading: f32, traits: Body) -> Going {
    let stride = own.stride * own.walk_weight;
    // `feet` scales strides likewise
    let share = stride / max(stride_at(traits.preferred_speed, traits.walk_ratio), LEAST_STRIDE);
    let missing = 1.0 - share;
    let down = foot_at(traits.foot_down);
    let stands = foot_at(traits.foot_stands);
    let left = left_ahead(stance_of(agent)) * LEG;
    return Going(
        own.phase,
        stride,
        down.x + (stands.x - down.x) * max(missing, 0.0),
        down.y * share + (stands.y + left) * missing,
        down.y * share + (stands.y - left) * missing,
        exact_sin_cos(heading),
    );
}

// The phase of a foot since it came down: `side` is 1 for the left foot and -1 for the right one.
fn since_strike(phase: u32, side: f32) -> u32 {
    return select(phase + HALF, phase, side > 0.0);
}

fn is_lifted(since: u32) -> bool {
    return unit_f32(since) >= ON_GROUND;
}

// Where the gait has a foot on the ground, or where it will put it down, from the body, m.
fn foothold(going: Going, side: f32) -> vec2<f32> {
    let since = since_strike(going.phase, side);
    let to_come = select(0.0, 1.0, is_lifted(since));
    let aside = side * going.aside;
    let along = select(going.right, going.left, side > 0.0) + going.stride * (to_come - unit_f32(since));
    let heading = going.heading;
    return vec2<f32>(heading.y * aside + heading.x * along, heading.y * along - heading.x * aside);
}

fn takes_a_step(own: Stance) -> bool {
    let begins = !(own.walk_weight > 0.0);
    let far = select(SETTLED, STEP_AT, begins);
    let apart = max(dot2(own.left, own.left), dot2(own.right, own.right));
    let turned = max(abs(own.turns.x), abs(own.turns.y));
    return apart > far * far || turned > select(SETTLED_TURN, STEP_AT_TURN, begins)
        || (!begins && (is_lifted(own.phase) || is_lifted(own.phase + HALF)));
}

// The phase from which an agent that stands sets off: the foot that is farther off goes first.
fn ready_phase(agent: u32, own: Stance) -> u32 {
    let left = dot2(own.left, own.left);
    let right = dot2(own.right, own.right);
    let drawn = (own_draw(agent, FIRST_FOOT, 0u) >> 31u) == 1u;
    return select(RIGHT_LEAVES, LEFT_LEAVES, left > right || (left == right && drawn));
}

// What is left of a swing, 1 to 0, by the phase of a foot; without speed at either end.
fn left_of_swing(since: u32) -> f32 {
    return 1.0 - eased(max(unit_f32(since) - ON_GROUND, 0.0) / (1.0 - ON_GROUND));
}

// The share that is left of how far a foot is off: 1 on the ground, 0 when it has just come down.
fn left_over(before: u32, after: u32) -> f32 {
    if !is_lifted(after) {
        return select(1.0, 0.0, is_lifted(before));
    }
    return min(left_of_swing(after) / max(left_of_swing(before), 1e-6), NEARLY_ALL);
}

// How far a foot is off when where the gait has it went on by `way`.
fn stays(off: vec2<f32>, way: vec2<f32>, share: f32) -> vec2<f32> {
    let now = select(unless_faint2(off * share), off - way, share >= 1.0);
    let far = sqrt(dot2(now, now));
    return select(now, now * (MOST_APART / max(far, MOST_APART)), far > MOST_APART);
}

// The same of where it points to.
fn stays_turned(off: f32, turned: f32, share: f32) -> f32 {
    let now = select(unless_faint(off * share), exact_wrap(off - turned), share >= 1.0);
    return limit(now, -MOST_TURNED, MOST_TURNED);
}

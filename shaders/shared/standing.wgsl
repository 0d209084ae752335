// uses: exact, quaternion
// How people stand: how much and in which emotions, and what is an agent's own. All of it is a function of the agent's number,
// what it shows and the time; clocks are integers, so that hours cost no precision. Twin: reference::standing.
const STANCES: u32 = 3u; // places of the feet; an avatar's standing clips: [emotion][stance]
const STANCE_WIDTH: f32 = 1.12;   // how far the ankles are apart, in widths of the hips
const STANCE_AHEAD: f32 = 0.045;  // how far one foot is ahead and the other one behind, in lengths of the leg
const FEET: u32 = 0xfee70000u;    // what an agent draws its stance for

// Which places of the feet are an agent's: side by side, left ahead, right ahead.
fn stance_of(agent: u32) -> u32 {
    return own_draw(agent, FEET, 0u) % STANCES;
}

// How far the left foot is ahead in a stance, and the right one behind, in lengths of the leg.
fn left_ahead(stance: u32) -> f32 {
    return select(select(0.0, STANCE_AHEAD, stance == 1u), -STANCE_AHEAD, stance == 2u);
}

// How much an agent walks, 0 to 1. With no gait to walk in, it stands.
fn walk_share(weights: vec4<f32>, walk_weight: f32) -> f32 {
    let sum = weights.x + weights.y + weights.z + weights.w;
    return select(0.0, limit(walk_weight, 0.0, 1.0), sum > 1e-6);
}

// Shares of the emotions in which it stands. Gaits of several weights are one for each emotion, and so feelings that change
// change the stand as smoothly as the walk; a single gait is of the emotion that is shown.
fn moods_of(weights: vec4<f32>, shown: u32) -> vec4<f32> {
    if weights.y == 0.0 && weights.z == 0.0 && weights.w == 0.0 {
        return vec4<f32>(
            select(0.0, 1.0, shown == 0u),
            select(0.0, 1.0, shown == 1u),
            select(0.0, 1.0, shown == 2u),
            select(0.0, 1.0, shown > 2u),
        );
    }
    return weights / (weights.x + weights.y + weights.z + weights.w);
}

// What an agent draws for a purpose; `number` counts the draws.
fn own_draw(agent: u32, purpose: u32, number: u32) -> u32 {
    return hash_u32(agent ^ hash_u32(purpose ^ hash_u32(number)));
}

// From 0 to 1, with no speed at either end.
fn eased(x: f32) -> f32 {
    return x * x * (3.0 - 2.0 * x);
}

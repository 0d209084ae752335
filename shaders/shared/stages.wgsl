// The stages of journeys, buffer `stages`: [stage][STAGE_STRIDE] vec4:
//   x, z, radius (m), kind
//   half axis along the region (x, z, m), half axis across it (x, z, m); of a queue: from one place to the next (x, z, m), places, number of the queue
//   number of the flow field that leads there or -1, least wait (steps), step before which nobody leaves, number of the stage in its file
//   elevation (m), 1 if it has one else 0 (then it is on whichever floor), two free
// Kinds: a waypoint is passed within its radius. A goal is a region with a place of its own for everyone, passed on entering it. In a waiting area
// everyone goes to a place of their own and stays for a time. Who enters an exit is gone. In a queue people stand one behind the other.
const STAGE_STRIDE: u32 = 4u;
const WAYPOINT: f32 = 0.0;
const GOAL: f32 = 1.0;
const WAITING: f32 = 2.0;
const QUEUE: f32 = 3.0;
const EXIT: f32 = 4.0;

// `aim`: [agent] x, z of the point walked to, m; how it is approached; number of the flow field that leads there or -1.
// How: PASS (0), at full speed; STOP, so as to stop at the point itself; above 0, so as to stand within that distance of it, m.
const PASS: f32 = 0.0;
const STOP: f32 = -2.0; // not -1: Mesa makes -float(condition) of a choice of 0 or -1, which is -0

// Places of people in a region keep this share of its half axes.
const INNER: f32 = 0.9;

// Whether a point is in the rectangle of a region.
fn in_region(at: vec2<f32>, middle: vec2<f32>, axes: vec4<f32>) -> bool {
    let to = at - middle;
    return abs(dot2(to, axes.xy)) <= dot2(axes.xy, axes.xy) && abs(dot2(to, axes.zw)) <= dot2(axes.zw, axes.zw);
}

// The place of its own that an agent has in a region: a point of a sequence that fills the square evenly whatever the number of agents
// (Roberts 2018, "R2": multiples of 1/p and 1/p^2, p^3 = p + 1, here in 32 bits), begun elsewhere for every stage.
fn own_place(agent: u32, number: u32, middle: vec2<f32>, axes: vec4<f32>) -> vec2<f32> {
    let begin = hash_u32(number + 1u);
    let u = (2.0 * unit_f32(agent * 3242174889u + begin) - 1.0) * INNER;
    let v = (2.0 * unit_f32(agent * 2447445414u + hash_u32(begin)) - 1.0) * INNER;
    return vec2<f32>(middle.x + (u * axes.x + v * axes.z), middle.y + (u * axes.y + v * axes.w));
}

// The nearest point of a region, as far inside as the places in it are.
fn nearest_place(at: vec2<f32>, middle: vec2<f32>, axes: vec4<f32>) -> vec2<f32> {
    let to = at - middle;
    let u = clamp(dot2(to, axes.xy) / dot2(axes.xy, axes.xy), -INNER, INNER);
    let v = clamp(dot2(to, axes.zw) / dot2(axes.zw, axes.zw), -INNER, INNER);
    return vec2<f32>(middle.x + (u * axes.x + v * axes.z), middle.y + (u * axes.y + v * axes.w));
}

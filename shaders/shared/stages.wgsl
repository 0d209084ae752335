// Buffer `stages`: the stages of journeys, [stage].
// Kinds: an agent passes a waypoint within its radius. A goal is a region with a place for each agent; an agent passes it on
// entering it. In a waiting area each agent goes to its own place and stays for a time. An agent that enters an exit is gone.
// In a queue agents stand one behind the other.
struct Stage {
    place: vec2<f32>,    // its middle, or the first place of a queue, m
    radius: f32,         // m
    kind: f32,
    along: vec2<f32>,    // half axis along the region, or from one place of a queue to the next, m
    across: vec2<f32>,   // half axis across the region, m; of a queue: its places, and its number
    field: f32,          // number of the flow field that leads there, or -1
    least_wait: f32,     // steps
    first_leave: f32,    // first step in which an agent may leave
    number: f32,         // in its file
    elevation: f32,      // m
    has_elevation: f32,  // 1; 0: it is on whichever floor
    unused_a: f32,
    unused_b: f32,
}
const WAYPOINT: f32 = 0.0;
const GOAL: f32 = 1.0;
const WAITING: f32 = 2.0;
const QUEUE: f32 = 3.0;
const EXIT: f32 = 4.0;

// How an aim is approached: PASS, at full speed; STOP, so as to stop at the point itself; above 0, so as to stand within that distance of it, m.
const PASS: f32 = 0.0;
const STOP: f32 = -2.0; // not -1: Mesa makes -float(condition) of a choice of 0 or -1, which is -0

// Places of people in a region keep this share of its half axes.
const INNER: f32 = 0.9;

// Whether a point is in the rectangle of a region.
fn in_region(at: vec2<f32>, region: Stage) -> bool {
    let to = at - region.place;
    let along = region.along;
    let across = region.across;
    return abs(dot2(to, along)) <= dot2(along, along) && abs(dot2(to, across)) <= dot2(across, across);
}

// The place of its own that an agent has in a region: a point of a sequence that fills the square evenly whatever the number of agents
// (Roberts 2018, "R2": multiples of 1/p and 1/p^2, p^3 = p + 1, here in 32 bits), begun elsewhere for every stage.
fn own_place(agent: u32, region: Stage) -> vec2<f32> {
    let begin = hash_u32(u32(region.number) + 1u);
    let u = (2.0 * unit_f32(agent * 3242174889u + begin) - 1.0) * INNER;
    let v = (2.0 * unit_f32(agent * 2447445414u + hash_u32(begin)) - 1.0) * INNER;
    return region.place + (u * region.along + v * region.across);
}

// The nearest point of a region, as far inside as the places in it are.
fn nearest_place(at: vec2<f32>, region: Stage) -> vec2<f32> {
    let to = at - region.place;
    let u = clamp(dot2(to, region.along) / dot2(region.along, region.along), -INNER, INNER);
    let v = clamp(dot2(to, region.across) / dot2(region.across, region.across), -INNER, INNER);
    return region.place + (u * region.along + v * region.across);
}

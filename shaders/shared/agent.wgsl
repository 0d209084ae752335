// What buffers hold of each agent, [agent], and of each slot of the grid, [slot]. The Rust twins are in kernels::layout.

// Buffer `body`.
struct Body {
    radius: f32,          // m
    max_speed: f32,       // m/s
    preferred_speed: f32, // m/s, alone and unhindered
    walk_ratio: f32,      // step length over step rate, m s
    foot_down: u32,       // where the left foot comes down in its usual stride, from the body: see foot_at
    foot_stands: u32,     // where it is in a stand with the feet side by side
}

// To the left and ahead, m, of a place in tenths of a millimetre: the lower half of the bits, and the upper half.
fn foot_at(place: u32) -> vec2<f32> {
    return vec2<f32>(f32(i32(place << 16u) >> 16u), f32(i32(place) >> 16u)) * 0.0001;
}

// How far a stride goes at a speed, m: the walk ratio is a person's own at every speed, so that length and rate of steps both
// go with the root of the speed.
fn stride_at(speed: f32, walk_ratio: f32) -> f32 {
    return 2.0 * sqrt(walk_ratio * speed);
}

// Buffer `avoidance`: which agents an agent avoids, and how far ahead.
struct Avoidance {
    inverse_time_horizon: f32, // 1/s; of an agent led from outside its comfort distance instead, m
    neighbour_distance: f32,   // m
    neighbour_cap: f32,        // most neighbours
    priority: f32,             // from LED on the agent is led from outside
}

// Buffer `stance`.
struct Stance {
    phase: u32,         // of its walk: the whole range is one stride
    walk_weight: f32,   // 0 stands, 1 walks
    left: vec2<f32>,    // m, world: from where the gait has the foot to where it is
    right: vec2<f32>,
    turns: vec2<f32>,   // rad: the same of where left and right foot point to
    lean: vec2<f32>,    // rad, world: how far the body leans, and where to
    heights: vec2<f32>, // m: of the floor under left and right foot above that under the body
    slopes: vec2<f32>,  // of that floor, upwards where left and right foot point to
    stride: f32,        // m that a stride covers now
    foresight: f32,     // rad: how far the head turns ahead of the body, to the left
}

// The same in vectors of four, each of which a GPU reads and writes at once.
struct StanceQuads {
    walk_and_left: vec4<u32>, // bits: those of a phase may be no number
    right_and_turns: vec4<f32>,
    lean_and_heights: vec4<f32>,
    slopes_and_rest: vec4<f32>,
}

fn stance_quads(own: Stance) -> StanceQuads {
    return StanceQuads(
        vec4<u32>(own.phase, bitcast<u32>(own.walk_weight), bitcast<vec2<u32>>(own.left)),
        vec4<f32>(own.right, own.turns),
        vec4<f32>(own.lean, own.heights),
        vec4<f32>(own.slopes, own.stride, own.foresight),
    );
}

fn stance_in(quads: StanceQuads) -> Stance {
    let walk = quads.walk_and_left;
    let left = bitcast<vec2<f32>>(walk.zw);
    let right = quads.right_and_turns;
    let lean = quads.lean_and_heights;
    let rest = quads.slopes_and_rest;
    return Stance(
        walk.x, bitcast<f32>(walk.y), left, right.xy, right.zw, lean.xy, lean.zw, rest.xy, rest.z, rest.w,
    );
}

// Buffer `appearance`.
struct Appearance {
    traits: u32,         // bits: avatar (8), emotion (8), gazes (1), has no body (1), stature (7), breadth (7)
    scale: f32,          // size of the body over its avatar's
    skin_and_hair: u32,  // colours of five, six and five bits
    top_and_bottom: u32, // colours of five, six and five bits
}

// Number of the avatar.
fn avatar_of(own: Appearance) -> u32 {
    return own.traits & 255u;
}

// The emotion that is shown: 0 happy, 1 angry, 2 sad, 3 neutral.
fn emotion_of(own: Appearance) -> u32 {
    return (own.traits >> 8u) & 255u;
}

// Skin and hair, top and bottom.
fn colors_of(own: Appearance) -> vec2<u32> {
    return vec2<u32>(own.skin_and_hair, own.top_and_bottom);
}

// Whether it may look at the user.
fn gazes(own: Appearance) -> bool {
    return ((own.traits >> 16u) & 1u) == 1u;
}

// Whether it has no body to draw.
fn is_bodiless(own: Appearance) -> bool {
    return ((own.traits >> 17u) & 1u) == 1u;
}

// How high and how broad a body stands beside its avatar's at the agent's scale, to a part in 64: for what needs no more.
fn stature_of(own: Appearance) -> f32 {
    return 1.0 + f32(i32(own.traits << 7u) >> 25u) * 0.015625;
}

fn breadth_of(own: Appearance) -> f32 {
    return 1.0 + f32(i32(own.traits) >> 25u) * 0.015625;
}

// Buffer `physique`: how a body is built, as ratios to its avatar's at the agent's scale, two a word: see ratios_in. Legs are as
// long as the scale makes them, so that strides and feet do not depend on a physique.
struct Physique {
    trunk_and_arms: u32,     // lengths
    head_and_shoulders: u32, // size of the head; how far the shoulder joints are apart
    chest: u32,              // breadth, depth
    waist: u32,              // breadth, depth
    hips: u32,               // breadth, depth
    neck_and_hands: u32,     // girth; size
    arms: u32,               // girths of upper arm and forearm
    legs: u32,               // girths of thigh and calf
}

// The ratios in the lower and the upper half of the bits: 0 is 1, each step more or less 1 / 16384.
fn ratios_in(pair: u32) -> vec2<f32> {
    let steps = vec2<f32>(f32(i32(pair << 16u) >> 16u), f32(i32(pair) >> 16u));
    return vec2<f32>(1.0, 1.0) + steps * 0.00006103515625;
}

// Traits with another emotion.
fn with_emotion(traits: u32, emotion: u32) -> u32 {
    return (traits & 0xffff00ffu) | (emotion << 8u);
}

// Buffer `route`: where an agent is on its journey.
struct Route {
    first: u32,            // number of its first stage
    length_and_loops: u32, // stages; the highest bit: the journey begins again after the last one
    next: u32,             // stage that it walks to, from its first
    arrivals: u32,         // times that it came to the last one
}

fn route_length(route: Route) -> u32 {
    return route.length_and_loops & 0x7fffffffu;
}

fn route_loops(route: Route) -> bool {
    return (route.length_and_loops >> 31u) == 1u;
}

// Buffer `slot_motion`: what an agent reads of itself and of the neighbours that it found. Their positions, which it reads of
// all candidates, are in a buffer of their own, `slot_position`.
struct SlotMotion {
    velocity: vec2<f32>, // m/s
    radius: f32,         // m, with the comfort distance of an agent led from outside
    max_speed: f32,      // m/s
    priority: f32,       // with RAISE while it has the right of way
    elevation: f32,      // m
    agent: u32,          // NOBODY: the slot is empty
    limits: u32,         // neighbour cap, LED_BIT, group << GROUP_SHIFT
}

// The same in vectors of four, each of which a GPU writes at once.
struct SlotMotionQuads {
    walk: vec4<f32>,
    rest: vec4<u32>,
}

fn motion_quads(own: SlotMotion) -> SlotMotionQuads {
    return SlotMotionQuads(
        vec4<f32>(own.velocity, own.radius, own.max_speed),
        vec4<u32>(bitcast<u32>(own.priority), bitcast<u32>(own.elevation), own.agent, own.limits),
    );
}

// Buffer `waiting`: what `unjam` remembers.
struct Waiting {
    stuck: f32, // s without progress
    lost: f32,  // m lost since it began to follow a wall
    side: f32,  // of the wall that it follows, -1 or 1; 0: none
    unused: f32,
}

// Buffer `lead`: where an agent led from outside is to be at the end of the step.
struct Lead {
    place: vec2<f32>,    // m; ABSENT: not there
    velocity: vec2<f32>, // on appearing, m/s
}

// Buffer `paths`: an agent led along keyframes.
struct Path {
    agent: u32,
    first_keyframe: u32,
    keyframes: u32, // 0: led by hand
    unused: u32,
}

// Buffer `keyframes`.
struct Keyframe {
    time: f32,  // s
    x: f32,     // m
    z: f32,     // m
    unused: f32,
}

// Buffer `teleports`: from one box to the other.
struct Teleport {
    from_low: vec2<f32>,  // m
    from_high: vec2<f32>, // m
    to_low: vec2<f32>,    // m
    to_high: vec2<f32>,   // m
}

// Buffer `sources`: where agents come in.
struct Source {
    first_place: u32, // of source_places
    places: u32,
    first_agent: u32,
    agents: u32,
    entered: u32, // agents let in so far
    widest: f32,  // largest radius of the crowd, m
    unused_a: u32,
    unused_b: u32,
}

// Two snapshots of a crowd and what lies between them; the Rust twin is kernels::layout::BetweenUniforms.
struct BetweenUniforms {
    agent_count: u32,
    newest: u32, // place of the newest snapshot, 0 or 1; the one before it has the other
    share: f32,  // of the way from the one before to the newest, 0 to 1
    reach: f32,  // m: an agent farther from its earlier place than this did not walk there
}

// Buffer `snapshots`: what is shown of an agent, [2][agent].
struct Snapshot {
    position: vec2<f32>,     // m
    heading: f32,            // rad
    walk_weight: f32,
    gait_weights: vec4<f32>,
    phase: u32,              // the whole range is one stride
    elevation: f32,          // m
    stride: f32,             // this and what follows as in Stance
    foresight: f32,
    left: vec2<f32>,
    right: vec2<f32>,
    turns: vec2<f32>,
    lean: vec2<f32>,
    heights: vec2<f32>,
    slopes: vec2<f32>,
}

fn snapshot_of(place: u32, agent: u32) -> u32 {
    return place * between.agent_count + agent;
}

// Two snapshots of a crowd and what lies between them; the Rust twin is kernels::layout::BetweenUniforms.
struct BetweenUniforms {
    agent_count: u32,
    newest: u32, // place of the newest snapshot, 0 or 1; the one before it has the other
    share: f32,  // of the way from the one before to the newest, 0 to 1
    reach: f32,  // m: whoever is farther from where they were did not walk there
}

// Elements of one agent in a snapshot: ground position, heading, walk weight; phase, elevation, 0, 0; gait weights. Bits.
const SNAPSHOT_STRIDE: u32 = 3u;

fn moment_start(place: u32, agent: u32) -> u32 {
    return (place * between.agent_count + agent) * SNAPSHOT_STRIDE;
}

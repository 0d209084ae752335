// Parameters of one frame; the Rust twin is kernels::layout::FrameUniforms. World frame, y up, metres.
struct FrameUniforms {
    planes: array<vec4<f32>, 12>, // unit normals; inside is dot(plane.xyz, p) + plane.w >= 0; eye 0 has 0..6, eye 1 has 6..12
    user_eyes: vec4<f32>,         // xyz: midpoint of the user's eyes, which agents look at
    camera: vec4<f32>,            // xyz: where distances for the level of detail are measured from; w: from here on far
                                  // bodies are specks, 0 for none, m
    level_distance: vec4<f32>,    // x, y: nearer than this is level 0, 1; z: farther than this is not drawn; w: from here
                                  // on agents are far bodies, drawn without a pose, 0 for none; m
    standing_clips: array<vec4<u32>, 4>, // [avatar] first of its standing clips, four to a vector
    agent_count: u32,
    eye_count: u32,               // 1 or 2; an agent is drawn if either eye sees it
    level_count: u32,             // levels of detail, 1 to 3
    bucket_count: u32,            // avatars * levels; with two far buckets for each avatar behind them at most 32
    visible_capacity: u32,        // agents that local_rotations and palettes have room for
    near_capacity: u32,           // agents that the skinned vertices have room for
    frame_index: u32,             // counts frames; a gaze not updated in the frame before starts afresh
    gaze_mode: u32,               // 0 natural, 1 paper
    frame_time: f32,              // time since the frame before, s
    agent_height: f32,            // bounding height for culling, m
    agent_radius: f32,            // bounding radius for culling, m
    clip_count: u32,              // clips in clip_frames; with none no agent is drawn
    gaze_limit: u32,              // 0: every agent that would look at the user does; else one more than the most at a time
    gaze_time: u32,               // the time that is shown, ms
    turn_least: u32,              // shortest turn to look at the user, ms
    turn_most: u32,               // longest turn, ms
    individuals: f32,             // how much agents differ from the people whose gaits they have, 0 to 1
    expression: f32,              // how far faces go with emotions: 0 not at all, 1 as actors do
    unused_a: u32,
    unused_b: u32,
}

// How feelings change, of all people; the Rust twin is kernels::layout::MoodUniforms.
struct MoodUniforms {
    radius: f32,       // m: people farther apart do not catch each other's feelings; 0: nobody does
    contagion: f32,    // 1/s
    decay: f32,        // 1/s: how fast feelings return to their own state
    event_count: u32,
}

// How feelings change, of all people; the Rust twin is kernels::layout::MoodUniforms.
struct MoodUniforms {
    radius: f32,       // m: agents farther apart do not catch each other's feelings; 0: none do
    contagion: f32,    // 1/s
    decay: f32,        // 1/s: how fast feelings return to their own state
    event_count: u32,
}

// Buffer `temperament`: [agent].
struct Temperament {
    rest: vec4<f32>,     // weights of happy, angry, sad, neutral that feelings return to; sum 1
    expressiveness: f32, // epsilon, 0 to 1
    openness: f32,       // delta, 0 to 1
    amplification: f32,  // eta, 0 to 1
    bias: f32,           // beta, 0 to 1
}

// Buffer `heard`: [agent].
struct Heard {
    strength: f32, // sum of epsilon alpha over all agents heard
    happy: f32,    // q*, 0 to 1
    angry: f32,    // q*, 0 to 1
    sad: f32,      // q*, 0 to 1
}

// Buffer `stimuli`: [event].
struct Stimulus {
    place: vec2<f32>, // m
    radius: f32,      // m
    strength: f32,    // 0 to 1
    emotion: f32,     // 0 happy, 1 angry, 2 sad, 3 neutral
    first_step: f32,
    end_step: f32,    // step after the last
    unused: f32,
}

// Buffer `paces`: [agent], how its gaits walk.
struct Paces {
    preferred_speeds: vec4<f32>, // with each gait, m/s
    walk_ratios: vec4<f32>,      // of each gait, m s
    max_speed_factor: f32,       // maximum speed over the preferred one; 0: shows nothing
    max_speed: f32,              // at most, m/s
    unused_a: f32,
    unused_b: f32,
}

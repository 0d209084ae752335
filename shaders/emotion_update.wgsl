// uses: step, exact, absent, mood
// How feelings change in a step: contagion between agents near one another, events, and the return to each agent's own
// state.
//
// Contagion is the emotion part of ASCRIBE, after Bosse, Duell, Memon, Treur and van der Wal (2009, 2015), for each
// of happy, angry and sad; neutral is what is left to 1. R hears S with
//   gamma_SR = epsilon_S alpha_SR delta_R,  gamma_R = sum of gamma_SR,  q* = sum of gamma_SR q_S / gamma_R,
//   dq_R/dt = contagion gamma_R [eta (beta PI + (1 - beta) NI) + (1 - eta) q* - q_R],
//   PI = 1 - (1 - q*)(1 - q_R),  NI = q* q_R,
// alpha_SR falling from 1 here to 0 at mood.radius. The bracket without q_R is held for the step and the rest is
// solved exactly, so that no rate makes a weight leave 0 to 1. Three weights that together pass 1 are scaled to it.
// `emotion_gather` supplies the sums over the agents that R hears.
const LOG2_E: f32 = 1.4426950;
const EVENT_RATE: f32 = 2.0;      // 1/s: how fast an event is taken in

@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<uniform> mood: MoodUniforms;
@group(0) @binding(2) var<storage, read> position: array<vec2<f32>>;      // [agent] m
@group(0) @binding(3) var<storage, read> temperament: array<Temperament>; // [agent]
@group(0) @binding(4) var<storage, read> stimuli: array<Stimulus>;        // [event]
@group(0) @binding(5) var<storage, read_write> heard: array<Heard>;       // [agent]
@group(0) @binding(6) var<storage, read_write> feeling: array<vec4<f32>>; // [agent] weights of happy, angry, sad, neutral; sum 1

// Share of the way to its goal that something takes in this step at that rate, 1/s.
fn taken(rate: f32) -> f32 {
    return 1.0 - exact_exp2(-(LOG2_E * rate * step.time_step));
}

// One weight after contagion.
fn caught(q: f32, heard: f32, take: f32, character: Temperament) -> f32 {
    let rising = 1.0 - (1.0 - heard) * (1.0 - q);
    let falling = heard * q;
    let amplified = character.bias * rising + (1.0 - character.bias) * falling;
    let goal = character.amplification * amplified + (1.0 - character.amplification) * heard;
    return q + take * (goal - q);
}

// The weights, the first three scaled so that they do not pass 1, neutral what is left.
fn completed(q: vec4<f32>) -> vec4<f32> {
    let sum = q.x + q.y + q.z;
    let most = max(sum, 1.0);
    return vec4<f32>(unless_faint(q.x / most), unless_faint(q.y / most), unless_faint(q.z / most), max(1.0 - sum, 0.0));
}

// An emotion raised to at least a part of `level`, the others giving way in proportion.
fn roused(q: vec4<f32>, emotion: u32, level: f32, take: f32) -> vec4<f32> {
    let old = q[emotion];
    if !(level > old) {
        return q;
    }
    let raised = old + take * (level - old);
    let rest = (1.0 - raised) / (1.0 - old);
    return vec4<f32>(
        select(q.x * rest, raised, emotion == 0u),
        select(q.y * rest, raised, emotion == 1u),
        select(q.z * rest, raised, emotion == 2u),
        select(q.w * rest, raised, emotion == 3u),
    );
}

@compute @workgroup_size(64)
fn emotion_update(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count {
        return;
    }
    let at = position[agent];
    if is_absent(at) {
        heard[agent] = Heard(); // a later occupant of the place has heard nothing yet
        return;
    }
    var q = feeling[agent];
    let character = temperament[agent];
    let others = heard[agent];
    if others.strength > 0.0 {
        let take = taken(mood.contagion * (character.openness * others.strength));
        q = completed(vec4<f32>(
            caught(q.x, others.happy, take, character),
            caught(q.y, others.angry, take, character),
            caught(q.z, others.sad, take, character),
            0.0,
        ));
    }
    let now = f32(step.step_index);
    for (var i = 0u; i < mood.event_count; i++) {
        let event = stimuli[i];
        if now >= event.first_step && now < event.end_step {
            let to = at - event.place;
            let level = event.strength * (1.0 - sqrt(dot2(to, to)) / event.radius);
            q = roused(q, min(u32(event.emotion), 3u), level, taken(EVENT_RATE));
        }
    }
    let back = taken(mood.decay);
    let own = character.rest;
    feeling[agent] = completed(vec4<f32>(
        q.x + back * (own.x - q.x),
        q.y + back * (own.y - q.y),
        q.z + back * (own.z - q.z),
        0.0,
    ));
}

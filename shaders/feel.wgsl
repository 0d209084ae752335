// uses: step, grid, exact, absent
// How feelings change in a step: contagion between people who are near one another, events, and the return to each
// one's own state. Reads the old feelings and writes new ones, so that the order of people does not matter.
//
// Contagion is the emotion part of ASCRIBE, after Bosse, Duell, Memon, Treur and van der Wal (2009, 2015), for each
// of happy, angry and sad; neutral is what is left to 1. R hears S with
//   gamma_SR = epsilon_S alpha_SR delta_R,  gamma_R = sum of gamma_SR,  q* = sum of gamma_SR q_S / gamma_R,
//   dq_R/dt = contagion gamma_R [eta (beta PI + (1 - beta) NI) + (1 - eta) q* - q_R],
//   PI = 1 - (1 - q*)(1 - q_R),  NI = q* q_R,
// alpha_SR falling from 1 here to 0 at mood.radius. The bracket without q_R is held for the step and the rest is
// solved exactly, so that no rate makes a weight leave 0 to 1. Three weights that together pass 1 are scaled to it.
//
// The sums are of integers (steps of 2^-20): they are the same in any order.
const SHARE = 1048576.0;     // units of a sum that make 1
const MOST_HEARD = 4095u;    // voices that fit into a sum
const MOST_TURNS = 32768u;   // candidates that are looked at, whatever the crowd
const LOG2_E = 1.4426950;
const EVENT_RATE = 2.0;      // 1/s: how fast an event is taken in

// Of all people; the Rust twin is kernels::layout::MoodUniforms.
struct MoodUniforms {
    radius: f32,       // m: people farther apart do not catch each other's feelings; 0: nobody does
    contagion: f32,    // 1/s
    decay: f32,        // 1/s: how fast feelings return to their own state
    event_count: u32,
}

@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<uniform> mood: MoodUniforms;
@group(0) @binding(2) var<storage, read> slot_motion: array<vec4<f32>>;        // [slot][2] position, velocity; radius, maximum speed, priority, elevation
@group(0) @binding(3) var<storage, read> slot_agent: array<u32>;               // [slot]
@group(0) @binding(4) var<storage, read> agent_slot: array<u32>;               // [agent]
@group(0) @binding(5) var<storage, read> cell_start: array<u32>;               // [cell + 1]
@group(0) @binding(6) var<storage, read> feeling: array<vec4<f32>>;            // [agent] weights of happy, angry, sad, neutral; sum 1
@group(0) @binding(7) var<storage, read> temperament: array<vec4<f32>>;        // [agent][2] the weights it returns to; expressiveness, openness, amplification, bias
@group(0) @binding(8) var<storage, read> stimuli: array<vec4<f32>>;            // [event][2] x, z, radius, strength; emotion, first step, step after the last, 0
@group(0) @binding(9) var<storage, read_write> new_feeling: array<vec4<f32>>;  // [agent]

// Sums over those who are heard: of epsilon alpha, and of that times each weight.
fn hear(slot: u32, at: vec2<f32>, elevation: f32) -> vec4<u32> {
    let reach = mood.radius;
    let low = grid_cell(at - vec2<f32>(reach), step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let high = grid_cell(at + vec2<f32>(reach), step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    var sums = vec4<u32>(0u);
    var heard = 0u;
    var turns = 0u;
    for (var y = low.y; y <= high.y; y++) {
        let row = y * i32(step.grid_columns);
        let end = cell_start[row + high.x + 1];
        for (var other = cell_start[row + low.x]; other < end && turns < MOST_TURNS; other++) {
            turns++;
            let to = slot_motion[other * 2u].xy - at;
            let distance2 = dot2(to, to);
            let apart = abs(slot_motion[other * 2u + 1u].w - elevation);
            let same_storey = step.storey_height <= 0.0 || apart < step.storey_height;
            if other != slot && distance2 < reach * reach && same_storey && heard < MOST_HEARD {
                heard++;
                let speaker = slot_agent[other];
                let voice = temperament[speaker * 2u + 1u].x * (1.0 - sqrt(distance2) / reach);
                let weighted = voice * feeling[speaker];
                sums += vec4<u32>(units(voice), units(weighted.x), units(weighted.y), units(weighted.z));
            }
        }
    }
    return sums;
}

fn units(share: f32) -> u32 {
    return u32(share * SHARE + 0.5);
}

// A sum as a number; both halves are exact, so it is rounded once.
fn total(sum: u32) -> f32 {
    return f32(sum >> 8u) * 256.0 + f32(sum & 255u);
}

// Share of the way to its goal that something takes in this step at that rate, 1/s.
fn taken(rate: f32) -> f32 {
    return 1.0 - exact_exp2(-(LOG2_E * rate * step.time_step));
}

// One weight after contagion.
fn caught(q: f32, heard: f32, take: f32, character: vec4<f32>) -> f32 {
    let rising = 1.0 - (1.0 - heard) * (1.0 - q);
    let falling = heard * q;
    let amplified = character.w * rising + (1.0 - character.w) * falling;
    let goal = character.z * amplified + (1.0 - character.z) * heard;
    return q + take * (goal - q);
}

// The weights, the first three scaled so that they do not pass 1, neutral what is left.
fn completed(q: vec4<f32>) -> vec4<f32> {
    let sum = q.x + q.y + q.z;
    let most = max(sum, 1.0);
    return vec4<f32>(q.x / most, q.y / most, q.z / most, max(1.0 - sum, 0.0));
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
fn feel(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count {
        return;
    }
    var q = feeling[agent];
    let slot = agent_slot[agent];
    if slot == NOBODY {
        new_feeling[agent] = q;
        return;
    }
    let at = slot_motion[slot * 2u].xy;
    let character = temperament[agent * 2u + 1u];
    if mood.radius > 0.0 && character.y > 0.0 {
        let sums = hear(slot, at, slot_motion[slot * 2u + 1u].w);
        if sums.x > 0u {
            let voices = total(sums.x);
            let take = taken(mood.contagion * (character.y * (voices / SHARE)));
            q = completed(vec4<f32>(
                caught(q.x, min(total(sums.y) / voices, 1.0), take, character),
                caught(q.y, min(total(sums.z) / voices, 1.0), take, character),
                caught(q.z, min(total(sums.w) / voices, 1.0), take, character),
                0.0,
            ));
        }
    }
    let now = f32(step.step_index);
    for (var i = 0u; i < mood.event_count; i++) {
        let place = stimuli[i * 2u];
        let what = stimuli[i * 2u + 1u];
        if now >= what.y && now < what.z {
            let to = at - place.xy;
            q = roused(q, min(u32(what.x), 3u), place.w * (1.0 - sqrt(dot2(to, to)) / place.z), taken(EVENT_RATE));
        }
    }
    let back = taken(mood.decay);
    let own = temperament[agent * 2u];
    new_feeling[agent] = completed(vec4<f32>(
        q.x + back * (own.x - q.x),
        q.y + back * (own.y - q.y),
        q.z + back * (own.z - q.z),
        0.0,
    ));
}

// uses: frame, exact, quaternion, body, agent, standing
// The pose of every visible agent: up to four gaits, sampled at the agent's phase and blended by their weights, and
// that blended with the standing clips by the walk weight. Rotations are blended as normalised sums, each aligned with
// the sum before it, so that q and -q count as the same. Scale is applied by `palette`, not here.
//
// Strides shorter than a gait's have smaller movements of trunk, head and arms: with half a stride later, what swings to either
// side is at rest in the middle. The legs are left to `feet`.
//
// A standing clip is a loop of shifted weight, from the left leg to the right and back. An agent rests somewhere near either
// end, and now and then shifts to the other one. It stands by a clip for each emotion that its gaits have.
@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> visible: array<u32>;                     // [visible] agents, then NONE
@group(0) @binding(2) var<storage, read> phase: array<u32>;                       // [agent] the whole range is one stride
@group(0) @binding(3) var<storage, read> stance: array<Stance>;                   // [agent]
@group(0) @binding(4) var<storage, read> appearance: array<Appearance>;           // [agent]
@group(0) @binding(5) var<storage, read> gaits: array<vec4<u32>>;                 // [agent] clip ids
@group(0) @binding(6) var<storage, read> gait_weights: array<vec4<f32>>;          // [agent]
@group(0) @binding(7) var<storage, read> clip_frames: array<vec4<f32>>;           // [clip][64][17]
@group(0) @binding(8) var<storage, read_write> local_rotations: array<vec4<f32>>; // [visible][17]

const SAMPLES: u32 = 8u; // four gaits, then the standing clips of four emotions
const GAITS: u32 = 4u;
const FIRST_UPPER: u32 = 1u;  // of the joints above the legs, without the pelvis
const FIRST_LEG: u32 = 10u;
const HALF_CLIP: u32 = 32u;   // frames

// Strides of bodies over those of their gaits.
const LONGEST: f32 = 1.4;
const AS_USUAL: f32 = 0.001; // away from 1: no difference is seen
const LEAST_TRAVEL: f32 = 0.01; // m

// By emotion, ms: the time in which there is one shift of weight, how late in it that may begin, and how long it lasts at least.
const SHIFT_EVERY: vec4<u32> = vec4<u32>(19000u, 9500u, 19000u, 19000u);
const SHIFT_SPREAD: vec4<u32> = vec4<u32>(10000u, 5000u, 10000u, 10000u);
const SHIFT_LASTS: vec4<u32> = vec4<u32>(1100u, 1000u, 1500u, 1100u);
const SHIFT_SPAN: u32 = 400u;         // ms, and at most so much longer
const REST_SPREAD: u32 = 0x20000000u; // of the loop, before and behind its ends: where agents rest

// What agents draw for.
const SIDE: u32 = 0x51de0000u;
const SHIFT: u32 = 0x5417f000u;
const REST: u32 = 0x4e570000u;

// The phase at which it rests after its shift of that number: about the left leg, then about the right.
fn rest_phase(agent: u32, number: u32) -> u32 {
    let draw = own_draw(agent, REST, number);
    return (number << 31u) + (draw >> 2u) - REST_SPREAD;
}

// The phase of the standing clip of an emotion.
fn weight_phase(agent: u32, emotion: u32) -> u32 {
    let every = SHIFT_EVERY[emotion];
    let own = own_draw(agent, SIDE, 0u);
    let time = frame.gaze_time + own % every;
    let number = time / every + (own >> 31u);
    let draw = own_draw(agent, SHIFT, number);
    let since = f32(i32(time % every) - i32(draw % SHIFT_SPREAD[emotion]));
    let lasts = f32(SHIFT_LASTS[emotion] + (draw >> 16u) % SHIFT_SPAN);
    let done = eased(limit(since / lasts, 0.0, 1.0));
    let before = rest_phase(agent, number - 1u);
    let way = rest_phase(agent, number) - before;
    return before + (u32(f32(way >> 8u) * done) << 8u);
}

// The row of the frame half a clip later.
fn later_row(row: u32) -> u32 {
    let frame = row / POSE_STRIDE;
    return (frame ^ HALF_CLIP) * POSE_STRIDE;
}

@compute @workgroup_size(64)
fn pose(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    let agent = visible[slot];
    if agent == NONE {
        return;
    }
    let own = appearance[agent];
    let weights = gait_weights[agent];
    let sum = weights.x + weights.y + weights.z + weights.w;
    let walk = walk_share(weights, stance[agent].walk_weight);
    let unit = walk / select(1.0, sum, sum > 1e-6);
    let stands = moods_of(weights, emotion_of(own)) * (1.0 - walk);
    let avatar = avatar_of(own);
    let clips = gaits[agent];
    let first = frame.standing_clips[avatar / 4u][avatar % 4u] + stance_of(agent);
    let strides = phase[agent];
    var ids = array<u32, 8>(clips.x, clips.y, clips.z, clips.w, first, first + STANCES, first + 2u * STANCES, first + 3u * STANCES);
    var shares = array<f32, 8>(weights.x * unit, weights.y * unit, weights.z * unit, weights.w * unit, stands.x, stands.y, stands.z, stands.w);
    var phases = array<u32, 8>(strides, strides, strides, strides, 0u, 0u, 0u, 0u);
    let samples = select(SAMPLES, GAITS, walk >= 1.0);
    for (var i = GAITS; i < samples; i++) {
        if shares[i] > 0.0 {
            phases[i] = weight_phase(agent, i - GAITS);
        }
    }
    // the frames between which each lies, and how far on the way
    var rows_a = array<u32, 8>();
    var rows_b = array<u32, 8>();
    var ways = array<f32, 8>();
    var travel = 0.0; // of the gaits, m
    for (var i = 0u; i < samples; i++) {
        // the top six bits are the frame, the next 24 the way to the next frame
        let first_of_clip = min(ids[i], frame.clip_count - 1u) * CLIP_FRAMES;
        let frame_a = phases[i] >> 26u;
        let frame_b = (frame_a + 1u) & (CLIP_FRAMES - 1u);
        rows_a[i] = (first_of_clip + frame_a) * POSE_STRIDE;
        rows_b[i] = (first_of_clip + frame_b) * POSE_STRIDE;
        ways[i] = unit_f32(phases[i] << 6u);
        if shares[i] > 0.0 && i < GAITS {
            travel += clip_frames[rows_a[i] + JOINTS].w * shares[i];
        }
    }
    var stride = 1.0;
    if travel > LEAST_TRAVEL {
        stride = limit(stance[agent].stride * walk / (travel * own.scale), 0.0, LONGEST);
        stride = select(stride, 1.0, abs(stride - 1.0) < AS_USUAL);
    }
    let rest = limit(0.5 - 0.5 * stride, 0.0, 0.5); // share of what is half a stride later

    for (var element = 0u; element < POSE_STRIDE; element++) {
        let is_root = element == JOINTS; // the last element is a position
        let rests = rest > 0.0 && element >= FIRST_UPPER && element < FIRST_LEG;
        var blend = vec4<f32>(0.0, 0.0, 0.0, 0.0);
        var is_first = true;
        for (var i = 0u; i < samples; i++) {
            let share = shares[i];
            if share > 0.0 {
                let a = clip_frames[rows_a[i] + element];
                let b = clip_frames[rows_b[i] + element];
                var sample = a + (b - a) * ways[i];
                if !is_root {
                    var q = quat_normalize(quat_lerp(a, b, ways[i]));
                    if rests && i < GAITS {
                        let later = later_row(rows_a[i]) + element;
                        let last = later_row(rows_b[i]) + element;
                        let r = quat_normalize(quat_lerp(clip_frames[later], clip_frames[last], ways[i]));
                        q = quat_normalize(quat_lerp(q, r, rest));
                    }
                    sample = select(q, -q, dot4(blend, q) < 0.0);
                }
                blend = select(blend + sample * share, sample * share, is_first);
                is_first = false;
            }
        }
        local_rotations[slot * POSE_STRIDE + element] = select(quat_normalize(blend), vec4<f32>(blend.xyz, stride), is_root);
    }
}

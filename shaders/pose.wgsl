// uses: frame, exact, quaternion, body, agent, standing
// The pose of every visible agent: up to four gaits, sampled at the agent's phase and blended by their weights, and
// that blended with the standing clips by the walk weight. Rotations are blended as normalised sums, each aligned with
// the sum before it, so that q and -q count as the same. Scale is applied by `palette`, not here.
//
// Strides shorter than a gait's have smaller movements of trunk, head and arms about the means of the gait. The legs are left to
// `feet`.
//
// A standing clip is a loop of shifted weight, from the left leg to the right and back. An agent rests somewhere near either
// end, and now and then shifts to the other one. It stands by a clip for each emotion that its gaits have.
@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> visible: array<u32>;                     // [visible] agents, then NONE
@group(0) @binding(2) var<storage, read> stance: array<Stance>;                   // [agent]
@group(0) @binding(3) var<storage, read> appearance: array<Appearance>;           // [agent]
@group(0) @binding(4) var<storage, read> gaits: array<vec4<u32>>;                 // [agent] clip ids
@group(0) @binding(5) var<storage, read> gait_weights: array<vec4<f32>>;          // [agent]
@group(0) @binding(6) var<storage, read> clip_frames: array<vec4<f32>>;           // [clip][64][17]
@group(0) @binding(7) var<storage, read_write> local_rotations: array<vec4<f32>>; // [visible][17]

const SAMPLES: u32 = 8u; // four gaits, then the standing clips of four emotions
const GAITS: u32 = 4u;
const EMOTIONS: u32 = 4u;
const FIRST_UPPER: u32 = 1u;  // of the joints above the legs, without the pelvis
const FIRST_LEG: u32 = 10u;

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

// The clips that are blended, with their shares; of each the rows between which its phase lies, and how far on the way.
struct Samples {
    count: u32,
    gaits: u32,  // of them, which come first
    travel: f32, // of the gaits, m
    before: array<u32, SAMPLES>,
    after: array<u32, SAMPLES>,
    mean: array<u32, SAMPLES>,
    way: array<f32, SAMPLES>,
    share: array<f32, SAMPLES>,
}

// Adds a clip at a phase: the top six bits are the frame, the next 24 the way to the next frame.
fn add_sample(samples: ptr<function, Samples>, clip: u32, at: u32, share: f32) {
    let first = min(clip, frame.clip_count - 1u) * CLIP_ROWS;
    let key = at >> 26u;
    let number = (*samples).count;
    (*samples).before[number] = (first + key) * POSE_STRIDE;
    (*samples).after[number] = (first + ((key + 1u) & (CLIP_FRAMES - 1u))) * POSE_STRIDE;
    (*samples).mean[number] = (first + CLIP_FRAMES) * POSE_STRIDE;
    (*samples).way[number] = unit_f32(at << 6u);
    (*samples).share[number] = share;
    (*samples).count = number + 1u;
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
    // only clips with a share, since devices that compute lanes together pay for what any of them may need
    var samples: Samples;
    for (var i = 0u; i < GAITS; i++) {
        let share = weights[i] * unit;
        if share > 0.0 {
            add_sample(&samples, clips[i], stance[agent].phase, share);
            samples.travel += clip_frames[samples.before[samples.gaits] + JOINTS].w * share;
            samples.gaits += 1u;
        }
    }
    for (var emotion = 0u; emotion < select(0u, EMOTIONS, walk < 1.0); emotion++) {
        if stands[emotion] > 0.0 {
            add_sample(&samples, first + emotion * STANCES, weight_phase(agent, emotion), stands[emotion]);
        }
    }
    var stride = 1.0;
    if samples.travel > LEAST_TRAVEL {
        stride = limit(stance[agent].stride * walk / (samples.travel * own.scale), 0.0, LONGEST);
        stride = select(stride, 1.0, abs(stride - 1.0) < AS_USUAL);
    }

    let at = slot * POSE_STRIDE;
    for (var joint = 0u; joint < JOINTS; joint++) {
        let rests = select(0.0, limit(1.0 - stride, 0.0, 1.0), joint >= FIRST_UPPER && joint < FIRST_LEG);
        var blend = vec4<f32>(0.0, 0.0, 0.0, 0.0);
        for (var i = 0u; i < samples.count; i++) {
            var q = quat_lerp(clip_frames[samples.before[i] + joint], clip_frames[samples.after[i] + joint], samples.way[i]);
            if rests > 0.0 && i < samples.gaits {
                q = quat_lerp(q, clip_frames[samples.mean[i] + joint], rests);
            }
            let part = select(q, -q, dot4(blend, q) < 0.0) * samples.share[i];
            blend = select(blend + part, part, i == 0u);
        }
        local_rotations[at + joint] = quat_normalize(blend);
    }
    var root = vec3<f32>(0.0, 0.0, 0.0);
    for (var i = 0u; i < samples.count; i++) {
        let a = clip_frames[samples.before[i] + JOINTS].xyz;
        let b = clip_frames[samples.after[i] + JOINTS].xyz;
        let part = (a + (b - a) * samples.way[i]) * samples.share[i];
        root = select(root + part, part, i == 0u);
    }
    local_rotations[at + JOINTS] = vec4<f32>(root, stride);
}

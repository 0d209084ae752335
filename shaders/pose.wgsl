// uses: frame, exact, quaternion, body, agent
// The pose of every visible agent: up to four gaits, sampled at the agent's phase and blended by their weights, and
// that blended with the standing clip by the walk weight. Rotations are blended as normalised sums, each aligned with
// the sum before it, so that q and -q count as the same. Scale is applied by `palette`, not here.
@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> visible: array<u32>;                     // [visible] agents, then NONE
@group(0) @binding(2) var<storage, read> phase: array<u32>;                       // [agent] the whole range is one stride
@group(0) @binding(3) var<storage, read> stance: array<Stance>;                   // [agent]
@group(0) @binding(4) var<storage, read> appearance: array<Appearance>;           // [agent]
@group(0) @binding(5) var<storage, read> gaits: array<vec4<u32>>;                 // [agent] clip ids
@group(0) @binding(6) var<storage, read> gait_weights: array<vec4<f32>>;          // [agent]
@group(0) @binding(7) var<storage, read> clip_frames: array<vec4<f32>>;           // [clip][64][17]
@group(0) @binding(8) var<storage, read_write> local_rotations: array<vec4<f32>>; // [visible][17]

const SAMPLES: u32 = 5u; // four gaits and the standing clip

@compute @workgroup_size(64)
fn pose(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    let agent = visible[slot];
    if agent == NONE {
        return;
    }
    let weights = gait_weights[agent];
    let sum = weights.x + weights.y + weights.z + weights.w;
    // with no gait to walk in, the agent stands
    let walk = select(0.0, limit(stance[agent].walk_weight, 0.0, 1.0), sum > 1e-6);
    let unit = walk / select(1.0, sum, sum > 1e-6);
    let avatar = avatar_of(appearance[agent]);
    let clips = gaits[agent];
    let standing = frame.standing_clips[avatar / 4u][avatar % 4u];
    var ids = array<u32, 5>(clips.x, clips.y, clips.z, clips.w, standing);
    var shares = array<f32, 5>(weights.x * unit, weights.y * unit, weights.z * unit, weights.w * unit, 1.0 - walk);

    // the top six bits are the frame, the next 24 the way to the next frame
    let frame_a = phase[agent] >> 26u;
    let frame_b = (frame_a + 1u) & (CLIP_FRAMES - 1u);
    let t = unit_f32(phase[agent] << 6u);

    for (var element = 0u; element < POSE_STRIDE; element++) {
        let is_root = element == JOINTS; // the last element is a position
        var blend = vec4<f32>(0.0, 0.0, 0.0, 0.0);
        var is_first = true;
        for (var i = 0u; i < SAMPLES; i++) {
            let share = shares[i];
            if share > 0.0 {
                let clip = min(ids[i], frame.clip_count - 1u) * CLIP_FRAMES;
                let a = clip_frames[(clip + frame_a) * POSE_STRIDE + element];
                let b = clip_frames[(clip + frame_b) * POSE_STRIDE + element];
                var sample = a + (b - a) * t;
                if !is_root {
                    let q = quat_normalize(quat_lerp(a, b, t));
                    sample = select(q, -q, dot4(blend, q) < 0.0);
                }
                blend = select(blend + sample * share, sample * share, is_first);
                is_first = false;
            }
        }
        local_rotations[slot * POSE_STRIDE + element] = select(quat_normalize(blend), blend, is_root);
    }
}

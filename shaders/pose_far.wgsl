// uses: frame, exact, quaternion, body, agent, far
// How every far body holds itself: an emotion is seen from afar by posture, and so trunk, head and arms are held as in the
// clips that the agent walks. The draw shader moves the limbs of a mesh by these angles. A kernel of its own since a draw
// shader would read eleven buffers for it, more than some devices bind.
@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> agent_bucket: array<u32>;           // [agent]
@group(0) @binding(2) var<storage, read> heading: array<f32>;                // [agent] rad
@group(0) @binding(3) var<storage, read> stance: array<Stance>;              // [agent]
@group(0) @binding(4) var<storage, read> elevation: array<f32>;              // [agent] m
@group(0) @binding(5) var<storage, read> gaits: array<vec4<u32>>;            // [agent] clip ids
@group(0) @binding(6) var<storage, read> gait_weights: array<vec4<f32>>;     // [agent]
@group(0) @binding(7) var<storage, read> clip_postures: array<ClipPosture>;  // [clip]
@group(0) @binding(8) var<storage, read_write> far_poses: array<FarPose>;    // [agent]

const TURN: f32 = 6.2831853;       // rad of a stride
const STEPS: f32 = 16777216.0;     // of a phase without its lowest eight bits

fn posture_of(clip: u32) -> vec4<f32> {
    let own = clip_postures[min(clip, frame.clip_count - 1u)];
    return vec4<f32>(own.lean, own.nod, own.spread, own.swing);
}

// The mean of the clips that the agent walks.
fn posture(agent: u32) -> vec4<f32> {
    let weights = gait_weights[agent];
    let clips = gaits[agent];
    if weights.y == 0.0 && weights.z == 0.0 && weights.w == 0.0 {
        return posture_of(clips.x);
    }
    let sum = posture_of(clips.x) * weights.x + posture_of(clips.y) * weights.y
        + posture_of(clips.z) * weights.z + posture_of(clips.w) * weights.w;
    return sum / max(weights.x + weights.y + weights.z + weights.w, 1e-6);
}

@compute @workgroup_size(64)
fn pose_far(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= frame.agent_count {
        return;
    }
    let bucket = agent_bucket[agent];
    if bucket == NONE || bucket < frame.bucket_count {
        return;
    }
    let walk = limit(stance[agent].walk_weight, 0.0, 1.0);
    let faces = exact_sin_cos(heading[agent]);
    let stride = exact_sin_cos(f32(stance[agent].phase >> 8u) * (TURN / STEPS)).y;
    let held = posture(agent);
    far_poses[agent] = FarPose(
        faces.x,
        faces.y,
        stride * walk,
        elevation[agent],
        held.x * walk,
        held.y * walk,
        held.z * walk,
        held.w,
    );
}

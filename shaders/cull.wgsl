// uses: frame, exact, body, absent, agent
// Which agents may be seen and how finely: each agent's bucket (avatar * levels + level of detail; far bodies
// bucket_count + avatar, specks behind all of these), or NONE.
// An upright capsule of agent_height and agent_radius, times the agent's size, is tested against the frusta;
// the level follows from the camera's distance to its middle. `compact` turns the buckets into lists.
// All inputs of the animation kernels are judged here: an agent with an impossible one is not drawn and reported.
const HEADING_LIMIT: f32 = 10000.0; // rad; beyond it a float has no direction left
const SCALE_LIMIT: f32 = 100.0;
const ELEVATION_LIMIT: f32 = 10000.0; // m
const WEIGHT_LIMIT: f32 = 1000000.0;
const STRIDE_LIMIT: f32 = 10000.0; // m

@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;        // [agent] m
@group(0) @binding(2) var<storage, read> stance: array<Stance>;             // [agent]
@group(0) @binding(3) var<storage, read> appearance: array<Appearance>;     // [agent]
@group(0) @binding(4) var<storage, read> gaits: array<vec4<u32>>;           // [agent] clip ids
@group(0) @binding(5) var<storage, read> gait_weights: array<vec4<f32>>;    // [agent]
@group(0) @binding(6) var<storage, read> elevation: array<f32>;             // [agent] m
@group(0) @binding(7) var<storage, read_write> agent_bucket: array<u32>;    // [agent]
@group(0) @binding(8) var<storage, read_write> failure: array<atomic<u32>>; // [kernel] smallest agent that failed
@group(0) @binding(9) var<storage, read> heading: array<f32>;               // [agent] rad

// Neither NaN (every comparison is false) nor out of range; an unweighted gait may be anything.
fn gait_is_usable(clip: u32, weight: f32) -> bool {
    return weight >= 0.0 && weight < WEIGHT_LIMIT && (weight == 0.0 || clip < frame.clip_count);
}

fn is_usable(agent: u32, avatar: u32, scale: f32) -> bool {
    let own = stance[agent];
    let clips = gaits[agent];
    let weights = gait_weights[agent];
    return is_finite2(position[agent]) && abs(elevation[agent]) < ELEVATION_LIMIT
        && abs(heading[agent]) < HEADING_LIMIT && abs(own.walk_weight) < WEIGHT_LIMIT && abs(own.stride) < STRIDE_LIMIT
        && is_finite2(own.left) && is_finite2(own.right) && is_finite2(own.turns) && is_finite2(own.lean)
        && is_finite2(own.heights) && is_finite2(own.slopes) && abs(own.foresight) < HEADING_LIMIT
        && scale > 0.0 && scale < SCALE_LIMIT
        && frame.clip_count > 0u && (avatar + 1u) * frame.level_count <= frame.bucket_count
        && gait_is_usable(clips.x, weights.x) && gait_is_usable(clips.y, weights.y)
        && gait_is_usable(clips.z, weights.z) && gait_is_usable(clips.w, weights.w);
}

// Whether the capsule about the axis from (x, low, z) to (x, high, z) reaches inside all planes of one eye.
fn eye_sees(eye: u32, x: f32, low: f32, high: f32, z: f32, radius: f32) -> bool {
    var inside = true;
    for (var i = 0u; i < 6u; i++) {
        let plane = frame.planes[eye * 6u + i];
        let foot = plane.x * x + plane.y * low + plane.z * z + plane.w;
        let top = plane.x * x + plane.y * high + plane.z * z + plane.w;
        inside = inside && (foot >= -radius || top >= -radius);
    }
    return inside;
}

@compute @workgroup_size(64)
fn cull(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= frame.agent_count {
        return;
    }
    let info = appearance[agent];
    let avatar = avatar_of(info);
    let scale = info.scale;
    agent_bucket[agent] = NONE;
    if !is_usable(agent, avatar, scale) {
        atomicMin(&failure[KERNEL_ID], agent);
        return;
    }
    let at = position[agent];
    if is_absent(at) || is_bodiless(info) {
        return;
    }
    let height = frame.agent_height * scale * stature_of(info);
    let radius = frame.agent_radius * scale * max(breadth_of(info), 1.0);
    let foot = elevation[agent];
    let low = foot + radius;
    let high = foot + select(radius, height - radius, height - radius > radius); // never below its own foot
    if !(eye_sees(0u, at.x, low, high, at.y, radius)
        || (frame.eye_count > 1u && eye_sees(1u, at.x, low, high, at.y, radius))) {
        return;
    }
    let dx = at.x - frame.camera.x;
    let dy = foot + 0.5 * height - frame.camera.y;
    let dz = at.y - frame.camera.z;
    let distance = sqrt(dx * dx + dy * dy + dz * dz);
    if !(distance <= frame.level_distance.z) {
        return;
    }
    var level = 0u;
    if frame.level_count > 1u && distance >= frame.level_distance.x {
        level = 1u;
    }
    if frame.level_count > 2u && distance >= frame.level_distance.y {
        level = 2u;
    }
    var bucket = avatar * frame.level_count + level;
    if frame.level_distance.w > 0.0 && distance >= frame.level_distance.w {
        bucket = frame.bucket_count + avatar;
        if frame.camera.w > 0.0 && distance >= frame.camera.w {
            bucket += frame.bucket_count / max(frame.level_count, 1u);
        }
    }
    agent_bucket[agent] = bucket;
}

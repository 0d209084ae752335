// uses: body, agent
// Puts the pose of every visible agent on the floor it stands on: raises the root by the agent's elevation. A kernel of
// its own because `pose`, `gaze` and `palette` bind as many buffers as every device has.
@group(0) @binding(0) var<storage, read> visible: array<u32>;                     // [visible] agents, then NONE
@group(0) @binding(1) var<storage, read> elevation: array<f32>;                   // [agent] m
@group(0) @binding(2) var<storage, read> appearance: array<Appearance>;           // [agent]
@group(0) @binding(3) var<storage, read_write> local_rotations: array<vec4<f32>>; // [visible][17]

@compute @workgroup_size(64)
fn stand(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    let agent = visible[slot];
    if agent == NONE {
        return;
    }
    // the root is in model space, before the agent's scale
    let root = slot * POSE_STRIDE + JOINTS;
    local_rotations[root].y = local_rotations[root].y + elevation[agent] / appearance[agent].scale;
}

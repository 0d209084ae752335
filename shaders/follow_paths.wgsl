// uses: step
// Where agents that are led on a scripted path are to be at the end of the step (robots, vehicles, people of a
// scenario); `lead_agents` brings them there.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> paths: array<vec4<u32>>;              // [path] agent, first keyframe, keyframes, 0
@group(0) @binding(2) var<storage, read> keyframes: array<vec4<f32>>;          // time, s; x, z, m; 0
@group(0) @binding(3) var<storage, read_write> lead: array<vec4<f32>>;         // [agent] target, m (ABSENT: not there); velocity on appearing, m/s

@compute @workgroup_size(64)
fn follow_paths(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= step.path_count {
        return;
    }
    let path = paths[id.x];
    if path.z == 0u {
        return; // somebody leads it by hand
    }
    // straight between keyframes, at rest before the first and after the last
    let time = f32(step.step_index + 1u) * step.time_step;
    var at = keyframes[path.y].yz;
    var velocity = vec2<f32>(0.0, 0.0);
    for (var k = path.y + 1u; k < path.y + path.z; k++) {
        let start = keyframes[k - 1u];
        let end = keyframes[k];
        if time >= start.x {
            let span = end.x - start.x;
            let share = min((time - start.x) / span, 1.0);
            let way = end.yz - start.yz;
            at = start.yz + way * share;
            velocity = select(vec2<f32>(0.0, 0.0), way / span, share < 1.0);
        }
    }
    lead[path.x] = vec4<f32>(at, velocity);
}

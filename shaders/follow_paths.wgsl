// uses: step, agent
// Where agents that are led on a scripted path are to be at the end of the step (robots, vehicles, people of a
// scenario); `lead_agents` brings them there.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> paths: array<Path>;         // [path]
@group(0) @binding(2) var<storage, read> keyframes: array<Keyframe>; // of all paths, one after another
@group(0) @binding(3) var<storage, read_write> lead: array<Lead>;    // [agent]

fn place_of(keyframe: Keyframe) -> vec2<f32> {
    return vec2<f32>(keyframe.x, keyframe.z);
}

@compute @workgroup_size(64)
fn follow_paths(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= step.path_count {
        return;
    }
    let path = paths[id.x];
    if path.keyframes == 0u {
        return; // the host leads this agent directly
    }
    // straight between keyframes, at rest before the first and after the last
    let time = f32(step.step_index + 1u) * step.time_step;
    var at = place_of(keyframes[path.first_keyframe]);
    var velocity = vec2<f32>(0.0, 0.0);
    for (var k = path.first_keyframe + 1u; k < path.first_keyframe + path.keyframes; k++) {
        let start = keyframes[k - 1u];
        let end = keyframes[k];
        if time >= start.time {
            let span = end.time - start.time;
            let share = min((time - start.time) / span, 1.0);
            let way = place_of(end) - place_of(start);
            at = place_of(start) + way * share;
            velocity = select(vec2<f32>(0.0, 0.0), way / span, share < 1.0);
        }
    }
    lead[path.agent] = Lead(at, velocity);
}

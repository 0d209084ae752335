// uses: step
// Until its reaction time has passed an agent wants to stand where it is (RiMEA's test 5); others may still push past.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> reaction: array<u32>;                       // [agent] first step in which it walks
@group(0) @binding(2) var<storage, read_write> preferred_velocity: array<vec2<f32>>; // [agent] m/s

@compute @workgroup_size(64)
fn react(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent < step.agent_count && step.step_index < reaction[agent] {
        preferred_velocity[agent] = vec2<f32>(0.0, 0.0);
    }
}

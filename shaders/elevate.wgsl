// uses: step, exact, absent, floors
// How high each agent stands, by the rule of floors.wgsl.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;  // [agent] m
@group(0) @binding(2) var<storage, read> floors: array<vec4<f32>>;    // [floor][9] see floors.wgsl
@group(0) @binding(3) var<storage, read_write> elevation: array<f32>; // [agent] m

@compute @workgroup_size(64)
fn elevate(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count || is_absent(position[agent]) {
        return;
    }
    elevation[agent] = standing(position[agent], elevation[agent]).height;
}

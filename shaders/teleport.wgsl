// uses: step, exact, absent, agent
// Endless corridors: an agent that enters the first box of its teleport is at a random place of the second box from this
// step on. The kernel runs before all others, so that the grid holds every agent at its new place.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> teleports: array<Teleport>;       // [teleport]
@group(0) @binding(2) var<storage, read> teleport_of: array<u32>;          // [agent] its teleport, or NOBODY for none
@group(0) @binding(3) var<storage, read_write> position: array<vec2<f32>>; // [agent] m

@compute @workgroup_size(64)
fn teleport(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count {
        return;
    }
    let own = teleport_of[agent];
    if own == NOBODY {
        return;
    }
    let here = position[agent];
    let boxes = teleports[own];
    let low = boxes.from_low;
    let high = boxes.from_high;
    if here.x < low.x || here.y < low.y || here.x > high.x || here.y > high.y {
        return;
    }
    let bits = hash_u32(agent ^ hash_u32(step.step_index ^ ~step.seed));
    let share = vec2<f32>(unit_f32(bits), unit_f32(hash_u32(bits)));
    position[agent] = boxes.to_low + (boxes.to_high - boxes.to_low) * share;
}

// uses: step, contents, absent
// Copies what neighbours read of each agent to its slot, so that what is read together lies together.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> slot_agent: array<u32>;               // [slot]
@group(0) @binding(2) var<storage, read> position: array<vec2<f32>>;           // [agent] m
@group(0) @binding(3) var<storage, read> velocity: array<vec2<f32>>;           // [agent] m/s
@group(0) @binding(4) var<storage, read> body: array<vec4<f32>>;               // [agent] radius, maximum speed, ...
@group(0) @binding(5) var<storage, read> avoidance: array<vec4<f32>>;            // [agent] 1/horizon, neighbour distance, neighbour cap, priority; of the led, x is their comfort distance, m
@group(0) @binding(6) var<storage, read> elevation: array<f32>;                // [agent] m
@group(0) @binding(7) var<storage, read_write> slot_motion: array<vec4<f32>>;  // [slot][2] position, velocity; radius, maximum speed, priority, elevation
@group(0) @binding(8) var<storage, read_write> slot_avoidance: array<vec4<u32>>; // [slot] agent, 1/horizon (bits), neighbour distance (bits), neighbour cap + LED_BIT

@compute @workgroup_size(64)
fn grid_pack(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= step.agent_count {
        return;
    }
    let agent = slot_agent[slot];
    if agent == NOBODY {
        slot_avoidance[slot] = vec4<u32>(NOBODY, 0u, 0u, 0u);
        return;
    }
    slot_motion[slot * 2u] = vec4<f32>(position[agent], velocity[agent]);
    var own = avoidance[0];
    if (contents & UNLIKE) != 0u {
        own = avoidance[agent];
    }
    // people keep their distance from those who are led from outside, and these avoid nobody
    let is_led = own.w >= LED;
    let comfort = select(0.0, own.x, is_led);
    slot_avoidance[slot] =
        vec4<u32>(agent, bitcast<u32>(own.x), bitcast<u32>(own.y), u32(own.z) | select(0u, LED_BIT, is_led));
    var height = 0.0;
    if (contents & (STOREYS | WALLS)) != 0u { // some walls stand at some heights only
        height = elevation[agent];
    }
    slot_motion[slot * 2u + 1u] = vec4<f32>(body[agent].x + comfort, body[agent].y, own.w, height);
}

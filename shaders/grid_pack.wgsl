// uses: step, contents, absent, agent
// Copies what neighbours read of each agent to its slot, so that what is read together lies together.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> slot_agent: array<u32>;                     // [slot]
@group(0) @binding(2) var<storage, read> position: array<vec2<f32>>;                 // [agent] m
@group(0) @binding(3) var<storage, read> velocity: array<vec2<f32>>;                 // [agent] m/s
@group(0) @binding(4) var<storage, read> body: array<Body>;                          // [agent]
@group(0) @binding(5) var<storage, read> avoidance: array<Avoidance>;                // [agent]
@group(0) @binding(6) var<storage, read> elevation: array<f32>;                      // [agent] m
@group(0) @binding(7) var<storage, read_write> slot_motion: array<SlotMotion>;       // [slot]
@group(0) @binding(8) var<storage, read_write> slot_avoidance: array<SlotAvoidance>; // [slot]

@compute @workgroup_size(64)
fn grid_pack(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= step.agent_count {
        return;
    }
    let agent = slot_agent[slot];
    if agent == NOBODY {
        slot_avoidance[slot] = SlotAvoidance(NOBODY, 0.0, 0.0, 0u);
        return;
    }
    var own = avoidance[0];
    if (contents & UNLIKE) != 0u {
        own = avoidance[agent];
    }
    // other agents keep their distance from an agent led from outside, and it avoids none of them
    let is_led = own.priority >= LED;
    let comfort = select(0.0, own.inverse_time_horizon, is_led);
    let limits = u32(own.neighbour_cap) | select(0u, LED_BIT, is_led);
    slot_avoidance[slot] = SlotAvoidance(agent, own.inverse_time_horizon, own.neighbour_distance, limits);
    var height = 0.0;
    if (contents & (STOREYS | WALLS)) != 0u { // some walls stand at some heights only
        height = elevation[agent];
    }
    let size = body[agent];
    slot_motion[slot] = SlotMotion(
        position[agent], velocity[agent], size.radius + comfort, size.max_speed, own.priority, height,
    );
}

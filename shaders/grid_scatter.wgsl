// uses: step, cells, contents, absent, agent
// Puts the agents in cell order, within a cell by id, so that the order does not depend on which thread came first: an agent's
// slot is the first one of its cell, plus as many as agents of lower ids are there. Copies what neighbours read of each agent
// to its slot, so that what is read together lies together. Absent agents have no slot; as many slots at the end are empty.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> cells: array<u32>;                 // [cell][2] see cells.wgsl
@group(0) @binding(2) var<storage, read> next_in_cell: array<u32>;          // [agent] see cells.wgsl
@group(0) @binding(3) var<storage, read_write> cell_start: array<u32>;      // see cells.wgsl
@group(0) @binding(4) var<storage, read> position: array<vec2<f32>>;        // [agent] m
@group(0) @binding(5) var<storage, read> velocity: array<vec2<f32>>;        // [agent] m/s
@group(0) @binding(6) var<storage, read> body: array<Body>;                 // [agent]
@group(0) @binding(7) var<storage, read> avoidance: array<Avoidance>;       // [agent]
@group(0) @binding(8) var<storage, read> elevation: array<f32>;             // [agent] m
@group(0) @binding(9) var<storage, read_write> slot_position: array<vec2<f32>>;        // [slot] m
@group(0) @binding(10) var<storage, read_write> slot_motion: array<SlotMotionQuads>;       // [slot]
@group(0) @binding(11) var<storage, read_write> agent_slot: array<u32>;     // [agent] NOBODY if absent

@compute @workgroup_size(64)
fn grid_scatter(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x; // and the number of a cell, and of a slot
    if agent < step.cell_count {
        cell_start[agent] = start_of(agent);
    }
    if agent >= step.agent_count {
        return;
    }
    if agent >= cell_start[step.cell_count] {
        slot_motion[agent] = motion_quads(SlotMotion(vec2<f32>(0.0, 0.0), 0.0, 0.0, 0.0, 0.0, NOBODY, 0u));
    }
    let at = position[agent];
    if is_absent(at) {
        agent_slot[agent] = NOBODY;
        return;
    }
    let motion = motion_of(agent); // before the list is walked: a GPU then waits for both at once
    let cell = cell_at(at);
    var slot = start_of(cell);
    var other = cells[CELL_WORDS * cell + 1u];
    while other > 0u {
        slot += u32(other <= agent); // other is an id plus 1
        other = next_in_cell[other - 1u];
    }
    agent_slot[agent] = slot;
    slot_position[slot] = at;
    slot_motion[slot] = motion_quads(motion);
}

// The slot of a cell's first agent.
fn start_of(cell: u32) -> u32 {
    return cells[CELL_WORDS * cell] + cell_start[in_groups(cell / GROUP_CELLS)];
}

// What others read of an agent.
fn motion_of(agent: u32) -> SlotMotion {
    var own = avoidance[0];
    if (contents & UNLIKE) != 0u {
        own = avoidance[agent];
    }
    // other agents keep their distance from an agent led from outside, and it avoids none of them
    let is_led = own.priority >= LED;
    let comfort = select(0.0, own.inverse_time_horizon, is_led);
    let limits = u32(own.neighbour_cap) | select(0u, LED_BIT, is_led);
    var height = 0.0;
    if (contents & (STOREYS | WALLS)) != 0u { // some walls stand at some heights only
        height = elevation[agent];
    }
    let size = body[agent];
    return SlotMotion(velocity[agent], size.radius + comfort, size.max_speed, own.priority, height, agent, limits);
}

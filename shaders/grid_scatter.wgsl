// uses: step, grid, absent
// Puts the agents in cell order, within a cell by id, so that the order does not depend on which thread came first.
// Absent agents have no slot; as many slots at the end are empty. The phases, in this order:
//   place (agent): takes the next free place of its cell (any order),
//   sort (cell):   sorts its agents by id and clears its count.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> cell_start: array<u32>;                // [cell + 1]
@group(0) @binding(2) var<storage, read_write> cell_counts: array<atomic<u32>>; // [cell], zero before and after
@group(0) @binding(3) var<storage, read_write> slot_agent: array<u32>;          // [slot]
@group(0) @binding(4) var<storage, read> position: array<vec2<f32>>;            // [agent] m
@group(0) @binding(5) var<storage, read_write> agent_slot: array<u32>;          // [agent] NOBODY if absent

@compute @workgroup_size(64)
fn grid_scatter_place(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= step.agent_count {
        return;
    }
    if is_absent(position[id.x]) {
        agent_slot[id.x] = NOBODY;
        return;
    }
    let at = grid_cell(position[id.x], step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let cell = u32(at.y) * step.grid_columns + u32(at.x);
    slot_agent[cell_start[cell] + atomicAdd(&cell_counts[cell], 1u)] = id.x;
}

@compute @workgroup_size(64)
fn grid_scatter_sort(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < step.agent_count && id.x >= cell_start[step.cell_count] {
        slot_agent[id.x] = NOBODY;
    }
    if id.x >= step.cell_count {
        return;
    }
    let first = cell_start[id.x];
    let end = cell_start[id.x + 1u];
    // Shell's sort: a cell holds a handful, but one at the border may hold hundreds, and a driver may allow an
    // invocation no more than 65,535 turns of its loops.
    var gap = 1u;
    while gap < (end - first) / 3u {
        gap = gap * 3u + 1u;
    }
    for (; gap > 0u; gap /= 3u) {
        for (var i = first + gap; i < end; i++) {
            let agent = slot_agent[i];
            var hole = i;
            while hole >= first + gap {
                let before = slot_agent[hole - gap];
                if before <= agent {
                    break;
                }
                slot_agent[hole] = before;
                hole -= gap;
            }
            slot_agent[hole] = agent;
        }
    }
    for (var slot = first; slot < end; slot++) {
        agent_slot[slot_agent[slot]] = slot;
    }
    atomicStore(&cell_counts[id.x], 0u);
}

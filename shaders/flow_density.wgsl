// uses: step, exact, way, absent, floors, dispatch
// What a metre costs on each cell of the flow grid: 1 + density_weight times the density of people around, agents/m2 of
// free ground, so that the emptier of two ways is the shorter (after Treuille, Cooper and Popovic, Continuum crowds,
// 2006, without their flow speed). Density is a mean over 2 window + 1 cells each way. The phases, in this order:
//   clear (cell):  clears the counts,
//   count (agent): counts,
//   rows (cell):   sums along rows,
//   cost (cell):   sums along columns, the cost.

@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<uniform> flow_grid: FlowUniforms;
@group(0) @binding(2) var<storage, read> position: array<vec2<f32>>;            // [agent] m
@group(0) @binding(3) var<storage, read_write> flow_cells: array<u32>;          // [cell] bits and step, see way.wgsl
@group(0) @binding(4) var<storage, read> flow_room: array<f32>;                 // [cell] m2 of free ground in the window around
@group(0) @binding(5) var<storage, read_write> flow_counts: array<atomic<u32>>; // [cell] agents
@group(0) @binding(6) var<storage, read_write> flow_sums: array<u32>;           // [cell] agents along the row
@group(0) @binding(7) var<storage, read> elevation: array<f32>;                 // [agent] m
@group(0) @binding(8) var<storage, read> floors: array<vec4<f32>>;              // [floor][9] see floors.wgsl

fn index_of(id: vec3<u32>) -> u32 {
    return id.x + id.y * MOST_GROUPS * 64u;
}

@compute @workgroup_size(64)
fn flow_density_clear(@builtin(global_invocation_id) id: vec3<u32>) {
    let cell = index_of(id);
    if cell < flow_grid.cell_count {
        atomicStore(&flow_counts[cell], 0u);
    }
}

@compute @workgroup_size(64)
fn flow_density_count(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = index_of(id);
    if agent >= step.agent_count || is_absent(position[agent]) {
        return;
    }
    let scaled = (position[agent] - flow_grid.origin) * flow_grid.inverse_cell_size;
    if scaled.x >= 0.0 && scaled.y >= 0.0 && scaled.x < f32(flow_grid.columns) && scaled.y < f32(flow_grid.sheet_rows) {
        var first = 0u;
        if flow_grid.sheet_rows < flow_grid.rows {
            let sheet = u32(standing(position[agent], elevation[agent]).sheet);
            first = min(sheet * flow_grid.sheet_rows, flow_grid.rows - flow_grid.sheet_rows);
        }
        atomicAdd(&flow_counts[(first + u32(scaled.y)) * flow_grid.columns + u32(scaled.x)], 1u);
    }
}

@compute @workgroup_size(64)
fn flow_density_rows(@builtin(global_invocation_id) id: vec3<u32>) {
    let cell = index_of(id);
    if cell >= flow_grid.cell_count {
        return;
    }
    let column = cell % flow_grid.columns;
    let row = cell / flow_grid.columns;
    let low = column - min(column, flow_grid.window);
    let high = min(column + flow_grid.window, flow_grid.columns - 1u);
    var sum = 0u;
    for (var x = low; x <= high; x++) {
        sum += atomicLoad(&flow_counts[row * flow_grid.columns + x]);
    }
    flow_sums[cell] = sum;
}

@compute @workgroup_size(64)
fn flow_density_cost(@builtin(global_invocation_id) id: vec3<u32>) {
    let cell = index_of(id);
    if cell >= flow_grid.cell_count {
        return;
    }
    let column = cell % flow_grid.columns;
    let row = cell / flow_grid.columns;
    let low = row - min(row, flow_grid.window);
    let high = min(row + flow_grid.window, flow_grid.rows - 1u);
    var sum = 0u;
    for (var z = low; z <= high; z++) {
        sum += flow_sums[z * flow_grid.columns + column];
    }
    var size = flow_grid.solid_step;
    if (flow_cells[cell] & SOLID) == 0u {
        size = flow_grid.cell_size * (1.0 + flow_grid.density_weight * (f32(sum) / flow_room[cell]));
    }
    flow_cells[cell] = way_with_step(flow_cells[cell], size);
}

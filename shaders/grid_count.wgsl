// uses: step, grid, absent
// Counts the agents of each cell. Absent agents are in none. cell_counts must be zero before (grid_scatter leaves it so).
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;            // [agent] m
@group(0) @binding(2) var<storage, read_write> cell_counts: array<atomic<u32>>; // [cell]

@compute @workgroup_size(64)
fn grid_count(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count || is_absent(position[agent]) {
        return;
    }
    let at = grid_cell(position[agent], step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    atomicAdd(&cell_counts[u32(at.y) * step.grid_columns + u32(at.x)], 1u);
}

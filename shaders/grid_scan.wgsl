// uses: step, scan, cells
// Where each cell's agents begin among all, in cell order. Each group counts the agents before each of its cells within the
// group, some in each lane. The group that is done last counts the agents before each group, and all; it empties the list of unsolved agents,
// too. `grid_scatter` adds the two counts up.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read_write> cells: array<u32>;              // [cell][2] see cells.wgsl
@group(0) @binding(2) var<storage, read_write> cell_start: array<atomic<u32>>; // see cells.wgsl
@group(0) @binding(3) var<storage, read_write> unsolved: array<u32>;           // see unsolved.wgsl

var<workgroup> groups_left: u32; // to be summed up by this workgroup: all, or none

@compute @workgroup_size(LANES)
fn grid_scan(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let groups = (step.cell_count + GROUP_CELLS - 1u) / GROUP_CELLS;
    let first_cell = id.x * LANE_CELLS;
    let end_cell = min(first_cell + LANE_CELLS, step.cell_count);
    var agents = 0u;
    for (var cell = first_cell; cell < end_cell; cell++) {
        agents += cells[CELL_WORDS * cell];
    }
    let own = scan(lane, agents);
    var before = own.before;
    for (var cell = first_cell; cell < end_cell; cell++) {
        let inside = cells[CELL_WORDS * cell];
        cells[CELL_WORDS * cell] = before;
        before += inside;
    }
    if lane == 0u {
        groups_left = 0u;
        if groups == 1u {
            // a small crowd: nothing is before its group, and no sums are left
            atomicStore(&cell_start[in_groups(0u)], 0u);
            end_with(own.total);
        } else if group.x < groups {
            atomicStore(&cell_start[in_groups(group.x)], own.total);
        }
    }
    storageBarrier(); // the sum is visible before the group counts as done
    if lane == 0u && groups > 1u && group.x < groups && atomicAdd(&cell_start[in_groups(groups)], 1u) == groups - 1u {
        groups_left = groups;
    }
    storageBarrier();
    let left = workgroupUniformLoad(&groups_left);
    var total = 0u;
    for (var first = 0u; first < left; first += LANES) {
        let one = first + lane;
        var sum = 0u;
        if one < left {
            sum = atomicLoad(&cell_start[in_groups(one)]);
        }
        let whole = scan(lane, sum);
        if one < left {
            atomicStore(&cell_start[in_groups(one)], total + whole.before);
        }
        total += whole.total;
    }
    if lane == 0u && left > 0u {
        atomicStore(&cell_start[in_groups(groups)], 0u);
        end_with(total);
    }
}

// What one invocation does at the end: no agent has to try again yet.
fn end_with(total: u32) {
    atomicStore(&cell_start[step.cell_count], total);
    atomicStore(&cell_start[step_word()], step.step_index);
    unsolved[0] = 0u;
    unsolved[1] = 1u;
    unsolved[2] = 1u;
    unsolved[3] = 0u;
    unsolved[4] = 0u;
}

// uses: step, scan
// Exclusive prefix sum of cell_counts into cell_start. A group is LANES cells. The phases, in this order:
//   sum (cell):        adds up each group into group_sums,
//   groups (one group): turns group_sums into their exclusive prefix sum and writes the total behind the last cell; it
//                      empties the list of unsolved agents, too,
//   cells (cell):      writes cell_start and clears cell_counts, which grid_scatter uses next.

@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read_write> cell_counts: array<u32>; // [cell]
@group(0) @binding(2) var<storage, read_write> group_sums: array<u32>;  // [cell / LANES, rounded up]
@group(0) @binding(3) var<storage, read_write> cell_start: array<u32>;  // [cell + 1]
@group(0) @binding(4) var<storage, read_write> unsolved: array<u32>;    // see velocity_orca

fn count_of(cell: u32) -> u32 {
    if cell < step.cell_count {
        return cell_counts[cell];
    }
    return 0u;
}

@compute @workgroup_size(LANES)
fn grid_scan_sum(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let sums = scan(lane, count_of(id.x));
    if lane == 0u {
        group_sums[group.x] = sums.total;
    }
}

@compute @workgroup_size(LANES)
fn grid_scan_groups(@builtin(local_invocation_index) lane: u32) {
    let groups = (step.cell_count + LANES - 1u) / LANES;
    var total = 0u;
    for (var first = 0u; first < groups; first += LANES) {
        let group = first + lane;
        var sum = 0u;
        if group < groups {
            sum = group_sums[group];
        }
        let sums = scan(lane, sum);
        if group < groups {
            group_sums[group] = total + sums.before;
        }
        total += sums.total;
    }
    if lane == 0u {
        cell_start[step.cell_count] = total;
        // no agent has to try again yet
        unsolved[0] = 0u;
        unsolved[1] = 1u;
        unsolved[2] = 1u;
        unsolved[3] = 0u;
    }
}

@compute @workgroup_size(LANES)
fn grid_scan_cells(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let sums = scan(lane, count_of(id.x));
    if id.x < step.cell_count {
        cell_start[id.x] = group_sums[group.x] + sums.before;
        cell_counts[id.x] = 0u;
    }
}

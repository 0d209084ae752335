// uses: step, dispatch
// Exclusive prefix sum of cell_counts into cell_start. The phases, in this order:
//   sum (run):   adds up a run of RUN cells into run_sums,
//   runs (one):  turns run_sums into their exclusive prefix sum and writes the total behind the last cell; it empties the
//                list of unsolved agents, too,
//   cells (run): walks the run again, writes cell_start and clears cell_counts, which grid_scatter uses next.
// No workgroup barrier anywhere: on software devices a barrier costs more than the sums.

@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read_write> cell_counts: array<u32>; // [cell]
@group(0) @binding(2) var<storage, read_write> run_sums: array<u32>;    // [cell / RUN, rounded up]
@group(0) @binding(3) var<storage, read_write> cell_start: array<u32>;  // [cell + 1]
@group(0) @binding(4) var<storage, read_write> unsolved: array<u32>;    // see velocity_orca

fn run_count() -> u32 {
    return (step.cell_count + RUN - 1u) / RUN;
}

@compute @workgroup_size(64)
fn grid_scan_sum(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= run_count() {
        return;
    }
    let first = id.x * RUN;
    var sum = 0u;
    for (var cell = first; cell < min(first + RUN, step.cell_count); cell++) {
        sum += cell_counts[cell];
    }
    run_sums[id.x] = sum;
}

@compute @workgroup_size(64)
fn grid_scan_runs(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x > 0u {
        return;
    }
    var total = 0u;
    for (var run = 0u; run < run_count(); run++) {
        let sum = run_sums[run];
        run_sums[run] = total;
        total += sum;
    }
    cell_start[step.cell_count] = total;
    // no agent has to try again yet
    unsolved[0] = 0u;
    unsolved[1] = 1u;
    unsolved[2] = 1u;
    unsolved[3] = 0u;
}

@compute @workgroup_size(64)
fn grid_scan_cells(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= run_count() {
        return;
    }
    let first = id.x * RUN;
    var sum = run_sums[id.x];
    for (var cell = first; cell < min(first + RUN, step.cell_count); cell++) {
        cell_start[cell] = sum;
        sum += cell_counts[cell];
        cell_counts[cell] = 0u;
    }
}

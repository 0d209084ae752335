// uses: frame, body, dispatch
// Turns agent_bucket into the list of visible agents, sorted by bucket and then by id, and into the arguments of the
// dispatches and draws that follow. No atomics decide an order and no barrier is needed.
// A run is RUN agents that one invocation walks. Row r of bucket_counts is run r, the row behind the last run holds
// the totals. The phases, in this order:
//   count (run):           counts level-0 agents (column 0) and all visible agents (column 1),
//   scan_visible (column): exclusive prefix sums of these two over the runs,
//   demote (run):          level-0 agents beyond near_capacity, in order of id, go down to level 1; agents beyond
//                          visible_capacity become far bodies, or, where there are none, are dropped and reported;
//                          then counts the agents of each bucket,
//   scan_buckets (bucket): exclusive prefix sums over the runs, totals,
//   arguments (one):       bucket_start, draw_args, dispatch_args, and NONE behind the posed agents of `visible`,
//   list (run):            writes `visible`.
// Far bodies (buckets from bucket_count on) have no pose: they stand in `visible` behind the room for those that have.
// dispatch_args: 3 words of groups for kernels of one invocation per visible agent (64 a group), then 3 words per
// avatar for `skin`: x covers the vertices of its level 0, y its near agents.
const COLUMNS: u32 = 32u;    // columns of a row of bucket_counts, the most buckets there can be

@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read_write> agent_bucket: array<u32>;    // [agent]
@group(0) @binding(2) var<storage, read_write> bucket_counts: array<u32>;   // [run + 1][32]
@group(0) @binding(3) var<storage, read_write> bucket_start: array<u32>;    // [posed bucket + 1][far bucket + 1], each with its end
@group(0) @binding(4) var<storage, read_write> visible: array<u32>;         // [(visible_capacity / 64 + 1) * 64] agents, then NONE; then far bodies
@group(0) @binding(5) var<storage, read> mesh_table: array<MeshRange>;      // [bucket]
@group(0) @binding(6) var<storage, read_write> draw_args: array<u32>;       // [2][bucket][5] VkDrawIndexedIndirectCommand: of images, of shadows
@group(0) @binding(7) var<storage, read_write> dispatch_args: array<u32>;   // [1 + avatar][3]
@group(0) @binding(8) var<storage, read_write> failure: array<atomic<u32>>; // [kernel] smallest agent that failed

fn run_count() -> u32 {
    return (frame.agent_count + RUN - 1u) / RUN;
}

fn is_near(bucket: u32) -> bool {
    return bucket < frame.bucket_count && bucket % frame.level_count == 0u;
}

// Two for each avatar, empty where far bodies are not asked for.
fn far_buckets() -> u32 {
    return 2u * (frame.bucket_count / max(frame.level_count, 1u));
}

@compute @workgroup_size(64)
fn compact_count(@builtin(global_invocation_id) id: vec3<u32>) {
    let run = id.x;
    if run >= run_count() {
        return;
    }
    var near = 0u;
    var seen = 0u;
    for (var agent = run * RUN; agent < min(run * RUN + RUN, frame.agent_count); agent++) {
        let bucket = agent_bucket[agent];
        near += select(0u, 1u, is_near(bucket));
        seen += select(0u, 1u, bucket < frame.bucket_count);
    }
    bucket_counts[run * COLUMNS] = near;
    bucket_counts[run * COLUMNS + 1u] = seen;
}

fn scan_column(column: u32) {
    var total = 0u;
    for (var run = 0u; run < run_count(); run++) {
        let count = bucket_counts[run * COLUMNS + column];
        bucket_counts[run * COLUMNS + column] = total;
        total += count;
    }
    bucket_counts[run_count() * COLUMNS + column] = total;
}

@compute @workgroup_size(64)
fn compact_scan_visible(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < 2u {
        scan_column(id.x);
    }
}

@compute @workgroup_size(64)
fn compact_scan_buckets(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < COLUMNS {
        scan_column(id.x);
    }
}

@compute @workgroup_size(64)
fn compact_demote(@builtin(global_invocation_id) id: vec3<u32>) {
    let run = id.x;
    if run >= run_count() {
        return;
    }
    var near = bucket_counts[run * COLUMNS];
    var seen = bucket_counts[run * COLUMNS + 1u];
    var counts = array<u32, 32>();
    for (var agent = run * RUN; agent < min(run * RUN + RUN, frame.agent_count); agent++) {
        var bucket = agent_bucket[agent];
        if bucket == NONE {
            continue;
        }
        if bucket >= frame.bucket_count {
            counts[bucket] += 1u;
            continue;
        }
        let is_last = seen >= frame.visible_capacity;
        var demoted = false;
        if is_near(bucket) {
            demoted = near >= min(frame.near_capacity, MOST_GROUPS);
            near++;
        }
        seen++;
        if is_last || (demoted && frame.level_count == 1u) {
            if frame.level_distance.w > 0.0 {
                bucket = frame.bucket_count + bucket / frame.level_count;
                agent_bucket[agent] = bucket;
                counts[bucket] += 1u;
                continue;
            }
            agent_bucket[agent] = NONE;
            atomicMin(&failure[KERNEL_ID], agent);
            continue;
        }
        if demoted {
            bucket++;
            agent_bucket[agent] = bucket;
        }
        counts[bucket] += 1u;
    }
    for (var bucket = 0u; bucket < COLUMNS; bucket++) {
        bucket_counts[run * COLUMNS + bucket] = counts[bucket];
    }
}

fn write_command(command: u32, mesh: MeshRange, count: u32) {
    draw_args[command * 5u] = mesh.index_count;
    draw_args[command * 5u + 1u] = count; // instance_count
    draw_args[command * 5u + 2u] = mesh.first_index;
    draw_args[command * 5u + 3u] = mesh.first_vertex; // vertex_offset: indices count from the mesh's first vertex
    draw_args[command * 5u + 4u] = 0u;     // first_instance: the draw shader adds bucket_start
}

// Writes how the agents of a bucket are drawn, and how their shadows are: one level coarser. How many they are.
fn write_draw(bucket: u32) -> u32 {
    let count = bucket_counts[run_count() * COLUMNS + bucket];
    write_command(bucket, mesh_table[bucket], count);
    let is_coarsest = bucket >= frame.bucket_count || bucket % frame.level_count == frame.level_count - 1u;
    let shadow = select(bucket + 1u, bucket, is_coarsest);
    write_command(frame.bucket_count + far_buckets() + bucket, mesh_table[shadow], count);
    return count;
}

@compute @workgroup_size(64)
fn compact_arguments(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x > 0u {
        return;
    }
    var start = 0u;
    for (var bucket = 0u; bucket < frame.bucket_count; bucket++) {
        let count = write_draw(bucket);
        bucket_start[bucket] = start;
        start += count;
        if bucket % frame.level_count == 0u {
            let at = 3u + bucket / frame.level_count * 3u;
            dispatch_args[at] = (mesh_table[bucket].vertex_count + RUN - 1u) / RUN;
            dispatch_args[at + 1u] = count;
            dispatch_args[at + 2u] = 1u;
        }
    }
    bucket_start[frame.bucket_count] = start;
    dispatch_args[0] = (start + RUN - 1u) / RUN;
    dispatch_args[1] = 1u;
    dispatch_args[2] = 1u;
    for (var slot = start; slot < (start / RUN + 1u) * RUN; slot++) {
        visible[slot] = NONE;
    }
    var far = (frame.visible_capacity / RUN + 1u) * RUN;
    for (var bucket = frame.bucket_count; bucket < frame.bucket_count + far_buckets(); bucket++) {
        bucket_start[bucket + 1u] = far;
        far += write_draw(bucket);
    }
    bucket_start[frame.bucket_count + far_buckets() + 1u] = far;
}

@compute @workgroup_size(64)
fn compact_list(@builtin(global_invocation_id) id: vec3<u32>) {
    let run = id.x;
    if run >= run_count() {
        return;
    }
    var next = array<u32, 32>();
    for (var bucket = 0u; bucket < frame.bucket_count; bucket++) {
        next[bucket] = bucket_start[bucket] + bucket_counts[run * COLUMNS + bucket];
    }
    for (var bucket = frame.bucket_count; bucket < frame.bucket_count + far_buckets(); bucket++) {
        next[bucket] = bucket_start[bucket + 1u] + bucket_counts[run * COLUMNS + bucket];
    }
    for (var agent = run * RUN; agent < min(run * RUN + RUN, frame.agent_count); agent++) {
        let bucket = agent_bucket[agent];
        if bucket != NONE {
            visible[next[bucket]] = agent;
            next[bucket] += 1u;
        }
    }
}

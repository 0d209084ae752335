// uses: frame, body, dispatch, ranks
// Turns agent_bucket into the list of visible agents, sorted by bucket and then by id, and into the arguments of the
// dispatches and draws that follow. No atomics decide an order.
// A group is LANES agents. Row g of bucket_counts is group g, the row behind the last group holds the totals.
// The phases, in this order:
//   count (agent):         counts level-0 agents (column 0) and all visible agents (column 1) of each group,
//   scan_visible (column): exclusive prefix sums of these two over the groups, a workgroup a column,
//   demote (agent):        level-0 agents beyond near_capacity, in order of id, go down to level 1; agents beyond
//                          visible_capacity become far bodies, or, where there are none, are dropped and reported;
//                          then counts the agents of each bucket,
//   scan_buckets (bucket): exclusive prefix sums over the groups, totals, a workgroup a bucket,
//   arguments (bucket):    bucket_start, draw_args, dispatch_args, and NONE behind the posed agents of `visible`,
//   list (agent):          writes `visible`.
// Far bodies (buckets from bucket_count on) have no pose: they stand in `visible` behind the room for those that have.
// dispatch_args: 3 words of groups for kernels of one invocation per visible agent (64 a group), then 3 words per
// avatar for `skin`: x covers the vertices of its level 0, y its near agents.

@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read_write> agent_bucket: array<u32>;    // [agent]
@group(0) @binding(2) var<storage, read_write> bucket_counts: array<u32>;   // [group + 1][32]
@group(0) @binding(3) var<storage, read_write> bucket_start: array<u32>;    // [posed bucket + 1][far bucket + 1], each with its end
@group(0) @binding(4) var<storage, read_write> visible: array<u32>;         // [(visible_capacity / 64 + 1) * 64] agents, then NONE; then far bodies
@group(0) @binding(5) var<storage, read> mesh_table: array<MeshRange>;      // [bucket]
@group(0) @binding(6) var<storage, read_write> draw_args: array<u32>;       // [2][bucket][5] VkDrawIndexedIndirectCommand: of images, of shadows
@group(0) @binding(7) var<storage, read_write> dispatch_args: array<u32>;   // [1 + avatar][3]
@group(0) @binding(8) var<storage, read_write> failure: array<atomic<u32>>; // [kernel] smallest agent that failed

fn group_count() -> u32 {
    return (frame.agent_count + LANES - 1u) / LANES;
}

fn bucket_of(agent: u32) -> u32 {
    if agent < frame.agent_count {
        return agent_bucket[agent];
    }
    return NONE;
}

fn is_near(bucket: u32) -> bool {
    return bucket < frame.bucket_count && bucket % frame.level_count == 0u;
}

// Two for each avatar, empty where far bodies are not asked for.
fn far_buckets() -> u32 {
    return 2u * (frame.bucket_count / max(frame.level_count, 1u));
}

// One vote in the lower half for a level-0 agent, one in the upper half for a visible one.
fn votes_of(bucket: u32) -> u32 {
    return select(0u, 1u, is_near(bucket)) | select(0u, 0x10000u, bucket < frame.bucket_count);
}

@compute @workgroup_size(LANES)
fn compact_count(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let votes = scan(lane, votes_of(bucket_of(id.x))).total;
    if lane == 0u {
        bucket_counts[group.x * COLUMNS] = votes & 0xffffu;
        bucket_counts[group.x * COLUMNS + 1u] = votes >> 16u;
    }
}

fn scan_column(lane: u32, column: u32) {
    let groups = group_count();
    var total = 0u;
    for (var first = 0u; first < groups; first += LANES) {
        let group = first + lane;
        var count = 0u;
        if group < groups {
            count = bucket_counts[group * COLUMNS + column];
        }
        let sums = scan(lane, count);
        if group < groups {
            bucket_counts[group * COLUMNS + column] = total + sums.before;
        }
        total += sums.total;
    }
    if lane == 0u {
        bucket_counts[groups * COLUMNS + column] = total;
    }
}

@compute @workgroup_size(LANES)
fn compact_scan_visible(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) column: vec3<u32>) {
    scan_column(lane, column.x);
}

@compute @workgroup_size(LANES)
fn compact_scan_buckets(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) column: vec3<u32>) {
    scan_column(lane, column.x);
}

// The bucket of a visible agent with so many level-0 and so many visible agents before it.
fn admitted(agent: u32, bucket: u32, near: u32, seen: u32) -> u32 {
    let is_demoted = is_near(bucket) && near >= min(frame.near_capacity, MOST_GROUPS);
    if seen >= frame.visible_capacity || (is_demoted && frame.level_count == 1u) {
        if frame.level_distance.w > 0.0 {
            return frame.bucket_count + bucket / frame.level_count;
        }
        atomicMin(&failure[KERNEL_ID], agent);
        return NONE;
    }
    return bucket + select(0u, 1u, is_demoted);
}

@compute @workgroup_size(LANES)
fn compact_demote(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    var bucket = bucket_of(id.x);
    let votes = scan(lane, votes_of(bucket)).before;
    let row = group.x * COLUMNS;
    if bucket < frame.bucket_count {
        let near = bucket_counts[row] + (votes & 0xffffu);
        let seen = bucket_counts[row + 1u] + (votes >> 16u);
        bucket = admitted(id.x, bucket, near, seen);
        agent_bucket[id.x] = bucket;
    }
    rank(lane, bucket);
    storageBarrier(); // all have read the row
    if lane < COLUMNS {
        bucket_counts[row + lane] = ranked(lane);
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
    let count = bucket_counts[group_count() * COLUMNS + bucket];
    write_command(bucket, mesh_table[bucket], count);
    let is_coarsest = bucket >= frame.bucket_count || bucket % frame.level_count == frame.level_count - 1u;
    let shadow = select(bucket + 1u, bucket, is_coarsest);
    write_command(frame.bucket_count + far_buckets() + bucket, mesh_table[shadow], count);
    return count;
}

@compute @workgroup_size(LANES)
fn compact_arguments(@builtin(local_invocation_index) lane: u32) {
    let far_end = frame.bucket_count + far_buckets();
    var count = 0u;
    if lane < far_end {
        count = write_draw(lane);
    }
    let is_posed = lane < frame.bucket_count;
    let posed = scan(lane, select(0u, count, is_posed));
    let far = scan(lane, select(count, 0u, is_posed));
    let far_start = (frame.visible_capacity / RUN + 1u) * RUN;
    if is_posed {
        bucket_start[lane] = posed.before;
        if lane % frame.level_count == 0u {
            let at = 3u + lane / frame.level_count * 3u;
            dispatch_args[at] = (mesh_table[lane].vertex_count + RUN - 1u) / RUN;
            dispatch_args[at + 1u] = count;
            dispatch_args[at + 2u] = 1u;
        }
    } else if lane < far_end {
        bucket_start[lane + 1u] = far_start + far.before;
    }
    if lane == 0u {
        bucket_start[frame.bucket_count] = posed.total;
        bucket_start[far_end + 1u] = far_start + far.total;
        dispatch_args[0] = (posed.total + RUN - 1u) / RUN;
        dispatch_args[1] = 1u;
        dispatch_args[2] = 1u;
    }
    let slot = posed.total + lane;
    if slot < (posed.total / RUN + 1u) * RUN {
        visible[slot] = NONE;
    }
}

@compute @workgroup_size(LANES)
fn compact_list(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let bucket = bucket_of(id.x);
    let place = rank(lane, bucket);
    if bucket != NONE {
        let start = bucket_start[bucket + select(0u, 1u, bucket >= frame.bucket_count)];
        visible[start + bucket_counts[group.x * COLUMNS + bucket] + place] = id.x;
    }
}

// uses: sight, scan
// Lists the visible agents in their old order, with the arguments of their draws. A group is LANES of the slots that are
// sifted. The phases, in this order:
//   count (slot):      how many of a group are seen,
//   scan (one group):  exclusive prefix sums over the groups, the total behind the last,
//   starts (slot):     how many are seen before each bucket, and before the end of the last,
//   list (slot):       `shown`, and the arguments of a bucket for as many slots as there are buckets.

@group(0) @binding(0) var<uniform> sight: SightUniforms;
@group(0) @binding(1) var<storage, read> bucket_start: array<u32>;      // [posed bucket + 1][far bucket + 1]
@group(0) @binding(2) var<storage, read> hidden: array<u32>;            // [slot] 1 if no eye sees it
@group(0) @binding(3) var<storage, read_write> group_shown: array<u32>; // [group + 1]
@group(0) @binding(4) var<storage, read_write> bucket_shown: array<u32>; // [bucket + 1]
@group(0) @binding(5) var<storage, read_write> shown: array<u32>;       // [slot] slots, those of a bucket from its first on
@group(0) @binding(6) var<storage, read> draw_args: array<u32>;         // [2][bucket][5]
@group(0) @binding(7) var<storage, read_write> shown_args: array<u32>;  // [bucket][5] VkDrawIndexedIndirectCommand

// How many slots are sifted.
fn sifted() -> u32 {
    return start_of(sight.bucket_end) - start_of(sight.first_bucket);
}

// 1 if the sifted slot of that number is seen.
fn seen(number: u32) -> u32 {
    if number < sifted() {
        return 1u - hidden[start_of(sight.first_bucket) + number];
    }
    return 0u;
}

@compute @workgroup_size(LANES)
fn occlusion_compact_count(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let sums = scan(lane, seen(id.x));
    if lane == 0u && id.x < sifted() {
        group_shown[group.x] = sums.total;
    }
}

@compute @workgroup_size(LANES)
fn occlusion_compact_scan(@builtin(local_invocation_index) lane: u32) {
    let groups = (sifted() + LANES - 1u) / LANES;
    var total = 0u;
    for (var first = 0u; first < groups; first += LANES) {
        let group = first + lane;
        var count = 0u;
        if group < groups {
            count = group_shown[group];
        }
        let sums = scan(lane, count);
        if group < groups {
            group_shown[group] = total + sums.before;
        }
        total += sums.total;
    }
    if lane == 0u {
        group_shown[groups] = total;
    }
}

// Sifted slots that are seen before the one of that number. Every lane must call it.
fn seen_before(number: u32, lane: u32, group: u32) -> u32 {
    let sums = scan(lane, seen(number));
    return group_shown[group] + sums.before;
}

@compute @workgroup_size(LANES)
fn occlusion_compact_starts(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let before = seen_before(id.x, lane, group.x);
    if id.x > sifted() {
        return;
    }
    let slot = start_of(sight.first_bucket) + id.x;
    for (var bucket = sight.first_bucket; bucket <= sight.bucket_end; bucket++) {
        if start_of(bucket) == slot {
            bucket_shown[bucket] = before;
        }
    }
}

@compute @workgroup_size(LANES)
fn occlusion_compact_list(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3<u32>,
) {
    let before = seen_before(id.x, lane, group.x);
    if seen(id.x) == 1u {
        let slot = start_of(sight.first_bucket) + id.x;
        let bucket = bucket_of(slot, sight.first_bucket);
        shown[start_of(bucket) + before - bucket_shown[bucket]] = slot;
    }
    let bucket = sight.first_bucket + id.x;
    if bucket < sight.bucket_end {
        for (var word = 0u; word < 5u; word++) {
            shown_args[bucket * 5u + word] = draw_args[bucket * 5u + word];
        }
        shown_args[bucket * 5u + 1u] = bucket_shown[bucket + 1u] - bucket_shown[bucket];
    }
}

// uses: sight, dispatch
// Lists the visible agents in their old order, with the arguments of their draws. A run is RUN slots.
// The phases, in this order:
//   count (run): how many of a run are seen,
//   scan (one):  exclusive prefix sums over the runs, the total behind the last,
//   list (run):  `shown`, and the arguments of a bucket for as many runs as there are buckets.

@group(0) @binding(0) var<uniform> sight: SightUniforms;
@group(0) @binding(1) var<storage, read> bucket_start: array<u32>;     // [posed bucket + 1][far bucket + 1]
@group(0) @binding(2) var<storage, read> hidden: array<u32>;           // [slot] 1 if no eye sees it
@group(0) @binding(3) var<storage, read_write> run_shown: array<u32>;  // [run + 1]
@group(0) @binding(4) var<storage, read_write> shown: array<u32>;      // [slot] slots, those of a bucket from its first on
@group(0) @binding(5) var<storage, read> draw_args: array<u32>;        // [2][bucket][5]
@group(0) @binding(6) var<storage, read_write> shown_args: array<u32>; // [bucket][5] VkDrawIndexedIndirectCommand

// Slots that are seen before number `count` of the sifted ones.
fn seen_before(count: u32) -> u32 {
    let first = start_of(sight.first_bucket);
    var seen = run_shown[count / RUN];
    for (var i = count / RUN * RUN; i < count; i++) {
        seen += 1u - hidden[first + i];
    }
    return seen;
}

fn write_shown(run: u32, first: u32, end: u32) {
    var seen = run_shown[run];
    var bucket = bucket_of(first + run * RUN, sight.first_bucket);
    var before = seen_before(start_of(bucket) - first); // seen in earlier buckets
    for (var slot = first + run * RUN; slot < min(first + run * RUN + RUN, end); slot++) {
        let of_slot = bucket_of(slot, bucket);
        if of_slot != bucket {
            bucket = of_slot;
            before = seen;
        }
        if hidden[slot] == 0u {
            shown[start_of(bucket) + seen - before] = slot;
            seen++;
        }
    }
}

fn write_arguments(bucket: u32, first: u32) {
    for (var word = 0u; word < 5u; word++) {
        shown_args[bucket * 5u + word] = draw_args[bucket * 5u + word];
    }
    shown_args[bucket * 5u + 1u] = seen_before(start_of(bucket + 1u) - first) - seen_before(start_of(bucket) - first);
}

// Slots that are sifted: the first, and the end.
fn sifted() -> vec2<u32> {
    return vec2<u32>(start_of(sight.first_bucket), start_of(sight.bucket_end));
}

fn run_count(slots: vec2<u32>) -> u32 {
    return (slots.y - slots.x + RUN - 1u) / RUN;
}

@compute @workgroup_size(64)
fn occlusion_compact_count(@builtin(global_invocation_id) id: vec3<u32>) {
    let slots = sifted();
    if id.x >= run_count(slots) {
        return;
    }
    let first = slots.x + id.x * RUN;
    var seen = 0u;
    for (var slot = first; slot < min(first + RUN, slots.y); slot++) {
        seen += 1u - hidden[slot];
    }
    run_shown[id.x] = seen;
}

@compute @workgroup_size(64)
fn occlusion_compact_scan(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x > 0u {
        return;
    }
    let runs = run_count(sifted());
    var total = 0u;
    for (var run = 0u; run < runs; run++) {
        let seen = run_shown[run];
        run_shown[run] = total;
        total += seen;
    }
    run_shown[runs] = total;
}

@compute @workgroup_size(64)
fn occlusion_compact_list(@builtin(global_invocation_id) id: vec3<u32>) {
    let slots = sifted();
    if id.x < sight.bucket_end - sight.first_bucket {
        write_arguments(sight.first_bucket + id.x, slots.x);
    }
    if id.x < run_count(slots) {
        write_shown(id.x, slots.x, slots.y);
    }
}

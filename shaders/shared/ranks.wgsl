// uses: scan
// Ranks of a workgroup's lanes among those of the same bucket.
const COLUMNS: u32 = 32u; // the most buckets there can be
const WORDS: u32 = 4u;    // of 32 lanes each

var<workgroup> rank_lanes: array<atomic<u32>, 128>; // [bucket][word] which lanes have it

// How many lanes before this one have its bucket; any bucket from COLUMNS on is none. Every lane must call it.
fn rank(lane: u32, bucket: u32) -> u32 {
    workgroupBarrier(); // the ranks before have been read
    atomicStore(&rank_lanes[lane], 0u);
    workgroupBarrier();
    let word = lane / 32u;
    let bit = 1u << (lane % 32u);
    if bucket < COLUMNS {
        atomicOr(&rank_lanes[bucket * WORDS + word], bit);
    }
    workgroupBarrier();
    if bucket >= COLUMNS {
        return 0u;
    }
    var before = countOneBits(atomicLoad(&rank_lanes[bucket * WORDS + word]) & (bit - 1u));
    for (var i = 0u; i < word; i++) {
        before += countOneBits(atomicLoad(&rank_lanes[bucket * WORDS + i]));
    }
    return before;
}

// How many lanes had that bucket when `rank` was called last.
fn ranked(bucket: u32) -> u32 {
    var count = 0u;
    for (var i = 0u; i < WORDS; i++) {
        count += countOneBits(atomicLoad(&rank_lanes[bucket * WORDS + i]));
    }
    return count;
}

// uses: sight, agent
// Finds the agents hidden behind bodies that are drawn already. Candidates are the agents of the sifted buckets. Such an
// agent is hidden if its two boxes, as each eye sees them, lie behind everything in the tiles of the image that they touch.
// A tile holds the farthest depth of its samples (0 where nothing is drawn). So no sample of a hidden body could have passed
// the depth test, and the image is the same without it. The phases, in this order:
//   mark (slot):  marks the blocks of tiles whose depth the next phase reads; the renderer then fills in their `tile_depth`,
//   judge (slot): tests the boxes against those depths.
// The boxes are upright, one around trunk and limbs and one around the head, at any phase of the stride. At eye level heads
// stand out, and few agents are hidden if heads count as wide as shoulders. An agent counts as seen where the test is
// impossible: a box reaches behind the eye or touches many tiles. It also counts as seen where the eye looks down on its
// head, since no other head is in the way then.
const PAD: f32 = 0.0625;       // pixels: corners of triangles are rounded to less than this
const BEHIND: f32 = 0.01;      // of what is nearer to the eye's plane than this nothing is known, clip space
const MOST_TILES: u32 = 256u;  // that one box may touch
const DOWN: f32 = 0.3;         // how far above a head the eye looks down on it, m
const NEARER: f32 = 1.00001;   // depth is rounded too

@group(0) @binding(0) var<uniform> sight: SightUniforms;
@group(0) @binding(1) var<storage, read> bucket_start: array<u32>;         // [posed bucket + 1][far bucket + 1]
@group(0) @binding(2) var<storage, read> visible: array<u32>;              // [slot] agent
@group(0) @binding(3) var<storage, read> position: array<vec2<f32>>;       // [agent] m
@group(0) @binding(4) var<storage, read> elevation: array<f32>;            // [agent] m
@group(0) @binding(5) var<storage, read> appearance: array<Appearance>;    // [agent]
@group(0) @binding(6) var<storage, read_write> wanted: array<atomic<u32>>; // [eye][block] 1 where phase `judge` reads it
@group(0) @binding(7) var<storage, read> tile_depth: array<f32>;           // [eye][tile] least depth, of a marked block
@group(0) @binding(8) var<storage, read_write> hidden: array<u32>;         // [slot] 1 if no eye sees it

struct Seen {
    is_judged: bool,
    low: vec2<u32>,  // first tile
    high: vec2<u32>, // behind the last one; none where the box is out of the image
    nearest: f32,    // greatest depth of the box
}

fn tile_at(pixel: f32, side: u32, most: u32) -> u32 {
    let tile = floor(pixel / f32(side));
    if !(tile > 0.0) {
        return 0u;
    }
    if tile >= f32(most) {
        return most;
    }
    return u32(tile);
}

fn look_at(eye: u32, agent: u32, bounds: vec4<f32>) -> Seen {
    let m = sight.clip_from_world[eye];
    let body = appearance[agent];
    let tall = body.scale * stature_of(body);
    let at = position[agent];
    let foot = elevation[agent];
    let radius = bounds.x * body.scale * breadth_of(body);
    var low = vec2<f32>(1.0e30, 1.0e30);
    var high = vec2<f32>(-1.0e30, -1.0e30);
    var nearest = 0.0;
    for (var corner = 0u; corner < 8u; corner++) {
        let x = at.x + select(-radius, radius, (corner & 1u) == 1u);
        let y = foot + select(bounds.y, bounds.z, (corner & 2u) == 2u) * tall;
        let z = at.y + select(-radius, radius, (corner & 4u) == 4u);
        let w = m[0].w * x + m[1].w * y + m[2].w * z + m[3].w;
        if !(w > BEHIND) {
            return Seen(false, vec2<u32>(0u), vec2<u32>(0u), 0.0);
        }
        let right = ((m[0].x * x + m[1].x * y + m[2].x * z + m[3].x) / w * 0.5 + 0.5) * sight.width;
        let down = ((m[0].y * x + m[1].y * y + m[2].y * z + m[3].y) / w * 0.5 + 0.5) * sight.height;
        let depth = (m[0].z * x + m[1].z * y + m[2].z * z + m[3].z) / w;
        low = vec2<f32>(select(low.x, right, right < low.x), select(low.y, down, down < low.y));
        high = vec2<f32>(select(high.x, right, right > high.x), select(high.y, down, down > high.y));
        nearest = select(nearest, depth, depth > nearest);
    }
    let is_out = high.x < -1.0 || high.y < -1.0 || low.x > sight.width + 1.0 || low.y > sight.height + 1.0;
    if is_out {
        return Seen(true, vec2<u32>(0u), vec2<u32>(0u), 0.0);
    }
    let first = vec2<u32>(
        tile_at(low.x - PAD, sight.tile_width, sight.tile_columns - 1u),
        tile_at(low.y - PAD, sight.tile_height, sight.tile_rows - 1u),
    );
    let end = vec2<u32>(
        tile_at(high.x + PAD, sight.tile_width, sight.tile_columns - 1u) + 1u,
        tile_at(high.y + PAD, sight.tile_height, sight.tile_rows - 1u) + 1u,
    );
    let tiles = (end.x - first.x) * (end.y - first.y);
    return Seen(tiles <= MOST_TILES, first, end, nearest);
}

fn mark(eye: u32, seen: Seen) {
    if seen.high.x == 0u {
        return; // out of the image
    }
    let columns = (sight.tile_columns + BLOCK - 1u) / BLOCK;
    let base = eye * columns * ((sight.tile_rows + BLOCK - 1u) / BLOCK);
    for (var row = seen.low.y / BLOCK; row <= (seen.high.y - 1u) / BLOCK; row++) {
        for (var column = seen.low.x / BLOCK; column <= (seen.high.x - 1u) / BLOCK; column++) {
            let block = base + row * columns + column;
            // most are marked already, and looking is cheaper
            if atomicLoad(&wanted[block]) == 0u {
                atomicStore(&wanted[block], 1u);
            }
        }
    }
}

fn is_behind(eye: u32, seen: Seen) -> bool {
    let base = eye * sight.tile_columns * sight.tile_rows;
    let nearest = seen.nearest * NEARER;
    for (var row = seen.low.y; row < seen.high.y; row++) {
        for (var column = seen.low.x; column < seen.high.x; column++) {
            if !(tile_depth[base + row * sight.tile_columns + column] > nearest) {
                return false;
            }
        }
    }
    return true;
}

// Whether an agent of a bucket is shown whatever stands before it.
fn is_shown(agent: u32, bucket: u32) -> bool {
    let count = start_of(sight.bucket_end) - start_of(sight.first_bucket);
    let body = appearance[agent];
    let head = sight.bounds[bucket][1].z * (body.scale * stature_of(body));
    return count < sight.fewest || sight.eye_height > elevation[agent] + head + DOWN;
}

// How one of the eyes sees one of the boxes: heads first, they are seen more often than what is below.
fn look_at_part(part: u32, agent: u32, bucket: u32) -> Seen {
    return look_at(part >> 1u, agent, sight.bounds[bucket][1u - (part & 1u)]);
}

fn part_count() -> u32 {
    return 2u * min(sight.eye_count, 2u);
}

@compute @workgroup_size(64)
fn occlude_mark(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = start_of(sight.first_bucket) + id.x;
    if slot >= start_of(sight.bucket_end) {
        return;
    }
    let bucket = bucket_of(slot, sight.first_bucket);
    let agent = visible[slot];
    if is_shown(agent, bucket) {
        return;
    }
    for (var part = 0u; part < part_count(); part++) {
        let seen = look_at_part(part, agent, bucket);
        if seen.is_judged {
            mark(part >> 1u, seen);
        }
    }
}

@compute @workgroup_size(64)
fn occlude_judge(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = start_of(sight.first_bucket) + id.x;
    if slot >= start_of(sight.bucket_end) {
        return;
    }
    let bucket = bucket_of(slot, sight.first_bucket);
    let agent = visible[slot];
    var is_hidden = !is_shown(agent, bucket);
    for (var part = 0u; is_hidden && part < part_count(); part++) {
        let seen = look_at_part(part, agent, bucket);
        is_hidden = seen.is_judged && is_behind(part >> 1u, seen);
    }
    hidden[slot] = select(0u, 1u, is_hidden);
}

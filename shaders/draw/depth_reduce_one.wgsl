// uses: block
// `tile_depth` of an image of one sample a pixel.

@group(0) @binding(0) var picture_depth: texture_depth_2d;
@group(0) @binding(1) var<storage, read> wanted: array<u32>; // [eye][block]

// width of a tile, and height in the upper half, pixels; columns and rows of tiles; the eye
var<immediate> tiles: vec4<u32>;

struct TileVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) side: vec2<u32>,
}

// One instance for each block. A block that `occlude` has not marked has no area.
@vertex
fn depth_reduce_one_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) block: u32) -> TileVertex {
    let count = (tiles.yz + BLOCK - 1u) / BLOCK;
    if wanted[tiles.w * count.x * count.y + block] == 0u {
        return TileVertex(vec4<f32>(0.0, 0.0, 0.0, 1.0), vec2<u32>(1u));
    }
    // two triangles: corners 0 1 2 and 2 1 3 of a square, cut off where the tiles end
    let corner = select(vertex, 5u - vertex + 1u, vertex >= 3u);
    let place = vec2<u32>(block % count.x, block / count.x) + vec2<u32>(corner & 1u, (corner >> 1u) & 1u);
    let at = vec2<f32>(min(place * BLOCK, tiles.yz)) / vec2<f32>(tiles.yz) * 2.0 - 1.0;
    let width = tiles.x & 0xffffu;
    return TileVertex(vec4<f32>(at, 0.0, 1.0), vec2<u32>(width, tiles.x >> 16u));
}

@fragment
fn depth_reduce_one_fragment(in: TileVertex) -> @location(0) vec4<f32> {
    let tile = vec2<u32>(in.clip.xy);
    let size = textureDimensions(picture_depth);
    let first = tile * in.side;
    let end = min(first + in.side, size);
    var least = 1.0;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            least = min(least, textureLoad(picture_depth, vec2<i32>(vec2<u32>(x, y)), 0));
        }
    }
    return vec4<f32>(least);
}

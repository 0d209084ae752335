// Lanes along y: what is read by x is the same for all of them.
@group(0) @binding(0) var<storage, read> columns: array<u32>;      // [x]
@group(0) @binding(1) var<storage, read> rows: array<vec2<u32>>;   // [y]
@group(0) @binding(2) var<storage, read_write> out: array<u32>;    // [y][x]
@group(0) @binding(3) var<storage, read> sizes: array<u32>;        // columns, rows

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= sizes[0] || id.y >= sizes[1] {
        return;
    }
    let column = columns[id.x];
    var value = rows[id.y].x;
    if column % 3u == 0u { // the same for all lanes
        value += rows[id.y].y * column;
    } else if rows[id.y].y > column { // not the same
        value -= columns[rows[id.y].y];
    }
    for (var i = 0u; i < column % 5u; i++) {
        value = value * 3u + columns[i] + rows[i].y + id.x;
    }
    out[id.y * sizes[0] + id.x] = value;
}

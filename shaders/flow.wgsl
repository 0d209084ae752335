// uses: way
// Way-finding: for every field the distance to its goal over the walkable cells, |grad T| = cost (the eikonal equation),
// by Godunov's upwind scheme, and the direction in which it falls. Solved tile by tile: one invocation sweeps the
// cells of a tile in four orders until none falls any more, then puts those neighbouring tiles on the list that its
// border can still improve (after Jeong and Whitaker, A fast iterative method for eikonal equations, 2008). Tiles are
// coloured like a chessboard and the two colours take turns, so no tile reads what another one writes in the same pass
// and the order within a list does not matter. Passes chosen by `level`:
//   0 (cell):     everything FAR, the lists empty,
//   1 (seed):     known distances, their tiles on the lists,
//   2..5 (place): one turn of list 0..3, again and again until all lists are empty; tiles of even colour are on even lists,
//   6 (tile):     those with cells where nobody can stand on the lists: so far these were left out, which is quicker,
//   7..10 (place): the same turns with them,
//   11 (cell):    directions; clears the lists, whose order is arbitrary.
// A cell may be entered only from the neighbours that its bits name: a free cell from free cells to which a body fits
// through, others from all, so that the field leads back whoever is outside.
// flow_args: for each list groups along x, 1, 1, and its length.
const TILE = 8u;
const SWEEPS = 64u;       // in one turn; a tile that needs more takes another turn
const GROUP = 32u;
const MOST_GROUPS = 65535u;
const FAR = 1e30;         // m: not reached

@group(0) @binding(0) var<uniform> flow_grid: FlowUniforms;
@group(0) @binding(1) var<storage, read> flow_cells: array<u32>;              // [cell] bits, see way.wgsl
@group(0) @binding(2) var<storage, read> flow_step: array<f32>;               // [cell] m: cell size times cost
@group(0) @binding(3) var<storage, read> flow_seeds: array<vec4<u32>>;        // [seed] field, cell, distance as bits, SEES or 0
@group(0) @binding(4) var<storage, read_write> flow_distance: array<f32>;     // [field][cell] m
@group(0) @binding(5) var<storage, read_write> flow_tiles: array<atomic<u32>>; // [field][tile] 1 while it is on a list
@group(0) @binding(6) var<storage, read_write> flow_lists: array<u32>;        // [4][field * tile]
@group(0) @binding(7) var<storage, read_write> flow_args: array<atomic<u32>>; // [4][4] arguments of the launches
@group(0) @binding(8) var<storage, read_write> flow_way: array<u32>;          // [field][cell] see way.wgsl
var<immediate> level: u32;

fn tile_total() -> u32 {
    return flow_grid.field_count * flow_grid.tile_columns * flow_grid.tile_rows;
}

fn enlist(list: u32, tile: u32) {
    if atomicExchange(&flow_tiles[tile], 1u) == 0u {
        let place = atomicAdd(&flow_args[list * 4u + 3u], 1u);
        flow_lists[list * tile_total() + place] = tile;
        atomicMax(&flow_args[list * 4u], place / GROUP + 1u);
    }
}

fn reset(index: u32) {
    if index < flow_grid.field_count * flow_grid.cell_count {
        flow_distance[index] = FAR;
        flow_way[index] = 0u;
    }
    clear_lists(index);
}

fn clear_lists(index: u32) {
    if index < tile_total() {
        atomicStore(&flow_tiles[index], 0u);
    }
    if index < 4u * tile_total() {
        flow_lists[index] = 0u;
    }
    if index < 4u {
        clear_list(index);
    }
}

// One group is launched even of an empty list: it empties the list that was used before.
fn clear_list(list: u32) {
    atomicStore(&flow_args[list * 4u], 1u);
    atomicStore(&flow_args[list * 4u + 1u], 1u);
    atomicStore(&flow_args[list * 4u + 2u], 1u);
    atomicStore(&flow_args[list * 4u + 3u], 0u);
}

fn sow(index: u32) {
    if index >= flow_grid.seed_count {
        return;
    }
    let seed = flow_seeds[index];
    let at = seed.x * flow_grid.cell_count + seed.y;
    flow_distance[at] = bitcast<f32>(seed.z);
    flow_way[at] = seed.w;
    let column = seed.y % flow_grid.columns;
    let row = seed.y / flow_grid.columns;
    let tx = column / TILE;
    let tz = row / TILE;
    let tile = (seed.x * flow_grid.tile_rows + tz) * flow_grid.tile_columns + tx;
    let colour = (tx + tz) & 1u;
    enlist(colour, tile);
    if column % TILE == 0u && column > 0u {
        enlist(1u - colour, tile - 1u);
    }
    if column % TILE == TILE - 1u && column + 1u < flow_grid.columns {
        enlist(1u - colour, tile + 1u);
    }
    if row % TILE == 0u && row > 0u {
        enlist(1u - colour, tile - flow_grid.tile_columns);
    }
    if row % TILE == TILE - 1u && row + 1u < flow_grid.rows {
        enlist(1u - colour, tile + flow_grid.tile_columns);
    }
}

fn enlist_solid(tile: u32) {
    if tile >= tile_total() {
        return;
    }
    let tx = tile % flow_grid.tile_columns;
    let tz = tile / flow_grid.tile_columns % flow_grid.tile_rows;
    let z1 = min(tz * TILE + TILE, flow_grid.rows);
    let x1 = min(tx * TILE + TILE, flow_grid.columns);
    var any = 0u;
    for (var z = tz * TILE; z < z1; z++) {
        for (var x = tx * TILE; x < x1; x++) {
            any |= flow_cells[z * flow_grid.columns + x];
        }
    }
    if (any & SOLID) != 0u {
        enlist((tx + tz) & 1u, tile);
    }
}

// Bits of a cell that is left out in these turns.
fn left_out() -> u32 {
    return select(0u, SOLID, level < 6u);
}

// Whether the cell outside, open by `bit` to a cell with that distance, could fall because of it: an update is at least the
// lower neighbour plus 0.707 of the step.
fn could_fall(first: u32, cell: u32, bit: u32, distance: f32) -> bool {
    let bits = flow_cells[cell];
    return (bits & bit) != 0u && (bits & left_out()) == 0u && flow_distance[first + cell] > distance + 0.7 * flow_step[cell];
}

fn turn(place: u32) {
    let list = select(level - 7u, level - 2u, level < 6u);
    if place == 0u {
        clear_list((list + 3u) & 3u);
    }
    if place >= atomicLoad(&flow_args[list * 4u + 3u]) {
        return;
    }
    let tile = flow_lists[list * tile_total() + place];
    atomicStore(&flow_tiles[tile], 0u);
    let columns = flow_grid.columns;
    let tx = tile % flow_grid.tile_columns;
    let tz = tile / flow_grid.tile_columns % flow_grid.tile_rows;
    let first = tile / (flow_grid.tile_columns * flow_grid.tile_rows) * flow_grid.cell_count; // of the field
    let last = flow_grid.field_count * flow_grid.cell_count - 1u;
    let x0 = tx * TILE;
    let z0 = tz * TILE;
    let width = min(TILE, columns - x0);
    let height = min(TILE, flow_grid.rows - z0);
    // the first sweep goes with the front: from the side beside which it is nearer to the goal
    let row = first + (z0 + height / 2u) * columns + x0;
    let column = first + z0 * columns + x0 + width / 2u;
    let west = select(FAR, flow_distance[min(row - 1u, last)], x0 > 0u);
    let east = select(FAR, flow_distance[min(row + width, last)], x0 + width < columns);
    let south = select(FAR, flow_distance[min(column - columns, last)], z0 > 0u);
    let north = select(FAR, flow_distance[min(column + height * columns, last)], z0 + height < flow_grid.rows);
    let nearer_right = east < west;
    let nearer_above = north < south;
    var fell = 0u; // sides whose cells fell: the bits by which the neighbours there are entered
    var quiet = false;
    for (var sweep = 0u; sweep < SWEEPS && !quiet; sweep++) {
        let from_right = ((sweep & 1u) != 0u) != nearer_right;
        let from_above = ((sweep & 2u) != 0u) != nearer_above;
        quiet = true;
        let by = select(1u, 0xffffffffu, from_right); // from cell to cell
        let behind_bit = select(FROM_LEFT, FROM_RIGHT, from_right);
        let ahead_bit = select(FROM_RIGHT, FROM_LEFT, from_right);
        for (var j = 0u; j < height; j++) {
            let z = select(j, height - 1u - j, from_above);
            // along the row what was read ahead is used again
            var at = first + (z0 + z) * columns + x0 + select(0u, width - 1u, from_right);
            var behind = flow_distance[min(at - by, last)];
            var here = flow_distance[at];
            for (var i = 0u; i < width; i++) {
                let ahead = flow_distance[min(at + by, last)];
                let bits = flow_cells[at - first];
                if (bits & left_out()) == 0u {
                    // a neighbour it may not be entered from is replaced by the cell itself, which never makes it fall
                    let below = flow_distance[select(at, at - columns, (bits & FROM_BELOW) != 0u)];
                    let above = flow_distance[select(at, at + columns, (bits & FROM_ABOVE) != 0u)];
                    let a = min(select(here, behind, (bits & behind_bit) != 0u), select(here, ahead, (bits & ahead_bit) != 0u));
                    let b = min(below, above);
                    let size = flow_step[at - first];
                    let apart = abs(a - b);
                    var fresh = min(a, b) + size;
                    if apart < size {
                        fresh = 0.5 * (a + b + sqrt(2.0 * size * size - apart * apart));
                    }
                    if fresh < here - 1e-4 * size {
                        flow_distance[at] = fresh;
                        here = fresh;
                        quiet = false;
                        let x = select(i, width - 1u - i, from_right);
                        fell |= select(0u, FROM_RIGHT, x == 0u) | select(0u, FROM_LEFT, x + 1u == width)
                            | select(0u, FROM_ABOVE, z == 0u) | select(0u, FROM_BELOW, z + 1u == height);
                    }
                }
                behind = here;
                here = ahead;
                at += by;
            }
        }
    }
    if !quiet {
        enlist((list + 2u) & 3u, tile);
    }
    var wake = 0u;
    for (var i = 0u; i < TILE; i++) {
        let row = (z0 + min(i, height - 1u)) * columns;
        let column = x0 + min(i, width - 1u);
        let west = row + x0;
        let east = west + width - 1u;
        let south = z0 * columns + column;
        let north = south + (height - 1u) * columns;
        if (fell & FROM_RIGHT) != 0u && x0 > 0u && could_fall(first, west - 1u, FROM_RIGHT, flow_distance[first + west]) {
            wake |= FROM_RIGHT;
        }
        if (fell & FROM_LEFT) != 0u && x0 + width < columns && could_fall(first, east + 1u, FROM_LEFT, flow_distance[first + east]) {
            wake |= FROM_LEFT;
        }
        if (fell & FROM_ABOVE) != 0u && z0 > 0u && could_fall(first, south - columns, FROM_ABOVE, flow_distance[first + south]) {
            wake |= FROM_ABOVE;
        }
        if (fell & FROM_BELOW) != 0u && z0 + height < flow_grid.rows && could_fall(first, north + columns, FROM_BELOW, flow_distance[first + north]) {
            wake |= FROM_BELOW;
        }
    }
    let next = (list + 1u) & 3u;
    if (wake & FROM_RIGHT) != 0u {
        enlist(next, tile - 1u);
    }
    if (wake & FROM_LEFT) != 0u {
        enlist(next, tile + 1u);
    }
    if (wake & FROM_ABOVE) != 0u {
        enlist(next, tile - flow_grid.tile_columns);
    }
    if (wake & FROM_BELOW) != 0u {
        enlist(next, tile + flow_grid.tile_columns);
    }
}

// How fast the distance falls towards +, from the two neighbours along one axis: the mean slope where both can be
// entered from and stand free, else that to the lower one.
fn slope(here: f32, low: f32, high: f32, both: bool) -> f32 {
    if both {
        return 0.5 * (low - high);
    }
    return max(here - high, 0.0) - max(here - low, 0.0);
}

fn point(index: u32) {
    if index < flow_grid.field_count * flow_grid.cell_count {
        let columns = flow_grid.columns;
        let bits = flow_cells[index % flow_grid.cell_count];
        let here = flow_distance[index];
        let from_left = (bits & FROM_LEFT) != 0u;
        let from_right = (bits & FROM_RIGHT) != 0u;
        let from_below = (bits & FROM_BELOW) != 0u;
        let from_above = (bits & FROM_ABOVE) != 0u;
        let left = flow_distance[select(index, index - 1u, from_left)];
        let right = flow_distance[select(index, index + 1u, from_right)];
        let below = flow_distance[select(index, index - columns, from_below)];
        let above = flow_distance[select(index, index + columns, from_above)];
        let is_free = (bits & SOLID) == 0u;
        let fall = vec2<f32>(
            slope(here, left, right, is_free && from_left && from_right),
            slope(here, below, above, is_free && from_below && from_above),
        );
        let steep = sqrt(fall.x * fall.x + fall.y * fall.y);
        var word = bits | (flow_way[index] & SEES);
        if here < 0.5 * FAR && steep > 0.0 {
            word |= LEADS | way_pack(fall * (1.0 / steep));
        }
        flow_way[index] = word;
    }
    clear_lists(index);
}

@compute @workgroup_size(32)
fn flow(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x + id.y * MOST_GROUPS * GROUP;
    if level == 0u {
        reset(index);
    } else if level == 1u {
        sow(index);
    } else if level == 6u {
        enlist_solid(index);
    } else if level == 11u {
        point(index);
    } else {
        turn(index);
    }
}

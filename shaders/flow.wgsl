// uses: way, tile, dispatch
// Way-finding: for every field the distance to its goal over the walkable cells, |grad T| = cost (the eikonal equation),
// by Godunov's upwind scheme, and the direction in which it falls. Solved tile by tile: one invocation sweeps the
// cells of a tile in four orders until none falls any more, then puts those neighbouring tiles on the list that its
// border can still improve (after Jeong and Whitaker, A fast iterative method for eikonal equations, 2008). Tiles are
// coloured like a chessboard and the two colours take turns, so no tile reads what another one writes in the same turn
// and the order within a list does not matter. The phases, in this order:
//   reset (tile):        everything FAR, the lists empty,
//   sow (seed):          known distances, their tiles on the lists,
//   sweep (place):       one turn of `list`, 0 to 3, again and again until all lists are empty; tiles of even colour are on
//                        even lists,
//   join (joint):        between such turns: cells that are one place on several sheets are as far as the nearest of them,
//                        and tiles that can fall because of it are on lists 0 and 1: the turns go on with list 0,
//   enlist_solid (tile): puts tiles with solid cells on the lists; the sweeps before leave solid cells out, which is quicker,
//   sweep_solid (place): the same turns with them,
//   point (tile):        directions; clears the lists, whose order is arbitrary,
//   mark (seed):         marks from where the goal is seen.
// A cell may be entered only from the neighbours that its bits name. A free cell names free cells to which a body fits
// through. A solid cell names all, so that the field leads an agent in it back to free cells.
// flow_args: for each list groups along x, 1, 1, and its length.
const SWEEPS: u32 = 64u;       // in one turn; a tile that needs more takes another turn
const GROUP: u32 = 32u;
const FAR: f32 = 1e30;         // m: not reached

@group(0) @binding(0) var<uniform> flow_grid: FlowUniforms;
@group(0) @binding(1) var<storage, read> flow_cells: array<u32>;               // [cell] bits and step, see way.wgsl
@group(0) @binding(2) var<storage, read> flow_seeds: array<FlowSeed>;          // [seed]
@group(0) @binding(3) var<storage, read_write> flow_distance: array<f32>;      // [field][cell] m
@group(0) @binding(4) var<storage, read_write> flow_tiles: array<atomic<u32>>; // [field][tile] 1 while it is on a list
@group(0) @binding(5) var<storage, read_write> flow_lists: array<u32>;         // [4][field * tile]
@group(0) @binding(6) var<storage, read_write> flow_args: array<atomic<u32>>;  // [4][4] arguments of the dispatches
@group(0) @binding(7) var<storage, read_write> flow_way: array<u32>;           // [field][cell] see way.wgsl
@group(0) @binding(8) var<storage, read> flow_joints: array<FlowJoint>;        // [joint]
var<immediate> list: u32;

fn tile_total() -> u32 {
    return flow_grid.field_count * flow_grid.tile_columns * flow_grid.tile_rows;
}

fn index_of(id: vec3<u32>) -> u32 {
    return id.x + id.y * MOST_GROUPS * GROUP;
}

fn enlist(list: u32, tile: u32) {
    if atomicExchange(&flow_tiles[tile], 1u) == 0u {
        let place = atomicAdd(&flow_args[list * 4u + 3u], 1u);
        flow_lists[list * tile_total() + place] = tile;
        atomicMax(&flow_args[list * 4u], place / GROUP + 1u);
    }
}

@compute @workgroup_size(32)
fn flow_reset(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = index_of(id);
    let cells = flow_grid.field_count * flow_grid.cell_count;
    let end = min((index + 1u) * TILE * TILE, cells);
    for (var at = index * TILE * TILE; at < end; at++) {
        flow_distance[at] = FAR;
    }
    clear_lists(index);
}

fn clear_lists(index: u32) {
    let total = tile_total();
    if index < total {
        atomicStore(&flow_tiles[index], 0u);
        for (var list = 0u; list < 4u; list++) {
            flow_lists[list * total + index] = 0u;
        }
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

@compute @workgroup_size(32)
fn flow_sow(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = index_of(id);
    if index >= flow_grid.seed_count {
        return;
    }
    let seed = flow_seeds[index];
    set_distance(seed.field, seed.cell, seed.distance);
}

// Sets the distance of a cell of a field; puts the tiles that can fall because of it on lists 0 and 1.
fn set_distance(field: u32, cell: u32, distance: f32) {
    flow_distance[field * flow_grid.cell_count + cell] = distance;
    let column = cell % flow_grid.columns;
    let row = cell / flow_grid.columns;
    let tx = column / TILE;
    let tz = row / TILE;
    let tile = (field * flow_grid.tile_rows + tz) * flow_grid.tile_columns + tx;
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

@compute @workgroup_size(32)
fn flow_join(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = index_of(id);
    if index >= flow_grid.joint_count * flow_grid.field_count {
        return;
    }
    let field = index / flow_grid.joint_count;
    let joint = flow_joints[index % flow_grid.joint_count];
    let sheet_cells = flow_grid.sheet_rows * flow_grid.columns;
    let first = field * flow_grid.cell_count + joint.cell;
    var least = FAR;
    for (var sheet = 0u; sheet < 32u; sheet++) {
        if (joint.sheets >> sheet & 1u) != 0u {
            least = min(least, flow_distance[first + sheet * sheet_cells]);
        }
    }
    for (var sheet = 0u; sheet < 32u; sheet++) {
        if (joint.sheets >> sheet & 1u) != 0u && flow_distance[first + sheet * sheet_cells] > least {
            set_distance(field, joint.cell + sheet * sheet_cells, least);
        }
    }
}

@compute @workgroup_size(32)
fn flow_enlist_solid(@builtin(global_invocation_id) id: vec3<u32>) {
    let tile = index_of(id);
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

@compute @workgroup_size(32)
fn flow_sweep(@builtin(global_invocation_id) id: vec3<u32>) {
    let place = index_of(id);
    turn(place, false);
}

@compute @workgroup_size(32)
fn flow_sweep_solid(@builtin(global_invocation_id) id: vec3<u32>) {
    let place = index_of(id);
    turn(place, true);
}

// Sweeps one tile of the list, with its solid cells or without.
fn turn(place: u32, with_solid: bool) {
    if place == 0u {
        clear_list((list + 3u) & 3u);
    }
    if place >= atomicLoad(&flow_args[list * 4u + 3u]) {
        return;
    }
    let index = flow_lists[list * tile_total() + place];
    atomicStore(&flow_tiles[index], 0u);
    // the first sweep goes with the front: from the side beside which it is nearer to the goal
    var tile = tile_at(index);
    let middle_row = tile.first + (tile.z0 + tile.height / 2u) * flow_grid.columns;
    let middle_column = tile.first + tile.x0 + tile.width / 2u;
    tile.from_right = outside(middle_row, 1u, tile.x0, tile.width, flow_grid.columns);
    tile.from_above = outside(middle_column, flow_grid.columns, tile.z0, tile.height, flow_grid.rows);
    tile_load(tile, select(SOLID, 0u, with_solid));
    let quiet = tile_sweeps(&tile, SWEEPS);
    if !quiet {
        enlist((list + 2u) & 3u, index);
    }
    wake(tile_wakes(tile, with_solid), tile, index);
    tile_store(tile);
}

// Whether the goal is nearer beyond the end of a tile than before its begin, along an axis on which cells lie `stride`
// apart and of which the tile takes `size` cells from `begin` on.
fn outside(line: u32, stride: u32, begin: u32, size: u32, end: u32) -> bool {
    let last = flow_grid.field_count * flow_grid.cell_count - 1u;
    let before = select(FAR, flow_distance[min(line + (begin - 1u) * stride, last)], begin > 0u);
    let beyond = select(FAR, flow_distance[min(line + (begin + size) * stride, last)], begin + size < end);
    return beyond < before;
}

// Puts those neighbouring tiles on the next list that can fall now.
fn wake(woken: u32, tile: Tile, index: u32) {
    let next = (list + 1u) & 3u;
    if (woken & FROM_RIGHT) != 0u && tile.x0 > 0u {
        enlist(next, index - 1u);
    }
    if (woken & FROM_LEFT) != 0u && tile.x0 + tile.width < flow_grid.columns {
        enlist(next, index + 1u);
    }
    if (woken & FROM_ABOVE) != 0u && tile.z0 > 0u {
        enlist(next, index - flow_grid.tile_columns);
    }
    if (woken & FROM_BELOW) != 0u && tile.z0 + tile.height < flow_grid.rows {
        enlist(next, index + flow_grid.tile_columns);
    }
}

// How fast the distance falls towards +, from the two neighbours along one axis: the mean slope where both can be
// entered from and stand free, else that to the lower one.
fn slope(here: f32, low: f32, high: f32, both: bool) -> f32 {
    return select(max(here - high, 0.0) - max(here - low, 0.0), 0.5 * (low - high), both);
}

// Writes the directions of the cells of a row. Rows 1, 0 and 2 hold the distances of the row and of the rows below and above.
fn point_row(tile: Tile, z: u32) {
    let row = (tile.z0 + z) * flow_grid.columns + tile.x0;
    for (var i = 0u; i < TILE; i++) {
        if i < tile.width {
            let at = RING + i + 1u;
            let bits = flow_cells[row + i] & ALL_BITS;
            let here = tile_distance[at];
            let from_left = (bits & FROM_LEFT) != 0u;
            let from_right = (bits & FROM_RIGHT) != 0u;
            let from_below = (bits & FROM_BELOW) != 0u;
            let from_above = (bits & FROM_ABOVE) != 0u;
            let left = select(here, tile_distance[at - 1u], from_left);
            let right = select(here, tile_distance[at + 1u], from_right);
            let below = select(here, tile_distance[at - RING], from_below);
            let above = select(here, tile_distance[at + RING], from_above);
            let is_free = (bits & SOLID) == 0u;
            let fall = vec2<f32>(
                slope(here, left, right, is_free && from_left && from_right),
                slope(here, below, above, is_free && from_below && from_above),
            );
            let steep = sqrt(fall.x * fall.x + fall.y * fall.y);
            var word = bits;
            if here < 0.5 * FAR && steep > 0.0 {
                word |= LEADS | way_pack(fall * (1.0 / steep));
            }
            flow_way[tile.first + row + i] = word;
        }
    }
}

@compute @workgroup_size(32)
fn flow_point(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = index_of(id);
    if index < tile_total() {
        let tile = tile_at(index);
        tile_load_row(tile, 0u, 1u);
        tile_load_row(tile, 1u, 2u);
        for (var z = 0u; z < tile.height; z++) {
            for (var i = 0u; i < RING; i++) {
                tile_distance[i] = tile_distance[RING + i];
                tile_distance[RING + i] = tile_distance[2u * RING + i];
            }
            tile_load_row(tile, z + 2u, 2u);
            point_row(tile, z);
        }
    }
    clear_lists(index);
}

@compute @workgroup_size(32)
fn flow_mark(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = index_of(id);
    if index < flow_grid.seed_count {
        let seed = flow_seeds[index];
        flow_way[seed.field * flow_grid.cell_count + seed.cell] |= seed.sees;
    }
}

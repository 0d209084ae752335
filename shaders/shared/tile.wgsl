// A tile of the flow grid and the ring of cells around it, held by one invocation in the order of a sweep: the first cell is
// the first that the sweep reaches. Only constants index the cells, in loops that a compiler unrolls. So it can keep them in
// registers, and sweeping waits for no memory. Where the code reads or writes rows one after the other, all rows move up by
// one each time, and the code always accesses the same one. This compiles faster than unrolling.
// Needs the bindings flow_grid, flow_cells and flow_distance. Twin: in reference::flow.
const TILE: u32 = 8u;          // cells along a side
const RING: u32 = TILE + 2u;   // with the ring

struct Tile {
    first: u32,           // cell at which the field begins
    x0: u32,
    z0: u32,
    width: u32,           // cells; fewer than TILE at the end of the grid
    height: u32,
    from_right: bool,     // whether sweeps along x begin at the high end
    from_above: bool,     // likewise along z
}

// The bits by which a cell is entered from its neighbour in the order of a sweep: along the row, and from row to row.
struct TileBits {
    behind: u32,
    ahead: u32,
    under: u32,
    over: u32,
}

var<private> tile_distance: array<f32, RING * RING>; // m
var<private> tile_cells: array<u32, TILE * TILE>;    // bits and step; 0, which never falls, outside the grid and where left out
var<private> tile_fell: u32;  // sides whose cells fell: the bits by which the neighbours there are entered
var<private> tile_quiet: bool; // nothing fell in this sweep

fn tile_at(index: u32) -> Tile {
    let x0 = index % flow_grid.tile_columns * TILE;
    let z0 = index / flow_grid.tile_columns % flow_grid.tile_rows * TILE;
    let first = index / (flow_grid.tile_columns * flow_grid.tile_rows) * flow_grid.cell_count;
    return Tile(first, x0, z0, min(TILE, flow_grid.columns - x0), min(TILE, flow_grid.rows - z0), false, false);
}

fn tile_bits(tile: Tile) -> TileBits {
    return TileBits(
        select(FROM_LEFT, FROM_RIGHT, tile.from_right),
        select(FROM_RIGHT, FROM_LEFT, tile.from_right),
        select(FROM_BELOW, FROM_ABOVE, tile.from_above),
        select(FROM_ABOVE, FROM_BELOW, tile.from_above),
    );
}

// Reads a row of the tile with its ring (0 is that before the tile) into row `to`.
fn tile_load_row(tile: Tile, j: u32, to: u32) {
    let last = flow_grid.field_count * flow_grid.cell_count - 1u;
    // cells outside the grid may be any others: no bits lead there
    let z = tile.z0 + select(j, RING - 1u - j, tile.from_above) - 1u;
    let row = tile.first + z * flow_grid.columns + tile.x0 - 1u;
    for (var i = 0u; i < RING; i++) {
        tile_distance[to * RING + i] = flow_distance[min(row + select(i, RING - 1u - i, tile.from_right), last)];
    }
}

fn tile_load_cells(tile: Tile, left_out: u32, j: u32) {
    let z = select(j, TILE - 1u - j, tile.from_above);
    let row = (tile.z0 + z) * flow_grid.columns + tile.x0;
    for (var i = 0u; i < TILE; i++) {
        let x = select(i, TILE - 1u - i, tile.from_right);
        let word = flow_cells[min(row + x, flow_grid.cell_count - 1u)];
        let is_in = x < tile.width && z < tile.height && (word & left_out) == 0u;
        tile_cells[(TILE - 1u) * TILE + i] = select(0u, word, is_in);
    }
}

fn tile_move_up() {
    for (var j = 0u; j + 1u < RING; j++) {
        for (var i = 0u; i < RING; i++) {
            tile_distance[j * RING + i] = tile_distance[(j + 1u) * RING + i];
        }
    }
}

// Reads a tile but for the cells with a bit of `left_out`.
fn tile_load(tile: Tile, left_out: u32) {
    for (var j = 0u; j < RING; j++) {
        tile_move_up();
        tile_load_row(tile, j, RING - 1u);
    }
    for (var j = 0u; j < TILE; j++) {
        for (var k = 0u; k + 1u < TILE; k++) {
            for (var i = 0u; i < TILE; i++) {
                tile_cells[k * TILE + i] = tile_cells[(k + 1u) * TILE + i];
            }
        }
        tile_load_cells(tile, left_out, j);
    }
    tile_fell = 0u;
}

// Writes a tile; what was read of it is gone.
fn tile_store(tile: Tile) {
    for (var j = 0u; j < TILE; j++) {
        tile_move_up();
        let z = select(j, TILE - 1u - j, tile.from_above);
        let row = tile.first + (tile.z0 + z) * flow_grid.columns + tile.x0;
        for (var i = 0u; i < TILE; i++) {
            let x = select(i, TILE - 1u - i, tile.from_right);
            if x < tile.width && z < tile.height {
                flow_distance[row + x] = tile_distance[i + 1u];
            }
        }
    }
}

// The sides (bits by which the neighbours there are entered) whose cells fell so far that one outside could fall because of
// it: an update is at least the lower neighbour plus 0.707 of a free cell's step. What is free on both sides of the border
// can be entered either way; `all`: so can what is not.
fn tile_wakes(tile: Tile, all: bool) -> u32 {
    let bits = tile_bits(tile);
    let any = select(0u, 0xffffffffu, all);
    let least = 0.7 * flow_grid.cell_size;
    var woken = 0u;
    for (var i = 0u; i < TILE; i++) {
        let row = (i + 1u) * RING;
        let column = i + 1u;
        let behind = tile_distance[row] > tile_distance[row + 1u] + least;
        let ahead = tile_distance[row + TILE + 1u] > tile_distance[row + TILE] + least;
        let under = tile_distance[column] > tile_distance[column + RING] + least;
        let over = tile_distance[column + (TILE + 1u) * RING] > tile_distance[column + TILE * RING] + least;
        woken |= select(0u, bits.ahead, behind && (tile_cells[i * TILE] & (bits.behind | any)) != 0u);
        woken |= select(0u, bits.behind, ahead && (tile_cells[i * TILE + TILE - 1u] & (bits.ahead | any)) != 0u);
        woken |= select(0u, bits.over, under && (tile_cells[i] & (bits.under | any)) != 0u);
        woken |= select(0u, bits.under, over && (tile_cells[(TILE - 1u) * TILE + i] & (bits.over | any)) != 0u);
    }
    return woken & tile_fell;
}

fn tile_sweep_row(bits: TileBits, j: u32) {
    for (var i = 0u; i < TILE; i++) {
        let at = (j + 1u) * RING + i + 1u;
        let word = tile_cells[j * TILE + i];
        let here = tile_distance[at];
        // a neighbour it may not be entered from is replaced by the cell itself, which never makes it fall
        let behind = select(here, tile_distance[at - 1u], (word & bits.behind) != 0u);
        let ahead = select(here, tile_distance[at + 1u], (word & bits.ahead) != 0u);
        let under = select(here, tile_distance[at - RING], (word & bits.under) != 0u);
        let over = select(here, tile_distance[at + RING], (word & bits.over) != 0u);
        let a = min(behind, ahead);
        let b = min(under, over);
        let size = way_step(word);
        let apart = abs(a - b);
        let both = 0.5 * (a + b + sqrt(max(2.0 * size * size - apart * apart, 0.0)));
        let fresh = select(min(a, b) + size, both, apart < size);
        let falls = fresh < here - 1e-4 * size;
        tile_distance[at] = select(here, fresh, falls);
        tile_quiet = tile_quiet && !falls;
        if i == 0u {
            tile_fell |= select(0u, bits.ahead, falls);
        }
        if i + 1u == TILE {
            tile_fell |= select(0u, bits.behind, falls);
        }
        if j == 0u {
            tile_fell |= select(0u, bits.over, falls);
        }
        if j + 1u == TILE {
            tile_fell |= select(0u, bits.under, falls);
        }
    }
}

// Sweeps in four orders, one after the other, until nothing falls or it was swept so often; whether it came to rest.
fn tile_sweeps(tile: ptr<function, Tile>, most: u32) -> bool {
    for (var sweep = 1u; sweep <= most; sweep++) {
        let bits = tile_bits(*tile);
        tile_quiet = true;
        tile_sweep_row(bits, 0u);
        tile_sweep_row(bits, 1u);
        tile_sweep_row(bits, 2u);
        tile_sweep_row(bits, 3u);
        tile_sweep_row(bits, 4u);
        tile_sweep_row(bits, 5u);
        tile_sweep_row(bits, 6u);
        tile_sweep_row(bits, 7u);
        if tile_quiet {
            break;
        }
        tile_mirror(tile);
        if (sweep & 1u) == 0u {
            tile_turn(tile);
        }
    }
    return tile_quiet;
}

fn tile_mirror_row(j: u32) {
    for (var i = 0u; i < RING / 2u; i++) {
        let kept = tile_distance[j * RING + i];
        tile_distance[j * RING + i] = tile_distance[j * RING + RING - 1u - i];
        tile_distance[j * RING + RING - 1u - i] = kept;
    }
    if j < TILE {
        for (var i = 0u; i < TILE / 2u; i++) {
            let kept = tile_cells[j * TILE + i];
            tile_cells[j * TILE + i] = tile_cells[j * TILE + TILE - 1u - i];
            tile_cells[j * TILE + TILE - 1u - i] = kept;
        }
    }
}

// From now on sweeps along x begin at the other end.
fn tile_mirror(tile: ptr<function, Tile>) {
    (*tile).from_right = !(*tile).from_right;
    tile_mirror_row(0u);
    tile_mirror_row(1u);
    tile_mirror_row(2u);
    tile_mirror_row(3u);
    tile_mirror_row(4u);
    tile_mirror_row(5u);
    tile_mirror_row(6u);
    tile_mirror_row(7u);
    tile_mirror_row(8u);
    tile_mirror_row(9u);
}

fn tile_swap_rows(j: u32) {
    for (var i = 0u; i < RING; i++) {
        let kept = tile_distance[j * RING + i];
        tile_distance[j * RING + i] = tile_distance[(RING - 1u - j) * RING + i];
        tile_distance[(RING - 1u - j) * RING + i] = kept;
    }
    if j < TILE / 2u {
        for (var i = 0u; i < TILE; i++) {
            let kept = tile_cells[j * TILE + i];
            tile_cells[j * TILE + i] = tile_cells[(TILE - 1u - j) * TILE + i];
            tile_cells[(TILE - 1u - j) * TILE + i] = kept;
        }
    }
}

// From now on sweeps along z begin at the other end.
fn tile_turn(tile: ptr<function, Tile>) {
    (*tile).from_above = !(*tile).from_above;
    tile_swap_rows(0u);
    tile_swap_rows(1u);
    tile_swap_rows(2u);
    tile_swap_rows(3u);
    tile_swap_rows(4u);
}

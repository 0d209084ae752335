// The flow grid: square cells over the walkable area, and for every field (one goal) which way leads on from each cell.
// Where there are floors it has several sheets of cells over the same area, one behind the other along z: that of the
// ground, and as many as floors lie above one another. Near a place where floors or ground meet both sheets have the same
// cells; these are joined: both are as far from the goal. Twin: reference::way.
struct FlowUniforms {
    origin: vec2<f32>,        // corner of cell 0, m
    cell_size: f32,           // m
    inverse_cell_size: f32,   // 1/m
    columns: u32,
    rows: u32,                // of all sheets
    cell_count: u32,          // columns * rows
    tile_columns: u32,        // tiles of TILE by TILE cells
    tile_rows: u32,
    field_count: u32,         // 0: no agent follows a flow field
    seed_count: u32,          // of flow_seeds
    window: u32,              // density is counted over 2 window + 1 cells each way
    density_weight: f32,      // m2: cost of a metre is 1 + density_weight * density; 0: density does not matter
    solid_step: f32,          // m: cost of a cell in which no agent can stand
    every: u32,               // steps between two counts of people; 0: never
    sheet_rows: u32,          // of one sheet
    joint_count: u32,         // of flow_joints
    unused_a: u32,
    unused_b: u32,
    unused_c: u32,
}

// Buffer `flow_seeds`: a cell from which a field begins, [seed].
struct FlowSeed {
    field: u32,
    cell: u32,
    distance: f32, // from the goal, m
    sees: u32,     // SEES: the goal is in sight of the cell; else 0
}

// Buffer `flow_joints`: the same cell on several sheets, [joint].
struct FlowJoint {
    cell: u32,   // of sheet 0
    sheets: u32, // a bit for each
}

// A word of flow_cells. Bits: the cell may be entered from the neighbour at -x, +x, -z, +z; it is no place to stand.
const FROM_LEFT: u32 = 1u;
const FROM_RIGHT: u32 = 2u;
const FROM_BELOW: u32 = 4u;
const FROM_ABOVE: u32 = 8u;
const SOLID: u32 = 16u;
const ALL_BITS: u32 = 31u;
// The upper 24 bits are those of what crossing it costs, a f32: its step, m (its size, times what a metre costs there).
const STEP_BITS: u32 = 0xffffff00u;

fn way_step(word: u32) -> f32 {
    return bitcast<f32>(word & STEP_BITS);
}

// The word with another step, to the nearest.
fn way_with_step(word: u32, step: f32) -> u32 {
    return (word & ALL_BITS) | ((bitcast<u32>(step) + 0x80u) & STEP_BITS);
}

// A word of flow_way: the same five bits, then
const SEES: u32 = 32u; // the goal lies in a straight line
const LEADS: u32 = 64u; // there is a way; where not, the goal cannot be reached from here
// and the direction of the way, (x, z) in [-1, 1], twelve bits each.
const WAY_SCALE: f32 = 2047.0;

fn way_pack(direction: vec2<f32>) -> u32 {
    let x = u32(i32(floor(direction.x * WAY_SCALE + 0.5)) + 2048);
    let z = u32(i32(floor(direction.y * WAY_SCALE + 0.5)) + 2048);
    return x << 8u | z << 20u;
}

fn way_direction(word: u32) -> vec2<f32> {
    let x = i32(word >> 8u & 0xfffu) - 2048;
    let z = i32(word >> 20u) - 2048;
    return vec2<f32>(f32(x), f32(z)) * (1.0 / WAY_SCALE);
}

// uses: step, grid
// The agents of each cell of the grid, as they come in: how many, and a list of them in no order. `advance_journey` fills the
// lists, `grid_scatter` reads them, and `integrate` empties them.
// Needs the binding cells: [cell][2] agents of the cell, and from `grid_scan` on those in the cells before it of its group; and the
// agent that came last, plus 1 (0: none). Each agent's next_in_cell is the one that came before it, likewise.
//
// The buffer cell_start holds: [cell + 1] where the agents of each cell begin among all, in cell order; then [group] how many are
// in the groups before; then the groups that are done, 0 between launches of `grid_scan`; then the number of the step. A group is
// GROUP_CELLS cells.
const CELL_WORDS: u32 = 2u;
const LANE_CELLS: u32 = 8u;     // cells whose agents one lane of a workgroup adds up
const GROUP_CELLS: u32 = 1024u; // by its LANES lanes together

// Where the words of the cell at a position begin.
fn cell_words(position: vec2<f32>) -> u32 {
    return CELL_WORDS * cell_at(position);
}

// The cell at a position.
fn cell_at(position: vec2<f32>) -> u32 {
    let at = grid_cell(position, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    return u32(at.y) * step.grid_columns + u32(at.x);
}

// Where cell_start says how many agents are in the groups before a group.
fn in_groups(group: u32) -> u32 {
    return step.cell_count + 1u + group;
}

// Where cell_start says which step it is, for kernels after `integrate`, which counts it on.
fn step_word() -> u32 {
    return in_groups((step.cell_count + GROUP_CELLS - 1u) / GROUP_CELLS) + 1u;
}

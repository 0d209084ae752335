//! Twins of the other texts of `shaders/shared/`.

/// Column and row of the cell that a ground position belongs to; outside the bounds, the nearest border cell.
pub fn grid_cell(
    position: [f32; 2],
    origin: [f32; 2],
    inverse_cell_size: f32,
    columns: u32,
    rows: u32,
) -> [i32; 2] {
    let x = ((position[0] - origin[0]) * inverse_cell_size).floor().clamp(0.0, (columns - 1) as f32);
    let y = ((position[1] - origin[1]) * inverse_cell_size).floor().clamp(0.0, (rows - 1) as f32);
    [x as i32, y as i32]
}

// The uniform grid. Agents outside the bounds belong to the border cells.
fn grid_cell(position: vec2<f32>, origin: vec2<f32>, inverse_cell_size: f32, columns: u32, rows: u32) -> vec2<i32> {
    let scaled = (position - origin) * inverse_cell_size;
    // clamped as floats first: converting a huge float to an integer is not defined on a GPU
    let x = clamp(floor(scaled.x), 0.0, f32(columns - 1u));
    let y = clamp(floor(scaled.y), 0.0, f32(rows - 1u));
    return vec2<i32>(i32(x), i32(y));
}

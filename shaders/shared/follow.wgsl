// uses: way, exact
// Following a field. Needs the bindings flow_grid and flow_way. Twin: reference::way.

// The direction (of any length) in which an agent at `at` walks to its goal, `to` away from it. It follows the flow field
// `field`, blended between the four cells around it, of the sheet it stands on. It follows `to` itself where its cell sees
// the goal, where there is no way, or without such a field. An agent in a solid cell is led out. Cells behind a wall do not
// count: the blend crosses only walkable links from cell to cell.
fn flow_direction(field: u32, sheet: u32, at: vec2<f32>, to: vec2<f32>) -> vec2<f32> {
    if field >= flow_grid.field_count {
        return to;
    }
    let scaled = (at - flow_grid.origin) * flow_grid.inverse_cell_size;
    let column = clamp(floor(scaled.x), 0.0, f32(flow_grid.columns - 1u));
    let row = clamp(floor(scaled.y), 0.0, f32(flow_grid.sheet_rows - 1u));
    let first = min(sheet * flow_grid.sheet_rows, flow_grid.rows - flow_grid.sheet_rows);
    let cell = field * flow_grid.cell_count + (first + u32(row)) * flow_grid.columns + u32(column);
    let own = flow_way[cell];
    if (own & (SEES | LEADS)) != LEADS {
        return to;
    }
    if (own & SOLID) != 0u {
        return way_direction(own);
    }
    // offset from the cell's middle, in cells; clamped for agents outside of the grid
    let off = clamp(scaled - vec2<f32>(column + 0.5, row + 0.5), vec2<f32>(-0.5, -0.5), vec2<f32>(0.5, 0.5));
    let right = off.x >= 0.0;
    let above = off.y >= 0.0;
    let x_open = (own & select(FROM_LEFT, FROM_RIGHT, right)) != 0u;
    let z_open = (own & select(FROM_BELOW, FROM_ABOVE, above)) != 0u;
    // all are read, whether they can be entered or not, so that no read waits for another
    let last = flow_grid.field_count * flow_grid.cell_count - 1u;
    let beside = select(cell - 1u, cell + 1u, right);
    let beyond = select(cell - flow_grid.columns, cell + flow_grid.columns, above);
    let x_way = flow_way[min(beside, last)];
    let z_way = flow_way[min(beyond, last)];
    let corner_way = flow_way[min(select(beyond - 1u, beyond + 1u, right), last)];
    let round_x = x_open && (x_way & select(FROM_BELOW, FROM_ABOVE, above)) != 0u;
    let round_z = z_open && (z_way & select(FROM_LEFT, FROM_RIGHT, right)) != 0u;
    let u = abs(off.x);
    let v = abs(off.y);
    let wx = select(0.0, u * (1.0 - v), x_open);
    let wz = select(0.0, (1.0 - u) * v, z_open);
    let wc = select(0.0, u * v, round_x || round_z);
    let blend = way_direction(own) * ((1.0 - u) * (1.0 - v)) + way_direction(x_way) * wx + way_direction(z_way) * wz
        + way_direction(corner_way) * wc;
    let length = sqrt(dot2(blend, blend));
    if length < 0.05 {
        return way_direction(own);
    }
    return blend * (1.0 / length);
}

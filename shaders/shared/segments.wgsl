// The obstacle segments near an agent, nearest first; twin: reference::segments.
// Needs grid, orca and the bindings step, obstacles, obstacle_cells.
var<private> segment_numbers: array<u32, 12>;
var<private> segment_distances: array<f32, 12>;

// Finds the segments nearer than `reach`, m, that are in the way of an agent at `elevation`, by (squared distance, number).
// Returns how many are in segment_numbers.
fn near_segments(at: vec2<f32>, reach: f32, elevation: f32) -> u32 {
    if step.obstacle_count == 0u {
        return 0u;
    }
    let centre = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let cell = u32(centre.y) * step.grid_columns + u32(centre.x);
    var count = 0u;
    let end = obstacle_cells[cell + 1u];
    for (var entry = obstacle_cells[cell]; entry < end; entry++) {
        let number = obstacle_cells[entry];
        let distance2 = segment_distance2(obstacles[number].a, obstacles[number].b, at);
        if distance2 < reach * reach && is_in_the_way(number, elevation) {
            // numbers rise within a cell's list, so equal distances stay in order of number
            var hole = count;
            while hole > 0u && distance2 < segment_distances[max(hole, 1u) - 1u] {
                if hole < SEGMENTS {
                    segment_numbers[hole] = segment_numbers[hole - 1u];
                    segment_distances[hole] = segment_distances[hole - 1u];
                }
                hole--;
            }
            if hole < SEGMENTS {
                segment_numbers[hole] = number;
                segment_distances[hole] = distance2;
                count = min(count + 1u, SEGMENTS);
            }
        }
    }
    return count;
}

// Whether a segment is in the way of an agent at `elevation`; without floors all are.
fn is_in_the_way(number: u32, elevation: f32) -> bool {
    if step.storey_height <= 0.0 {
        return true;
    }
    return stands_at(obstacles[number].corners, elevation);
}

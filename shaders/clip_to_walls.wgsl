// uses: step, grid, orca, absent, agent
// The last resort of collision avoidance: no agent walks through a wall. A velocity may bring an agent's centre across an
// obstacle segment, or nearer to it than GAP. It then loses its component into the wall, twice if need be (a corner). It is
// zero where that does not help. The way out of a solid stays open. Agents led from outside are exempt.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> slot_position: array<vec2<f32>>;      // [slot] m
@group(0) @binding(2) var<storage, read> slot_motion: array<SlotMotion>;       // [slot]
@group(0) @binding(3) var<storage, read> obstacles: array<Segment>;            // [segment]
@group(0) @binding(4) var<storage, read> obstacle_cells: array<u32>;           // [cell + 1] where the cell's list begins in this array, then the lists
@group(0) @binding(5) var<storage, read_write> new_velocity: array<vec2<f32>>; // [slot] m/s

// Least distance of a centre from a wall, m: far below any radius, far above rounding.
const GAP: f32 = 0.01;
// What is held at a wall leaves it at this speed, m/s: by rounding it might else cross again.
const NUDGE: f32 = 0.02;
const ROUNDS: u32 = 3u;

@compute @workgroup_size(64)
fn clip_to_walls(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= step.agent_count || step.obstacle_count == 0u {
        return;
    }
    let own = slot_motion[slot];
    if own.agent == NOBODY || (own.limits & LED_BIT) != 0u {
        return;
    }
    let at = slot_position[slot];
    let wanted = new_velocity[slot];
    if !is_finite2(wanted) {
        return; // for integrate to report
    }
    let centre = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let cell = u32(centre.y) * step.grid_columns + u32(centre.x);
    let end = obstacle_cells[cell + 1u];
    var velocity = wanted;
    var held = 1u;
    for (var round = 0u; round < ROUNDS && held > 0u; round++) {
        held = 0u;
        for (var entry = obstacle_cells[cell]; entry < end; entry++) {
            let wall = obstacles[obstacle_cells[entry]];
            let along = wall.along;
            let there = step.storey_height <= 0.0 || stands_at(wall.corners, own.elevation);
            if there && crosses(at, velocity, wall.a, wall.b, along) {
                held++;
                velocity = along * dot2(along, velocity) + vec2<f32>(along.y, -along.x) * NUDGE;
                if round + 1u == ROUNDS || crosses(at, velocity, wall.a, wall.b, along) {
                    velocity = vec2<f32>(0.0, 0.0);
                }
            }
        }
    }
    if velocity.x != wanted.x || velocity.y != wanted.y {
        new_velocity[slot] = velocity;
    }
}

// Whether one step would bring a point on the open side of a segment nearer than GAP to it, or across.
fn crosses(at: vec2<f32>, velocity: vec2<f32>, a: vec2<f32>, b: vec2<f32>, along: vec2<f32>) -> bool {
    let next = at + velocity * step.time_step;
    let now = det2(along, a - at);
    let then = det2(along, a - next);
    if now < 0.0 || then >= now || then >= GAP {
        return false;
    }
    // where the move is at the gap's edge, and where it is on the line
    let s = dot2(along, at - a);
    let moved = dot2(along, next - at);
    let first = s + moved * ((now - min(now, GAP)) / (now - then));
    let last = s + moved * ((now - max(then, 0.0)) / (now - then));
    return max(first, last) >= -GAP && min(first, last) <= dot2(along, b - a) + GAP;
}

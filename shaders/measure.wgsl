// uses: step, storey, grid, cells, orca, absent, agent
// Measures the crowd after a step: how near two discs come, which pairs overlap, who is outside the walkable area, how fast
// people walk, and when they are gone. What it finds is summed on the device, so that the host need not read each step.
// The grid is that of the step's beginning. Agents that came in during the step have no slot, and are in no pair yet.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;           // [agent] m
@group(0) @binding(2) var<storage, read> velocity: array<vec2<f32>>;           // [agent] m/s
@group(0) @binding(3) var<storage, read> body: array<Body>;                    // [agent]
@group(0) @binding(4) var<storage, read> elevation: array<f32>;                // [agent] m
@group(0) @binding(5) var<storage, read> cell_start: array<u32>;               // see cells.wgsl
@group(0) @binding(6) var<storage, read> slot_position: array<vec2<f32>>;      // [slot] m, at the step's beginning
@group(0) @binding(7) var<storage, read> slot_motion: array<SlotMotion>;       // [slot]
@group(0) @binding(8) var<storage, read> obstacles: array<Segment>;            // [segment]
@group(0) @binding(9) var<storage, read> obstacle_cells: array<u32>;           // [cell + 1] where the cell's list begins in this array, then the lists
@group(0) @binding(10) var<storage, read> cell_depth: array<i32>;               // [cell] solids that its middle lies in
@group(0) @binding(11) var<storage, read_write> seen: array<Seen>;             // [agent]
@group(0) @binding(12) var<storage, read_write> measured: array<atomic<u32>>;  // least gap (in_order), then [MEASURED_STEPS] overlapping pairs of a step, then [MEASURED_STEPS] agents outside

// Steps that the host may leave unread.
const MEASURED_STEPS: u32 = 1024u;
// Gaps are measured up to this, m.
const NEAR: f32 = 0.5;
// Two discs overlap when their centres are nearer than this share of their summed radii.
const OVERLAP: f32 = 0.9;

// Buffer `seen`: what was seen of an agent.
struct Seen {
    speed_sum: f32, // over the steps in which it was there, m/s
    steps: u32,     // in which it was there
    is_there: u32,  // 1: it was, when it was last seen
    gone: u32,      // steps done when it was gone; 0: it is there, or never was
}

@compute @workgroup_size(64)
fn measure(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= step.agent_count {
        return;
    }
    see(id.x);
    let agent = slot_motion[id.x].agent;
    if agent == NOBODY || is_absent(position[agent]) {
        return;
    }
    let number = cell_start[step_word()] % MEASURED_STEPS;
    if step.obstacle_count > 0u && is_outside(position[agent]) {
        atomicAdd(&measured[1u + MEASURED_STEPS + number], 1u);
    }
    measure_pairs(id.x, agent, number);
}

// Notes whether an agent is there, and how fast it walks.
fn see(agent: u32) {
    var own = seen[agent];
    if is_absent(position[agent]) {
        own.gone = select(own.gone, cell_start[step_word()] + 1u, own.is_there == 1u);
        own.is_there = 0u;
    } else {
        let v = velocity[agent];
        own = Seen(own.speed_sum + sqrt(dot2(v, v)), own.steps + 1u, 1u, 0u);
    }
    seen[agent] = own;
}

// The overlaps of an agent with those of higher slots, and the gaps below the least so far. What that is by now depends on the
// other invocations; what is found does not: a gap counts if the other is not faster than any may be, and then it is in reach.
fn measure_pairs(slot: u32, agent: u32, number: u32) {
    let at = position[agent];
    let radius = body[agent].radius;
    let known = atomicLoad(&measured[0]);
    var least = select(NEAR, from_order(known), known < in_order(NEAR));
    let way = step.fastest * step.time_step;
    let reach = radius + step.widest_radius + max(least, 0.0) + way;
    let low = grid_cell(at - vec2<f32>(reach), step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let high = grid_cell(at + vec2<f32>(reach), step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    var overlapping = 0u;
    for (var row = u32(low.y); row <= u32(high.y); row++) {
        let end = cell_start[row * step.grid_columns + u32(high.x) + 1u];
        for (var other = max(cell_start[row * step.grid_columns + u32(low.x)], slot + 1u); other < end; other++) {
            let start = slot_position[other] - at;
            if dot2(start, start) > reach * reach {
                continue;
            }
            let them = slot_motion[other].agent;
            let to = position[them] - at;
            let distance = sqrt(dot2(to, to));
            let sum = radius + body[them].radius;
            let gap = distance - sum;
            let farthest = sum + max(gap, 0.0) + way;
            if dot2(start, start) <= farthest * farthest && on_storey(elevation[agent], elevation[them]) {
                least = min(least, gap);
                overlapping += u32(distance < OVERLAP * sum);
            }
        }
    }
    if in_order(least) < min(known, in_order(NEAR)) {
        atomicMin(&measured[0], in_order(least));
    }
    if overlapping > 0u {
        atomicAdd(&measured[1u + number], overlapping);
    }
}

// Bits that are in the order of the numbers.
fn in_order(number: f32) -> u32 {
    let bits = bitcast<u32>(number);
    return select(bits | 0x80000000u, ~bits, (bits >> 31u) == 1u);
}

// The number of such bits.
fn from_order(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 0x7fffffffu, (bits >> 31u) == 1u));
}

// Whether a point lies in something solid. On the way there from the middle of its cell every wall that is crossed leads into
// a solid or out of one.
fn is_outside(at: vec2<f32>) -> bool {
    let cell = cell_at(at);
    let place = vec2<f32>(f32(cell % step.grid_columns), f32(cell / step.grid_columns)) + vec2<f32>(0.5);
    let middle = step.grid_origin + place * step.cell_size;
    var depth = cell_depth[cell];
    let end = obstacle_cells[cell + 1u];
    for (var entry = obstacle_cells[cell]; entry < end; entry++) {
        let wall = obstacles[obstacle_cells[entry]];
        let ends_apart = (det2(at - middle, wall.a - middle) > 0.0) != (det2(at - middle, wall.b - middle) > 0.0);
        // what stands at some heights only bounds no area
        if ends_apart && abs(wall.corners.x) < 0.5 * RAISED {
            let ab = wall.b - wall.a;
            depth += i32(det2(ab, at - wall.a) > 0.0) - i32(det2(ab, middle - wall.a) > 0.0);
        }
    }
    return depth > 0;
}

// uses: step, grid, exact, mood, agent
// Sums what each agent hears for `emotion_update`: the strength of all agents near it, and their mean feelings.
// Each step updates a quarter of the rows of cells, and the first step updates all: feelings change over seconds.
// Rows take turns, not agents. So neighbouring threads do the same work, and the numbering of agents does not matter.
//
// R hears S with epsilon_S alpha_SR, alpha_SR falling from 1 here to 0 at mood.radius; q* = sum of epsilon alpha q_S / sum of
// epsilon alpha. The sums are of integers (steps of 2^-20): they are the same in any order.
const SHARE: f32 = 1048576.0;     // units of a sum that make 1
const MOST_HEARD: u32 = 4095u;    // voices that fit into a sum
const MOST_TURNS: u32 = 32768u;   // candidates that are looked at, whatever the crowd
const ROWS_BETWEEN: u32 = 4u;     // from one row that has its turn to the next; an agent that changes rows may wait for nearly two rounds

@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<uniform> mood: MoodUniforms;
@group(0) @binding(2) var<storage, read> slot_position: array<vec2<f32>>; // [slot] m
@group(0) @binding(3) var<storage, read> slot_motion: array<SlotMotion>;  // [slot]
@group(0) @binding(4) var<storage, read> cell_start: array<u32>;          // [cell + 1]
@group(0) @binding(5) var<storage, read> feeling: array<vec4<f32>>;       // [agent] weights of happy, angry, sad, neutral; sum 1
@group(0) @binding(6) var<storage, read> temperament: array<Temperament>; // [agent]
@group(0) @binding(7) var<storage, read_write> heard: array<Heard>;       // [agent]

fn units(share: f32) -> u32 {
    return u32(share * SHARE + 0.5);
}

// A sum as a number; both halves are exact, so it is rounded once.
fn total(sum: u32) -> f32 {
    return f32(sum >> 8u) * 256.0 + f32(sum & 255u);
}

@compute @workgroup_size(64)
fn emotion_gather(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.x;
    if slot >= cell_start[step.cell_count] {
        return;
    }
    let at = slot_position[slot];
    let row = grid_cell(at, step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows).y;
    if step.step_index > 0u && (u32(row) + step.step_index) % ROWS_BETWEEN != 0u {
        return;
    }
    let agent = slot_motion[slot].agent;
    let elevation = slot_motion[slot].elevation;
    let reach = mood.radius;
    var sums = vec4<u32>(0u);
    if reach > 0.0 && temperament[agent].openness > 0.0 {
        let low = grid_cell(at - vec2<f32>(reach), step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
        let high = grid_cell(at + vec2<f32>(reach), step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
        var count = 0u;
        var turns = 0u;
        for (var y = low.y; y <= high.y; y++) {
            let first = y * i32(step.grid_columns);
            let end = cell_start[first + high.x + 1];
            for (var other = cell_start[first + low.x]; other < end && turns < MOST_TURNS; other++) {
                turns++;
                let to = slot_position[other] - at;
                let distance2 = dot2(to, to);
                if !(distance2 < reach * reach) || other == slot || count >= MOST_HEARD {
                    continue;
                }
                let apart = abs(slot_motion[other].elevation - elevation);
                if step.storey_height > 0.0 && apart >= step.storey_height {
                    continue;
                }
                count++;
                let speaker = slot_motion[other].agent;
                let voice = temperament[speaker].expressiveness * (1.0 - sqrt(distance2) / reach);
                let weighted = voice * feeling[speaker];
                sums += vec4<u32>(units(voice), units(weighted.x), units(weighted.y), units(weighted.z));
            }
        }
    }
    if sums.x == 0u {
        heard[agent] = Heard();
        return;
    }
    let voices = total(sums.x);
    heard[agent] = Heard(
        voices / SHARE,
        min(total(sums.y) / voices, 1.0),
        min(total(sums.z) / voices, 1.0),
        min(total(sums.w) / voices, 1.0),
    );
}

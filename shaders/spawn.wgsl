// uses: step, storey, grid, absent, exact, agent
// Lets agents in: of every source at most one agent a step, the next by number once its time has come, at a random free
// place of the source. Without a free place it waits outside, and every later agent of the source waits behind it. A new
// agent is in the grid from the next step on, and stands still until then.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> body: array<Body>;                // [agent]
@group(0) @binding(2) var<storage, read> elevation: array<f32>;            // [agent] m
@group(0) @binding(3) var<storage, read> entry: array<u32>;                // [agent] step from which on it comes in + 1; 0: there from the start
@group(0) @binding(4) var<storage, read> cell_start: array<u32>;           // [cell + 1]
@group(0) @binding(5) var<storage, read> slot_position: array<vec2<f32>>;  // [slot] m
@group(0) @binding(6) var<storage, read> slot_motion: array<SlotMotion>;   // [slot]
@group(0) @binding(7) var<storage, read> source_places: array<vec2<f32>>;  // [place] m, of all sources one after another
@group(0) @binding(8) var<storage, read_write> sources: array<Source>;     // [source]
@group(0) @binding(9) var<storage, read_write> position: array<vec2<f32>>; // [agent] m

// Places tried in one step.
const TRIES: u32 = 16u;
// Gap left between two people, m.
const GAP: f32 = 0.1;
// Most people looked at for one place: more than fit near it.
const MOST: u32 = 1024u;

@compute @workgroup_size(64)
fn spawn(@builtin(global_invocation_id) id: vec3<u32>) {
    let source = id.x;
    if source >= step.source_count {
        return;
    }
    let own = sources[source];
    let next = own.entered;
    if next >= own.agents || own.places == 0u {
        return;
    }
    let agent = own.first_agent + next;
    if step.step_index + 1u < entry[agent] {
        return;
    }
    let begin = hash_u32(source ^ hash_u32(step.step_index ^ step.seed)) % own.places;
    for (var t = 0u; t < min(TRIES, own.places); t++) {
        let place = source_places[own.first_place + (begin + t) % own.places];
        if is_free(place, body[agent].radius, own.widest, elevation[agent]) {
            position[agent] = place;
            sources[source].entered = next + 1u;
            return;
        }
    }
}

// Whether no agent is too near a place for an agent of that radius and elevation.
fn is_free(place: vec2<f32>, radius: f32, widest: f32, height: f32) -> bool {
    let meets_user = step.user_radius > 0.0 && on_storey(height, step.user_elevation);
    if meets_user && is_near(place, step.user_position, radius + step.user_radius + GAP) {
        return false;
    }
    let reach = radius + widest + GAP;
    let low = grid_cell(place - vec2<f32>(reach), step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    let high = grid_cell(place + vec2<f32>(reach), step.grid_origin, step.inverse_cell_size, step.grid_columns, step.grid_rows);
    var seen = 0u;
    for (var row = u32(low.y); row <= u32(high.y); row++) {
        let first = cell_start[row * step.grid_columns + u32(low.x)];
        let end = cell_start[row * step.grid_columns + u32(high.x) + 1u];
        seen += end - first;
        if seen > MOST {
            return false;
        }
        for (var slot = first; slot < end; slot++) {
            let other = slot_motion[slot];
            if on_storey(other.elevation, height) && is_near(place, slot_position[slot], radius + other.radius + GAP) {
                return false;
            }
        }
    }
    return true;
}

fn is_near(a: vec2<f32>, b: vec2<f32>, distance: f32) -> bool {
    let to = b - a;
    return dot2(to, to) < distance * distance;
}

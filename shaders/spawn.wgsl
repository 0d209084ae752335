// uses: step, storey, grid, absent, exact
// Lets people in: of every source at most one agent a step, the next by number once its time has come, at a random free place of the source.
// While there is none it waits outside, and everyone after it. Who comes in is in the grid from the next step on, and stands still until then.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> body: array<vec4<f32>>;               // [agent] radius, ...
@group(0) @binding(2) var<storage, read> elevation: array<f32>;                // [agent] m
@group(0) @binding(3) var<storage, read> entry: array<u32>;                    // [agent] step from which on it comes in + 1; 0: there from the start
@group(0) @binding(4) var<storage, read> cell_start: array<u32>;               // [cell + 1]
@group(0) @binding(5) var<storage, read> slot_motion: array<vec4<f32>>;        // [slot][2] position, velocity; radius, maximum speed, priority, elevation
@group(0) @binding(6) var<storage, read> source_places: array<vec2<f32>>;      // [place] m, of all sources one after another
@group(0) @binding(7) var<storage, read_write> sources: array<u32>;            // [source][8] first place, places, first agent, agents, agents let in, widest radius (bits), 0, 0
@group(0) @binding(8) var<storage, read_write> position: array<vec2<f32>>;     // [agent] m

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
    let base = source * 8u;
    let places = sources[base + 1u];
    let next = sources[base + 4u];
    if next >= sources[base + 3u] || places == 0u {
        return;
    }
    let agent = sources[base + 2u] + next;
    if step.step_index + 1u < entry[agent] {
        return;
    }
    let widest = bitcast<f32>(sources[base + 5u]);
    let begin = hash_u32(source ^ hash_u32(step.step_index ^ step.seed)) % places;
    for (var t = 0u; t < min(TRIES, places); t++) {
        let place = source_places[sources[base] + (begin + t) % places];
        if is_free(place, body[agent].x, widest, elevation[agent]) {
            position[agent] = place;
            sources[base + 4u] = next + 1u;
            return;
        }
    }
}

// Whether nobody is too near a place for somebody of that radius and elevation.
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
            let traits = slot_motion[slot * 2u + 1u];
            if on_storey(traits.w, height) && is_near(place, slot_motion[slot * 2u].xy, radius + traits.x + GAP) {
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

// uses: step, exact, climb
// The floor under an agent. Floors are bridges, ramps and storeys: convex pieces of planes. Of those under a point, the
// agent stands on the one whose height is nearest to its own, if that is at most a step up or down. Otherwise it stands on
// the ground, at 0. An agent under a bridge stays under it, and one on a ramp goes up.
// Needs the bindings step and floors. Twin: reference::elevate.
//   floors: [floor][9] height = x a + z b + c: (a, b, c, sheet of the flow grid); eight edges: inside if x n + z m + d >= 0: (n, m, d, 0)
const FLOOR_STRIDE: u32 = 9u;
const EDGE: f32 = 0.02;  // m that a piece reaches beyond its edges, so that no agent falls between two that meet

struct Standing {
    height: f32,         // m
    sheet: f32,          // of the flow grid
    gradient: vec2<f32>, // of the height, m/m
}

// Where an agent stands at a point, from the height `present` it stood at before.
fn standing(at: vec2<f32>, present: f32) -> Standing {
    var nearest = STEP;
    var found = Standing(0.0, 0.0, vec2<f32>(0.0, 0.0));
    for (var number = 0u; number < step.floor_count; number++) {
        let base = number * FLOOR_STRIDE;
        var inside = true;
        for (var edge = 1u; edge < FLOOR_STRIDE && inside; edge++) {
            let side = floors[base + edge];
            inside = dot2(side.xy, at) + side.z >= -EDGE;
        }
        if inside {
            let plane = floors[base];
            let here = dot2(plane.xy, at) + plane.z;
            let off = abs(here - present);
            if off < nearest {
                nearest = off;
                found = Standing(here, plane.w, plane.xy);
            }
        }
    }
    return found;
}

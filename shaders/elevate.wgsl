// uses: step, exact, absent
// How high each agent stands: on the floor (bridge, ramp, storey: a convex piece of a plane) under it whose height is
// nearest to where it stood, if that is no more than a step up or down; else on the ground, at 0. So whoever walks under
// a bridge stays under it, and whoever walks up a ramp goes up.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;      // [agent] m
@group(0) @binding(2) var<storage, read> floors: array<vec4<f32>>;        // [floor][9] height = x a + z b + c: (a, b, c, 0); eight edges: inside if x n + z m + d >= 0: (n, m, d, 0)
@group(0) @binding(3) var<storage, read_write> elevation: array<f32>;     // [agent] m

const STRIDE = 9u;  // elements of a floor
const STEP = 0.6;   // m: nobody climbs more at once
const EDGE = 0.02;  // m that a piece reaches beyond its edges, so that nobody falls between two that meet

@compute @workgroup_size(64)
fn elevate(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count || is_absent(position[agent]) {
        return;
    }
    let at = position[agent];
    let present = elevation[agent];
    var nearest = STEP;
    var height = 0.0;
    for (var number = 0u; number < step.floor_count; number++) {
        let base = number * STRIDE;
        var inside = true;
        for (var edge = 1u; edge < STRIDE && inside; edge++) {
            let side = floors[base + edge];
            inside = dot2(side.xy, at) + side.z >= -EDGE;
        }
        if inside {
            let plane = floors[base];
            let here = dot2(plane.xy, at) + plane.z;
            let off = abs(here - present);
            if off < nearest {
                nearest = off;
                height = here;
            }
        }
    }
    elevation[agent] = height;
}

// uses: between, exact, agent
// Interpolates every agent between the two snapshots that `keep_snapshot` kept. The position moves along the straight line,
// the heading by the shorter turn, the phase of the walk forwards (it wraps by itself). An agent may be farther from its
// earlier place than people walk in that time: it was set to another place, has just come in, or is gone. It is then shown
// as in the newest snapshot. A share of 1 gives the newest snapshot bit for bit.
@group(0) @binding(0) var<uniform> between: BetweenUniforms;
@group(0) @binding(1) var<storage, read> snapshots: array<Snapshot>;           // [2][agent]
@group(0) @binding(2) var<storage, read_write> position: array<vec2<f32>>;     // [agent] m
@group(0) @binding(3) var<storage, read_write> stance: array<Stance>;          // [agent]
@group(0) @binding(4) var<storage, read_write> heading: array<f32>;            // [agent] rad
@group(0) @binding(5) var<storage, read_write> elevation: array<f32>;          // [agent] m
@group(0) @binding(6) var<storage, read_write> gait_weights: array<vec4<f32>>; // [agent]

const TURN_LIMIT: f32 = 10000.0; // rad; beyond it a float has no direction left

fn on_the_way(a: vec4<f32>, b: vec4<f32>, share: f32) -> vec4<f32> {
    return select(a + (b - a) * share, b, share >= 1.0);
}

@compute @workgroup_size(64)
fn interpolate(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= between.agent_count {
        return;
    }
    let was = snapshots[snapshot_of(1u - between.newest, agent)];
    let now = snapshots[snapshot_of(between.newest, agent)];
    let stood = vec4<f32>(was.position, was.heading, was.walk_weight);
    let stands = vec4<f32>(now.position, now.heading, now.walk_weight);
    let way = now.position - was.position;
    // a place or a heading that is no number is not on the way
    let walked = dot2(way, way) <= between.reach * between.reach && abs(now.heading - was.heading) < TURN_LIMIT;
    let share = select(1.0, between.share, walked);

    let there = on_the_way(stood, stands, share);
    position[agent] = there.xy;
    let turned = exact_wrap(was.heading + exact_wrap(now.heading - was.heading) * share);
    let lifted = on_the_way(vec4<f32>(was.elevation, was.stride, was.foresight, 0.0), vec4<f32>(now.elevation, now.stride, now.foresight, 0.0), share);
    let feet = on_the_way(vec4<f32>(was.left, was.right), vec4<f32>(now.left, now.right), share);
    let turns = on_the_way(vec4<f32>(was.turns, was.lean), vec4<f32>(now.turns, now.lean), share);
    let floors = on_the_way(vec4<f32>(was.heights, was.slopes), vec4<f32>(now.heights, now.slopes), share);
    heading[agent] = select(turned, now.heading, share >= 1.0);

    // 24 bits of a stride in the top of the word; below a share of 1 the product stays below 2^24
    let strides = u32(f32((now.phase - was.phase) >> 8u) * min(share, 0.99999994));
    let phase = select(was.phase + (strides << 8u), now.phase, share >= 1.0);
    stance[agent] = Stance(
        phase, there.w, feet.xy, feet.zw, turns.xy, turns.zw, floors.xy, floors.zw, lifted.y, lifted.z,
    );
    elevation[agent] = lifted.x;
    gait_weights[agent] = on_the_way(was.gait_weights, now.gait_weights, share);
}

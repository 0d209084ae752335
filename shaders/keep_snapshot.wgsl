// uses: between, agent
// Keeps the drawn state of a crowd's present snapshot, packed, at one of two places (`place`), for `interpolate`.
@group(0) @binding(0) var<uniform> between: BetweenUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;       // [agent] m
@group(0) @binding(2) var<storage, read> stance: array<Stance>;            // [agent]
@group(0) @binding(3) var<storage, read> heading: array<f32>;              // [agent] rad
@group(0) @binding(4) var<storage, read> elevation: array<f32>;            // [agent] m
@group(0) @binding(5) var<storage, read> gait_weights: array<vec4<f32>>;   // [agent]
@group(0) @binding(6) var<storage, read_write> snapshots: array<Snapshot>; // [2][agent]
var<immediate> place: u32;

@compute @workgroup_size(64)
fn keep_snapshot(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= between.agent_count {
        return;
    }
    let own = stance[agent];
    snapshots[snapshot_of(place, agent)] = Snapshot(
        position[agent], heading[agent], own.walk_weight, gait_weights[agent], own.phase, elevation[agent],
        own.stride, own.foresight, own.left, own.right, own.turns, own.lean, own.heights, own.slopes,
    );
}

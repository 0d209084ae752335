// uses: step, absent
// Advances the queues, one invocation each. An agent that has been served for its time leaves. Of the agents that came to
// the end of the line in this step, the one with the lowest number gets the next place. `advance_journey` reports which
// agents are there, and walks each to its place.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read_write> queues: array<u32>;         // [queue][8] agent that asks to join (NOBODY: none), first and next ticket in the line, 1 if the first stands at the counter, steps it has been served, places, steps of service, 0
@group(0) @binding(2) var<storage, read_write> stage_progress: array<u32>; // [agent] in a queue: its ticket + 1

@compute @workgroup_size(64)
fn queue(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= step.queue_count {
        return;
    }
    let base = id.x * 8u;
    var first = queues[base + 1u];
    let next = queues[base + 2u];
    if queues[base + 3u] == 1u {
        var served = queues[base + 4u] + 1u;
        if served >= queues[base + 6u] {
            first += 1u;
            queues[base + 1u] = first;
            served = 0u;
        }
        queues[base + 4u] = served;
        queues[base + 3u] = 0u;
    }
    let joins = queues[base];
    if joins != NOBODY {
        if next - first < queues[base + 5u] {
            stage_progress[joins] = next + 1u;
            queues[base + 2u] = next + 1u;
        }
        queues[base] = NOBODY;
    }
}

// The agents that the first phase of a velocity kernel leaves to the second: two lists in one buffer, one from either end.
// One is of agents whose neighbours the first phase has found. The other is of agents that have to look farther, or nearer.
// So invocations side by side do alike. A workgroup of the second phase takes agents of one list only.
// Needs the bindings step and unsolved: workgroups of the second phase along x, y, z; how many each list has; their entries.
const LIST_FOUND: u32 = 3u;   // where their lengths stand
const LIST_UNSURE: u32 = 4u;
const LISTED: u32 = 5u;       // where the entries begin
const GROUP: u32 = 64u;       // invocations of a workgroup
const REACH_SHIFT: u32 = 28u; // an entry is a slot, and the reach in which to look for neighbours; 0: they are known
const NO_ENTRY: u32 = 0xffffffffu;

// Leaves the agent of a slot to the second phase.
fn leave(slot: u32, reach: u32) {
    let list = select(LIST_UNSURE, LIST_FOUND, reach == 0u);
    let place = atomicAdd(&unsolved[list], 1u);
    let at = select(step.agent_count - 1u - place, place, reach == 0u);
    atomicStore(&unsolved[LISTED + at], slot | (reach << REACH_SHIFT));
    if place % GROUP == 0u {
        atomicAdd(&unsolved[0], 1u);
    }
}

// The entry that an invocation of the second phase takes.
fn left_to(invocation: u32) -> u32 {
    let found_count = atomicLoad(&unsolved[LIST_FOUND]);
    let unsure_count = atomicLoad(&unsolved[LIST_UNSURE]);
    let first = (found_count + GROUP - 1u) / GROUP * GROUP; // of the second list
    let is_first = invocation < first;
    let place = select(invocation - first, invocation, is_first);
    let is_there = place < select(unsure_count, found_count, is_first);
    let at = select(step.agent_count - 1u - place, place, is_first);
    return select(NO_ENTRY, atomicLoad(&unsolved[LISTED + select(0u, at, is_there)]), is_there);
}

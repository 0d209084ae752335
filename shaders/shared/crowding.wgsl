// uses: contents
// How much slower an agent walks the more people there are ahead; twin: reference::crowding, where the equations are.
//
// Needs the bindings step, slot_position, slot_motion and preferred_velocity, and the list `found` of
// shared/neighbours.wgsl.

// The share of the own person in the density.
const OWN_SHARE: f32 = 0.13;
// v0 of Weidmann's diagram, m/s.
const FREE_SPEED: f32 = 1.34;
// One over the density at which all stand, m2, and how steeply speed falls, 1/m2 (Weidmann 1993).
const JAM_AREA: f32 = 0.18518518;
const STEEPNESS: f32 = 2.7598755; // 1.913 log2(e)
// The least speed wanted, as a share of v0, which Weidmann has at 5 people/m2: in a jam people
// shuffle on, or it would never dissolve.
const LEAST_SHARE: f32 = 0.03;
// The density is measured over no less than this, m2.
const LEAST_REACH2: f32 = 0.04;

// Whether an agent has been given the right of way (RAISE). Such an agent does not slow down for the density.
fn has_right_of_way(slot: u32) -> bool {
    return slot_motion[slot].priority >= RAISE;
}

// What is left of the velocity `wanted` by the agent in `slot` with `count` neighbours in `found`, of at most `cap` looked for
// within `range`, m.
fn crowded(slot: u32, wanted: vec2<f32>, range: f32, cap: u32, count: u32) -> vec2<f32> {
    let at = slot_position[slot];
    let wanted2 = dot2(wanted, wanted);
    if step.crowding <= 0.0 || count == 0u || wanted2 < 1e-8 {
        return wanted;
    }
    let reach = min(range, step.crowding_reach);
    var reach2 = reach * reach;
    if count == min(cap, NEIGHBOURS) {
        // there may be more people behind the farthest one, so the density is that of the disc up to it
        let to = slot_position[found[count - 1u]] - at;
        reach2 = min(reach2, dot2(to, to));
    }
    reach2 = max(reach2, LEAST_REACH2);
    var people = OWN_SHARE;
    for (var k = 0u; k < count; k++) {
        let to = slot_position[found[k]] - at;
        let distance2 = dot2(to, to);
        let along = dot2(to, wanted);
        // members of a group walk near one another on purpose
        let is_mate = (contents & GROUPS) != 0u && is_with(slot, found[k]);
        if (along > 0.0) & (distance2 > 1e-6) & (distance2 < reach2) & !is_mate {
            let theirs = preferred_velocity[slot_motion[found[k]].agent];
            let theirs2 = dot2(theirs, theirs);
            // an agent queues behind one that stands, and not behind one that comes the other way
            let same = select(dot2(theirs, wanted) / sqrt(theirs2 * wanted2), 1.0, theirs2 < 1e-8);
            people += (1.0 - distance2 / reach2) * (along / sqrt(distance2 * wanted2)) * max(same, 0.0);
        }
    }
    let density = people / (0.5 * reach2);
    let room = max(1.0 - exact_exp2(-STEEPNESS * (1.0 / density - JAM_AREA)), LEAST_SHARE);
    // the diagram's speed over the wanted one
    let share = min(room * max(FREE_SPEED / sqrt(wanted2), 1.0), 1.0);
    return wanted * (1.0 - step.crowding * (1.0 - share));
}

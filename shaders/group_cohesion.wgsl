// uses: step, exact, absent, agent
// People who walk together: changes the preferred velocity of the members of a group. They stay side by side where there
// is room, walk at the pace of the slowest, and wait for a member that has fallen behind.
//
// After Moussaid, Perozo, Garnier, Helbing, Theraulaz, "The walking behaviour of pedestrian social groups and its impact
// on crowd dynamics" (PLoS ONE 2010). With N members, V the wanted velocity, the group adds to the acceleration
//   -GAZE a v            v: present velocity, a: angle by which the head must turn for the centre of the others to be seen (within 90 degrees)
//   +GATHER towards the centre of the group, if that is farther than (N - 1)/2 metres
//   -APART from every member nearer than PERSONAL.
// The acceleration towards a wanted velocity takes RELAXATION seconds, so a force f shifts the wanted velocity by f times
// that, and GAZE, whose force grows with the speed, divides it by 1 + GAZE a RELAXATION. The rest is ours. The two steps at
// a distance are ramps, since here velocities follow at once. Gathering is weaker than the will to go on. No agent walks
// backwards. A member that is farther along the route than another waits for it but does not hold it back.
//
// The kernel also marks each agent with its group. By that mark `velocity_*` exempts members from avoidance as strangers. The
// kernel raises the priority of members that their group has left behind. Strangers in a press then let them catch up. That
// is ours, too.
@group(0) @binding(0) var<uniform> step: StepUniforms;
@group(0) @binding(1) var<storage, read> position: array<vec2<f32>>;                 // [agent] m
@group(0) @binding(2) var<storage, read> body: array<Body>;                          // [agent]
@group(0) @binding(3) var<storage, read> route: array<Route>;                        // [agent]
@group(0) @binding(4) var<storage, read> companions: array<vec4<u32>>;               // [agent] the others of its group, NOBODY for none
@group(0) @binding(5) var<storage, read_write> preferred_velocity: array<vec2<f32>>; // [agent] m/s
@group(0) @binding(6) var<storage, read> agent_slot: array<u32>;                     // [agent] NOBODY if absent
@group(0) @binding(7) var<storage, read_write> slot_motion: array<SlotMotion>;       // [slot]

const GAZE: f32 = 2.0;        // 1/(rad s), beta 1; there 4, with which groups who wait for their own hold up a door
const GATHER: f32 = 3.0;      // m/s2, beta 2
const APART: f32 = 1.0;       // m/s2, beta 3
const PERSONAL: f32 = 0.8;    // m, d 0
const RELAXATION: f32 = 0.5;  // s
const RAMP: f32 = 0.5;        // m over which gathering and keeping apart grow to full strength; ours
const STRAY: f32 = 0.75;      // greatest share of the speed that gathering takes: more would hold agents at slanting walls; ours
const FORWARD: f32 = 0.1;     // least share of the pace: with less, agents walk backwards or wait for ever; ours
const LEFT_BEHIND: f32 = 0.9; // m by which the first of the group is ahead that count; ours
const HASTE: f32 = 1.0;       // 1/m: priority for each of them, so that they count like twice as many metres ahead (precedence: PLACE); ours

@compute @workgroup_size(64)
fn group_cohesion(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = id.x;
    if agent >= step.agent_count || is_absent(position[agent]) {
        return;
    }
    let others = companions[agent];
    let slot = agent_slot[agent];
    let first = min(min(others.x, others.y), min(others.z, others.w));
    if first != NOBODY && slot < step.agent_count {
        slot_motion[slot].limits |= (min(agent, first) + 1u) << GROUP_SHIFT;
    }
    let own_way = route[agent];
    let at = position[agent];
    var pace = body[agent].preferred_speed;
    var others_sum = vec2<f32>(0.0, 0.0);
    var away = vec2<f32>(0.0, 0.0);
    var count = 0.0;
    var wanted = preferred_velocity[agent];
    var behind = 0.0; // m that the first of the group is ahead, times the wanted speed
    for (var k = 0u; k < 4u; k++) {
        let other = others[k];
        if other < step.agent_count && !is_absent(position[min(other, step.agent_count - 1u)]) {
            pace = min(pace, body[other].preferred_speed);
            let way = route[other];
            let off = at - position[other];
            let distance = sqrt(dot2(off, off));
            if distance < PERSONAL && distance > 0.0 {
                away += off * (min((PERSONAL - distance) / RAMP, 1.0) / distance);
            }
            behind = max(behind, -dot2(off, wanted));
            let is_ahead = way.arrivals > own_way.arrivals || (way.arrivals == own_way.arrivals && way.next > own_way.next);
            if !is_ahead {
                others_sum += position[other];
                count += 1.0;
            }
        }
    }
    let wish = sqrt(dot2(wanted, wanted));
    if behind > 0.0 && slot < step.agent_count {
        // no priority of people is above 1: what is above belongs to robots, and to the right of way that is given
        let priority = slot_motion[slot].priority;
        let raised = min(priority + HASTE * min(behind / wish, LEFT_BEHIND), 1.0);
        slot_motion[slot].priority = max(priority, raised);
    }
    let own_speed = body[agent].preferred_speed;
    if own_speed > pace {
        wanted = wanted * (pace / own_speed);
    }
    let speed = sqrt(dot2(wanted, wanted));
    if speed > 0.0 {
        let direction = wanted / speed;
        var shift = away * (APART * RELAXATION);
        if count > 0.0 {
            // how far the head must turn for the centre of the others
            let to = others_sum / count - at;
            let along = dot2(to, direction);
            let turn = exact_atan2(max(-along, 0.0), abs(det2(direction, to)));
            let slower = GAZE * RELAXATION * turn;
            shift -= wanted * (slower / (1.0 + slower));
            // the centre of the group, the agent included
            let gather = to * (count / (count + 1.0));
            let distance = sqrt(dot2(gather, gather));
            let too_far = distance - 0.5 * count;
            if too_far > 0.0 {
                shift += gather * (min(GATHER * RELAXATION * min(too_far / RAMP, 1.0), STRAY * speed) / distance);
            }
        }
        let sum = wanted + shift;
        let forward = dot2(sum, direction);
        let least = FORWARD * speed;
        wanted = select(sum, sum + direction * (least - forward), forward < least);
    }
    preferred_velocity[agent] = wanted;
}

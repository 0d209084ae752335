// uses: frame, exact, body, attention, agent, scan
// Schedules which agents look at the user, so that a crowd never stares at once. Candidates are the drawn agents that are
// happy or angry and see the user (`paper` mode: all drawn agents). At most frame.gaze_limit - 1 of them look at a time.
// A turn lasts turn_least to turn_most. After it the agent rests for REST_LEAST to REST_LEAST + REST_SPAN. The agent that
// has waited longest comes next; the wait of near agents counts up to twice. Sets ATTENDS in gaze_frame, which `gaze` obeys.
//
// A key orders the agents that wait: ten bits of waiting, then eight of a hash that changes from frame to frame, so that
// equal ones do not stay equal. Sums of integers decide, in any order. The phases, in this order:
//   look (visible):     which turns go on, and how many agents wait with each upper half of a key,
//   border (one group): the half in which the room ends,
//   count (visible):    how many wait with each lower half within that one,
//   least (one group):  the least key that has room; keys beyond the room wait for the next frame,
//   begin (visible):    turns begin.
struct Attention {
    until: u32,         // when the turn ends or ended, ms
    key_and_frame: u32, // key << 14 | low bits of frame_index of the last update
}

const FIELD_START: f32 = 0.1;       // cosine of 84 degrees: turns begin a little within the field of regard
const REST_LEAST: u32 = 1000u;      // ms
const REST_SPAN: u32 = 2000u;       // ms
const WAIT_UNIT: f32 = 512.0;       // ms of waiting that make one step of a key
const MOST_WAIT: f32 = 1023.0;

const FRAME_BITS: u32 = 0x3fffu;

const BINS: u32 = 512u;             // of each half of a key
const HELD: u32 = 1024u;            // attention_counts: turns that go on
const BORDER: u32 = 1025u;          //   the upper half in which the room ends, or NONE
const ROOM: u32 = 1026u;            //   room that is left for that half
const LEAST: u32 = 1027u;           //   least key whose turn begins
const OVER: u32 = 1028u;            //   1: there are fewer turns than there were, all end
const COUNTS: u32 = 1029u;          // elements of attention_counts

@group(0) @binding(0) var<uniform> frame: FrameUniforms;
@group(0) @binding(1) var<storage, read> visible: array<u32>;                        // [visible] agents, then NONE
@group(0) @binding(2) var<storage, read> position: array<vec2<f32>>;                 // [agent] m
@group(0) @binding(3) var<storage, read> heading: array<f32>;                        // [agent] rad
@group(0) @binding(4) var<storage, read> appearance: array<Appearance>;              // [agent]
@group(0) @binding(5) var<storage, read_write> gaze_frame: array<u32>;               // [agent]
@group(0) @binding(6) var<storage, read_write> attention: array<Attention>;          // [agent]
@group(0) @binding(7) var<storage, read_write> attention_counts: array<atomic<u32>>; // [COUNTS]

// How far the user is on the ground, m, or -1 if the agent would not look there.
fn interest(agent: u32, looks: bool) -> f32 {
    let own = appearance[agent];
    if !gazes(own) || emotion_of(own) > ANGRY {
        return -1.0;
    }
    let to = vec2<f32>(frame.user_eyes.x, frame.user_eyes.z) - position[agent];
    let distance = sqrt(dot2(to, to));
    if frame.gaze_mode != 0u {
        return distance;
    }
    let turn = exact_sin_cos(heading[agent]);
    let ahead = turn.x * to.x + turn.y * to.y;
    let range = RANGE + select(0.0, RANGE_HYSTERESIS, looks);
    let sees = distance < range && ahead >= select(FIELD_START, FIELD_END, looks) * distance;
    return select(-1.0, distance, sees);
}

// What is left of a turn that ends or ended at `until`: positive while it lasts.
fn left_of(until: u32) -> i32 {
    return bitcast<i32>(until - frame.gaze_time);
}

fn draw(agent: u32, time: u32) -> u32 {
    return hash_u32(agent ^ hash_u32(time));
}

@compute @workgroup_size(64)
fn gaze_schedule_look(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = visible[id.x];
    if agent == NONE {
        return;
    }
    let memory = attention[agent];
    let is_fresh = ((frame.frame_index - memory.key_and_frame) & FRAME_BITS) <= 1u;
    let looks = is_fresh && left_of(memory.until) > 0;
    let distance = interest(agent, looks);
    var until = memory.until;
    var key = 0u;
    var attends = false;
    if looks && distance >= 0.0 {
        attends = true;
        atomicAdd(&attention_counts[HELD], 1u);
    } else {
        if left_of(until) > 0 {
            until = frame.gaze_time; // given up
        }
        let waited = frame.gaze_time - until;
        let rested = until == 0u || waited >= REST_LEAST + draw(agent, until) % REST_SPAN;
        if distance >= 0.0 && rested {
            let near = 2.0 - min(distance / RANGE, 1.0);
            let wait = min(floor(f32(waited) * near / WAIT_UNIT), MOST_WAIT);
            key = (max(u32(wait), 1u) << 8u) | (draw(agent, frame.gaze_time) & 255u);
            atomicAdd(&attention_counts[key / BINS], 1u);
        }
    }
    attention[agent] = Attention(until, (key << 14u) | (frame.frame_index & FRAME_BITS));
    gaze_frame[agent] = (gaze_frame[agent] & ~ATTENDS) | select(0u, ATTENDS, attends);
}

const OWN: u32 = 4u; // bins of a lane, BINS / LANES

var<workgroup> border: u32;
var<workgroup> room: u32;

// Finds the bin, counted from the top, that has no room any more, and empties all; `border` is NONE if all have. Leaves in
// `room` what is left. Every lane of the workgroup must call it.
fn find_border(lane: u32, first: u32, most: u32) {
    let highest = first + BINS - 1u - lane * OWN;
    var sum = 0u;
    for (var i = 0u; i < OWN; i++) {
        sum += atomicLoad(&attention_counts[highest - i]);
    }
    let sums = scan(lane, sum);
    if lane == 0u && sums.total <= most {
        border = NONE;
        room = most - sums.total;
    }
    if sums.before <= most && sums.before + sum > most {
        // it is one of this lane's
        var left = most - sums.before;
        for (var i = 0u; i < OWN; i++) {
            let count = atomicLoad(&attention_counts[highest - i]);
            if count > left {
                border = highest - i - first;
                room = left;
                break;
            }
            left -= count;
        }
    }
    for (var i = 0u; i < OWN; i++) {
        atomicStore(&attention_counts[highest - i], 0u);
    }
    workgroupBarrier();
}

@compute @workgroup_size(LANES)
fn gaze_schedule_border(@builtin(local_invocation_index) lane: u32) {
    let most = frame.gaze_limit - 1u;
    let held = atomicLoad(&attention_counts[HELD]);
    find_border(lane, 0u, most - min(held, most));
    if lane == 0u {
        atomicStore(&attention_counts[HELD], 0u);
        atomicStore(&attention_counts[OVER], select(0u, 1u, held > most));
        atomicStore(&attention_counts[BORDER], border);
        atomicStore(&attention_counts[ROOM], room);
    }
}

@compute @workgroup_size(64)
fn gaze_schedule_count(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = visible[id.x];
    if agent == NONE {
        return;
    }
    let key = attention[agent].key_and_frame >> 14u;
    if key != 0u && key / BINS == atomicLoad(&attention_counts[BORDER]) {
        atomicAdd(&attention_counts[BINS + key % BINS], 1u);
    }
}

@compute @workgroup_size(LANES)
fn gaze_schedule_least(@builtin(local_invocation_index) lane: u32) {
    let upper = atomicLoad(&attention_counts[BORDER]);
    // without a border no key was counted
    find_border(lane, BINS, atomicLoad(&attention_counts[ROOM]));
    if lane == 0u {
        // the border has more keys than there is room for, so one of its bins has, too
        atomicStore(&attention_counts[LEAST], select(upper * BINS + border + 1u, 1u, upper == NONE));
        atomicStore(&attention_counts[ROOM], room);
    }
}

@compute @workgroup_size(64)
fn gaze_schedule_begin(@builtin(global_invocation_id) id: vec3<u32>) {
    let agent = visible[id.x];
    if agent == NONE {
        return;
    }
    let key = attention[agent].key_and_frame >> 14u;
    if key != 0u && key >= atomicLoad(&attention_counts[LEAST]) {
        let span = frame.turn_most - frame.turn_least + 1u;
        attention[agent].until = frame.gaze_time + frame.turn_least + draw(agent, ~frame.gaze_time) % max(span, 1u);
        gaze_frame[agent] = gaze_frame[agent] | ATTENDS;
    } else if atomicLoad(&attention_counts[OVER]) == 1u && left_of(attention[agent].until) > 0 {
        attention[agent].until = frame.gaze_time;
        gaze_frame[agent] = gaze_frame[agent] & ~ATTENDS;
    }
}

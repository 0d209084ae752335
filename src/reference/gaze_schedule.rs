//! Schedules which agents look at the user, so that a crowd never stares at once.

use super::body::visible_agents;
use super::exact::{dot2, hash_u32, lesser, sin_cos};
use crate::kernels::gaze_schedule::index::{BORDER, HELD, LEAST, OVER, ROOM};
use crate::kernels::gaze_schedule::{
    BINS, FIELD_START, FRAME_BITS, MOST_WAIT, REST_LEAST, REST_SPAN, Slices, WAIT_UNIT,
};
use crate::kernels::layout::Attention;
use crate::kernels::shared::attention::{ANGRY, ATTENDS, FIELD_END, RANGE, RANGE_HYSTERESIS};
use crate::kernels::shared::body::NONE;

/// Twin of phase `look` of `shaders/gaze_schedule.wgsl`.
pub fn gaze_schedule_look(mut b: Slices<'_>) {
    let visible = b.visible;
    visible_agents(visible).iter().for_each(|agent| look_on(&mut b, *agent));
}

/// Twin of phase `count` of `shaders/gaze_schedule.wgsl`.
pub fn gaze_schedule_count(b: Slices<'_>) {
    for agent in visible_agents(b.visible) {
        let key = b.attention[*agent as usize].key_and_frame >> 14;
        if key != 0 && key / BINS == b.attention_counts[BORDER] {
            b.attention_counts[(BINS + key % BINS) as usize] += 1;
        }
    }
}

/// Twin of phase `begin` of `shaders/gaze_schedule.wgsl`.
pub fn gaze_schedule_begin(mut b: Slices<'_>) {
    let visible = b.visible;
    visible_agents(visible).iter().for_each(|agent| begin(&mut b, *agent));
}

fn interest(b: &Slices<'_>, agent: usize, looks: bool) -> f32 {
    let own = &b.appearance[agent];
    if !own.gazes() || own.emotion() > ANGRY {
        return -1.0;
    }
    let ([eyes_x, _, eyes_z, _], [x, z]) = (b.frame.user_eyes, b.position[agent]);
    let to = [eyes_x - x, eyes_z - z];
    let distance = dot2(to, to).sqrt();
    if b.frame.gaze_mode != 0 {
        return distance;
    }
    let [sine, cosine] = sin_cos(b.heading[agent]);
    let ahead = sine * to[0] + cosine * to[1];
    let range = RANGE + if looks { RANGE_HYSTERESIS } else { 0.0 };
    let sees = distance < range && ahead >= if looks { FIELD_END } else { FIELD_START } * distance;
    if sees { distance } else { -1.0 }
}

fn left_of(b: &Slices<'_>, until: u32) -> i32 {
    until.wrapping_sub(b.frame.gaze_time) as i32
}

fn draw(agent: u32, time: u32) -> u32 {
    hash_u32(agent ^ hash_u32(time))
}

fn look_on(b: &mut Slices<'_>, id: u32) {
    let (agent, now) = (id as usize, b.frame.gaze_time);
    let Attention { mut until, key_and_frame } = b.attention[agent];
    let is_fresh = b.frame.frame_index.wrapping_sub(key_and_frame) & FRAME_BITS <= 1;
    let looks = is_fresh && left_of(b, until) > 0;
    let distance = interest(b, agent, looks);
    let mut key = 0;
    let attends = looks && distance >= 0.0;
    if attends {
        b.attention_counts[HELD] += 1;
    } else {
        if left_of(b, until) > 0 {
            until = now; // given up
        }
        let waited = now.wrapping_sub(until);
        let rested = until == 0 || waited >= REST_LEAST + draw(id, until) % REST_SPAN;
        if distance >= 0.0 && rested {
            let near = 2.0 - lesser(distance / RANGE, 1.0);
            let wait = lesser((waited as f32 * near / WAIT_UNIT).floor(), MOST_WAIT);
            key = ((wait as u32).max(1) << 8) | (draw(id, now) & 255);
            b.attention_counts[(key / BINS) as usize] += 1;
        }
    }
    let key_and_frame = (key << 14) | (b.frame.frame_index & FRAME_BITS);
    b.attention[agent] = Attention { until, key_and_frame };
    b.gaze_frame[agent] = (b.gaze_frame[agent] & !ATTENDS) | if attends { ATTENDS } else { 0 };
}

fn border_of(counts: &mut [u32], first: u32, most: u32) -> u32 {
    let (mut room, mut border) = (most, NONE);
    for bin in (0..BINS).rev() {
        let count = std::mem::take(&mut counts[(first + bin) as usize]);
        if border == NONE {
            if count > room {
                border = bin;
            } else {
                room -= count;
            }
        }
    }
    counts[ROOM] = room;
    border
}

/// Twin of phase `border` of `shaders/gaze_schedule.wgsl`.
pub fn gaze_schedule_border(b: Slices<'_>) {
    let most = b.frame.gaze_limit.wrapping_sub(1);
    let counts = b.attention_counts;
    let held = std::mem::take(&mut counts[HELD]);
    counts[OVER] = u32::from(held > most);
    counts[BORDER] = border_of(counts, 0, most - held.min(most));
}

/// Twin of phase `least` of `shaders/gaze_schedule.wgsl`.
pub fn gaze_schedule_least(b: Slices<'_>) {
    let counts = b.attention_counts;
    let border = counts[BORDER];
    counts[LEAST] = 1;
    if border != NONE {
        let room = counts[ROOM];
        let fine = border_of(counts, BINS, room);
        counts[LEAST] = border.wrapping_mul(BINS).wrapping_add(fine).wrapping_add(1);
    }
}

fn begin(b: &mut Slices<'_>, id: u32) {
    let agent = id as usize;
    let key = b.attention[agent].key_and_frame >> 14;
    if key != 0 && key >= b.attention_counts[LEAST] {
        let now = b.frame.gaze_time;
        let span = b.frame.turn_most.wrapping_sub(b.frame.turn_least).wrapping_add(1);
        let turn = b.frame.turn_least.wrapping_add(draw(id, !now) % span.max(1));
        b.attention[agent].until = now.wrapping_add(turn);
        b.gaze_frame[agent] |= ATTENDS;
    } else if b.attention_counts[OVER] == 1 && left_of(b, b.attention[agent].until) > 0 {
        b.attention[agent].until = b.frame.gaze_time;
        b.gaze_frame[agent] &= !ATTENDS;
    }
}

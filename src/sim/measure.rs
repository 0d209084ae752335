//! What a crowd looks like from outside: speeds, clearances, overlaps, departures from the walkable area, and a hash.

use super::setup::NEVER;
use crate::ground::is_absent;
pub use crate::hash::Hash;
use crate::kernels::Store;
use crate::kernels::layout::{Appearance, Avoidance, Source};
use glam::Vec2;

/// Two discs overlap when their centres are nearer than this share of their summed radii.
pub const OVERLAP: f32 = crate::kernels::measure::OVERLAP;

/// What a crowd looks like at one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// Agents present.
    pub present: u32,
    /// Their mean speed, m/s; 0 for none.
    pub mean_speed: f32,
    /// Smallest gap between two discs, m (negative when they overlap); infinite when no two are near.
    pub min_clearance: f32,
    /// Pairs that overlap by more than a tenth.
    pub overlapping_pairs: u32,
    /// Routes and journeys walked to their end so far.
    pub arrived: u64,
    /// Agents present at any time so far, with those of the start.
    pub entered: u32,
    /// Agents that have left by an exit.
    pub left: u32,
    /// Agents whose time to come in has come, but that have found no room yet.
    pub waiting_outside: u32,
    /// Agents that no source has a time for.
    pub never: u32,
}

/// Time after a number of steps, s. A step of a thirtieth of a second is meant as such, although an `f32` holds only
/// nearly that.
pub fn time_of(steps: u32, time_step: f32) -> f64 {
    let rate = 1.0 / f64::from(time_step);
    let meant = if (rate - rate.round()).abs() < 1e-5 * rate { rate.round() } else { rate };
    f64::from(steps) / meant
}

/// The sum of the speeds of present agents that `is_counted` accepts, m/s, and how many these are.
pub fn speeds(store: &Store, is_counted: impl Fn(usize) -> bool) -> (f64, u32) {
    let agents = store.step.agent_count as usize;
    let there = (0..agents).filter(|agent| !is_absent(store.position[*agent]) && is_counted(*agent));
    there.fold((0.0, 0), |(sum, count), agent| {
        let [x, z] = store.velocity[agent].map(f64::from);
        (sum + libm::hypot(x, z), count + 1)
    })
}

/// Measures the agents of a store.
pub fn measures(store: &Store) -> Measures {
    let agents = store.step.agent_count as usize;
    let (min_clearance, overlapping_pairs) = pairs(&store.position[..agents], |i| store.body[i].radius);
    let present = store.position[..agents].iter().filter(|p| !is_absent(**p)).count();
    let (speeds, _) = speeds(store, |_| true);
    let entry = &store.entry[..agents.min(store.entry.len())];
    let sources = || store.sources.iter().take(store.step.source_count as usize);
    let outside = entry.iter().filter(|step| **step > 0).count();
    let entered = agents as u32 - outside as u32 + sources().map(|source| source.entered).sum::<u32>();
    let due = |source: &Source| {
        let all = source.first_agent as usize..(source.first_agent + source.agents) as usize;
        let late = all.skip(source.entered as usize).filter(|agent| entry[*agent] <= store.step.step_index);
        late.count() as u32
    };
    Measures {
        entered,
        left: entered - (present as u32).min(entered),
        waiting_outside: sources().map(due).sum(),
        never: entry.iter().filter(|step| **step == NEVER).count() as u32,
        present: present as u32,
        mean_speed: (speeds / present.max(1) as f64) as f32,
        min_clearance,
        overlapping_pairs,
        arrived: store.route[..agents].iter().map(|route| u64::from(route.arrivals)).sum(),
    }
}

/// Smallest gap and number of overlapping pairs, by sweeping along x.
fn pairs(position: &[[f32; 2]], radius: impl Fn(usize) -> f32) -> (f32, u32) {
    let reach = 2.0 * (0..position.len()).map(&radius).fold(0.0, f32::max);
    let mut order: Vec<u32> =
        (0..position.len() as u32).filter(|i| !is_absent(position[*i as usize])).collect();
    order.sort_unstable_by(|a, b| position[*a as usize][0].total_cmp(&position[*b as usize][0]));
    let (mut clearance, mut overlapping) = (f32::INFINITY, 0);
    for (at, &i) in order.iter().enumerate() {
        let (i, a) = (i as usize, position[i as usize]);
        for &j in &order[at + 1..] {
            let (j, b) = (j as usize, position[j as usize]);
            if b[0] - a[0] > reach.max(clearance + reach) || b[0] - a[0] > 4.0 * reach {
                break;
            }
            let apart = (b[1] - a[1]).abs();
            if apart > 4.0 * reach {
                continue;
            }
            let distance = libm::hypotf(b[0] - a[0], apart);
            let sum = radius(i) + radius(j);
            clearance = clearance.min(distance - sum);
            overlapping += u32::from(distance < OVERLAP * sum);
        }
    }
    (clearance, overlapping)
}

/// Agents that stand outside the walkable area: outside the bounds or inside an obstacle.
pub fn outside(store: &Store, walkable: impl Fn(Vec2) -> bool) -> u32 {
    let agents = store.step.agent_count as usize;
    let present = store.position[..agents].iter().filter(|p| !is_absent(**p));
    present.map(|p| u32::from(!walkable(Vec2::from_array(*p)))).sum()
}

/// A hash of everything a step carries on: equal on all machines where the crowds are equal, bit for bit.
pub fn state_hash(store: &Store) -> u64 {
    let agents = store.step.agent_count as usize;
    let mut hash = Hash::default();
    let mut add = |bytes: &[u8]| hash.add(bytes);
    add(bytemuck::cast_slice(&store.position[..agents]));
    add(bytemuck::cast_slice(&store.velocity[..agents]));
    // headings once lay where phases lie now, and the hashes of then still hold
    for (heading, stance) in store.heading.iter().zip(&store.stance).take(agents) {
        add(bytemuck::bytes_of(heading));
        add(&bytemuck::bytes_of(stance)[size_of_val(&stance.phase)..]);
    }
    store.stance.iter().take(agents).for_each(|stance| add(bytemuck::bytes_of(&stance.phase)));
    add(bytemuck::cast_slice(&store.route[..agents]));
    add(bytemuck::cast_slice(&store.waiting[..agents]));
    if store.step.floor_count > 0 {
        add(bytemuck::cast_slice(&store.elevation[..agents]));
    }
    let progress = &store.stage_progress[..agents.min(store.stage_progress.len())];
    if progress.iter().any(|word| *word > 0) {
        add(bytemuck::cast_slice(progress));
    }
    if store.step.queue_count > 0 {
        add(bytemuck::cast_slice(&store.queues));
    }
    if store.step.source_count > 0 {
        add(bytemuck::cast_slice(&store.sources));
    }
    if store.step.feels != 0 {
        add(bytemuck::cast_slice(&store.feeling[..agents]));
        add(bytemuck::cast_slice(&store.heard[..agents]));
        let shown: Vec<u32> = store.appearance[..agents].iter().map(Appearance::shown).collect();
        add(bytemuck::cast_slice(&shown));
    }
    hash.value()
}

/// Mean weights of happy, angry, sad and neutral over all present agents that walk by themselves, where feelings change.
pub fn mean_feeling(store: &Store) -> Option<[f32; 4]> {
    if store.step.feels == 0 {
        return None;
    }
    let (mut sums, mut count) = ([0.0_f64; 4], 0.0);
    let is_led = |agent| store.avoidance.get(agent).is_some_and(Avoidance::is_led);
    let agents = store.feeling.iter().zip(&store.position).take(store.step.agent_count as usize);
    for (agent, (feeling, position)) in agents.enumerate() {
        if !is_absent(*position) && !is_led(agent) {
            count += 1.0;
            for (sum, weight) in sums.iter_mut().zip(feeling) {
                *sum += f64::from(*weight);
            }
        }
    }
    (count > 0.0).then(|| sums.map(|sum| (sum / count) as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_equal_a_brute_force_count() {
        let unit = |i: u32| crate::reference::exact::unit_f32(crate::reference::exact::hash_u32(i));
        let position: Vec<[f32; 2]> = (0..400).map(|i| [unit(2 * i) * 9.0, unit(2 * i + 1) * 9.0]).collect();
        let (mut clearance, mut overlapping) = (f32::INFINITY, 0);
        for i in 0..position.len() {
            for j in 0..i {
                let (a, b) = (position[i], position[j]);
                let distance = libm::hypotf(a[0] - b[0], a[1] - b[1]);
                clearance = clearance.min(distance - 0.5);
                overlapping += u32::from(distance < 0.45);
            }
        }
        assert!(overlapping > 10);
        let found = pairs(&position, |_| 0.25);
        assert_eq!(found.1, overlapping);
        assert!((found.0 - clearance).abs() < 1e-6);
        assert_eq!(pairs(&[], |_| 0.25), (f32::INFINITY, 0));
    }
}

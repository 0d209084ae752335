//! Inputs for the kernels: plausible ones and the hard ones, from a seed.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "counts of cases are small"
)]

pub mod animation;
pub mod avatars;
pub mod between;
mod case;
pub mod crossing;
pub mod feelings;
pub mod flow;
pub mod gaits;
pub mod hidden;
pub mod journeys;
mod odd;
pub mod step;
pub(crate) mod uneven;

pub use case::Case;

use crate::kernels::{Dispatch, Phase, Store, probe};
use crate::sim::order;
use case::unit;

/// All cases of a size: steps, frames and what else there is, of every kind (seeds differ in kind). Above a thousand
/// agents there is one of each.
pub fn all(size: usize, seed: u32) -> Vec<Case> {
    let few = size > 1_000;
    let numbers = |count: u32| 0..if few { 1 } else { count };
    let mut cases = Vec::new();
    for number in numbers(3) {
        let seed = seed.wrapping_mul(8).wrapping_add(number);
        for model in order::MODELS.take(if number == 0 { usize::MAX } else { 1 }) {
            let store = step::crowd_with(model, size, seed);
            cases.push(Case::step(&format!("step of model {model}"), size, seed, store));
        }
        cases.push(Case::step("journeys", size, seed, journeys::journeys(size, seed)));
        cases.extend(odd::cases(size, seed));
        cases.extend(if number == 0 { uneven::cases(size, seed) } else { Vec::new() });
    }
    for number in numbers(8) {
        // the large case is of the tight kind, whose buffers are small
        let seed = seed.wrapping_mul(8).wrapping_add(if few { 1 } else { number });
        cases.push(Case::new("picture", size, seed, animation::animation(size, seed), animation::dispatches));
    }
    for number in numbers(5) {
        let seed = seed.wrapping_mul(8).wrapping_add(number);
        cases.push(Case::new("who is hidden", size, seed, hidden::hidden(size, seed), hidden::dispatches));
    }
    for number in numbers(2) {
        let seed = seed.wrapping_mul(8).wrapping_add(number);
        cases.push(Case::new("ways", size, seed, flow::fields(size, seed), flow::dispatches));
    }
    for number in numbers(3) {
        let seed = seed.wrapping_mul(3).wrapping_add(if few { 1 } else { number });
        cases.push(Case::step("feelings", size, seed, feelings::feelings(size, seed)));
    }
    for number in numbers(4) {
        let seed = seed.wrapping_mul(4).wrapping_add(number);
        cases.push(Case::new("two snapshots", size, seed, between::between(size, seed), between::dispatches));
    }
    // the large case is of the kind in which every gait is usable
    for seed in numbers(2) {
        cases.push(Case::new("features of gaits", size, seed, gaits::gaits(size, seed), gaits::dispatches));
    }
    cases
}

/// A crowd that has everything at once: journeys, groups, walls, floors, flow fields, sources, queues, agents led from
/// outside, feelings, and a crowd ahead that slows people down.
pub fn everything(agents: usize, seed: u32) -> Store {
    let mut store = journeys::journeys(agents, seed);
    store.step.crowding = 0.3 + 0.7 * unit(seed ^ 0x57e9_0000, 1, 0);
    feelings::add_feelings(&mut store, agents, seed);
    store
}

/// A step of that crowd.
pub fn crowd(agents: usize, seed: u32, model: u32) -> Case {
    let mut store = everything(agents, seed);
    store.step.model = model;
    Case::step(&format!("crowd of model {model}"), agents, seed, store)
}

/// Cases of the operations, and of the functions made of them, that `gaitway verify` tries.
pub const PROBED: usize = 65_536;

/// The operations themselves, without subnormal numbers: a device may flush those.
pub fn arithmetic(count: usize) -> Case {
    let cases = probe::cases(count).into_iter().filter(|(_, class)| *class == probe::Class::Normal);
    let numerics_in: Vec<_> = cases.map(|(case, _)| case).collect();
    let dispatches = vec![Dispatch::of(Phase::Arithmetic, numerics_in.len() as u32)];
    let arithmetic_out = vec![[0.0; 4]; numerics_in.len() * 3];
    let store = Store { numerics_in, arithmetic_out, ..Store::default() };
    Case { name: "arithmetic".to_owned(), store, dispatches }
}

/// The functions of `exact.wgsl`.
pub fn functions(count: usize) -> Case {
    let numerics_in = crate::reference::probe_cases(count as u32);
    let numerics_out = vec![[0.0; 4]; count * 2];
    let store = Store { numerics_in, numerics_out, ..Store::default() };
    Case {
        name: "functions".to_owned(),
        store,
        dispatches: vec![Dispatch::of(Phase::Numerics, count as u32)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::KernelId;
    use std::collections::BTreeSet;

    #[test]
    fn seeds_draw_steps_frames_joined_sides_and_radii() {
        let crowds: Vec<Store> = (8..16).map(|seed| journeys::journeys(65, seed)).collect();
        let different = |of: &dyn Fn(&Store) -> f32| {
            crowds.iter().map(|store| of(store).to_bits()).collect::<BTreeSet<_>>().len()
        };
        assert_eq!(different(&|store| store.step.time_step), 8);
        assert_eq!(different(&|store| store.step.grid_origin[0]), 8);
        assert_eq!(different(&|store| store.step.user_radius), 8);
        assert_eq!(different(&|store| store.step.wrap), 5, "half of them have none");
        assert_eq!(different(&|store| store.body[40].radius), 8);
        assert_eq!(different(&|store| store.stages[0].radius), 8, "a waypoint's radius");
        let frames: BTreeSet<_> =
            (8..16).map(|seed| animation::animation(1, seed).frame.frame_time.to_bits()).collect();
        assert_eq!(frames.len(), 8);
    }

    #[test]
    fn the_crowd_of_the_trajectory_has_everything() {
        let mut store = everything(2_000, 1);
        assert!(store.step.crowding > 0.0 && store.step.patience > 0.0);
        let dispatches = order::step_dispatches(&store.step);
        let reached: BTreeSet<KernelId> = dispatches.iter().map(Dispatch::kernel).collect();
        let wanted = [
            KernelId::FollowPaths,
            KernelId::LeadAgents,
            KernelId::Teleport,
            KernelId::AdvanceJourney,
            KernelId::Queue,
            KernelId::EmotionGather,
            KernelId::EmotionUpdate,
            KernelId::EmotionApply,
            KernelId::Spawn,
            KernelId::GroupCohesion,
            KernelId::Unjam,
            KernelId::ClipToWalls,
            KernelId::Elevate,
        ];
        assert!(wanted.iter().all(|kernel| reached.contains(kernel)), "{reached:?}");
        let (before, waiting) = (store.feeling.clone(), store.waiting.clone());
        for dispatch in &dispatches {
            crate::reference::run(dispatch.phase, &mut store, dispatch.immediate);
        }
        assert!(store.feeling != before && store.waiting != waiting);
        assert!(store.companions.iter().any(|others| others[0] != crate::kernels::shared::absent::NOBODY));
        assert!(
            store.route.iter().any(|route| route.next > 0)
                && store.sources.iter().any(|source| source.entered > 0)
        );
    }
}

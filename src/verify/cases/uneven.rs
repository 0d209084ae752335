//! Crowds like the crossing that are hard to find neighbours in: one that is dense in one place and thin elsewhere, and one on two
//! storeys.

use super::crossing::crossing;
use crate::kernels::Store;
use crate::reference::exact::{hash_u32, unit_f32};
use crate::sim::order;

/// Metres between the agents of a clustered crowd, were it even: one to two square metres.
const SPACING: f32 = std::f32::consts::SQRT_2;
/// Side of the square in which half of them stand, over that of the whole: an eighth of the area.
const DENSE: f32 = 0.353_553_4;
/// Metres between neighbours of two storeys together; on each there is one to a square metre.
const STOREYS_SPACING: f32 = std::f32::consts::FRAC_1_SQRT_2;
/// Metres between the storeys.
const STOREY: f32 = 3.0;

/// The crossing with half of the people within the eighth of the area in its middle, two to a square metre. The others have
/// the rest. Cells are sized by the mean density.
pub(crate) fn clustered(agents: usize) -> Store {
    let mut store = crossing(agents, SPACING);
    let side = store.step.wrap;
    let dense = lattice(agents.div_ceil(2), side * DENSE, |_| true);
    let middle = 0.5 * side;
    let is_outside = |at: [f32; 2]| at.iter().any(|along| (along - middle).abs() > 0.5 * DENSE * side);
    let thin = lattice(agents / 2, side, is_outside);
    let columns = (side / SPACING).round() as usize;
    for position in &mut store.position[..agents] {
        // the crossing has each of the numbers from 0 on once, in arbitrary order
        let [column, row] = position.map(|along| (along / SPACING) as usize);
        let number = row * columns + column;
        *position = if number.is_multiple_of(2) {
            dense[number / 2].map(|along| along + 0.5 * (1.0 - DENSE) * side)
        } else {
            thin[number / 2]
        };
    }
    store
}

/// So many places over a square from 0 to `side` where `is_in`, about evenly, none exactly.
fn lattice(count: usize, side: f32, is_in: impl Fn([f32; 2]) -> bool) -> Vec<[f32; 2]> {
    let mut columns = (count as f32).sqrt().ceil().max(1.0) as usize;
    loop {
        let spacing = side / columns as f32;
        let jitter = 0.2 * spacing;
        let place = |cell: usize| {
            let draw = |lane: u32| jitter * (unit_f32(hash_u32(3 * cell as u32 + lane)) - 0.5);
            let at = [cell % columns, cell / columns].map(|along| spacing * (along as f32 + 0.5));
            [at[0] + draw(1), at[1] + draw(2)]
        };
        let places: Vec<[f32; 2]> = (0..columns * columns).map(place).filter(|at| is_in(*at)).collect();
        if places.len() >= count {
            return (0..count).map(|number| places[number * places.len() / count]).collect();
        }
        columns += 1;
    }
}

/// Two crossings above one another. Cells are sized as if all people stood on one plane.
pub(crate) fn storeys(agents: usize) -> Store {
    let mut store = crossing(agents, STOREYS_SPACING);
    store.step.storey_height = 2.0;
    for (position, elevation) in store.position.iter().zip(&mut store.elevation) {
        let [column, row] = position.map(|along| (along / STOREYS_SPACING) as u32);
        *elevation = if (column + row).is_multiple_of(2) { 0.0 } else { STOREY };
    }
    store
}

/// Steps of both, once around ORCA and once around RVO.
pub(super) fn cases(size: usize, seed: u32) -> Vec<super::Case> {
    if size == 0 {
        return Vec::new(); // a grid has a cell
    }
    let of = |name: &str, store: Store| {
        let with = |model: u32| {
            let mut store = store.clone();
            store.step.model = model;
            super::Case::step(&format!("{name} crowd of model {model}"), size, seed, store)
        };
        order::MODELS.map(with).collect::<Vec<_>>()
    };
    [of("clustered", clustered(size)), of("storeys", storeys(size))].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::{Backend, Simulation, measure};

    #[test]
    fn half_of_a_clustered_crowd_is_within_an_eighth_of_the_area() {
        for agents in [1_000, 10_000] {
            let store = clustered(agents);
            let side = store.step.wrap;
            let (low, high) = (0.5 * side * (1.0 - DENSE), 0.5 * side * (1.0 + DENSE));
            let is_dense = |at: &&[f32; 2]| at.iter().all(|along| (low..=high).contains(along));
            let dense = store.position[..agents].iter().filter(is_dense).count();
            assert_eq!(dense, agents / 2);
            let inside = |at: &[f32; 2]| at.iter().all(|along| (0.0..side).contains(along));
            assert!(store.position[..agents].iter().all(inside));
        }
    }

    #[test]
    fn lanes_and_twins_agree_about_both_crowds() {
        for (name, crowd) in [("clustered", clustered as fn(usize) -> Store), ("storeys", storeys)] {
            let hash = |backend| {
                let mut simulation = Simulation::from_store(crowd(3_000), backend, None).unwrap();
                simulation.step(40).unwrap();
                measure::state_hash(simulation.state().unwrap())
            };
            assert_eq!(hash(Backend::Cpu), hash(Backend::Reference), "{name}");
        }
    }
}

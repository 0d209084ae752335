//! Crowds like the crossing that are hard to find neighbours in: one that is dense in one place and thin elsewhere, one on two
//! storeys, and one in a strip a few cells wide.

use super::crossing::crossing;
use crate::kernels::Store;
use crate::kernels::shared::absent::ABSENT;
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

/// A crowd in a strip so few cells wide that what lies behind the end of a row of cells is near as well. Every ninth is absent. Empty
/// slots hold a place beside the last person, as after another step.
fn strip(agents: usize, columns: u32) -> Store {
    let mut store = crossing(agents, 1.0);
    let width = columns as f32 * store.step.cell_size;
    let length = agents as f32 / width;
    store.step.wrap = 0.0;
    store.step.grid_columns = columns;
    store.step.grid_rows = (length / store.step.cell_size).ceil() as u32;
    store.step.cell_count = columns * store.step.grid_rows;
    for (position, number) in store.position.iter_mut().zip(0..) {
        let draw = |lane: u32| unit_f32(hash_u32(2 * number + lane));
        *position = if number % 9 == 8 { [ABSENT; 2] } else { [width * draw(0), length * draw(1)] };
    }
    super::step::scratch(&mut store, agents);
    let end = [0.5 * width, length - 0.3];
    store.slot_position.fill(end);
    store
}

/// Columns of the strips.
const STRIPS: [u32; 4] = [1, 2, 4, 5];

/// Steps of all, once around ORCA and once around RVO.
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
    let strips = STRIPS.map(|columns| of(&format!("{columns} cells wide"), strip(size, columns)));
    [of("clustered", clustered(size)), of("storeys", storeys(size)), strips.concat()].concat()
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
    fn lanes_and_twins_agree_about_all_crowds() {
        let strips = STRIPS.map(|columns| ("strip", strip(3_000, columns)));
        let crowds = [("clustered", clustered(3_000)), ("storeys", storeys(3_000))];
        for (name, crowd) in crowds.into_iter().chain(strips) {
            let hash = |backend| {
                let mut simulation = Simulation::from_store(crowd.clone(), backend, None).unwrap();
                simulation.step(40).unwrap();
                measure::state_hash(simulation.state().unwrap())
            };
            assert_eq!(hash(Backend::Cpu), hash(Backend::Reference), "{name} of {:?}", crowd.step);
        }
    }
}

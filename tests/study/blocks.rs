//! Blocks: every count that the design states.

use gaitway::study::plan::blocks::{Blocks, Cell};
use gaitway::study::plan::square::Square;
use gaitway::study::plan::{Ledger, Role, Rows, Trial};
use std::collections::BTreeMap;

/// How often each key comes.
fn count<K: Ord>(keys: impl IntoIterator<Item = K>) -> BTreeMap<K, usize> {
    let mut counts = BTreeMap::new();
    keys.into_iter().for_each(|key| *counts.entry(key).or_insert(0) += 1);
    counts
}

fn all_are<K: Ord + std::fmt::Debug>(counts: &BTreeMap<K, usize>, keys: usize, times: usize) {
    assert_eq!(counts.len(), keys, "{counts:?}");
    assert!(counts.values().all(|&found| found == times), "{counts:?}");
}

fn orders(cells: &[Cell]) -> Vec<(usize, Vec<usize>)> {
    cells.chunks(3).map(|block| (block[0].scene, block.iter().map(|cell| cell.condition).collect())).collect()
}

#[test]
fn over_the_24_rows_everything_is_balanced_as_designed() {
    let blocks = Blocks::new(4, 3);
    assert_eq!(blocks.rows(), 24);
    let rows: Vec<Vec<Cell>> = (0..24).map(|row| blocks.cells(row)).collect();
    let trials = || rows.iter().flat_map(|row| row.iter().enumerate());
    let scenes = || rows.iter().map(|row| row.chunks(3).map(|block| block[0].scene).collect::<Vec<_>>());
    // scene at position: 6; scene after scene: 6
    all_are(&count(scenes().flat_map(|row| row.into_iter().enumerate().collect::<Vec<_>>())), 16, 6);
    let pairs = scenes().flat_map(|row| row.windows(2).map(|pair| (pair[0], pair[1])).collect::<Vec<_>>());
    all_are(&count(pairs), 12, 6);
    // (scene, order): 4
    all_are(&count(rows.iter().flat_map(|row| orders(row))), 24, 4);
    // (scene, condition, place in the block): 8; (trial, condition): 8
    all_are(&count(trials().map(|(at, cell)| (cell.scene, cell.condition, at % 3))), 36, 8);
    all_are(&count(trials().map(|(at, cell)| (at, cell.condition))), 36, 8);
    // condition after condition across blocks: 8
    let across =
        rows.iter().flat_map(|row| [2, 5, 8].map(|last| (row[last].condition, row[last + 1].condition)));
    all_are(&count(across), 9, 8);
    // four different orders each, and every trial of a block in its block
    for row in &rows {
        let own = count(orders(row).into_iter().map(|(_, order)| order));
        all_are(&own, 4, 1);
        assert!(
            row.iter()
                .enumerate()
                .all(|(at, cell)| cell.block == at / 3 && cell.scene == row[at / 3 * 3].scene)
        );
        all_are(&count(row.iter().map(|cell| (cell.scene, cell.condition))), 12, 1);
    }
    assert_eq!(blocks.cells(24), []);
}

#[test]
fn the_four_participants_of_a_sub_block_differ_in_scenes_and_in_orders() {
    let blocks = Blocks::new(4, 3);
    for cycle in 0..20 {
        for four in blocks.cycle(5, cycle).chunks(4) {
            all_are(&count(four.iter().map(|row| row / 6)), 4, 1);
            all_are(&count(four.iter().map(|row| row % 6)), 4, 1);
        }
    }
}

#[test]
fn any_prefix_of_participants_is_balanced_as_far_as_it_can_be() {
    for (scenes, conditions) in [(4, 3), (3, 3), (4, 2), (2, 2), (5, 4)] {
        let blocks = Blocks::new(scenes, conditions);
        for seed in 0..20 {
            let mut rows = Rows::new(blocks.rows());
            let orders = blocks.rows() / blocks.scene_rows();
            let mut of_scene = vec![0_u32; blocks.scene_rows()];
            for place in 1..=2 * blocks.rows() {
                let row = rows.admit(None, |cycle| blocks.cycle(seed, cycle)).unwrap();
                of_scene[row / orders] += 1;
                assert!(rows.gap() <= 1);
                let (least, most) = (of_scene.iter().min().unwrap(), of_scene.iter().max().unwrap());
                assert!(most - least <= 1, "{place}: {of_scene:?}");
                if place % blocks.scene_rows() == 0 {
                    assert_eq!(least, most, "{place}");
                }
                if place % blocks.rows() == 0 {
                    assert_eq!(rows.gap(), 0);
                }
            }
        }
        assert_ne!(blocks.cycle(1, 0), blocks.cycle(2, 0));
        assert_ne!(blocks.cycle(1, 0), blocks.cycle(1, 1));
    }
}

#[test]
fn other_numbers_of_scenes_and_conditions_are_balanced_within_scenes() {
    for scenes in 2..=6 {
        for conditions in 2..=5 {
            let blocks = Blocks::new(scenes, conditions);
            let rows: Vec<Vec<Cell>> = (0..blocks.rows()).map(|row| blocks.cells(row)).collect();
            let cells = || rows.iter().flatten().enumerate();
            let trials = scenes * conditions;
            let places = count(cells().map(|(at, c)| (c.scene, c.condition, at % conditions)));
            all_are(&places, trials * conditions, rows.len() / conditions);
            let at = count(cells().map(|(at, c)| (at % trials / conditions, c.scene)));
            all_are(&at, scenes * scenes, rows.len() * conditions / scenes);
        }
    }
}

#[test]
fn a_lapsed_row_is_handed_out_next() {
    let blocks = Blocks::new(4, 3);
    let mut rows = Rows::new(24);
    let order = |cycle| blocks.cycle(7, cycle);
    let given: Vec<usize> = (0..24).map(|_| rows.admit(None, order).unwrap()).collect();
    assert_eq!(given, blocks.cycle(7, 0));
    rows.lapse(given[5]);
    rows.finish(given[6]);
    assert_eq!(rows.admit(None, order), Some(given[5]));
    assert_eq!(rows.admit(None, order), Some(blocks.cycle(7, 1)[0]));
    let square = Square::new(8);
    let mut rows = Rows::new(square.rows());
    let places: Vec<usize> = (0..20).map(|_| rows.admit(None, |_| square.cycle()).unwrap()).collect();
    assert_eq!(places, (0..20).map(|place| place % 8).collect::<Vec<_>>());
}

#[test]
fn the_agents_study_hands_out_trials_of_both_designs() {
    let plan = super::plan("eva-agents", 0);
    let mut ledger = Ledger::new(&plan);
    let places: Vec<Vec<Trial>> = (0..24).map(|person| ledger.place(&plan, person).unwrap().trials).collect();
    for (place, trials) in places.iter().enumerate() {
        let (scenes, agents): (Vec<&Trial>, Vec<&Trial>) = trials.iter().partition(|t| t.part == "scenes");
        assert_eq!((scenes.len(), agents.len()), (12, 8));
        assert!(trials.iter().all(|trial| trial.role == Role::Ordinary && trial.seed < 1 << 63));
        // the people of a block are the same, those of another block are not
        for block in scenes.chunks(3) {
            assert!(block.iter().all(|trial| trial.seed == block[0].seed && trial.block == block[0].block));
        }
        assert_eq!(count(scenes.iter().map(|trial| trial.seed)).len(), 4);
        assert!(agents.iter().all(|trial| trial.row == Some(place as u32 % 8)));
        assert_eq!(count(agents.iter().map(|trial| trial.item)).len(), 8);
    }
    let rows = count(places.iter().map(|trials| trials[0].row));
    all_are(&rows, 24, 1);
    // clips are made before the study: few seeds a scene
    let seeds = count(places.iter().flatten().filter(|t| t.part == "scenes").map(|t| t.seed));
    assert_eq!(seeds.len(), 4 * 3);
}

#[test]
fn lapses_and_returns_keep_rows_as_near_as_the_lemma_says() {
    for seed in 0..3000_u64 {
        let mut state = seed;
        let mut below = |end: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % end.max(1)
        };
        let blocks = Blocks::new(2 + below(3), 2 + below(2));
        let mut rows = Rows::new(blocks.rows());
        let (mut leased, mut lapsed, mut finished) = (Vec::new(), Vec::new(), 0);
        let (mut lost, mut late) = (vec![0; blocks.rows()], 0);
        for _ in 0..120 {
            match below(6) {
                0..=2 => leased.push(rows.admit(None, |cycle| blocks.cycle(seed, cycle)).unwrap()),
                3 if !leased.is_empty() => {
                    rows.finish(leased.swap_remove(below(leased.len())));
                    finished += 1;
                }
                4 if !leased.is_empty() => {
                    let row = leased.swap_remove(below(leased.len()));
                    rows.lapse(row);
                    lost[row] += 1;
                    lapsed.push(row);
                }
                5 if !lapsed.is_empty() => {
                    let row = lapsed.swap_remove(below(lapsed.len()));
                    rows.lease_again(row);
                    late += 1;
                    leased.push(row);
                }
                _ => {}
            }
            let counts = rows.counts();
            assert_eq!(counts.iter().sum::<u32>() as usize, leased.len() + finished);
            let most = counts.iter().max().unwrap();
            assert!(
                counts.iter().zip(&lost).all(|(count, lost)| *most <= 1 + late + count + lost),
                "{counts:?}"
            );
            if rows.gap() <= 1 {
                lost.fill(0);
                late = 0;
            }
        }
    }
}

//! Blocks: scenes by Williams squares, conditions within each scene.
//!
//! Four scenes and three conditions, as in the paper: scenes by the rows W of Williams; the six orders of three conditions in
//! lexical order O = 012, 021, 102, 120, 201, 210; block b of row (s, k) shows scene W\[s\]\[b\] with order O\[τ(b, k)\], τ(0) = 012345,
//! τ(1) = 431502, τ(2) = 504123, τ(3) = 253014. Over the 24 rows: scene at position 6 times each, scene after scene 6, (scene, order) 4,
//! (scene, condition, place in the block) 8, (trial 1 to 12, condition) 8, condition after condition across blocks 8. Every row has
//! four different orders.
//!
//! Other numbers: block b of row (s, k) has row (k + b) mod K of the Williams square of the conditions, of K rows. Scenes, places
//! and (scene, order) stay balanced; condition after condition across blocks need not be.
//!
//! Rows are handed out in sub-blocks {(s, (j+s) mod K)}, j shuffled, s shuffled within each. After as many participants as there
//! are scene rows each scene row was used once, after all rows each row once.

use super::draw::{Purpose, random};
use super::williams;

/// The orders of three conditions, in lexical order.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
/// Which order block b of row (s, k) has: τ(b, k).
const TAU: [[usize; 6]; 4] = [[0, 1, 2, 3, 4, 5], [4, 3, 1, 5, 0, 2], [5, 0, 4, 1, 2, 3], [2, 5, 3, 0, 1, 4]];

/// A trial of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell {
    /// The block, from 0.
    pub block: usize,
    /// Index of the scene.
    pub scene: usize,
    /// Index of the condition.
    pub condition: usize,
}

/// The design of some scenes under some conditions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Blocks {
    scenes: Vec<Vec<usize>>,
    orders: Vec<Vec<usize>>,
    is_papers: bool,
}

impl Blocks {
    /// A design for numbers of scenes and conditions, each within [`williams::SIZES`].
    pub fn new(scenes: usize, conditions: usize) -> Self {
        let is_papers = (scenes, conditions) == (4, 3);
        let orders = if is_papers {
            ORDERS.iter().map(|order| order.to_vec()).collect()
        } else {
            williams::rows(conditions)
        };
        Self { scenes: williams::rows(scenes), orders, is_papers }
    }

    /// Number of rows: balance needs a multiple of it.
    pub fn rows(&self) -> usize {
        self.scenes.len() * self.orders.len()
    }

    /// Number of scene rows: after each so many participants each of them was used once.
    pub fn scene_rows(&self) -> usize {
        self.scenes.len()
    }

    /// Whether conditions are balanced across blocks, too, as they are for four scenes and three conditions.
    pub const fn balances_across_blocks(&self) -> bool {
        self.is_papers
    }

    /// The order of conditions in a block of row (s, k), as an index of the orders.
    fn order(&self, block: usize, k: usize) -> usize {
        if self.is_papers { TAU[block][k] } else { (k + block) % self.orders.len() }
    }

    /// The trials of a row in order; rows count s first: row = s K + k. Empty for a row that is not there.
    pub fn cells(&self, row: usize) -> Vec<Cell> {
        let (s, k) = (row / self.orders.len().max(1), row % self.orders.len().max(1));
        let Some(scenes) = self.scenes.get(s) else { return Vec::new() };
        let block = |(block, &scene): (usize, &usize)| {
            let order = &self.orders[self.order(block, k)];
            order.iter().map(move |&condition| Cell { block, scene, condition })
        };
        scenes.iter().enumerate().flat_map(block).collect()
    }

    /// The order in which the rows of a cycle are handed out.
    pub fn cycle(&self, seed: u64, cycle: u32) -> Vec<usize> {
        let (scenes, orders) = (self.scenes.len(), self.orders.len());
        let mut random = random(seed, Purpose::Rows, &[u64::from(cycle)]);
        let mut blocks: Vec<usize> = (0..orders).collect();
        random.shuffle(&mut blocks);
        let mut rows = Vec::with_capacity(self.rows());
        for j in blocks {
            let mut order: Vec<usize> = (0..scenes).collect();
            random.shuffle(&mut order);
            rows.extend(order.into_iter().map(|s| s * orders + (j + s) % orders));
        }
        rows
    }
}

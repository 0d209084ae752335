//! What goes between an operator and the headset of one lab: orders one way, what is seen and said the other.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Lines that are kept.
const MOST_LINES: usize = 12;

/// What an operator wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// The current trial again, from its beginning.
    Repeat,
    /// The current trial is left out.
    Skip,
    /// What is shown is cut, and the store is asked for the page: the operator has paused, resumed or excluded.
    Look,
    /// The session ends: everything is grey from the next frame on. The participation can go on later.
    End,
}

/// What goes between an operator and a headset. Both hold it and neither waits for the other.
#[derive(Debug, Default)]
pub struct Lab {
    /// The code of the participant in the headset.
    pub participant: String,
    table: Mutex<Table>,
}

#[derive(Debug, Default)]
struct Table {
    orders: VecDeque<Order>,
    lines: VecDeque<String>,
    eye: Option<Arc<[u8]>>,
    pictures: u64,
}

impl Lab {
    /// A lab with the participant of a code.
    pub fn new(participant: &str) -> Self {
        Self { participant: participant.to_owned(), table: Mutex::default() }
    }

    fn table(&self) -> MutexGuard<'_, Table> {
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes an order of the operator.
    pub fn order(&self, order: Order) {
        self.table().orders.push_back(order);
    }

    /// The next order; given once.
    pub fn next_order(&self) -> Option<Order> {
        self.table().orders.pop_front()
    }

    /// Takes a line for the operator to read; the newest are kept.
    pub fn note(&self, line: &str) {
        let mut table = self.table();
        table.lines.push_back(line.to_owned());
        let more = table.lines.len().saturating_sub(MOST_LINES);
        table.lines.drain(..more);
    }

    /// The newest lines, oldest first.
    pub fn lines(&self) -> Vec<String> {
        self.table().lines.iter().cloned().collect()
    }

    /// Takes what the left eye sees, as PNG.
    pub fn show(&self, png: Vec<u8>) {
        let mut table = self.table();
        (table.eye, table.pictures) = (Some(png.into()), table.pictures + 1);
    }

    /// What the left eye saw last, as PNG, and how many pictures there were.
    pub fn eye(&self) -> Option<(u64, Arc<[u8]>)> {
        let table = self.table();
        table.eye.clone().map(|png| (table.pictures, png))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_given_once_and_the_newest_lines_and_picture_stay() {
        let lab = Lab::default();
        assert_eq!((lab.next_order(), lab.eye().is_none()), (None, true));
        lab.order(Order::Skip);
        lab.order(Order::End);
        assert_eq!(
            [lab.next_order(), lab.next_order(), lab.next_order()],
            [Some(Order::Skip), Some(Order::End), None]
        );
        (0..20).for_each(|line| lab.note(&line.to_string()));
        assert_eq!((lab.lines().len(), lab.lines()[0].as_str(), lab.lines()[11].as_str()), (12, "8", "19"));
        lab.show(vec![1]);
        lab.show(vec![2, 3]);
        assert_eq!(lab.eye().map(|(number, png)| (number, png.to_vec())), Some((2, vec![2, 3])));
    }
}

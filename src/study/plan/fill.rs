//! Fill: every item gets the same number of answers, whatever participants do.
//!
//! Item i has c(i) = answered + leased. A new participant gets the m items of least c, ties by a keyed hash of seed, participant
//! and item, in a random order. A lease turns into an answer or lapses.
//!
//! *Lemma 1.* Without lapses max c - min c <= 1 for ever. If all c are t or t+1 and at least m are t, only those rise. Else all
//! t rise to t+1 and some t+1 to t+2, so that all are t+1 or t+2.
//!
//! *Lemma 2.* Let d(i) be the leases of i that lapsed since max c - min c was last at most 1. Without late answers
//! max c <= 1 + c(i) + d(i) for every i, so that the gap is at most 1 + max d. Proof: a lapse leaves c(i) + d(i) as it is and max c no
//! greater. An admission raises max c from M to M+1 only if it takes an item at M. The items that it leaves are then at M or above,
//! and those that it takes had c(i) + d(i) >= M-1, which is M afterwards. Late answers, returning participants and
//! replaced stimuli raise max c by one at most, so that w of them give max c <= 1 + w + c(i) + d(i).
//!
//! *Lemma 3.* Admission is closed while min c >= `at_least`. If it is closed and nothing is leased, every item has at least
//! `at_least` answers, since then c = answered. A lapse below `at_least` opens it again.

use super::draw::{Purpose, random};

/// Counts of one part's items.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fill {
    seed: u64,
    each: usize,
    at_least: u32,
    answered: Vec<u32>,
    leased: Vec<u32>,
}

impl Fill {
    /// `items` items without answers, of which a participant gets `each` (all, if there are fewer), until each has `at_least`
    /// answers. `seed` keys ties and orders.
    pub fn new(seed: u64, items: usize, each: usize, at_least: u32) -> Self {
        let none = vec![0; items];
        Self { seed, each: each.min(items), at_least, answered: none.clone(), leased: none }
    }

    /// Answered and leased together, by item.
    pub fn counts(&self) -> Vec<u32> {
        self.answered.iter().zip(&self.leased).map(|(a, b)| a + b).collect()
    }

    /// Answers, by item.
    pub fn answered(&self) -> &[u32] {
        &self.answered
    }

    /// Leases under way, by item.
    pub fn leased(&self) -> &[u32] {
        &self.leased
    }

    /// Greatest count minus least count; 0 without items.
    pub fn gap(&self) -> u32 {
        let counts = self.counts();
        counts.iter().max().unwrap_or(&0) - counts.iter().min().unwrap_or(&0)
    }

    /// Whether some item lacks answers that no participant is about to give.
    pub fn is_open(&self) -> bool {
        self.counts().iter().any(|&count| count < self.at_least)
    }

    /// How many participants close admission if no lease lapses any more.
    pub fn needs(&self) -> usize {
        let lacks =
            || self.answered.iter().zip(&self.leased).map(|(a, b)| self.at_least.saturating_sub(a + b));
        let sum: usize = lacks().map(|lack| lack as usize).sum();
        // an item goes to a participant once
        sum.div_ceil(self.each.max(1)).max(lacks().max().unwrap_or(0) as usize)
    }

    /// Leases for a new participant, in the order of their trials; none while admission is closed.
    pub fn admit(&mut self, person: u64) -> Option<Vec<usize>> {
        if !self.is_open() {
            return None;
        }
        let mut items = self.least(person, &[]);
        items.truncate(self.each);
        items.iter().for_each(|&item| self.leased[item] += 1);
        random(self.seed, Purpose::Order, &[person]).shuffle(&mut items);
        Some(items)
    }

    /// All items but those in `without`, least count first.
    fn least(&self, person: u64, without: &[usize]) -> Vec<usize> {
        let tie = |item: usize| random(self.seed, Purpose::Ties, &[person, item as u64]).bits();
        let counts = self.counts();
        let mut order: Vec<(u32, u64, usize)> = counts
            .iter()
            .enumerate()
            .filter(|(item, _)| !without.contains(item))
            .map(|(item, &count)| (count, tie(item), item))
            .collect();
        order.sort_unstable();
        order.into_iter().map(|(.., item)| item).collect()
    }

    /// A lease as a store has it, or of a stimulus that was seen.
    pub fn lease(&mut self, item: usize) {
        self.leased[item] += 1;
    }

    /// A lease turns into an answer.
    pub fn answer(&mut self, item: usize) {
        self.leased[item] = self.leased[item].saturating_sub(1);
        self.answered[item] += 1;
    }

    /// A lease lapses.
    pub fn lapse(&mut self, item: usize) {
        self.leased[item] = self.leased[item].saturating_sub(1);
    }

    /// An answer whose lease had lapsed: it is kept.
    pub fn answer_late(&mut self, item: usize) {
        self.answered[item] += 1;
    }

    /// An answer is deleted, since its participant withdrew.
    pub fn delete(&mut self, item: usize) {
        self.answered[item] = self.answered[item].saturating_sub(1);
    }

    /// A participant whose lease of `item` lapsed is back. The item is leased again while it lacks answers more than others,
    /// or else the item that lacks most of those that the participant does not have (`own`). Returns what is leased.
    pub fn lease_again(&mut self, person: u64, item: usize, own: &[usize]) -> usize {
        let counts = self.counts();
        let is_free = counts.iter().any(|&count| count > counts[item]) || self.gap() == 0;
        let other = self.least(person, own).first().copied();
        let taken = other.filter(|&other| !is_free && counts[other] < counts[item]).unwrap_or(item);
        self.leased[taken] += 1;
        taken
    }

    /// Leases the item that lacks most of those that the participant does not have (`own`), in place of `item`, which cannot be
    /// shown. None if the participant has all items: the lease is given up then.
    pub fn replace(&mut self, person: u64, item: usize, own: &[usize]) -> Option<usize> {
        self.lapse(item);
        let taken = self.least(person, own).first().copied()?;
        self.leased[taken] += 1;
        Some(taken)
    }
}

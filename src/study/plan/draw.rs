//! Draws of a plan: pure functions of the study's seed and of what is drawn for.

use crate::hash::Hash;
use crate::random::Random;

/// What a draw is for. Each purpose is its own stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub(crate) enum Purpose {
    /// Ties between items of the same count.
    Ties = 1,
    /// Order of a participant's trials.
    Order = 2,
    /// Order of rows within a cycle.
    Rows = 3,
    /// Seeds of trials.
    Trial = 4,
    /// Repeated and instructed trials.
    Extra = 5,
    /// Order of statements and options.
    Items = 6,
    /// Names of stimuli.
    Names = 7,
}

/// The generator of a draw.
pub(crate) fn random(seed: u64, purpose: Purpose, of: &[u64]) -> Random {
    let mut state = seed;
    for &word in [purpose as u64].iter().chain(of) {
        // one round of the generator between two words: no two lists of words meet by chance of their sums
        state = Random::new(state ^ word).bits();
    }
    Random::new(state)
}

/// A word that stands for a text in [`random`].
pub(crate) fn word(text: &str) -> u64 {
    let mut hash = Hash::default();
    hash.add_text(text);
    hash.value()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_have_these_values_for_ever_and_differ_by_seed_purpose_and_word() {
        let first = |seed, purpose, of: &[u64]| random(seed, purpose, of).bits();
        assert_eq!(first(7, Purpose::Ties, &[1, 2]), first(7, Purpose::Ties, &[1, 2]));
        let all = [
            first(7, Purpose::Ties, &[1, 2]),
            first(8, Purpose::Ties, &[1, 2]),
            first(7, Purpose::Order, &[1, 2]),
            first(7, Purpose::Ties, &[2, 1]),
            first(7, Purpose::Ties, &[1]),
        ];
        for (at, one) in all.iter().enumerate() {
            assert!(!all[..at].contains(one), "{all:?}");
        }
        assert_ne!(word("a"), word("b"));
    }
}

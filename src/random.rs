//! The host's draws that enter no crowd's hash: the folds of an evaluation, the order of videos for raters, what a statistic
//! draws again. A crowd's own draws are `scenario::random`, hashes of what is drawn for.

use rand::{Rng as _, TryRng};
use std::convert::Infallible;

/// `SplitMix64` (Steele, Lea, Flood 2014): the same numbers everywhere and in every version. It is a generator of the crate
/// `rand`, whose distributions draw from it.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl TryRng for Random {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        let [upper, _] = halves(self.next_u64());
        Ok(upper)
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Ok(z ^ (z >> 31))
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for part in bytes.chunks_mut(8) {
            part.copy_from_slice(&self.next_u64().to_le_bytes()[..part.len()]);
        }
        Ok(())
    }
}

/// The upper and the lower 32 bits.
#[allow(clippy::cast_possible_truncation, reason = "each half fits")]
const fn halves(bits: u64) -> [u32; 2] {
    [(bits >> 32) as u32, bits as u32]
}

impl Random {
    /// The numbers of a seed.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.next_u64()
    }

    /// The next number in [0, 1), 53 bits.
    #[allow(clippy::cast_precision_loss, reason = "53 bits are exact in an f64")]
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The next number below `end`; 0 if `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        // the upper half of a product with a number below 2^64 is below `end`
        usize::try_from((u128::from(self.bits()) * end as u128) >> 64).unwrap_or(0)
    }

    /// Puts items into a random order.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt as _;

    #[test]
    fn random_numbers_are_those_published_for_seed_0() {
        let mut random = Random::new(0);
        assert_eq!([random.bits(), random.bits()], [0xe220_a839_7b1d_cdaf, 0x6e78_9e6a_a1b9_65f4]);
        assert!((0..1000).all(|_| random.below(7) < 7 && (0.0..1.0).contains(&random.unit())));
    }

    #[test]
    fn distributions_of_rand_draw_from_it() {
        let mut random = Random::new(0);
        assert!((0..1000).all(|_| (3..9).contains(&random.random_range(3..9))));
        let mut bytes = [0; 11];
        Random::new(0).fill_bytes(&mut bytes);
        assert_eq!(bytes[..8], 0xe220_a839_7b1d_cdaf_u64.to_le_bytes());
    }
}

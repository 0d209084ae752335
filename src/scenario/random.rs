//! Counter-based random numbers: a draw is a pure function of (seed, agent, purpose, count).
//!
//! No generator is carried along, so agent 17 looks and walks the same whether it is populated first, last, on
//! another thread or on another machine. Only 32-bit integer operations, so a shader can state it too.
//!
//! Algorithm. `mix` is the xor-shift-multiply finaliser with shifts 16, 15, 16 and odd factors `0x7feb352d`,
//! `0x846ca68b` (a bijection of u32; constants from Chris Wellons' search for low bias). The five words seed low,
//! seed high, agent, purpose, draw are absorbed one after another: `h = mix((h ^ word) + 0x9e3779b9)`, h = 0 first.

/// What a draw is for. Each purpose is its own stream: adding one never changes another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Purpose {
    /// Route, lane and place at the start.
    Start = 1,
    /// Desired emotion.
    Emotion = 2,
    /// Gait out of GEA(e), one draw per emotion.
    Gait = 3,
    /// Phase of the walk cycle.
    Phase = 4,
    /// Avatar.
    Avatar = 5,
    /// Size of the body.
    Scale = 6,
    /// Colours of skin, hair and clothes.
    Colors = 7,
    /// Pairing and trimming of lanes (the agent is the route).
    Lane = 8,
    /// Looks of the environment (the agent is the object).
    Scenery = 9,
    /// Speed that an agent prefers.
    Speed = 10,
    /// Valence and arousal.
    Affect = 11,
    /// Size of a group (the agent is its first member).
    Group = 12,
    /// Class, and the numbers of a class.
    Person = 13,
    /// Journey, and the way through it.
    Journey = 20,
    /// How an agent shows, catches and amplifies feelings.
    Temperament = 21,
    /// Stature, weight and shape of the body.
    Build = 22,
    /// What is worn.
    Clothes = 23,
}

/// The bijection of u32 under every draw.
const fn mix(mut h: u32) -> u32 {
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb_352d);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846c_a68b);
    h ^ (h >> 16)
}

/// One random word, uniform over u32.
#[allow(clippy::cast_possible_truncation, reason = "takes the two halves of the seed")]
pub const fn bits(seed: u64, agent: u32, purpose: Purpose, draw: u32) -> u32 {
    let words = [seed as u32, (seed >> 32) as u32, agent, purpose as u32, draw];
    let mut h = 0_u32;
    let mut i = 0;
    while i < words.len() {
        h = mix((h ^ words[i]).wrapping_add(0x9e37_79b9));
        i += 1;
    }
    h
}

/// A number in [0, 1): the top 24 bits of [`bits`], exact in f32.
pub fn unit(seed: u64, agent: u32, purpose: Purpose, draw: u32) -> f32 {
    fraction(bits(seed, agent, purpose, draw))
}

/// The top 24 bits of a word as a number in [0, 1), exact in f32.
#[allow(clippy::cast_precision_loss, reason = "24 bits are exact in f32")]
pub fn fraction(word: u32) -> f32 {
    (word >> 8) as f32 / 16_777_216.0
}

/// A number in [low, high).
pub fn range(seed: u64, agent: u32, purpose: Purpose, draw: u32, low: f32, high: f32) -> f32 {
    low + (high - low) * unit(seed, agent, purpose, draw)
}

/// An index below `count` (0 when `count` is 0), by multiplication: the bias is below `count / 2^32`.
pub fn index(seed: u64, agent: u32, purpose: Purpose, draw: u32, count: usize) -> usize {
    let wide = u128::from(bits(seed, agent, purpose, draw)) * (count as u128);
    usize::try_from(wide >> 32).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_have_these_values_for_ever() {
        // Changing any of these changes every crowd ever seeded: mark it "results:" in the changelog.
        assert_eq!(bits(0, 0, Purpose::Start, 0), 0x0233_c9b4);
        assert_eq!(bits(1, 0, Purpose::Start, 0), 0x5993_0ab5);
        assert_eq!(bits(1 << 32, 0, Purpose::Start, 0), 0x6874_513a);
        assert_eq!(bits(42, 7, Purpose::Emotion, 3), 0x16a6_c05c);
        assert_eq!(bits(u64::MAX, u32::MAX, Purpose::Scenery, u32::MAX), 0x384b_2e52);
    }

    #[test]
    fn draws_are_spread_evenly_and_streams_differ() {
        let mut counts = [0_u32; 10];
        let mut equal = 0;
        for agent in 0..100_000 {
            counts[index(5, agent, Purpose::Gait, 0, 10)] += 1;
            equal += u32::from(bits(5, agent, Purpose::Gait, 0) == bits(5, agent, Purpose::Phase, 0));
            let u = unit(5, agent, Purpose::Scale, 0);
            assert!((0.0..1.0).contains(&u));
        }
        for count in counts {
            assert!(count.abs_diff(10_000) < 400, "{counts:?}");
        }
        assert!(equal < 3);
        assert_eq!(index(1, 1, Purpose::Gait, 0, 0), 0);
    }
}

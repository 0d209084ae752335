//! Clothes of the generated bodies: which parts of its mesh an agent shows, what covers its arms and legs, and in which colours.
//! `shaders/shared/outfit.wgsl` says what each part does.

use super::{Mesh, Sex};
use crate::kernels::layout::Appearance;
use crate::kernels::shared::outfit::{
    BACKPACK, BARE_LEGS, BEARD, BUN, BUTTONS, CAP, DRESS, DRESSED, FIRST_COVER, GLASSES, HAIR_DOWN, HAIR_UP, JACKET,
    LOWER_LEG, LOWER_SLEEVE, OPEN, PEAK, PONYTAIL, SKIRT, STRIPES, TORSO, TROUSERS, UPPER_SLEEVE, V_NECK,
};
use crate::kernels::shared::tailored::PLAIN;
use crate::scenario::random::{Purpose, bits, fraction, index};

/// What outfits do to a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[doc(hidden)]
pub struct Tailoring {
    /// Number of the part that it belongs to; 0: it is the same in every outfit.
    pub part: u32,
    /// Whether the body's own outfit has that part.
    pub is_plain: bool,
    /// How far it moves along its normal in outfits that differ from the body's own in that part, m.
    pub growth: f32,
}

impl Tailoring {
    /// As the shaders read it: part (5 bits), plain (1), growth in mm (8 bits, signed, from bit 8), the collar's height in mm
    /// (16 bits).
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within their bits")]
    pub fn word(&self, collar: f32) -> u32 {
        let growth = (1e3 * self.growth).round().clamp(-127.0, 127.0) as i8;
        let plain = if self.is_plain { PLAIN } else { 0 };
        self.part | plain | u32::from(growth.cast_unsigned()) << 8 | ((1e3 * collar).round() as u32) << 16
    }
}

/// What one level of a body may wear.
#[derive(Debug, Clone, PartialEq)]
#[doc(hidden)]
pub struct Clothes {
    /// Of every vertex of the body's own mesh.
    pub own: Vec<Tailoring>,
    /// What comes beside it.
    pub others: Mesh,
    /// Of every vertex of these.
    pub of_others: Vec<Tailoring>,
}

/// What a generated body may wear.
#[derive(Debug, Clone, PartialEq)]
#[doc(hidden)]
pub struct Wardrobe {
    /// Whose it is.
    pub sex: Sex,
    /// Height of the top's collar, m.
    pub collar: f32,
    /// By level of detail.
    pub levels: Vec<Clothes>,
}

/// What an agent wears, as the draw shaders read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
#[doc(hidden)]
pub struct Outfit {
    /// A bit for each part and style; 0: the body's own outfit.
    pub worn: u32,
    /// Colours of the jacket, and of cap, bag and stripes: five, six and five bits each.
    pub colors: u32,
}

/// Jackets, and the colours beside those of tops and bottoms.
const OUTER: [u32; 9] =
    [0x2b303a, 0x3b3a36, 0x4a3b2e, 0x1f2a44, 0x5a6b52, 0x7a6a55, 0x6e2f33, 0x8a8f96, 0xa9752f];
const EXTRA: [u32; 9] =
    [0x22252b, 0xd8d4ca, 0x7c2a2e, 0x2f5d8a, 0x3f6b4a, 0xc9a227, 0x56505c, 0x9a5b34, 0x14171c];

/// Shares of outfits: ours, made up so that a crowd looks like a street in spring.
mod shares {
    pub(super) const JACKET: f32 = 0.34;
    pub(super) const OPEN_JACKET: f32 = 0.62;
    pub(super) const LONG_SLEEVES: f32 = 0.5;
    pub(super) const SLEEVELESS: f32 = 0.16;
    pub(super) const SKIRT: f32 = 0.36;
    pub(super) const DRESS: f32 = 0.4;
    pub(super) const SHORTS: f32 = 0.14;
    pub(super) const HAIR_UP: f32 = 0.5;
    pub(super) const BUN: f32 = 0.4;
    pub(super) const BEARD: f32 = 0.25;
    pub(super) const CAP: f32 = 0.1;
    pub(super) const GLASSES: f32 = 0.18;
    pub(super) const BACKPACK: f32 = 0.17;
    /// Of tops without a jacket: buttons, then a neck cut out, then stripes.
    pub(super) const TOPS: [f32; 3] = [0.24, 0.2, 0.2];
}

impl Outfit {
    /// What an agent wears: it follows from its number and its colours, so from the seed of its crowd.
    pub fn of(sex: Sex, agent: u32, own: &Appearance) -> Self {
        let seed = u64::from(own.skin_and_hair) << 32 | u64::from(own.top_and_bottom);
        let chance = |draw: u32, share: f32| fraction(bits(seed, agent, Purpose::Clothes, draw)) < share;
        let pick = |draw: u32, colors: &[u32]| {
            Appearance::color_bits(colors[index(seed, agent, Purpose::Clothes, draw, colors.len())])
        };
        let mut parts = vec![TORSO];
        let has_jacket = chance(0, shares::JACKET);
        if has_jacket {
            parts.extend([JACKET, UPPER_SLEEVE, LOWER_SLEEVE]);
            if chance(1, shares::OPEN_JACKET) {
                parts.push(OPEN);
            }
        } else {
            let style = fraction(bits(seed, agent, Purpose::Clothes, 2));
            let [buttons, neck, stripes] = shares::TOPS;
            match style {
                _ if style < buttons => parts.push(BUTTONS),
                _ if style < buttons + neck => parts.push(V_NECK),
                _ if style < buttons + neck + stripes => parts.push(STRIPES),
                _ => {}
            }
            if chance(3, shares::LONG_SLEEVES) {
                parts.extend([UPPER_SLEEVE, LOWER_SLEEVE]);
            } else if sex == Sex::Male || !chance(4, shares::SLEEVELESS) {
                parts.push(UPPER_SLEEVE);
            }
        }
        let is_warm = !has_jacket;
        match sex {
            Sex::Female => Self::of_woman(&chance, &mut parts),
            Sex::Male => {
                if !(is_warm && chance(5, shares::SHORTS)) {
                    parts.push(LOWER_LEG);
                }
                if chance(9, shares::BEARD) {
                    parts.push(BEARD);
                }
            }
        }
        for (draw, share, worn) in [
            (10, shares::CAP, [CAP, PEAK].as_slice()),
            (11, shares::GLASSES, &[GLASSES]),
            (12, shares::BACKPACK, &[BACKPACK]),
        ] {
            if chance(draw, share) {
                parts.extend(worn);
            }
        }
        Self {
            worn: parts.into_iter().fold(DRESSED, |worn, part| worn | 1 << part),
            colors: pick(13, &OUTER) | pick(14, &EXTRA) << 16,
        }
    }

    fn of_woman(chance: &dyn Fn(u32, f32) -> bool, parts: &mut Vec<u32>) {
        if chance(5, shares::SKIRT) {
            parts.extend([SKIRT, BARE_LEGS]);
            if chance(6, shares::DRESS) {
                parts.push(DRESS);
            }
        } else {
            parts.push(TROUSERS);
        }
        if chance(7, shares::HAIR_UP) {
            parts.extend([HAIR_UP, if chance(8, shares::BUN) { BUN } else { PONYTAIL }]);
        } else {
            parts.push(HAIR_DOWN);
        }
    }

    /// Whether it has a part or style.
    pub const fn has(&self, part: u32) -> bool {
        self.worn >> part & 1 == 1
    }

    /// Whether the body shows a vertex in this outfit.
    pub const fn shows(&self, vertex: &Tailoring) -> bool {
        if vertex.part == 0 || vertex.part >= FIRST_COVER {
            return true;
        }
        if self.worn & DRESSED == 0 { vertex.is_plain } else { self.has(vertex.part) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    fn agents(sex: Sex) -> impl Iterator<Item = Outfit> {
        (0..20_000).map(move |agent| {
            let colors = [agent * 7919 & 0xff_ffff, 0, agent * 104_729 & 0xff_ffff, 0];
            Outfit::of(sex, agent, &Appearance::new(0, 0, false, 1.0, colors))
        })
    }

    #[test]
    fn there_are_more_than_five_hundred_combinations_and_nothing_is_worn_with_what_it_excludes() {
        let all: Vec<(Sex, Outfit)> =
            Sex::ALL.into_iter().flat_map(|sex| agents(sex).map(move |outfit| (sex, outfit))).collect();
        for (sex, outfit) in &all {
            let has = |part| outfit.has(part);
            assert_eq!(has(SKIRT), has(BARE_LEGS), "{outfit:?}");
            assert_eq!(has(CAP), has(PEAK), "{outfit:?}");
            assert!(!has(LOWER_SLEEVE) || has(UPPER_SLEEVE), "{outfit:?}");
            assert!(!has(JACKET) || has(LOWER_SLEEVE), "{outfit:?}");
            assert!(!has(OPEN) || has(JACKET), "{outfit:?}");
            assert!(!has(JACKET) || !(has(BUTTONS) || has(STRIPES) || has(V_NECK)), "{outfit:?}");
            let is_woman = *sex == Sex::Female;
            assert_eq!(has(TROUSERS) || has(SKIRT), is_woman, "{outfit:?}");
            assert_eq!(has(HAIR_UP) || has(HAIR_DOWN), is_woman, "{outfit:?}");
            assert!(!(has(TROUSERS) && has(SKIRT)) && !(has(HAIR_UP) && has(HAIR_DOWN)), "{outfit:?}");
            assert!(!has(DRESS) || has(SKIRT), "{outfit:?}");
            assert!(!has(BEARD) || !is_woman, "{outfit:?}");
        }
        let masks: HashSet<(Sex, u32)> = all.iter().map(|(sex, outfit)| (*sex, outfit.worn)).collect();
        assert!(masks.len() >= 500, "{} combinations", masks.len());
        println!("{} combinations", masks.len());
    }

    #[test]
    fn an_outfit_follows_from_number_and_colours() {
        let own = |top: u32| Appearance::new(0, 0, false, 1.0, [0, 0, top, 0]);
        let of = |agent: u32, top: u32| Outfit::of(Sex::Male, agent, &own(top));
        assert_eq!(of(7, 0x20_3040), of(7, 0x20_3040));
        let differ = (0..100).filter(|agent| of(*agent, 0x20_3040) != of(*agent, 0x40_3020)).count();
        assert!(differ > 90, "{differ} of 100 dress differently in another seed");
        let mut angry = own(0x20_3040);
        angry.set_emotion(1);
        assert_eq!(Outfit::of(Sex::Male, 7, &angry), of(7, 0x20_3040), "clothes do not tell emotions");
    }

    #[test]
    fn what_is_not_dressed_shows_its_own_outfit() {
        let plain = Outfit::default();
        let vertex = |part: u32, is_plain: bool| Tailoring { part, is_plain, growth: 0.0 };
        assert!(plain.shows(&vertex(0, false)) && plain.shows(&vertex(SKIRT, true)));
        assert!(!plain.shows(&vertex(TROUSERS, false)) && plain.shows(&vertex(LOWER_SLEEVE, false)));
        let dressed = Outfit { worn: DRESSED | 1 << TROUSERS, colors: 0 };
        assert!(dressed.shows(&vertex(TROUSERS, false)) && !dressed.shows(&vertex(SKIRT, true)));
    }

    #[test]
    fn a_word_holds_part_growth_and_collar() {
        let word = Tailoring { part: LOWER_SLEEVE, is_plain: true, growth: -0.006 }.word(1.5);
        assert_eq!(word & 31, LOWER_SLEEVE);
        assert_eq!(word & PLAIN, PLAIN);
        assert_eq!((word << 16).cast_signed() >> 24, -6);
        assert_eq!(word >> 16, 1500);
    }
}

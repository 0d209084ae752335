//! How the people of a crowd wear their hair: shapes that go with sex, age, skin and colour of hair.

use crate::gait::walker::Sex;
use crate::kernels::layout::Appearance;
use crate::kernels::shared::outfit::{
    BALD, BUN, CROPPED, HAIR_LONG, HAIR_UP, KNOT, OWN_HAIR, PLAITS, PONYTAIL, ROUND, SWEPT,
};

/// Shorter than this share of an avatar's adults is a child.
const ADULT: f32 = 0.86;
/// Skin is dark below this green, of 63; hair is grey where red and blue differ by less, of 31, and are brighter.
const DARK: u32 = 24;
const GREY: [u32; 2] = [2, 14];

/// A shape of hair: its parts, and how often it is worn beside the others.
struct Shape {
    parts: &'static [u32],
    share: f32,
    /// By so much more often with dark skin, by children, with grey hair.
    dark: f32,
    child: f32,
    grey: f32,
    /// Whether hats are worn over it: not where it stands out, nor with plaits, which have triangles enough.
    is_flat: bool,
}

const fn shape(parts: &'static [u32], share: f32, [dark, child, grey]: [f32; 3], is_flat: bool) -> Shape {
    Shape { parts, share, dark, child, grey, is_flat }
}

/// Shares are ours, made up as those of clothes.
const OF_WOMEN: [Shape; 9] = [
    shape(&[OWN_HAIR], 0.22, [0.5, 1.0, 1.3], true),
    shape(&[HAIR_LONG], 0.24, [0.6, 1.5, 0.5], true),
    shape(&[HAIR_UP, PONYTAIL], 0.18, [1.0, 1.5, 0.5], true),
    shape(&[HAIR_UP, BUN], 0.1, [1.0, 0.5, 1.5], true),
    shape(&[HAIR_UP, KNOT], 0.05, [1.2, 0.8, 0.3], false),
    shape(&[HAIR_UP, PLAITS], 0.04, [2.0, 5.0, 0.2], false),
    shape(&[CROPPED], 0.04, [2.5, 0.2, 1.5], true),
    shape(&[SWEPT], 0.09, [0.5, 0.3, 2.0], false),
    shape(&[ROUND], 0.04, [7.0, 1.0, 1.5], false),
];
const OF_MEN: [Shape; 7] = [
    shape(&[OWN_HAIR], 0.4, [0.7, 1.5, 1.0], true),
    shape(&[SWEPT], 0.2, [0.3, 0.7, 0.6], false),
    shape(&[CROPPED], 0.18, [2.2, 1.0, 1.0], true),
    shape(&[HAIR_LONG], 0.06, [0.5, 0.8, 0.6], true),
    shape(&[HAIR_UP, KNOT], 0.03, [1.0, 0.0, 0.2], false),
    shape(&[BALD], 0.07, [1.0, 0.0, 3.0], true),
    shape(&[ROUND], 0.06, [3.0, 1.0, 0.8], false),
];

/// Whether an agent is a child, by its body.
pub(super) fn is_child(own: &Appearance) -> bool {
    own.scale * own.stature() < ADULT
}

/// The hair of an agent by a number in [0, 1), and whether hats are worn over it.
pub(super) fn hair_of(sex: Sex, own: &Appearance, draw: f32) -> (&'static [u32], bool) {
    let shapes: &[Shape] = match sex {
        Sex::Female => &OF_WOMEN,
        Sex::Male => &OF_MEN,
    };
    let skin_green = own.skin_and_hair >> 5 & 63;
    let [red, blue] = [own.skin_and_hair >> 27, own.skin_and_hair >> 16 & 31];
    let [apart, bright] = GREY;
    let is_grey = red.abs_diff(blue) < apart && red > bright;
    let traits = [skin_green < DARK, is_child(own), is_grey];
    let weight = |shape: &Shape| {
        let factors = [shape.dark, shape.child, shape.grey];
        traits.iter().zip(factors).filter(|(has, _)| **has).fold(shape.share, |share, (_, by)| share * by)
    };
    let all: f32 = shapes.iter().map(weight).sum();
    let mut rest = draw * all;
    let found = shapes.iter().find(|shape| {
        rest -= weight(shape);
        rest < 0.0
    });
    let own = found.unwrap_or(&shapes[0]);
    (own.parts, own.is_flat)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    const PALE: u32 = 0xf3_d3bc;
    const DARK_SKIN: u32 = 0x4a_2c1b;
    const BLACK: u32 = 0x1c_1714;
    const SILVER: u32 = 0x8f_8b86;

    /// Shares of shapes, by the first of their parts that is none of tied hair.
    fn shares(sex: Sex, skin: u32, hair: u32, scale: f32) -> HashMap<u32, f32> {
        let own = Appearance::new(0, 0, false, scale, [skin, hair, 0, 0]);
        let mut found: HashMap<u32, f32> = HashMap::new();
        for k in 0..10_000_u16 {
            let (parts, _) = hair_of(sex, &own, f32::from(k) * 1e-4);
            *found.entry(*parts.last().unwrap()).or_default() += 1e-4;
        }
        found
    }

    #[test]
    fn there_are_a_dozen_shapes_and_more_and_all_are_worn() {
        let [women, men] = Sex::ALL.map(|sex| shares(sex, PALE, BLACK, 1.0));
        let of = |found: &HashMap<u32, f32>| found.len();
        assert_eq!((of(&women), of(&men)), (OF_WOMEN.len(), OF_MEN.len()));
        assert!(women.values().chain(men.values()).all(|share| *share > 0.01), "{women:?}, {men:?}");
        let sum: f32 = OF_WOMEN.iter().map(|shape| shape.share).sum();
        assert!((sum - 1.0).abs() < 1e-5 && (OF_MEN.iter().map(|s| s.share).sum::<f32>() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn hair_goes_with_skin_age_and_its_colour() {
        let of = |found: &HashMap<u32, f32>, part: u32| found.get(&part).copied().unwrap_or(0.0);
        let men = |skin, hair, scale| shares(Sex::Male, skin, hair, scale);
        assert!(of(&men(DARK_SKIN, BLACK, 1.0), ROUND) > 2.0 * of(&men(PALE, BLACK, 1.0), ROUND));
        assert!(of(&men(PALE, SILVER, 1.0), BALD) > 2.0 * of(&men(PALE, BLACK, 1.0), BALD));
        assert!(of(&men(PALE, BLACK, 0.7), BALD) == 0.0, "no child is bald");
        let girls = shares(Sex::Female, PALE, BLACK, 0.7);
        assert!(of(&girls, PLAITS) > 3.0 * of(&shares(Sex::Female, PALE, BLACK, 1.0), PLAITS));
        // blond is as bright as grey, and no grey
        assert_eq!(men(PALE, 0xc4_9a58, 1.0), men(PALE, BLACK, 1.0));
    }
}

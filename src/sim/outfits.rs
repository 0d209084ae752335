//! What the people of a crowd wear, drawn from their numbers and colours. It is looks alone: no kernel and no state knows of it.

use super::avatar_set::AvatarSet;
use super::bodies::MeshBuffers;
use super::hair::{hair_of, is_child};
use crate::avatar::wardrobe::{Clothes, Outfit};
use crate::gait::walker::Sex;
use crate::kernels::Store;
use crate::kernels::layout::Appearance;
use crate::kernels::shared::body::index::VERTEX_STRIDE;
use crate::kernels::shared::outfit::{
    BACKPACK, BARE_LEGS, BEARD, BRIM, BUTTONS, CAP, COAT, DRESS, GLASSES, JACKET, LOWER_LEG, LOWER_SLEEVE,
    OPEN, PEAK, SKIRT, SNEAKERS, STRIPES, TORSO, TROUSERS, UPPER_SLEEVE, V_NECK,
};
use crate::scenario::random::{Purpose, bits, fraction, index};

/// Jackets, and the colours beside those of tops and bottoms.
const OUTER: [u32; 9] =
    [0x2b303a, 0x3b3a36, 0x4a3b2e, 0x1f2a44, 0x5a6b52, 0x7a6a55, 0x6e2f33, 0x8a8f96, 0xa9752f];
const EXTRA: [u32; 9] =
    [0x22252b, 0xd8d4ca, 0x7c2a2e, 0x2f5d8a, 0x3f6b4a, 0xc9a227, 0x56505c, 0x9a5b34, 0x14171c];

/// Shares of outfits: ours, made up so that a crowd looks like a street in spring.
mod shares {
    pub(super) const JACKET: f32 = 0.34;
    pub(super) const OPEN_JACKET: f32 = 0.62;
    /// Of jackets.
    pub(super) const COAT: f32 = 0.24;
    pub(super) const LONG_SLEEVES: f32 = 0.5;
    pub(super) const SLEEVELESS: f32 = 0.16;
    pub(super) const SKIRT: f32 = 0.36;
    pub(super) const DRESS: f32 = 0.4;
    pub(super) const SHORTS: f32 = 0.14;
    pub(super) const BEARD: f32 = 0.25;
    pub(super) const SNEAKERS: f32 = 0.35;
    /// Of hair that hats are worn over: a cap with a peak, a hat with a brim, a cap of wool.
    pub(super) const HATS: [f32; 3] = [0.08, 0.05, 0.04];
    pub(super) const GLASSES: f32 = 0.18;
    pub(super) const BACKPACK: f32 = 0.17;
    /// Of tops without a jacket: buttons, then a neck cut out, then stripes.
    pub(super) const TOPS: [f32; 3] = [0.24, 0.2, 0.2];
}

impl MeshBuffers {
    /// Adds what outfits do to the next mesh, which has that many vertices of its own.
    pub(super) fn add_clothes(&mut self, clothes: &Clothes, collar: f32, vertices: usize) {
        self.tailoring.resize(self.vertices.len() / VERTEX_STRIDE, 0);
        let own = clothes.own.iter().take(vertices).chain(&clothes.of_others);
        self.tailoring.extend(own.map(|vertex| vertex.word(collar)));
    }
}

/// What the agents of a store wear.
pub(super) fn outfits(store: &Store, cast: &AvatarSet) -> Vec<Outfit> {
    let of = |(own, agent): (&Appearance, u32)| {
        let wardrobe = cast.avatars().get(own.avatar() as usize).and_then(|avatar| avatar.wardrobe.as_ref());
        wardrobe.map_or_else(Outfit::default, |wardrobe| outfit_of(wardrobe.sex, agent, own))
    };
    store.appearance.iter().zip(0..).map(of).collect()
}

/// What an agent wears: it follows from its number and its colours, so from the seed of its crowd.
fn outfit_of(sex: Sex, agent: u32, own: &Appearance) -> Outfit {
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
        if chance(15, shares::COAT) {
            parts.push(COAT);
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
    match sex {
        Sex::Female => of_woman(&chance, &mut parts),
        Sex::Male => {
            if has_jacket || !chance(5, shares::SHORTS) {
                parts.push(LOWER_LEG);
            }
            if chance(9, shares::BEARD) && !is_child(own) {
                parts.push(BEARD);
            }
        }
    }
    let (hair, is_flat) = hair_of(sex, own, fraction(bits(seed, agent, Purpose::Clothes, 7)));
    parts.extend(hair);
    if is_flat {
        parts.extend(hat(fraction(bits(seed, agent, Purpose::Clothes, 10))));
    }
    for (draw, share, worn) in
        [(11, shares::GLASSES, GLASSES), (12, shares::BACKPACK, BACKPACK), (16, shares::SNEAKERS, SNEAKERS)]
    {
        if chance(draw, share) {
            parts.push(worn);
        }
    }
    Outfit {
        worn: parts.into_iter().fold(0, |worn, part| worn | 1 << part),
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
}

fn hat(draw: f32) -> &'static [u32] {
    let [peak, brim, wool] = shares::HATS;
    match draw {
        _ if draw < peak => &[CAP, PEAK],
        _ if draw < peak + brim => &[CAP, BRIM],
        _ if draw < peak + brim + wool => &[CAP],
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::avatar::wardrobe::Tailoring;
    use crate::avatar::{self, Mesh};
    use crate::kernels::shared::outfit::{
        BALD, BUN, CROPPED, HAIR_LONG, HAIR_UP, KNOT, OWN_HAIR, PLAITS, PONYTAIL, ROUND, SWEPT,
    };
    use std::collections::HashSet;

    fn agents(sex: Sex) -> impl Iterator<Item = Outfit> {
        (0..20_000).map(move |agent| {
            let colors = [(agent * 7919) & 0xff_ffff, 0, (agent * 104_729) & 0xff_ffff, 0];
            outfit_of(sex, agent, &Appearance::new(0, 0, false, 1.0, colors))
        })
    }

    #[test]
    fn there_are_more_than_five_hundred_combinations_and_nothing_is_worn_with_what_it_excludes() {
        let all: Vec<(Sex, Outfit)> =
            Sex::ALL.into_iter().flat_map(|sex| agents(sex).map(move |outfit| (sex, outfit))).collect();
        for (sex, outfit) in &all {
            let has = |part| outfit.has(part);
            assert_eq!(has(SKIRT), has(BARE_LEGS), "{outfit:?}");
            assert!(has(CAP) || !(has(PEAK) || has(BRIM)), "{outfit:?}");
            assert!(!has(PEAK) || !has(BRIM), "{outfit:?}");
            assert!(!has(CAP) || !(has(ROUND) || has(KNOT) || has(SWEPT)), "{outfit:?}");
            assert!(!has(COAT) || has(JACKET), "{outfit:?}");
            let shells = [OWN_HAIR, HAIR_UP, HAIR_LONG, CROPPED, SWEPT, ROUND, BALD];
            assert_eq!(shells.into_iter().filter(|part| has(*part)).count(), 1, "{outfit:?}");
            let tied = [PONYTAIL, BUN, PLAITS, KNOT].into_iter().filter(|part| has(*part)).count();
            assert_eq!(tied, usize::from(has(HAIR_UP)), "{outfit:?}");
            assert!(!has(LOWER_SLEEVE) || has(UPPER_SLEEVE), "{outfit:?}");
            assert!(!has(JACKET) || has(LOWER_SLEEVE), "{outfit:?}");
            assert!(!has(OPEN) || has(JACKET), "{outfit:?}");
            assert!(!has(JACKET) || !(has(BUTTONS) || has(STRIPES) || has(V_NECK)), "{outfit:?}");
            let is_woman = *sex == Sex::Female;
            assert_eq!(has(TROUSERS) || has(SKIRT), is_woman, "{outfit:?}");
            assert!(!has(BALD) || !is_woman, "{outfit:?}");
            assert!(!has(TROUSERS) || !has(SKIRT), "{outfit:?}");
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
        let of = |agent: u32, top: u32| outfit_of(Sex::Male, agent, &own(top));
        assert_eq!(of(7, 0x20_3040), of(7, 0x20_3040));
        let differ = (0..100).filter(|agent| of(*agent, 0x20_3040) != of(*agent, 0x40_3020)).count();
        assert!(differ > 90, "{differ} of 100 dress differently in another seed");
        let mut angry = own(0x20_3040);
        angry.set_emotion(1);
        assert_eq!(outfit_of(Sex::Male, 7, &angry), of(7, 0x20_3040), "clothes do not tell emotions");
    }

    #[test]
    fn dressed_people_have_at_most_4000_triangles_and_3600_in_the_mean() {
        for sex in Sex::ALL {
            let body = if sex == Sex::Female { avatar::Sex::Female } else { avatar::Sex::Male };
            let avatar = avatar::generated(body);
            let clothes = &avatar.wardrobe.as_ref().unwrap().levels[0];
            let parts = |mesh: &Mesh, tailoring: &[Tailoring]| -> Vec<Tailoring> {
                mesh.indices.chunks_exact(3).map(|t| tailoring[t[0] as usize]).collect()
            };
            let mut all = parts(&avatar.levels[0], &clothes.own);
            let plain = all.len();
            all.extend(parts(&clothes.others, &clothes.of_others));
            let drawn = |outfit: &Outfit| all.iter().filter(|vertex| outfit.shows(vertex)).count();
            assert_eq!(drawn(&Outfit::default()), plain);
            let most = agents(sex).map(|outfit| drawn(&outfit)).max().unwrap();
            let mean = agents(sex).take(2000).map(|outfit| drawn(&outfit)).sum::<usize>() / 2000;
            println!("{}: {plain} plain, {mean} in the mean, {most} at most, {} held", sex.name(), all.len());
            assert!(most <= 4000 && mean <= 3600, "{}: {mean} triangles, {most} at most", sex.name());
        }
    }
}

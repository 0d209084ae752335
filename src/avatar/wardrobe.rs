//! Clothes of the generated bodies: which parts of its mesh an agent shows, what covers its arms and legs, and in which colours.
//! `shaders/shared/outfit.wgsl` says what each part does.

use super::body_model::Mesh;
use crate::gait::walker::Sex;
use crate::kernels::shared::outfit::FIRST_COVER;
use crate::kernels::shared::tailored::PLAIN;

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

impl Outfit {
    /// Whether it has a part or style.
    pub const fn has(&self, part: u32) -> bool {
        self.worn >> part & 1 == 1
    }

    /// Whether the body shows a vertex in this outfit.
    pub const fn shows(&self, vertex: &Tailoring) -> bool {
        if vertex.part == 0 || vertex.part >= FIRST_COVER {
            return true;
        }
        if self.worn == 0 { vertex.is_plain } else { self.has(vertex.part) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::shared::outfit::{LOWER_SLEEVE, SKIRT, TROUSERS};

    #[test]
    fn what_is_not_dressed_shows_its_own_outfit() {
        let plain = Outfit::default();
        let vertex = |part: u32, is_plain: bool| Tailoring { part, is_plain, growth: 0.0 };
        assert!(plain.shows(&vertex(0, false)) && plain.shows(&vertex(SKIRT, true)));
        assert!(!plain.shows(&vertex(TROUSERS, false)) && plain.shows(&vertex(LOWER_SLEEVE, false)));
        let dressed = Outfit { worn: 1 << TROUSERS, colors: 0 };
        assert!(dressed.shows(&vertex(TROUSERS, false)) && !dressed.shows(&vertex(SKIRT, true)));
    }

    #[test]
    fn all_corners_of_a_triangle_are_worn_or_not_together() {
        for sex in crate::avatar::Sex::ALL {
            let avatar = crate::avatar::generated(sex);
            let wardrobe = avatar.wardrobe.as_ref().unwrap();
            for (mesh, clothes) in avatar.levels.iter().zip(&wardrobe.levels) {
                assert_eq!(mesh.vertices.len(), clothes.own.len());
                assert_eq!(clothes.others.vertices.len(), clothes.of_others.len());
                for (mesh, tailoring) in [(mesh, &clothes.own), (&clothes.others, &clothes.of_others)] {
                    for t in mesh.indices.chunks_exact(3) {
                        let shell = |index: u32| match tailoring[index as usize].part {
                            part if part < FIRST_COVER => part,
                            _ => 0,
                        };
                        assert!(shell(t[0]) == shell(t[1]) && shell(t[1]) == shell(t[2]));
                    }
                }
                assert!(
                    clothes
                        .own
                        .iter()
                        .all(|vertex| vertex.part == 0 || vertex.part >= FIRST_COVER || vertex.is_plain)
                );
                assert!(clothes.of_others.iter().all(|vertex| !vertex.is_plain && vertex.part > 0));
            }
        }
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

//! Rust twins of the structs that buffers hold, written from the WGSL when the crate is built: the same fields in the same
//! order, without a gap. Bits are packed and unpacked here, in one function each.

use crate::kernels::shared::contents::{BARE, CROWDED, GROUPS, STOREYS, UNLIKE, USER, WALLS};
use crate::kernels::shared::stages::WAYPOINT;
use crate::kernels::shared::step::{GROUP_SHIFT, LED, LED_BIT};
use bytemuck::{Pod, Zeroable};

include!(concat!(env!("OUT_DIR"), "/layout.rs"));

impl Avoidance {
    /// Whether the agent is led from outside.
    pub fn is_led(&self) -> bool {
        self.priority >= LED
    }
}

/// Where `emotion` begins in [`Appearance::traits`].
const EMOTION_SHIFT: u32 = 8;
/// The bit of an agent that may look at the user.
const GAZES: u32 = 1 << 16;
/// The bit of an agent that has no body to draw.
const BODILESS: u32 = 1 << 17;
/// Where stature and breadth begin, seven bits each.
const STATURE_SHIFT: u32 = 18;
const BREADTH_SHIFT: u32 = 25;
/// Steps of one in a coarse ratio, and in a ratio of a [`Physique`].
const COARSE_STEPS: f32 = 64.0;
const STEPS: f32 = 16_384.0;

impl Body {
    /// How far a stride goes at a speed, m/s: in m. Twin of `stride_at` in `shaders/shared/agent.wgsl`.
    pub fn stride_at(&self, speed: f32) -> f32 {
        2.0 * (self.walk_ratio * speed).sqrt()
    }

    /// A place of a foot, to the left and ahead, m, as bits; what is farther than 3 m counts as 3 m.
    #[allow(clippy::cast_possible_truncation, reason = "30,000 at most")]
    pub fn foot_bits(place: [f32; 2]) -> u32 {
        let tenths = |part: f32| ((10_000.0 * part.clamp(-3.0, 3.0)).round() as i16).cast_unsigned();
        let [aside, ahead] = place.map(tenths);
        u32::from(aside) | u32::from(ahead) << 16
    }

    /// That place. Twin of `foot_at` in `shaders/shared/agent.wgsl`.
    #[allow(clippy::cast_possible_truncation, reason = "halves of the bits")]
    pub fn foot_at(bits: u32) -> [f32; 2] {
        [bits as u16, (bits >> 16) as u16].map(|part| f32::from(part.cast_signed()) * 0.0001)
    }
}

impl Appearance {
    /// An agent of an avatar, by number, that shows an emotion (0 happy, 1 angry, 2 sad, 3 neutral), at a scale; skin, hair,
    /// top and bottom as `0xRRGGBB`.
    pub fn new(avatar: u32, emotion: u32, gazes: bool, scale: f32, colors: [u32; 4]) -> Self {
        let [skin, hair, top, bottom] = colors.map(rgb565);
        Self {
            traits: avatar | emotion << EMOTION_SHIFT | if gazes { GAZES } else { 0 },
            scale,
            skin_and_hair: skin | hair << 16,
            top_and_bottom: top | bottom << 16,
        }
    }

    /// A colour `0xRRGGBB` in five, six and five bits.
    pub fn color_bits(color: u32) -> u32 {
        rgb565(color)
    }

    /// Number of the avatar.
    pub const fn avatar(&self) -> u32 {
        self.traits & 255
    }

    /// The emotion that is shown: 0 happy, 1 angry, 2 sad, 3 neutral.
    pub const fn emotion(&self) -> u32 {
        self.traits >> EMOTION_SHIFT & 255
    }

    /// Whether the agent may look at the user.
    pub const fn gazes(&self) -> bool {
        self.traits & GAZES != 0
    }

    /// Whether there is no body to draw.
    pub const fn is_bodiless(&self) -> bool {
        self.traits & BODILESS != 0
    }

    /// How high a body stands beside its avatar's at this scale, to a part in 64. Twin of `stature_of` in
    /// `shaders/shared/agent.wgsl`.
    pub const fn stature(&self) -> f32 {
        coarse_ratio(self.traits >> STATURE_SHIFT)
    }

    /// How broad, likewise.
    pub const fn breadth(&self) -> f32 {
        coarse_ratio(self.traits >> BREADTH_SHIFT)
    }

    /// What is shown of an agent and may change while it walks: its traits without those of its build.
    pub const fn shown(&self) -> u32 {
        self.traits & ((1 << STATURE_SHIFT) - 1)
    }

    /// Sets how high and how broad a body stands beside its avatar's at this scale.
    pub fn set_size(&mut self, stature: f32, breadth: f32) {
        self.traits =
            self.shown() | coarse_steps(stature) << STATURE_SHIFT | coarse_steps(breadth) << BREADTH_SHIFT;
    }

    /// Sets the number of the avatar.
    pub const fn set_avatar(&mut self, avatar: u32) {
        self.traits = self.traits & !255 | avatar;
    }

    /// Sets the emotion that is shown.
    pub const fn set_emotion(&mut self, emotion: u32) {
        self.traits = self.traits & !(255 << EMOTION_SHIFT) | emotion << EMOTION_SHIFT;
    }

    /// Sets whether the agent may look at the user.
    pub const fn set_gazes(&mut self, gazes: bool) {
        self.traits = self.traits & !GAZES | if gazes { GAZES } else { 0 };
    }

    /// Sets whether there is no body to draw.
    pub const fn set_bodiless(&mut self, bodiless: bool) {
        self.traits = self.traits & !BODILESS | if bodiless { BODILESS } else { 0 };
    }
}

/// A ratio to a part in 64, 0 to 1.98, as seven bits: 0 is 1.
#[allow(clippy::cast_possible_truncation, reason = "-64 to 63")]
fn coarse_steps(ratio: f32) -> u32 {
    let steps = ((ratio - 1.0) * COARSE_STEPS).round().clamp(-64.0, 63.0) as i32;
    steps.cast_unsigned() & 127
}

#[allow(clippy::cast_precision_loss, reason = "-64 to 63")]
const fn coarse_ratio(bits: u32) -> f32 {
    1.0 + ((bits << 25).cast_signed() >> 25) as f32 * (1.0 / COARSE_STEPS)
}

impl Physique {
    /// The ratios in a word. Twin of `ratios_in` in `shaders/shared/agent.wgsl`.
    #[allow(clippy::cast_possible_truncation, reason = "halves of the bits")]
    pub fn ratios_in(pair: u32) -> [f32; 2] {
        [pair as u16, (pair >> 16) as u16].map(|steps| 1.0 + f32::from(steps.cast_signed()) * (1.0 / STEPS))
    }

    /// Two ratios as a word; what is below a quarter or above 2.75 counts as that.
    #[allow(clippy::cast_possible_truncation, reason = "28,672 at most")]
    pub fn word(ratios: [f32; 2]) -> u32 {
        let [low, high] = ratios.map(|ratio| {
            let ratio = if ratio.is_nan() { 1.0 } else { ratio.clamp(0.25, 2.75) };
            (((ratio - 1.0) * STEPS).round() as i16).cast_unsigned()
        });
        u32::from(low) | u32::from(high) << 16
    }
}

/// `0xRRGGBB` in five, six and five bits.
fn rgb565(color: u32) -> u32 {
    let (r, g, b) = (color >> 16 & 0xff, color >> 8 & 0xff, color & 0xff);
    r >> 3 << 11 | g >> 2 << 5 | b >> 3
}

impl Route {
    /// A journey of `length` stages from number `first` on, at its stage `next`; with `loops` it begins again after the last one.
    pub const fn new(first: u32, length: u32, loops: bool, next: u32) -> Self {
        Self { first, length_and_loops: length | (loops as u32) << 31, next, arrivals: 0 }
    }

    /// How many stages it has.
    pub const fn length(&self) -> u32 {
        self.length_and_loops & 0x7fff_ffff
    }

    /// Whether it begins again after the last one.
    pub const fn loops(&self) -> bool {
        self.length_and_loops >> 31 == 1
    }
}

impl Stage {
    /// A waypoint at `place`, passed within `radius`, m.
    pub const fn waypoint(place: [f32; 2], radius: f32) -> Self {
        Self {
            place,
            radius,
            kind: WAYPOINT,
            along: [0.0; 2],
            across: [0.0; 2],
            field: -1.0,
            least_wait: 0.0,
            first_leave: 0.0,
            number: 0.0,
            elevation: 0.0,
            has_elevation: 0.0,
            unused_a: 0.0,
            unused_b: 0.0,
        }
    }
}

impl StepUniforms {
    /// What there is in the crowd, as flags of the immediate `contents`.
    pub fn contents(&self) -> u32 {
        [
            (STOREYS, self.storey_height > 0.0),
            // with patience, and in groups, some are given the right of way for a while
            (UNLIKE, self.alike == 0 || self.patience > 0.0 || self.group_count > 0),
            (WALLS, self.obstacle_count > 0),
            (USER, self.user_radius > 0.0),
            (CROWDED, self.crowding > 0.0),
            (GROUPS, self.group_count > 0),
            (BARE, self.bare > 0),
        ]
        .into_iter()
        .filter(|(_, is_there)| *is_there)
        .fold(0, |contents, (bit, _)| contents | bit)
    }
}

impl SlotMotion {
    /// Most neighbours.
    pub const fn neighbour_cap(&self) -> u32 {
        self.limits & (LED_BIT - 1)
    }

    /// Whether the agent is led from outside.
    pub const fn is_led(&self) -> bool {
        self.limits & LED_BIT != 0
    }

    /// The group that it walks with, or 0.
    pub const fn group(&self) -> u32 {
        self.limits >> GROUP_SHIFT
    }

    /// Joins a group, by the number of its first member.
    pub const fn join(&mut self, first_member: u32) {
        self.limits |= (first_member + 1) << GROUP_SHIFT;
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "ratios of whole steps are exact")]
mod tests {
    use super::*;

    #[test]
    fn colours_keep_their_high_bits() {
        assert_eq!(rgb565(0x00ff_ffff), 0xffff);
        assert_eq!(rgb565(0x00ff_0000), 0xf800);
        assert_eq!(rgb565(0x0000_8000), 0x0400);
    }

    #[test]
    fn an_appearance_gives_back_what_was_put_in() {
        let mut own = Appearance::new(4, 2, true, 1.1, [0xff_ffff, 0, 0, 0xff_ffff]);
        assert_eq!((own.avatar(), own.emotion(), own.gazes(), own.is_bodiless()), (4, 2, true, false));
        assert_eq!((own.skin_and_hair, own.top_and_bottom), (0xffff, 0xffff_0000));
        own.set_emotion(1);
        own.set_avatar(3);
        own.set_bodiless(true);
        own.set_gazes(false);
        assert_eq!((own.avatar(), own.emotion(), own.gazes(), own.is_bodiless()), (3, 1, false, true));
    }

    #[test]
    fn a_build_gives_back_what_was_put_in_and_none_is_the_avatars_own() {
        let mut own = Appearance::new(4, 2, true, 1.1, [0; 4]);
        assert_eq!((own.stature(), own.breadth()), (1.0, 1.0));
        for (stature, breadth) in [(0.75, 1.25), (1.5, 0.5), (63.0 / 64.0, 65.0 / 64.0)] {
            own.set_size(stature, breadth);
            assert_eq!((own.stature(), own.breadth()), (stature, breadth));
            assert_eq!((own.avatar(), own.emotion(), own.gazes(), own.is_bodiless()), (4, 2, true, false));
        }
        own.set_size(-3.0, 9.0);
        assert_eq!((own.stature(), own.breadth()), (0.0, 1.0 + 63.0 / 64.0));
        assert_eq!(Physique::ratios_in(0), [1.0, 1.0]);
        assert_eq!(Physique::ratios_in(Physique::word([0.75, 1.5])), [0.75, 1.5]);
        assert_eq!(Physique::ratios_in(Physique::word([f32::NAN, 9.0])), [1.0, 2.75]);
    }

    #[test]
    fn a_route_gives_back_what_was_put_in() {
        let route = Route::new(7, 3, true, 1);
        assert_eq!((route.first, route.length(), route.loops(), route.next), (7, 3, true, 1));
        assert!(!Route::new(0, u32::MAX >> 1, false, 0).loops());
    }

    #[test]
    fn limits_hold_cap_group_and_who_is_led() {
        let mut own = SlotMotion { limits: 10 | LED_BIT, ..SlotMotion::default() };
        own.join(41);
        assert_eq!((own.neighbour_cap(), own.is_led(), own.group()), (10, true, 42));
    }
}

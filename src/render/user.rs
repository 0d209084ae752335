//! What a frame shows of the user: hands or controllers, where a teleport leads, a vignette.

use crate::kernels::layout::{Solid, UserUniforms};
use bytemuck::Zeroable as _;
use glam::{Mat4, Quat, Vec3};

/// Most solids of one frame (`shaders/draw/user.wgsl`).
const SOLIDS: usize = 64;
/// Vertices of one solid there: faces around times faces down, of six.
pub(super) const SOLID_VERTICES: u32 = 12 * 8 * 6;
/// Beads of a teleport's arc.
const BEADS: u8 = 14;
/// Radius of a bead, m.
const BEAD: f32 = 0.012;
/// Radius of the ring where a teleport leads, m.
const RING: f32 = 0.35;
/// Where teleporting is allowed and where not, linear; what is above 1 glows.
const ALLOWED: Vec3 = Vec3::new(0.05, 0.85, 1.25);
const FORBIDDEN: Vec3 = Vec3::new(1.3, 0.12, 0.05);
/// The vignette begins at these angles from the middle of the view at strength 0 and 1, radians, and is full so much
/// farther out.
const VIGNETTE: [f32; 3] = [1.05, 0.42, 0.22];

/// What is drawn where a hand is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HandKind {
    /// A hand: a fist with a thumb and a cuff.
    #[default]
    Hand,
    /// A controller, without a hand.
    Controller,
}

/// A hand of the user, as OpenXR's grip pose: the origin is the middle of the fist.
/// −z runs along the tube that the fingers form, out past the thumb. +y is up when the arm is held out forwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hand {
    /// World frame, m.
    pub place: Vec3,
    /// `world_from_hand`.
    pub turn: Quat,
    /// What is drawn.
    pub kind: HandKind,
}

/// Joints of a hand that is seen, in OpenXR's order: palm, wrist, four of the thumb, five of each other finger.
pub const JOINTS: usize = 26;

/// A hand that is seen, joint by joint: place in the world frame and radius, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joints(pub [(Vec3, f32); JOINTS]);

/// Where a teleport would lead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Teleport {
    /// Where its arc begins, mostly a hand; world frame, m.
    pub from: Vec3,
    /// The place on the floor, world frame, m.
    pub to: Vec3,
    /// Whether the user may go there: blue, else red.
    pub is_allowed: bool,
}

/// What frames show of the user, until the next [`super::Renderer::set_user`]. By default nothing.
///
/// Hands and arc are lit and shaded like everything, the ring lies on the floor, the vignette over all. They cast no
/// shadows, and agents do not see them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct User {
    /// The left and the right hand, where there is one.
    pub hands: [Option<Hand>; 2],
    /// The same, joint by joint; drawn instead of [`User::hands`].
    pub joints: [Option<Joints>; 2],
    /// Where a teleport would lead, while the user aims.
    pub teleport: Option<Teleport>,
    /// How far the view is narrowed for comfort while the user is moved: 0 not at all (nothing is drawn) to 1. Grow and
    /// shrink it over a few tenths of a second.
    pub vignette: f32,
    /// How far everything is covered with grey, hands too: 0 not at all to 1.
    pub fade: f32,
}

impl User {
    /// The shapes, and how many solids are among them.
    pub(super) fn uniforms(&self) -> (UserUniforms, u32) {
        let mut solids = Vec::with_capacity(SOLIDS);
        for (side, (hand, joints)) in [-1.0, 1.0].into_iter().zip(self.hands.iter().zip(&self.joints)) {
            match joints {
                Some(joints) => solids.extend(bones(joints)),
                None => solids.extend(hand.iter().flat_map(|hand| hand_solids(hand, side))),
            }
        }
        let mut uniforms = UserUniforms::zeroed();
        if let Some(teleport) = self.teleport {
            let color = if teleport.is_allowed { ALLOWED } else { FORBIDDEN };
            uniforms.target_place = teleport.to.extend(RING).to_array();
            uniforms.target_color = color.extend(1.0).to_array();
            solids.extend(beads(&teleport, color));
        }
        let strength = self.vignette.clamp(0.0, 1.0);
        let begin = VIGNETTE[0] + (VIGNETTE[1] - VIGNETTE[0]) * strength;
        // a weak one is wide and fades in; from a third of the strength on it is black
        uniforms.vignette =
            [(3.0 * strength).min(1.0), begin, begin + VIGNETTE[2], self.fade.clamp(0.0, 1.0)];
        let usable = solids.into_iter().filter(|solid| solid.x.iter().chain(&solid.y).all(|v| v.is_finite()));
        let mut count = 0;
        for (to, solid) in uniforms.solids.iter_mut().zip(usable) {
            *to = solid;
            count += 1;
        }
        (uniforms, count)
    }
}

/// A solid of these half lengths at `middle` in the frame of `world_from_part`.
fn solid(world_from_part: &Mat4, middle: [f32; 3], half: [f32; 3], color: Vec3, boxy: f32) -> Solid {
    let local = Mat4::from_translation(Vec3::from(middle)) * Mat4::from_scale(Vec3::from(half));
    let world = *world_from_part * local;
    let row = |i| world.row(i).to_array();
    Solid { x: row(0), y: row(1), z: row(2), color: color.extend(boxy).to_array() }
}

/// Colour of hands, linear.
const SKIN: Vec3 = Vec3::new(0.5, 0.3, 0.2);

/// The bones of a hand: from each joint to the next one of its finger, and the palm between the wrist and the knuckles.
fn bones(Joints(joints): &Joints) -> impl Iterator<Item = Solid> + '_ {
    const FINGERS: [(usize, usize); 5] = [(2, 5), (6, 10), (11, 15), (16, 20), (21, 25)];
    let pairs = FINGERS.into_iter().flat_map(|(first, last)| (first..last).map(|joint| (joint, joint + 1)));
    pairs.chain([(1, 12)]).map(move |(from, to)| {
        let ((a, near), (b, far)) = (joints[from], joints[to]);
        let thick = 0.5 * (near + far);
        let way = b - a;
        let turn = Quat::from_rotation_arc(Vec3::Z, way.try_normalize().unwrap_or(Vec3::Z));
        let world = Mat4::from_rotation_translation(turn, 0.5 * (a + b));
        solid(&world, [0.0; 3], [thick, thick, 0.5 * way.length() + 0.7 * thick], SKIN, 0.2)
    })
}

/// A hand or a controller; `side` is −1 for the left one.
fn hand_solids(hand: &Hand, side: f32) -> Vec<Solid> {
    let world = Mat4::from_rotation_translation(hand.turn.normalize(), hand.place);
    let part = |middle, half, color, boxy| solid(&world, middle, half, color, boxy);
    match hand.kind {
        HandKind::Hand => {
            let (skin, sleeve) = (SKIN, Vec3::new(0.05, 0.09, 0.16));
            let inwards = -side;
            let mut solids = vec![
                // the back of the hand looks outwards, the fingers curl in before it
                part([-0.012 * inwards, 0.0, 0.01], [0.024, 0.04, 0.048], skin, 0.5),
                part([0.0, -0.052, 0.055], [0.034, 0.04, 0.05], sleeve, 0.3),
                part([0.014 * inwards, 0.03, -0.035], [0.012, 0.012, 0.036], skin, 0.0),
            ];
            for finger in [-0.032, -0.011, 0.011, 0.032] {
                solids.push(part([0.016 * inwards, 0.0, finger], [0.02, 0.031, 0.0105], skin, 0.3));
            }
            solids
        }
        HandKind::Controller => {
            let (grip, head) = (Vec3::splat(0.03), Vec3::splat(0.09));
            vec![
                part([0.0, -0.005, 0.025], [0.017, 0.02, 0.06], grip, 0.6),
                part([0.0, 0.012, -0.045], [0.028, 0.014, 0.032], head, 0.7),
                part([0.0, 0.03, -0.04], [0.007, 0.009, 0.007], grip, 0.2),
                part([0.0, -0.01, -0.055], [0.008, 0.016, 0.012], grip, 0.5),
            ]
        }
    }
}

/// The arc from the hand to the place: beads on a parabola that leaves the line by a quarter of its length.
fn beads(teleport: &Teleport, color: Vec3) -> impl Iterator<Item = Solid> {
    let Teleport { from, to, .. } = *teleport;
    let rise = 0.25 * from.distance(to);
    (1..=BEADS).map(move |number| {
        let t = f32::from(number) / f32::from(BEADS + 1);
        let middle = from.lerp(to, t) + Vec3::Y * (4.0 * rise * t * (1.0 - t));
        solid(&Mat4::IDENTITY, middle.to_array(), [BEAD; 3], color, 0.0)
    })
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "limits are exact")]
mod tests {
    use super::*;

    #[test]
    fn everything_of_a_user_has_room_and_what_is_not_finite_is_left_out() {
        let hand = |kind| Some(Hand { place: Vec3::Y, turn: Quat::IDENTITY, kind });
        let teleport = Some(Teleport { from: Vec3::Y, to: Vec3::Z, is_allowed: true });
        let user =
            User { hands: [hand(HandKind::Hand); 2], joints: [None; 2], teleport, vignette: 2.0, fade: 3.0 };
        let (uniforms, count) = user.uniforms();
        assert_eq!(count, 2 * 7 + u32::from(BEADS), "all have room");
        assert_eq!((uniforms.vignette[0], uniforms.vignette[3]), (1.0, 1.0));
        assert_eq!(uniforms.target_color[3], 1.0);
        assert_eq!(User::default().uniforms().1, 0);
        let lost = Some(Hand { place: Vec3::NAN, turn: Quat::IDENTITY, kind: HandKind::Controller });
        let (uniforms, count) = User { hands: [lost, hand(HandKind::Controller)], ..user }.uniforms();
        assert_eq!(count, 4 + u32::from(BEADS));
        assert!(uniforms.solids.iter().all(|solid| solid.x.iter().all(|v| v.is_finite())));
    }

    #[test]
    fn a_hand_that_is_seen_is_drawn_by_its_bones_instead_of_what_it_holds() {
        // finger after finger beside each other, joints three centimetres apart
        let place = |joint: u8| Vec3::new(0.02 * f32::from(joint / 5), 1.0, -0.03 * f32::from(joint % 5));
        let mut number = 0;
        let joints = Joints([(); JOINTS].map(|()| {
            number += 1;
            (place(number), 0.01)
        }));
        let held = Some(Hand { place: Vec3::Y, turn: Quat::IDENTITY, kind: HandKind::Controller });
        let teleport = Some(Teleport { from: Vec3::Y, to: Vec3::Z, is_allowed: true });
        let user = User { hands: [held; 2], joints: [Some(joints); 2], teleport, ..User::default() };
        let (uniforms, count) = user.uniforms();
        assert_eq!(count, 2 * 20 + u32::from(BEADS), "all have room");
        let index = &uniforms.solids[3]; // from joint 6, number 7, to the next
        let middle = 0.5 * (place(7) + place(8));
        let [x, y, z] = [index.x, index.y, index.z];
        assert!((Vec3::new(x[3], y[3], z[3]) - middle).length() < 1e-6, "{index:?}");
        let length = Vec3::new(x[2], y[2], z[2]).length();
        assert!((length - (0.015 + 0.007)).abs() < 1e-6, "{length}");
        let one = User { joints: [Some(joints), None], ..user };
        assert_eq!(one.uniforms().1, 20 + 4 + u32::from(BEADS));
    }

    #[test]
    fn the_arc_leaves_the_hand_upwards_and_comes_down_at_the_place() {
        let teleport =
            Teleport { from: Vec3::new(0.0, 1.2, 0.0), to: Vec3::new(0.0, 0.0, 4.0), is_allowed: false };
        let places: Vec<Vec3> =
            beads(&teleport, FORBIDDEN).map(|s| Vec3::new(s.x[3], s.y[3], s.z[3])).collect();
        assert!(places[0].y > 1.2 && places.windows(2).all(|pair| pair[0].z < pair[1].z));
        assert!(places[13].distance(teleport.to) < 0.6);
    }
}

//! Hands: a palm, four fingers and a thumb, at rest and as fists. Coarser levels have mittens.

use super::limbs::Skin;
use super::shape::{Builder, Cap, Cover, Ring};
use super::{Measures, SKIN, Sex};
use crate::avatar::FaceVertex;
use glam::{Vec2, Vec3};

/// A finger of a man's hand, m.
struct Finger {
    /// Of its knuckle from the wrist, along the forearm and towards the thumb.
    knuckle: [f32; 2],
    length: f32,
    /// Half of its breadth.
    broad: f32,
    /// At rest, how far its first bone and the line from its second joint to its tip are bent from the palm, rad. Little
    /// fingers are bent more.
    rest: [f32; 2],
}

const FINGERS: [Finger; 4] = [
    Finger { knuckle: [0.092, 0.0300], length: 0.074, broad: 0.0092, rest: [0.50, 1.25] },
    Finger { knuckle: [0.095, 0.0100], length: 0.082, broad: 0.0094, rest: [0.58, 1.38] },
    Finger { knuckle: [0.091, -0.0100], length: 0.076, broad: 0.0090, rest: [0.64, 1.48] },
    Finger { knuckle: [0.083, -0.0290], length: 0.061, broad: 0.0080, rest: [0.68, 1.55] },
];
/// The same of a fist: the last bone points back at the palm.
const CLENCHED: [f32; 2] = [1.48, 3.85];
/// Share of a finger's length from its knuckle to its second joint, and from there to its tip at rest and clenched.
const FIRST_BONE: f32 = 0.47;
const TO_TIP: [f32; 2] = [0.52, 0.43];
/// Where the tip begins to be round, of the way to it.
const PAD: f32 = 0.86;
/// How far knuckles begin inside the palm, m.
const INSIDE: f32 = 0.012;

/// The thumb's joints, man's hand, m: from the wrist along the forearm, towards the front, towards the palm; and its radius.
type Thumb = [([f32; 3], f32); 3];
const THUMB_AT_REST: Thumb =
    [([0.015, 0.020, 0.006], 0.0145), ([0.058, 0.041, 0.020], 0.0115), ([0.088, 0.043, 0.034], 0.0095)];
const THUMB_OF_FIST: Thumb =
    [([0.015, 0.020, 0.006], 0.0145), ([0.060, 0.038, 0.034], 0.0115), ([0.080, 0.014, 0.056], 0.0095)];

/// How a hand is held.
#[derive(Clone, Copy, PartialEq)]
enum Held {
    AtRest,
    Clenched,
}

/// A hand's own axes.
struct Hand {
    wrist: Vec3,
    /// On from the forearm.
    along: Vec3,
    /// To the side of the thumb.
    front: Vec3,
    /// To the side of the palm.
    inward: Vec3,
    size: f32,
}

impl Measures {
    /// A hand with fingers and what makes a fist of it; a mitten on coarser levels. `points`: shoulder, elbow, wrist.
    pub(super) fn hand<'a>(&self, builder: &mut Builder<'a>, points: [Vec3; 3], left: bool, skin: Skin<'a>) {
        let [_, elbow, wrist] = points;
        let along = (wrist - elbow).normalize_or_zero();
        let front = (Vec3::Z - along * along.z).normalize_or_zero();
        let inward = along.cross(front) * if left { 1.0 } else { -1.0 };
        let size = if self.sex == Sex::Male { 1.0 } else { 0.88 };
        let hand = Hand { wrist, along, front, inward, size };
        if builder.level > 0 {
            hand.mitten(builder, skin);
            return;
        }
        hand.palm(builder, skin);
        let first = builder.len();
        hand.fingers(builder, skin, Held::AtRest);
        let mut fist = Builder::new(0);
        hand.fingers(&mut fist, skin, Held::Clenched);
        let (fist, ..) = fist.finish();
        builder.express(first, &|number, own| FaceVertex {
            fist: fist.vertices[number].position - own.position,
            fist_normal: fist.vertices[number].normal - own.normal,
            ..FaceVertex::default()
        });
    }
}

impl Hand {
    /// A cross section of the palm: along the forearm, towards the palm, bent there; half thickness and half breadth.
    fn section(&self, along: f32, palm: f32, bent: f32, [thick, broad]: [f32; 2]) -> Ring {
        let (sine, cosine) = libm::sincosf(bent);
        Ring {
            center: self.wrist + (self.along * along + self.inward * palm) * self.size,
            side: (self.inward * cosine - self.along * sine) * thick * self.size,
            front: self.front * broad * self.size,
            back: 1.0,
            square: 2.6,
            paint: SKIN,
            back_paint: None,
            keep: 0,
            cover: Cover::default(),
        }
    }

    fn mitten<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        let rings = [
            self.section(-0.022, 0.0, 0.0, [0.021, 0.026]),
            self.section(0.086, 0.006, 0.3, [0.017, 0.042]),
            self.section(0.138, 0.060, 1.4, [0.011, 0.029]),
        ]
        .map(|ring| Ring { keep: builder.level, ..ring });
        builder.begin(skin);
        builder.loft(&rings, 3, [Cap::Open, Cap::Fan(0.010)]);
        builder.end(None);
    }

    fn palm<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        let rings = [
            self.section(-0.022, 0.0, 0.0, [0.020, 0.026]),
            self.section(0.030, 0.001, 0.0, [0.018, 0.037]),
            self.section(0.090, 0.003, 0.1, [0.0125, 0.041]),
        ];
        builder.begin(skin);
        builder.loft(&rings, 6, [Cap::Open, Cap::Fan(0.004)]);
        builder.end(None);
    }

    fn fingers<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>, held: Held) {
        for finger in &FINGERS {
            builder.begin(skin);
            builder.loft(&self.finger(finger, held), 4, [Cap::Open; 2]);
            builder.end(None);
        }
        let thumb = if held == Held::Clenched { THUMB_OF_FIST } else { THUMB_AT_REST };
        builder.begin(skin);
        builder.loft(&self.thumb(&thumb), 4, [Cap::Open; 2]);
        builder.end(None);
    }

    /// In the plane of `along` and `inward`.
    fn finger(&self, finger: &Finger, held: Held) -> [Ring; 4] {
        let is_fist = held == Held::Clenched;
        let [first, second] = if is_fist { CLENCHED } else { finger.rest };
        let way = |angle: f32| Vec2::from_angle(angle) * finger.length;
        let [along, aside] = finger.knuckle;
        let knuckle = Vec2::new(along, 0.003);
        let joint = knuckle + way(first) * FIRST_BONE;
        let to_tip = way(second) * TO_TIP[usize::from(is_fist)];
        let ring = |at: Vec2, angle: f32, share: f32| {
            let (sine, cosine) = libm::sincosf(angle);
            Ring {
                center: self.wrist
                    + (self.along * at.x + self.inward * at.y + self.front * aside) * self.size,
                side: (self.inward * cosine - self.along * sine) * (finger.broad * share * self.size),
                front: self.front * (finger.broad * share * self.size),
                back: 1.0,
                square: 2.4,
                paint: SKIN,
                back_paint: None,
                keep: 0,
                cover: Cover::default(),
            }
        };
        [
            ring(knuckle - Vec2::X * INSIDE, 0.5 * first, 1.05),
            ring(joint, 0.5 * (first + second), 1.0),
            ring(joint + to_tip * PAD, second, 0.82),
            ring(joint + to_tip, second, 0.0),
        ]
    }

    fn thumb(&self, joints: &Thumb) -> [Ring; 4] {
        let place =
            |[along, front, palm]: [f32; 3]| self.along * along + self.front * front + self.inward * palm;
        let [base, joint, tip] = joints.map(|(at, _)| place(at));
        let ring = |at: Vec3, way: Vec3, radius: f32| {
            let way = way.normalize_or_zero();
            let side = (self.inward - way * way.dot(self.inward)).normalize_or_zero();
            Ring {
                center: self.wrist + at * self.size,
                side: side * (radius * self.size),
                front: side.cross(way) * (radius * self.size),
                back: 1.0,
                square: 2.0,
                paint: SKIN,
                back_paint: None,
                keep: 0,
                cover: Cover::default(),
            }
        };
        let [of_base, of_joint, of_tip] = joints.map(|(_, radius)| radius);
        let last = tip - joint;
        [
            ring(base, joint - base, of_base),
            ring(joint, tip - base, of_joint),
            ring(joint + last * PAD, last, of_tip),
            ring(tip, last, 0.0),
        ]
    }
}

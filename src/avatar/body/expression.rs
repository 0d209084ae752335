//! How the generated faces move: where each vertex goes with each of the numbers of an expression.
//!
//! All movements slide along the skull, so that no skin leaves it. They fade with the distance from what moves.

use super::super::FaceVertex;
use super::super::body_model::UNSEEN;
use super::eye::Eye;
use super::head::Skull;
use super::weights::step;
use glam::{Quat, Vec3};

/// Between the lips, under the crown (man's size), m.
pub(super) const MOUTH: f32 = 0.1888;
/// A corner of the mouth, beside the middle (man's size), m.
pub(super) const CORNER: f32 = 0.0257;
/// The inner end of a brow beside the middle, and how far away its outer end is (man's size), m.
pub(super) const BROW: [f32; 2] = [0.0118, 0.0385];
/// The middle of the brows, under the crown (man's size), m.
const BROW_AT: f32 = 0.089;
/// How far the lower lids rise in a smile, and where lips are pressed, as the angry do (unit 7), rad.
const LOWER_LID: [f32; 2] = [0.16, 0.20];

/// A soft bump, 1 in the middle.
pub(super) fn bump(x: f32, y: f32) -> f32 {
    libm::expf(-(x * x + y * y))
}

/// A place on a face at rest, man's size.
struct Place<'a> {
    skull: &'a Skull,
    /// To the side, m.
    x: f32,
    /// Of that side: 1 is left, -1 right.
    side: f32,
    /// Under the crown, m.
    drop: f32,
    /// 1 in the face, 0 on the back of the head.
    ahead: f32,
}

impl Place<'_> {
    /// The way to another place on the skull, so far to the side and up, and in front of it, man's size, m.
    fn slide(&self, aside: f32, up: f32, out: f32) -> Vec3 {
        let from = self.skull.face(self.x, self.drop, 0.0);
        let to = self.skull.face(self.x + aside, self.drop - up, out);
        (to - from) * Vec3::new(self.side, 1.0, 1.0) * self.ahead
    }

    /// How much the place moves with the inner and with the outer end of a brow.
    fn of_brow(&self) -> [f32; 2] {
        let [inner, length] = BROW;
        let along = (self.x - inner) / length;
        [step(0.8, 0.0, along), step(0.25, 1.0, along) * step(1.8, 1.1, along)]
    }

    /// How much it moves with the corner of the mouth.
    fn of_corner(&self) -> f32 {
        let share = self.x / CORNER;
        if share < 1.0 { libm::powf(share, 1.7) } else { bump((self.x - CORNER) / 0.015, 0.0) }
    }

    /// How much it moves with the middle of the lips.
    fn of_middle(&self) -> f32 {
        let share = self.x / CORNER;
        libm::powf((1.0 - share * share).max(0.0), 0.8)
    }

    fn brows(&self, share: f32) -> FaceVertex {
        let [inner, outer] = self.of_brow().map(|weight| weight * share);
        FaceVertex {
            inner_brow: self.slide(0.002 * inner, 0.0075 * inner, 0.0),
            outer_brow: self.slide(0.0, 0.0055 * outer, 0.0),
            ..FaceVertex::default()
        }
    }

    fn corners_up(&self) -> Vec3 {
        let corner = self.of_corner() * bump(0.0, (self.drop - MOUTH) / 0.017);
        let cheek = bump((self.x - 0.036) / 0.014, (self.drop - 0.158) / 0.013);
        self.slide(0.006 * corner, 0.0095 * corner + 0.004 * cheek, 0.003 * cheek)
    }

    fn corners_down(&self) -> Vec3 {
        let corner = self.of_corner() * bump(0.0, (self.drop - MOUTH - 0.001) / 0.014);
        // the chin pushes the lower lip up
        let pout = self.of_middle() * bump(0.0, (self.drop - 0.193) / 0.009);
        self.slide(0.0005 * corner, 0.0022 * pout - 0.0065 * corner, 0.0015 * pout)
    }

    fn opened(&self, is_below: bool) -> Vec3 {
        let lip = self.of_middle();
        if is_below {
            let jaw = step(MOUTH, 0.205, self.drop) * bump(self.x / 0.05, 0.0);
            self.slide(0.0, -0.010 * lip * bump(0.0, (self.drop - MOUTH) / 0.009) - 0.005 * jaw, 0.0)
        } else {
            self.slide(0.0, 0.0022 * lip * bump(0.0, (self.drop - MOUTH) / 0.006), 0.0)
        }
    }

    fn pressed(&self) -> Vec3 {
        let share = self.x / CORNER;
        let lip = bump(0.0, (self.drop - MOUTH) / 0.0095) * step(1.35, 0.9, share);
        let inwards = 0.0022 * lip * share.min(1.0);
        self.slide(-inwards, 0.65 * lip * (self.drop - MOUTH), -0.0022 * lip * (1.0 - 0.5 * share * share))
    }
}

impl Skull {
    fn place(&self, p: Vec3) -> Place<'_> {
        let drop = (self.crown - p.y) / self.size;
        let ahead = step(0.02, 0.05, p.z / self.size);
        Place { skull: self, x: p.x.abs() / self.size, side: p.x.signum(), drop, ahead }
    }

    /// Of the skin at a place; `is_below` of what lies below the line between the lips.
    pub(super) fn moves_of_skin(&self, p: Vec3, is_below: bool) -> FaceVertex {
        let place = self.place(p);
        let of_brows = place.brows(bump(0.0, (place.drop - BROW_AT) / 0.012));
        seen(FaceVertex {
            corners_up: place.corners_up(),
            corners_down: place.corners_down(),
            opened: place.opened(is_below),
            pressed: place.pressed(),
            ..of_brows
        })
    }

    /// Of a brow, which moves as a whole.
    pub(super) fn moves_of_brow(&self, p: Vec3) -> FaceVertex {
        self.place(p).brows(1.0)
    }

    /// Of the teeth, which stay behind the upper lip.
    pub(super) fn moves_of_teeth(&self, p: Vec3) -> FaceVertex {
        let place = Place { drop: MOUTH, ..self.place(p) };
        let upright = Vec3::new(0.0, 1.0, 1.0);
        FaceVertex {
            corners_up: place.corners_up() * upright,
            corners_down: place.corners_down() * upright,
            pressed: place.pressed() * upright,
            ..FaceVertex::default()
        }
    }
}

impl Eye {
    /// Of the lower lid, which rises in a smile and in anger.
    pub(super) fn moves_of_lower_lid(&self, p: Vec3) -> FaceVertex {
        let way = p - self.center;
        let [corners_up, pressed] = LOWER_LID.map(|angle| Quat::from_rotation_x(-angle) * way - way);
        FaceVertex { corners_up, pressed, ..FaceVertex::default() }
    }
}

/// Nothing where no movement is seen.
fn seen(own: FaceVertex) -> FaceVertex {
    let ways = [own.inner_brow, own.outer_brow, own.corners_up, own.corners_down, own.opened, own.pressed];
    if ways.iter().all(|way| way.length() < UNSEEN) { FaceVertex::default() } else { own }
}

//! Hair of the generated bodies: shells around the skull in several cuts, and what is tied up.

use super::head::{SHORT, Skin, Skull, TO_JAW, UNDER_SHELL};
use super::shape::{Builder, Cap, Paint, Ring, level_ring};
use super::weights::step;
use super::{HAIR, Material, Measures, SKIN, Sex, Shares};
use crate::gait::{JOINT_COUNT, Joint};
use crate::kernels::shared::outfit::{
    BALD, BUN, CROPPED, HAIR_LONG, HAIR_UP, KNOT, OWN_HAIR, PLAITS, PONYTAIL, ROUND, SWEPT,
};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

const UNDER_HAIR: Paint = Paint::tinted(Material::Hair, 0.55);
/// Shades of hair from column to column of the finest level: the same on both sides.
const STRANDS: [f32; 12] = [0.96, 1.0, 0.86, 0.95, 0.80, 0.92, 0.85, 0.92, 0.80, 0.95, 0.86, 1.0];
/// Shades of curls, and how far they stand out of the shape, m.
const CURLS: [(f32, f32); 3] = [(0.78, -0.0025), (1.0, 0.0025), (0.9, 0.0)];
/// How thick hair is in the finest level and in the others, m; long hair is thicker by so much, short hair thinner.
const THICK: [f32; 2] = [0.013, 0.020];
const LONG_MORE: f32 = 0.005;
const SHORT_LESS: f32 = 0.002;
const SWEPT_LESS: f32 = 0.005;

/// How hair is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cut {
    /// Down to the jaw, over the ears.
    Bob,
    /// Off the ears, a short nape.
    Short,
    /// The same of long hair that is tied up.
    Up,
    /// A few millimetres.
    Cropped,
    /// Short at the sides, and high in front.
    Swept,
    /// A ball of curls.
    Round,
    /// Over the ears and down the back: a woman's below the shoulders, a man's to them.
    Long,
}

impl Cut {
    const fn of(sex: Sex) -> Self {
        match sex {
            Sex::Female => Self::Bob,
            Sex::Male => Self::Short,
        }
    }

    /// How fast the hair closes in on the nape and, beside it, on the neck, metres per metre of height.
    const fn closing(self) -> [f32; 2] {
        match self {
            Self::Bob => TO_JAW,
            Self::Round => [0.30, 0.05],
            Self::Long => [-0.08, 0.06], // over the back
            _ => SHORT,
        }
    }

    const fn covers_ears(self) -> bool {
        matches!(self, Self::Bob | Self::Long)
    }

    /// Columns and rows of its shell.
    const fn grid(self, level: usize) -> (usize, usize) {
        match self {
            _ if level > 0 => (7, 2),
            Self::Bob | Self::Short => (24, 6),
            Self::Long => (18, 7),
            Self::Round => (20, 6),
            _ => (17, 5),
        }
    }

    /// Its lower edge at an angle from the front, under the crown (man's size), m.
    fn edge(self, sex: Sex, angle: f32, level: usize) -> f32 {
        let turn = turn(angle);
        // parted on the left: a fringe falls to the right; the skull is open above its last row
        let parting = step(-0.45, 0.75, -libm::sinf(angle));
        let fringe = match self {
            _ if level > 0 => 0.052,
            Self::Bob | Self::Long => 0.049 + 0.015 * parting,
            Self::Cropped | Self::Round => 0.047,
            _ => 0.048 + 0.008 * parting,
        };
        match self {
            // shorter in front
            Self::Bob => fringe + (0.212 + 0.026 * step(1.2, 2.3, turn) - fringe) * step(0.85, 1.35, turn),
            Self::Long => {
                let fall = if sex == Sex::Female { 0.150 } else { 0.025 };
                fringe + (0.240 - fringe) * step(0.85, 1.35, turn) + fall * step(1.75, 2.3, turn)
            }
            // Sideburns in front of the ear, a short nape.
            _ => fringe + (0.118 - fringe) * step(0.85, 1.5, turn) + 0.055 * step(1.7, 2.4, turn),
        }
    }

    /// How far it is outside the skin on the way from its edge to the crown, m.
    fn thickness(self, t: f32, level: usize) -> f32 {
        let is_finest = level == 0;
        let thick = THICK[level.min(1)];
        let wave = libm::sinf(PI * t);
        match self {
            Self::Cropped => thick - if is_finest { 0.009 } else { 0.008 },
            Self::Round => thick, // at its edge; above it is a ball
            Self::Swept => thick - SWEPT_LESS,
            // Long hair grows thin towards its ends; short hair is fullest half way up.
            Self::Bob | Self::Long if is_finest => {
                (thick + LONG_MORE) * (0.8 + 0.2 * step(0.0, 0.4, t) + 0.12 * wave)
            }
            Self::Short | Self::Up if is_finest => (thick - SHORT_LESS) * (1.0 + 0.3 * wave),
            Self::Bob | Self::Long => thick + LONG_MORE,
            Self::Short | Self::Up => thick - SHORT_LESS,
        }
    }
}

/// How far an angle is from the front, to either side.
fn turn(angle: f32) -> f32 {
    if angle > PI { TAU - angle } else { angle }
}

impl Measures {
    /// The hair of a body's own outfit: women wear it down.
    pub(super) fn own_hair<'a>(&self, builder: &mut Builder<'a>, skull: &Skull, skin: Skin<'a>) {
        let own = Cut::of(self.sex);
        builder.wear(OWN_HAIR, true);
        skull.hair(builder, own, skin);
        builder.wear(0, true);
        if self.sex == Sex::Male && builder.level == 0 {
            skull.ears(builder, skin);
        }
    }

    /// All hair beside it. Not on the coarsest level, whose heads wear hair as paint.
    pub(super) fn other_hair<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>, long: Skin<'a>) {
        let skull = Skull::of(self);
        let cuts = [
            (HAIR_UP, Cut::Up),
            (CROPPED, Cut::Cropped),
            (SWEPT, Cut::Swept),
            (ROUND, Cut::Round),
            (HAIR_LONG, Cut::Long),
        ];
        for (part, cut) in cuts {
            builder.wear(part, false);
            skull.with(cut.closing()).hair(builder, cut, if cut == Cut::Long { long } else { skin });
            // a man's are his body's
            if self.sex == Sex::Female && builder.level == 0 && !cut.covers_ears() {
                skull.ears(builder, skin);
            }
        }
        builder.wear(KNOT, false);
        skull.bun(builder, skin, [0.0, -0.010, -0.045], Vec3::new(0.0, 0.9, -0.44), 0.030);
        match self.sex {
            Sex::Female => {
                builder.wear(PONYTAIL, false);
                skull.ponytail(builder, skin);
                builder.wear(BUN, false);
                skull.bun(builder, skin, [0.0, 0.060, -0.116], Vec3::new(0.0, 0.45, -0.9), 0.038);
                builder.wear(PLAITS, false);
                [-1.0, 1.0].into_iter().for_each(|side| skull.plait(builder, long, side));
            }
            Sex::Male if builder.level == 0 => {
                builder.wear(BALD, false);
                skull.with(SHORT).bald(builder, skin);
            }
            Sex::Male => {}
        }
    }

    /// Shares of long hair: below the nape it lies on the back.
    pub(super) fn of_long_hair(&self, p: Vec3) -> Shares {
        let neck = self.bones.of(Joint::Neck).y;
        let down = step(neck + 0.05, neck - 0.07, p.y);
        let mut shares = [0.0; JOINT_COUNT];
        shares[Joint::Head as usize] = 1.0 - down;
        shares[Joint::Spine as usize] = down;
        shares
    }
}

impl Skull {
    /// Where a ball of curls is above a place of its edge, on the way to the crown.
    fn in_ball(&self, place: Vec3, t: f32, curl: f32) -> Vec3 {
        /// Its middle, under the crown and ahead, and its radius, m (man's size).
        const BALL: [f32; 3] = [0.072, -0.008, 0.128];
        let [drop, ahead, radius] = BALL;
        let middle = self.beside([0.0, drop, ahead]);
        let from = place - middle;
        let flat = from.with_y(0.0).normalize_or_zero();
        // it grows from the edge as wide as that is, and is round soon
        let low = libm::atan2f(from.y, from.with_y(0.0).length());
        let (high, out) = libm::sincosf(low + (0.47 * PI - low) * t);
        let edge = from.length() / self.size;
        let away = edge + (radius - edge) * step(0.0, 0.4, t) + curl;
        middle + (flat * out + Vec3::Y * high) * away * self.size
    }

    /// How far swept hair stands above short hair: in front, and leaning to a side.
    fn swept(&self, angle: f32, t: f32) -> Vec3 {
        let front = 1.0 - step(0.2, 1.5, turn(angle));
        let top = step(0.45, 0.9, t);
        let wave = front * step(0.0, 0.3, t) * step(1.3, 0.55, t);
        Vec3::new(-0.010 * (wave + 0.5 * top), 0.024 * wave + 0.010 * top, 0.006 * wave) * self.size
    }

    /// A shell of hair.
    fn hair<'a>(&self, builder: &mut Builder<'a>, cut: Cut, skin: Skin<'a>) {
        let level = builder.level;
        let (columns, rows) = cut.grid(level);
        let curl = |row: usize, column: usize| match cut {
            Cut::Round if level == 0 && row > 1 => CURLS[(2 * row + column) % CURLS.len()],
            _ => (STRANDS[column % STRANDS.len()], 0.0),
        };
        let mut grid: Vec<Vec<Vec3>> = Vec::new();
        for row in 0..=rows + 1 {
            // The first row turns in under the hair's edge, so that it has thickness.
            let t = (row as f32 - 1.0).max(0.0) / rows as f32;
            let ring = (0..columns).map(|k| {
                let angle = TAU * k as f32 / columns as f32;
                let out = if row == 0 { UNDER_SHELL } else { cut.thickness(t, level) };
                // Flatter over the forehead, where it would look like a peak.
                let out = out * (1.0 - 0.4 * (1.0 - step(0.2, 1.3, turn(angle))) * (1.0 - t));
                let edge = cut.edge(self.sex, angle, level);
                let place = |drop: f32| self.around(angle, drop, out);
                let short = || place(edge * libm::powf(1.0 - t, 1.35));
                match cut {
                    Cut::Round if row > 0 => self.in_ball(place(edge), t, curl(row, k).1),
                    Cut::Swept if row > 0 => short() + self.swept(angle, t),
                    _ => short(),
                }
            });
            grid.push(ring.collect());
        }
        let strands = |row: usize, column: usize| match row {
            _ if level > 0 => HAIR,
            0 => UNDER_HAIR,
            _ => Paint::tinted(Material::Hair, curl(row, column).0),
        };
        builder.begin(skin);
        builder.painted_grid(&grid, true, &strands);
        builder.close(grid.last(), 0.001, HAIR);
        builder.end(None);
    }

    /// A bare head, with hair at its sides and back.
    fn bald<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        const COLUMNS: u8 = 16;
        /// Where the face ends, and skin under hair, under the crown, m.
        const FROM: [f32; 2] = [0.045, 0.100];
        /// The hair's upper edge, m, and where it begins beside the face, rad.
        const TO: f32 = 0.068;
        const SIDE: f32 = 1.25;
        let row = |share: f32| -> Vec<Vec3> {
            let at = |k: u8| {
                let angle = TAU * f32::from(k) / f32::from(COLUMNS);
                let [front, back] = FROM;
                let from = front + (back - front) * step(1.5, 2.0, turn(angle));
                self.around(angle, from * share, 0.0)
            };
            (0..COLUMNS).map(at).collect()
        };
        let dome = [1.15, 1.0, 0.72, 0.42, 0.16].map(row);
        builder.begin(skin);
        builder.grid(&dome, true, SKIN);
        builder.close(dome.last(), 0.0, SKIN);
        builder.end(None);
        let strip = |share: f32, out: f32| -> Vec<Vec3> {
            let at = |k: u8| {
                let angle = SIDE + (TAU - 2.0 * SIDE) * f32::from(k) / f32::from(COLUMNS);
                let low = Cut::Short.edge(self.sex, angle, 0);
                // thin at its ends
                let ends = step(SIDE, SIDE + 0.3, turn(angle));
                self.around(angle, low + (TO - low) * share, UNDER_SHELL + (out - UNDER_SHELL) * ends)
            };
            (0..=COLUMNS).map(at).collect()
        };
        let rows = [(0.0, UNDER_SHELL), (0.0, 0.007), (0.5, 0.010), (0.85, 0.007), (1.0, UNDER_SHELL)];
        let rows = rows.map(|(share, out)| strip(share, out));
        builder.begin(skin);
        builder.painted_grid(&rows, false, &|row, column| match row {
            0 => UNDER_HAIR,
            _ => Paint::tinted(Material::Hair, STRANDS[column % STRANDS.len()]),
        });
        builder.end(None);
    }

    /// A tail of hair through places at its middle: aside, under the crown, ahead; and radii, m (man's size).
    fn tail<'a, const N: usize>(
        &self,
        builder: &mut Builder<'a>,
        skin: Skin<'a>,
        path: &[([f32; 4], usize); N],
        sides: [usize; 2],
    ) {
        let middle = |at: usize| {
            let [aside, drop, ahead, _] = path[at].0;
            self.beside([aside, drop, ahead])
        };
        let ring = |at: usize| {
            let along = (middle((at + 1).min(N - 1)) - middle(at.saturating_sub(1))).normalize_or_zero();
            let ([.., radius], keep) = path[at];
            let radius = radius * self.size;
            let front = Vec3::X.cross(along).normalize_or_zero() * radius;
            Ring { side: Vec3::X * radius, front, ..level_ring(middle(at), [radius; 2], 2.0, HAIR, keep) }
        };
        builder.begin(skin);
        let segments = sides[builder.level.min(1)];
        builder.loft(&(0..N).map(ring).collect::<Vec<_>>(), segments, [Cap::Open; 2]);
        builder.end(None);
    }

    fn ponytail<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        let path = [
            ([0.0, 0.070, -0.094, 0.012], 1),
            ([0.0, 0.072, -0.126, 0.020], 1),
            ([0.0, 0.130, -0.150, 0.027], 1),
            ([0.0, 0.205, -0.138, 0.024], 0),
            ([0.0, 0.268, -0.126, 0.005], 1),
        ];
        self.tail(builder, skin, &path, [7, 4]);
    }

    fn plait<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>, side: f32) {
        let path = [
            ([side * 0.052, 0.118, -0.074, 0.0100], 1),
            ([side * 0.062, 0.146, -0.094, 0.0180], 0),
            ([side * 0.069, 0.180, -0.101, 0.0120], 1),
            ([side * 0.073, 0.214, -0.106, 0.0170], 0),
            ([side * 0.076, 0.248, -0.111, 0.0115], 1),
            ([side * 0.077, 0.282, -0.117, 0.0155], 0),
            ([side * 0.078, 0.316, -0.123, 0.0085], 0),
            ([side * 0.078, 0.342, -0.127, 0.0125], 0),
            ([side * 0.078, 0.372, -0.129, 0.0030], 1),
        ];
        self.tail(builder, skin, &path, [5, 3]);
    }

    /// Hair that is rolled up about an axis away from the head, at a place beside the skull.
    fn bun<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>, at: [f32; 3], along: Vec3, radius: f32) {
        let (center, along, radius) = (self.beside(at), along.normalize(), radius * self.size);
        let ring = |share: f32, keep: usize| {
            let (sine, cosine) = libm::sincosf(PI * share);
            let at = center - along * (radius * 0.8 * cosine);
            let across = radius * sine.max(0.02);
            let front = Vec3::X.cross(along) * across;
            Ring { side: Vec3::X * across, front, ..level_ring(at, [across; 2], 2.0, HAIR, keep) }
        };
        let rings = [ring(0.15, 1), ring(0.4, 1), ring(0.65, 0), ring(0.85, 1), ring(1.0, 1)];
        builder.begin(skin);
        builder.loft(&rings, [7, 5][builder.level.min(1)], [Cap::Open; 2]);
        builder.end(None);
    }
}

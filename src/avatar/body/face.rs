//! The finest head: a face in relief, and eyes that turn under lids. What the second level has of it.
//!
//! The surface of the skull is moved forwards and back by soft bumps. Eyeballs are caps of spheres set into its sockets, with
//! shells of skin just outside as lids. They hang on joints of their own, which kernel `eyes` turns.

use super::expression::{BROW, MOUTH, bump};
use super::eye::{EYE_RADIUS, Eye};
use super::head::{BEFORE_FACETS, SQUARE, Skin, Skull};
use super::shape::{Builder, Paint};
use super::weights::step;
use super::{Material, SKIN, Sex};
use crate::kernels::shared::outfit::BEARD;
use glam::Vec3;
use std::f32::consts::PI;

const LIPS: [Paint; 2] = [
    Paint { material: Material::Skin, color: Vec3::new(0.80, 0.36, 0.37) },
    Paint { material: Material::Skin, color: Vec3::new(0.72, 0.42, 0.42) },
];
const BETWEEN_LIPS: Paint = Paint { material: Material::Skin, color: Vec3::new(0.42, 0.19, 0.19) };
/// Of the skin's material, since a triangle has one material.
const INSIDE: Paint = Paint { material: Material::Skin, color: Vec3::new(0.10, 0.04, 0.05) };
const TEETH: Paint = Paint::fixed(0.52, 0.50, 0.45);
/// Of brows: their ridge and their edges.
const HAIR_OF_BROWS: [Paint; 2] = [Paint::tinted(Material::Hair, 0.5), Paint::tinted(Material::Hair, 0.75)];

/// What a row of the finest head is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Row {
    Skin,
    /// The red of a lip.
    Lip,
    /// Where the lips meet.
    Edge,
    /// Inside the mouth.
    Inside,
}

/// Of the finest head: rows under the crown (man's size), m. Above the last one there is hair.
const ROWS: [(f32, Row); 27] = [
    (0.236, Row::Skin),
    (0.220, Row::Skin),
    (0.210, Row::Skin),
    (0.2015, Row::Skin),
    (0.1968, Row::Lip),
    (0.1928, Row::Lip),
    (MOUTH, Row::Edge),
    (0.1900, Row::Inside),
    (0.1876, Row::Inside),
    (MOUTH, Row::Edge),
    (0.1856, Row::Lip),
    (0.1826, Row::Lip),
    (0.180, Row::Skin),
    (0.174, Row::Skin),
    (0.168, Row::Skin),
    (0.160, Row::Skin),
    (0.153, Row::Skin),
    (0.144, Row::Skin),
    (0.134, Row::Skin),
    (0.125, Row::Skin),
    (0.118, Row::Skin),
    (0.111, Row::Skin),
    (0.104, Row::Skin),
    (0.097, Row::Skin),
    (0.089, Row::Skin),
    (0.075, Row::Skin),
    (0.045, Row::Skin),
];
/// From this one on, the back of the head is under hair.
const UNDER_HAIR: usize = 17;
/// How many of them lie below the line between the lips.
const ROWS_BELOW: usize = 8;
/// Of its half: columns as shares of the half width, from the middle of the face to the side; then angles from the front.
const COLUMNS: [f32; 10] = [0.0, 0.095, 0.2, 0.31, 0.42, 0.53, 0.64, 0.76, 0.88, 1.0];
const BACK: [f32; 2] = [2.1, 2.65];
/// The column through the corner of the mouth.
const CORNER_SHARE: f32 = COLUMNS[4];
/// How deep the mouth is, m.
const MOUTH_DEPTH: f32 = 0.014;
/// How far the teeth are behind the lips, m.
const TEETH_DEPTH: f32 = 0.0055;
/// The upper teeth: from and to, under the crown, and how far to either side, m (man's size).
const TEETH_AT: [f32; 3] = [0.1865, 0.1925, 0.0195];
/// Two a tooth; a multiple of four, so that there is a gap in the middle.
const TEETH_COLUMNS: u8 = 8;
const TEETH_GAP: f32 = 0.72;

/// Centre of the left eyeball at the side of the middle and under the crown (man's size), and its depth, m.
pub(super) const EYE_AT: [f32; 2] = [0.0315, 0.1115];
pub(super) const EYE_DEPTH: f32 = 0.0715;

impl Skull {
    /// What the face adds in front of the skull at `x` to the left and `drop` under the crown (man's size), m.
    fn relief(&self, x: f32, drop: f32) -> f32 {
        let x = x.abs();
        let is_man = self.sex == Sex::Male;
        let [eye, eye_drop] = EYE_AT;
        let socket = 0.008 * bump((x - eye) / 0.0165, (drop - eye_drop + 0.003) / 0.0120);
        let temple = 0.0055 * bump((x - 0.049) / 0.010, (drop - 0.110) / 0.015);
        let ridge = if is_man { 0.002 } else { 0.001 };
        let ridge = ridge * bump((x - 0.026) / 0.022, (drop - 0.094) / 0.008);
        let along = ((drop - 0.100) / (0.155 - 0.100)).clamp(0.0, 1.0);
        let (tip, width) = if is_man { (0.0235, 0.0105) } else { (0.0185, 0.0095) };
        let nose = (0.005 + (tip - 0.005) * along) * bump(x / (0.0065 + (width - 0.0065) * along), 0.0);
        let nose = nose * step(0.088, 0.108, drop) * step(0.1665, 0.156, drop);
        let wings = 0.006 * bump((x - 0.0125) / 0.006, (drop - 0.1555) / 0.006);
        let cheek = 0.003 * bump((x - 0.040) / 0.018, (drop - 0.146) / 0.020);
        let under = 0.0018 * bump((x - eye) / 0.016, (drop - 0.127) / 0.007);
        let lips = 0.0045 * bump(x / 0.021, (drop - 0.1852) / 0.0045)
            + 0.005 * bump(x / 0.018, (drop - 0.1932) / 0.005);
        let mouth = 0.0025 * bump(x / 0.024, (drop - MOUTH) / 0.0025);
        let chin = 0.004 * bump(x / 0.018, (drop - 0.216) / 0.011);
        ridge + temple + nose + wings + cheek + under + lips + chin - socket - mouth
    }

    /// The skin at an angle from the front, to the left; the face's relief is in it.
    fn skin(&self, angle: f32, drop: f32, out: f32) -> Vec3 {
        let (half_width, front, back) = Self::section(drop);
        let middle = 0.5 * (front + back);
        let rounded = |v: f32| v.signum() * libm::powf(v.abs(), 2.0 / SQUARE);
        let x = rounded(libm::sinf(angle)) * half_width;
        let ahead = rounded(libm::cosf(angle));
        let relief = if ahead > 0.0 { self.relief(x, drop) + out } else { 0.0 };
        Vec3::new(
            x * self.size,
            self.crown - drop * self.size,
            (middle + (front - middle) * ahead + relief) * self.size,
        )
    }

    /// The angle at which the skin is at a share of the half width.
    fn angle(share: f32) -> f32 {
        share.signum() * libm::asinf(libm::powf(share.abs().min(1.0), 0.5 * SQUARE))
    }

    /// Centre of the left eyeball, m.
    pub(super) fn eyeball(&self) -> Vec3 {
        let [x, drop] = EYE_AT;
        Vec3::new(x * self.size, self.crown - drop * self.size, EYE_DEPTH * self.size)
    }

    /// The finest head without its hair.
    pub(super) fn face_and_eyes<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        self.head_and_face(builder, skin);
        self.teeth(builder, skin);
        for side in [-1.0, 1.0] {
            self.brow(builder, skin, side);
            let center = self.eyeball() * Vec3::new(side, 1.0, 1.0);
            let eye = Eye { center, radius: EYE_RADIUS * self.size, side };
            eye.ball(builder);
            let first = builder.len();
            eye.lower_lid(builder, skin);
            builder.express(first, &|_, own| eye.moves_of_lower_lid(own.position));
            eye.upper_lid(builder);
        }
    }

    fn head_and_face<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        let columns = columns();
        let lips = LIPS[usize::from(self.sex == Sex::Male)];
        let paint = |row: usize, share: f32| match ROWS[row].1 {
            Row::Inside if share < CORNER_SHARE => INSIDE,
            Row::Edge if share <= CORNER_SHARE => BETWEEN_LIPS,
            Row::Lip if share < CORNER_SHARE => lips,
            _ => SKIN,
        };
        let grid = |rows: std::ops::Range<usize>, columns: &[(f32, f32)]| -> Vec<Vec<Vec3>> {
            ROWS[rows]
                .iter()
                .map(|row| columns.iter().map(|column| self.in_grid(*row, *column)).collect())
                .collect()
        };
        let first = builder.len();
        builder.begin(skin);
        let lower = grid(0..UNDER_HAIR + 1, &columns);
        builder.painted_grid(&lower, true, &|row, column| paint(row, columns[column].1.abs()));
        // Above, hair hides the back of the head.
        let (left, right) = columns.split_at(columns.len() / 2);
        let front = |column: &&(f32, f32)| column.0.abs() <= BACK[0];
        let seen: Vec<(f32, f32)> = right.iter().chain(left).filter(front).copied().collect();
        builder.painted_grid(&grid(UNDER_HAIR..ROWS.len(), &seen), false, &|_, _| SKIN);
        let grids = builder.len() - first;
        // The bottom; the top is open, under the hair.
        let rim: Vec<u32> = lower[0].iter().map(|p| builder.vertex(*p, SKIN)).collect();
        let middle = lower[0].iter().sum::<Vec3>() / columns.len() as f32;
        let tip = builder.vertex(middle - Vec3::Y * 0.004, SKIN);
        for k in 0..rim.len() {
            builder.triangle(rim[(k + 1) % rim.len()], rim[k], tip);
        }
        builder.end(None);
        let is_below = |number: usize| number >= grids || number < ROWS_BELOW * columns.len();
        builder.express(first, &|number, own| self.moves_of_skin(own.position, is_below(number)));
        if self.sex == Sex::Male {
            builder.cover(first, BEARD, &|own| own.color == Vec3::ONE && self.is_bearded(own.position));
        }
    }

    /// Whether a beard grows here: on jaw, chin and upper lip, and in front of the ears.
    fn is_bearded(&self, place: Vec3) -> bool {
        let drop = (self.crown - place.y) / self.size;
        let x = place.x.abs() / self.size;
        let is_lip = x < 0.030 && (0.173..0.180).contains(&drop);
        let is_jaw = drop > 0.1985 || (drop > 0.165 && x > 0.034);
        let is_sideburn = drop > 0.120 && x > 0.066;
        place.z > -0.02 && (is_lip || is_jaw || is_sideburn)
    }

    /// A place of the head's grid. Lips are thinner towards the corners of the mouth, and behind them is a hollow.
    fn in_grid(&self, (drop, row): (f32, Row), (angle, share): (f32, f32)) -> Vec3 {
        let share = share.abs();
        let narrowing = (share - CORNER_SHARE) / 0.13;
        let is_hollow = row == Row::Inside && share < CORNER_SHARE;
        let height = match row {
            Row::Inside if !is_hollow => 0.0,
            _ if (drop - MOUTH).abs() < 0.013 && !is_hollow => 1.0 - 0.72 * bump(narrowing, 0.0),
            _ => 1.0,
        };
        self.skin(angle, MOUTH + (drop - MOUTH) * height, if is_hollow { -MOUTH_DEPTH } else { 0.0 })
    }

    /// The upper teeth, seen when the mouth is open.
    fn teeth<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        let [top, bottom, aside] = TEETH_AT;
        let (half_width, ..) = Self::section(MOUTH);
        let row = |drop: f32| -> Vec<Vec3> {
            let at = |k: u8| {
                let x = aside * (f32::from(k) / (0.5 * f32::from(TEETH_COLUMNS)) - 1.0);
                let lip = self.skin(Self::angle(x / half_width), MOUTH, -TEETH_DEPTH);
                lip.with_y(self.crown - drop * self.size)
            };
            (0..=TEETH_COLUMNS).map(at).collect()
        };
        // a tooth in each two columns, with a gap in the shade beside it; cheeks darken the hindmost
        let paint = |_: usize, column: usize| {
            let aside = (column as f32 / (0.5 * f32::from(TEETH_COLUMNS)) - 1.0).abs();
            let gap = if column.is_multiple_of(2) { TEETH_GAP } else { 1.0 };
            Paint { color: TEETH.color * gap * (1.0 - 0.6 * aside * aside), ..TEETH }
        };
        let first = builder.len();
        builder.begin(skin);
        builder.painted_grid(&[row(bottom), row(top)], false, &paint);
        builder.end(Some(Vec3::Z));
        builder.express(first, &|_, own| self.moves_of_teeth(own.position));
    }

    /// A strip of hair over an eye, following the skin.
    fn brow<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>, side: f32) {
        const PEAK: f32 = 0.62; // highest, on the way to the temple
        let half_thick = if self.sex == Sex::Male { 0.0027 } else { 0.0019 };
        let [inner, length] = BROW;
        let (half_width, ..) = Self::section(0.089);
        let strip = |edge: f32, out: f32| -> Vec<Vec3> {
            let at = |t: f32| {
                let x = side * (inner + length * t);
                let below = if t < PEAK { 0.0016 } else { 0.0038 };
                let from_peak = if t < PEAK { (t - PEAK) / PEAK } else { (t - PEAK) / (1.0 - PEAK) };
                // it begins softly, and is pointed at the temple
                let thick = half_thick * (0.62 + 1.2 * t - 1.66 * t * t);
                let drop = 0.0862 + below * from_peak * from_peak + edge * thick;
                self.skin(Self::angle(x / half_width), drop, out)
            };
            (0..8_u8).map(|k| at(f32::from(k) / 7.0)).collect()
        };
        let first = builder.len();
        builder.begin(skin);
        let [ridge, edge] = HAIR_OF_BROWS;
        let rows = [strip(1.0, 0.0008), strip(0.0, 0.0026), strip(-1.0, 0.0008)];
        builder.painted_grid(&rows, false, &|row, _| if row == 1 { ridge } else { edge });
        builder.end(Some(Vec3::Z));
        builder.express(first, &|_, own| self.moves_of_brow(own.position));
    }
}

/// Of the second level, whose face is flat: strokes where the finest one has brows and lips.
impl Skull {
    /// Whether a beard grows here.
    pub(super) fn is_low_and_in_front(&self, place: Vec3) -> bool {
        /// Under the crown (man's size), m.
        const FROM: f32 = 0.170;
        (self.crown - place.y) / self.size > FROM && place.z > 0.0
    }

    pub(super) fn brows_and_mouth<'a>(&self, builder: &mut Builder<'a>, skin: Skin<'a>) {
        /// Heights of a brow's ends under the crown, m (man's size).
        const ENDS: [f32; 2] = [0.0878, 0.0866];
        /// Of a brow, a woman's and a man's, and of the lips, m.
        const THICK: [f32; 2] = [0.0036, 0.0050];
        const LIPS_THICK: f32 = 0.0090;
        /// Of the mouth, m.
        const HALF_WIDTH: f32 = 0.0215;
        let is_man = usize::from(self.sex == Sex::Male);
        let [inner, length] = BROW;
        for side in [-1.0, 1.0] {
            let ends = [[side * inner, ENDS[0]], [side * (inner + length), ENDS[1]]];
            self.stroke(builder, skin, ends, (THICK[is_man], HAIR_OF_BROWS[0]));
        }
        let corners = [-1.0, 1.0].map(|side| [side * HALF_WIDTH, MOUTH]);
        self.stroke(builder, skin, corners, (LIPS_THICK, LIPS[is_man]));
    }

    /// A stroke from one place on the face to another, each at the side of the middle and under the crown (man's size), m.
    fn stroke<'a>(
        &self,
        builder: &mut Builder<'a>,
        skin: Skin<'a>,
        [from, to]: [[f32; 2]; 2],
        (thick, paint): (f32, Paint),
    ) {
        let half = 0.5 * thick;
        let corners = [(from, -half), (to, -half), (to, half), (from, half)];
        let corners = corners.map(|([x, drop], off)| self.face(x, drop + off, BEFORE_FACETS));
        builder.patch(&corners, Vec3::Z, paint, skin);
    }
}

/// Around the head from the middle of the face to the left: angles, and shares of the half width; 1 on its back.
fn columns() -> Vec<(f32, f32)> {
    let face = COLUMNS[1..].iter().map(|share| (Skull::angle(*share), *share));
    let half: Vec<(f32, f32)> = face.chain(BACK.map(|angle| (angle, 1.0))).collect();
    let right = half.iter().rev().map(|(angle, share)| (-angle, *share));
    std::iter::once((0.0, 0.0)).chain(half.iter().copied()).chain([(PI, 1.0)]).chain(right).collect()
}

//! Trees, hedges, beds and grass. Near by, crowns are clusters of leaves about a dark core.

use super::look::{Look, v};
use crate::scenario::place::material::SurfaceMaterial as Material;
use crate::scenario::place::mesh::{Builder, srgb};
use glam::{Vec2, Vec3};

/// Crowns have leaves up to this distance, m, and half as many beyond that one; hedges have them up to the third; grass grows up to the last.
const LEAFY: f32 = 90.0;
const LESS_LEAFY: f32 = 40.0;
const HEDGE_LEAFY: f32 = 28.0;
const GRASSY: f32 = 18.0;
/// Bunches of leaves that a crown has at most, those within it included, and how long one is, m: larger crowns have larger ones.
const MOST: f32 = 800.0;
const BUNCH: f32 = 0.34;
/// Bunches on a m² of hedge.
const HEDGE_LEAVES: f32 = 22.0;
/// How deep a crown's leaves lie over its core, as a share of its radius, and a hedge's, m.
const DEPTH: f32 = 0.2;
const HEDGE_DEPTH: f32 = 0.07;
/// Tufts of grass a m², and most of a lawn.
const TUFTS: f32 = 7.0;
const MOST_TUFTS: u32 = 2500;
/// Height of grass, m.
const BLADE: f32 = 0.09;

/// Radius of the trunk of a tree whose crown is `width` across, m.
pub(crate) fn trunk_radius(width: f32) -> f32 {
    (0.06 * width).clamp(0.12, 0.6)
}

/// Whether a tree of this number is a conifer.
const fn is_conifer(id: u32) -> bool {
    id.is_multiple_of(3)
}

pub(super) fn tree(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let leaf = look.pick(0, &[0x3f7038, 0x4f8340, 0x5c8f3a, 0x37663f, 0x7a9a3c]);
    let (r, h) = (trunk_radius(size.x), size.y);
    if look.is_fine() && look.eye.length() < LEAFY {
        leafy_tree(b, size, look, leaf);
        return;
    }
    b.of(Material::Wood).turned(Vec3::ZERO, &[(r, 0.0), (r * 0.7, h * 0.5)], 6, srgb(0x5d4632));
    b.of(Material::Foliage);
    let sides = if look.is_full() { 10 } else { 6 };
    let crown = v(size.x * 0.5, h * 0.32, size.z * 0.5);
    if is_conifer(look.id) {
        for (y, scale) in [(0.25, 1.0), (0.48, 0.76), (0.7, 0.5)] {
            let profile = [(0.0, 0.0), (crown.x * scale, 0.0), (0.0, h * 0.4 * (0.6 + 0.4 * scale))];
            b.turned(v(0.0, h * y, 0.0), &profile, sides, leaf);
        }
        return;
    }
    b.ball(v(0.0, h * 0.66, 0.0), crown, sides, leaf);
    b.ball(v(crown.x * 0.45, h * 0.56, crown.z * 0.2), crown * 0.6, sides, leaf * 0.86);
    b.ball(v(-crown.x * 0.4, h * 0.6, -crown.z * 0.35), crown * 0.62, sides, leaf * 1.12);
}

/// A tree with a rooted trunk, limbs and leaves.
#[allow(clippy::cast_precision_loss, reason = "a few limbs")]
fn leafy_tree(b: &mut Builder<'_>, size: Vec3, look: &Look, leaf: Vec3) {
    let (r, h) = (trunk_radius(size.x), size.y);
    let bark = srgb(0x5d4632);
    b.of(Material::Wood);
    let trunk = [(r * 1.5, 0.0), (r * 1.05, 0.15_f32.min(h * 0.1)), (r * 0.9, h * 0.2), (r * 0.55, h * 0.55)];
    b.turned(Vec3::ZERO, &trunk, 9, bark);
    if is_conifer(look.id) {
        conifer(b, size, look, leaf);
        return;
    }
    let half = v(size.x * 0.5, h * 0.3, size.z * 0.5);
    // the crown's balls, the whole within the tree's size
    let mut balls = vec![(v(0.0, h * 0.7, 0.0), half * v(0.78, 1.0, 0.78))];
    for limb in 0..5_u32 {
        let angle = std::f32::consts::TAU * (limb as f32 + 0.6 * look.unit(20 + limb)) / 5.0;
        let out = v(libm::sinf(angle), 0.0, libm::cosf(angle));
        let reach = 0.42 + 0.12 * look.unit(30 + limb);
        let height = h * (0.52 + 0.2 * look.unit(40 + limb));
        let center = out * half * reach + Vec3::Y * height;
        let radii = half * (0.5 + 0.14 * look.unit(50 + limb)) * v(1.0, 0.9, 1.0);
        let from = Vec3::Y * (h * (0.28 + 0.05 * limb as f32));
        b.limb(from, center, [r * 0.42, r * 0.14], bark);
        balls.push((center, radii));
    }
    b.of(Material::Foliage);
    let area: f32 = balls.iter().map(|(_, radii)| sphere(*radii)).sum();
    // as many as cover it, and so large that they do
    let most = if look.eye.length() < LESS_LEAFY { MOST } else { 0.5 * MOST };
    let length = (1.5 * area / most).sqrt().max(BUNCH);
    let leaves =
        Leaves { count: 1.5 / (length * length), length, middle: v(0.0, h * 0.62, 0.0), leaf, balls };
    for (center, radii) in &leaves.balls {
        b.ball(*center, *radii * (1.0 - DEPTH), 10, leaf * 0.6);
    }
    for number in 0..leaves.balls.len() {
        leaves_on(b, look, number, &leaves);
    }
}

/// Surface of a ball of these radii, m², roughly.
fn sphere(radii: Vec3) -> f32 {
    4.0 * std::f32::consts::PI * libm::powf(radii.x * radii.y * radii.z, 2.0 / 3.0)
}

/// The leaves of a crown.
struct Leaves {
    /// Bunches a m², and their length, m.
    count: f32,
    length: f32,
    /// Middle of the whole crown: what looks away from it is light.
    middle: Vec3,
    leaf: Vec3,
    /// Middle and radii of the balls that it is made of, m.
    balls: Vec<(Vec3, Vec3)>,
}

impl Leaves {
    /// Whether a place lies within another ball, where no leaf is seen.
    fn is_within(&self, at: Vec3, own: usize) -> bool {
        let others = self.balls.iter().enumerate().filter(|(number, _)| *number != own);
        others
            .map(|(_, ball)| ball)
            .any(|(center, radii)| ((at - *center) / *radii).length() < 1.0 - 0.5 * DEPTH)
    }
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a few hundred leaves"
)]
fn leaves_on(b: &mut Builder<'_>, look: &Look, number: usize, how: &Leaves) {
    let (center, radii) = how.balls[number];
    let count = (how.count * sphere(radii)) as u32;
    for i in 0..count {
        let draw = |what: u32| look.unit(10_000 + (number as u32 * 1024 + i) * 8 + what);
        // even over a ball: a spiral from its top to its bottom, shaken
        let up = 1.0 - 2.0 * (i as f32 + draw(0)) / count as f32;
        let angle = 2.399_963 * i as f32 + draw(1);
        let flat = (1.0 - up * up).max(0.0).sqrt();
        let out = v(flat * libm::sinf(angle), up, flat * libm::cosf(angle));
        let at = center + out * radii * (1.0 - DEPTH * 0.8 * draw(2));
        if how.is_within(at, number) {
            continue;
        }
        let shaken = v(draw(3), draw(4), draw(5)) * 1.6 - 0.8;
        let facing = (out + shaken).normalize_or(out);
        let facing = if facing.dot(out) < 0.3 { out } else { facing };
        let normal = ((at - how.middle).normalize_or(Vec3::Y) * 1.5 + facing).normalize_or(Vec3::Y);
        // light above and outside, dark within and below
        let depth = (0.62 + 0.38 * normal.y) * (0.75 + 0.4 * draw(6));
        let length = how.length * (0.75 + 0.5 * draw(7));
        b.leaf(at, [facing, normal], length, 6.3 * draw(5), how.leaf * depth * 1.2);
    }
}

/// Whorls of drooping twigs about a stem.
#[allow(clippy::cast_precision_loss, reason = "a few whorls")]
fn conifer(b: &mut Builder<'_>, size: Vec3, look: &Look, leaf: Vec3) {
    const WHORLS: u32 = 11;
    let h = size.y;
    b.turned(Vec3::Y * (h * 0.5), &[(0.05 * size.x, 0.0), (0.0, h * 0.48)], 6, srgb(0x4d3a2a));
    b.of(Material::Foliage);
    for whorl in 0..WHORLS {
        let part = whorl as f32 / WHORLS as f32;
        let (y, radius) = (h * (0.16 + 0.8 * part), 0.5 * size.x * libm::powf(1.0 - part, 0.8) + 0.1);
        let twigs = 14 - whorl.min(8);
        let inner = radius * 0.72;
        b.turned(Vec3::Y * (y - 0.1 * radius), &[(0.0, 0.0), (inner, 0.0), (0.0, 0.13 * h)], 9, leaf * 0.42);
        for twig in 0..twigs {
            let draw = |what: u32| look.unit(20_000 + (whorl * 32 + twig) * 4 + what);
            let angle = std::f32::consts::TAU * (twig as f32 + 0.8 * draw(0)) / twigs as f32;
            let out = v(libm::sinf(angle), 0.0, libm::cosf(angle));
            let aside = v(out.z, 0.0, -out.x) * (0.2 * radius + 0.07);
            let top = Vec3::Y * (y + 0.07 * h);
            let low = (y - 0.28 * radius * (0.6 + draw(2))).max(0.1);
            let tip = out * radius * (0.85 + 0.3 * draw(1)) + Vec3::Y * low;
            let waist = top.lerp(tip, 0.62);
            let shade = leaf * (0.62 + 0.4 * part) * (0.8 + 0.35 * draw(3));
            // two halves that fall to the sides
            let fall = Vec3::Y * (0.06 * radius).min(0.1);
            b.triangle([top, waist - aside - fall, tip], shade);
            b.triangle([top, tip, waist + aside - fall], shade * 1.15);
        }
    }
}

pub(super) fn hedge(b: &mut Builder<'_>, base: Vec3, size: Vec3, look: &Look) {
    let half = v(size.x * 0.5, 0.0, size.z * 0.5);
    let color = srgb(0x3d6b35);
    b.of(Material::Foliage);
    if !look.is_fine() {
        b.frustum_box(base - half, base + half + Vec3::Y * size.y, 0.96, color);
        return;
    }
    let near = look
        .eye
        .clamp(Vec2::new(base.x - half.x, base.z - half.z), Vec2::new(base.x + half.x, base.z + half.z));
    if look.eye.distance(near) > HEDGE_LEAFY {
        b.frustum_box(base - half, base + half + Vec3::Y * size.y, 0.96, color);
        return;
    }
    let core = v((half.x - HEDGE_DEPTH).max(0.02), 0.0, (half.z - HEDGE_DEPTH).max(0.02));
    let top = (size.y - HEDGE_DEPTH).max(0.5 * size.y);
    b.frustum_box(base - core, base + core + Vec3::Y * top, 0.99, color * 0.55);
    clipped_leaves(b, base, size, look, color);
}

/// Leaves over the top and the sides of a clipped box.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a few thousand leaves"
)]
fn clipped_leaves(b: &mut Builder<'_>, base: Vec3, size: Vec3, look: &Look, color: Vec3) {
    let faces = [
        (Vec3::Y, size.x, size.z, 0.5 * size.y),
        (Vec3::Z, size.x, size.y, 0.5 * size.z),
        (Vec3::NEG_Z, size.x, size.y, 0.5 * size.z),
        (Vec3::X, size.z, size.y, 0.5 * size.x),
        (Vec3::NEG_X, size.z, size.y, 0.5 * size.x),
    ];
    let middle = base + Vec3::Y * (0.5 * size.y);
    let leaf = 1.3 / HEDGE_LEAVES.sqrt();
    for (number, (out, wide, tall, depth)) in (0_u32..).zip(faces) {
        let (along, up) = if out.y > 0.5 { (Vec3::X, Vec3::Z) } else { (Vec3::Y.cross(out), Vec3::Y) };
        let count = (HEDGE_LEAVES * wide * tall).min(6000.0) as u32;
        for i in 0..count {
            let draw = |what: u32| look.unit(100_000 + (number * 8192 + i) * 8 + what);
            let place = along * ((draw(0) - 0.5) * wide) + up * ((draw(1) - 0.5) * tall);
            let at = middle + place + out * (depth - 0.7 * HEDGE_DEPTH * draw(2));
            if look.far(at) > HEDGE_LEAFY || at.y < 0.05 {
                continue;
            }
            let shaken = v(draw(3), draw(4), draw(5)) * 1.4 - 0.7;
            let facing = (out + shaken).normalize_or(out);
            let normal = (out * 1.5 + facing).normalize_or(out);
            let light = (0.55 + 0.45 * (at.y - base.y) / size.y) * (0.75 + 0.5 * draw(6));
            b.leaf(at, [facing, normal], leaf * (0.7 + 0.5 * draw(7)), 6.3 * draw(2), color * light * 1.25);
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "a few dozen flowers")]
pub(super) fn bed(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let t = 0.5_f32.min(size.x * 0.2);
    let grass = look.pick(0, &[0x76a34e, 0x6b9848, 0x83ab55]);
    let inner = [size.x - 2.0 * t, size.z - 2.0 * t];
    b.of(Material::Grass).sheet(v(0.0, 0.1, 0.0), inner[0], inner[1], grass);
    for side in [-0.5, 0.5] {
        hedge(b, v(0.0, 0.0, side * (size.z - t)), v(size.x, size.y, t), look);
        hedge(b, v(side * (size.x - t), 0.0, 0.0), v(t, size.y, size.z - 2.0 * t), look);
    }
    b.of(Material::Plain);
    let color = look.pick(1, &[0xd64d6b, 0xf2c14e, 0xf7f3ee, 0x9a5fb5, 0xe8763a]);
    let flowers = if look.is_full() { 24 } else { 0 };
    let is_near = look.is_fine() && look.eye.length() < 2.0 * GRASSY;
    for i in 0..if is_near { 3 * flowers } else { flowers } {
        let place = |draw: u32| look.unit(100 + 2 * i + draw) - 0.5;
        let at = v(place(0) * (size.x - 3.0 * t), 0.11, place(1) * (size.z - 3.0 * t));
        let color = color * (0.8 + 0.4 * (i % 3) as f32 / 2.0);
        if is_near {
            flower(b, at, color, look.unit(400 + i));
        } else {
            b.turned(at, &[(0.05, 0.0), (0.2, 0.28), (0.0, 0.4)], 5, color);
        }
    }
    if look.is_fine() {
        tufts(b, inner, 0.1, grass * 0.9, look);
    }
}

/// A blossom of five petals on a stem with two leaves.
fn flower(b: &mut Builder<'_>, at: Vec3, color: Vec3, draw: f32) {
    let (tall, stem) = (0.22 + 0.14 * draw, srgb(0x4f7d35));
    let top = at + Vec3::Y * tall;
    b.turned(at, &[(0.012, 0.0), (0.0, tall)], 3, stem);
    for side in 0..2_u8 {
        let angle = 6.3 * draw + 2.6 * f32::from(side);
        let out = v(libm::sinf(angle), 0.5, libm::cosf(angle));
        let facing = v(-out.x, 1.6, -out.z).normalize_or(Vec3::Y);
        b.leaf(at + out * 0.08, [facing, facing], 0.09, angle, stem * 1.2);
    }
    for petal in 0..5_u8 {
        let angle = 6.3 * draw + std::f32::consts::TAU * f32::from(petal) / 5.0;
        let out = v(libm::sinf(angle), 0.0, libm::cosf(angle));
        let aside = v(out.z, 0.0, -out.x);
        let (inner, outer) = (top + out * 0.01, top + out * 0.11 + Vec3::Y * 0.04);
        b.quad([inner, outer - out * 0.04 - aside * 0.05, outer, outer - out * 0.04 + aside * 0.05], color);
    }
    b.turned(top, &[(0.022, 0.0), (0.0, 0.03)], 5, srgb(0xe0b23c));
}

/// Tufts of grass on a rectangle (x, z) at a height, where they are near enough to be seen.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "a few thousand tufts"
)]
pub(super) fn tufts(b: &mut Builder<'_>, [wide, deep]: [f32; 2], height: f32, color: Vec3, look: &Look) {
    let half = Vec2::new(wide, deep) * 0.5;
    let low = (look.eye - GRASSY).max(-half);
    let room = (look.eye + GRASSY).min(half) - low;
    if room.min_element() <= 0.0 {
        return;
    }
    b.of(Material::Plain);
    let count = (TUFTS * room.x * room.y).min(MOST_TUFTS as f32) as u32;
    for i in 0..count {
        let draw = |what: u32| look.unit(200_000 + i * 8 + what);
        let place = low + room * Vec2::new(draw(0), draw(1));
        let at = v(place.x, height, place.y);
        let off = look.far(at);
        // thinner with the distance, so that no edge is seen
        if off > GRASSY * (0.35 + 0.65 * draw(2)) {
            continue;
        }
        let shade = color * (0.75 + 0.6 * draw(3));
        for blade in 0..5_u8 {
            let angle = 6.3 * draw(4) + 1.257 * f32::from(blade);
            let out = v(libm::sinf(angle), 0.0, libm::cosf(angle));
            let aside = v(out.z, 0.0, -out.x) * 0.014;
            let tip = at + out * (0.05 + 0.06 * draw(5)) + Vec3::Y * (BLADE * (0.6 + 0.4 * draw(6)));
            let base = at + out * 0.012;
            b.blade([base - aside, base + aside, tip], shade);
        }
    }
}

//! The outpost of another world: domes, columns, panelled walls, a pad to land on.

use super::ground::{GLOW, PAINT, PAINT_ABOVE, PAVED};
use super::look::{Look, count, v};
use crate::scenario::place::material::SurfaceMaterial as Material;
use crate::scenario::place::mesh::{Builder, srgb};
use glam::Vec3;

pub(super) fn landing_pad(b: &mut Builder<'_>, size: Vec3) {
    let r = size.x * 0.5;
    b.on(PAINT).of(Material::Paint).disc(v(0.0, 0.0, 0.0), r, 48, srgb(0x5b6575));
    b.on(PAINT_ABOVE).ring(v(0.0, 0.0, 0.0), r * 0.94, r, 48, GLOW);
    b.on(PAINT_ABOVE).ring(v(0.0, 0.0, 0.0), r * 0.55, r * 0.62, 48, v(1.8, 0.7, 0.15));
    b.on(PAVED).sheet(v(0.0, 0.0, 0.0), r * 0.12, r * 0.6, v(1.8, 0.7, 0.15));
    b.on(PAVED).sheet(v(-r * 0.2, 0.0, 0.0), r * 0.12, r * 0.6, v(1.8, 0.7, 0.15));
    b.on(PAVED).sheet(v(r * 0.2, 0.0, 0.0), r * 0.12, r * 0.6, v(1.8, 0.7, 0.15));
}

/// Height of a dome's upright foot, and of its glowing band, shares of the whole.
const FOOT: f32 = 0.28;
const BAND: f32 = 0.06;

#[allow(clippy::cast_precision_loss, reason = "a few rings")]
pub(super) fn pod(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let (r, h) = (size.x * 0.5, size.y);
    let (shell, glow) = (srgb(0xe6ebf0), [GLOW, v(1.7, 0.5, 1.5), v(1.8, 0.9, 0.2)][(look.id % 3) as usize]);
    let [sides, rings] = if look.is_fine() {
        [48, 12]
    } else if look.is_full() {
        [28, 7]
    } else {
        [12, 4]
    };
    b.of(Material::Lacquer).turned(Vec3::ZERO, &[(r, 0.0), (r, h * FOOT)], sides, shell);
    b.turned(v(0.0, h * FOOT, 0.0), &[(r * 0.97, 0.0), (r * 0.97, h * BAND)], sides, glow);
    let profile: Vec<(f32, f32)> = (0..=rings)
        .map(|i| {
            let angle = std::f32::consts::FRAC_PI_2 * i as f32 / rings as f32;
            let radius = if i == rings { 0.0 } else { r * libm::cosf(angle) };
            (radius, h * (FOOT + BAND) + h * (1.0 - FOOT - BAND) * libm::sinf(angle))
        })
        .collect();
    b.turned(Vec3::ZERO, &profile, sides, shell);
    b.of(Material::Plain);
    // Door and round windows.
    b.block(v(0.0, 0.0, r * 0.94), v(1.5, 2.3, r * 0.14), srgb(0x2b3442));
    b.block(v(0.0, 2.3, r * 0.94), v(1.7, 0.14, r * 0.16), glow);
    if !look.is_full() {
        return;
    }
    if look.is_fine() {
        porch(b, r, glow);
    }
    for i in 1..8_u8 {
        let angle = std::f32::consts::TAU * f32::from(i) / 8.0;
        if look.is_fine() {
            let around = &mut b.aside(angle);
            porthole(around, r, h);
            seams(&mut around.aside(std::f32::consts::PI / 8.0), &profile, r, h);
            continue;
        }
        let at = v(libm::sinf(angle) * r * 0.93, h * 0.55, libm::cosf(angle) * r * 0.93) * v(0.9, 1.0, 0.9);
        b.ball(at, v(0.55, 0.55, 0.55), 8, srgb(0x2f4d6b));
    }
}

/// Jambs, two leaves with a lit joint, and lights beside a pod's door.
fn porch(b: &mut Builder<'_>, r: f32, glow: Vec3) {
    let z = 1.01 * r;
    let metal = srgb(0x8b95a6);
    for side in [-1.0_f32, 1.0] {
        b.block(v(side * 0.82, 0.0, 0.94 * r), v(0.16, 2.44, 0.16 * r), metal);
        b.of(Material::Panel).cuboid(
            v(0.37 * side - 0.35, 0.03, z - 0.02),
            v(0.37 * side + 0.35, 2.26, z + 0.02),
            srgb(0x46525f),
        );
        b.of(Material::Pane).rect(
            [0.37 * side - 0.2, 0.37 * side + 0.2],
            [1.35, 1.95],
            z + 0.024,
            srgb(0x1d3347),
        );
        b.of(Material::Plain).rect(
            [side * 0.82 - 0.03, side * 0.82 + 0.03],
            [0.9, 1.9],
            1.0 * r + 0.025 * r,
            glow,
        );
    }
    b.rect([-0.015, 0.015], [0.05, 2.24], z + 0.022, glow * 0.7);
    b.cuboid(v(-0.9, 0.0, 0.98 * r), v(0.9, 0.015, 1.02 * r), metal * 0.8);
}

/// A round window in a rim, where +z of the frame leaves the dome.
fn porthole(b: &mut Builder<'_>, r: f32, h: f32) {
    // where the shell is at this height
    let sine = ((0.55 - FOOT - BAND) / (1.0 - FOOT - BAND)).clamp(0.0, 1.0);
    let out = r * (1.0 - sine * sine).sqrt();
    let (center, radius) = (v(0.0, 0.55 * h, 0.0), 0.42);
    let normal =
        v(0.0, sine * r / (h * (1.0 - FOOT - BAND)), (1.0 - sine * sine).sqrt()).normalize_or(Vec3::Z);
    let middle = center + Vec3::Z * out;
    b.of(Material::Plain).limb_capped(
        middle - normal * 0.2,
        middle + normal * 0.12,
        [0.56, 0.52],
        18,
        srgb(0x7d8896),
    );
    b.of(Material::Pane).limb_capped(middle, middle + normal * 0.135, [radius, radius], 18, srgb(0x17293a));
}

/// A rib over the dome along +z of the frame.
fn seams(b: &mut Builder<'_>, profile: &[(f32, f32)], r: f32, h: f32) {
    const HALF: f32 = 0.07;
    let grey = srgb(0xb4bcc6);
    b.of(Material::Panel).cuboid(v(-HALF, 0.0, 0.9 * r), v(HALF, h * FOOT, r + 0.03), grey);
    for pair in profile.windows(2) {
        let ((r0, y0), (r1, y1)) = (pair[0], pair[1]);
        let out = |radius: f32, y: f32, x: f32| v(x, y + 0.02, radius + 0.03);
        let narrow = (r1 / r).max(0.15);
        let corners =
            [out(r0, y0, -HALF), out(r0, y0, HALF), out(r1, y1, HALF * narrow), out(r1, y1, -HALF * narrow)];
        b.quad(corners, grey);
    }
}

pub(super) fn column(b: &mut Builder<'_>, size: Vec3) {
    let (r, h) = (size.x * 0.5, size.y);
    let shell = srgb(0x7c8798);
    b.turned(Vec3::ZERO, &[(r, 0.0), (r, 0.3), (r * 0.6, 0.5), (r * 0.5, h * 0.8), (r * 1.4, h)], 12, shell);
    for y in [0.35, 0.55] {
        b.turned(v(0.0, h * y, 0.0), &[(r * 0.7, 0.0), (r * 0.7, 0.18)], 12, GLOW);
    }
}

#[allow(clippy::cast_precision_loss, reason = "a few panels")]
pub(super) fn wall(b: &mut Builder<'_>, size: Vec3) {
    b.block(Vec3::ZERO, size, srgb(0x566074));
    b.block(v(0.0, size.y * 0.6, 0.0), v(size.x * 0.98, 0.25, size.z + 0.1), GLOW);
    let ribs = count(size.x, 4.0, 12);
    for i in 0..=ribs {
        let x = (i as f32 / ribs as f32 - 0.5) * size.x;
        b.block(v(x, 0.0, 0.0), v(0.4, size.y + 0.3, size.z + 0.3), srgb(0x8b95a6));
    }
}

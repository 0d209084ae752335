//! Parked cars, facing +z.

use super::look::{Look, v};
use crate::scenario::place::material::SurfaceMaterial as Material;
use crate::scenario::place::mesh::{Builder, srgb};
use glam::Vec3;

pub(super) const PAINTS: [u32; 8] =
    [0xb3282d, 0x1f4e8c, 0xd9d9d6, 0x2b2d31, 0x8c9299, 0x3e6b4b, 0xe0c04a, 0x5a2a3c];
const RUBBER: u32 = 0x0017_181a;
const GLASS: u32 = 0x0022_303c;
const PLATE: u32 = 0x00e8_e6d8;
/// Radius of a wheel, and how much more its arch has, m.
const WHEEL: f32 = 0.32;
const ARCH: f32 = 0.045;

pub(super) fn car(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    // its wheels and lights have sizes of their own
    if look.is_fine() && size.y > 1.0 && size.z > 2.5 {
        shaped(b, size, look);
    } else {
        blocks(b, size, look);
    }
}

fn blocks(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let (w, h, l) = (size.x, size.y, size.z);
    let paint = look.pick(0, &PAINTS);
    b.of(Material::Lacquer).block(v(0.0, 0.28, 0.0), v(w, h * 0.38, l), paint);
    let cabin =
        |y0: f32, y1: f32, grow: f32| (v(-w * 0.44 - grow, y0, -l * 0.36), v(w * 0.44 + grow, y1, l * 0.2));
    let roof = 0.28 + h * 0.38;
    let (low, high) = cabin(roof, h - 0.06, 0.0);
    b.frustum_box(low, high, 0.78, srgb(GLASS));
    b.block(v(0.0, h - 0.07, -l * 0.08), v(w * 0.66, 0.07, l * 0.42), paint);
    if !look.is_full() {
        return;
    }
    b.of(Material::Plain);
    for z in [-0.31, 0.31] {
        for x in [-0.43, 0.43] {
            b.wheel(v(x * w, WHEEL, z * l), WHEEL, 0.24, 10, srgb(RUBBER));
            b.wheel(v(x * w * 1.02, WHEEL, z * l), 0.17, 0.24, 8, srgb(0xb8bcc0));
        }
    }
    for x in [-0.36, 0.36] {
        b.block(v(x * w, 0.55, l * 0.5), v(w * 0.2, 0.14, 0.04), v(1.3, 1.3, 1.1));
        b.block(v(x * w, 0.58, -l * 0.5), v(w * 0.18, 0.14, 0.04), v(0.9, 0.03, 0.03));
    }
    b.block(v(0.0, 0.3, l * 0.5), v(w * 0.9, 0.16, 0.1), srgb(0x2a2c2f));
    b.block(v(0.0, 0.3, -l * 0.5), v(w * 0.9, 0.16, 0.1), srgb(0x2a2c2f));
}

/// A cross-section of a body: where along it, half its width at the waist, lowest and highest point, shares of the car's size but
/// for the lowest, m.
type Station = [f32; 4];

/// From the tail to the nose.
const BODY: [Station; 9] = [
    [-0.50, 0.40, 0.36, 0.50],
    [-0.485, 0.46, 0.26, 0.62],
    [-0.44, 0.485, 0.22, 0.67],
    [-0.30, 0.50, 0.20, 0.66],
    [0.10, 0.50, 0.20, 0.64],
    [0.24, 0.50, 0.20, 0.63],
    [0.40, 0.485, 0.22, 0.58],
    [0.475, 0.45, 0.26, 0.51],
    [0.50, 0.39, 0.34, 0.42],
];
/// Of the cabin: along, half the width below and above, height above the waist as a share of all there is.
const CABIN: [[f32; 4]; 5] = [
    [-0.42, 0.42, 0.40, 0.05],
    [-0.27, 0.455, 0.345, 0.94],
    [-0.08, 0.46, 0.35, 1.0],
    [0.06, 0.46, 0.345, 0.95],
    [0.27, 0.43, 0.41, 0.04],
];

/// A body lofted over stations, with a glazed cabin, pillars, lights and wheels in arches.
fn shaped(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let paint = look.pick(0, &PAINTS);
    b.of(Material::Lacquer);
    let ring = |station: &Station| {
        let [along, half, low, high] = *station;
        let (z, x, y) = (along * size.z, half * size.x, high * size.y);
        let waist = low + 0.62 * (y - low);
        let side =
            [(0.86 * x, low), (0.99 * x, low + 0.12), (x, waist), (0.93 * x, y - 0.025), (0.78 * x, y)];
        let right = side.iter().map(|(x, y)| v(*x, *y, z));
        let left = side.iter().rev().map(|(x, y)| v(-*x, *y, z));
        right.chain(left).collect::<Vec<_>>()
    };
    let rings: Vec<Vec<Vec3>> = BODY.iter().map(ring).collect();
    b.loft(&rings, paint);
    cabin(b, size, paint);
    trim(b, size, paint, look);
    b.of(Material::Plain);
    for z in [-0.3, 0.31] {
        for side in [-1.0_f32, 1.0] {
            let at = v(side * 0.44 * size.x, WHEEL, z * size.z);
            if look.is_far {
                b.wheel(at, WHEEL, 0.128 * size.x, 10, srgb(RUBBER));
                b.wheel(at + Vec3::X * (side * 0.018), 0.2, 0.128 * size.x, 6, srgb(0xa9adb2));
                continue;
            }
            b.wheel(at + Vec3::Y * ARCH, WHEEL + ARCH, 0.128 * size.x, 18, srgb(0x0b0b0c));
            b.wheel(at + Vec3::X * (side * 0.012), WHEEL, 0.128 * size.x, 18, srgb(RUBBER));
            b.wheel(at + Vec3::X * (side * 0.018), 0.2, 0.128 * size.x, 14, srgb(0xa9adb2));
            b.wheel(at + Vec3::X * (side * 0.024), 0.06, 0.128 * size.x, 8, srgb(0x4a4d50));
        }
    }
}

fn cabin(b: &mut Builder<'_>, size: Vec3, paint: Vec3) {
    let waist = 0.63 * size.y;
    let at = |[along, below, above, height]: [f32; 4], grow: f32| {
        let top = waist + (size.y - waist) * height + grow;
        let z = along * size.z;
        [v((below + grow) * size.x, waist, z), v((above + grow) * size.x, top, z)]
    };
    let mirror = |p: Vec3| v(-p.x, p.y, p.z);
    for pair in CABIN.windows(2) {
        let ([low0, high0], [low1, high1]) = (at(pair[0], 0.0), at(pair[1], 0.0));
        let is_roof = pair[0][3] > 0.5 && pair[1][3] > 0.5;
        b.of(Material::Pane);
        b.quad([low1, low0, high0, high1], srgb(GLASS));
        b.quad([low0, low1, high1, high0].map(mirror), srgb(GLASS));
        let lid = [high1, high0, mirror(high0), mirror(high1)];
        if is_roof {
            b.of(Material::Lacquer);
        }
        b.quad(lid, if is_roof { paint } else { srgb(0x2c3c49) });
        // pillars and the frame of the roof, a little outside of the glass
        let ([low0, high0], [low1, high1]) = (at(pair[0], 0.004), at(pair[1], 0.004));
        b.of(Material::Lacquer);
        let slim = |from: Vec3, to: Vec3, share: f32| from.lerp(to, share);
        let (a, c) = (slim(high0, low0, 0.12), slim(high1, low1, 0.12));
        b.quad([c, a, high0, high1], paint);
        b.quad([a, c, high1, high0].map(mirror), paint);
        if pair[1][0] < 0.2 {
            let (d, e) = (slim(low1, low0, 0.12), slim(high1, high0, 0.12));
            b.quad([low1, d, e, high1], paint * 0.9);
            b.quad([d, low1, high1, e].map(mirror), paint * 0.9);
        }
    }
}

/// Lights, bumpers, plates, mirrors, handles; from afar lights and bumpers.
fn trim(b: &mut Builder<'_>, size: Vec3, paint: Vec3, look: &Look) {
    let (w, h, l) = (size.x, size.y, size.z);
    b.of(Material::Plain);
    for side in [-1.0_f32, 1.0] {
        let x = side * w;
        b.block(v(0.27 * x, 0.33 * h, 0.5 * l - 0.03), v(0.17 * w, 0.1, 0.1), v(0.95, 0.95, 0.9));
        b.block(v(0.35 * x, 0.47 * h, -0.487 * l), v(0.17 * w, 0.1, 0.1), v(0.55, 0.02, 0.02));
        if look.is_far {
            continue;
        }
        b.block(v(0.53 * x, 0.66 * h, 0.16 * l), v(0.09 * w, 0.11, 0.1), paint * 0.9);
        b.block(v(0.497 * x, 0.53 * h, -0.02 * l), v(0.02, 0.03, 0.16), paint * 0.6);
        // the joint of the doors
        for z in [-0.2, -0.02, 0.16] {
            b.block(v(0.4985 * x, 0.3, z * l - 0.14), v(0.008, 0.3 * h, 0.012), paint * 0.3);
        }
        b.block(v(0.488 * x, 0.2, 0.0), v(0.03, 0.07, 0.42 * l), srgb(0x1e2022));
    }
    for z in [0.5, -0.5] {
        b.block(v(0.0, 0.27, z * l * 0.975), v(0.7 * w, 0.12, 0.1), srgb(0x232528));
    }
    if look.is_far {
        return;
    }
    for z in [0.5, -0.5] {
        b.block(v(0.0, 0.36, z * l * 0.992), v(0.5, 0.11, 0.03), srgb(PLATE));
    }
    b.block(v(0.0, 0.33 * h, 0.5 * l - 0.02), v(0.32 * w, 0.08, 0.06), srgb(0x15171a));
}

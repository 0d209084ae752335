//! What lies flat: pavements, markings, lawns, strips.

use super::look::{Detail, Look, count, v};
use super::plants;
use crate::scenario::place::material::SurfaceMaterial as Material;
use crate::scenario::place::mesh::{Builder, srgb};
use glam::Vec3;

/// Layer of the ground, below all others.
pub(crate) const GROUND: u8 = 4;
pub(super) const PAINT: u8 = 3;
pub(super) const PAINT_ABOVE: u8 = 2;
pub(super) const PAVED: u8 = 1;
/// Of what glows.
pub(super) const GLOW: Vec3 = v(0.15, 1.6, 1.9);

/// A pavement of at least this height has kerbs that are seen; what is lower lies flush.
const RAISED: f32 = 0.05;
/// Width of a kerb, and length of its stones, m.
const KERB: f32 = 0.15;
const STONE: f32 = 1.0;
/// Stones one by one up to this distance, m.
const NEAR: f32 = 30.0;

pub(super) fn pavement(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let (w, d) = (size.x - 2.0 * KERB, size.z - 2.0 * KERB);
    if w <= 0.0 || d <= 0.0 {
        b.on(PAVED).of(Material::Paving).sheet(v(0.0, 0.0, 0.0), size.x, size.z, srgb(0xb9b6ae));
        return;
    }
    if look.is_fine() && size.y >= RAISED {
        b.of(Material::Paving).sheet(v(0.0, size.y, 0.0), w, d, srgb(0xaeaaa0));
    } else {
        b.on(PAVED).of(Material::Paving).sheet(v(0.0, 0.0, 0.0), w, d, srgb(0xaeaaa0));
    }
    let kerb = srgb(0xd5d2ca);
    if look.is_fine() {
        for side in 0..4_u8 {
            let (long, deep) = if side % 2 == 0 { (size.x, size.z) } else { (size.z, size.x) };
            kerb_stones(&mut b.side(side), long, 0.5 * deep, size.y, &look.seen_at(side));
        }
        return;
    }
    let (x, z) = ((size.x - KERB) * 0.5, (size.z - KERB) * 0.5);
    b.on(PAVED).of(Material::Plain).sheet(v(-x, 0.0, 0.0), KERB, size.z, kerb);
    b.on(PAVED).sheet(v(x, 0.0, 0.0), KERB, size.z, kerb);
    b.on(PAVED).sheet(v(0.0, 0.0, -z), w, KERB, kerb);
    b.on(PAVED).sheet(v(0.0, 0.0, z), w, KERB, kerb);
}

/// A row of stones along the edge at `z`, each of its own grey.
#[allow(clippy::cast_precision_loss, reason = "a few hundred stones")]
fn kerb_stones(b: &mut Builder<'_>, long: f32, z: f32, height: f32, look: &Look) {
    let is_raised = height >= RAISED;
    let place = v(look.eye.x.clamp(-0.5 * long, 0.5 * long), 0.0, z);
    let stones = if look.far(place) < NEAR { count(long, STONE, 200) } else { 1 };
    let kerb = srgb(0xcfccc3);
    for i in 0..stones {
        let at = |i: u32| (i as f32 / stones as f32 - 0.5) * long;
        let joint = if stones > 1 { 0.006 } else { 0.0 };
        let (x0, x1) = (at(i) + joint, at(i + 1) - joint);
        let stone = kerb * (0.9 + 0.2 * look.unit(300 + i));
        let middle = v(0.5 * (x0 + x1), 0.0, z - 0.5 * KERB);
        if is_raised {
            b.on(0).of(Material::Plaster);
            b.sheet(middle + Vec3::Y * height, x1 - x0, KERB, stone);
            b.rect_shaded([x0, x1], [0.0, height], z, [stone * 0.55, stone * 0.9]);
        } else {
            b.on(PAVED).of(Material::Plain).sheet(middle, x1 - x0, KERB, stone);
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "a few hundred stripes")]
pub(super) fn zebra(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let stripes = if look.detail == Detail::Box { 8 } else { count(size.x, 1.1, 200) };
    let pitch = size.x / stripes as f32;
    // Height tells the two diagonals of a scramble crossing apart where they cross.
    let layer = if size.y > 0.015 { PAINT_ABOVE } else { PAINT };
    for i in 0..stripes {
        let x = (i as f32 + 0.5) * pitch - size.x * 0.5;
        b.on(layer).of(Material::Paint).sheet(v(x, 0.0, 0.0), pitch * 0.55, size.z, srgb(0xeeeee8));
    }
}

pub(super) fn line(b: &mut Builder<'_>, size: Vec3) {
    b.on(PAINT).of(Material::Paint).sheet(v(0.0, 0.0, 0.0), size.x, size.z, srgb(0xe8e8e0));
}

pub(super) fn strip(b: &mut Builder<'_>, size: Vec3) {
    b.on(PAINT_ABOVE).sheet(v(0.0, 0.0, 0.0), size.x, size.z, GLOW);
}

pub(super) fn lawn(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    b.on(PAINT).of(Material::Grass).sheet(v(0.0, 0.0, 0.0), size.x, size.z, srgb(0x6f9a4b));
    if look.is_fine() {
        plants::tufts(b.on(0), [size.x, size.z], 0.0, srgb(0x5f8a3c), look);
    }
}

//! What stands in streets and gardens: lamps, traffic lights, benches, fountains.

use super::look::{Look, v};
use crate::scenario::place::material::SurfaceMaterial as Material;
use crate::scenario::place::mesh::{Builder, srgb};
use glam::Vec3;

pub(super) fn lamp(b: &mut Builder<'_>, size: Vec3) {
    let (post, h) = (srgb(0x3c4248), size.y);
    b.turned(Vec3::ZERO, &[(0.14, 0.0), (0.12, 0.5), (0.06, 0.6), (0.05, h)], 8, post);
    b.block(v(0.0, h, 0.5), v(0.08, 0.08, 1.1), post);
    b.of(Material::LitPane).block(v(0.0, h - 0.1, 0.95), v(0.28, 0.1, 0.6), srgb(0xd6d0be));
}

pub(super) fn traffic_light(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let (post, h) = (srgb(0x2e3236), size.y);
    b.turned(Vec3::ZERO, &[(0.12, 0.0), (0.07, 0.3), (0.06, h - 1.0)], 8, post);
    b.block(v(0.0, h - 1.0, 0.0), v(0.36, 1.0, 0.3), srgb(0x1c1e20));
    let lit = look.id % 2;
    let lights = [
        (0.72, v(1.8, 0.1, 0.08), lit == 0),
        (0.42, v(1.7, 1.0, 0.05), false),
        (0.12, v(0.1, 1.7, 0.4), lit == 1),
    ];
    for (y, color, on) in lights {
        let color = if on { color } else { color * 0.12 };
        let y = h - 1.0 + y;
        if look.is_fine() {
            b.dial(v(0.0, y + 0.1, 0.152), 0.11, 14, color);
            visor(b, v(0.0, y + 0.1, 0.15), 0.13);
        } else {
            b.block(v(0.0, y, 0.16), v(0.2, 0.2, 0.04), color);
        }
    }
    b.block(v(0.0, 2.1, 0.12), v(0.26, 0.5, 0.16), srgb(0x1c1e20));
    b.block(
        v(0.0, 2.2, 0.21),
        v(0.14, 0.2, 0.03),
        if lit == 0 { v(0.1, 1.6, 0.4) } else { v(1.7, 0.1, 0.08) },
    );
}

/// The hood over a light that faces +z.
fn visor(b: &mut Builder<'_>, center: Vec3, radius: f32) {
    const OUT: f32 = 0.16;
    let at = |i: u8, z: f32| {
        let angle = std::f32::consts::PI * f32::from(i) / 6.0;
        center + v(radius * libm::cosf(angle), radius * libm::sinf(angle), z)
    };
    for i in 0..6_u8 {
        b.quad([at(i, 0.0), at(i + 1, 0.0), at(i + 1, OUT), at(i, OUT)], srgb(0x1c1e20));
        b.quad([at(i, OUT), at(i + 1, OUT), at(i + 1, 0.0), at(i, 0.0)], srgb(0x101214));
    }
}

pub(super) fn bench(b: &mut Builder<'_>, size: Vec3) {
    let (wood, iron) = (srgb(0x8a5a33), srgb(0x34383c));
    b.of(Material::Wood);
    for i in 0..3_u8 {
        let z = size.z * (f32::from(i) - 0.8) * 0.28;
        b.block(v(0.0, 0.42, z), v(size.x, 0.05, size.z * 0.22), wood);
    }
    for y in [0.55, 0.72] {
        b.block(v(0.0, y, -size.z * 0.42), v(size.x, 0.12, 0.05), wood);
    }
    b.of(Material::Plain);
    for side in [-0.42, 0.42] {
        b.block(v(side * size.x, 0.0, 0.0), v(0.08, 0.42, size.z * 0.9), iron);
        b.block(v(side * size.x, 0.42, -size.z * 0.46), v(0.06, 0.45, 0.04), iron);
    }
}

pub(super) fn fountain(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let (r, stone, water) = (size.x * 0.5, srgb(0xc9c3b6), srgb(0x5aa7c7));
    let sides = if look.is_fine() { 48 } else { 24 };
    b.turned(Vec3::ZERO, &[(r, 0.0), (r, 0.5), (r * 0.88, 0.5)], sides, stone);
    b.of(Material::Water).disc(v(0.0, 0.51, 0.0), r * 0.87, sides, water);
    b.of(Material::Plain);
    b.turned(v(0.0, 0.5, 0.0), &[(r * 0.2, 0.0), (r * 0.12, 0.8), (r * 0.5, 1.0), (r * 0.5, 1.1)], 16, stone);
    b.of(Material::Water).disc(v(0.0, 1.62, 0.0), r * 0.47, 16, water);
    b.of(Material::Plain);
    b.turned(v(0.0, 1.6, 0.0), &[(r * 0.1, 0.0), (r * 0.06, 0.6), (r * 0.2, 0.7)], 12, stone);
    if look.is_fine() {
        let rim = b.of(Material::Plaster);
        rim.ring(v(0.0, 0.56, 0.0), r * 0.86, r * 1.04, sides, stone * 1.08);
        rim.turned_wall(v(0.0, 0.44, 0.0), r * 1.04, 0.12, sides, stone);
        rim.turned_wall(v(0.0, 0.0, 0.0), r * 1.03, 0.12, sides, stone * 0.9);
        jets(b, r, size.y);
        return;
    }
    b.turned(v(0.0, 2.3, 0.0), &[(0.03, 0.0), (0.1, size.y - 2.3), (0.0, size.y - 2.0)], 8, srgb(0xcfeaf5));
    for i in 0..10_u8 {
        let angle = std::f32::consts::TAU * f32::from(i) / 10.0;
        let at = v(libm::sinf(angle), 0.0, libm::cosf(angle)) * r * 0.5 + Vec3::Y * 0.5;
        b.turned(at, &[(0.06, 0.0), (0.03, 1.1)], 4, srgb(0xcfeaf5));
    }
}

/// Water that rises in the middle and falls in arcs from the bowl into the basin.
fn jets(b: &mut Builder<'_>, r: f32, tall: f32) {
    const ARCS: u8 = 20;
    const STEPS: u8 = 7;
    let foam = srgb(0xd9edf5);
    let spout = (tall - 2.3).max(0.1);
    b.of(Material::Water);
    b.turned(v(0.0, 2.3, 0.0), &[(0.015, 0.0), (0.028, 0.5 * spout), (0.0, spout)], 8, foam);
    for i in 0..ARCS {
        let angle = std::f32::consts::TAU * f32::from(i) / f32::from(ARCS);
        let out = v(libm::sinf(angle), 0.0, libm::cosf(angle));
        let low = i % 2 == 0;
        // from the rim of the bowl, or from the middle above it
        let (from, reach, rise, drop) =
            if low { (0.5 * r, 0.3 * r, 0.05, 1.1) } else { (0.06 * r, 0.42 * r, 0.4, 0.75) };
        let start = if low { 1.62 } else { 2.32 };
        let at = |step: u8| {
            let t = f32::from(step) / f32::from(STEPS);
            out * (from + reach * t) + Vec3::Y * (start + rise * 4.0 * t * (1.0 - t) - drop * t * t)
        };
        for step in 0..STEPS {
            let radius = |step: u8| 0.006 + 0.009 * f32::from(step) / f32::from(STEPS);
            b.limb(at(step), at(step + 1), [radius(step), radius(step + 1)], foam);
        }
    }
}

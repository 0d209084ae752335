//! How each prop is drawn. Flat things lie in layers, see [`EnvironmentMesh::layers`]: none flickers through another.

use super::material::SurfaceMaterial as Material;
use super::mesh::{Builder, EnvironmentMesh, srgb};
use crate::scenario::file::{Prop, PropKind};
use crate::scenario::random::{Purpose, index, unit};
use glam::Vec3;

/// Layer of the ground, below all others.
pub(crate) const GROUND: u8 = 4;
const PAINT: u8 = 3;
const PAINT_ABOVE: u8 = 2;
const PAVED: u8 = 1;

/// How finely a prop is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Detail {
    Full,
    Some,
    Box,
}

/// Radius of the trunk of a tree whose crown is `width` across, m.
pub(crate) fn trunk_radius(width: f32) -> f32 {
    (0.06 * width).clamp(0.12, 0.6)
}

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A colour out of a list, by the prop's index.
fn pick(id: u32, draw: u32, colors: &[u32]) -> Vec3 {
    srgb(colors[index(0, id, Purpose::Scenery, draw, colors.len())])
}

/// Whole number of things of length `pitch` in `length`, at least 1, at most `most`.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a small range")]
fn count(length: f32, pitch: f32, most: u32) -> u32 {
    (length / pitch).round().clamp(1.0, 1000.0).min(f32::from(u16::try_from(most).unwrap_or(1000))) as u32
}

/// Draws a prop; `id` picks its looks.
pub(crate) fn draw(mesh: &mut EnvironmentMesh, prop: &Prop, id: u32, detail: Detail) {
    let [x, z] = prop.position;
    let mut b = Builder::new(mesh, v(x, 0.0, z), prop.heading_deg.to_radians());
    let size = Vec3::from(prop.size);
    match prop.kind {
        PropKind::Pavement => pavement(&mut b, size),
        PropKind::Zebra => zebra(&mut b, size, detail),
        PropKind::Line => {
            b.on(PAINT).of(Material::Paint).sheet(v(0.0, 0.0, 0.0), size.x, size.z, srgb(0xe8e8e0));
        }
        PropKind::Lawn => {
            b.on(PAINT).of(Material::Grass).sheet(v(0.0, 0.0, 0.0), size.x, size.z, srgb(0x6f9a4b));
        }
        PropKind::Strip => b.on(PAINT_ABOVE).sheet(v(0.0, 0.0, 0.0), size.x, size.z, v(0.15, 1.6, 1.9)),
        PropKind::LandingPad => landing_pad(&mut b, size),
        _ if detail == Detail::Box => far(&mut b, prop.kind, size, id),
        PropKind::Building => building(&mut b, size, id, detail),
        PropKind::Store => store(&mut b, size, id, detail),
        PropKind::Lamp => lamp(&mut b, size),
        PropKind::TrafficLight => traffic_light(&mut b, size, id),
        PropKind::Tree => tree(&mut b, size, id, detail),
        PropKind::Hedge => hedge(&mut b, v(0.0, 0.0, 0.0), size),
        PropKind::Bed => bed(&mut b, size, id, detail),
        PropKind::Bench => bench(&mut b, size),
        PropKind::Fountain => fountain(&mut b, size),
        PropKind::Car => car(&mut b, size, id, detail),
        PropKind::Pod => pod(&mut b, size, id, detail),
        PropKind::Column => column(&mut b, size),
        PropKind::Wall => wall(&mut b, size),
        PropKind::Box => b.block(Vec3::ZERO, size, srgb(0x9a9a98)),
    }
}

/// A plain box in the thing's main colour, for the distance.
fn far(b: &mut Builder<'_>, kind: PropKind, size: Vec3, id: u32) {
    let color = match kind {
        PropKind::Building => pick(id, 0, &WALLS),
        PropKind::Store => srgb(0xd8d2c4),
        PropKind::Tree | PropKind::Hedge => srgb(0x3f7038),
        PropKind::Bed => srgb(0x5d8a45),
        PropKind::Car => pick(id, 0, &PAINTS),
        PropKind::Pod => srgb(0xe6ebf0),
        PropKind::Wall => srgb(0x566074),
        _ => srgb(0x8a8f98),
    };
    b.of(match kind {
        PropKind::Building | PropKind::Store => Material::Plaster,
        PropKind::Tree | PropKind::Hedge | PropKind::Bed => Material::Foliage,
        PropKind::Car | PropKind::Pod => Material::Lacquer,
        _ => Material::Plain,
    });
    match kind {
        PropKind::Tree => b.block(v(0.0, size.y * 0.3, 0.0), size * v(0.8, 0.7, 0.8), color),
        PropKind::Lamp | PropKind::TrafficLight => b.block(Vec3::ZERO, v(0.12, size.y, 0.12), color),
        PropKind::Pod => b.turned(Vec3::ZERO, &[(size.x * 0.5, 0.0), (size.x * 0.3, size.y)], 6, color),
        _ => b.block(Vec3::ZERO, size, color),
    }
}

fn pavement(b: &mut Builder<'_>, size: Vec3) {
    const KERB: f32 = 0.15;
    let (w, d) = (size.x - 2.0 * KERB, size.z - 2.0 * KERB);
    if w <= 0.0 || d <= 0.0 {
        b.on(PAVED).of(Material::Paving).sheet(v(0.0, 0.0, 0.0), size.x, size.z, srgb(0xb9b6ae));
        return;
    }
    b.on(PAVED).of(Material::Paving).sheet(v(0.0, 0.0, 0.0), w, d, srgb(0xaeaaa0));
    let kerb = srgb(0xd5d2ca);
    let (x, z) = ((size.x - KERB) * 0.5, (size.z - KERB) * 0.5);
    b.on(PAVED).of(Material::Plain).sheet(v(-x, 0.0, 0.0), KERB, size.z, kerb);
    b.on(PAVED).sheet(v(x, 0.0, 0.0), KERB, size.z, kerb);
    b.on(PAVED).sheet(v(0.0, 0.0, -z), w, KERB, kerb);
    b.on(PAVED).sheet(v(0.0, 0.0, z), w, KERB, kerb);
}

#[allow(clippy::cast_precision_loss, reason = "a few hundred stripes")]
fn zebra(b: &mut Builder<'_>, size: Vec3, detail: Detail) {
    let stripes = if detail == Detail::Box { 8 } else { count(size.x, 1.1, 200) };
    let pitch = size.x / stripes as f32;
    // Height tells the two diagonals of a scramble crossing apart where they cross.
    let layer = if size.y > 0.015 { PAINT_ABOVE } else { PAINT };
    for i in 0..stripes {
        let x = (i as f32 + 0.5) * pitch - size.x * 0.5;
        b.on(layer).of(Material::Paint).sheet(v(x, 0.0, 0.0), pitch * 0.55, size.z, srgb(0xeeeee8));
    }
}

fn landing_pad(b: &mut Builder<'_>, size: Vec3) {
    let r = size.x * 0.5;
    b.on(PAINT).of(Material::Paint).disc(v(0.0, 0.0, 0.0), r, 48, srgb(0x5b6575));
    b.on(PAINT_ABOVE).ring(v(0.0, 0.0, 0.0), r * 0.94, r, 48, v(0.15, 1.6, 1.9));
    b.on(PAINT_ABOVE).ring(v(0.0, 0.0, 0.0), r * 0.55, r * 0.62, 48, v(1.8, 0.7, 0.15));
    b.on(PAVED).sheet(v(0.0, 0.0, 0.0), r * 0.12, r * 0.6, v(1.8, 0.7, 0.15));
    b.on(PAVED).sheet(v(-r * 0.2, 0.0, 0.0), r * 0.12, r * 0.6, v(1.8, 0.7, 0.15));
    b.on(PAVED).sheet(v(r * 0.2, 0.0, 0.0), r * 0.12, r * 0.6, v(1.8, 0.7, 0.15));
}

const WALLS: [u32; 7] = [0xb9a58c, 0x9c5f48, 0x8d99a6, 0xc9c2b2, 0x6f7d8c, 0xa88a6a, 0xd0b89a];
/// What those walls are made of.
const WALLS_OF: [Material; 7] = [
    Material::Plaster,
    Material::Brick,
    Material::Panel,
    Material::Plaster,
    Material::Panel,
    Material::Brick,
    Material::Plaster,
];
const PAINTS: [u32; 8] = [0xb3282d, 0x1f4e8c, 0xd9d9d6, 0x2b2d31, 0x8c9299, 0x3e6b4b, 0xe0c04a, 0x5a2a3c];
const SIGNS: [u32; 6] = [0xd7263d, 0x1b998b, 0xf4a259, 0x2e86ab, 0xf6d55c, 0x7b4b94];

#[allow(clippy::cast_precision_loss, reason = "a few dozen storeys and windows")]
fn building(b: &mut Builder<'_>, size: Vec3, id: u32, detail: Detail) {
    let (wall, glass) = (pick(id, 0, &WALLS), srgb(0x35506b));
    let made = WALLS_OF[index(0, id, Purpose::Scenery, 0, WALLS.len())];
    b.of(made).block(Vec3::ZERO, size, wall);
    b.of(Material::Glass);
    let ground_floor = 4.0_f32.min(size.y * 0.5);
    let floors = count(size.y - ground_floor - 0.8, 3.2, if detail == Detail::Full { 14 } else { 4 });
    let pitch = (size.y - ground_floor - 0.8) / floors as f32;
    for floor in 0..floors {
        let y = ground_floor + (floor as f32 + 0.3) * pitch;
        b.block(v(0.0, y, 0.0), v(size.x + 0.08, pitch * 0.5, size.z + 0.08), glass);
    }
    // Shop windows between piers, a coloured fascia, and an awning over the pavement on every side.
    b.block(v(0.0, 0.6, 0.0), v(size.x + 0.1, ground_floor * 0.55, size.z + 0.1), srgb(0x8fb2c4));
    b.of(Material::Plain);
    b.block(v(0.0, ground_floor * 0.76, 0.0), v(size.x + 0.3, 0.7, size.z + 0.3), pick(id, 1, &SIGNS));
    b.block(v(0.0, size.y, 0.0), v(size.x * 0.4, 2.0, size.z * 0.4), srgb(0x77787a));
    if detail != Detail::Full {
        return;
    }
    b.of(made);
    for (along, across, turned) in [(size.x, size.z, false), (size.z, size.x, true)] {
        let piers = count(along, 4.0, 12);
        for i in 0..=piers {
            let t = (i as f32 / piers as f32 - 0.5) * along;
            for side in [-0.5, 0.5] {
                let base = if turned { v(across * side, 0.0, t) } else { v(t, 0.0, across * side) };
                b.block(base, v(0.45, size.y, 0.45), wall * 0.9);
            }
        }
    }
    b.block(v(0.0, size.y, 0.0), v(size.x + 0.5, 0.5, size.z + 0.5), wall * 0.8);
}

#[allow(clippy::cast_precision_loss, reason = "a few mullions")]
fn store(b: &mut Builder<'_>, size: Vec3, id: u32, detail: Detail) {
    let front = size.z * 0.5;
    b.of(Material::Plaster).block(Vec3::ZERO, size, srgb(0xd8d2c4));
    b.of(Material::Glass).block(v(0.0, 0.3, front), v(size.x * 0.9, size.y * 0.52, 0.1), srgb(0x7fa9bd));
    b.of(Material::Plain);
    let sign = pick(id, 1, &SIGNS);
    b.block(v(0.0, size.y * 0.68, front), v(size.x * 0.96, size.y * 0.26, 0.4), sign);
    b.block(v(0.0, size.y * 0.62, front + 0.6), v(size.x * 0.92, 0.12, 1.4), sign * 0.7);
    if detail != Detail::Full {
        return;
    }
    let mullions = count(size.x, 2.0, 16);
    for i in 0..=mullions {
        let x = (i as f32 / mullions as f32 - 0.5) * size.x * 0.9;
        b.block(v(x, 0.0, front + 0.06), v(0.12, size.y * 0.6, 0.12), srgb(0x40444a));
    }
    b.block(v(0.0, 0.0, front + 0.08), v(2.2, size.y * 0.5, 0.1), srgb(0x23384a));
    // Lettering, as far as a low-polygon sign can say it.
    for i in 0..7_u32 {
        let x = (i as f32 - 3.0) * size.x * 0.07;
        let tall = 0.3 + 0.4 * unit(0, id, Purpose::Scenery, 10 + i);
        b.block(
            v(x, size.y * 0.75, front + 0.21),
            v(size.x * 0.04, size.y * 0.18 * tall, 0.06),
            srgb(0xffffff),
        );
    }
}

fn lamp(b: &mut Builder<'_>, size: Vec3) {
    let (post, h) = (srgb(0x3c4248), size.y);
    b.turned(Vec3::ZERO, &[(0.14, 0.0), (0.12, 0.5), (0.06, 0.6), (0.05, h)], 8, post);
    b.block(v(0.0, h, 0.5), v(0.08, 0.08, 1.1), post);
    b.block(v(0.0, h - 0.1, 0.95), v(0.28, 0.1, 0.6), v(1.8, 1.6, 1.1));
}

fn traffic_light(b: &mut Builder<'_>, size: Vec3, id: u32) {
    let (post, h) = (srgb(0x2e3236), size.y);
    b.turned(Vec3::ZERO, &[(0.12, 0.0), (0.07, 0.3), (0.06, h - 1.0)], 8, post);
    b.block(v(0.0, h - 1.0, 0.0), v(0.36, 1.0, 0.3), srgb(0x1c1e20));
    let lit = id % 2;
    let lights = [
        (0.72, v(1.8, 0.1, 0.08), lit == 0),
        (0.42, v(1.7, 1.0, 0.05), false),
        (0.12, v(0.1, 1.7, 0.4), lit == 1),
    ];
    for (y, color, on) in lights {
        let color = if on { color } else { color * 0.12 };
        b.block(v(0.0, h - 1.0 + y, 0.16), v(0.2, 0.2, 0.04), color);
    }
    b.block(v(0.0, 2.1, 0.12), v(0.26, 0.5, 0.16), srgb(0x1c1e20));
    b.block(
        v(0.0, 2.2, 0.21),
        v(0.14, 0.2, 0.03),
        if lit == 0 { v(0.1, 1.6, 0.4) } else { v(1.7, 0.1, 0.08) },
    );
}

fn tree(b: &mut Builder<'_>, size: Vec3, id: u32, detail: Detail) {
    let leaf = pick(id, 0, &[0x3f7038, 0x4f8340, 0x5c8f3a, 0x37663f, 0x7a9a3c]);
    let (r, h) = (trunk_radius(size.x), size.y);
    b.of(Material::Wood).turned(Vec3::ZERO, &[(r, 0.0), (r * 0.7, h * 0.5)], 6, srgb(0x5d4632));
    b.of(Material::Foliage);
    let sides = if detail == Detail::Full { 10 } else { 6 };
    let crown = v(size.x * 0.5, h * 0.32, size.z * 0.5);
    if id.is_multiple_of(3) {
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

fn hedge(b: &mut Builder<'_>, base: Vec3, size: Vec3) {
    let half = v(size.x * 0.5, 0.0, size.z * 0.5);
    b.of(Material::Foliage).frustum_box(base - half, base + half + Vec3::Y * size.y, 0.96, srgb(0x3d6b35));
}

#[allow(clippy::cast_precision_loss, reason = "a few dozen flowers")]
fn bed(b: &mut Builder<'_>, size: Vec3, id: u32, detail: Detail) {
    let t = 0.5_f32.min(size.x * 0.2);
    b.of(Material::Grass).sheet(
        v(0.0, 0.1, 0.0),
        size.x - 2.0 * t,
        size.z - 2.0 * t,
        pick(id, 0, &[0x76a34e, 0x6b9848, 0x83ab55]),
    );
    for side in [-0.5, 0.5] {
        hedge(b, v(0.0, 0.0, side * (size.z - t)), v(size.x, size.y, t));
        hedge(b, v(side * (size.x - t), 0.0, 0.0), v(t, size.y, size.z - 2.0 * t));
    }
    b.of(Material::Plain);
    let flowers = if detail == Detail::Full { 24 } else { 0 };
    let color = pick(id, 1, &[0xd64d6b, 0xf2c14e, 0xf7f3ee, 0x9a5fb5, 0xe8763a]);
    for i in 0..flowers {
        let place = |draw: u32| unit(0, id, Purpose::Scenery, 100 + 2 * i + draw) - 0.5;
        let at = v(place(0) * (size.x - 3.0 * t), 0.11, place(1) * (size.z - 3.0 * t));
        b.turned(at, &[(0.05, 0.0), (0.2, 0.28), (0.0, 0.4)], 5, color * (0.8 + 0.4 * (i % 3) as f32 / 2.0));
    }
}

fn bench(b: &mut Builder<'_>, size: Vec3) {
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

fn fountain(b: &mut Builder<'_>, size: Vec3) {
    let (r, stone, water) = (size.x * 0.5, srgb(0xc9c3b6), srgb(0x5aa7c7));
    b.turned(Vec3::ZERO, &[(r, 0.0), (r, 0.5), (r * 0.88, 0.5)], 24, stone);
    b.of(Material::Water).disc(v(0.0, 0.51, 0.0), r * 0.87, 24, water);
    b.of(Material::Plain);
    b.turned(v(0.0, 0.5, 0.0), &[(r * 0.2, 0.0), (r * 0.12, 0.8), (r * 0.5, 1.0), (r * 0.5, 1.1)], 16, stone);
    b.of(Material::Water).disc(v(0.0, 1.62, 0.0), r * 0.47, 16, water);
    b.of(Material::Plain);
    b.turned(v(0.0, 1.6, 0.0), &[(r * 0.1, 0.0), (r * 0.06, 0.6), (r * 0.2, 0.7)], 12, stone);
    b.turned(v(0.0, 2.3, 0.0), &[(0.03, 0.0), (0.1, size.y - 2.3), (0.0, size.y - 2.0)], 8, srgb(0xcfeaf5));
    for i in 0..10_u8 {
        let angle = std::f32::consts::TAU * f32::from(i) / 10.0;
        let at = v(libm::sinf(angle), 0.0, libm::cosf(angle)) * r * 0.5 + Vec3::Y * 0.5;
        b.turned(at, &[(0.06, 0.0), (0.03, 1.1)], 4, srgb(0xcfeaf5));
    }
}

fn car(b: &mut Builder<'_>, size: Vec3, id: u32, detail: Detail) {
    let (w, h, l) = (size.x, size.y, size.z);
    let paint = pick(id, 0, &PAINTS);
    b.of(Material::Lacquer).block(v(0.0, 0.28, 0.0), v(w, h * 0.38, l), paint);
    let cabin =
        |y0: f32, y1: f32, grow: f32| (v(-w * 0.44 - grow, y0, -l * 0.36), v(w * 0.44 + grow, y1, l * 0.2));
    let roof = 0.28 + h * 0.38;
    let (low, high) = cabin(roof, h - 0.06, 0.0);
    b.frustum_box(low, high, 0.78, srgb(0x22303c));
    b.block(v(0.0, h - 0.07, -l * 0.08), v(w * 0.66, 0.07, l * 0.42), paint);
    if detail != Detail::Full {
        return;
    }
    b.of(Material::Plain);
    for z in [-0.31, 0.31] {
        for x in [-0.43, 0.43] {
            b.wheel(v(x * w, 0.32, z * l), 0.32, 0.24, 10, srgb(0x17181a));
            b.wheel(v(x * w * 1.02, 0.32, z * l), 0.17, 0.24, 8, srgb(0xb8bcc0));
        }
    }
    for x in [-0.36, 0.36] {
        b.block(v(x * w, 0.55, l * 0.5), v(w * 0.2, 0.14, 0.04), v(1.3, 1.3, 1.1));
        b.block(v(x * w, 0.58, -l * 0.5), v(w * 0.18, 0.14, 0.04), v(0.9, 0.03, 0.03));
    }
    b.block(v(0.0, 0.3, l * 0.5), v(w * 0.9, 0.16, 0.1), srgb(0x2a2c2f));
    b.block(v(0.0, 0.3, -l * 0.5), v(w * 0.9, 0.16, 0.1), srgb(0x2a2c2f));
}

#[allow(clippy::cast_precision_loss, reason = "a few rings")]
fn pod(b: &mut Builder<'_>, size: Vec3, id: u32, detail: Detail) {
    let (r, h) = (size.x * 0.5, size.y);
    let (shell, glow) =
        (srgb(0xe6ebf0), [v(0.15, 1.6, 1.9), v(1.7, 0.5, 1.5), v(1.8, 0.9, 0.2)][(id % 3) as usize]);
    let sides = if detail == Detail::Full { 28 } else { 12 };
    b.of(Material::Lacquer).turned(Vec3::ZERO, &[(r, 0.0), (r, h * 0.28)], sides, shell);
    b.turned(v(0.0, h * 0.28, 0.0), &[(r * 0.97, 0.0), (r * 0.97, h * 0.06)], sides, glow);
    let rings: u32 = if detail == Detail::Full { 7 } else { 4 };
    let profile: Vec<(f32, f32)> = (0..=rings)
        .map(|i| {
            let angle = std::f32::consts::FRAC_PI_2 * i as f32 / rings as f32;
            (if i == rings { 0.0 } else { r * libm::cosf(angle) }, h * 0.34 + h * 0.66 * libm::sinf(angle))
        })
        .collect();
    b.turned(Vec3::ZERO, &profile, sides, shell);
    b.of(Material::Plain);
    // Door and round windows.
    b.block(v(0.0, 0.0, r * 0.94), v(1.5, 2.3, r * 0.14), srgb(0x2b3442));
    b.block(v(0.0, 2.3, r * 0.94), v(1.7, 0.14, r * 0.16), glow);
    if detail != Detail::Full {
        return;
    }
    for i in 1..8_u8 {
        let angle = std::f32::consts::TAU * f32::from(i) / 8.0;
        let at = v(libm::sinf(angle) * r * 0.93, h * 0.55, libm::cosf(angle) * r * 0.93) * v(0.9, 1.0, 0.9);
        b.ball(at, v(0.55, 0.55, 0.55), 8, srgb(0x2f4d6b));
    }
}

fn column(b: &mut Builder<'_>, size: Vec3) {
    let (r, h) = (size.x * 0.5, size.y);
    let shell = srgb(0x7c8798);
    b.turned(Vec3::ZERO, &[(r, 0.0), (r, 0.3), (r * 0.6, 0.5), (r * 0.5, h * 0.8), (r * 1.4, h)], 12, shell);
    for y in [0.35, 0.55] {
        b.turned(v(0.0, h * y, 0.0), &[(r * 0.7, 0.0), (r * 0.7, 0.18)], 12, v(0.15, 1.6, 1.9));
    }
}

#[allow(clippy::cast_precision_loss, reason = "a few panels")]
fn wall(b: &mut Builder<'_>, size: Vec3) {
    b.block(Vec3::ZERO, size, srgb(0x566074));
    b.block(v(0.0, size.y * 0.6, 0.0), v(size.x * 0.98, 0.25, size.z + 0.1), v(0.15, 1.6, 1.9));
    let ribs = count(size.x, 4.0, 12);
    for i in 0..=ribs {
        let x = (i as f32 / ribs as f32 - 0.5) * size.x;
        b.block(v(x, 0.0, 0.0), v(0.4, size.y + 0.3, size.z + 0.3), srgb(0x8b95a6));
    }
}

//! Shops: on the ground floor of houses, and stores of their own.

use super::letters;
use super::look::{Look, count, v};
use crate::scenario::place::material::SurfaceMaterial as Material;
use crate::scenario::place::mesh::{Builder, srgb};
use glam::Vec3;

pub(super) const SIGNS: [u32; 6] = [0xd7263d, 0x1b998b, 0xf4a259, 0x2e86ab, 0xf6d55c, 0x7b4b94];
const NAMES: [&str; 14] = [
    "CAFE", "BOOKS", "BAKERY", "FLOWERS", "HOTEL", "SHOES", "MUSIC", "PHARMACY", "TAILOR", "GRILL", "CINEMA",
    "TOYS", "OPTICIAN", "BIKES",
];
const STORES: [&str; 8] = ["MARKET", "HARDWARE", "BAKERY", "SHOES", "BOOKS", "GARDEN", "TOYS", "PHARMACY"];
/// Colour of a store's walls.
pub(super) const WALL: u32 = 0x00d8_d2c4;
/// Where the sign over shops begins, as a share of the ground floor's height.
pub(super) const FASCIA: f32 = 0.76;
/// Shops are drawn with doors, letters and awnings up to this distance, m.
const NEAR: f32 = 60.0;
/// How far shop windows and doors are set back, m.
const WINDOW_DEPTH: f32 = 0.18;
const DOOR_DEPTH: f32 = 0.45;
/// Width of a shop window's panes, and of the bars between them, m.
const PANE: f32 = 1.7;
const BAR: f32 = 0.07;
/// How far an awning stands out, m, and how far it falls.
const AWNING: [f32; 2] = [1.1, 0.5];
/// Width of its stripes, m.
const STRIPE: f32 = 0.35;

/// The ground floor of one side of a house, which faces +z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Front {
    pub(super) wide: f32,
    /// Where it is, m.
    pub(super) z: f32,
    /// Its height, m.
    pub(super) tall: f32,
    /// Colour of the house's walls.
    pub(super) wall: Vec3,
}

/// One shop: from and to, m, and its number.
#[derive(Debug, Clone, Copy)]
struct Shop {
    x: [f32; 2],
    number: u32,
}

impl Shop {
    const fn draw(self, what: u32) -> u32 {
        200 + self.number * 16 + what
    }
}

/// Draws shops side by side along the foot of a house.
#[allow(clippy::cast_precision_loss, reason = "a few shops")]
pub(super) fn ground_floor(b: &mut Builder<'_>, front: &Front, look: &Look, side: u32) {
    let shops = count(front.wide, 7.0, 12);
    let pitch = front.wide / shops as f32;
    let stone = front.wall * 0.8;
    for number in 0..shops {
        let from = number as f32 * pitch - 0.5 * front.wide;
        shop(b, front, look, Shop { x: [from, from + pitch], number: side * 16 + number });
    }
    // piers between shops, a course above
    b.of(Material::Plaster);
    for number in 0..=shops {
        let x = (number as f32 * pitch - 0.5 * front.wide)
            .clamp(0.25 - 0.5 * front.wide, 0.5 * front.wide - 0.25);
        b.cuboid(v(x - 0.25, 0.0, front.z - 0.2), v(x + 0.25, front.tall, front.z + 0.14), stone);
        if !look.is_far {
            b.cuboid(v(x - 0.3, 0.0, front.z - 0.2), v(x + 0.3, 0.35, front.z + 0.19), stone * 0.85);
        }
    }
    let half = 0.5 * front.wide;
    b.cuboid(
        v(-half, front.tall - 0.12, front.z - 0.2),
        v(half, front.tall + 0.12, front.z + 0.2),
        stone * 1.1,
    );
}

fn shop(b: &mut Builder<'_>, front: &Front, look: &Look, shop: Shop) {
    let [x0, x1] = [shop.x[0] + 0.25, shop.x[1] - 0.25];
    let (z, low) = (front.z, front.tall * FASCIA);
    let sign = look.pick(shop.draw(0), &SIGNS);
    // what is above the sign, and the sign
    b.of(Material::Plaster).rect([x0, x1], [low, front.tall], z - 0.02, srgb(0x8a857b));
    b.of(Material::Plain).cuboid(v(x0, low, z - 0.1), v(x1, low + 0.62, z + 0.1), sign * 0.8);
    b.cuboid(v(x0, low + 0.62, z - 0.1), v(x1, low + 0.7, z + 0.16), sign * 0.55);
    // a door at one end, windows beside it
    let is_left = look.unit(shop.draw(1)) < 0.5;
    let room = (x1 - x0).min(1.5);
    let (door, glass) =
        if is_left { ([x0, x0 + room], [x0 + room, x1]) } else { ([x1 - room, x1], [x0, x1 - room]) };
    let wood = [srgb(0x2f3b38), srgb(0x4a2f26), srgb(0x2b3140), srgb(0x5b5348)][look.index(shop.draw(2), 4)];
    if look.is_far {
        flat_window(b, glass, [0.0, low], z, wood);
        flat_window(b, door, [0.0, low], z, wood);
    } else {
        window(b, glass, [0.0, low], z, wood);
        entrance(b, door, low, z, wood);
    }
    if look.far(v(0.5 * (x0 + x1), 0.0, z)) > NEAR {
        return;
    }
    let name = NAMES[look.index(shop.draw(3), NAMES.len())];
    let middle = v(0.5 * (x0 + x1), low + 0.31, z + 0.104);
    b.of(Material::Plain);
    letters::write(b, name, middle, 0.4, 0.8 * (x1 - x0), srgb(0xf4f0e4));
    if look.unit(shop.draw(4)) < 0.6 && glass[1] - glass[0] > 1.0 {
        awning(b, look, glass, low, z + 0.1, sign);
    }
    if look.unit(shop.draw(5)) < 0.5 {
        hanging_sign(b, look, if is_left { x1 - 0.2 } else { x0 + 0.2 }, front, sign);
    }
}

/// A shop window: a plinth, panes between bars, a row of small panes above.
#[allow(clippy::cast_precision_loss, reason = "a few bars")]
fn window(b: &mut Builder<'_>, x: [f32; 2], y: [f32; 2], z: f32, wood: Vec3) {
    let (inner, plinth, transom) = (z - WINDOW_DEPTH, y[0] + 0.5, y[1] - 0.55);
    b.of(Material::Plain).rect(x, [y[0], plinth], z - 0.04, wood);
    b.rect([x[0] + 0.12, x[1] - 0.12], [y[0] + 0.12, plinth - 0.1], z - 0.03, wood * 0.8);
    b.recess(x, [plinth, y[1]], [z - 0.04, inner], wood);
    let (dark, light) = (srgb(0x4c6674), srgb(0x7f9fae));
    b.of(Material::LitPane).rect_shaded(x, [plinth, transom], inner, [light, dark]);
    b.rect_shaded(x, [transom, y[1]], inner, [dark, dark * 0.5]);
    b.of(Material::Plain);
    let bars = count(x[1] - x[0], PANE, 8);
    for bar in 0..=bars {
        let at = x[0] + (x[1] - x[0] - BAR) * bar as f32 / bars as f32;
        b.cuboid(v(at, plinth, inner), v(at + BAR, y[1], inner + 0.08), wood);
    }
    b.cuboid(v(x[0], transom, inner), v(x[1], transom + 0.08, inner + 0.08), wood);
}

/// What a shop window or a door looks like from afar: a plinth, panes between bars. What is in front comes first.
#[allow(clippy::cast_precision_loss, reason = "a few bars")]
fn flat_window(b: &mut Builder<'_>, x: [f32; 2], y: [f32; 2], z: f32, wood: Vec3) {
    let (plinth, transom) = (y[0] + 0.5, y[1] - 0.55);
    let (dark, light) = (srgb(0x4c6674), srgb(0x7f9fae));
    let pane = [x[0] + BAR, x[1] - BAR];
    let bars = count(x[1] - x[0], PANE, 8);
    b.of(Material::Plain);
    for bar in 1..bars {
        let at = x[0] + (x[1] - x[0] - BAR) * bar as f32 / bars as f32;
        b.rect([at, at + BAR], [plinth, y[1]], z - 0.02, wood);
    }
    b.of(Material::LitPane).rect_shaded(pane, [plinth, transom], z - 0.03, [light, dark]);
    b.rect_shaded(pane, [transom + 0.08, y[1]], z - 0.03, [dark, dark * 0.5]);
    b.of(Material::Plain).rect(x, y, z - 0.04, wood);
}

/// A door set back between reveals, with a pane and a handle; another pane above it.
fn entrance(b: &mut Builder<'_>, x: [f32; 2], top: f32, z: f32, wood: Vec3) {
    let inner = z - DOOR_DEPTH;
    let leaf = 2.25_f32.min(top - 0.3);
    b.of(Material::Plain).recess(x, [0.0, top], [z - 0.04, inner], wood * 0.9);
    let (x0, x1) = (x[0] + 0.15, x[1] - 0.15);
    b.rect(x, [0.0, top], inner, wood * 0.7);
    b.cuboid(v(x0, 0.04, inner), v(x1, leaf, inner + 0.05), wood);
    let glass = [srgb(0x3a5260), srgb(0x2a3c48)];
    b.of(Material::LitPane).rect_shaded([x0 + 0.14, x1 - 0.14], [0.75, leaf - 0.14], inner + 0.055, glass);
    b.rect_shaded([x0, x1], [leaf + 0.1, top - 0.1], inner + 0.02, [glass[1], glass[1] * 0.6]);
    b.of(Material::Plain);
    b.cuboid(v(x1 - 0.11, 0.95, inner + 0.05), v(x1 - 0.07, 1.35, inner + 0.11), srgb(0xc9b27a));
}

/// Striped cloth over a window.
#[allow(clippy::cast_precision_loss, reason = "a few stripes")]
fn awning(b: &mut Builder<'_>, look: &Look, x: [f32; 2], y: f32, z: f32, color: Vec3) {
    let [out, fall] = AWNING;
    let (high, low, front) = (y + 0.02, y + 0.02 - fall, z + out);
    let stripes = count(x[1] - x[0], STRIPE, 60);
    let at = |i: u32| x[0] + (x[1] - x[0]) * i as f32 / stripes as f32;
    b.of(Material::Plain);
    for i in 0..stripes {
        let (from, to) = (at(i), at(i + 1));
        let cloth = if i % 2 == 0 { color } else { srgb(0xf0ebe0) };
        b.quad([v(from, low, front), v(to, low, front), v(to, high, z), v(from, high, z)], cloth);
        // the border that hangs down; and what is seen from below, without the sun
        b.rect([from, to], [low - 0.18, low], front, cloth * 0.9);
        if look.is_far {
            continue;
        }
        b.quad(
            [
                v(from, high - 0.01, z),
                v(to, high - 0.01, z),
                v(to, low, front - 0.01),
                v(from, low, front - 0.01),
            ],
            cloth * 0.5,
        );
    }
    for (edge, flip) in [(x[0], true), (x[1], false)] {
        let mut corners = [v(edge, high, z), v(edge, low, front), v(edge, low, z)];
        if flip {
            corners.reverse();
        }
        // a sheet, seen from both sides
        b.triangle(corners, color * 0.7);
        corners.reverse();
        b.triangle(corners, color * 0.45);
    }
}

/// A board across the pavement, on an arm.
fn hanging_sign(b: &mut Builder<'_>, look: &Look, x: f32, front: &Front, color: Vec3) {
    let (y, z) = (front.tall + 0.25, front.z + 0.2);
    b.of(Material::Plain);
    b.cuboid(v(x - 0.03, y, z + 0.1), v(x + 0.03, y + 0.66, z + 0.7), color * 0.7);
    b.cuboid(v(x - 0.04, y + 0.15, z + 0.22), v(x + 0.04, y + 0.51, z + 0.58), srgb(0xf0ebe0));
    if look.is_far {
        return;
    }
    b.cuboid(v(x - 0.02, y + 0.72, z - 0.2), v(x + 0.02, y + 0.76, z + 0.75), srgb(0x26292c));
}

/// A store: a low house with a glass front and a sign, which faces +z.
#[allow(clippy::cast_precision_loss, reason = "a few mullions")]
pub(super) fn store(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let front = size.z * 0.5;
    let sign = look.pick(1, &SIGNS);
    if look.is_fine() && size.x > 5.0 && size.y > 3.4 {
        fine_store(b, size, look, sign);
        return;
    }
    b.of(Material::Plaster).block(Vec3::ZERO, size, srgb(WALL));
    b.of(Material::Glass).block(v(0.0, 0.3, front), v(size.x * 0.9, size.y * 0.52, 0.1), srgb(0x7fa9bd));
    b.of(Material::Plain);
    b.block(v(0.0, size.y * 0.68, front), v(size.x * 0.96, size.y * 0.26, 0.4), sign);
    b.block(v(0.0, size.y * 0.62, front + 0.6), v(size.x * 0.92, 0.12, 1.4), sign * 0.7);
    if !look.is_full() {
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
        let tall = 0.3 + 0.4 * look.unit(10 + i);
        b.block(
            v(x, size.y * 0.75, front + 0.21),
            v(size.x * 0.04, size.y * 0.18 * tall, 0.06),
            srgb(0xffffff),
        );
    }
}

/// A store with its windows set back under a canopy, an entrance in the middle, letters and a parapet.
fn fine_store(b: &mut Builder<'_>, size: Vec3, look: &Look, sign: Vec3) {
    const BACK: f32 = 0.7;
    let (half, front, head) = (0.5 * size.x, 0.5 * size.z, 0.62 * size.y);
    let (wall, metal) = (srgb(WALL), srgb(0x40444a));
    b.of(Material::Plaster);
    b.cuboid(v(-half, 0.0, -front), v(half, size.y, front - BACK), wall);
    b.cuboid(v(-half, head, front - BACK), v(half, size.y, front), wall);
    for x in [-half, half - 0.5] {
        b.cuboid(v(x, 0.0, front - BACK), v(x + 0.5, head, front + 0.05), wall * 0.92);
    }
    let inner = front - BACK + 0.02;
    let glass = [-half + 0.5, half - 0.5];
    let door = 1.3_f32.min(0.2 * size.x);
    for x in [[glass[0], -door], [door, glass[1]]] {
        window(b, x, [0.0, head], inner + WINDOW_DEPTH, metal);
    }
    // two leaves that slide
    b.of(Material::LitPane).rect_shaded(
        [-door, door],
        [0.05, head - 0.5],
        inner + 0.02,
        [srgb(0x5b7886), srgb(0x31444f)],
    );
    b.of(Material::Plain).rect([-door, door], [head - 0.5, head], inner + 0.03, metal);
    for x in [-door - 0.08, -0.04, door] {
        b.cuboid(v(x, 0.0, inner), v(x + 0.08, head, inner + 0.1), metal);
    }
    // canopy on posts, sign, letters
    b.cuboid(v(-half, head, front), v(half, head + 0.16, front + 1.3), sign * 0.6);
    for x in [-half + 0.3, half - 0.4] {
        b.cuboid(v(x, 0.0, front + 1.1), v(x + 0.1, head, front + 1.2), metal);
    }
    let board = [head + 0.3, size.y - 0.25];
    b.cuboid(v(-0.46 * size.x, board[0], front - 0.05), v(0.46 * size.x, board[1], front + 0.18), sign);
    let name = STORES[look.index(5, STORES.len())];
    let middle = v(0.0, 0.5 * (board[0] + board[1]), front + 0.185);
    letters::write(b, name, middle, 0.62 * (board[1] - board[0]), 0.7 * size.x, srgb(0xffffff));
    b.of(Material::Plaster);
    b.block(v(0.0, size.y, 0.0), v(size.x + 0.06, 0.25, size.z + 0.12), wall * 0.75);
    b.of(Material::Plain);
    b.block(v(0.2 * size.x, size.y + 0.25, -0.1 * size.z), v(1.8, 1.1, 1.4), srgb(0x9aa0a3));
    b.block(v(-0.25 * size.x, size.y + 0.25, 0.1 * size.z), v(1.2, 0.8, 1.2), srgb(0x9aa0a3));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::place::EnvironmentMesh;

    #[test]
    fn every_name_on_a_sign_has_letters_that_face_the_street_and_keep_their_room() {
        for name in NAMES.iter().chain(&STORES) {
            assert!(letters::has(name), "{name}");
            let mut mesh = EnvironmentMesh::default();
            letters::write(
                &mut Builder::new(&mut mesh, Vec3::ZERO, 0.0),
                name,
                Vec3::ZERO,
                0.6,
                2.0,
                Vec3::ONE,
            );
            assert!(mesh.normals.iter().all(|normal| normal.z > 0.999), "{name}");
            let reach = mesh.positions.iter().fold(Vec3::ZERO, |most, p| most.max(p.abs()));
            // half a stroke stands out
            assert!(reach.x > 0.4 && reach.x < 1.1 && reach.y > 0.1 && reach.y < 0.4, "{name} {reach}");
        }
        assert!(!letters::has("JAZZ"));
    }
}

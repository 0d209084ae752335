//! Houses: walls with windows in reveals, shops on the ground floor, eaves.

use super::look::{Look, count, v};
use super::shops::{self, Front};
use crate::scenario::place::material::SurfaceMaterial as Material;
use crate::scenario::place::mesh::{Builder, srgb};
use glam::{Vec2, Vec3};

pub(super) const WALLS: [u32; 7] = [0xb9a58c, 0x9c5f48, 0x8d99a6, 0xc9c2b2, 0x6f7d8c, 0xa88a6a, 0xd0b89a];
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
const GLASS: u32 = 0x0035_506b;
/// Behind a window without light.
/// Share of windows behind which a lamp burns in the evening.
const LIT: f32 = 0.4;
const PANES: [u32; 4] = [0x2c4458, 0x35506b, 0x3d5a70, 0x28394a];
const BLINDS: [u32; 4] = [0xcfc8b8, 0xb8b4aa, 0xd8d4c8, 0xa7b0b4];
const FRAMES: [u32; 3] = [0xe4e1d8, 0x3a3f45, 0x54463a];

/// Depth of a window's reveal, m.
const REVEAL: f32 = 0.14;
/// Width of the frames and bars of windows, m.
const FRAME: f32 = 0.06;
/// Where the bar across a window is, as a share of its height.
const TRANSOM: f32 = 0.68;
/// Windows of a side are drawn one by one up to this distance, m; beyond, a storey's glass is one band.
const NEAR: f32 = 120.0;
/// Sills, bars and balconies up to this one, m.
const CLOSE: f32 = 60.0;
/// How far the core lies behind the walls, m: doors are set back less.
const CORE: f32 = 0.8;
/// The narrowest side with windows of its own, m.
const NARROWEST: f32 = 3.0;
/// How far eaves stand out, m: layouts leave as much room before walls.
const EAVES: f32 = 0.25;

/// Storeys of a house.
#[derive(Debug, Clone, Copy)]
struct Storeys {
    /// Height of the ground floor, m.
    ground: f32,
    count: u32,
    /// Height of each of the others, m.
    height: f32,
}

impl Storeys {
    #[allow(clippy::cast_precision_loss, reason = "a few dozen storeys")]
    fn of(size: Vec3, most: u32) -> Self {
        let ground = 4.0_f32.min(size.y * 0.5);
        let rest = size.y - ground - 0.8;
        let count = count(rest, 3.2, most);
        Self { ground, count, height: rest / count as f32 }
    }
}

/// Draws a house.
pub(super) fn building(b: &mut Builder<'_>, size: Vec3, look: &Look) {
    let storeys = Storeys::of(size, if look.is_full() { 14 } else { 4 });
    let is_large = size.min_element() > NARROWEST && size.y > 6.0;
    if !(look.is_fine() && is_large) {
        plain(b, size, look, storeys);
        return;
    }
    let wall = look.pick(0, &WALLS);
    for side in 0..4_u8 {
        let (wide, deep) = if side % 2 == 0 { (size.x, size.z) } else { (size.z, size.x) };
        let side_look = look.seen_at(side);
        let face = Face { wide, z: 0.5 * deep, tall: size.y, storeys, wall, made: made_of(look) };
        let b = &mut b.side(side);
        let aside = (side_look.eye.x.abs() - 0.5 * wide).max(0.0);
        let off = Vec2::new(aside, side_look.eye.y - face.z).length();
        if look.hidden[usize::from(side)] || off > NEAR {
            face.bands(b, &side_look, look.hidden[usize::from(side)]);
        } else {
            face.windows(b, &side_look, side);
            shops::ground_floor(
                b,
                &Front { wide, z: face.z, tall: storeys.ground, wall },
                &side_look,
                u32::from(side),
            );
        }
    }
    roof(b, size, wall, look);
    // last: what stands before it hides nearly all of it
    b.of(Material::Plaster).block(Vec3::ZERO, size - v(2.0 * CORE, 0.3, 2.0 * CORE), wall * 0.5);
}

fn made_of(look: &Look) -> Material {
    WALLS_OF[look.index(0, WALLS_OF.len())]
}

/// A house of blocks.
#[allow(clippy::cast_precision_loss, reason = "a few dozen storeys and windows")]
fn plain(b: &mut Builder<'_>, size: Vec3, look: &Look, storeys: Storeys) {
    let (wall, glass, made) = (look.pick(0, &WALLS), srgb(GLASS), made_of(look));
    b.of(made).block(Vec3::ZERO, size, wall);
    b.of(Material::Glass);
    let Storeys { ground, height, .. } = storeys;
    for floor in 0..storeys.count {
        let y = ground + (floor as f32 + 0.3) * height;
        b.block(v(0.0, y, 0.0), v(size.x + 0.08, height * 0.5, size.z + 0.08), glass);
    }
    // Shop windows between piers, a coloured fascia, and an awning over the pavement on every side.
    b.block(v(0.0, 0.6, 0.0), v(size.x + 0.1, ground * 0.55, size.z + 0.1), srgb(0x8fb2c4));
    b.of(Material::Plain);
    b.block(v(0.0, ground * 0.76, 0.0), v(size.x + 0.3, 0.7, size.z + 0.3), look.pick(1, &shops::SIGNS));
    b.block(v(0.0, size.y, 0.0), v(size.x * 0.4, 2.0, size.z * 0.4), srgb(0x77787a));
    if !look.is_full() {
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

/// One side of a house, which faces +z.
#[derive(Debug, Clone, Copy)]
struct Face {
    wide: f32,
    /// Where it is, m.
    z: f32,
    tall: f32,
    storeys: Storeys,
    wall: Vec3,
    made: Material,
}

/// A window in a side: from and to, m, and what its number is.
#[derive(Debug, Clone, Copy)]
struct Opening {
    x: [f32; 2],
    y: [f32; 2],
    number: u32,
}

impl Face {
    /// A wall and a band of glass a storey: what is far, or unseen.
    #[allow(clippy::cast_precision_loss, reason = "a few dozen storeys")]
    fn bands(&self, b: &mut Builder<'_>, look: &Look, is_hidden: bool) {
        let half = 0.5 * self.wide;
        b.of(self.made).rect([-half, half], [0.0, self.tall], self.z, self.wall);
        if is_hidden {
            return;
        }
        let Storeys { ground, count, height } = self.storeys;
        b.of(Material::Glass);
        for storey in 0..count {
            let y = ground + (storey as f32 + 0.3) * height;
            b.rect([-half, half], [y, y + 0.5 * height], self.z + 0.04, srgb(GLASS));
        }
        b.rect([-half, half], [0.6, 0.6 + ground * 0.55], self.z + 0.05, srgb(0x8fb2c4));
        let low = ground * shops::FASCIA;
        b.of(Material::Plain);
        b.cuboid(v(-half, low, self.z - 0.1), v(half, low + 0.7, self.z + 0.15), look.pick(1, &shops::SIGNS));
    }

    /// Every storey above the ground floor.
    #[allow(clippy::cast_precision_loss, reason = "a few dozen storeys and windows")]
    fn windows(&self, b: &mut Builder<'_>, look: &Look, side: u8) {
        let half = 0.5 * self.wide;
        let Storeys { ground, count: storeys, height } = self.storeys;
        let bays = count(self.wide - 0.8, self.bay(), 24);
        let pitch = (self.wide - 0.8) / bays as f32;
        let glass = [self.share() * pitch, self.heights()[1] * height];
        for storey in 0..storeys {
            let floor = ground + storey as f32 * height;
            let y0 = floor + self.heights()[0] * height;
            let y = [y0, y0 + glass[1]];
            let opening = |bay: u32| {
                let middle = (bay as f32 + 0.5) * pitch - 0.5 * (self.wide - 0.8);
                let x = [middle - 0.5 * glass[0], middle + 0.5 * glass[0]];
                Opening { x, y, number: (u32::from(side) * 64 + storey) * 64 + bay }
            };
            if look.is_far {
                (0..bays).for_each(|bay| self.flat_window(b, look, opening(bay)));
                continue;
            }
            b.of(self.made);
            b.rect([-half, half], [floor, y[0]], self.z, self.wall);
            b.rect([-half, half], [y[1], floor + height], self.z, self.wall);
            let mut from = -half;
            for opening in (0..bays).map(opening) {
                b.of(self.made).rect([from, opening.x[0]], y, self.z, self.wall);
                from = opening.x[1];
                self.window(b, look, opening);
            }
            b.of(self.made).rect([from, half], y, self.z, self.wall);
        }
        let from = if look.is_far { ground } else { ground + storeys as f32 * height };
        b.of(self.made).rect([-half, half], [from, self.tall], self.z, self.wall);
    }

    /// Width of a bay, the share of it that is glass, and where glass begins and how tall it is, shares of a storey.
    fn bay(&self) -> f32 {
        if self.made == Material::Panel { 3.2 } else { 2.5 }
    }

    fn share(&self) -> f32 {
        if self.made == Material::Panel { 0.8 } else { 0.5 }
    }

    fn heights(&self) -> [f32; 2] {
        if self.made == Material::Panel { [0.3, 0.52] } else { [0.28, 0.54] }
    }

    fn window(&self, b: &mut Builder<'_>, look: &Look, opening: Opening) {
        let Opening { x, y, number } = opening;
        let inner = self.z - REVEAL;
        b.of(self.made).recess(x, y, [self.z, inner], self.wall * 0.85);
        glazing(b, look, opening, inner);
        let middle = v(0.5 * (x[0] + x[1]), 0.0, self.z);
        if look.far(middle) > CLOSE {
            return;
        }
        frames(b, opening, inner + 0.03, look.pick(2, &FRAMES), self.bars());
        if self.made == Material::Panel {
            return;
        }
        let stone = self.stone();
        b.of(Material::Plaster);
        let [x0, x1] = [x[0] - 0.1, x[1] + 0.1];
        b.cuboid(v(x0, y[0] - 0.1, self.z - 0.02), v(x1, y[0], self.z + 0.09), stone);
        b.cuboid(v(x0, y[1], self.z - 0.02), v(x1, y[1] + 0.18, self.z + 0.03), stone);
        if self.has_balcony(look, number) {
            balcony(b, look, opening, self.z);
        }
    }

    /// A window, sill and lintel as they look from afar: sheets on the wall. What is in front comes first, and hides the rest.
    #[allow(clippy::cast_precision_loss, reason = "a few bars")]
    fn flat_window(&self, b: &mut Builder<'_>, look: &Look, opening: Opening) {
        let Opening { x, y, number } = opening;
        let at = |sheet: u8| self.z + 0.01 * f32::from(sheet);
        if look.far(v(0.5 * (x[0] + x[1]), 0.0, self.z)) > CLOSE {
            glazing(b, look, opening, at(1));
            return;
        }
        if self.made != Material::Panel {
            let [x0, x1] = [x[0] - 0.1, x[1] + 0.1];
            b.of(Material::Plaster);
            b.rect([x0, x1], [y[0] - 0.1, y[0]], at(2), self.stone());
            b.rect([x0, x1], [y[1], y[1] + 0.18], at(2), self.stone());
        }
        if self.has_balcony(look, number) {
            balcony(b, look, opening, self.z);
        }
        let frame = look.pick(2, &FRAMES);
        let pane = Opening { x: [x[0] + FRAME, x[1] - FRAME], y: [y[0] + FRAME, y[1] - FRAME], number };
        b.of(Material::Plain);
        for bar in 1..=self.bars() {
            let middle = x[0] + (x[1] - x[0]) * bar as f32 / (self.bars() + 1) as f32;
            b.rect([middle - 0.5 * FRAME, middle + 0.5 * FRAME], pane.y, at(3), frame);
        }
        if self.bars() == 1 {
            let low = y[0] + TRANSOM * (y[1] - y[0]);
            b.rect(pane.x, [low, low + 0.05], at(3), frame);
        }
        glazing(b, look, pane, at(2));
        b.of(Material::Plain).rect(x, y, at(1), frame * 0.95);
    }

    /// Bars that part the panes of a window.
    fn bars(&self) -> u32 {
        if self.made == Material::Panel { 2 } else { 1 }
    }

    /// Colour of sills and lintels.
    fn stone(&self) -> Vec3 {
        if self.made == Material::Brick { srgb(0xc7beac) } else { self.wall * 1.12 }
    }

    fn has_balcony(&self, look: &Look, window: u32) -> bool {
        self.made == Material::Plaster && look.unit(500 + window) < 0.22
    }
}

/// Panes, the upper part of some behind a blind; darker under the lintel.
fn glazing(b: &mut Builder<'_>, look: &Look, opening: Opening, z: f32) {
    let Opening { x, y, number } = opening;
    let draw = 1000 + 4 * number;
    let (pane, blind) = (look.pick(draw, &PANES), look.pick(draw + 1, &BLINDS));
    let drawn = (look.unit(draw + 2) * 1.9 - 1.0).max(0.0);
    let edge = y[1] - drawn * (y[1] - y[0]);
    let made = if look.unit(draw + 3) < LIT { Material::LitPane } else { Material::Pane };
    b.of(made).rect_shaded(x, [y[0], edge], z, [pane, pane * if drawn > 0.0 { 0.95 } else { 0.7 }]);
    if drawn > 0.02 {
        b.of(Material::Plain).rect_shaded(x, [edge, y[1]], z, [blind * 0.6, blind * 0.42]);
    }
}

/// A frame about an opening, and bars that part its panes.
#[allow(clippy::cast_precision_loss, reason = "a few bars")]
fn frames(b: &mut Builder<'_>, opening: Opening, z: f32, color: Vec3, bars: u32) {
    let Opening { x: [x0, x1], y: [y0, y1], .. } = opening;
    b.of(Material::Plain);
    b.rect([x0, x0 + FRAME], [y0, y1], z, color);
    b.rect([x1 - FRAME, x1], [y0, y1], z, color);
    b.rect([x0, x1], [y0, y0 + FRAME], z + 0.002, color);
    b.rect([x0, x1], [y1 - FRAME, y1], z + 0.002, color * 0.8);
    for bar in 1..=bars {
        let x = x0 + (x1 - x0) * bar as f32 / (bars + 1) as f32;
        b.rect([x - 0.5 * FRAME, x + 0.5 * FRAME], [y0, y1], z, color);
    }
    if bars == 1 {
        let y = y0 + TRANSOM * (y1 - y0);
        b.rect([x0, x1], [y, y + 0.05], z, color);
    }
}

/// A slab with a railing before a window.
fn balcony(b: &mut Builder<'_>, look: &Look, opening: Opening, z: f32) {
    const OUT: f32 = 0.7;
    let Opening { x, y, .. } = opening;
    let (x0, x1, floor) = (x[0] - 0.3, x[1] + 0.3, y[0] - 0.2);
    let iron = srgb(0x2c3034);
    b.of(Material::Plaster).cuboid(v(x0, floor - 0.16, z - 0.02), v(x1, floor, z + OUT), srgb(0xb5b0a4));
    b.of(Material::Plain);
    b.cuboid(v(x0, floor + 0.95, z + OUT - 0.06), v(x1, floor + 1.0, z + OUT - 0.01), iron);
    if look.is_far {
        return;
    }
    let bars = count(x1 - x0, 0.16, 40);
    for bar in 0..=bars {
        #[allow(clippy::cast_precision_loss, reason = "a few bars")]
        let at = x0 + (x1 - x0 - 0.02) * bar as f32 / bars as f32;
        b.rect([at, at + 0.02], [floor, floor + 0.95], z + OUT - 0.03, iron);
    }
    for x in [x0, x1 - 0.03] {
        b.cuboid(v(x, floor + 0.95, z), v(x + 0.03, floor + 1.0, z + OUT), iron);
        b.cuboid(v(x, floor + 0.45, z), v(x + 0.03, floor + 0.48, z + OUT), iron);
    }
}

/// Eaves, a parapet, and what stands on a roof.
fn roof(b: &mut Builder<'_>, size: Vec3, wall: Vec3, look: &Look) {
    let cornice = |b: &mut Builder<'_>, y: f32, tall: f32, out: f32, shade: f32| {
        b.block(v(0.0, y, 0.0), v(size.x + 2.0 * out, tall, size.z + 2.0 * out), wall * shade);
    };
    b.of(Material::Plaster);
    cornice(b, size.y - 0.55, 0.18, 0.08, 0.9);
    cornice(b, size.y - 0.1, 0.22, 0.16, 0.95);
    cornice(b, size.y + 0.12, 0.38, EAVES, 0.85);
    b.of(Material::Plain);
    let top = size.y + 0.5;
    b.block(v(size.x * 0.1, top, -size.z * 0.08), v(size.x * 0.35, 1.9, size.z * 0.32), srgb(0x77787a));
    for number in 0..3_u32 {
        let place = v(look.unit(60 + 2 * number) - 0.5, 0.0, look.unit(61 + 2 * number) - 0.5) * 0.7;
        let at = v(place.x * size.x, top, place.z * size.z);
        b.block(at, v(1.1, 0.9, 0.9), srgb(0xa9aeb0));
    }
    b.turned(v(-size.x * 0.3, top, size.z * 0.28), &[(0.06, 0.0), (0.05, 2.6)], 6, srgb(0x55595c));
}

//! Parking: a car park in front of a row of stores (8 agents in the paper).
//!
//! Islands of bays, two rows of cars back to back, with aisles along x and footways along z between them; the
//! stores stand along the far edge (least z).

use super::blocks::{Generated, Streets, spaced};
use crate::scenario::file::{Ground, Prop, PropKind};
use crate::scenario::polygon;
use crate::scenario::random::{Purpose, unit};
use glam::{Vec2, Vec3};

/// Agents per m² outside the islands.
const DENSITY: f32 = 0.12;
/// A car: width, height, length, m.
const CAR: Vec3 = Vec3::new(1.8, 1.48, 4.3);
/// Width of a bay, m: 1.6 m remain between neighbours, wide enough to walk through.
const BAY: f32 = 3.4;
/// Depth of an island, m: two bays and 1.7 m between the bumpers.
const ISLAND: f32 = 10.8;
/// Height of the pavement before the stores, m.
const KERB: f32 = 0.12;
/// Up to this many islands every car is an obstacle of its own, beyond it the island is.
const SINGLE_CARS: u32 = 160;

/// Rows and columns of islands.
#[derive(Debug, Clone, Copy)]
struct Lot {
    columns: u32,
    rows: u32,
    /// Bays per row of an island.
    bays: u32,
    aisle: f32,
    footway: f32,
}

impl Lot {
    #[allow(clippy::cast_precision_loss, reason = "up to a million agents")]
    fn for_agents(agents: u32) -> Self {
        let scale = libm::powf(agents as f32 / 60.0, 0.25).clamp(1.0, 4.0);
        let bays = if agents > 2000 { 10 } else { 4 };
        let mut lot = Self { columns: 2, rows: 2, bays, aisle: 6.0 * scale, footway: 4.0 * scale };
        while lot.walkable() * DENSITY < agents as f32 && lot.rows < 999 {
            // Grow so that the lot stays about square.
            if lot.size().x < lot.size().y { lot.columns += 1 } else { lot.rows += 1 }
        }
        lot
    }

    #[allow(clippy::cast_precision_loss, reason = "a few bays")]
    fn island(&self) -> Vec2 {
        Vec2::new(self.bays as f32 * BAY, ISLAND)
    }

    #[allow(clippy::cast_precision_loss, reason = "a few hundred islands")]
    fn size(&self) -> Vec2 {
        let (c, r) = (self.columns as f32, self.rows as f32);
        let island = self.island();
        Vec2::new(c * island.x + (c + 1.0) * self.footway, r * island.y + (r + 1.0) * self.aisle)
    }

    #[allow(clippy::cast_precision_loss, reason = "a few hundred islands")]
    fn walkable(&self) -> f32 {
        let islands = (self.columns * self.rows) as f32;
        self.size().x * self.size().y - islands * self.island().x * self.island().y
    }

    fn center(&self, column: u32, row: u32) -> Vec2 {
        let island = self.island();
        Vec2::new(
            spaced(column, self.columns, island.x + self.footway),
            spaced(row, self.rows, island.y + self.aisle),
        )
    }

    fn streets(&self) -> Streets {
        let half = self.size() * 0.5;
        let island = self.island();
        let lines = |count: u32, pitch: f32| (0..=count).map(|i| spaced(i, count + 1, pitch)).collect();
        Streets {
            xs: lines(self.columns, island.x + self.footway),
            zs: lines(self.rows, island.y + self.aisle),
            low: -half,
            high: half,
            width: Vec2::new(self.footway, self.aisle),
        }
    }
}

/// Makes the place for a number of agents.
pub(crate) fn generate(agents: u32) -> Generated {
    let lot = Lot::for_agents(agents);
    let size = lot.size();
    let outline = polygon::oriented(polygon::rectangle(Vec2::ZERO, size, 0.0), false);
    let mut made = Generated { bounds: outline, ground: Ground::Asphalt, ..Generated::default() };
    let streets = lot.streets();
    // In the aisle and on the footway next to the middle.
    let nearest = |lines: &[f32]| {
        lines.iter().copied().fold(f32::INFINITY, |a, b| if b.abs() < a.abs() { b } else { a })
    };
    made.user_place = Some(Vec2::new(nearest(&streets.xs) + 0.6, nearest(&streets.zs) + 0.6));
    made.routes = streets.straight();
    made.routes.extend(streets.loops(1.0));
    let single = lot.columns * lot.rows <= SINGLE_CARS;
    let mut id = 0;
    for column in 0..lot.columns {
        for row in 0..lot.rows {
            island(&lot, lot.center(column, row), single, &mut id, &mut made);
        }
    }
    surroundings(&lot, &mut made.props);
    made
}

/// Two rows of bays, back to back.
fn island(lot: &Lot, center: Vec2, single: bool, id: &mut u32, made: &mut Generated) {
    let island = lot.island();
    if !single {
        made.obstacles.push(polygon::rectangle(center, island - Vec2::splat(0.4), 0.0));
    }
    for (side, heading) in [(-1.0, 180.0), (1.0, 0.0)] {
        let depth = center.y + side * (island.y * 0.5 - 0.25 - CAR.z * 0.5);
        for bay in 0..lot.bays {
            let x = center.x + spaced(bay, lot.bays, BAY);
            *id += 1;
            if unit(0, *id, Purpose::Scenery, 0) < 0.72 {
                let car = Prop::new(PropKind::Car, Vec2::new(x, depth), CAR).facing(heading);
                made.props.push(if single { car } else { car.scenery() });
            }
        }
        for line in 0..=lot.bays {
            let at = Vec2::new(center.x + spaced(line, lot.bays + 1, BAY), depth);
            made.props.push(Prop::new(PropKind::Line, at, Vec3::new(0.12, 0.01, CAR.z + 0.3)));
        }
    }
    let lamp = Prop::new(
        PropKind::Lamp,
        Vec2::new(center.x - island.x * 0.5 - 0.7, center.y),
        Vec3::new(0.3, 6.0, 1.2),
    );
    made.props.push(if single { lamp.facing(90.0) } else { lamp.facing(90.0).scenery() });
}

/// Beyond the bounds: stores with a pavement along the far edge, lawn and trees along the others.
fn surroundings(lot: &Lot, props: &mut Vec<Prop>) {
    let size = lot.size();
    let far = -size.y * 0.5;
    let paved = Vec3::new(size.x + 20.0, KERB, 4.5);
    props.push(Prop::new(PropKind::Pavement, Vec2::new(0.0, far - 2.3), paved));
    let mut x = -size.x * 0.5 - 4.0;
    let mut id = 0_u32;
    while x < size.x * 0.5 + 4.0 && id < 400 {
        let draw = |k: u32| unit(0, id, Purpose::Scenery, 30 + k);
        let (width, height, depth) = (11.0 + 8.0 * draw(0), 4.5 + 2.5 * draw(1), 12.0 + 4.0 * draw(2));
        // Fronts in one line; neighbours 10 cm apart.
        let at = Vec2::new(x + width * 0.5, far - 4.8 - depth * 0.5);
        props.push(Prop::new(PropKind::Store, at, Vec3::new(width - 0.1, height, depth)).scenery());
        x += width;
        id += 1;
    }
    let lawn = Vec3::new(size.x + 60.0, 0.01, 16.0);
    props.push(Prop::new(PropKind::Lawn, Vec2::new(0.0, size.y * 0.5 + 8.5), lawn));
    for side in [-1.0, 1.0] {
        let strip = Vec3::new(16.0, 0.01, size.y);
        props.push(Prop::new(PropKind::Lawn, Vec2::new(side * (size.x * 0.5 + 14.0), 0.5), strip));
        for i in 0..8_u32 {
            let near = spaced(i, 8, (size.y / 8.0).min(14.0));
            let at = Vec2::new(side * (size.x * 0.5 + 10.0 + 6.0 * unit(0, i, Purpose::Scenery, 50)), near);
            props.push(Prop::new(PropKind::Tree, at, Vec3::new(4.2, 6.5, 4.2)).scenery());
        }
    }
    for i in 0..12_u32 {
        let at = Vec2::new(spaced(i, 12, (size.x / 11.0).min(14.0)), size.y * 0.5 + 5.0);
        props.push(Prop::new(PropKind::Tree, at, Vec3::new(4.0, 6.0, 4.0)).scenery());
    }
}

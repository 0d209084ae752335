//! Garden: a small leisure garden (4 agents in the paper): hedged beds, gravel paths, a fountain with benches.

use super::blocks::{Blocks, Generated};
use crate::scenario::file::{Ground, Prop, PropKind};
use crate::scenario::random::{Purpose, range};
use glam::{Vec2, Vec3};

/// Agents per m² of path.
const DENSITY: f32 = 0.12;

/// Makes the place for a number of agents.
pub(crate) fn generate(agents: u32) -> Generated {
    let blocks = Blocks::for_agents(agents, DENSITY, 6.0, 3.4, 1.0);
    let streets = blocks.streets();
    let mut made = Generated { bounds: blocks.outline(), ground: Ground::Gravel, ..Generated::default() };
    made.routes = streets.straight();
    made.routes.extend(streets.loops(1.0));
    made.user_place = Some(Vec2::new(0.0, blocks.block * 0.5 + blocks.path * 0.4));
    for (id, center) in (0_u32..).zip(blocks.centers()) {
        let bed = Prop::new(PropKind::Bed, center, Vec3::new(blocks.block, 0.8, blocks.block));
        made.props.push(bed);
        trees(&mut made.props, center, blocks.block, id);
    }
    middle(&mut made.props, blocks.block);
    surroundings(&mut made.props, blocks.side());
    made
}

/// Trees within a bed: what is solid there is the bed.
fn trees(props: &mut Vec<Prop>, center: Vec2, block: f32, id: u32) {
    for k in 0..2_u32 {
        let draw = |i: u32, low: f32, high: f32| range(0, id, Purpose::Scenery, 20 + 4 * k + i, low, high);
        let reach = block * 0.5 - 1.4;
        let side = if k == 0 { 1.0 } else { -1.0 };
        let at = center + Vec2::new(side * draw(0, 0.35, 1.0), draw(1, -1.0, 1.0)) * reach;
        let crown = draw(2, 2.0, 3.0 + 0.04 * block);
        let size = Vec3::new(crown, crown * 1.2 + draw(3, 1.2, 2.4), crown);
        props.push(Prop::new(PropKind::Tree, at, size).scenery());
    }
}

/// The fountain in the middle, benches and small trees about it.
fn middle(props: &mut Vec<Prop>, block: f32) {
    let fountain = (block * 0.16).clamp(1.0, 3.0);
    props.push(Prop::new(PropKind::Fountain, Vec2::ZERO, Vec3::new(2.0 * fountain, 3.4, 2.0 * fountain)));
    for quarter in 0..4_u8 {
        let heading = f32::from(quarter) * 90.0 + 45.0;
        let out = Vec2::new(libm::sinf(heading.to_radians()), libm::cosf(heading.to_radians()));
        // A bench looks at the water; the middle block's corners are its place.
        let bench =
            Prop::new(PropKind::Bench, out * (block * 0.5).max(fountain + 2.0), Vec3::new(1.5, 0.9, 0.55));
        props.push(bench.facing(heading + 180.0 - if heading > 180.0 { 360.0 } else { 0.0 }));
    }
}

/// A hedge round the garden, lawns and trees beyond it.
fn surroundings(props: &mut Vec<Prop>, side: f32) {
    let out = side * 0.5;
    let lawn = 40.0 + side * 0.5;
    for (x, z) in [(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0)] {
        let direction = Vec2::new(x, z);
        let (along_x, along_z) = (direction.x == 0.0, direction.x != 0.0);
        let hedge = Vec3::new(if along_x { side + 2.0 } else { 0.9 }, 1.5, if along_z { side } else { 0.9 });
        props.push(Prop::new(PropKind::Hedge, direction * (out + 0.55), hedge).scenery());
        let size = Vec3::new(
            if along_x { side + 2.0 * lawn } else { lawn },
            0.01,
            if along_z { side } else { lawn },
        );
        props.push(Prop::new(PropKind::Lawn, direction * (out + lawn * 0.5), size));
        for i in 0..14_u8 {
            let id = u32::from(i) + 100 * (direction.x.to_bits() >> 20) + 7 * (direction.y.to_bits() >> 20);
            let draw = |k: u32, low: f32, high: f32| range(0, id, Purpose::Scenery, 40 + k, low, high);
            let at = direction * (out + draw(0, 4.0, 18.0))
                + direction.perp() * draw(1, -0.7, 0.7) * (side * 0.7 + 12.0).min(90.0);
            let crown = draw(2, 3.0, 5.5);
            props.push(Prop::new(PropKind::Tree, at, Vec3::new(crown, crown * 1.6, crown)).scenery());
        }
    }
}

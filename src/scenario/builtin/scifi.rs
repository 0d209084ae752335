//! Scifi: a fantastical residential pod (4 agents in the paper): domes on a deck, glowing strips, a landing pad.

use super::blocks::{Blocks, Generated, spaced};
use crate::scenario::file::{Ground, Prop, PropKind};
use glam::{Vec2, Vec3};

/// Agents per m² of deck.
const DENSITY: f32 = 0.14;

/// Makes the place for a number of agents.
pub(crate) fn generate(agents: u32) -> Generated {
    // A dome covers pi/4 of its square.
    let blocks = Blocks::for_agents(agents, DENSITY, 6.0, 4.2, 0.8);
    let streets = blocks.streets();
    let mut made = Generated { bounds: blocks.outline(), ground: Ground::Deck, ..Generated::default() };
    made.routes = streets.straight();
    made.routes.extend(streets.loops(1.0));
    made.user_place = Some(Vec2::new(0.4, blocks.block * 0.35));
    // Domes of an agreeable shape however large their square: no taller than 9 m.
    let height = (blocks.block * 0.62).min(9.0);
    for center in blocks.centers() {
        // Doors look at the middle of the place; the frame stands out by less than the margin left here.
        let turn = if center.x.abs() > center.y.abs() {
            -90.0 * center.x.signum()
        } else if center.y > 0.0 {
            180.0
        } else {
            0.0
        };
        let size = Vec3::new(blocks.block * 0.95, height, blocks.block * 0.95);
        made.props.push(Prop::new(PropKind::Pod, center, size).facing(turn));
    }
    let pad = blocks.block * 0.9;
    made.props.push(Prop::new(PropKind::LandingPad, Vec2::ZERO, Vec3::new(pad, 0.01, pad)));
    deck(&mut made.props, &blocks);
    walls(&mut made.props, blocks.side());
    made
}

/// Strips along every path, columns where inner paths cross.
fn deck(props: &mut Vec<Prop>, blocks: &Blocks) {
    let lines = blocks.count + 1;
    for i in 0..lines {
        let line = spaced(i, lines, blocks.pitch());
        for j in 0..blocks.count {
            let middle = spaced(j, blocks.count, blocks.pitch());
            for side in [-0.5, 0.5] {
                let edge = line + side * blocks.path * 0.86;
                let length = blocks.block * 0.9;
                props.push(Prop::new(
                    PropKind::Strip,
                    Vec2::new(edge, middle),
                    Vec3::new(0.14, 0.01, length),
                ));
                props.push(Prop::new(
                    PropKind::Strip,
                    Vec2::new(middle, edge),
                    Vec3::new(length, 0.01, 0.14),
                ));
            }
        }
        for j in 0..lines {
            let inner = i > 0 && j > 0 && i + 1 < lines && j + 1 < lines;
            if inner {
                let at = Vec2::new(line, spaced(j, lines, blocks.pitch()));
                props.push(Prop::new(PropKind::Column, at, Vec3::new(0.5, 6.0, 0.5)));
            }
        }
    }
}

/// A panelled wall round the deck, just outside the bounds.
fn walls(props: &mut Vec<Prop>, side: f32) {
    let out = side * 0.5 + 0.4;
    for (x, z, heading) in [(0.0, out, 0.0), (0.0, -out, 180.0), (out, 0.0, 90.0), (-out, 0.0, -90.0)] {
        let wall = Prop::new(PropKind::Wall, Vec2::new(x, z), Vec3::new(side + 1.1, 3.4, 0.4));
        props.push(wall.facing(heading).scenery());
    }
}

//! Crossing: a busy intersection in a city (8 agents in the paper), a scramble crossing with diagonal zebras.
//!
//! Up to 10,000 agents the one intersection grows; beyond that the city does: an odd number of streets each way,
//! with the user at the middle intersection.

use super::blocks::{Generated, LANE_MARGIN, Streets, route, spaced};
use crate::scenario::file::{Ground, Prop, PropKind, Route, RouteMode};
use crate::scenario::polygon;
use crate::scenario::random::{Purpose, range};
use glam::{Vec2, Vec3};

/// Mean density, agents/m²: where two streets cross it is about 1.7 times as high.
const DENSITY: f32 = 0.16;

/// Streets each way and their width.
#[derive(Debug, Clone, Copy)]
struct City {
    /// Streets each way, odd.
    streets: u32,
    /// Width of a street, m.
    width: f32,
    /// Side of a block and length of the outer arms, m.
    block: f32,
}

impl City {
    #[allow(clippy::cast_precision_loss, reason = "up to a million agents")]
    fn for_agents(agents: u32) -> Self {
        let area = agents as f32 / DENSITY;
        let mut streets = 1;
        loop {
            // With blocks as wide as the streets the streets cover (3 k² + 2 k) squares of that side.
            let k = streets as f32;
            let width = (area / (3.0 * k * k + 2.0 * k)).sqrt().max(18.0);
            let most = if streets == 1 { 112.0 } else { 64.0 };
            if width <= most || streets >= 99 {
                return Self { streets, width, block: width };
            }
            streets += 2;
        }
    }

    fn pitch(&self) -> f32 {
        self.width + self.block
    }

    fn lines(&self) -> Vec<f32> {
        (0..self.streets).map(|i| spaced(i, self.streets, self.pitch())).collect()
    }

    /// Half the side of the whole city, m.
    #[allow(clippy::cast_precision_loss, reason = "a few dozen streets")]
    fn half(&self) -> f32 {
        0.5 * (self.streets as f32 * self.width + (self.streets + 1) as f32 * self.block)
    }

    /// A comb on each side: the streets open to the edge, the outer blocks are outside. Clockwise on (x, z).
    fn outline(&self) -> Vec<Vec2> {
        let (half, inner, w) = (self.half(), self.half() - self.block, self.width * 0.5);
        let mut side = Vec::new();
        for line in self.lines() {
            side.extend([(line - w, inner), (line - w, half), (line + w, half), (line + w, inner)]);
        }
        let mut outline: Vec<Vec2> = Vec::new();
        for quarter in 0..4_u8 {
            for &(along, out) in &side {
                let p = match quarter {
                    0 => Vec2::new(along, out),
                    1 => Vec2::new(out, -along),
                    2 => Vec2::new(-along, -out),
                    _ => Vec2::new(-out, along),
                };
                if outline.last().is_none_or(|last| last.distance(p) > 1e-3) {
                    outline.push(p);
                }
            }
        }
        if outline.len() > 1 && outline[0].distance(outline[outline.len() - 1]) <= 1e-3 {
            outline.pop();
        }
        polygon::oriented(outline, false)
    }
}

/// Makes the place for a number of agents.
pub(crate) fn generate(agents: u32) -> Generated {
    let city = City::for_agents(agents);
    let mut made = Generated { bounds: city.outline(), ground: Ground::Asphalt, ..Generated::default() };
    // Off the middle, so that no lane of the streets ends in the user.
    made.user_place = Some(Vec2::new(0.12 * city.width, 0.16 * city.width));
    // Above the near arm: from anywhere else the houses hide the crossing.
    let eye = Vec3::new(0.22 * city.width, 0.42 * city.width, 0.5 * city.width + 0.75 * city.block);
    made.overview = Some((eye, Vec3::new(0.0, 0.0, -0.05 * city.width)));
    made.routes = ways(&city);
    blocks(&city, &mut made);
    for &x in &city.lines() {
        for &z in &city.lines() {
            intersection(&city, Vec2::new(x, z), &mut made.props);
        }
    }
    street_ends(&city, &mut made.props);
    made
}

/// Along every street, round every inner block, and at the middle intersection across the diagonals and round
/// the corners.
fn ways(city: &City) -> Vec<Route> {
    let half = city.half();
    let streets = Streets {
        xs: city.lines(),
        zs: city.lines(),
        low: Vec2::splat(-half),
        high: Vec2::splat(half),
        width: Vec2::splat(city.width),
    };
    let mut ways = streets.straight();
    ways.extend(streets.loops(0.25));
    let lanes = city.width - 2.0 * LANE_MARGIN;
    let (arm, q) = (city.width * 0.5 + city.block * 0.6, city.width * 0.25);
    let mut add = |name: &str, points: [[f32; 2]; 4], width: f32, weight: f32| {
        ways.push(route(name.to_owned(), points.to_vec(), width, RouteMode::Patrol, weight));
    };
    let edge = city.width * 0.5;
    for (name, s) in [("diagonal-a", 1.0), ("diagonal-b", -1.0)] {
        let (narrow, side) = (lanes * 0.45, q * s);
        add(&format!("{name}-z"), [[-side, -arm], [-side, -edge], [side, edge], [side, arm]], narrow, 0.3);
        add(&format!("{name}-x"), [[-arm, -side], [-edge, -side], [edge, side], [arm, side]], narrow, 0.3);
    }
    for (name, sx, sz) in
        [("corner-a", 1.0, 1.0), ("corner-b", 1.0, -1.0), ("corner-c", -1.0, -1.0), ("corner-d", -1.0, 1.0)]
    {
        let points = [[0.0, sz * arm], [0.0, sz * edge * 0.5], [sx * edge * 0.5, 0.0], [sx * arm, 0.0]];
        add(name, points, lanes * 0.5, 0.25);
    }
    ways
}

/// Houses; inner blocks are solid, outer ones stand outside the bounds.
fn blocks(city: &City, made: &mut Generated) {
    let mut id = 0_u32;
    for i in 0..=city.streets {
        for j in 0..=city.streets {
            let at = |n: u32| spaced(n, city.streets + 1, city.pitch());
            let center = Vec2::new(at(i), at(j));
            let inner = i > 0 && j > 0 && i < city.streets && j < city.streets;
            if inner {
                made.obstacles.push(polygon::rectangle(center, Vec2::splat(city.block), 0.0));
            }
            for (dx, dz) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let draw = |k: u32, low: f32, high: f32| range(0, id, Purpose::Scenery, k, low, high);
                // Eaves and shop fronts stand out by 0.25 m; the walls stay that far behind the outline.
                let side = city.block * 0.5 - 0.3;
                let tall = draw(0, 11.0, 15.0 + 0.45 * city.block.min(60.0));
                let offset = Vec2::new(dx, dz) * (side * 0.5 + 0.02);
                let size = Vec3::new(side - 0.1, tall, side - 0.1);
                made.props.push(Prop::new(PropKind::Building, center + offset, size).scenery());
                id += 1;
            }
        }
    }
}

/// Zebras over the four arms and both diagonals, pavements, lamps and lights.
fn intersection(city: &City, at: Vec2, props: &mut Vec<Prop>) {
    let (w, half) = (city.width, city.width * 0.5);
    let paved = (0.15 * w).clamp(3.0, 8.0);
    let kerb = half - paved;
    // The diagonals lie in two layers; the bevel keeps them off the zebras of the arms.
    let diagonal = Vec3::new(w * 0.95, 0.01, 3.4);
    props.push(Prop::new(PropKind::Zebra, at, diagonal).facing(45.0));
    props.push(Prop::new(PropKind::Zebra, at, diagonal + Vec3::Y * 0.01).facing(-45.0));
    for quarter in 0..4_u8 {
        let heading = f32::from(quarter) * 90.0;
        let out = |along: f32, across: f32| {
            // `along` leads away from the intersection, `across` to the side.
            at + match quarter {
                0 => Vec2::new(across, along),
                1 => Vec2::new(along, -across),
                2 => Vec2::new(-across, -along),
                _ => Vec2::new(-along, across),
            }
        };
        let stripes = Vec3::new(2.0 * kerb - 0.6, 0.01, 4.0);
        props.push(Prop::new(PropKind::Zebra, out(half + 2.6, 0.0), stripes).facing(heading));
        for line in 0..4_u8 {
            let center = out(half + 7.0 + 4.0 * f32::from(line), 0.0);
            if 9.0 + 4.0 * f32::from(line) < city.block {
                props.push(Prop::new(PropKind::Line, center, Vec3::new(0.2, 0.01, 2.0)).facing(heading));
            }
        }
        for side in [-1.0, 1.0] {
            // Half the block's side each way: the neighbouring intersection paves the other half.
            let length = if city.streets == 1 { city.block } else { city.block * 0.5 };
            let center = out(half + length * 0.5, side * (half - paved * 0.5));
            let slab = Vec3::new(paved, 0.01, length);
            props.push(Prop::new(PropKind::Pavement, center, slab).facing(heading));
            let light = out(half + 0.6, side * (kerb + 0.35));
            let facing = heading + if side > 0.0 { 0.0 } else { 180.0 };
            props.push(
                Prop::new(PropKind::TrafficLight, light, Vec3::new(0.4, 3.6, 0.4)).facing(facing % 360.0),
            );
            let mut along = half + 9.0;
            while along < half + length - 1.0 {
                let lamp =
                    Prop::new(PropKind::Lamp, out(along, side * (kerb + 0.35)), Vec3::new(0.3, 5.5, 1.2));
                props.push(lamp.facing((heading - side * 90.0) % 360.0));
                along += 18.0;
            }
        }
    }
}

/// Beyond the bounds: waiting cars, street trees and a house that closes the view.
fn street_ends(city: &City, props: &mut Vec<Prop>) {
    let half = city.half();
    for (n, &line) in city.lines().iter().enumerate() {
        for quarter in 0..4_u8 {
            let heading = f32::from(quarter) * 90.0;
            let place = |along: f32, across: f32| match quarter {
                0 => Vec2::new(line + across, half + along),
                1 => Vec2::new(half + along, line + across),
                2 => Vec2::new(line + across, -half - along),
                _ => Vec2::new(-half - along, line + across),
            };
            for car in 0..6_u8 {
                let (row, lane) = (f32::from(car / 2), f32::from(car % 2) * 2.0 - 1.0);
                let at = place(4.0 + 6.5 * row, lane * city.width * 0.14);
                // Towards the crossing on one side, away from it on the other.
                let facing = if lane > 0.0 { heading } else { heading + 180.0 };
                let size = Vec3::new(1.85, 1.5, 4.4);
                props.push(Prop::new(PropKind::Car, at, size).facing(facing % 360.0).scenery());
            }
            for side in [-0.42, 0.42] {
                let tree = Prop::new(PropKind::Tree, place(6.0, side * city.width), Vec3::new(4.0, 7.0, 4.0));
                props.push(tree.scenery());
            }
            let seed = u32::try_from(n).unwrap_or(0) * 4 + u32::from(quarter);
            let tall = range(0, seed, Purpose::Scenery, 9, 14.0, 40.0);
            let wide = Vec3::new(city.width + city.block, tall, 16.0);
            props.push(
                Prop::new(PropKind::Building, place(40.0, 0.0), wide).facing(heading % 180.0).scenery(),
            );
        }
    }
}

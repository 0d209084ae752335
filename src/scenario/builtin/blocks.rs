//! Streets and blocks: what the layouts of the built-in scenes are made of.

use crate::scenario::file::{Ground, Point, Prop, Route, RouteMode};
use crate::scenario::polygon;
use glam::{Vec2, Vec3};

/// Clear space between the outermost lane of a route and the walls beside it, m.
pub(crate) const LANE_MARGIN: f32 = 0.9;

/// What a layout makes for a number of agents.
#[derive(Debug, Default)]
pub(crate) struct Generated {
    pub(crate) bounds: Vec<Vec2>,
    pub(crate) obstacles: Vec<Vec<Vec2>>,
    pub(crate) routes: Vec<Route>,
    pub(crate) ground: Ground,
    pub(crate) props: Vec<Prop>,
    /// Where a user stands, m.
    pub(crate) user_place: Option<Vec2>,
    /// Eye and target of the overview; `None`: a raised three-quarter view.
    pub(crate) overview: Option<(Vec3, Vec3)>,
}

/// Number `i` of `count` things `pitch` apart, centred on 0.
#[allow(clippy::cast_precision_loss, reason = "counts are far below 2^24")]
pub(crate) fn spaced(i: u32, count: u32, pitch: f32) -> f32 {
    (i as f32 - (count.saturating_sub(1)) as f32 * 0.5) * pitch
}

/// Rectangular streets and the ways along them.
#[derive(Debug)]
pub(crate) struct Streets {
    /// x of the middle of each street that runs along z, ascending.
    pub(crate) xs: Vec<f32>,
    /// z of the middle of each street that runs along x, ascending.
    pub(crate) zs: Vec<f32>,
    /// Least and greatest corner of the walkable rectangle, m.
    pub(crate) low: Vec2,
    /// See `low`.
    pub(crate) high: Vec2,
    /// Width of the streets that run along z (x) and along x (y), m.
    pub(crate) width: Vec2,
}

/// Most rectangles that are walked round, so that a huge scene keeps few routes.
const MAX_LOOPS: usize = 300;

impl Streets {
    /// Width left for lanes, m.
    fn lanes(width: f32) -> f32 {
        (width - 2.0 * LANE_MARGIN).max(0.0)
    }

    /// Up and down every street from end to end.
    pub(crate) fn straight(&self) -> Vec<Route> {
        let end = 1.5;
        let along_z = self.xs.iter().enumerate().map(|(i, &x)| {
            let ends = vec![[x, self.low.y + end], [x, self.high.y - end]];
            route(format!("avenue-{i}"), ends, Self::lanes(self.width.x), RouteMode::Patrol, 1.0)
        });
        let along_x = self.zs.iter().enumerate().map(|(i, &z)| {
            let ends = vec![[self.low.x + end, z], [self.high.x - end, z]];
            route(format!("street-{i}"), ends, Self::lanes(self.width.y), RouteMode::Patrol, 1.0)
        });
        along_z.chain(along_x).collect()
    }

    /// Round every block between neighbouring streets (round some of them in a huge scene).
    pub(crate) fn loops(&self, weight: f32) -> Vec<Route> {
        let width = Self::lanes(self.width.min_element());
        let blocks: Vec<(usize, usize)> =
            (1..self.xs.len()).flat_map(|i| (1..self.zs.len()).map(move |j| (i, j))).collect();
        let step = blocks.len().div_ceil(MAX_LOOPS).max(1);
        let around = |&(i, j): &(usize, usize)| {
            let (x0, x1, z0, z1) = (self.xs[i - 1], self.xs[i], self.zs[j - 1], self.zs[j]);
            let corners = vec![[x0, z0], [x1, z0], [x1, z1], [x0, z1]];
            route(format!("block-{i}-{j}"), corners, width, RouteMode::Loop, weight)
        };
        blocks.iter().step_by(step).map(around).collect()
    }
}

/// A route with the usual waypoint radius.
pub(crate) fn route(name: String, waypoints: Vec<Point>, width: f32, mode: RouteMode, weight: f32) -> Route {
    Route { name, waypoints, width, radius: 2.5, mode, weight }
}

/// A street grid of square blocks: how many streets each way, how wide, how large the blocks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blocks {
    /// Blocks per side, odd.
    pub(crate) count: u32,
    /// Side of a block, m.
    pub(crate) block: f32,
    /// Width of a path, m.
    pub(crate) path: f32,
}

impl Blocks {
    /// The smallest grid, ringed by paths, that keeps `agents` at or under `density` (agents/m²); beyond a
    /// hundred agents blocks and paths grow, too, so that a million agents do not need a hundred thousand blocks.
    /// `solid` is the share of a block's square that cannot be walked on.
    #[allow(clippy::cast_precision_loss, reason = "up to a million agents")]
    pub(crate) fn for_agents(agents: u32, density: f32, block: f32, path: f32, solid: f32) -> Self {
        let scale = libm::powf(agents as f32 / 60.0, 0.25).clamp(1.0, 6.0);
        let (block, path) = (block * scale, path * scale);
        let mut count = 3;
        let walkable = |count: u32| {
            let n = count as f32;
            (n * block + (n + 1.0) * path).powi(2) - (n * n - 1.0) * block * block * solid
        };
        while walkable(count) * density < agents as f32 && count < 999 {
            count += 2;
        }
        Self { count, block, path }
    }

    /// Distance from block to block, m.
    pub(crate) fn pitch(&self) -> f32 {
        self.block + self.path
    }

    /// Side of the whole square, outer paths included, m.
    #[allow(clippy::cast_precision_loss, reason = "a few hundred blocks")]
    pub(crate) fn side(&self) -> f32 {
        self.count as f32 * self.pitch() + self.path
    }

    /// Middles of all blocks but the central one.
    pub(crate) fn centers(self) -> impl Iterator<Item = Vec2> {
        let middle = self.count / 2;
        (0..self.count)
            .flat_map(move |i| (0..self.count).map(move |j| (i, j)))
            .filter(move |&cell| cell != (middle, middle))
            .map(move |(i, j)| {
                Vec2::new(spaced(i, self.count, self.pitch()), spaced(j, self.count, self.pitch()))
            })
    }

    /// The paths between and around the blocks.
    pub(crate) fn streets(&self) -> Streets {
        let lines: Vec<f32> = (0..=self.count).map(|i| spaced(i, self.count + 1, self.pitch())).collect();
        let half = Vec2::splat(self.side() * 0.5);
        Streets { xs: lines.clone(), zs: lines, low: -half, high: half, width: Vec2::splat(self.path) }
    }

    /// The bounding square.
    pub(crate) fn outline(&self) -> Vec<Vec2> {
        polygon::oriented(polygon::rectangle(Vec2::ZERO, Vec2::splat(self.side()), 0.0), false)
    }
}

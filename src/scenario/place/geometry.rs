//! Geometry of a scenario: what its file says, plus what its generated layout adds for that many agents.

use super::clearance::Clearance;
use super::floors::Floors;
use super::mesh::{EnvironmentMesh, Finish};
use super::walkable::Area;
use super::walls::{self, Wall};
use crate::avatar::PlaceModel;
use crate::ground::world_from_ground;
use crate::scenario::builtin::{self, Generated, spaced};
use crate::scenario::file::{Environment, Layout, Obstacle, Point, Prop, Route, Scenario, Spawn, User};
use crate::scenario::polygon;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Rows and columns of places that are tried for a user whom the middle has no room for.
const SEARCHED: u32 = 64;

/// Everything of a scenario that has a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Outer outline of the walkable area, clockwise on (x, z): the walkable side is to the right of each edge.
    pub bounds: Vec<Vec2>,
    /// Solid polygons, counter-clockwise on (x, z): the walkable side is to the right of each edge, too.
    pub obstacles: Vec<Vec<Vec2>>,
    /// Start regions; none: agents start along their routes.
    pub spawns: Vec<Spawn>,
    /// Routes.
    pub routes: Vec<Route>,
    /// Scenery.
    pub environment: Environment,
    /// Floors above the ground, and what is solid at some heights only.
    pub floors: Floors,
    /// Where the user starts, m; none: there is no user.
    pub user: Option<Vec2>,
    /// Height of the floor that the user starts on, m.
    pub user_elevation: f32,
    /// A camera that shows the place at a glance: eye, and the point looked at, m, world.
    pub overview: (Vec3, Vec3),
    /// What pictures are about, m: the user, the layout's place for one, or else the middle of the bounds.
    pub focus: Vec2,
    /// Where the user is, or the place that the layout has for one, m.
    user_place: Option<Vec2>,
    /// Obstacles, where no props show what is solid.
    walls: Vec<Wall>,
    /// The model of the place, once it is read.
    pub(crate) place: Option<Arc<PlaceModel>>,
}

impl Geometry {
    /// The mesh of everything that stands still: ground, props and floors; in a place without props its obstacles as low
    /// walls, if it has any, and a kerb along its bounds.
    pub fn scenery(&self) -> EnvironmentMesh {
        self.scenery_of(Finish::Plain)
    }

    /// The same with as much to show as its pictures have room for.
    #[doc(hidden)]
    pub fn scenery_of(&self, finish: Finish) -> EnvironmentMesh {
        let mut mesh = self.environment.mesh(&self.bounds, self.focus, finish);
        self.floors.draw(&mut mesh);
        if !self.walls.is_empty() {
            walls::draw(&mut mesh, &self.walls, &self.bounds);
        }
        mesh.place.clone_from(&self.place);
        mesh
    }

    /// All closed outlines that agents must not cross, bounds first, in the orientation the solver wants.
    pub fn outlines(&self) -> impl Iterator<Item = &[Vec2]> {
        std::iter::once(self.bounds.as_slice()).chain(self.obstacles.iter().map(Vec::as_slice))
    }

    /// Area inside the bounds less that of the obstacles, m² (overlapping obstacles count twice).
    pub fn walkable_area(&self) -> f64 {
        let solid: f64 = self.obstacles.iter().map(|p| polygon::signed_area(p)).sum();
        -polygon::signed_area(&self.bounds) - solid
    }

    /// The user's eyes where the user of `scenario` starts, world, m; none: there is no user.
    pub fn eyes(&self, scenario: &Scenario) -> Option<Vec3> {
        scenario
            .user
            .zip(self.user)
            .map(|(user, at)| world_from_ground(at, self.user_elevation + user.eye_height))
    }

    /// Where a user of this radius can be put, m: the place of the layout, or the free one nearest to the middle.
    pub fn place_for_user(&self, radius: f32) -> Vec2 {
        if let Some(place) = self.user_place {
            return place;
        }
        let (low, high) = extent(&self.bounds);
        let middle = (low + high) * 0.5;
        let free = Clearance::new(&self.bounds, &self.obstacles);
        if free.admits(middle, radius) {
            return middle;
        }
        let lattice = (0..SEARCHED).flat_map(|i| (0..SEARCHED).map(move |j| (i, j)));
        lattice
            .map(|(i, j)| Vec2::new(spaced(i, SEARCHED, 1.0), spaced(j, SEARCHED, 1.0)))
            .map(|place| middle + place * (high - low) / (SEARCHED as f32))
            .filter(|&place| free.admits(place, radius))
            .min_by(|a, b| a.distance_squared(middle).total_cmp(&b.distance_squared(middle)))
            .unwrap_or(middle)
    }
}

impl Scenario {
    /// The geometry for the present number of agents. Cheap for the built-in sizes; a million agents make some
    /// ten thousand objects.
    pub fn geometry(&self) -> Geometry {
        let agents = self.population.agents;
        let mut made = builtin::generate(self.layout, agents).unwrap_or_else(|| self.area());
        let bounds = polygon::oriented(made.bounds, false);
        made.routes.extend(self.routes.iter().cloned());
        made.props.extend(self.environment.props.iter().cloned());
        let mut walls = Vec::new();
        if made.props.is_empty() && self.environment.glb.is_none() {
            let holes = made.obstacles.iter();
            walls.extend(holes.map(|hole| Wall { outline: hole.clone(), heights: [None; 2] }));
            walls.extend(self.obstacles.iter().map(|obstacle| Wall {
                outline: vectors(&obstacle.polygon),
                heights: [obstacle.low, obstacle.high],
            }));
        }
        let whole = self.obstacles.iter().filter(|obstacle| !obstacle.is_raised());
        made.obstacles.extend(whole.map(|obstacle| vectors(&obstacle.polygon)));
        let inside = |prop: &&Prop| polygon::contains(&bounds, Vec2::from(prop.position));
        made.obstacles.extend(made.props.iter().filter(inside).filter_map(Prop::footprint));
        let at = |user: &User| user.position.map_or(made.user_place.unwrap_or_default(), Vec2::from);
        let user = self.user.as_ref().map(at);
        let floors = Floors::new(&self.floors, &self.obstacles);
        let (low, high) = extent(&bounds);
        let focus = user.or(made.user_place).unwrap_or((low + high) * 0.5);
        Geometry {
            overview: made.overview.unwrap_or_else(|| overview(&bounds, focus)),
            obstacles: made.obstacles.into_iter().map(|p| polygon::oriented(p, true)).collect(),
            spawns: self.spawns.clone(),
            routes: made.routes,
            environment: Environment {
                glb: self.environment.glb.clone(),
                ground: self.environment.ground.or(self.environment.glb.is_none().then_some(made.ground)),
                props: made.props,
            },
            user_elevation: user.zip(self.user).map_or(0.0, |(at, user)| floors.height(at, user.elevation)),
            floors,
            user,
            focus,
            user_place: user.or(made.user_place),
            bounds,
            walls,
            place: None,
        }
    }

    /// Bounds and holes of a scenario without a layout. (Text that is no area was refused before: it gives none.)
    fn area(&self) -> Generated {
        if self.walkable_wkt.is_empty() {
            return Generated { bounds: vectors(&self.bounds), ..Generated::default() };
        }
        let area = Area::from_wkt_in(self.walkable_plane, &self.walkable_wkt).unwrap_or_default();
        Generated { bounds: area.bounds, obstacles: area.holes, ..Generated::default() }
    }

    /// Puts a user in where there is none ([`Geometry::place_for_user`]).
    pub fn put_in(&mut self, user: User) {
        if self.user.is_none() {
            let position =
                user.position.unwrap_or_else(|| self.geometry().place_for_user(user.radius).into());
            self.user = Some(User { position: Some(position), ..user });
        }
    }

    /// The same scenario with its generated geometry written out, to be edited by hand: layout `custom`.
    #[must_use]
    pub fn expanded(&self) -> Self {
        let agents = self.population.agents;
        let Some(made) = builtin::generate(self.layout, agents) else { return self.clone() };
        let mut own = self.clone();
        own.layout = Layout::Custom;
        own.bounds = points(&made.bounds);
        if let (Some(user), Some(place)) = (&mut own.user, made.user_place) {
            user.position.get_or_insert(place.into());
        }
        own.environment.ground.get_or_insert(made.ground);
        let solid = |polygon: &Vec<Vec2>| Obstacle { polygon: points(polygon), low: None, high: None };
        own.obstacles.splice(0..0, made.obstacles.iter().map(solid));
        own.routes.splice(0..0, made.routes);
        own.environment.props.splice(0..0, made.props);
        own
    }
}

fn vectors(points: &[Point]) -> Vec<Vec2> {
    points.iter().copied().map(Vec2::from).collect()
}

fn points(vectors: &[Vec2]) -> Vec<Point> {
    vectors.iter().map(Vec2::to_array).collect()
}

/// A raised three-quarter view from the south of the focus, far enough back to take in at most 150 m.
fn overview(bounds: &[Vec2], focus: Vec2) -> (Vec3, Vec3) {
    let (low, high) = extent(bounds);
    let reach = ((high.max(focus) - low.min(focus)).max_element() * 0.5).clamp(8.0, 75.0);
    let eye = Vec3::new(focus.x + 0.45 * reach, 0.62 * reach, focus.y + 0.95 * reach);
    (eye, Vec3::new(focus.x, 1.0, focus.y))
}

/// Least and greatest corner of an outline, m.
fn extent(outline: &[Vec2]) -> (Vec2, Vec2) {
    (outline.iter().copied().fold(Vec2::MAX, Vec2::min), outline.iter().copied().fold(Vec2::MIN, Vec2::max))
}

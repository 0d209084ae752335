//! Allowed ranges of every value of a scenario.

use super::environment::Prop;
use super::error::Error;
use super::floors;
use super::gaze::{Budget, Gaze};
use super::people;
use super::polygon;
use super::population::{EmotionMode, GaitChoice, GenderChoice, Population};
use super::schema::{Layout, Navigation, Point, Route, RouteMode, Scenario, Spawn, User, route_names};
use super::walkable::{Area, Plane};
use crate::spelling::nearest;
use glam::Vec2;

/// Most agents of one scenario.
pub const MAX_AGENTS: u32 = 1_000_000;
/// Most neighbours an agent may consider: the length of the kernels' neighbour list.
pub const MAX_NEIGHBOURS: u32 = 10;
/// Farthest coordinate, m: beyond it an f32 no longer resolves a centimetre.
pub const MAX_COORDINATE: f32 = 50_000.0;
/// Most people who walk together.
pub const MAX_GROUP: usize = 5;
/// Most corners of one polygon.
const MAX_CORNERS: usize = 1024;
/// Closest two corners of a polygon may be, m.
const MIN_EDGE: f32 = 1e-3;

impl Scenario {
    /// Checks every value against its range, and every name against what it refers to.
    ///
    /// # Errors
    /// [`Error::Value`] for the first wrong value: key, value, allowed range, way out.
    pub fn validate(&self) -> Result<(), Error> {
        let word = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if self.name.is_empty() || self.name.len() > 64 || !self.name.chars().all(word) {
            let allowed = "1 to 64 letters, digits, '-' or '_'";
            return Err(Error::value(
                "name",
                format!("{:?}", self.name),
                allowed,
                "files are named after it",
            ));
        }
        if i64::try_from(self.seed).is_err() {
            return Err(Error::value("seed", self.seed, "0 to 2^63 - 1", "TOML knows no larger integer"));
        }
        population(&self.population)?;
        navigation(&self.navigation)?;
        self.user.as_ref().map_or(Ok(()), user)?;
        gaze(&self.gaze)?;
        super::feelings::validate(self)?;
        super::outsiders::validate(self)?;
        self.way_finding.validate()?;
        let area = walkable(self)?;
        if area.is_some() {
            // outline and holes are in the text
        } else if self.layout == Layout::Custom {
            outline("bounds", &self.bounds, "the corners of the walkable area, in order")?;
        } else if !self.bounds.is_empty() {
            let hint = "remove it, or set layout = \"custom\"";
            return Err(Error::value("bounds", "[..]", "left out with a generated layout", hint));
        }
        let goes_nowhere = self.routes.is_empty() && self.journeys.is_empty();
        if self.layout == Layout::Custom && goes_nowhere && self.population.agents > 0 {
            let hint = "add a [[routes]] or a [[journeys]] table";
            return Err(Error::value("routes", "[]", "one route or journey or more", hint));
        }
        for (index, obstacle) in self.obstacles.iter().enumerate() {
            outline(
                &format!("obstacles[{index}].polygon"),
                &obstacle.polygon,
                "the corners of something solid",
            )?;
        }
        floors::validate(&self.floors, &self.obstacles)?;
        floors::validate_places(self)?;
        routes(&self.routes)?;
        spawns(&self.spawns, &self.routes, self.layout)?;
        super::journeys::validate(self)?;
        super::walkers::validate(self)?;
        if let Some(area) = area {
            super::walkable::check(self, &area)?;
        }
        self.environment.props.iter().enumerate().try_for_each(|(index, item)| prop(index, item))?;
        match self.user {
            Some(user) if user.elevation.abs() > 0.0 => {
                let geometry = self.geometry();
                floors::validate_user(&geometry.floors, geometry.user.unwrap_or_default(), user.elevation)
            }
            _ => Ok(()),
        }
    }
}

/// The walkable area, where it is given as text.
fn walkable(scenario: &Scenario) -> Result<Option<Area>, Error> {
    if !scenario.walkable_file.is_empty() {
        let hint = "read the scenario from a file, or give the area as walkable_wkt";
        let allowed = "the name of a file beside the scenario's";
        return Err(Error::value("walkable_file", format!("{:?}", scenario.walkable_file), allowed, hint));
    }
    if scenario.walkable_wkt.is_empty() {
        return match &scenario.walkable_node {
            None if scenario.walkable_plane != Plane::default() => {
                let hint = "it is the plane of walkable_wkt; bounds are (x, z) always";
                Err(Error::value(
                    "walkable_plane",
                    "\"xz\"",
                    "left out without walkable_wkt or walkable_file",
                    hint,
                ))
            }
            None => Ok(None),
            Some(name) => {
                let hint = "it names a node of walkable_file";
                Err(Error::value(
                    "walkable_node",
                    format!("{name:?}"),
                    "left out without walkable_file",
                    hint,
                ))
            }
        };
    }
    if scenario.layout != Layout::Custom || !scenario.bounds.is_empty() {
        let hint = "the walkable area is the bounds: leave out bounds and layout";
        return Err(Error::value("walkable_wkt", "..", "left out where bounds or a layout are given", hint));
    }
    match Area::from_wkt_in(scenario.walkable_plane, &scenario.walkable_wkt) {
        Ok(area) => Ok(Some(area)),
        Err(message) => {
            let allowed = "POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION of one area";
            Err(Error::value("walkable_wkt", message, allowed, "such as POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0))"))
        }
    }
}

/// A number within `low..=high`; NaN fails.
pub(super) fn within(key: &str, value: f32, low: f32, high: f32, hint: &str) -> Result<(), Error> {
    if value >= low && value <= high {
        return Ok(());
    }
    Err(Error::value(key, value, format!("{low} to {high}"), hint))
}

pub(super) fn point(key: &str, [x, z]: Point) -> Result<(), Error> {
    if x.abs() <= MAX_COORDINATE && z.abs() <= MAX_COORDINATE {
        return Ok(());
    }
    let allowed = format!("within {MAX_COORDINATE} m of the origin in x and z");
    Err(Error::value(key, format!("[{x}, {z}]"), allowed, "shift the scene towards the origin"))
}

fn population(population: &Population) -> Result<(), Error> {
    if population.agents > MAX_AGENTS {
        let hint = "split the crowd over several runs";
        return Err(Error::value("population.agents", population.agents, format!("0 to {MAX_AGENTS}"), hint));
    }
    let [low, high] = population.scale;
    if !(low >= 0.5 && low <= high && high <= 2.0) {
        let found = format!("[{low}, {high}]");
        return Err(Error::value(
            "population.scale",
            found,
            "[least, greatest] within 0.5 to 2",
            "try [0.93, 1.07]",
        ));
    }
    if population.avatars.is_empty() || population.avatars.len() > 256 {
        let found = format!("{} names", population.avatars.len());
        return Err(Error::value(
            "population.avatars",
            found,
            "1 to 256 names",
            "try [\"female\", \"male\"]",
        ));
    }
    genders(population)?;
    if let Some(index) = population.avatars.iter().position(|name| name.trim().is_empty()) {
        let key = format!("population.avatars[{index}]");
        return Err(Error::value(key, "\"\"", "the name or path of an avatar", "try \"female\" or \"male\""));
    }
    let e = population.emotions;
    for (name, share) in [("happy", e.happy), ("angry", e.angry), ("sad", e.sad), ("neutral", e.neutral)] {
        within(
            &format!("population.emotions.{name}"),
            share,
            0.0,
            1e6,
            "shares are relative: 1 and 1 is half each",
        )?;
    }
    if e.normalised().iter().all(|&share| share <= 0.0) {
        let hint = "give at least one emotion a share, such as neutral = 1.0";
        return Err(Error::value("population.emotions", "all 0", "a sum above 0", hint));
    }
    groups(&population.groups.sizes)?;
    people::validate(population)
}

/// Sizes of groups.
fn groups(sizes: &[f32]) -> Result<(), Error> {
    if sizes.len() > MAX_GROUP {
        let (found, allowed) = (format!("{} shares", sizes.len()), format!("at most {MAX_GROUP}"));
        let hint = "shares of groups of 1, 2, ... people; larger ones split up when they walk";
        return Err(Error::value("population.groups.sizes", found, allowed, hint));
    }
    for (index, &share) in sizes.iter().enumerate() {
        let key = format!("population.groups.sizes[{index}]");
        within(&key, share, 0.0, 1e6, "shares are relative: 1 and 1 is half each")?;
    }
    if !sizes.is_empty() && sizes.iter().all(|share| *share <= 0.0) {
        let hint = "try [0.5, 0.35, 0.1, 0.05], or leave population.groups out";
        return Err(Error::value("population.groups.sizes", "all 0", "a sum above 0", hint));
    }
    Ok(())
}

/// Genders of avatars, and what gaits are preferred by.
fn genders(population: &Population) -> Result<(), Error> {
    let (avatars, genders) = (population.avatars.len(), population.avatar_genders.len());
    if genders > 0 && genders != avatars {
        let allowed = format!("one for each of the {avatars} avatars, or left out");
        let hint = "female or male, in the order of population.avatars";
        return Err(Error::value("population.avatar_genders", format!("{genders} genders"), allowed, hint));
    }
    let prefer = &population.prefer;
    let by_avatar = matches!(prefer.gender, GenderChoice::Match | GenderChoice::Counter);
    let unknown = (0..avatars).find(|&avatar| population.gender_of(avatar).is_none()).filter(|_| by_avatar);
    if let Some(name) = unknown.and_then(|avatar| population.avatars.get(avatar)) {
        let found = if prefer.gender == GenderChoice::Match { "match" } else { "counter" };
        let hint = format!("the gender of avatar {name:?} is not known: say it in population.avatar_genders");
        return Err(Error::value("population.prefer.gender", found, "any, female or male", hint));
    }
    if let Some([low, high]) = prefer.speed
        && !(low >= 0.1 && low <= high && high <= 5.0)
    {
        let found = format!("[{low}, {high}]");
        let allowed = "a speed or [least, greatest] within 0.1 to 5 m/s";
        return Err(Error::value("population.prefer.speed", found, allowed, "people walk at 0.8 to 1.8"));
    }
    within("population.prefer.speed_tolerance", prefer.speed_tolerance, 0.0, 5.0, "m/s; 0.1 is usual")?;
    if let Some(temperature) = prefer.margin_temperature {
        let hint = "rating points; 0.5 is a clear preference, 0 takes the clearest gait always";
        within("population.prefer.margin_temperature", temperature, 0.0, 100.0, hint)?;
    }
    if !prefer.is_nothing() && population.gaits != GaitChoice::Random {
        let found = if population.gaits == GaitChoice::Cycle { "cycle" } else { "first" };
        let hint = "or leave population.prefer out";
        return Err(Error::value("population.gaits", found, "random where population.prefer is given", hint));
    }
    affect(population)
}

fn affect(population: &Population) -> Result<(), Error> {
    match (population.emotion_mode, population.affect) {
        (EmotionMode::Affect, None) => {
            let allowed = "draw or blend where population.affect is left out";
            let hint = "add affect = { valence = [-1, 1], arousal = [-1, 1] } to [population]";
            Err(Error::value("population.emotion_mode", "affect", allowed, hint))
        }
        (EmotionMode::Draw | EmotionMode::Blend, Some(_)) => {
            let hint = "it would not be heeded: set emotion_mode = \"affect\"";
            Err(Error::value("population.affect", "{..}", "left out with this emotion_mode", hint))
        }
        (_, None) => Ok(()),
        (_, Some(affect)) => {
            for (name, [low, high]) in [("valence", affect.valence), ("arousal", affect.arousal)] {
                if !(low >= -1.0 && low <= high && high <= 1.0) {
                    let (key, found) = (format!("population.affect.{name}"), format!("[{low}, {high}]"));
                    let allowed = "a number or [least, greatest] within -1 to 1";
                    return Err(Error::value(key, found, allowed, "0 is neither; try [-0.5, 0.5]"));
                }
            }
            Ok(())
        }
    }
}

fn navigation(n: &Navigation) -> Result<(), Error> {
    within("navigation.time_step", n.time_step, 0.001, 0.2, "1/30 s = 0.0333 is usual")?;
    within("navigation.neighbour_distance", n.neighbour_distance, 0.5, 50.0, "metres; 5 is usual")?;
    if !(1..=MAX_NEIGHBOURS).contains(&n.neighbour_cap) {
        let allowed = format!("1 to {MAX_NEIGHBOURS}");
        return Err(Error::value("navigation.neighbour_cap", n.neighbour_cap, allowed, "10 is usual"));
    }
    within("navigation.time_horizon", n.time_horizon, 0.1, 20.0, "seconds; 2 is usual")?;
    within(
        "navigation.time_horizon_obstacles",
        n.time_horizon_obstacles,
        0.1,
        20.0,
        "seconds; 0.5 to 1 is usual",
    )?;
    within("navigation.radius", n.radius, 0.05, 2.0, "metres; 0.2 is usual")?;
    within(
        "navigation.max_speed_factor",
        n.max_speed_factor,
        1.0,
        10.0,
        "times the preferred speed; 1.5 is usual",
    )?;
    within("navigation.max_speed", n.max_speed, 0.1, 10.0, "metres a second; 2.5 is usual")?;
    within("navigation.collision_weight", n.collision_weight, 0.0, 100.0, "metres; 1 is usual")?;
    within("navigation.patience", n.patience, 0.0, 600.0, "seconds; 1 is usual, 0 is never")?;
    within("navigation.max_acceleration", n.max_acceleration, 0.1, 100.0, "m/s2; 10 is usual")?;
    within("navigation.perturbation", n.perturbation, 0.0, 0.5, "m/s; 0.02 is usual")?;
    within(
        "navigation.time_horizon_dense",
        n.time_horizon_dense,
        0.0,
        60.0,
        "seconds; 1 is usual, 0 is none",
    )?;
    within(
        "navigation.time_horizon_jam",
        n.time_horizon_jam,
        0.0,
        60.0,
        "seconds; 0.15 is usual, 0 is none",
    )?;
    within("navigation.crowding", n.crowding, 0.0, 1.0, "0 is off, 1 is Weidmann's fundamental diagram")?;
    within("navigation.safety_margin", n.safety_margin, 0.0, 1.0, "metres; 0.01 is usual")
}

fn user(user: &User) -> Result<(), Error> {
    if let Some(position) = user.position {
        point("user.position", position)?;
    }
    within("user.heading_deg", user.heading_deg, -360.0, 360.0, "degrees; 0 looks along +z")?;
    within("user.elevation", user.elevation, -100.0, 100.0, "metres above the ground; 0 is the ground")?;
    within("user.eye_height", user.eye_height, 0.3, 2.5, "metres; 1.65 is usual")?;
    within("user.radius", user.radius, 0.05, 5.0, "metres; 0.3 is usual")?;
    within("user.comfort", user.comfort, 0.0, 5.0, "metres; 0.5 is usual")
}

fn gaze(gaze: &Gaze) -> Result<(), Error> {
    if let Some(Budget::Most(count)) = gaze.budget
        && count > MAX_AGENTS
    {
        let allowed = format!("0 to {MAX_AGENTS}, or \"all\"");
        return Err(Error::value("gaze.budget", count, allowed, "12 is usual"));
    }
    let [least, most] = gaze.turn;
    if !(least >= 0.1 && least <= most && most <= 60.0) {
        let allowed = "[shortest, longest] within 0.1 to 60 s";
        return Err(Error::value("gaze.turn", format!("[{least}, {most}]"), allowed, "try [1, 4]"));
    }
    Ok(())
}

/// A simple closed polygon.
pub(super) fn outline(key: &str, corners: &[Point], hint: &str) -> Result<(), Error> {
    if !(3..=MAX_CORNERS).contains(&corners.len()) {
        let found = format!("{} corners", corners.len());
        return Err(Error::value(key, found, format!("3 to {MAX_CORNERS} corners"), hint));
    }
    for (index, &corner) in corners.iter().enumerate() {
        point(&format!("{key}[{index}]"), corner)?;
    }
    let polygon: Vec<Vec2> = corners.iter().copied().map(Vec2::from).collect();
    for (index, (a, b)) in polygon::edges(&polygon).enumerate() {
        if a.distance(b) < MIN_EDGE {
            let allowed = format!("at least {MIN_EDGE} m from the next corner");
            let hint = "remove the doubled corner; the polygon closes by itself";
            return Err(Error::value(format!("{key}[{index}]"), a, allowed, hint));
        }
    }
    if let Some((i, j)) = polygon::self_intersection(&polygon) {
        let found = format!("edges {i} and {j} cross");
        return Err(Error::value(
            key,
            found,
            "an outline that does not cross itself",
            "put the corners in order",
        ));
    }
    Ok(())
}

fn routes(routes: &[Route]) -> Result<(), Error> {
    let names = route_names(routes);
    for (index, route) in routes.iter().enumerate() {
        let key = |field: &str| format!("routes[{index}].{field}");
        if route.name.is_empty() || names.get(route.name.as_str()) != Some(&index) {
            let found = format!("{:?}", route.name);
            return Err(Error::value(key("name"), found, "a name no other route has", "rename this route"));
        }
        let least = if route.mode == RouteMode::Loop { 3 } else { 2 };
        if !(least..=MAX_CORNERS).contains(&route.waypoints.len()) {
            let found = format!("{} points", route.waypoints.len());
            let allowed = format!("{least} to {MAX_CORNERS} points");
            return Err(Error::value(key("waypoints"), found, allowed, "list the corners of the way"));
        }
        for (i, &waypoint) in route.waypoints.iter().enumerate() {
            point(&format!("routes[{index}].waypoints[{i}]"), waypoint)?;
            let next = route.waypoints.get(i + 1).copied().unwrap_or(route.waypoints[0]);
            let last = i + 1 == route.waypoints.len() && route.mode != RouteMode::Loop;
            if !last && Vec2::from(waypoint).distance(Vec2::from(next)) < 0.5 {
                let key = format!("routes[{index}].waypoints[{i}]");
                let found = format!("{waypoint:?}");
                return Err(Error::value(
                    key,
                    found,
                    "at least 0.5 m from the next one",
                    "remove one of the two",
                ));
            }
        }
        within(&key("width"), route.width, 0.0, 10_000.0, "metres; 0 is a single lane")?;
        within(&key("radius"), route.radius, 0.3, 50.0, "metres; 1 to 3 is usual")?;
        within(&key("weight"), route.weight, 0.0, 1e6, "1 is as busy as the other routes")?;
    }
    Ok(())
}

fn spawns(spawns: &[Spawn], routes: &[Route], layout: Layout) -> Result<(), Error> {
    let names: Vec<&str> = routes.iter().map(|route| route.name.as_str()).collect();
    for (index, spawn) in spawns.iter().enumerate() {
        outline(&format!("spawns[{index}].polygon"), &spawn.polygon, "the corners of the region")?;
        if let Some(weight) = spawn.weight {
            within(&format!("spawns[{index}].weight"), weight, 0.0, 1e9, "relative to the other regions")?;
        }
        for (i, name) in spawn.routes.iter().enumerate() {
            // Names of generated routes are checked when the layout is made.
            if layout == Layout::Custom && !names.contains(&name.as_str()) {
                let hint = nearest(name, &names).map_or_else(
                    || format!("the routes are {}", names.join(", ")),
                    |near| format!("did you mean {near:?}?"),
                );
                let key = format!("spawns[{index}].routes[{i}]");
                return Err(Error::value(key, format!("{name:?}"), "the name of a route", hint));
            }
        }
    }
    Ok(())
}

fn prop(index: usize, prop: &Prop) -> Result<(), Error> {
    point(&format!("environment.props[{index}].position"), prop.position)?;
    let key = format!("environment.props[{index}].heading_deg");
    within(&key, prop.heading_deg, -360.0, 360.0, "degrees about +y")?;
    for (i, &length) in prop.size.iter().enumerate() {
        let key = format!("environment.props[{index}].size[{i}]");
        within(&key, length, 0.01, 20_000.0, "metres: [width, height, depth]")?;
    }
    Ok(())
}

//! Routes and spawn regions.

use super::ranges::{MAX_CORNERS, outline, point, within};
use crate::scenario::error::Error;
use crate::scenario::file::{Layout, Route, RouteMode, Spawn, route_names};
use crate::spelling::suggestion;
use glam::Vec2;

pub(super) fn check(routes: &[Route]) -> Result<(), Error> {
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
        within(&key("width"), route.width)?;
        within(&key("radius"), route.radius)?;
        within(&key("weight"), route.weight)?;
    }
    Ok(())
}

pub(super) fn check_spawns(spawns: &[Spawn], routes: &[Route], layout: Layout) -> Result<(), Error> {
    let names: Vec<&str> = routes.iter().map(|route| route.name.as_str()).collect();
    for (index, spawn) in spawns.iter().enumerate() {
        outline(&format!("spawns[{index}].polygon"), &spawn.polygon, "the corners of the region")?;
        if let Some(weight) = spawn.weight {
            within(&format!("spawns[{index}].weight"), weight)?;
        }
        for (i, name) in spawn.routes.iter().enumerate() {
            // Names of generated routes are checked when the layout is made.
            if layout == Layout::Custom && !names.contains(&name.as_str()) {
                let hint = suggestion(name, &names, "the routes are");
                let key = format!("spawns[{index}].routes[{i}]");
                return Err(Error::value(key, format!("{name:?}"), "the name of a route", hint));
            }
        }
    }
    Ok(())
}

//! Whether what a scenario places lies in its walkable area: a plan in another plane lies beside it.

use crate::scenario::error::Error;
use crate::scenario::file::{Plane, Point, Scenario};
use crate::scenario::place::Area;
use glam::Vec2;

/// How far outside a point may lie, m: coordinates are rounded.
const SLACK: f32 = 0.01;

/// Checks stages, spawn regions, sources, obstacles, routes and walkers against the walkable area.
///
/// # Errors
/// [`Error::Value`] for the first that has no part in it.
pub(super) fn check(scenario: &Scenario, area: &Area) -> Result<(), Error> {
    let place = Placed { area, plane: scenario.walkable_plane };
    for (index, stage) in scenario.stages.iter().enumerate() {
        let key = format!("stages[{index}].position");
        let middle = Vec2::from(stage.position);
        let [along, across] = stage.half_axes();
        if stage.size.is_some() {
            let region = [
                middle - along - across,
                middle + along - across,
                middle + along + across,
                middle - along + across,
            ];
            place.region(&key, stage.position, &region)?;
        } else {
            place.point(&key, stage.position, stage.radius.unwrap_or(0.0))?;
        }
    }
    let regions = scenario.spawns.iter().map(|spawn| ("spawns", &spawn.polygon)).enumerate();
    let sources = scenario.sources.iter().map(|source| ("sources", &source.polygon)).enumerate();
    let obstacles = scenario.obstacles.iter().map(|obstacle| ("obstacles", &obstacle.polygon)).enumerate();
    for (index, (name, corners)) in regions.chain(sources).chain(obstacles) {
        let outline: Vec<Vec2> = corners.iter().copied().map(Vec2::from).collect();
        if let Some(first) = corners.first() {
            place.region(&format!("{name}[{index}].polygon"), *first, &outline)?;
        }
    }
    for (index, route) in scenario.routes.iter().enumerate() {
        for (k, waypoint) in route.waypoints.iter().enumerate() {
            place.point(&format!("routes[{index}].waypoints[{k}]"), *waypoint, route.radius)?;
        }
    }
    for (index, walker) in scenario.walkers.iter().enumerate() {
        place.point(&format!("walkers[{index}].position"), walker.position, 0.0)?;
    }
    Ok(())
}

/// The area, and the plane that its text is in.
struct Placed<'a> {
    area: &'a Area,
    plane: Plane,
}

impl Placed<'_> {
    fn point(&self, key: &str, at: Point, reach: f32) -> Result<(), Error> {
        let reaches = |at: Vec2| self.area.contains(at) || self.area.distance(at) <= reach + SLACK;
        if reaches(at.into()) {
            return Ok(());
        }
        Err(self.outside(key, at, reaches(mirrored(at.into()))))
    }

    /// `at` is the point named when no part of the region is inside.
    fn region(&self, key: &str, at: Point, region: &[Vec2]) -> Result<(), Error> {
        if self.area.meets(region) {
            return Ok(());
        }
        let other: Vec<Vec2> = region.iter().copied().map(mirrored).collect();
        Err(self.outside(key, at, self.area.meets(&other)))
    }

    fn outside(&self, key: &str, [x, z]: Point, would_mirrored: bool) -> Error {
        let low = self.area.bounds.iter().copied().fold(Vec2::MAX, Vec2::min);
        let high = self.area.bounds.iter().copied().fold(Vec2::MIN, Vec2::max);
        let allowed = format!(
            "inside the walkable area (x {:.2} to {:.2}, z {:.2} to {:.2})",
            low.x,
            high.x,
            low.y + 0.0, // a zero without a sign
            high.y + 0.0
        );
        let hint = match (would_mirrored, self.plane) {
            (true, Plane::Xy) => format!(
                "walkable_wkt is in the plane (x, y = -z), all else in (x, z): write [{x}, {}], or set \
                 walkable_plane = \"xz\"",
                0.0 - z
            ),
            (true, Plane::Xz) => {
                "walkable_plane = \"xz\" says that the area has z as it is; left out, it has y = -z".into()
            }
            (false, _) => "move it inside, or enlarge the area".into(),
        };
        Error::value(key, format!("[{x}, {z}]"), allowed, hint)
    }
}

fn mirrored(at: Vec2) -> Vec2 {
    Vec2::new(at.x, -at.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plan of 20 m by 10 m with a pillar, whose text has y from 0 to 10, and what follows line 5.
    fn refused(plane: &str, extra: &str) -> Option<String> {
        let text = format!(
            "name = \"hall\"\nwalkable_wkt = \"POLYGON ((0 0, 20 0, 20 10, 0 10, 0 0), (9 4, 11 4, 11 6, 9 6, 9 4))\"\n\
             {plane}\n[population]\nagents = 0\n{extra}\n"
        );
        Scenario::parse(&text, "hall.toml").err().map(|error| error.to_string())
    }

    const STAGE: &str = "[[stages]]\nname = \"out\"\nkind = \"exit\"\nsize = [1, 1]\nposition = ";

    #[test]
    fn what_lies_outside_of_the_plan_is_an_error_with_file_and_line_that_names_the_plane() {
        assert_eq!(refused("", &format!("{STAGE}[3, -4]")), None);
        let said = refused("", &format!("{STAGE}[3, 4]")).unwrap();
        for part in
            ["hall.toml:10: stages[0].position", "z -10.00 to 0.00", "y = -z", "[3, -4]", "walkable_plane"]
        {
            assert!(said.contains(part), "{part}: {said}");
        }
        let square = |x: f32, z: f32| {
            format!("[[{x}, {z}], [{}, {z}], [{}, {}], [{x}, {}]]", x + 1.0, x + 1.0, z + 1.0, z + 1.0)
        };
        for (extra, key) in [
            (format!("[[spawns]]\npolygon = {}", square(2.0, 2.0)), "hall.toml:7: spawns[0].polygon"),
            (format!("[[obstacles]]\npolygon = {}", square(2.0, 2.0)), "hall.toml:7: obstacles[0].polygon"),
            (format!("[[obstacles]]\npolygon = {}", square(9.5, -5.5)), "hall.toml:7: obstacles[0].polygon"),
            (
                "[[routes]]\nname = \"r\"\nwaypoints = [[1, -1], [5, 6]]".into(),
                "hall.toml:8: routes[0].waypoints[1]",
            ),
            ("[[walkers]]\nposition = [1, 1]".into(), "hall.toml:7: walkers[0].position"),
            (format!("{STAGE}[30, 4]"), "move it inside"),
        ] {
            let said = refused("", &extra).unwrap_or_default();
            assert!(said.contains(key), "{extra}: {said}");
        }
        // partly outside, or as near as a waypoint is wide
        assert_eq!(refused("", &format!("[[obstacles]]\npolygon = {}", square(19.5, -0.5))), None);
        assert_eq!(
            refused("", "[[routes]]\nname = \"r\"\nwaypoints = [[1, -1], [5, 0.5]]\nradius = 1"),
            None
        );
    }

    #[test]
    fn a_plan_may_have_z_instead_of_y() {
        assert_eq!(refused("walkable_plane = \"xz\"", &format!("{STAGE}[3, 4]")), None);
        let said = refused("walkable_plane = \"xz\"", &format!("{STAGE}[3, -4]")).unwrap();
        assert!(said.contains("z 0.00 to 10.00") && said.contains("\"xz\""), "{said}");
        let text = "name = \"hall\"\nwalkable_plane = \"xz\"\nbounds = [[0, 0], [9, 0], [9, 9]]\n[population]\nagents = 0\n";
        let said = Scenario::parse(text, "hall.toml").unwrap_err().to_string();
        assert!(said.contains("hall.toml:2: walkable_plane"), "{said}");
        let area = Area::from_wkt_in(Plane::Xz, "POLYGON ((0 0, 4 0, 4 3, 0 3))").unwrap();
        assert!(area.bounds.contains(&Vec2::new(4.0, 3.0)));
        assert_eq!(Area::from_wkt(&area.to_wkt()).unwrap(), area, "written in the plane xy");
    }
}

//! Floors, the heights of obstacles, and what stands on floors.

use super::ranges::{point, within, within_from};
use crate::kernels::shared::climb::STEP;
use crate::scenario::error::Error;
use crate::scenario::file::{Floor, MAX_FLOORS, Obstacle, Point, Scenario};
use crate::scenario::place::{Floors, MAX_FLOOR_CORNERS};
use crate::scenario::polygon;
use glam::Vec2;

/// Steepest floor: rise over run.
const MOST_SLOPE: f32 = 1.0;

fn floor(floor: &Floor, key: &str) -> Result<(), Error> {
    let count = floor.polygon.len();
    if !(3..=MAX_FLOOR_CORNERS).contains(&count) {
        let allowed = format!("3 to {MAX_FLOOR_CORNERS} corners");
        let hint = "make several floors of it that share edges";
        return Err(Error::value(format!("{key}.polygon"), format!("{count} corners"), allowed, hint));
    }
    for (index, &corner) in floor.polygon.iter().enumerate() {
        point(&format!("{key}.polygon[{index}]"), corner)?;
    }
    let corners = polygon::oriented(floor.corners(), true);
    let turns = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % count]);
        (b - a).perp_dot(c - b)
    };
    if !(0..count).all(|i| turns(i) > 1e-3) || polygon::self_intersection(&corners).is_some() {
        let hint = "no corner may point inwards or lie on a straight edge; split the floor";
        return Err(Error::value(format!("{key}.polygon"), "not convex", "a convex outline", hint));
    }
    if ![1, 3].contains(&floor.heights.len()) {
        let found = format!("{} numbers", floor.heights.len());
        let hint = "one for a level floor; three for a ramp: the heights of its first three corners";
        return Err(Error::value(format!("{key}.heights"), found, "1 or 3 numbers", hint));
    }
    for (index, &height) in floor.heights.iter().enumerate() {
        within(&format!("{key}.heights[{index}]"), height)?;
    }
    let slope = floor.plane().truncate().length();
    if !(0.0..=MOST_SLOPE).contains(&slope) {
        let hint = "people climb no more than 45 degrees: make the ramp longer";
        let allowed = format!("a slope of 0 to {MOST_SLOPE}");
        return Err(Error::value(format!("{key}.heights"), slope, allowed, hint));
    }
    for (index, &edge) in floor.railings.iter().enumerate() {
        if edge as usize >= count {
            let (key, allowed) = (format!("{key}.railings[{index}]"), format!("0 to {}", count - 1));
            return Err(Error::value(key, edge, allowed, "edge 0 leads from the first corner to the second"));
        }
    }
    Ok(())
}

/// Checks that there is a floor where the user is to stand.
pub(super) fn check_user(floors: &Floors, at: Vec2, elevation: f32) -> Result<(), Error> {
    stands(floors, "user.elevation", at, elevation, "choose one of these heights, or another user.position")
}

/// Checks that there is a floor, or the ground, where stages, spawn regions and sources say that they are.
pub(super) fn check_places(scenario: &Scenario) -> Result<(), Error> {
    let floors = Floors::new(&scenario.floors, &[]);
    let middle = |corners: &[Point]| {
        let sum = corners.iter().copied().map(Vec2::from).sum::<Vec2>();
        #[allow(clippy::cast_precision_loss, reason = "a few corners")]
        let count = corners.len().max(1) as f32;
        sum / count
    };
    let stages = scenario.stages.iter().map(|s| ("stages", Vec2::from(s.position), s.elevation)).enumerate();
    let spawns = scenario.spawns.iter().map(|s| ("spawns", middle(&s.polygon), s.elevation)).enumerate();
    let sources = scenario.sources.iter().map(|s| ("sources", middle(&s.polygon), s.elevation)).enumerate();
    for (index, (name, at, elevation)) in stages.chain(spawns).chain(sources) {
        if let Some(elevation) = elevation {
            let key = format!("{name}[{index}].elevation");
            within(&key, elevation)?;
            stands(&floors, &key, at, elevation, "choose one of these heights, or leave elevation out")?;
        }
    }
    Ok(())
}

/// Whether an agent can stand at a height, m.
fn stands(floors: &Floors, key: &str, at: Vec2, elevation: f32, hint: &str) -> Result<(), Error> {
    if floors.footing(at, elevation).is_some() {
        return Ok(());
    }
    let mut heights = floors.heights(at);
    heights.sort_by(f32::total_cmp);
    let heights: Vec<String> = heights.iter().map(|height| format!("{height:.2}")).collect();
    let allowed =
        format!("within a step of {STEP} m of a floor at ({}, {}): {}", at.x, at.y, heights.join(", "));
    Err(Error::value(key, elevation, allowed, hint))
}

/// Checks floors, and the heights of obstacles.
pub(super) fn check(floors: &[Floor], obstacles: &[Obstacle]) -> Result<(), Error> {
    if floors.len() > MAX_FLOORS {
        let (found, allowed) = (format!("{} floors", floors.len()), format!("at most {MAX_FLOORS}"));
        return Err(Error::value("floors", found, allowed, "join pieces that lie in one plane"));
    }
    for (index, floor) in floors.iter().enumerate() {
        self::floor(floor, &format!("floors[{index}]"))?;
    }
    for (index, obstacle) in obstacles.iter().enumerate() {
        let (low, high) = (obstacle.low.unwrap_or(-1000.0), obstacle.high.unwrap_or(1000.0));
        within(&format!("obstacles[{index}].low"), low)?;
        within_from(&format!("obstacles[{index}].high"), high, low)?;
        if obstacle.is_raised() && floors.is_empty() {
            let hint = "without [[floors]] everyone is on the ground: leave low and high out";
            return Err(Error::value(format!("obstacles[{index}]"), "low or high", "left out", hint));
        }
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn floors_that_are_not_convex_too_steep_or_railed_where_there_is_no_edge_are_refused() {
        let square = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let floor = |polygon: &[Point], heights: &[f32], railings: &[u32]| Floor {
            polygon: polygon.to_vec(),
            heights: heights.to_vec(),
            railings: railings.to_vec(),
        };
        let refused = |floor: Floor| check(&[floor], &[]).unwrap_err().to_string();
        check(&[floor(&square, &[3.0], &[3])], &[]).unwrap();
        let dart = [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]];
        assert!(refused(floor(&dart, &[3.0], &[])).contains("convex"));
        assert!(refused(floor(&square, &[0.0, 5.0, 5.0], &[])).contains("slope"));
        assert!(refused(floor(&square, &[0.0, 1.0], &[])).contains("heights"));
        assert!(refused(floor(&square, &[f32::NAN], &[])).contains("heights"));
        assert!(refused(floor(&square, &[3.0], &[4])).contains("railings"));
        assert!(refused(floor(&square[..2], &[3.0], &[])).contains("corners"));
    }
}

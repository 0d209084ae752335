//! Ranges that many sections share.

use crate::scenario::error::Error;
use crate::scenario::file::Point;
use crate::scenario::polygon::{self, MAX_COORDINATE};
use glam::Vec2;

/// Most corners of one polygon.
pub(super) const MAX_CORNERS: usize = 1024;
/// Closest two corners of a polygon may be, m.
const MIN_EDGE: f32 = 1e-3;

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

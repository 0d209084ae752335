//! Ranges that many sections share.

use crate::scenario::error::Error;
use crate::scenario::file::{Limits, MAX_COORDINATE, Point, Spread, limits};
use crate::scenario::polygon;
use glam::Vec2;

/// Most corners of one polygon.
pub(super) const MAX_CORNERS: usize = 1024;
/// Closest two corners of a polygon may be, m.
const MIN_EDGE: f32 = 1e-3;

/// The limits of a key. One that has none, which a test excludes, may not be written.
fn limits_of(key: &str) -> Result<&'static Limits, Error> {
    let unknown = || Error::value(key, "given", "left out", "no limits of this key are known");
    limits(key).ok_or_else(unknown)
}

/// A number within the limits of its key; NaN fails.
pub(super) fn within(key: &str, value: f32) -> Result<(), Error> {
    let limits = limits_of(key)?;
    within_from(key, value, limits.least)
}

/// The same, from another least on: no earlier than the row before, no lower than the other end.
pub(super) fn within_from(key: &str, value: f32, least: f32) -> Result<(), Error> {
    let Limits { greatest, hint, .. } = *limits_of(key)?;
    if value >= least && value <= greatest {
        return Ok(());
    }
    Err(Error::value(key, value, format!("{least} to {greatest}"), hint))
}

/// The same for how many.
pub(super) fn count(key: &str, value: u32) -> Result<(), Error> {
    let Limits { least, greatest, hint, .. } = *limits_of(key)?;
    if f64::from(value) >= f64::from(least) && f64::from(value) <= f64::from(greatest) {
        return Ok(());
    }
    Err(Error::value(key, value, format!("{least} to {greatest}"), hint))
}

/// Least and greatest within the limits of their key, in order. `one` is what can stand for both: `a speed or`.
pub(super) fn ends(key: &str, [low, high]: [f32; 2], one: &str) -> Result<(), Error> {
    let Limits { least, greatest, unit, hint, .. } = *limits_of(key)?;
    if low >= least && low <= high && high <= greatest {
        return Ok(());
    }
    let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
    let allowed = format!("{one}[least, greatest] within {least} to {greatest}{unit}");
    Err(Error::value(key, format!("[{low}, {high}]"), allowed, hint))
}

/// A number or how it is spread, all of which can be drawn within the limits of its key.
pub(super) fn spread(key: &str, spread: &Spread) -> Result<(), Error> {
    let Limits { least, greatest, hint, .. } = *limits_of(key)?;
    if let Spread::Normal(n) = spread {
        let most = greatest - least;
        if !(n.deviation >= 0.0 && n.deviation <= most) {
            let hint = "0 is the same for all";
            return Err(Error::value(format!("{key}.deviation"), n.deviation, format!("0 to {most}"), hint));
        }
    }
    let [low, high] = spread.ends();
    if low >= least && low <= high && high <= greatest {
        return Ok(());
    }
    let allowed =
        format!("a number, [least, greatest] or {{ mean, deviation }} within {least} to {greatest}");
    Err(Error::value(key, format!("{low} to {high}"), allowed, hint))
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

//! The walkable area of a recording, from well-known text.

use super::Found;
use crate::wkt::{self, Polygon};
use glam::DVec2;

/// Most corners of a walkable area.
const MAX_CORNERS: usize = 100_000;

/// Takes the largest polygon of a text, where there is one, or notes why there is none.
pub(super) fn take(text: Option<&str>, found: &mut Found) {
    match text.map(|text| wkt::polygons(text, f64::MAX)) {
        Some(Ok(polygons)) => {
            let (count, largest) = (polygons.len(), largest(polygons));
            let corners: usize = largest.iter().flatten().map(Vec::len).sum();
            match largest {
                None => found.notes.push("walkable area left out: it has no polygon".to_owned()),
                Some(_) if corners > MAX_CORNERS => {
                    found.notes.push(format!("walkable area left out: more than {MAX_CORNERS} corners"));
                }
                Some(rings) => {
                    if count > 1 {
                        found.notes.push(format!("{count} walkable polygons; the largest is taken"));
                    }
                    found.area = Some(rings);
                }
            }
        }
        Some(Err(why)) => found.notes.push(format!("walkable area left out: {why}")),
        None => found.notes.push("no walkable area".to_owned()),
    }
}

/// The polygon with the largest outer ring.
fn largest(polygons: Vec<Polygon>) -> Option<Polygon> {
    let size = |ring: &Vec<DVec2>| {
        let next = ring.iter().cycle().skip(1);
        (0.5 * ring.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()).abs()
    };
    let area = |polygon: &Polygon| polygon.first().map_or(0.0, size);
    polygons.into_iter().max_by(|a, b| area(a).total_cmp(&area(b)))
}

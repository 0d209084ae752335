//! Walkable areas as well-known text.

use glam::DVec2;

/// Most corners of an area.
const MAX_CORNERS: usize = 100_000;

/// The largest polygon of a `POLYGON`, `MULTIPOLYGON` or `GEOMETRYCOLLECTION`: outer ring first, then its holes, each
/// without the closing repetition of its first corner. Also how many polygons there were.
pub(super) fn polygon(text: &str) -> Result<(Vec<Vec<DVec2>>, usize), String> {
    let upper = text.trim_start().to_ascii_uppercase();
    let known = ["POLYGON", "MULTIPOLYGON", "GEOMETRYCOLLECTION"].iter().any(|name| upper.starts_with(name));
    if !known {
        return Err(format!("{:?} is no POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION", super::clip(text)));
    }
    // Rings are the innermost parentheses; a polygon's are closed together by one more.
    let mut polygons: Vec<Vec<Vec<DVec2>>> = Vec::new();
    let mut rings: Vec<Vec<DVec2>> = Vec::new();
    let (mut start, mut depth, mut corners) = (None, 0_usize, 0);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'(' => {
                depth += 1;
                start = Some(at + 1);
            }
            b')' => {
                depth = depth.checked_sub(1).ok_or("a parenthesis closes that never opened")?;
                match start.take() {
                    Some(start) => {
                        let ring = ring(&text[start..at])?;
                        corners += ring.len();
                        if corners > MAX_CORNERS {
                            return Err(format!("more than {MAX_CORNERS} corners"));
                        }
                        rings.push(ring);
                    }
                    None if !rings.is_empty() => polygons.push(std::mem::take(&mut rings)),
                    None => {}
                }
            }
            _ => {}
        }
    }
    if depth > 0 {
        return Err("a parenthesis is not closed".to_owned());
    }
    let count = polygons.len();
    let area = |polygon: &Vec<Vec<DVec2>>| polygon.first().map_or(0.0, |ring| ring_area(ring).abs());
    let largest = polygons.into_iter().max_by(|a, b| area(a).total_cmp(&area(b)));
    largest.map(|polygon| (polygon, count)).ok_or_else(|| "it has no polygon".to_owned())
}

fn ring_area(ring: &[DVec2]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    0.5 * ring.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
}

fn ring(text: &str) -> Result<Vec<DVec2>, String> {
    let mut ring = Vec::new();
    for corner in text.split(',') {
        let mut cells = corner.split_whitespace().map(str::parse::<f64>);
        match (cells.next(), cells.next()) {
            (Some(Ok(x)), Some(Ok(y))) if x.is_finite() && y.is_finite() => ring.push(DVec2::new(x, y)),
            _ => return Err(format!("{:?} is no corner", super::clip(corner))),
        }
    }
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    if ring.len() < 3 {
        return Err(format!("a ring of {} corners; it needs 3", ring.len()));
    }
    Ok(ring)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_come_without_their_closing_corner_and_the_largest_polygon_is_taken() {
        let text = "GEOMETRYCOLLECTION (POLYGON ((0 0, 1 0, 1 1, 0 0)), POLYGON((0 0, 9 0, 9 9, 0 9, 0 0), (1 1, 2 1, 2 2, 1 1)))";
        let (rings, count) = polygon(text).unwrap();
        assert_eq!((rings.len(), rings[0].len(), rings[1].len(), count), (2, 4, 3, 2));
        let multi = polygon("MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)), ((0 0, 3 0, 3 3, 0 0)))").unwrap();
        assert_eq!((multi.1, multi.0[0][1]), (2, DVec2::new(3.0, 0.0)));
    }

    #[test]
    fn what_is_no_area_says_why() {
        for (text, why) in [
            ("LINESTRING (0 0, 1 1)", "no POLYGON"),
            ("POLYGON ((0 0, 1 0", "not closed"),
            ("POLYGON ((0 0, 1 0))", "2 corners"),
            ("POLYGON ((0 0, x 0, 1 1))", "no corner"),
            ("POLYGON EMPTY", "no polygon"),
            ("POLYGON ))((", "never opened"),
        ] {
            let said = polygon(text).unwrap_err();
            assert!(said.contains(why), "{text}: {said}");
        }
    }
}

//! The `obsmat.txt` of the ETH and UCY data: frame, id, x, height, y, and the same of the velocity, in metres and m/s.

use super::{Error, Found, Row, number, syntax, whole};
use glam::DVec2;
use std::path::Path;

/// Both data sets were filmed at 25 frames per second.
const RATE: f64 = 25.0;

pub(super) fn parse(path: &Path, text: &str) -> Result<Found, Error> {
    let mut found = Found { usual_rate: Some(RATE), ..Found::default() };
    for (line, row) in (1..).zip(text.lines()) {
        let mut cells = row.split_whitespace();
        let Some(first) = cells.next().filter(|cell| !cell.starts_with('#')) else { continue };
        let frame = whole(path, line, "the frame", Some(first))?;
        let id = whole(path, line, "the id", cells.next())?;
        let x = number(path, line, "x", cells.next())?;
        number(path, line, "the height", cells.next())?;
        let y = number(path, line, "y", cells.next())?;
        let rest = cells.count();
        if rest != 3 {
            return Err(syntax(path, line, format!("{} columns; obsmat has 8", 5 + rest)));
        }
        found.rows.push(Row { id, frame, place: DVec2::new(x, y), facing: None, line });
    }
    Ok(found)
}

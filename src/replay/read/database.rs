//! `JuPedSim`'s SQLite trajectories, versions 1 and 2: tables `trajectory_data(frame, id, pos_x, pos_y, ori_x, ori_y)`,
//! `metadata(key, value)` with `version` and `fps`, `geometry(.., wkt)`.

use super::{Error, Format, Found, Row, area, unusable};
use glam::DVec2;
use rusqlite::{Connection, OpenFlags};
use std::path::Path;

pub(super) fn read(path: &Path) -> Result<Found, Error> {
    let wrong = |source: rusqlite::Error| Error::Sqlite { path: path.to_owned(), source: source.into() };
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(path, flags).map_err(wrong)?;
    let mut found =
        Found { format: Format::Sqlite, metres_per_unit: Some((1.0, "format")), ..Found::default() };
    let text = |key: &str| -> rusqlite::Result<Option<String>> {
        let mut statement =
            connection.prepare("SELECT CAST(value AS TEXT) FROM metadata WHERE key = ?1 LIMIT 1")?;
        let mut rows = statement.query([key])?;
        rows.next()?.map(|row| row.get(0)).transpose()
    };
    let version = text("version").map_err(wrong)?.unwrap_or_default();
    if !matches!(version.as_str(), "1" | "2") {
        let message = format!("trajectory database of version {:?}", super::clip(&version));
        return Err(unusable(path, message, "versions 1 and 2 of JuPedSim's are read"));
    }
    let rate = text("fps").map_err(wrong)?.and_then(|fps| fps.trim().parse().ok());
    found.frame_rate = rate.map(|rate| (rate, "file"));
    rows(&connection, path, &mut found)?;
    find_area(&connection, &mut found).map_err(wrong)?;
    Ok(found)
}

fn rows(connection: &Connection, path: &Path, found: &mut Found) -> Result<(), Error> {
    let wrong = |source: rusqlite::Error| Error::Sqlite { path: path.to_owned(), source: source.into() };
    let columns = "SELECT frame, id, pos_x, pos_y, ori_x, ori_y FROM trajectory_data";
    let mut statement = connection.prepare(columns).map_err(wrong)?;
    let mut rows = statement.query([]).map_err(wrong)?;
    while let Some(row) = rows.next().map_err(wrong)? {
        let line = found.rows.len() + 1;
        let number = |index| row.get::<_, f64>(index);
        let place = DVec2::new(number(2).map_err(wrong)?, number(3).map_err(wrong)?);
        // Orientation may be missing (NULL) or zero: then the heading is unknown.
        let facing = DVec2::new(number(4).unwrap_or(0.0), number(5).unwrap_or(0.0));
        let frame: i64 = row.get(0).map_err(wrong)?;
        found.rows.push(Row {
            id: row.get(1).map_err(wrong)?,
            #[allow(
                clippy::cast_precision_loss,
                reason = "an absurd number is refused, a plausible one is exact"
            )]
            frame: frame as f64,
            place,
            velocity: None,
            facing: (facing.is_finite() && facing.length_squared() > 1e-6).then(|| facing.to_angle()),
            line,
        });
    }
    Ok(())
}

fn find_area(connection: &Connection, found: &mut Found) -> rusqlite::Result<()> {
    let Ok(mut statement) = connection.prepare("SELECT wkt FROM geometry LIMIT 2") else {
        found.notes.push("no walkable area".to_owned());
        return Ok(());
    };
    let areas = statement.query_map([], |row| row.get::<_, String>(0))?.collect::<Result<Vec<_>, _>>()?;
    if areas.len() > 1 {
        found.notes.push("the walkable area changes in time; the first one is taken throughout".to_owned());
    }
    area::take(areas.first().map(String::as_str), found);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is found in a trajectory whose walkable area is this text.
    fn read_area(text: &str) -> Found {
        let connection = Connection::open_in_memory().unwrap();
        connection.execute_batch("CREATE TABLE geometry(wkt TEXT)").unwrap();
        connection.execute("INSERT INTO geometry VALUES (?1)", [text]).unwrap();
        let mut found = Found::default();
        find_area(&connection, &mut found).unwrap();
        found
    }

    #[test]
    fn rings_come_without_their_closing_corner_and_the_largest_polygon_is_taken() {
        let text = "GEOMETRYCOLLECTION (POLYGON ((0 0, 1 0, 1 1, 0 0)), POLYGON((0 0, 9 0, 9 9, 0 9, 0 0), (1 1, 2 1, 2 2, 1 1)))";
        let found = read_area(text);
        let rings = found.area.unwrap();
        assert_eq!((rings.len(), rings[0].len(), rings[1].len()), (2, 4, 3));
        assert_eq!(found.notes, ["2 walkable polygons; the largest is taken"]);
        let multi = read_area("MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)), ((0 0, 3 0, 3 3, 0 0)))");
        assert_eq!(multi.area.unwrap()[0][1], DVec2::new(3.0, 0.0));
    }

    #[test]
    fn what_is_no_area_says_why() {
        for (text, why) in [
            ("LINESTRING (0 0, 1 1)", "at byte 0: expected POLYGON"),
            ("POLYGON ((0 0, 1 0", "at byte 18: expected ',' or ')', found the end"),
            ("POLYGON ((0 0, 1 0))", "at byte 9: expected a ring of three corners or more"),
            ("POLYGON ((0 0, x 0, 1 1))", "at byte 15: expected a number"),
            ("POLYGON EMPTY", "it has no polygon"),
            ("POLYGON ))((", "at byte 8: expected '('"),
        ] {
            let found = read_area(text);
            assert!(found.area.is_none() && found.notes[0].contains(why), "{text}: {:?}", found.notes);
            assert!(found.notes[0].starts_with("walkable area left out: "), "{:?}", found.notes);
        }
    }
}

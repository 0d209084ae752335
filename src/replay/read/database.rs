//! `JuPedSim`'s SQLite trajectories, versions 1 and 2: tables `trajectory_data(frame, id, pos_x, pos_y, ori_x, ori_y)`,
//! `metadata(key, value)` with `version` and `fps`, `geometry(.., wkt)`.

use super::{Error, Format, Found, Row, unusable, wkt};
use glam::DVec2;
use rusqlite::{Connection, OpenFlags};
use std::path::Path;

pub(super) fn read(path: &Path) -> Result<Found, Error> {
    let wrong = |source| Error::Sqlite { path: path.to_owned(), source };
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
    area(&connection, &mut found).map_err(wrong)?;
    Ok(found)
}

fn rows(connection: &Connection, path: &Path, found: &mut Found) -> Result<(), Error> {
    let wrong = |source| Error::Sqlite { path: path.to_owned(), source };
    let columns = "SELECT frame, id, pos_x, pos_y, ori_x, ori_y FROM trajectory_data";
    let mut statement = connection.prepare(columns).map_err(wrong)?;
    let mut rows = statement.query([]).map_err(wrong)?;
    while let Some(row) = rows.next().map_err(wrong)? {
        let line = found.rows.len() + 1;
        let number = |index| row.get::<_, f64>(index);
        let place = DVec2::new(number(2).map_err(wrong)?, number(3).map_err(wrong)?);
        // Orientation may be missing (NULL) or zero: nobody said where they face.
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

fn area(connection: &Connection, found: &mut Found) -> rusqlite::Result<()> {
    let Ok(mut statement) = connection.prepare("SELECT wkt FROM geometry LIMIT 2") else {
        found.notes.push("no walkable area".to_owned());
        return Ok(());
    };
    let areas = statement.query_map([], |row| row.get::<_, String>(0))?.collect::<Result<Vec<_>, _>>()?;
    if areas.len() > 1 {
        found.notes.push("the walkable area changes in time; the first one is taken throughout".to_owned());
    }
    match areas.first().map(|text| wkt::polygon(text)) {
        Some(Ok((rings, count))) => {
            if count > 1 {
                found.notes.push(format!("{count} walkable polygons; the largest is taken"));
            }
            found.area = Some(rings);
        }
        Some(Err(why)) => found.notes.push(format!("walkable area left out: {why}")),
        None => found.notes.push("no walkable area".to_owned()),
    }
    Ok(())
}

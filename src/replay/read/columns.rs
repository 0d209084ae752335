//! Texts of columns: the Pedestrian Dynamics Data Archive, and CSV with named columns.

use super::{Error, Found, Options, Row, number, syntax, unusable, whole};
use glam::DVec2;
use std::path::Path;

/// The archive's text: comments that begin with `#`, then id, frame, x, y and perhaps z (place or height).
pub(super) fn parse_archive(path: &Path, text: &str, options: &Options) -> Result<Found, Error> {
    let mut found = Found::default();
    let mut heights = Vec::new();
    for (line, row) in (1..).zip(text.lines()) {
        let row = row.trim();
        if let Some(comment) = row.strip_prefix('#') {
            read_comment(comment, &mut found);
            continue;
        }
        if row.is_empty() {
            continue;
        }
        let mut cells =
            row.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|c| !c.is_empty());
        let id = whole(path, line, "the id", cells.next())?;
        let frame = whole(path, line, "the frame", cells.next())?;
        let x = number(path, line, "x", cells.next())?;
        let y = number(path, line, "y", cells.next())?;
        if let Some(cell) = cells.next() {
            heights.push(number(path, line, "z", Some(cell))?);
        }
        found.rows.push(Row { id, frame, place: DVec2::new(x, y), facing: None, line });
    }
    if found.metres_per_unit.is_none() && options.metres_per_unit.is_none() {
        infer_unit(&mut found, heights, options);
    }
    Ok(found)
}

/// Frame rate and unit out of a comment: `framerate: 25 fps`, `x/cm`, `in m`.
fn read_comment(comment: &str, found: &mut Found) {
    let lower = comment.to_ascii_lowercase();
    if let Some((_, rest)) = lower.split_once("framerate").or_else(|| lower.split_once("frame rate")) {
        let digits: String = rest
            .chars()
            .skip_while(|c| !c.is_ascii_digit())
            .take_while(|c| c.is_ascii_digit() || *c == '.')
            .collect();
        found.frame_rate = digits.parse().ok().filter(|rate: &f64| *rate > 0.0).or(found.frame_rate);
    }
    let unit = if lower.contains("x/cm") || lower.contains("[cm]") || lower.contains("in cm") {
        Some(0.01)
    } else if lower.contains("x/m") || lower.contains("[m]") || lower.contains("in m") {
        Some(1.0)
    } else {
        None
    };
    found.metres_per_unit = unit.or(found.metres_per_unit);
}

/// Whether numbers are metres or centimetres: by the height of people, else by how fast they walk.
fn infer_unit(found: &mut Found, heights: Vec<f64>, options: &Options) {
    let heights = median(heights.into_iter().filter(|z| *z > 0.0).collect());
    let rate = options.frame_rate.or(found.frame_rate).unwrap_or(16.0);
    let speed = || {
        let pairs = found.rows.windows(2).filter(|two| two[0].id == two[1].id && two[1].frame > two[0].frame);
        #[allow(clippy::cast_precision_loss, reason = "a difference of frames")]
        let speeds = pairs
            .map(|two| two[0].place.distance(two[1].place) * rate / (two[1].frame - two[0].frame) as f64);
        median(speeds.collect())
    };
    let (metres, why) = match heights {
        Some(height) if (50.0..300.0).contains(&height) => (0.01, format!("people are {height:.0} tall")),
        Some(height) if (0.5..3.0).contains(&height) => (1.0, format!("people are {height:.2} tall")),
        _ => match speed() {
            // nobody walks at 10 m/s, and at 10 cm/s a crowd would stand
            Some(speed) if speed > 10.0 => {
                (0.01, format!("half of the steps are faster than {speed:.0} a second"))
            }
            Some(speed) => (1.0, format!("half of the steps are faster than {speed:.2} a second")),
            None => (1.0, "nothing says otherwise".to_owned()),
        },
    };
    let name = if metres < 0.5 { "centimetres" } else { "metres" };
    found.metres_per_unit = Some(metres);
    found.notes.push(format!("unit inferred: {name} ({why})"));
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Places of the columns of a CSV.
struct Places {
    id: usize,
    frame: usize,
    x: usize,
    y: usize,
    heading: Option<usize>,
    /// The CSV is ours: y is z, down the page, and headings are about +y.
    is_ours: bool,
}

impl Places {
    fn of(path: &Path, line: usize, head: &[String]) -> Result<Self, Error> {
        let at = |names: &[&str]| names.iter().find_map(|name| head.iter().position(|cell| cell == name));
        let need = |name: &str, names: &[&str]| {
            at(names).ok_or_else(|| {
                let known: Vec<&str> = head.iter().map(String::as_str).take(12).collect();
                let list = known.join(", ");
                syntax(
                    path,
                    line,
                    format!("no column for {name} among {:?} (one of {names:?})", super::clip(&list)),
                )
            })
        };
        let is_ours = at(&["z_m"]).is_some() && at(&["x_m"]).is_some();
        Ok(Self {
            id: need(
                "the person",
                &["id", "personid", "person_id", "agent", "agent_id", "ped_id", "track_id"],
            )?,
            frame: need("the frame", &["frame", "frame_id", "fr"])?,
            x: need("x", &["x", "x_m", "pos_x", "x/m"])?,
            y: if is_ours { need("z", &["z_m"])? } else { need("y", &["y", "y_m", "pos_y", "y/m"])? },
            heading: at(&["heading_rad"]).filter(|_| is_ours),
            is_ours,
        })
    }
}

/// CSV with a head: `ID,Frame,x,y,v_x,v_y`, or ours, `frame,time_s,id,x_m,z_m,heading_rad`.
pub(super) fn parse_csv(path: &Path, text: &str) -> Result<Found, Error> {
    let mut found = Found { metres_per_unit: Some(1.0), ..Found::default() };
    let mut lines =
        (1..).zip(text.lines()).filter(|(_, row)| !row.trim().is_empty() && !row.starts_with('#'));
    let Some((line, head)) = lines.next() else {
        return Err(syntax(path, 1, "empty; a line that names the columns is expected"));
    };
    let separator = [';', '\t', ','].into_iter().find(|c| head.contains(*c)).unwrap_or(',');
    let head: Vec<String> = head
        .split(separator)
        .take(256)
        .map(|cell| cell.trim().trim_matches('"').to_ascii_lowercase())
        .collect();
    let places = Places::of(path, line, &head)?;
    let time = head.iter().position(|cell| cell == "time_s");
    let mut first_and_last: Option<[(i64, f64); 2]> = None;
    for (line, row) in lines {
        let cell = |at: usize| row.split(separator).nth(at);
        let id = whole(path, line, "the id", cell(places.id))?;
        let frame = whole(path, line, "the frame", cell(places.frame))?;
        let x = number(path, line, "x", cell(places.x))?;
        let y = number(path, line, "y", cell(places.y))?;
        let heading = places.heading.map(|at| number(path, line, "the heading", cell(at))).transpose()?;
        if let Some(at) = time {
            let now = (frame, number(path, line, "the time", cell(at))?);
            let [first, last] = first_and_last.get_or_insert([now; 2]);
            *first = if now.0 < first.0 { now } else { *first };
            *last = if now.0 > last.0 { now } else { *last };
        }
        found.rows.push(Row {
            id,
            frame,
            place: if places.is_ours { DVec2::new(x, -y) } else { DVec2::new(x, y) },
            facing: heading.map(|heading| heading - std::f64::consts::FRAC_PI_2),
            line,
        });
    }
    if let Some([first, last]) = first_and_last.filter(|[first, last]| last.1 > first.1) {
        #[allow(clippy::cast_precision_loss, reason = "a difference of frames")]
        let rate = (last.0 - first.0) as f64 / (last.1 - first.1);
        // Times are written to the microsecond, which leaves the rate of a short file uncertain in the fifth place.
        found.frame_rate = Some((rate * 1000.0).round() / 1000.0);
    }
    if found.rows.is_empty() {
        return Err(unusable(path, "no rows below the head", "a recording has at least one"));
    }
    Ok(found)
}

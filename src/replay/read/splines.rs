//! UCY's annotations (Lerner, Chrysanthou, Lischinski 2007): for each person the control points of a spline in the picture,
//! `x y frame gaze`, pixels from the centre of the picture (y up) and degrees from up the picture, counter-clockwise.
//!
//! ```text
//! 434 - the number of splines
//! 5 - Num of control points
//! 70.0 -35.0 0 -79.7 - (2D point, m_id)
//! ```

use super::{Error, Format, Found, Pixels, Row, number, syntax, unusable, whole};
use crate::table::Records;
use glam::{DMat3, DVec2, DVec3};
use std::path::Path;

/// UCY was filmed at 25 frames per second, 720 by 576 pixels.
const RATE: f64 = 25.0;
const PICTURE: DVec2 = DVec2::new(720.0, 576.0);

/// From pixels to the ground.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Homography {
    matrix: DMat3,
    pixels: Pixels,
    note: String,
}

impl Homography {
    /// Three rows of three numbers.
    pub(super) fn parse(path: &Path, text: &str, pixels: Option<Pixels>) -> Result<Self, Error> {
        let mut numbers = Vec::new();
        let mut records = Records::new(text);
        while let Some((line, row)) = records.pass_line() {
            for cell in row.split_whitespace() {
                numbers.push(number(path, line, "a number of the homography", Some(cell))?);
            }
            if numbers.len() > 9 {
                break;
            }
        }
        let Ok(numbers) = <[f64; 9]>::try_from(numbers) else {
            return Err(unusable(
                path,
                "it does not hold nine numbers",
                "a homography is three rows of three",
            ));
        };
        let matrix = DMat3::from_cols_array(&numbers).transpose();
        if matrix.determinant().abs() < 1e-12 {
            return Err(unusable(
                path,
                "its determinant is 0",
                "take the homography that came with the recording",
            ));
        }
        let inferred = inferred(&matrix);
        let taken = pixels.unwrap_or(inferred);
        let counted = match taken {
            Pixels::Centre => "from the centre of the picture, y up",
            Pixels::RowColumn => "as (row, column) from the upper left",
        };
        let why = if pixels.is_some() { "as asked for" } else { "inferred: depth is foreshortened" };
        Ok(Self { matrix, pixels: taken, note: format!("homography takes pixels {counted} ({why})") })
    }

    /// Ground of a point of the picture: pixels from the centre, y up.
    fn ground(&self, point: DVec2) -> DVec2 {
        let input = match self.pixels {
            Pixels::Centre => point,
            Pixels::RowColumn => DVec2::new(0.5 * PICTURE.y - point.y, 0.5 * PICTURE.x + point.x),
        };
        let out = self.matrix * DVec3::new(input.x, input.y, 1.0);
        out.truncate() / out.z
    }
}

/// How pixels are counted, from the scales of the matrix: a camera that looks down at a slant shows depth shorter than
/// width, so a pixel up the picture spans more ground than one across.
fn inferred(matrix: &DMat3) -> Pixels {
    let scale = |column: DVec3| column.truncate().length();
    if scale(matrix.x_axis) > scale(matrix.y_axis) { Pixels::RowColumn } else { Pixels::Centre }
}

/// Parses splines.
pub(super) fn parse(path: &Path, text: &str, homography: &Homography) -> Result<Found, Error> {
    let mut found = Found {
        format: Format::Vsp,
        usual_rate: Some(RATE),
        metres_per_unit: Some((1.0, "format")),
        is_curve: true,
        notes: vec![homography.note.clone()],
        ..Found::default()
    };
    let mut records = Records::new(text);
    let mut lines = std::iter::from_fn(|| records.pass_line());
    let first = |line: &str| line.split_whitespace().next().map(str::to_owned);
    let Some((line, head)) = lines.next() else {
        return Err(syntax(path, 1, "empty; the number of splines is expected"));
    };
    let splines = whole(path, line, "the number of splines", first(head).as_deref())?;
    for id in 1..=splines {
        let Some((line, head)) = lines.next() else {
            return Err(syntax(path, line, format!("ends before spline {id} of {splines}")));
        };
        let points = whole(path, line, "the number of control points", first(head).as_deref())?;
        for point in 1..=points {
            let Some((line, row)) = lines.next() else {
                return Err(syntax(path, line, format!("spline {id} ends before point {point} of {points}")));
            };
            found.rows.push(control_point(path, line, row, id, homography)?);
        }
    }
    Ok(found)
}

fn control_point(
    path: &Path,
    line: usize,
    row: &str,
    id: i64,
    homography: &Homography,
) -> Result<Row, Error> {
    let mut cells = row.split_whitespace();
    let x = number(path, line, "x", cells.next())?;
    let y = number(path, line, "y", cells.next())?;
    let frame = whole(path, line, "the frame", cells.next())?;
    let gaze = number(path, line, "the gaze", cells.next())?.to_radians();
    let pixel = DVec2::new(x, y);
    let place = homography.ground(pixel);
    // What a small step along the gaze in the picture is on the ground.
    let ahead = homography.ground(pixel + DVec2::new(-libm::sin(gaze), libm::cos(gaze))) - place;
    let facing = (ahead.is_finite() && ahead.length_squared() > 0.0).then(|| ahead.to_angle());
    if !place.is_finite() {
        return Err(syntax(path, line, format!("({x}, {y}) lies on the horizon of the homography")));
    }
    #[allow(clippy::cast_precision_loss, reason = "exact: a whole number of 53 bits")]
    let frame = frame as f64;
    Ok(Row { id, frame, place, velocity: None, facing, line })
}

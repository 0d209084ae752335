//! Vector fields: `rows columns`, the side of a cell, the least corner, then a velocity for each cell, row by row.

use super::xml::Source;
use crate::scenario::error::Error;
use glam::Vec2;

/// Most cells of a field.
const MOST: usize = 4_000_000;
/// A velocity below this leads nowhere, in preferred speeds.
const STILL: f32 = 1e-3;

/// A field in Menge's plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Side of a cell, m.
    pub(super) cell: f32,
    low: Vec2,
    /// `[row][column]`, in preferred speeds.
    velocities: Vec<Vec2>,
}

impl Field {
    pub(super) fn parse(source: &Source) -> Result<Self, Error> {
        let lines = (1..).zip(source.text.lines());
        let mut words = lines.flat_map(|(line, text)| text.split_whitespace().map(move |word| (line, word)));
        let last_line = source.text.lines().count().max(1);
        let mut next = |what: &str| -> Result<(usize, f32), Error> {
            let Some((line, word)) = words.next() else {
                return Err(source.wrong_line(last_line, format!("the vector field ends before {what}")));
            };
            match word.parse::<f32>() {
                Ok(value) if value.is_finite() => Ok((line, value)),
                _ => {
                    let word: String = word.chars().take(40).collect();
                    Err(source.wrong_line(line, format!("{what} is {word:?}, not a number")))
                }
            }
        };
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "checked to be whole and small"
        )]
        let whole = |(line, value): (usize, f32), what: &str| {
            if value.fract() == 0.0 && value >= 1.0 && value <= MOST as f32 {
                return Ok(value as usize);
            }
            Err(source.wrong_line(line, format!("{what} is {value}, not 1 to {MOST}")))
        };
        let rows = whole(next("the number of rows")?, "the number of rows")?;
        let columns = whole(next("the number of columns")?, "the number of columns")?;
        let (line, cell) = next("the side of a cell")?;
        if cell <= 0.0 || rows.saturating_mul(columns) > MOST {
            let message = format!("{rows} by {columns} cells of {cell} m; at most {MOST} cells above 0 m");
            return Err(source.wrong_line(line, message));
        }
        let low = Vec2::new(next("the least x")?.1, next("the least y")?.1);
        let mut velocities = Vec::new();
        for _ in 0..rows * columns {
            velocities.push(Vec2::new(next("x of a velocity")?.1, next("y of a velocity")?.1));
        }
        Ok(Self { rows, columns, cell, low, velocities })
    }

    /// The cell of a point, or the nearest one.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "clamped to the field"
    )]
    fn at(&self, point: Vec2) -> usize {
        let most = Vec2::new((self.columns - 1) as f32, (self.rows - 1) as f32);
        let scaled = ((point - self.low) / self.cell).floor().clamp(Vec2::ZERO, most);
        scaled.y as usize * self.columns + scaled.x as usize
    }

    /// Where an agent ends that follows the field from a point: where it is still, turns back, or leaves its own ground.
    pub(super) fn end(&self, from: Vec2) -> Vec2 {
        #[allow(clippy::cast_precision_loss, reason = "at most some million cells")]
        let high = self.low + Vec2::new(self.columns as f32, self.rows as f32) * self.cell;
        let (mut at, step) = (from, 0.25 * self.cell);
        let mut visits = vec![0_u8; self.velocities.len()];
        let mut entered = usize::MAX;
        loop {
            let cell = self.at(at);
            if cell != entered {
                entered = cell;
                visits[cell] += 1;
            }
            let along = self.velocities[cell];
            let next = at + along.normalize_or_zero() * step;
            let is_outside = next.cmplt(self.low).any() || next.cmpgt(high).any();
            // a cell is met again where velocities on both sides of a line lead back to it; a step that is lost in rounding
            // leads nowhere
            if along.length() < STILL || next == at || is_outside || visits[cell] > 2 {
                return at;
            }
            at = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn field(text: &str) -> Result<Field, Error> {
        Field::parse(&Source { path: PathBuf::from("f.txt"), text: text.to_owned() })
    }

    #[test]
    fn a_field_is_followed_to_where_it_ends() {
        // rows upwards: to the right in the lower row, up at its end, still at the top
        let corner = field("2 3\n1.0\n0 0\n1 0\n1 0\n0 1\n1 0\n1 0\n0 0\n").unwrap();
        let end = corner.end(Vec2::new(0.5, 0.5));
        assert!(end.x >= 2.0 && end.y >= 1.0, "{end}");
        let out = field("1 2\n1.0\n0 0\n1 0\n1 0\n").unwrap().end(Vec2::new(0.5, 0.5));
        assert!((1.7..=2.0).contains(&out.x), "{out}");
        let sink = field("1 2\n1.0\n0 0\n1 0\n-1 0\n").unwrap().end(Vec2::new(0.1, 0.5));
        assert!((0.7..=1.3).contains(&sink.x), "{sink}");
    }

    #[test]
    fn a_step_too_small_to_be_taken_ends_the_way() {
        // a velocity whose length overflows has no direction, and cells of a nanometre vanish beside 1,000 m
        for text in ["1 2\n1.0\n0 0\n1e38 1e38\n1 0\n", "1 2\n1e-9\n1000 1000\n1 0\n1 0\n"] {
            let field = field(text).unwrap();
            assert_eq!(field.end(field.low), field.low);
        }
    }

    #[test]
    fn a_broken_field_says_where() {
        for (text, why) in [
            ("2 2\n1\n0 0\n1 0\n", "f.txt:4: the vector field ends before"),
            ("2 x\n", "f.txt:1: the number of columns is \"x\""),
            ("0 2\n1\n", "not 1 to"),
            ("2 2\n0\n0 0\n", "f.txt:2:"),
            ("4000000 4000000\n1\n0 0\n", "at most"),
            ("1 1\n1\n0 0\nnan 0\n", "not a number"),
            ("", "f.txt:1"),
        ] {
            let said = field(text).unwrap_err().to_string();
            assert!(said.contains(why), "{text:?}: {said}");
        }
    }
}

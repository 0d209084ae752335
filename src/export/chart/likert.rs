//! Answers on a scale: bars that part at the middle of the scale, disagreement to the left and agreement to the right.

use super::canvas::{Anchor, Canvas, Paint, Size, on};
use super::{Figure, MOST, Scale};

const MARGIN: f64 = 20.0;
/// Height of a bar, units.
const BAR: f64 = 22.0;
/// From one bar to the next, units.
const ROW: f64 = 28.0;
/// Units of one percent.
const PERCENT: f64 = 4.2;
/// Share below which a bar has no room for its number, percent.
const LEAST_WRITTEN: f64 = 8.0;
/// The colour of the middle of the scale.
const MIDDLE: [u8; 3] = [203, 206, 211];

/// Answers of one group.
#[derive(Debug, Clone, PartialEq)]
pub struct LikertRow {
    /// Left of the bar.
    pub name: String,
    /// Answers by point, from the least; all rows have as many points.
    pub counts: Vec<usize>,
}

/// A figure of answers on a scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Likert {
    /// Above the figure.
    pub title: String,
    /// Names of the points, from the least.
    pub points: Vec<String>,
    /// From top to bottom.
    pub rows: Vec<LikertRow>,
    /// Below the figure.
    pub note: String,
}

#[allow(clippy::cast_precision_loss, reason = "counts of answers")]
const fn real(count: usize) -> f64 {
    count as f64
}

impl Likert {
    /// The colour of a point.
    fn color(&self, point: usize) -> [u8; 3] {
        let half = (real(self.points.len()) - 1.0) / 2.0;
        let place = real(point) - half;
        if place.abs() < 0.25 { MIDDLE } else { Scale::Diverging(half.max(0.5)).color(-place) }
    }

    /// Percent of each point.
    fn shares(&self, row: &LikertRow) -> Vec<f64> {
        let all = real(row.counts.iter().sum()).max(1.0);
        (0..self.points.len())
            .map(|point| 100.0 * real(row.counts.get(point).copied().unwrap_or(0)) / all)
            .collect()
    }

    /// Percent left of the middle of the scale; half of the middle point counts.
    fn below(&self, shares: &[f64]) -> f64 {
        let half = (real(self.points.len()) - 1.0) / 2.0;
        let part = |(point, share): (usize, &f64)| {
            let place = real(point) - half;
            if place.abs() < 0.25 {
                share / 2.0
            } else if place < 0.0 {
                *share
            } else {
                0.0
            }
        };
        shares.iter().enumerate().map(part).sum()
    }

    /// Names of the points with their colours, in lines that are not wider than `room`; returns the height.
    fn legend(&self, canvas: Option<&mut Canvas>, room: f64) -> f64 {
        let mut places = Vec::new();
        let (mut x, mut y) = (MARGIN, MARGIN + 40.0);
        for name in &self.points {
            let width = 15.0 + Size::Normal.width(name) + 15.0;
            if x > MARGIN && x + width > MARGIN + room {
                (x, y) = (MARGIN, y + 20.0);
            }
            places.push([x, y]);
            x += width;
        }
        if let Some(canvas) = canvas {
            for (point, (name, [x, y])) in self.points.iter().zip(places).enumerate() {
                canvas.rect([x, y - 9.0], [10.0, 10.0], Paint::Fixed(self.color(point)));
                canvas.text([x + 15.0, y], (Size::Normal, Anchor::Start, Paint::Ink), name);
            }
        }
        y + 22.0
    }

    fn row(&self, canvas: &mut Canvas, row: &LikertRow, [left, y, zero]: [f64; 3]) {
        let line = y + BAR - 6.0;
        canvas.text([left, line], (Size::Normal, Anchor::End, Paint::Ink), &row.name);
        if row.counts.iter().all(|&count| count == 0) {
            return canvas.text([zero, line], (Size::Normal, Anchor::Middle, Paint::Muted), "-");
        }
        let shares = self.shares(row);
        let mut x = zero - PERCENT * self.below(&shares);
        for (point, share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let (width, color) = (PERCENT * share, self.color(point));
            canvas.rect([x, y], [width, BAR], Paint::Fixed(color));
            if *share >= LEAST_WRITTEN {
                let style = (Size::Normal, Anchor::Middle, on(color));
                canvas.text([x + 0.5 * width, line], style, &format!("{share:.0}"));
            }
            x += width;
        }
    }
}

impl Figure for Likert {
    fn canvas(&self) -> Canvas {
        let rows = || self.rows.iter().take(MOST);
        let names = rows().map(|row| Size::Normal.width(&row.name)).fold(0.0, f64::max);
        let sides = |row: &LikertRow| {
            let below = self.below(&self.shares(row));
            [below, 100.0 - below]
        };
        let reach = rows().map(sides).fold([1.0_f64; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        let left = MARGIN + names + 12.0;
        let zero = left + PERCENT * reach[0];
        let numbers =
            rows().map(|row| format!("n = {}", row.counts.iter().sum::<usize>())).collect::<Vec<_>>();
        let widest = numbers.iter().map(|text| Size::Normal.width(text)).fold(0.0, f64::max);
        let right = zero + PERCENT * reach[1];
        let words = Size::Title.width(&self.title).max(Size::Normal.width(&self.note));
        let width = (right + 12.0 + widest).max(MARGIN + words) + MARGIN;
        let top = self.legend(None, width - 2.0 * MARGIN);
        let bottom = top + ROW * real(numbers.len());
        let note = if self.note.is_empty() { 0.0 } else { 20.0 };
        let mut canvas = Canvas::new(width, bottom + 14.0 + note, &self.title);
        canvas.text([MARGIN, MARGIN + 13.0], (Size::Title, Anchor::Start, Paint::Ink), &self.title);
        self.legend(Some(&mut canvas), width - 2.0 * MARGIN);
        canvas.rect([zero - 0.5, top - 4.0], [1.0, bottom - top + 2.0], Paint::Muted);
        for (index, (row, number)) in rows().zip(&numbers).enumerate() {
            let y = top + ROW * real(index);
            self.row(&mut canvas, row, [left - 12.0, y, zero]);
            let style = (Size::Normal, Anchor::Start, Paint::Muted);
            canvas.text([right + 12.0, y + BAR - 6.0], style, number);
        }
        canvas.text([MARGIN, bottom + 16.0], (Size::Normal, Anchor::Start, Paint::Muted), &self.note);
        canvas
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_part_at_the_middle_of_the_scale_and_are_as_wide_as_their_share() {
        let rows = vec![
            LikertRow { name: "a".to_owned(), counts: vec![1, 2, 4, 2, 1] },
            LikertRow { name: "none".to_owned(), counts: vec![0; 5] },
        ];
        let points = ["no", "rather no", "neither", "rather yes", "yes"].map(str::to_owned).to_vec();
        let figure = Likert { title: "t".to_owned(), points, rows, note: String::new() };
        let shares = figure.shares(&figure.rows[0]);
        assert!((figure.below(&shares) - 50.0).abs() < 1e-9, "{shares:?}");
        let svg = figure.svg();
        // 40 percent in the middle, 10 at each end
        for width in [0.4 * 100.0 * PERCENT, 0.1 * 100.0 * PERCENT] {
            assert!(svg.contains(&format!("width=\"{width:.1}\" height=\"{BAR:.1}\"")), "{width} {svg}");
        }
        assert!(svg.contains("n = 10") && svg.contains("n = 0") && svg.contains(">40<"));
        // four points have no middle: two lie on each side
        let four = Likert { points: figure.points[..4].to_vec(), ..figure };
        assert!((four.below(&[10.0, 20.0, 30.0, 40.0]) - 30.0).abs() < 1e-9);
        assert_ne!(four.color(1), four.color(2));
    }
}

//! Values of single things: one dot each, in columns.

use super::Figure;
use super::bars::{step, tick};
use super::canvas::{Anchor, Canvas, Paint, Size};

const MARGIN: f64 = 20.0;
const HEIGHT: f64 = 300.0;
/// Width of a column, units.
const COLUMN: f64 = 150.0;
const RADIUS: f64 = 2.6;
/// Most dots of a column.
const MOST_DOTS: usize = 5000;

/// One column of dots.
#[derive(Debug, Clone, PartialEq)]
pub struct StripColumn {
    /// Below the column.
    pub name: String,
    /// Values with the colour of each.
    pub dots: Vec<(f64, [u8; 3])>,
}

/// A figure of dots in columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// Above the figure.
    pub title: String,
    /// What the axis is.
    pub axis: String,
    /// Ends of the axis.
    pub range: [f64; 2],
    /// From left to right.
    pub columns: Vec<StripColumn>,
    /// A line across with its name, such as a threshold.
    pub line: Option<(f64, String)>,
    /// Names and colours of dots.
    pub legend: Vec<(String, [u8; 3])>,
    /// Below the figure.
    pub note: String,
}

/// Places of dots in a column: height on the canvas and distance from the middle. Dots of one height stand side by side.
fn places(values: &[f64], room: f64) -> Vec<f64> {
    let row = |value: f64| (value / (2.0 * RADIUS)).round();
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| row(values[a]).total_cmp(&row(values[b])).then(a.cmp(&b)));
    let mut found = vec![0.0; values.len()];
    for group in order.chunk_by(|&a, &b| row(values[a]).total_cmp(&row(values[b])).is_eq()) {
        #[allow(clippy::cast_precision_loss, reason = "a few thousand dots")]
        let (count, space) = (group.len() as f64, (2.0 * RADIUS).min(room / group.len() as f64));
        let mut offset = -0.5 * space * (count - 1.0);
        for &index in group {
            found[index] = offset;
            offset += space;
        }
    }
    found
}

#[allow(clippy::cast_precision_loss, reason = "a few columns")]
impl Figure for Strip {
    fn canvas(&self) -> Canvas {
        let left = MARGIN + Size::Normal.width("0.0") + Size::Normal.space();
        let right = left + COLUMN * self.columns.len() as f64;
        let legend: f64 = self.legend.iter().map(|(name, _)| 30.0 + Size::Normal.width(name)).sum();
        let words = Size::Title.width(&self.title).max(legend).max(Size::Normal.width(&self.note));
        let line = self.line.as_ref().map_or(0.0, |(_, name)| Size::Normal.width(name) + 8.0);
        let top = MARGIN + Canvas::line(Size::Title) + 52.0;
        let bottom = top + HEIGHT;
        let width = (right + line).max(MARGIN + words) + MARGIN;
        let note = if self.note.is_empty() { 0.0 } else { 20.0 };
        let mut canvas = Canvas::new(width, bottom + 34.0 + note, &self.title);
        let [low, high] = self.range;
        let y = |value: f64| bottom - HEIGHT * ((value - low) / (high - low).max(1e-9)).clamp(0.0, 1.0);
        canvas.text([MARGIN, MARGIN + 13.0], (Size::Title, Anchor::Start, Paint::Ink), &self.title);
        let mut x = MARGIN;
        for (name, color) in &self.legend {
            canvas.dot([x + 5.0, MARGIN + 34.0], 5.0, Paint::Fixed(*color));
            canvas.text([x + 15.0, MARGIN + 38.0], (Size::Normal, Anchor::Start, Paint::Ink), name);
            x += 30.0 + Size::Normal.width(name);
        }
        canvas.text([MARGIN, top - 12.0], (Size::Normal, Anchor::Start, Paint::Muted), &self.axis);
        let step = step((high - low).max(1e-9));
        let mut at = low;
        while at <= high + 0.01 * step {
            canvas.rect([left, y(at) - 0.5], [right - left, 1.0], Paint::Grid);
            let style = (Size::Normal, Anchor::End, Paint::Muted);
            canvas.text([left - Size::Normal.space(), y(at) + 4.0], style, &tick(at, step));
            at += step;
        }
        if let Some((value, name)) = &self.line {
            canvas.rect([left, y(*value) - 0.75], [right - left, 1.5], Paint::Muted);
            canvas.text([right + 8.0, y(*value) + 4.0], (Size::Normal, Anchor::Start, Paint::Muted), name);
        }
        for (index, column) in self.columns.iter().enumerate() {
            let middle = left + COLUMN * (index as f64 + 0.5);
            let dots = || column.dots.iter().filter(|(value, _)| value.is_finite()).take(MOST_DOTS);
            let heights: Vec<f64> = dots().map(|(value, _)| y(*value)).collect();
            let offsets = places(&heights, COLUMN - 16.0);
            for ((height, offset), (_, color)) in heights.iter().zip(offsets).zip(dots()) {
                canvas.dot([middle + offset, *height], RADIUS, Paint::Fixed(*color));
            }
            let style = (Size::Normal, Anchor::Middle, Paint::Ink);
            canvas.text([middle, bottom + 20.0], style, &column.name);
        }
        canvas.text([MARGIN, bottom + 44.0], (Size::Normal, Anchor::Start, Paint::Muted), &self.note);
        canvas
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_of_one_height_stand_side_by_side_and_within_their_column() {
        assert_eq!(places(&[10.0, 10.0, 90.0], 134.0), [-RADIUS, RADIUS, 0.0]);
        let many = places(&[10.0; 400], 134.0);
        assert!(many.iter().all(|offset| offset.abs() <= 67.0), "{many:?}");
        let mut sorted = many.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        assert_eq!(sorted.len(), 400);
    }
}

//! Matrices: every cell coloured by its value, with the value in it.

use super::canvas::{Anchor, Canvas, Paint, Size, on};
use super::{Figure, MOST};

/// Height of a cell, units.
const CELL_HEIGHT: f64 = 44.0;
/// Least width of a cell, units.
const CELL_WIDTH: f64 = 78.0;
const MARGIN: f64 = 20.0;
/// Between two cells, units.
const GAP: f64 = 2.0;

/// Which colours stand for which values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// One hue, from pale at the first to dark at the second number (counts, shares).
    Sequential(f64, f64),
    /// From blue through white at 0 to red, out to plus and minus this number (correlations).
    Diverging(f64),
}

/// Anchors of the sequential colours, pale to dark.
const SEQUENTIAL: [[f64; 3]; 3] = [[238.0, 243.0, 247.0], [98.0, 160.0, 202.0], [10.0, 58.0, 112.0]];
/// Anchors of the diverging colours, negative to positive.
const DIVERGING: [[f64; 3]; 5] = [
    [28.0, 84.0, 150.0],
    [130.0, 180.0, 215.0],
    [246.0, 246.0, 246.0],
    [238.0, 152.0, 122.0],
    [168.0, 28.0, 42.0],
];
/// A value that does not exist.
const ABSENT: [u8; 3] = [150, 150, 150];

impl Scale {
    /// The colour of a value; values beyond the ends have the colour of the end, NaN is grey.
    pub fn color(self, value: f64) -> [u8; 3] {
        let (share, anchors): (f64, &[[f64; 3]]) = match self {
            Self::Sequential(low, high) => ((value - low) / (high - low), &SEQUENTIAL),
            Self::Diverging(most) => (0.5 + 0.5 * value / most, &DIVERGING),
        };
        if share.is_nan() {
            return ABSENT;
        }
        #[allow(clippy::cast_precision_loss, reason = "a handful of anchors")]
        let place = share.clamp(0.0, 1.0) * (anchors.len() - 1) as f64;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to the number of anchors"
        )]
        let index = (place as usize).min(anchors.len() - 2);
        #[allow(clippy::cast_precision_loss, reason = "a handful of anchors")]
        let t = place - index as f64;
        std::array::from_fn(|channel| {
            let (a, b) = (anchors[index][channel], anchors[index + 1][channel]);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two bytes")]
            let mixed = (a + (b - a) * t).round() as u8;
            mixed
        })
    }
}

/// A matrix with values: a confusion matrix, a table of correlations.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// Above the figure.
    pub title: String,
    /// What the rows are, such as `wanted`; may be empty.
    pub row_name: String,
    /// What the columns are, such as `perceived`; may be empty.
    pub column_name: String,
    /// Names of the rows.
    pub rows: Vec<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// `[row][column]`; missing ones and NaN are shown as absent.
    pub values: Vec<Vec<f64>>,
    /// A second line in each cell, `[row][column]`, such as a count; may be empty.
    pub notes: Vec<Vec<String>>,
    /// Digits after the point.
    pub decimals: usize,
    /// Written after each value, such as `%`.
    pub unit: String,
    /// Which colours stand for which values.
    pub scale: Scale,
    /// Below the figure, such as n.
    pub note: String,
}

impl Matrix {
    /// A confusion matrix of counts: shares of each row in percent, with the counts below them and n.
    pub fn confusion(title: &str, names: [&str; 2], labels: &[String], counts: &[Vec<u64>]) -> Self {
        #[allow(clippy::cast_precision_loss, reason = "counts of trials")]
        let real = |count: u64| count as f64;
        let share = |row: &Vec<u64>| {
            let total = real(row.iter().sum());
            row.iter().map(|&count| 100.0 * real(count) / total).collect()
        };
        let total: u64 = counts.iter().flatten().sum();
        let right: u64 = counts.iter().enumerate().filter_map(|(i, row)| row.get(i)).sum();
        let accuracy = if total > 0 { 100.0 * real(right) / real(total) } else { 0.0 };
        Self {
            title: title.to_owned(),
            row_name: names[0].to_owned(),
            column_name: names[1].to_owned(),
            rows: labels.to_vec(),
            columns: labels.to_vec(),
            values: counts.iter().map(share).collect(),
            notes: counts
                .iter()
                .map(|row| row.iter().map(|count| format!("n = {count}")).collect())
                .collect(),
            decimals: 1,
            unit: " %".to_owned(),
            scale: Scale::Sequential(0.0, 100.0),
            note: format!("n = {total}, on the diagonal {right} = {accuracy:.2} %"),
        }
    }

    fn cell_text(&self, row: usize, column: usize) -> (f64, String) {
        let value = self.values.get(row).and_then(|row| row.get(column)).copied().unwrap_or(f64::NAN);
        let text = if value.is_nan() {
            "-".to_owned()
        } else {
            let text = format!("{value:.*}{}", self.decimals, self.unit);
            // A rounded -0 is 0.
            let is_zero = text.chars().all(|c| !('1'..='9').contains(&c));
            if is_zero { text.trim_start_matches('-').to_owned() } else { text }
        };
        (value, text)
    }
}

#[allow(clippy::cast_precision_loss, reason = "a few hundred cells")]
impl Figure for Matrix {
    fn canvas(&self) -> Canvas {
        let (length, space) = (|text: &str| Size::Normal.width(text), Size::Normal.space());
        let longest = |words: &[String]| words.iter().map(|word| length(word)).fold(0.0, f64::max);
        let (rows, columns) = (self.rows.len().min(MOST), self.columns.len().min(MOST));
        let cell_width =
            self.notes.iter().map(|row| longest(row)).fold(longest(&self.columns), f64::max) + 12.0;
        let cell_width = cell_width.max(CELL_WIDTH);
        let left = MARGIN + longest(&self.rows).max(length(&self.row_name)) + space;
        let has_head = !self.column_name.is_empty() || !self.row_name.is_empty();
        let top = MARGIN + Canvas::line(Size::Title) + if has_head { 44.0 } else { 26.0 };
        let right = left + cell_width * columns as f64;
        let bottom = top + CELL_HEIGHT * rows as f64;
        let title_width = Size::Title.width(&self.title);
        let note_width = length(&self.note);
        let width = right.max(MARGIN + title_width).max(MARGIN + note_width) + MARGIN;
        let mut canvas =
            Canvas::new(width, bottom + if self.note.is_empty() { 16.0 } else { 38.0 }, &self.title);
        canvas.text([MARGIN, MARGIN + 13.0], (Size::Title, Anchor::Start, Paint::Ink), &self.title);
        let names = |x, anchor| ([x, top - 28.0], (Size::Normal, anchor, Paint::Muted));
        let (at, style) = names((left + right) * 0.5, Anchor::Middle);
        canvas.text(at, style, &self.column_name);
        let (at, style) = names(left - space, Anchor::End);
        canvas.text([at[0], top - 9.0], style, &self.row_name);
        for (column, name) in self.columns.iter().take(columns).enumerate() {
            let x = left + (column as f64 + 0.5) * cell_width;
            canvas.text([x, top - 9.0], (Size::Normal, Anchor::Middle, Paint::Ink), name);
        }
        for (row, name) in self.rows.iter().take(rows).enumerate() {
            let y = top + row as f64 * CELL_HEIGHT;
            let middle = y + 0.5 * CELL_HEIGHT + 4.0;
            canvas.text([left - space, middle], (Size::Normal, Anchor::End, Paint::Ink), name);
            for column in 0..columns {
                let x = left + column as f64 * cell_width;
                let (value, text) = self.cell_text(row, column);
                let ground = self.scale.color(value);
                let size = [cell_width - GAP, CELL_HEIGHT - GAP];
                canvas.rect([x, y], size, Paint::Fixed(ground));
                let style = (Size::Normal, Anchor::Middle, on(ground));
                let note = self.notes.get(row).and_then(|row| row.get(column)).map_or("", String::as_str);
                let up = if note.is_empty() { 0.0 } else { 8.0 };
                canvas.text([x + 0.5 * size[0], middle - 1.0 - up], style, &text);
                canvas.text([x + 0.5 * size[0], middle + 8.0], style, note);
            }
        }
        canvas.text([MARGIN, bottom + 22.0], (Size::Normal, Anchor::Start, Paint::Muted), &self.note);
        canvas
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::luminance;
    use super::*;

    fn table() -> Matrix {
        let labels = ["happy", "a<b & \"c\""].map(str::to_owned).to_vec();
        Matrix::confusion("Wanted against seen", ["wanted", "seen"], &labels, &[vec![3, 1], vec![0, 4]])
    }

    #[test]
    fn a_confusion_matrix_says_shares_counts_and_n() {
        let svg = table().svg();
        for text in ["75.0 %", "n = 1<", "100.0 %", "n = 8, on the diagonal 7 = 87.50 %", "wanted", "seen"] {
            assert!(svg.contains(text), "{text} is missing");
        }
        assert!(svg.contains("a&lt;b &amp; &quot;c&quot;") && svg.contains("prefers-color-scheme: dark"));
        assert_eq!(svg.matches("<rect").count(), 1 + 4);
    }

    #[test]
    fn text_in_a_cell_has_contrast_with_every_colour() {
        for scale in [Scale::Sequential(0.0, 1.0), Scale::Diverging(1.0)] {
            for step in -100..=100 {
                let ground = scale.color(f64::from(step) / 100.0);
                let Paint::Fixed(ink) = on(ground) else { panic!("fixed") };
                let (a, b) = (luminance(ground) + 0.05, luminance(ink) + 0.05);
                let contrast = a.max(b) / a.min(b);
                assert!(contrast > 4.0, "{scale:?} {step}: {contrast:.1}"); // 4.5 is WCAG AA for small text
            }
        }
        assert_eq!(Scale::Diverging(1.0).color(f64::NAN), ABSENT);
        assert_eq!(Scale::Diverging(1.0).color(0.0), [246; 3]);
        assert_eq!(Scale::Sequential(0.0, 1.0).color(7.0), [10, 58, 112]);
    }

    #[test]
    fn absent_values_and_rounded_zeros_read_well() {
        let mut matrix = table();
        matrix.values = vec![vec![-0.01, f64::NAN]];
        matrix.decimals = 1;
        assert_eq!(matrix.cell_text(0, 0).1, "0.0 %");
        assert_eq!(matrix.cell_text(0, 1).1, "-");
        assert_eq!(matrix.cell_text(1, 1).1, "-");
        matrix.image().unwrap();
    }
}

//! Means with intervals: dots, several side by side in each group.

use super::bars::{step, tick};
use super::canvas::{Anchor, Canvas, Paint, Size};
use super::{Figure, MOST};

const MARGIN: f64 = 20.0;
const HEIGHT: f64 = 220.0;
/// Width of one dot with its number, units.
const DOT: f64 = 44.0;
/// Between two groups, units.
const GAP: f64 = 26.0;

/// Colours of series that have no meaning of their own: at least 3 to 1 on the light and the dark ground.
pub const SERIES_COLORS: [[u8; 3]; 6] =
    [[66, 118, 190], [200, 66, 52], [46, 139, 87], [146, 100, 180], [176, 110, 20], [110, 118, 128]];

/// A mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// Its interval.
    pub interval: [f64; 2],
}

/// Means of one colour, one in each group; a missing one is none.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanSeries {
    /// In the legend.
    pub name: String,
    /// One a group.
    pub means: Vec<Option<Mean>>,
}

/// A figure of means.
#[derive(Debug, Clone, PartialEq)]
pub struct Means {
    /// Above the figure.
    pub title: String,
    /// What the axis is.
    pub axis: String,
    /// Ends of the axis.
    pub range: [f64; 2],
    /// Names of the groups, below them.
    pub groups: Vec<String>,
    /// Side by side in each group.
    pub series: Vec<MeanSeries>,
    /// Below the figure.
    pub note: String,
}

impl Means {
    fn legend(&self, canvas: &mut Canvas, [mut x, y]: [f64; 2]) {
        for (series, color) in self.series.iter().zip(SERIES_COLORS.iter().cycle()) {
            canvas.dot([x + 5.0, y - 4.0], 5.0, Paint::Fixed(*color));
            canvas.text([x + 15.0, y], (Size::Normal, Anchor::Start, Paint::Ink), &series.name);
            x += 30.0 + Size::Normal.width(&series.name);
        }
    }

    fn axis(&self, canvas: &mut Canvas, [left, right]: [f64; 2], y: &dyn Fn(f64) -> f64) {
        let [low, high] = self.range;
        let step = step((high - low).max(1e-9)).max(1.0);
        let mut at = low;
        while at <= high + 0.01 * step {
            canvas.rect([left, y(at) - 0.5], [right - left, 1.0], Paint::Grid);
            let style = (Size::Normal, Anchor::End, Paint::Muted);
            canvas.text([left - Size::Normal.space(), y(at) + 4.0], style, &tick(at, step));
            at += step;
        }
    }
}

/// One mean with its interval at `x`.
fn draw(canvas: &mut Canvas, mean: Mean, x: f64, color: [u8; 3], y: &dyn Fn(f64) -> f64) {
    let [low, high] = mean.interval.map(y);
    canvas.line_between([[x, low], [x, high]], 2.0, color);
    canvas.dot([x, y(mean.value)], 5.0, Paint::Fixed(color));
    let text = format!("{:.1}", mean.value);
    let wide = Size::Normal.width(&text);
    canvas.rect([x - 0.5 * wide, high - 18.0], [wide, 14.0], Paint::Paper);
    canvas.text([x, high - 7.0], (Size::Normal, Anchor::Middle, Paint::Ink), &text);
}

#[allow(clippy::cast_precision_loss, reason = "a few hundred dots")]
impl Figure for Means {
    fn canvas(&self) -> Canvas {
        let groups = self.groups.len().min(MOST);
        let names = self.groups.iter().map(|name| Size::Normal.width(name)).fold(0.0, f64::max);
        let group = (DOT * self.series.len() as f64).max(names);
        let left = MARGIN + Size::Normal.width("00") + Size::Normal.space();
        let right = left + GAP + groups as f64 * (group + GAP);
        let legend: f64 = self.series.iter().map(|one| 30.0 + Size::Normal.width(&one.name)).sum();
        let words = [&self.axis, &self.note].map(|text| Size::Normal.width(text));
        let words = words.into_iter().fold(Size::Title.width(&self.title).max(legend), f64::max);
        let top = MARGIN + Canvas::line(Size::Title) + 64.0;
        let bottom = top + HEIGHT;
        let note = if self.note.is_empty() { 0.0 } else { 20.0 };
        let mut canvas = Canvas::new(right.max(MARGIN + words) + MARGIN, bottom + 34.0 + note, &self.title);
        let [low, high] = self.range;
        let y = |value: f64| bottom - HEIGHT * ((value - low) / (high - low).max(1e-9)).clamp(0.0, 1.0);
        canvas.text([MARGIN, MARGIN + 13.0], (Size::Title, Anchor::Start, Paint::Ink), &self.title);
        self.legend(&mut canvas, [MARGIN, MARGIN + 38.0]);
        canvas.text([MARGIN, MARGIN + 60.0], (Size::Normal, Anchor::Start, Paint::Muted), &self.axis);
        self.axis(&mut canvas, [left, right], &y);
        for (index, name) in self.groups.iter().take(groups).enumerate() {
            let start = left + GAP + index as f64 * (group + GAP);
            let first = start + 0.5 * (group - DOT * self.series.len() as f64);
            for (place, (series, color)) in self.series.iter().zip(SERIES_COLORS.iter().cycle()).enumerate() {
                if let Some(mean) = series.means.get(index).copied().flatten() {
                    draw(&mut canvas, mean, first + (place as f64 + 0.5) * DOT, *color, &y);
                }
            }
            let style = (Size::Normal, Anchor::Middle, Paint::Ink);
            canvas.text([start + 0.5 * group, bottom + 20.0], style, name);
        }
        canvas.text([MARGIN, bottom + 44.0], (Size::Normal, Anchor::Start, Paint::Muted), &self.note);
        canvas
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::luminance;
    use super::*;

    #[test]
    fn colours_of_series_are_seen_on_both_grounds() {
        for color in SERIES_COLORS {
            for ground in [[255; 3], [0x14, 0x17, 0x1b]] {
                let (a, b) = (luminance(color), luminance(ground));
                let contrast = (a.max(b) + 0.05) / (a.min(b) + 0.05);
                assert!(contrast >= 3.0, "{color:?} on {ground:?}: {contrast}");
            }
        }
    }

    #[test]
    fn a_mean_stands_where_the_axis_says() {
        let mean = Mean { value: 4.0, interval: [3.0, 5.0] };
        let series = vec![MeanSeries { name: "s".to_owned(), means: vec![Some(mean), None] }];
        let groups = vec!["one".to_owned(), "two".to_owned()];
        let (title, axis, note) = ("t".to_owned(), "points".to_owned(), String::new());
        let svg = Means { title, axis, range: [1.0, 7.0], groups, series, note }.svg();
        let dots: Vec<&str> = svg.lines().filter(|line| line.starts_with("<circle")).collect();
        // the legend's and one mean, in the middle of the axis
        let middle = MARGIN + Canvas::line(Size::Title) + 64.0 + HEIGHT / 2.0;
        assert!(dots.len() == 2 && dots[1].contains(&format!("cy=\"{middle:.1}\"")), "{dots:?}");
        assert!(svg.contains(">4.0<") && svg.contains(">two<"));
    }
}

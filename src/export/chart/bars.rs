//! Bars, one or several side by side in each group, with values, intervals and an axis from 0.

use super::canvas::{Anchor, Canvas, Paint, Size};
use super::{Figure, MOST};

/// Height of the plot, units.
const HEIGHT: f64 = 220.0;
const MARGIN: f64 = 20.0;
/// Least width of a bar, units.
const BAR: f64 = 46.0;
/// Between two groups, units.
const GAP: f64 = 26.0;
/// Width of an interval's line, units.
const LINE: f64 = 1.5;
/// Wanted number of steps on the axis.
const STEPS: f64 = 5.0;

/// One bar.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bar {
    /// Its height; NaN: there is none.
    pub value: f64,
    /// Interval around the value, if known.
    pub interval: Option<[f64; 2]>,
    /// Written above it; empty: the value.
    pub text: String,
}

/// Bars of one colour, one in each group.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// In the legend; may be empty if it is the only one.
    pub name: String,
    /// One per group.
    pub bars: Vec<Bar>,
    /// One colour for all bars, or one for each group.
    pub colors: Vec<[u8; 3]>,
}

/// A figure of bars.
#[derive(Debug, Clone, PartialEq)]
pub struct Bars {
    /// Above the figure.
    pub title: String,
    /// What the axis is, such as `accuracy, %`.
    pub axis: String,
    /// Names of the groups, below them.
    pub groups: Vec<String>,
    /// Side by side in each group.
    pub series: Vec<Series>,
    /// A line across with its name, such as chance.
    pub line: Option<(f64, String)>,
    /// Digits after the point.
    pub decimals: usize,
    /// Below the figure, such as n.
    pub note: String,
}

/// A round step of the axis so that about [`STEPS`] of them reach `highest`.
pub(super) fn step(highest: f64) -> f64 {
    let raw = highest / STEPS;
    let power = 10_f64.powf(raw.log10().floor());
    let lead = raw / power;
    power * [1.0, 2.0, 2.5, 5.0].into_iter().find(|&round| lead <= round * 1.0001).unwrap_or(10.0)
}

/// A number of the axis with as many digits as its step needs.
pub(super) fn tick(value: f64, step: f64) -> String {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a few digits")]
    let digits = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
    // Steps of 2.5, 0.25, ... need one digit more.
    let lead = step / 10_f64.powf(step.log10().floor());
    let digits = digits + usize::from((lead - 2.5).abs() < 1e-6);
    format!("{value:.digits$}")
}

/// Units of a series in the legend: a square, its name and what parts it from the next.
fn legend_width(series: &Series) -> f64 {
    15.0 + Size::Normal.width(&series.name) + 15.0
}

impl Bars {
    /// The axis' end, a whole number of steps, and the step.
    fn reach(&self) -> (f64, f64) {
        let bars = self.series.iter().flat_map(|series| series.bars.iter().take(MOST));
        let ends = bars.flat_map(|bar| [bar.value, bar.interval.map_or(f64::NAN, |interval| interval[1])]);
        let ends = ends.chain(self.line.as_ref().map(|line| line.0)).filter(|end| end.is_finite());
        let highest = ends.fold(0.0, f64::max);
        if !(highest > 0.0 && highest < 1e300) {
            return (1.0, 0.2);
        }
        let step = step(highest);
        ((highest / step - 1e-9).ceil() * step, step)
    }

    /// Draws one bar whose left edge is `x`; `y` maps a value to its height on the canvas.
    fn bar(
        &self,
        canvas: &mut Canvas,
        bar: &Bar,
        [x, width]: [f64; 2],
        color: [u8; 3],
        y: &dyn Fn(f64) -> f64,
    ) {
        let middle = x + 0.5 * width;
        let style = (Size::Normal, Anchor::Middle, Paint::Ink);
        if !bar.value.is_finite() {
            return canvas.text([middle, y(0.0) - 6.0], style, "-");
        }
        let top = y(bar.value.max(0.0));
        canvas.rect([x, top], [width, y(0.0) - top], Paint::Fixed(color));
        let mut above = top;
        if let Some([low, high]) = bar.interval.filter(|ends| ends.iter().all(|end| end.is_finite())) {
            let (low, high) = (y(low.max(0.0)), y(high.max(0.0)));
            canvas.rect([middle - 0.5 * LINE, high], [LINE, (low - high).max(0.0)], Paint::Ink);
            for end in [low, high] {
                canvas.rect([middle - 5.0, end - 0.5 * LINE], [10.0, LINE], Paint::Ink);
            }
            above = above.min(high);
        }
        let value = format!("{:.*}", self.decimals, bar.value);
        let text = if bar.text.is_empty() { &value } else { &bar.text };
        // Grid lines do not run through the text.
        let wide = Size::Normal.width(text) + 4.0;
        canvas.rect([middle - 0.5 * wide, above - 18.0], [wide, 15.0], Paint::Paper);
        canvas.text([middle, above - 6.0], style, text);
    }

    /// Names and colours of the series in a row at `at`.
    fn legend(&self, canvas: &mut Canvas, [mut x, y]: [f64; 2]) {
        for series in &self.series {
            let color = series.colors.first().copied().unwrap_or([128; 3]);
            canvas.rect([x, y - 9.0], [10.0, 10.0], Paint::Fixed(color));
            canvas.text([x + 15.0, y], (Size::Normal, Anchor::Start, Paint::Ink), &series.name);
            x += legend_width(series);
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "a few hundred bars")]
impl Figure for Bars {
    fn canvas(&self) -> Canvas {
        let length = |text: &str| Size::Normal.width(text);
        let groups = self.groups.len().min(MOST);
        let series = self.series.len().clamp(1, MOST) as f64;
        let bars = || self.series.iter().flat_map(|series| &series.bars);
        let widest = bars().map(|bar| length(&bar.text)).fold(BAR, |a, b| a.max(b + 8.0));
        let names = self.groups.iter().map(|name| length(name) + 6.0).fold(0.0, f64::max);
        let group = (widest * series).max(names);
        let (end, step) = self.reach();
        let left = MARGIN + length(&tick(end, step)) + Size::Normal.space();
        let right = left + GAP + groups as f64 * (group + GAP);
        let has_legend = self.series.len() > 1;
        let legend = if has_legend { 24.0 } else { 0.0 };
        let top = MARGIN + Canvas::line(Size::Title) + legend + 40.0;
        let bottom = top + HEIGHT;
        let title = Size::Title.width(&self.title);
        let names = self.series.iter().map(legend_width).sum::<f64>();
        let width = [
            right,
            MARGIN + title.max(length(&self.axis)).max(length(&self.note)),
            MARGIN + names * f64::from(has_legend),
        ];
        let width = width.into_iter().fold(0.0, f64::max) + MARGIN;
        let note = if self.note.is_empty() { 0.0 } else { 22.0 };
        let mut canvas = Canvas::new(width, bottom + 34.0 + note, &self.title);
        let y = |value: f64| bottom - HEIGHT * (value / end).clamp(0.0, 1.0);
        canvas.text([MARGIN, MARGIN + 13.0], (Size::Title, Anchor::Start, Paint::Ink), &self.title);
        canvas.text([MARGIN, top - 22.0], (Size::Normal, Anchor::Start, Paint::Muted), &self.axis);
        if has_legend {
            self.legend(&mut canvas, [MARGIN, top - 42.0]);
        }
        let mut at = 0.0;
        while at <= end + 0.5 * step {
            canvas.rect(
                [left, y(at) - 0.5],
                [right - left, 1.0],
                if at > 0.0 { Paint::Grid } else { Paint::Ink },
            );
            canvas.text(
                [left - Size::Normal.space(), y(at) + 4.0],
                (Size::Normal, Anchor::End, Paint::Muted),
                &tick(at, step),
            );
            at += step;
        }
        for (index, name) in self.groups.iter().take(groups).enumerate() {
            let start = left + GAP + index as f64 * (group + GAP);
            let bar = (group / series).min(widest);
            let first = start + 0.5 * (group - bar * series);
            for (place, series) in self.series.iter().take(MOST).enumerate() {
                let color = series.colors.get(index).or(series.colors.first()).copied().unwrap_or([128; 3]);
                if let Some(found) = series.bars.get(index) {
                    let x = first + place as f64 * bar;
                    self.bar(&mut canvas, found, [x + 1.0, bar - 2.0], color, &y);
                }
            }
            let style = (Size::Normal, Anchor::Middle, Paint::Ink);
            canvas.text([start + 0.5 * group, bottom + 18.0], style, name);
        }
        if let Some((value, name)) = &self.line {
            canvas.rect([left, y(*value) - 0.75], [right - left, 1.5], Paint::Muted);
            canvas.text([right, y(*value) - 5.0], (Size::Normal, Anchor::End, Paint::Muted), name);
        }
        canvas.text([MARGIN, bottom + 42.0], (Size::Normal, Anchor::Start, Paint::Muted), &self.note);
        canvas
    }
}

#[cfg(test)]
mod tests {
    use super::super::EMOTION_COLORS;
    use super::*;

    fn shares() -> Bars {
        let bar = |value: f64| Bar { value, interval: Some([value - 2.0, value + 3.0]), text: String::new() };
        Bars {
            title: "Labels".into(),
            axis: "share, %".into(),
            groups: ["happy", "angry", "sad", "neutral"].map(String::from).to_vec(),
            series: vec![
                Series {
                    name: "ours".into(),
                    bars: [32.0, 24.0, 28.0, 16.0].map(bar).to_vec(),
                    colors: EMOTION_COLORS.to_vec(),
                },
                Series { name: "paper".into(), bars: vec![bar(30.0), bar(f64::NAN)], colors: vec![[90; 3]] },
            ],
            line: Some((25.0, "even".into())),
            decimals: 1,
            note: "n = 318".into(),
        }
    }

    #[test]
    fn axes_end_on_round_numbers_above_everything() {
        assert_eq!(shares().reach(), (40.0, 10.0));
        for (highest, want) in
            [(1.0, 0.2), (0.93, 0.2), (4.9, 1.0), (12.0, 2.5), (318.0, 100.0), (0.004, 0.001)]
        {
            assert!((step(highest) - want).abs() < 1e-12, "{highest}: {}", step(highest));
        }
        assert_eq!(tick(7.5, 2.5), "7.5");
        assert_eq!(tick(0.25, 0.25), "0.25");
        assert_eq!(tick(40.0, 10.0), "40");
        let none = Bars { series: vec![], line: None, ..shares() };
        assert_eq!(none.reach(), (1.0, 0.2));
        none.image().unwrap();
    }

    #[test]
    fn bars_stand_on_the_axis_as_high_as_their_values() {
        let image = shares().image().unwrap();
        let rows = |color: [u8; 3]| {
            let [r, g, b] = color;
            (0..image.height)
                .filter(|&y| (0..image.width).any(|x| image.pixel(x, y) == Some([r, g, b, 255])))
                .count()
        };
        let (happy, neutral) = (rows(EMOTION_COLORS[0]), rows(EMOTION_COLORS[3]));
        let full = HEIGHT * 2.0;
        // 32 and 16 of 40; the legend's square of the same colour is 20 rows high.
        #[allow(clippy::cast_precision_loss, reason = "rows of a picture")]
        let near = |rows: usize, want: f64| (rows as f64 - want).abs() < 26.0;
        assert!(near(happy, full * 0.8) && near(neutral, full * 0.4), "{happy} {neutral}");
        let svg = shares().svg();
        for text in ["share, %", "n = 318", "even", "ours", "paper", "32.0", "16.0"] {
            assert!(svg.contains(text), "{text}");
        }
    }
}

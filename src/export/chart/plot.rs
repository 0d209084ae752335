//! Lines and points over two axes, such as a fundamental diagram.

use super::bars::{step, tick};
use super::canvas::{Anchor, Canvas, Paint, Size};
use super::{Figure, MOST};

/// Size of the area between the axes, units.
const AREA: [f64; 2] = [460.0, 280.0];
const MARGIN: f64 = 20.0;
/// Width of a line, units.
const LINE: f64 = 2.0;
/// Radius of a point, units.
const POINT: f64 = 3.5;
/// Most points of one series; of longer ones, every n-th is drawn.
const MOST_POINTS: usize = 2000;

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// From point to point.
    Line,
    /// Likewise, interrupted.
    Dashed,
    /// The points alone.
    Points,
}

/// Points of one colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// In the legend.
    pub name: String,
    /// x and y; points that are not finite are left out.
    pub points: Vec<[f64; 2]>,
    /// How they are drawn.
    pub stroke: Stroke,
    /// sRGB, readable on white and on black.
    pub color: [u8; 3],
}

/// A figure of curves. The axes begin at 0, the vertical one below it where a curve does. What lies left of 0 is drawn on the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Above the figure.
    pub title: String,
    /// What x and y are, with units.
    pub axes: [String; 2],
    /// The curves, the last on top.
    pub curves: Vec<Curve>,
    /// Below the figure.
    pub note: String,
}

impl Plot {
    /// The axis' begin and end, whole numbers of steps, and the step.
    fn reach(&self, axis: usize) -> [f64; 3] {
        let values = self.curves.iter().flat_map(|curve| &curve.points).map(|point| point[axis]);
        let values = values.filter(|value| value.is_finite());
        let (lowest, highest) = values.fold((0.0_f64, 0.0_f64), |(a, b), value| (a.min(value), b.max(value)));
        let lowest = if axis == 0 { 0.0 } else { lowest };
        let length = highest - lowest;
        if !(length > 1e-300 && length < 1e300) {
            return [0.0, 1.0, 0.2];
        }
        let step = step(length);
        let whole = |value: f64| (value.abs() / step - 1e-9).ceil().max(0.0) * step * value.signum();
        [whole(lowest), whole(highest), step]
    }
}

impl Figure for Plot {
    fn canvas(&self) -> Canvas {
        let (length, space) = (|text: &str| Size::Normal.width(text), Size::Normal.space());
        let ([_, x_end, x_step], [y_begin, y_end, y_step]) = (self.reach(0), self.reach(1));
        let curves = self.curves.len().min(MOST);
        let ticks = [y_begin, y_end].map(|end| length(&tick(end, y_step)));
        let left = MARGIN + ticks[0].max(ticks[1]) + space;
        let top = MARGIN + Canvas::line(Size::Title) + 26.0;
        let (right, bottom) = (left + AREA[0], top + AREA[1]);
        let names = self.curves.iter().take(curves).map(|curve| length(&curve.name)).fold(0.0, f64::max);
        let title = Size::Title.width(&self.title);
        let width =
            [right + 44.0 + names, MARGIN + title, MARGIN + length(&self.note).max(length(&self.axes[1]))];
        let width = width.into_iter().fold(0.0, f64::max) + MARGIN;
        let note = if self.note.is_empty() { 0.0 } else { 22.0 };
        let mut canvas = Canvas::new(width, bottom + 56.0 + note, &self.title);
        let x = |value: f64| left + AREA[0] * (value / x_end).clamp(0.0, 1.0);
        let y = |value: f64| bottom - AREA[1] * ((value - y_begin) / (y_end - y_begin)).clamp(0.0, 1.0);
        let start = (Size::Normal, Anchor::Start, Paint::Ink);
        canvas.text([MARGIN, MARGIN + 13.0], (Size::Title, Anchor::Start, Paint::Ink), &self.title);
        canvas.text([MARGIN, top - 12.0], (Size::Normal, Anchor::Start, Paint::Muted), &self.axes[1]);
        let mut at = y_begin;
        while at <= y_end + 0.5 * y_step {
            let paint = if at.abs() > 0.5 * y_step { Paint::Grid } else { Paint::Ink };
            canvas.rect([left, y(at) - 0.5], [AREA[0], 1.0], paint);
            let style = (Size::Normal, Anchor::End, Paint::Muted);
            canvas.text([left - space, y(at) + 4.0], style, &tick(at, y_step));
            at += y_step;
        }
        at = 0.0;
        while at <= x_end + 0.5 * x_step {
            let paint = if at > 0.0 { Paint::Grid } else { Paint::Ink };
            canvas.rect([x(at) - 0.5, top], [1.0, AREA[1]], paint);
            let style = (Size::Normal, Anchor::Middle, Paint::Muted);
            canvas.text([x(at), bottom + 18.0], style, &tick(at, x_step));
            at += x_step;
        }
        let style = (Size::Normal, Anchor::Middle, Paint::Muted);
        canvas.text([0.5 * (left + right), bottom + 38.0], style, &self.axes[0]);
        for (index, curve) in self.curves.iter().take(curves).enumerate() {
            let every = curve.points.len().div_ceil(MOST_POINTS).max(1);
            let points: Vec<[f64; 2]> = curve
                .points
                .iter()
                .step_by(every)
                .filter(|point| point.iter().all(|value| value.is_finite()))
                .map(|point| [x(point[0]), y(point[1])])
                .collect();
            draw(&mut canvas, &points, curve);
            let row = top + 12.0 + 20.0 * index as f64;
            let ends = [[right + 12.0, row - 4.0], [right + 34.0, row - 4.0]];
            let sample =
                if curve.stroke == Stroke::Points { vec![[right + 23.0, row - 4.0]] } else { ends.to_vec() };
            draw(&mut canvas, &sample, curve);
            canvas.text([right + 42.0, row], start, &curve.name);
        }
        let style = (Size::Normal, Anchor::Start, Paint::Muted);
        canvas.text([MARGIN, bottom + 62.0], style, &self.note);
        canvas
    }
}

/// Draws `points` of the canvas as `curve` is drawn.
fn draw(canvas: &mut Canvas, points: &[[f64; 2]], curve: &Curve) {
    match curve.stroke {
        Stroke::Points => {
            for &point in points {
                canvas.dot(point, POINT, Paint::Fixed(curve.color));
            }
        }
        Stroke::Line => {
            for ends in points.windows(2) {
                canvas.line_between([ends[0], ends[1]], LINE, curve.color);
            }
        }
        Stroke::Dashed => {
            let mut walked = 0.0;
            for ends in points.windows(2) {
                dashes(canvas, [ends[0], ends[1]], &mut walked, curve.color);
            }
        }
    }
}

/// Dashes of 7 units every 12, counted on from `walked`.
fn dashes(canvas: &mut Canvas, [a, b]: [[f64; 2]; 2], walked: &mut f64, color: [u8; 3]) {
    const DASH: f64 = 7.0;
    const PERIOD: f64 = 12.0;
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    let at = |s: f64| [a[0] + (b[0] - a[0]) * s / length, a[1] + (b[1] - a[1]) * s / length];
    let mut s = 0.0;
    while s < length {
        let phase = (*walked + s) % PERIOD;
        let (end, drawn) = if phase < DASH { (s + DASH - phase, true) } else { (s + PERIOD - phase, false) };
        let end = end.min(length).max(s + 1e-6);
        if drawn {
            canvas.line_between([at(s), at(end)], LINE, color);
        }
        s = end;
    }
    *walked += length;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> Plot {
        let curve = |name: &str, stroke, color| Curve {
            name: name.to_owned(),
            points: (0..20).map(|i| [f64::from(i) * 0.1, 1.3 - f64::from(i) * 0.05]).collect(),
            stroke,
            color,
        };
        Plot {
            title: "Speed & density".into(),
            axes: ["density, 1/m²".into(), "speed, m/s".into()],
            curves: vec![
                curve("line", Stroke::Line, [200, 66, 52]),
                curve("dashes", Stroke::Dashed, [66, 118, 190]),
                curve("points", Stroke::Points, [222, 158, 20]),
            ],
            note: "n = 20".into(),
        }
    }

    #[test]
    fn all_curves_are_drawn_in_their_colours_as_svg_and_as_pixels() {
        let (svg, image) = (plot().svg(), plot().image().unwrap());
        assert_eq!(svg.matches("<circle").count(), 21);
        assert!(svg.matches("<line").count() > 40 && svg.contains("Speed &amp; density"));
        for color in [[200, 66, 52], [66, 118, 190], [222, 158, 20]] {
            let count = image.pixels.chunks_exact(4).filter(|pixel| pixel[..3] == color).count();
            assert!(count > 300, "{count} pixels of {color:?}");
        }
    }

    #[test]
    fn a_figure_of_nothing_or_of_nonsense_is_still_a_figure() {
        let mut plot = plot();
        plot.curves[0].points = vec![[f64::NAN, 1.0], [f64::INFINITY, 2.0]];
        plot.curves.truncate(1);
        assert!(plot.svg().contains("<svg"));
        plot.curves.clear();
        assert!(plot.image().unwrap().width > 100);
    }
}

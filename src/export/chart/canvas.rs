//! What figures are drawn on: rectangles, lines and text, rendered as SVG or pixels.

use super::super::font;
use crate::picture::Image;
use std::fmt::Write as _;

/// Pixels of a picture for one unit.
const PIXELS: f64 = 2.0;
/// Widest and highest figure, units.
const MOST_UNITS: f64 = 8000.0;

/// A colour, or the part it plays where the reader's colour scheme decides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Paint {
    /// Text and axes.
    Ink,
    /// Notes and names of axes.
    Muted,
    /// The ground of the figure.
    Paper,
    /// Grid lines.
    Grid,
    /// A colour of its own in both schemes, sRGB.
    Fixed([u8; 3]),
}

/// Where a text's position is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    /// At its left end.
    Start,
    /// In its middle.
    Middle,
    /// At its right end.
    End,
}

/// How large a text is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Size {
    /// 12 units.
    Normal,
    /// 17 units.
    Title,
}

impl Size {
    const fn units(self) -> f64 {
        match self {
            Self::Normal => 12.0,
            Self::Title => 17.0,
        }
    }

    /// Pixels of a dot of the bitmap font.
    const fn dot(self) -> u32 {
        match self {
            Self::Normal => 2,
            Self::Title => 3,
        }
    }

    /// Units from one character to the next, in the picture's font; that of an SVG is a little narrower.
    pub(super) fn advance(self) -> f64 {
        f64::from(font::ADVANCE * self.dot()) / PIXELS
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Mark {
    Rect { at: [f64; 2], size: [f64; 2], paint: Paint },
    Line { ends: [[f64; 2]; 2], width: f64, paint: Paint },
    Dot { at: [f64; 2], radius: f64, paint: Paint },
    Text { at: [f64; 2], size: Size, anchor: Anchor, paint: Paint, text: String },
}

/// A figure as marks. Units are those of the SVG, from the top left corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Canvas {
    width: f64,
    height: f64,
    title: String,
    marks: Vec<Mark>,
}

impl Canvas {
    /// An empty figure; `title` is what screen readers say.
    pub(super) fn new(width: f64, height: f64, title: &str) -> Self {
        let within = |size: f64| size.clamp(16.0, MOST_UNITS).ceil();
        Self { width: within(width), height: within(height), title: title.to_owned(), marks: Vec::new() }
    }

    pub(super) fn rect(&mut self, at: [f64; 2], size: [f64; 2], paint: Paint) {
        self.marks.push(Mark::Rect { at, size, paint });
    }

    /// A straight line with round ends.
    pub(super) fn line_between(&mut self, ends: [[f64; 2]; 2], width: f64, paint: Paint) {
        self.marks.push(Mark::Line { ends, width, paint });
    }

    pub(super) fn dot(&mut self, at: [f64; 2], radius: f64, paint: Paint) {
        self.marks.push(Mark::Dot { at, radius, paint });
    }

    /// Text whose line stands at `at[1]` (its baseline).
    pub(super) fn text(&mut self, at: [f64; 2], (size, anchor, paint): (Size, Anchor, Paint), text: &str) {
        if !text.is_empty() {
            self.marks.push(Mark::Text { at, size, anchor, paint, text: text.to_owned() });
        }
    }

    /// The figure as SVG.
    pub(super) fn svg(&self) -> String {
        let (width, height, title) = (self.width, self.height, escaped(&self.title));
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
             {height}\" role=\"img\">\n<title>{title}</title>\n<style>\ntext {{ font-family: system-ui, sans-serif; \
             font-size: 12px }}\n.title {{ font-size: 17px; font-weight: 600 }}\n.ink {{ fill: #1e2126 }}\n.muted {{ \
             fill: #5c636d }}\n.grid {{ fill: #d9dce0 }}\n.paper {{ fill: #ffffff }}\n@media \
             (prefers-color-scheme: dark) {{\n.ink {{ fill: #eceef1 }}\n.muted {{ fill: #a3abb6 }}\n.grid {{ fill: \
             #3a4048 }}\n.paper {{ fill: #14171b }}\n}}\n</style>\n<rect class=\"paper\" width=\"{width}\" \
             height=\"{height}\"/>\n"
        );
        for mark in &self.marks {
            // Writing into a String cannot fail.
            let _ = match mark {
                Mark::Rect { at: [x, y], size: [w, h], paint } => {
                    writeln!(
                        svg,
                        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" {}/>",
                        attribute(*paint, "")
                    )
                }
                Mark::Line { ends: [[x1, y1], [x2, y2]], width, paint } => writeln!(
                    svg,
                    "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke-width=\"{width:.1}\" \
                     stroke-linecap=\"round\" {}/>",
                    stroke(*paint)
                ),
                Mark::Dot { at: [x, y], radius, paint } => writeln!(
                    svg,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\" {}/>",
                    attribute(*paint, "")
                ),
                Mark::Text { at: [x, y], size, anchor, paint, text } => {
                    let anchor = match anchor {
                        Anchor::Start => "start",
                        Anchor::Middle => "middle",
                        Anchor::End => "end",
                    };
                    let size = if *size == Size::Title { " title" } else { "" };
                    let (paint, text) = (attribute(*paint, size), escaped(text));
                    writeln!(
                        svg,
                        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {paint}>{text}</text>"
                    )
                }
            };
        }
        svg + "</svg>\n"
    }

    /// The figure as pixels on white.
    pub(super) fn image(&self) -> Image {
        let mut image = Image::filled(pixel(self.width), pixel(self.height), [255; 4]);
        for mark in &self.marks {
            match mark {
                Mark::Rect { at, size, paint } => {
                    let [left, top] = at.map(pixel);
                    let [right, bottom] = [at[0] + size[0], at[1] + size[1]].map(pixel);
                    // A line thinner than a pixel is a pixel.
                    let (width, height) =
                        ((right - left.min(right)).max(1), (bottom - top.min(bottom)).max(1));
                    image.fill(left, top, width, height, color(*paint));
                }
                Mark::Line { ends: [a, b], width, paint } => {
                    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
                    #[allow(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "within a figure"
                    )]
                    let steps = (length * PIXELS).min(MOST_UNITS * PIXELS).ceil() as u32;
                    for k in 0..=steps {
                        let t = f64::from(k) / f64::from(steps.max(1));
                        let at = [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];
                        disc(&mut image, at, 0.5 * width, color(*paint));
                    }
                }
                Mark::Dot { at, radius, paint } => disc(&mut image, *at, *radius, color(*paint)),
                Mark::Text { at, size, anchor, paint, text } => {
                    let count = u32::try_from(text.chars().count()).unwrap_or(u32::MAX);
                    // The last character needs no space after it.
                    let wide =
                        (count.saturating_mul(font::ADVANCE)).saturating_sub(1).saturating_mul(size.dot());
                    let before = match anchor {
                        Anchor::Start => 0,
                        Anchor::Middle => wide / 2,
                        Anchor::End => wide,
                    };
                    let left = pixel(at[0]).saturating_sub(before);
                    let top = pixel(at[1]).saturating_sub(7 * size.dot());
                    for (x, y) in font::dots(text) {
                        let (dot, color) = (size.dot(), color(*paint));
                        image.fill(
                            left.saturating_add(x * dot),
                            top.saturating_add(y * dot),
                            dot,
                            dot,
                            color,
                        );
                    }
                }
            }
        }
        image
    }

    /// Units of a text's height.
    pub(super) const fn line(size: Size) -> f64 {
        size.units() * 1.4
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a figure's size")]
fn pixel(units: f64) -> u32 {
    (units * PIXELS).round().clamp(0.0, MOST_UNITS * PIXELS) as u32
}

/// A filled disc, at least a pixel.
fn disc(image: &mut Image, at: [f64; 2], radius: f64, color: [u8; 4]) {
    let mut y = -radius;
    while y <= radius {
        let half = (radius * radius - y * y).max(0.0).sqrt();
        let (left, right) = (pixel(at[0] - half), pixel(at[0] + half));
        image.fill(left, pixel(at[1] + y), (right - left.min(right)).max(1), 1, color);
        y += 1.0 / PIXELS;
    }
}

/// A line's colour; the reader's scheme decides through the same classes.
fn stroke(paint: Paint) -> String {
    match paint {
        Paint::Fixed([r, g, b]) => format!("stroke=\"#{r:02x}{g:02x}{b:02x}\""),
        other => format!("stroke=\"currentColor\" {}", attribute(other, "")),
    }
}

fn attribute(paint: Paint, more: &str) -> String {
    let class = match paint {
        Paint::Ink => "ink",
        Paint::Muted => "muted",
        Paint::Paper => "paper",
        Paint::Grid => "grid",
        Paint::Fixed([r, g, b]) => {
            return format!("fill=\"#{r:02x}{g:02x}{b:02x}\" class=\"{}\"", more.trim());
        }
    };
    format!("class=\"{class}{more}\"")
}

/// The colour of the light scheme.
const fn color(paint: Paint) -> [u8; 4] {
    match paint {
        Paint::Ink => [30, 33, 38, 255],
        Paint::Muted => [92, 99, 109, 255],
        Paint::Paper => [255; 4],
        Paint::Grid => [217, 220, 224, 255],
        Paint::Fixed([r, g, b]) => [r, g, b, 255],
    }
}

/// Text as XML wants it; characters that XML does not know are left out.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            control if control.is_control() && !matches!(control, '\t' | '\n') => {}
            other => safe.push(other),
        }
    }
    safe
}

/// Black or white, whichever reads better on `ground` (by the contrast ratio of WCAG 2).
pub(super) fn on(ground: [u8; 3]) -> Paint {
    // 0.179 is where black and white contrast alike: (L + 0.05)^2 = 1.05 x 0.05.
    if luminance(ground) > 0.179 { Paint::Fixed([16, 18, 22]) } else { Paint::Fixed([255; 3]) }
}

/// Relative luminance of WCAG 2, 0 to 1.
pub(super) fn luminance(color: [u8; 3]) -> f64 {
    let linear = color.map(|channel| {
        let value = f64::from(channel) / 255.0;
        if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    });
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

//! What figures are drawn on: rectangles, lines and text, written as SVG; a picture is that SVG rasterised.

use super::super::image::Error;
use super::super::raster;
use super::super::svg::escaped;
use crate::picture::Image;
use std::fmt::Write as _;

/// Pixels of a picture for one unit.
const PIXELS: f32 = 2.0;
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

    /// Units that a text may be wide. Each reader's `system-ui` is another font: the layout takes the widths of a wide one
    /// (`DejaVu Sans`), which the font of pictures stays below.
    pub(super) fn width(self, text: &str) -> f64 {
        let em = |character| match character {
            ' ' | '!' | '\'' | '(' | ')' | ',' | '-' | '.' | '/' | ':' | ';' | '[' | ']' | '|' => 0.4,
            'f' | 'i' | 'j' | 'l' | 'r' | 't' | 'I' | 'J' => 0.42,
            '%' | '@' | 'M' | 'W' | 'm' => 1.0,
            '+' | '<' | '=' | '>' | 'w' => 0.84,
            'A'..='Z' => 0.79,
            ' '..='~' => 0.68,
            _ => 1.0,
        };
        text.chars().map(em).sum::<f64>() * self.units()
    }

    /// Units between a text and what it stands beside.
    pub(super) const fn space(self) -> f64 {
        0.5 * self.units()
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Mark {
    Rect { at: [f64; 2], size: [f64; 2], paint: Paint },
    Line { ends: [[f64; 2]; 2], width: f64, color: [u8; 3] },
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
    pub(super) fn line_between(&mut self, ends: [[f64; 2]; 2], width: f64, color: [u8; 3]) {
        self.marks.push(Mark::Line { ends, width, color });
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
             {height}\" role=\"img\">\n<title>{title}</title>\n<style>\nrect {{ shape-rendering: crispEdges }}\ntext {{ font-family: system-ui, sans-serif; \
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
                Mark::Line { ends: [[x1, y1], [x2, y2]], width, color: [r, g, b] } => writeln!(
                    svg,
                    "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke-width=\"{width:.1}\" \
                     stroke-linecap=\"round\" stroke=\"#{r:02x}{g:02x}{b:02x}\"/>"
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

    /// The figure as pixels, in the light scheme.
    pub(super) fn image(&self) -> Result<Image, Error> {
        raster::pixels(&self.svg(), PIXELS).map_err(Error::Draw)
    }

    /// Units of a text's height.
    pub(super) const fn line(size: Size) -> f64 {
        size.units() * 1.4
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

//! Figures of results: bars, matrices and curves, as SVG text and as a picture of that SVG. Plain data in.
//!
//! An SVG follows the reader's colour scheme, light or dark; a PNG has its own paper and reads on both. Every value is
//! written out, so no figure needs its colours to be read. The colour-blind can distinguish the colours: matrices run in one
//! hue, or from blue to red through white.

mod bars;
mod canvas;
mod funnel;
mod likert;
mod matrix;
mod means;
mod plot;
mod strip;

use super::{AtomicFile, Error};
use crate::picture::Image;
pub use bars::{Bar, Bars, Series};
use canvas::Canvas;
pub use funnel::{Funnel, FunnelStep};
pub use likert::{Likert, LikertRow};
pub use matrix::{Matrix, Scale};
pub use means::{Mean, MeanSeries, Means, SERIES_COLORS};
pub use plot::{Curve, Plot, Stroke};
use std::io::Write as _;
use std::path::{Path, PathBuf};
pub use strip::{Strip, StripColumn};

/// Colours of happy, angry, sad and neutral in figures, sRGB, in the order of [`crate::Emotion::ALL`]: dark enough on
/// white and light enough on black.
pub const EMOTION_COLORS: [[u8; 3]; 4] = [[222, 158, 20], [200, 66, 52], [66, 118, 190], [132, 138, 146]];

/// Most rows, columns, bars or series of one figure.
pub const MOST: usize = 200;

/// Something that can be drawn as a figure.
pub trait Figure {
    #[doc(hidden)]
    fn canvas(&self) -> Canvas;

    /// The figure as an SVG file's text.
    fn svg(&self) -> String {
        self.canvas().svg()
    }

    /// The figure as a picture, two pixels for each unit of the SVG.
    ///
    /// # Errors
    /// [`super::image::Error::Draw`] in a build without the feature `charts`.
    fn image(&self) -> Result<Image, super::image::Error> {
        self.canvas().image()
    }
}

/// Writes `NAME.svg` and `NAME.png` into a folder, which is made if it is not there; returns both paths.
///
/// # Errors
/// [`Error::Write`] or [`Error::Picture`] when the folder or a file cannot be made, or in a build without the feature `charts`.
pub fn write(folder: &Path, name: &str, figure: &dyn Figure) -> Result<[PathBuf; 2], Error> {
    let wrong = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::Write { path, source }
    };
    let image = figure.image()?;
    std::fs::create_dir_all(folder).map_err(wrong(folder))?;
    let (svg, png) = (folder.join(format!("{name}.svg")), folder.join(format!("{name}.png")));
    let mut file = AtomicFile::create(&svg)?;
    file.write_all(figure.svg().as_bytes()).map_err(wrong(&svg))?;
    file.finish()?;
    super::image::write_png(&png, &image)?;
    Ok([svg, png])
}

#[cfg(test)]
#[cfg(feature = "charts")]
#[allow(clippy::cast_possible_truncation, reason = "units of a figure")]
mod tests {
    use super::canvas::{Anchor, Paint, Size};
    use super::*;
    use crate::export::raster::texts;

    fn wide() -> [String; 4] {
        [
            "WWWWWW, MMMM",
            "E-GAIT: 100 % AT 25 \u{b0}C",
            "illicit fjords",
            "\u{d6}\u{c4}\u{dc} \u{2248} 5 m\u{b2}",
        ]
        .map(str::to_owned)
    }

    /// Every text within the figure and none over another one.
    fn assert_legible(figure: &dyn Figure) {
        let svg = figure.svg();
        let (boxes, image) = (texts(&svg), figure.image().unwrap());
        assert!(boxes.len() > 8, "{svg}");
        let [width, height] = [image.width, image.height].map(|pixels| pixels as f32 / 2.0);
        for (index, a) in boxes.iter().enumerate() {
            assert!(
                a[0] >= 0.0 && a[1] >= 0.0 && a[2] <= width && a[3] <= height,
                "{a:?} of {width} x {height}"
            );
            for b in &boxes[..index] {
                let meet = a[0] < b[2] && b[0] < a[2] && a[1] + 2.0 < b[3] && b[1] + 2.0 < a[3];
                assert!(!meet, "{a:?} {b:?} in {svg}");
            }
        }
    }

    #[test]
    fn the_layout_has_room_for_every_text() {
        let letters =
            (' '..='~').chain('\u{a1}'..='\u{17f}').chain("\u{2013}\u{2248}\u{20ac}\u{3b1}\u{416}".chars());
        for letter in letters {
            for size in [Size::Normal, Size::Title] {
                let text = format!("n{letter}n");
                let mut canvas = Canvas::new(400.0, 40.0, "");
                canvas.text([10.0, 20.0], (size, Anchor::Start, Paint::Ink), &text);
                let (found, room) = (texts(&canvas.svg())[0], size.width(&text));
                assert!(f64::from(found[2] - 10.0) <= room, "{text:?}: {found:?}, room {room}");
            }
        }
    }

    #[test]
    fn texts_of_figures_stay_within_them_and_apart() {
        let title = wide().join(" ").repeat(2);
        let bars =
            |k: f64| [88.0, 100.0, 7.5, 0.0].map(|value| Bar { value: value * k, ..Bar::default() }).to_vec();
        let series = |k| Series { name: wide()[0].clone(), bars: bars(k), colors: EMOTION_COLORS.to_vec() };
        assert_legible(&Bars {
            title: title.clone(),
            axis: wide().concat(),
            groups: wide().to_vec(),
            series: vec![series(1.0), series(0.5)],
            line: None,
            decimals: 1,
            note: title.repeat(2),
        });
        let counts = vec![vec![1_000_000, 2, 3, 4]; 4];
        assert_legible(&Matrix::confusion(&title, ["WANTED", "PERCEIVED"], &wide(), &counts));
        let curves = wide().map(|name| Curve {
            name,
            points: vec![[0.0, 1e5], [9.0, 2e5]],
            stroke: Stroke::Line,
            color: [0; 3],
        });
        let axes = [wide()[1].clone(), wide().concat()];
        assert_legible(&Plot { title: title.clone(), axes, curves: curves.to_vec(), note: title.clone() });
        assert_legible_of_studies(&title);
    }

    /// The figures of studies, with texts as long.
    fn assert_legible_of_studies(title: &str) {
        let (title, note) = (title.to_owned(), title.to_owned());
        let row = |name: &String| LikertRow { name: name.clone(), counts: vec![3, 4, 2, 5] };
        let rows = wide().iter().map(row).collect();
        assert_legible(&Likert { title: title.clone(), points: wide().to_vec(), rows, note: note.clone() });
        let mean = |value: f64| Some(Mean { value, interval: [value - 0.8, value + 0.8] });
        let series =
            |name: &String| MeanSeries { name: name.clone(), means: [1.0, 3.0, 5.0, 7.0].map(mean).to_vec() };
        let series = wide().iter().map(series).collect();
        let (axis, groups, range) = (wide().concat(), wide().to_vec(), [1.0, 7.0]);
        assert_legible(&Means {
            title: title.clone(),
            axis: axis.clone(),
            range,
            groups,
            series,
            note: note.clone(),
        });
        let dots = (0..90_u32).map(|value| (f64::from(value % 40) / 10.0 + 1.0, [66, 118, 190])).collect();
        let columns =
            ["happy", "angry"].map(|name| StripColumn { name: name.to_owned(), dots: Vec::clone(&dots) });
        let legend = wide().map(|name| (name, [66, 118, 190])).to_vec();
        let (columns, line, range) = (columns.to_vec(), Some((3.5, wide()[1].clone())), [1.0, 5.0]);
        assert_legible(&Strip { title: title.clone(), axis, range, columns, line, legend, note });
        let step = |(index, name): (usize, &String)| FunnelStep {
            name: name.clone(),
            count: 1000 / (1 + 60 * index),
            losses: vec![(name.clone(), 7), (name.clone(), 12)],
        };
        assert_legible(&Funnel { title, steps: wide().iter().enumerate().map(step).collect() });
    }

    #[test]
    fn a_picture_is_the_light_scheme_of_its_svg_with_smooth_letters() {
        let canvas = {
            let mut canvas = Canvas::new(40.0, 20.0, "");
            canvas.text([4.0, 15.0], (Size::Normal, Anchor::Start, Paint::Ink), "agoe");
            canvas
        };
        let image = canvas.image().unwrap();
        assert_eq!((image.width, image.height, image.pixel(0, 0)), (80, 40, Some([255; 4])));
        let mut greys: Vec<u8> = image.pixels.chunks_exact(4).map(|pixel| pixel[1]).collect();
        greys.sort_unstable();
        greys.dedup();
        assert!(greys[0] < 80 && greys.len() > 16, "{greys:?}");
    }
}

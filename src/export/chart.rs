//! Figures of results: bars, matrices and curves, as SVG text and as a picture. Plain data in.
//!
//! An SVG follows the reader's colour scheme, light or dark; a PNG has its own paper and reads on both. Every value is
//! written out, so no figure needs its colours to be read. The colour-blind can distinguish the colours: matrices run in one
//! hue, or from blue to red through white.

mod bars;
mod canvas;
mod matrix;
mod plot;

use super::{AtomicFile, Error};
use crate::picture::Image;
pub use bars::{Bar, Bars, Series};
use canvas::Canvas;
pub use matrix::{Matrix, Scale};
pub use plot::{Curve, Plot, Stroke};
use std::io::Write as _;
use std::path::{Path, PathBuf};

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
    fn image(&self) -> Image {
        self.canvas().image()
    }
}

/// Writes `NAME.svg` and `NAME.png` into a folder, which is made if it is not there; returns both paths.
///
/// # Errors
/// [`Error::Write`] or [`Error::Picture`] when the folder or a file cannot be made.
pub fn write(folder: &Path, name: &str, figure: &dyn Figure) -> Result<[PathBuf; 2], Error> {
    let wrong = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::Write { path, source }
    };
    std::fs::create_dir_all(folder).map_err(wrong(folder))?;
    let (svg, png) = (folder.join(format!("{name}.svg")), folder.join(format!("{name}.png")));
    let mut file = AtomicFile::create(&svg)?;
    file.write_all(figure.svg().as_bytes()).map_err(wrong(&svg))?;
    file.finish()?;
    super::image::write_png(&png, &figure.image())?;
    Ok([svg, png])
}

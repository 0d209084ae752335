//! Pictures into PNG files, and many pictures onto one sheet.

use super::raster;
use super::svg::escaped;
use crate::file::Partial;
use crate::picture::Image;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// A picture or a video could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be written.
    #[error("cannot write {path:?}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The name has no ending that says which format is wanted.
    #[error("{path:?} has the ending {found:?}; pictures can be {allowed}")]
    Ending {
        /// The file.
        path: PathBuf,
        /// Its ending.
        found: String,
        /// What can be written.
        allowed: &'static str,
    },
    /// A picture has a size that does not fit.
    #[error("picture of {width}x{height} pixels with {bytes} bytes: {problem}")]
    Size {
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Bytes it holds.
        bytes: usize,
        /// What is wrong, what is allowed, what to do.
        problem: String,
    },
    /// The frame rate cannot be used.
    #[error("a frame rate of {0} per second; give one from 1 to 1000")]
    FrameRate(f64),
    /// A figure or a caption could not be drawn.
    #[error("cannot draw the picture: {0}")]
    Draw(String),
    /// The video could not be coded.
    #[error("cannot code {path:?} as H.264: {message}")]
    Encode {
        /// The file.
        path: PathBuf,
        /// Why.
        message: String,
    },
}

impl Error {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Write { .. } => Some("give a path in a folder that exists and may be written to"),
            Self::Encode { .. } => Some("a name that ends in .y4m gives an uncompressed video"),
            Self::Size { .. } | Self::Ending { .. } | Self::FrameRate(_) | Self::Draw(_) => None,
        }
    }

    pub(super) fn write(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self::Write { path, source }
    }
}

/// Says what is wrong with a picture whose size and bytes do not agree.
pub(super) fn check(image: &Image) -> Result<(), Error> {
    let wanted = image.width as usize * image.height as usize * 4;
    let problem = if wanted == 0 {
        "a picture has at least one pixel".to_owned()
    } else if image.pixels.len() != wanted {
        format!("there should be {wanted} bytes")
    } else {
        return Ok(());
    };
    Err(Error::Size { width: image.width, height: image.height, bytes: image.pixels.len(), problem })
}

/// Writes a picture as PNG (8 bits a channel, sRGB, fast compression).
///
/// # Errors
/// When the name does not end in `.png`, the picture is empty, or the file cannot be written; nothing is left then.
pub fn write_png(path: &Path, image: &Image) -> Result<(), Error> {
    check(image)?;
    let found = path.extension().unwrap_or_default().to_string_lossy().into_owned();
    if !found.eq_ignore_ascii_case("png") {
        return Err(Error::Ending { path: path.to_path_buf(), found, allowed: ".png" });
    }
    let mut partial = Partial::create(path).map_err(Error::write(path))?;
    let mut out = BufWriter::new(&mut partial);
    let written = encode_png(&mut out, image).and_then(|()| out.flush());
    drop(out);
    written.and_then(|()| partial.finish()).map_err(Error::write(path))
}

/// A picture as PNG in memory.
///
/// # Errors
/// When the picture is empty, or this build has no feature `png`.
#[doc(hidden)]
pub fn png(image: &Image) -> Result<Vec<u8>, Error> {
    check(image)?;
    let mut bytes = Vec::new();
    encode_png(&mut bytes, image).map_err(Error::write(Path::new("memory")))?;
    Ok(bytes)
}

#[cfg(not(feature = "png"))]
fn encode_png(_: impl std::io::Write, _: &Image) -> std::io::Result<()> {
    Err(std::io::Error::new(std::io::ErrorKind::Unsupported, "this build has no feature `png`"))
}

#[cfg(feature = "png")]
fn encode_png(out: impl std::io::Write, image: &Image) -> std::io::Result<()> {
    // a picture without transparency needs no fourth channel: a quarter less to compress and to store
    let opaque = image.pixels.chunks_exact(4).all(|pixel| pixel[3] == 255);
    let rgb: Vec<u8>;
    let (color, data) = if opaque {
        rgb = image.pixels.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        (png::ColorType::Rgb, &rgb)
    } else {
        (png::ColorType::Rgba, &image.pixels)
    };
    let mut encoder = png::Encoder::new(out, image.width, image.height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(())
}

/// One picture of a contact sheet.
#[derive(Debug, Clone, Copy)]
pub struct Tile<'a> {
    /// Text below the picture; may be empty.
    pub caption: &'a str,
    /// The picture.
    pub image: &'a Image,
}

const PAPER: [u8; 4] = [24, 26, 30, 255];

/// Puts pictures in rows of `columns` (0: about as many as rows) with their captions below.
///
/// Every cell has the size of the largest picture. An ellipsis ends a line that is wider than its picture. No tiles give one
/// dark pixel.
///
/// # Errors
/// [`Error::Draw`] when there are captions and the build lacks the feature `charts`.
pub fn contact_sheet(tiles: &[Tile<'_>], columns: u32) -> Result<Image, Error> {
    /// Pixels between tiles.
    const GAP: u32 = 8;
    let count = u32::try_from(tiles.len()).unwrap_or(u32::MAX);
    if count == 0 {
        return Ok(Image::filled(1, 1, PAPER));
    }
    let columns =
        if columns == 0 { count.isqrt() + u32::from(count.isqrt().pow(2) < count) } else { columns }
            .min(count);
    let rows = count.div_ceil(columns);
    let width = tiles.iter().map(|tile| tile.image.width).max().unwrap_or(0);
    let height = tiles.iter().map(|tile| tile.image.height).max().unwrap_or(0);
    let letters = Letters { width, size: 12 * (width / 320).clamp(1, 3) };
    let lines = tiles.iter().map(|tile| tile.caption.lines().count()).max().unwrap_or(0);
    let below = letters.height(lines);
    let (across, down) = (width + GAP, height + below + GAP);
    let mut sheet = Image::filled(columns * across + GAP, rows * down + GAP, PAPER);
    for (index, tile) in (0_u32..).zip(tiles) {
        let (left, top) = (GAP + index % columns * across, GAP + index / columns * down);
        sheet.blit(tile.image, left, top);
        if !tile.caption.is_empty() {
            sheet.blit(&letters.picture(tile.caption)?, left, top + height);
        }
    }
    Ok(sheet)
}

/// Captions below pictures: light letters on [`PAPER`].
struct Letters {
    /// Pixels that a line may be wide.
    width: u32,
    /// Size of the letters, pixels.
    size: u32,
}

impl Letters {
    /// Pixels of so many lines, and a little above them.
    fn height(&self, lines: usize) -> u32 {
        u32::try_from(lines).unwrap_or(0) * self.size * 5 / 4 + if lines > 0 { self.size / 3 } else { 0 }
    }

    fn svg(&self, lines: &[String]) -> String {
        use std::fmt::Write as _;
        let (width, height, size) = (self.width, self.height(lines.len()), self.size);
        let [r, g, b, _] = PAPER;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\"><rect width=\"100%\" \
             height=\"100%\" fill=\"rgb({r},{g},{b})\"/>"
        );
        for (count, line) in (1..).zip(lines) {
            // The letters stand a quarter of their size above the bottom of their line.
            let (y, text) = (self.height(count) - size / 4, escaped(line));
            // Writing into a String cannot fail.
            let _ = write!(svg, "<text y=\"{y}\" font-size=\"{size}\" fill=\"#e8e8e4\">{text}</text>");
        }
        svg + "</svg>"
    }

    /// A line, or as much of its beginning as fits before an ellipsis.
    #[allow(clippy::cast_precision_loss, reason = "a picture's width")]
    fn fitted(&self, line: &str) -> Result<String, Error> {
        // No letter is narrower than a pixel.
        let mut kept: String = line.chars().take(self.width as usize).collect();
        let mut shown = line.to_owned();
        while raster::reach(&self.svg(&[shown.clone()])).map_err(Error::Draw)? > self.width as f32 {
            if kept.pop().is_none() {
                return Ok(String::new());
            }
            shown = format!("{}\u{2026}", kept.trim_end());
        }
        Ok(shown)
    }

    fn picture(&self, caption: &str) -> Result<Image, Error> {
        let lines: Result<Vec<String>, Error> = caption.lines().map(|line| self.fitted(line)).collect();
        raster::pixels(&self.svg(&lines?), 1.0).map_err(Error::Draw)
    }
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, reason = "remainders of 256")]
mod tests {
    use super::*;

    fn gradient(width: u32, height: u32, alpha: u8) -> Image {
        let mut image = Image::filled(width, height, [0, 0, 0, alpha]);
        for y in 0..height {
            for x in 0..width {
                image.set(x, y, [(x * 7 % 256) as u8, (y * 5 % 256) as u8, ((x + y) % 256) as u8, alpha]);
            }
        }
        image
    }

    fn read(path: &Path) -> (png::ColorType, Vec<u8>) {
        let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(path).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        (info.color_type, pixels)
    }

    #[test]
    fn a_png_holds_the_picture_and_nothing_else_stays_in_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let image = gradient(37, 19, 255);
        write_png(&path, &image).unwrap();
        let (color, pixels) = read(&path);
        let want: Vec<u8> = image.pixels.chunks(4).flat_map(|p| p[..3].to_vec()).collect();
        assert_eq!((color, pixels), (png::ColorType::Rgb, want));
        let clear = gradient(5, 4, 100);
        write_png(&path, &clear).unwrap();
        assert_eq!(read(&path), (png::ColorType::Rgba, clear.pixels));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_picture_that_cannot_be_written_is_refused_with_the_reason() {
        let folder = tempfile::tempdir().unwrap();
        let image = gradient(4, 4, 255);
        let error = write_png(&folder.path().join("a.jpg"), &image).unwrap_err();
        assert!(error.to_string().contains("jpg") && error.to_string().contains(".png"), "{error}");
        let error = write_png(&folder.path().join("none/a.png"), &image).unwrap_err();
        assert!(error.to_string().contains("none") && error.hint().is_some(), "{error}");
        let short = Image { width: 9, height: 9, pixels: vec![0; 8] };
        let error = write_png(&folder.path().join("a.png"), &short).unwrap_err();
        assert!(error.to_string().contains("324"), "{error}");
        std::fs::create_dir(folder.path().join("d.png")).unwrap();
        assert!(write_png(&folder.path().join("d.png"), &image).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    }

    #[test]
    fn tiles_stand_in_rows_with_captions_below() {
        let (red, blue) = (Image::filled(64, 32, [255, 0, 0, 255]), Image::filled(64, 32, [0, 0, 255, 255]));
        let tile = |caption, image| Tile { caption, image };
        let tiles = [tile("first", &red), tile("second\nline", &blue), tile("", &red)];
        let sheet = contact_sheet(&tiles, 0).unwrap();
        // Two lines of 15 pixels, 4 above them, and 8 to the next row.
        assert_eq!((sheet.width, sheet.height), (2 * 72 + 8, 2 * (32 + 34 + 8) + 8));
        assert_eq!(sheet.pixel(8, 8), Some([255, 0, 0, 255]));
        assert_eq!(sheet.pixel(80, 8), Some([0, 0, 255, 255]));
        assert_eq!(sheet.pixel(8, 82), Some([255, 0, 0, 255]));
        let ink = |left: u32, top: u32| {
            (left..left + 64).any(|x| (top..top + 15).any(|y| sheet.pixel(x, y).unwrap()[0] > 150))
        };
        assert!(ink(8, 44) && !ink(8, 59), "the first caption has one line");
        assert!(ink(80, 44) && ink(80, 59), "both lines of the second caption are there");
        assert!(!ink(8, 118) && !ink(8, 133), "the third has none");
        assert_eq!(contact_sheet(&[], 3).unwrap().width, 1);
    }

    #[test]
    fn captions_stop_where_their_picture_ends() {
        let tile = Image::filled(90, 8, [9, 9, 9, 255]);
        let long = "wanted: a very long caption & <more>";
        let sheet = contact_sheet(&[Tile { caption: long, image: &tile }; 2], 2).unwrap();
        let gap_is_clear =
            (8 + 90..8 + 98).all(|x| (0..sheet.height).all(|y| sheet.pixel(x, y) == Some(PAPER)));
        assert!(gap_is_clear);
        let letters = Letters { width: 90, size: 12 };
        let shown = letters.fitted(long).unwrap();
        assert!(shown.len() > 10 && shown.ends_with('\u{2026}') && long.starts_with(&shown[..10]), "{shown}");
        assert_eq!(letters.fitted("short").unwrap(), "short");
        assert_eq!(Letters { width: 1, size: 12 }.fitted(long).unwrap(), "");
    }
}

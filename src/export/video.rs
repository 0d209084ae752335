//! Pictures into a video: H.264 in MP4, which browsers and players open, or Y4M, uncompressed, which ffmpeg, mpv and VLC
//! read.
//!
//! Both get the same frames: 4:2:0, BT.709, limited range, chroma sited left (the default of both formats). Pictures of odd
//! width or height are continued by one column or row.

#[cfg(feature = "video")]
mod h264;

use super::image::{Error, check};
use crate::file::Partial;
use crate::picture::Image;
use rayon::prelude::*;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// A video being written. The file appears under its name when [`Video::finish`] is called, not before; a video that
/// is dropped leaves nothing behind.
#[derive(Debug)]
pub struct Video {
    sink: Sink,
    path: PathBuf,
    /// Size of the pictures.
    size: (u32, u32),
    /// Size of the frames, both even.
    even: (u32, u32),
    frames: u64,
    /// One frame: luma, then both chroma planes.
    planes: Vec<u8>,
}

#[derive(Debug)]
enum Sink {
    Y4m(BufWriter<Partial>),
    #[cfg(feature = "video")]
    H264(Box<h264::Mp4>),
}

impl Video {
    /// Begins a video of `width` x `height` pixels at `rate` frames per second, by the ending of its name: `.mp4` (a build
    /// with the feature `video`) or `.y4m`.
    ///
    /// # Errors
    /// When size, rate or ending cannot be used, or the file cannot be made.
    pub fn create(path: &Path, width: u32, height: u32, rate: f64) -> Result<Self, Error> {
        let too_much = || Error::Size {
            width,
            height,
            bytes: 0,
            problem: "a video has 1 to 16384 pixels a side".into(),
        };
        if !(1..=16_384).contains(&width) || !(1..=16_384).contains(&height) {
            return Err(too_much());
        }
        let even = (width.next_multiple_of(2), height.next_multiple_of(2));
        let rate = rational(rate)?;
        let found = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let begin = || Partial::create(path).map(BufWriter::new).map_err(Error::write(path));
        let sink = match found.as_str() {
            "y4m" => {
                let mut out = begin()?;
                let ((width, height), (n, d)) = (even, rate);
                // C420mpeg2: 4:2:0 with chroma sited left
                writeln!(out, "YUV4MPEG2 W{width} H{height} F{n}:{d} Ip A1:1 C420mpeg2 XCOLORRANGE=LIMITED")
                    .map_err(Error::write(path))?;
                Sink::Y4m(out)
            }
            #[cfg(feature = "video")]
            "mp4" => Sink::H264(Box::new(h264::Mp4::begin(path, begin()?, even, rate)?)),
            _ => return Err(Error::Ending { path: path.to_path_buf(), found, allowed: ENDINGS }),
        };
        let planes = vec![0; even.0 as usize * even.1 as usize * 3 / 2];
        Ok(Self { sink, path: path.to_owned(), size: (width, height), even, frames: 0, planes })
    }

    /// The file that will be there in the end.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Frames written so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// When the picture has another size than the video, it cannot be encoded, or the disk is full.
    pub fn push(&mut self, image: &Image) -> Result<(), Error> {
        check(image)?;
        if (image.width, image.height) != self.size {
            let problem = format!("the video has frames of {}x{}", self.size.0, self.size.1);
            let bytes = image.pixels.len();
            return Err(Error::Size { width: image.width, height: image.height, bytes, problem });
        }
        if self.size == self.even {
            planes_from_image(image, &mut self.planes);
        } else {
            planes_from_image(&continued(image, self.even), &mut self.planes);
        }
        match &mut self.sink {
            Sink::Y4m(out) => out
                .write_all(b"FRAME\n")
                .and_then(|()| out.write_all(&self.planes))
                .map_err(Error::write(&self.path))?,
            #[cfg(feature = "video")]
            Sink::H264(mp4) => mp4.push(&self.planes)?,
        }
        self.frames += 1;
        Ok(())
    }

    /// Completes the file and gives it its name, which is returned.
    ///
    /// # Errors
    /// When the disk is full.
    #[cfg_attr(
        not(feature = "video"),
        allow(clippy::infallible_destructuring_match, reason = "there is one kind of sink less")
    )]
    pub fn finish(self) -> Result<PathBuf, Error> {
        let out = match self.sink {
            Sink::Y4m(out) => out,
            #[cfg(feature = "video")]
            Sink::H264(mp4) => mp4.finish()?,
        };
        let whole = out.into_inner().map_err(std::io::IntoInnerError::into_error);
        whole.and_then(Partial::finish).map_err(Error::write(&self.path))?;
        Ok(self.path)
    }
}

/// What the names of videos end in.
const ENDINGS: &str = if cfg!(feature = "video") {
    ".mp4 or .y4m"
} else {
    ".y4m (.mp4 takes a build with the feature `video`)"
};

/// The picture with its last column and row once more, where that makes its sides even.
fn continued(image: &Image, (width, height): (u32, u32)) -> Image {
    let at = |x: u32, y: u32| image.pixel(x.min(image.width - 1), y.min(image.height - 1)).unwrap_or([0; 4]);
    let pixels = (0..height).flat_map(|y| (0..width).flat_map(move |x| at(x, y))).collect();
    Image { width, height, pixels }
}

/// Frames per second as a fraction: whole numbers as they are, others to a thousandth.
fn rational(rate: f64) -> Result<(u32, u32), Error> {
    if !(1.0..=1000.0).contains(&rate) {
        return Err(Error::FrameRate(rate));
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1000 to 1 000 000")]
    let thousandths = (rate * 1000.0).round() as u32;
    Ok(if thousandths.is_multiple_of(1000) { (thousandths / 1000, 1) } else { (thousandths, 1000) })
}

/// Luma and chroma of a picture, BT.709, limited range (16 to 235, 16 to 240), both sizes even.
fn planes_from_image(image: &Image, planes: &mut [u8]) {
    let width = image.width as usize;
    let (luma, chroma) = planes.split_at_mut(width * image.height as usize);
    let (cb, cr) = chroma.split_at_mut(chroma.len() / 2);
    image
        .pixels
        .par_chunks(width * 8)
        .zip(luma.par_chunks_mut(width * 2))
        .zip(cb.par_chunks_mut(width / 2).zip(cr.par_chunks_mut(width / 2)))
        .for_each(|((pixels, luma), (cb, cr))| {
            for (pixel, y) in pixels.chunks_exact(4).zip(luma) {
                *y = yuv_from_rgb([pixel[0], pixel[1], pixel[2]].map(i32::from), 0)[0];
            }
            // a chroma sample stands on the left luma column, between two rows: weights 1 2 1 across, 1 1 down
            for column in 0..width / 2 {
                let mut sum = [0_i32; 3];
                for (x, weight) in [((2 * column).saturating_sub(1), 1), (2 * column, 2), (2 * column + 1, 1)]
                {
                    for at in [x * 4, (width + x) * 4] {
                        for (channel, total) in sum.iter_mut().enumerate() {
                            *total += weight * i32::from(pixels[at + channel]);
                        }
                    }
                }
                let [_, b, r] = yuv_from_rgb(sum, 3);
                (cb[column], cr[column]) = (b, r);
            }
        });
}

/// One colour, its channels scaled by `1 << shift`, in 16 bits of fraction.
///
/// Y = 16 + 219 (0.2126 R + 0.7152 G + 0.0722 B), Cb = 128 + 224 (B − Y') / 1.8556, Cr = 128 + 224 (R − Y') / 1.5748,
/// with R, G, B in 0 to 1 (ITU-R BT.709); here in 0 to 255.
fn yuv_from_rgb([r, g, b]: [i32; 3], shift: u32) -> [u8; 3] {
    let mix = |kr: i32, kg: i32, kb: i32, base: i32| {
        let sum = kr * r + kg * g + kb * b;
        let value = (sum + (1 << (15 + shift))) >> (16 + shift);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a byte")]
        let byte = (value + base).clamp(0, 255) as u8;
        byte
    };
    [mix(11_966, 40_254, 4_064, 16), mix(-6_596, -22_189, 28_785, 128), mix(28_785, -26_146, -2_639, 128)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_the_values_of_bt709() {
        let yuv = |r, g, b| yuv_from_rgb([r, g, b], 0);
        assert_eq!(yuv(0, 0, 0), [16, 128, 128]);
        assert_eq!(yuv(255, 255, 255), [235, 128, 128]);
        assert_eq!(yuv(255, 0, 0), [63, 102, 240]);
        assert_eq!(yuv(0, 255, 0), [173, 42, 26]);
        assert_eq!(yuv(0, 0, 255), [32, 240, 118]);
        for gray in 0..=255 {
            assert_eq!(yuv(gray, gray, gray)[1..], [128, 128], "gray has no colour");
        }
    }

    #[test]
    fn a_y4m_holds_every_frame_and_appears_only_when_finished() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("v.y4m");
        let mut video = Video::create(&path, 4, 2, 29.97).unwrap();
        let mut frame = Image::filled(4, 2, [255, 0, 0, 255]);
        frame.fill(2, 0, 2, 2, [0, 0, 255, 255]);
        video.push(&frame).unwrap();
        video.push(&Image::filled(4, 2, [255; 4])).unwrap();
        assert!(!path.exists());
        assert_eq!(video.finish().unwrap(), path);
        let bytes = std::fs::read(&path).unwrap();
        let head = b"YUV4MPEG2 W4 H2 F29970:1000 Ip A1:1 C420mpeg2 XCOLORRANGE=LIMITED\n";
        let mut want = head.to_vec();
        want.extend(b"FRAME\n");
        want.extend([63, 63, 32, 32, 63, 63, 32, 32]);
        // the second sample mixes a quarter of red into three quarters of blue
        want.extend([102, 206, 240, 148]);
        want.extend(b"FRAME\n");
        want.extend([235; 8].into_iter().chain([128; 4]));
        assert_eq!(bytes, want);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn an_abandoned_video_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut video = Video::create(&folder.path().join("v.y4m"), 2, 2, 30.0).unwrap();
        video.push(&Image::filled(2, 2, [0; 4])).unwrap();
        drop(video);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn what_cannot_be_a_video_is_refused_with_what_could() {
        let folder = tempfile::tempdir().unwrap();
        let make = |name: &str, width, rate| {
            Video::create(&folder.path().join(name), width, 4, rate).unwrap_err().to_string()
        };
        assert!(make("v.y4m", 0, 30.0).contains("1 to 16384"));
        assert!(make("v.y4m", 4, f64::NAN).contains("1 to 1000"));
        assert!(make("v.avi", 4, 30.0).contains(".y4m"));
        let mut video = Video::create(&folder.path().join("v.y4m"), 4, 4, 30.0).unwrap();
        assert!(video.push(&Image::filled(4, 6, [0; 4])).unwrap_err().to_string().contains("4x4"));
    }

    #[test]
    fn odd_sizes_are_continued_by_their_last_column_and_row() {
        let mut image = Image::filled(3, 1, [10, 20, 30, 255]);
        image.fill(2, 0, 1, 1, [200, 0, 0, 255]);
        let wide = continued(&image, (4, 2));
        assert_eq!((wide.width, wide.height, wide.pixels.len()), (4, 2, 32));
        assert_eq!(wide.pixel(3, 1), Some([200, 0, 0, 255]));
        assert_eq!(wide.pixel(1, 1), Some([10, 20, 30, 255]));
        let folder = tempfile::tempdir().unwrap();
        let mut video = Video::create(&folder.path().join("v.y4m"), 3, 1, 30.0).unwrap();
        video.push(&image).unwrap();
        let bytes = std::fs::read(video.finish().unwrap()).unwrap();
        assert!(bytes.starts_with(b"YUV4MPEG2 W4 H2 "));
    }
}

//! Pictures into a video: H.264 in MP4 through the ffmpeg program where there is one, else Y4M, uncompressed, which
//! ffmpeg, mpv and VLC read.
//!
//! Both get the same frames: 4:2:0, BT.709, limited range, chroma sited left (the default of both formats).

use super::image::{Error, check};
use crate::file::Partial;
use crate::picture::Image;
use rayon::prelude::*;
use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;

/// A video being written. The file appears under its name when [`Video::finish`] is called, not before; a video that
/// is dropped leaves nothing behind.
#[derive(Debug)]
pub struct Video {
    sink: Sink,
    partial: Partial,
    path: PathBuf,
    width: u32,
    height: u32,
    frames: u64,
    /// One frame: luma, then both chroma planes.
    planes: Vec<u8>,
}

#[derive(Debug)]
enum Sink {
    Y4m(BufWriter<File>),
    Ffmpeg { child: Child, said: Option<JoinHandle<String>> },
}

/// The ffmpeg program in `PATH`, if there is one.
pub fn find_ffmpeg() -> Option<PathBuf> {
    let name = format!("ffmpeg{}", std::env::consts::EXE_SUFFIX);
    std::env::split_paths(&std::env::var_os("PATH")?)
        .map(|folder| folder.join(&name))
        .find(|file| file.is_file())
}

impl Video {
    /// Begins a video of `width` x `height` pixels (both even) at `rate` frames per second.
    ///
    /// A name in `.y4m` gives Y4M; `.mp4`, `.mov` or `.mkv` gives H.264 if ffmpeg is in `PATH`, and otherwise Y4M under
    /// the same name with the ending `.y4m`: [`Video::path`] says which.
    ///
    /// # Errors
    /// When size, rate or ending cannot be used, or the file cannot be made.
    pub fn create(path: &Path, width: u32, height: u32, rate: f64) -> Result<Self, Error> {
        Self::create_with(path, width, height, rate, find_ffmpeg().as_deref())
    }

    /// The same with a given ffmpeg program, or none.
    ///
    /// # Errors
    /// As [`Video::create`].
    pub fn create_with(
        path: &Path,
        width: u32,
        height: u32,
        rate: f64,
        ffmpeg: Option<&Path>,
    ) -> Result<Self, Error> {
        if width == 0 || height == 0 || width % 2 == 1 || height % 2 == 1 {
            let even = |n: u32| n.max(2) & !1;
            let problem =
                format!("a video needs an even width and height, such as {}x{}", even(width), even(height));
            return Err(Error::Size { width, height, bytes: 0, problem });
        }
        let rate = rational(rate)?;
        let found = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let container = match found.as_str() {
            "y4m" => None,
            "mp4" | "mov" => Some("mp4"),
            "mkv" => Some("matroska"),
            _ => {
                return Err(Error::Ending {
                    path: path.to_path_buf(),
                    found,
                    allowed: ".mp4, .mov, .mkv or .y4m",
                });
            }
        };
        let (path, ffmpeg) = match (container, ffmpeg) {
            (Some(container), Some(ffmpeg)) => (path.to_path_buf(), Some((container, ffmpeg))),
            _ => (path.with_extension("y4m"), None),
        };
        let partial = Partial::create(&path).map_err(Error::write(&path))?;
        let sink = match ffmpeg {
            Some((container, program)) => run_ffmpeg(program, container, &partial, (width, height), rate)?,
            None => {
                let mut out = BufWriter::new(File::create(partial.temporary()).map_err(Error::write(&path))?);
                // C420mpeg2: 4:2:0 with chroma sited left
                let (n, d) = rate;
                writeln!(out, "YUV4MPEG2 W{width} H{height} F{n}:{d} Ip A1:1 C420mpeg2 XCOLORRANGE=LIMITED")
                    .map_err(Error::write(&path))?;
                Sink::Y4m(out)
            }
        };
        let planes = vec![0; width as usize * height as usize * 3 / 2];
        Ok(Self { sink, partial, path, width, height, frames: 0, planes })
    }

    /// The file that will be there in the end.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Frames written so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Whether the frames go through ffmpeg (H.264) rather than into Y4M.
    pub fn is_compressed(&self) -> bool {
        matches!(self.sink, Sink::Ffmpeg { .. })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// When the picture has another size than the video, the disk is full, or ffmpeg has stopped.
    pub fn push(&mut self, image: &Image) -> Result<(), Error> {
        check(image)?;
        if (image.width, image.height) != (self.width, self.height) {
            let problem = format!("the video has frames of {}x{}", self.width, self.height);
            let bytes = image.pixels.len();
            return Err(Error::Size { width: image.width, height: image.height, bytes, problem });
        }
        planes_from_image(image, &mut self.planes);
        let written = match &mut self.sink {
            Sink::Y4m(out) => out.write_all(b"FRAME\n").and_then(|()| out.write_all(&self.planes)),
            Sink::Ffmpeg { child, .. } => match &mut child.stdin {
                Some(pipe) => pipe.write_all(&self.planes),
                None => Err(std::io::ErrorKind::BrokenPipe.into()),
            },
        };
        if let Err(source) = written {
            // a broken pipe says nothing; what ffmpeg said does
            return Err(match self.sink.close(&self.path) {
                Err(error @ Error::Ffmpeg { .. }) => error,
                _ => Error::Write { path: self.path.clone(), source },
            });
        }
        self.frames += 1;
        Ok(())
    }

    /// Completes the file and gives it its name, which is returned.
    ///
    /// # Errors
    /// When the disk is full or ffmpeg failed.
    pub fn finish(mut self) -> Result<PathBuf, Error> {
        self.sink.close(&self.path)?;
        self.partial.finish().map_err(Error::write(&self.path))?;
        Ok(self.path)
    }
}

impl Sink {
    /// Ends the stream and waits until everything is written.
    fn close(&mut self, path: &Path) -> Result<(), Error> {
        match self {
            Self::Y4m(out) => out.flush().map_err(Error::write(path)),
            Self::Ffmpeg { child, said } => {
                drop(child.stdin.take()); // the end of the stream
                let status = child.wait().map_err(Error::write(path))?;
                let said = said.take().and_then(|thread| thread.join().ok()).unwrap_or_default();
                if status.success() {
                    return Ok(());
                }
                let last: Vec<_> =
                    said.lines().rev().filter(|line| !line.trim().is_empty()).take(3).collect();
                let said = last.into_iter().rev().collect::<Vec<_>>().join("; ");
                let said = if said.is_empty() { status.to_string() } else { said };
                Err(Error::Ffmpeg { path: path.to_path_buf(), said })
            }
        }
    }
}

impl Drop for Sink {
    fn drop(&mut self) {
        if let Self::Ffmpeg { child, .. } = self {
            // already over after `close`; otherwise the video was given up
            let _ = child.kill();
            let _ = child.wait();
        }
    }
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

fn run_ffmpeg(
    program: &Path,
    container: &str,
    file: &Partial,
    size: (u32, u32),
    rate: (u32, u32),
) -> Result<Sink, Error> {
    const COLOR: [&str; 8] =
        ["-color_range", "tv", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"];
    let mut child = Command::new(program)
        .args(["-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "yuv420p"])
        .args([
            "-video_size",
            &format!("{}x{}", size.0, size.1),
            "-framerate",
            &format!("{}/{}", rate.0, rate.1),
        ])
        .args(COLOR)
        .args([
            "-i", "pipe:0", "-an", "-c:v", "libx264", "-preset", "medium", "-crf", "18", "-pix_fmt",
            "yuv420p",
        ])
        .args(COLOR)
        .args(if container == "mp4" { &["-movflags", "+faststart"][..] } else { &[] })
        .args(["-f", container])
        .arg(file.temporary())
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(Error::write(program))?;
    // read on a thread of its own: a full pipe would stop ffmpeg, and us with it
    let said = child.stderr.take().map(|mut pipe| {
        std::thread::spawn(move || {
            let mut text = Vec::new();
            let _ = pipe.by_ref().take(1 << 16).read_to_end(&mut text);
            let _ = std::io::copy(&mut pipe, &mut std::io::sink());
            String::from_utf8_lossy(&text).into_owned()
        })
    });
    Ok(Sink::Ffmpeg { child, said })
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
        let mut video = Video::create_with(&path, 4, 2, 29.97, None).unwrap();
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
        let mut video = Video::create_with(&folder.path().join("v.y4m"), 2, 2, 30.0, None).unwrap();
        video.push(&Image::filled(2, 2, [0; 4])).unwrap();
        drop(video);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn without_ffmpeg_the_ending_becomes_y4m() {
        let folder = tempfile::tempdir().unwrap();
        let video = Video::create_with(&folder.path().join("v.mp4"), 2, 2, 30.0, None).unwrap();
        assert!(video.path().ends_with("v.y4m") && !video.is_compressed());
        assert!(video.finish().unwrap().exists());
    }

    #[test]
    fn what_cannot_be_a_video_is_refused_with_what_could() {
        let folder = tempfile::tempdir().unwrap();
        let make = |name: &str, width, rate| {
            Video::create_with(&folder.path().join(name), width, 4, rate, None).unwrap_err().to_string()
        };
        assert!(make("v.y4m", 5, 30.0).contains("4x4"));
        assert!(make("v.y4m", 4, f64::NAN).contains("1 to 1000"));
        assert!(make("v.avi", 4, 30.0).contains(".mp4"));
        let mut video = Video::create_with(&folder.path().join("v.y4m"), 4, 4, 30.0, None).unwrap();
        assert!(video.push(&Image::filled(4, 6, [0; 4])).unwrap_err().to_string().contains("4x4"));
    }

    /// One test at a time makes and starts programs: a file that another thread's child still holds open for writing
    /// cannot be run.
    fn alone() -> std::sync::MutexGuard<'static, ()> {
        static ALONE: std::sync::Mutex<()> = std::sync::Mutex::new(());
        ALONE.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    #[cfg(unix)]
    fn program(folder: &Path, script: &str) -> PathBuf {
        use std::os::unix::fs::PermissionsExt;
        let path = folder.join("ffmpeg");
        std::fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
        path
    }

    #[test]
    #[cfg(unix)]
    fn ffmpeg_gets_raw_frames_and_writes_the_neighbour() {
        let _alone = alone();
        let folder = tempfile::tempdir().unwrap();
        // the last argument is the file
        let ffmpeg = program(folder.path(), "for out; do :; done; echo \"$*\" > \"$0.args\"; cat > \"$out\"");
        let path = folder.path().join("v.mp4");
        let mut video = Video::create_with(&path, 2, 2, 25.0, Some(&ffmpeg)).unwrap();
        assert!(video.is_compressed());
        for _ in 0..3 {
            video.push(&Image::filled(2, 2, [255; 4])).unwrap();
        }
        assert_eq!(video.finish().unwrap(), path);
        assert_eq!(std::fs::read(&path).unwrap(), [235, 235, 235, 235, 128, 128].repeat(3));
        let args = std::fs::read_to_string(folder.path().join("ffmpeg.args")).unwrap();
        assert!(args.contains("-video_size 2x2 -framerate 25/1") && args.contains("-c:v libx264"), "{args}");
        assert!(args.contains("-f mp4"), "{args}");
    }

    #[test]
    #[cfg(unix)]
    fn what_ffmpeg_says_when_it_stops_is_in_the_error() {
        let _alone = alone();
        let folder = tempfile::tempdir().unwrap();
        let ffmpeg = program(folder.path(), "echo 'Unknown encoder libx264' >&2; exit 1");
        let path = folder.path().join("v.mp4");
        let mut video = Video::create_with(&path, 256, 256, 25.0, Some(&ffmpeg)).unwrap();
        let frame = Image::filled(256, 256, [255; 4]);
        // the pipe holds some bytes, so the first frames may go through
        let error =
            (0..100).find_map(|_| video.push(&frame).err()).unwrap_or_else(|| video.finish().unwrap_err());
        assert!(error.to_string().contains("Unknown encoder libx264"), "{error}");
        assert!(error.hint().unwrap().contains(".y4m"));
        assert!(!path.exists());
    }

    #[test]
    fn ffmpeg_reads_both_formats_back_in_the_same_colours() {
        let _alone = alone();
        let Some(ffmpeg) = find_ffmpeg() else {
            println!("skipped: no ffmpeg in PATH");
            return;
        };
        let folder = tempfile::tempdir().unwrap();
        let mut frame = Image::filled(64, 32, [200, 60, 40, 255]);
        frame.fill(32, 0, 32, 32, [30, 90, 200, 255]);
        for name in ["v.mp4", "v.y4m", "v.mkv"] {
            let path = folder.path().join(name);
            let mut video = Video::create(&path, 64, 32, 24.0).unwrap();
            for _ in 0..5 {
                video.push(&frame).unwrap();
            }
            assert_eq!(video.finish().unwrap(), path);
            let read = Command::new(&ffmpeg)
                .args(["-loglevel", "error", "-i"])
                .arg(&path)
                .args(["-f", "rawvideo", "-pix_fmt", "rgb24", "-vf", "scale=in_color_matrix=bt709", "-"])
                .output()
                .unwrap();
            assert!(read.stderr.is_empty(), "{name}: {}", String::from_utf8_lossy(&read.stderr));
            assert_eq!(read.stdout.len(), 5 * 64 * 32 * 3, "{name}: five frames");
            for (x, want) in [(8, [200, 60, 40]), (56, [30, 90, 200])] {
                let at = (16 * 64 + x) * 3;
                let found = &read.stdout[at..at + 3];
                assert!(
                    found.iter().zip(want).all(|(a, b)| a.abs_diff(b) <= 4),
                    "{name}: {found:?} {want:?}"
                );
            }
        }
    }
}

//! H.264 (Constrained Baseline, by openh264) in MP4: `avc1` samples of one constant duration, the tables at the end.
//!
//! Quantization is held at or below [`WORST_QP`], whatever that takes, and the encoder has one thread: the same pictures give
//! the same file.

use super::Error;
use crate::file::Partial;
use mp4::{AvcConfig, Bytes, MediaConfig, Mp4Config, Mp4Sample, Mp4Writer, TrackConfig, TrackType};
use openh264::encoder::{
    BitRate, Complexity, Encoder, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, QpRange,
    RateControlMode, VuiConfig,
};
use openh264::formats::YUVSlices;
use openh264::{OpenH264API, Timestamp};
use std::fmt;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Coarsest and finest quantization (0 to 51).
const WORST_QP: u8 = 24;
const BEST_QP: u8 = 12;
/// Wanted bits for a pixel.
const BITS_PER_PIXEL: f64 = 0.2;
/// Seconds between two key frames.
const KEY_EVERY: u32 = 2;
/// What the encoder takes: fewest and most pixels of a side, and most of the shorter one.
const SIDES: [u32; 3] = [16, 3840, 2160];
/// Ticks of the file's clock for a frame, times those of [`super::rational`].
const TICKS: u32 = 100;
/// The only track.
const TRACK: u32 = 1;
/// Types of the NAL units that say how the stream is coded.
const SEQUENCE: u8 = 7;
const PICTURE: u8 = 8;

/// A file being written.
pub(super) struct Mp4 {
    path: PathBuf,
    size: (u32, u32),
    /// Frames per second.
    rate: (u32, u32),
    encoder: Encoder,
    writer: Mp4Writer<BufWriter<Partial>>,
    frames: u64,
}

impl fmt::Debug for Mp4 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mp4").field("path", &self.path).field("frames", &self.frames).finish_non_exhaustive()
    }
}

impl Mp4 {
    /// Begins a file of frames of that size, both sides even.
    pub(super) fn begin(
        path: &Path,
        out: BufWriter<Partial>,
        (width, height): (u32, u32),
        rate: (u32, u32),
    ) -> Result<Self, Error> {
        let [least, most, shorter] = SIDES;
        if width.min(height) < least || width.max(height) > most || width.min(height) > shorter {
            let problem = format!(
                "an .mp4 has {least} to {most} x {shorter} pixels; .y4m and folders of pictures take any"
            );
            return Err(Error::Size { width, height, bytes: 0, problem });
        }
        let per_second = f64::from(rate.0) / f64::from(rate.1);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturating, not negative"
        )]
        let (bits, key_frames) = (
            (f64::from(width * height) * per_second * BITS_PER_PIXEL).min(2e8) as u32,
            (per_second * f64::from(KEY_EVERY)).ceil() as u32,
        );
        #[allow(clippy::cast_possible_truncation, reason = "at most a thousand")]
        let config = EncoderConfig::new()
            .rate_control_mode(RateControlMode::Bufferbased)
            .bitrate(BitRate::from_bps(bits))
            .qp(QpRange::new(BEST_QP, WORST_QP))
            .max_frame_rate(FrameRate::from_hz(per_second as f32))
            .intra_frame_period(IntraFramePeriod::from_num_frames(key_frames))
            .skip_frames(false)
            .scene_change_detect(false)
            .background_detection(false)
            .complexity(Complexity::High)
            .num_threads(1)
            .vui(VuiConfig::bt709());
        let failed = |message: String| Error::Encode { path: path.to_owned(), message };
        let encoder = Encoder::with_api_config(OpenH264API::from_source(), config)
            .map_err(|error| failed(error.to_string()))?;
        let brands = [*b"isom", *b"iso2", *b"avc1", *b"mp41"];
        let file = Mp4Config {
            major_brand: brands[0].into(),
            minor_version: 512,
            compatible_brands: brands.map(Into::into).to_vec(),
            timescale: TICKS * rate.0, // the track's: parts of a tick are lost with every frame
        };
        let writer = Mp4Writer::write_start(out, &file).map_err(|error| failed(error.to_string()))?;
        Ok(Self { path: path.to_owned(), size: (width, height), rate, encoder, writer, frames: 0 })
    }

    fn failed(&self, error: &impl fmt::Display) -> Error {
        Error::Encode { path: self.path.clone(), message: error.to_string() }
    }

    /// Adds a frame: luma, then both chroma planes.
    pub(super) fn push(&mut self, planes: &[u8]) -> Result<(), Error> {
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let (luma, chroma) = planes.split_at(width * height);
        let (cb, cr) = chroma.split_at(chroma.len() / 2);
        let frame = YUVSlices::new((luma, cb, cr), (width, height), (width, width / 2, width / 2));
        let (n, d) = (u64::from(self.rate.0), u64::from(self.rate.1));
        let time = Timestamp::from_millis(self.frames * d * 1000 / n);
        let coded = match self.encoder.encode_at(&frame, time) {
            Ok(coded) => Coded::of(&coded),
            Err(error) => return Err(self.failed(&error)),
        };
        if self.frames == 0 {
            self.begin_track(&coded)?;
        }
        let sample = Mp4Sample {
            start_time: self.frames * u64::from(TICKS) * d,
            duration: TICKS * self.rate.1,
            rendering_offset: 0,
            is_sync: coded.is_key,
            bytes: Bytes::from(coded.units),
        };
        self.writer.write_sample(TRACK, &sample).map_err(|error| self.failed(&error))?;
        self.frames += 1;
        Ok(())
    }

    /// The track can begin once the first frame has said how the stream is coded.
    fn begin_track(&mut self, first: &Coded) -> Result<(), Error> {
        let side = |pixels| u16::try_from(pixels).unwrap_or(u16::MAX);
        let track = TrackConfig {
            track_type: TrackType::Video,
            timescale: TICKS * self.rate.0,
            language: "und".to_owned(),
            media_conf: MediaConfig::AvcConfig(AvcConfig {
                width: side(self.size.0),
                height: side(self.size.1),
                seq_param_set: first.sequence.clone(),
                pic_param_set: first.picture.clone(),
            }),
        };
        self.writer.add_track(&track).map_err(|error| self.failed(&error))
    }

    /// Writes the tables.
    pub(super) fn finish(mut self) -> Result<BufWriter<Partial>, Error> {
        self.writer.write_end().map_err(|error| self.failed(&error))?;
        Ok(self.writer.into_writer())
    }
}

/// A coded frame, as MP4 holds it.
#[derive(Debug, Default)]
struct Coded {
    /// Its NAL units, each behind its length in four bytes.
    units: Vec<u8>,
    sequence: Vec<u8>,
    picture: Vec<u8>,
    is_key: bool,
}

impl Coded {
    fn of(stream: &openh264::encoder::EncodedBitStream<'_>) -> Self {
        let mut coded = Self { is_key: stream.frame_type() == FrameType::IDR, ..Self::default() };
        for layer in (0..stream.num_layers()).filter_map(|number| stream.layer(number)) {
            for unit in (0..layer.nal_count()).filter_map(|number| layer.nal_unit(number)) {
                coded.take(without_start_code(unit));
            }
        }
        coded
    }

    fn take(&mut self, unit: &[u8]) {
        match unit.first().map(|byte| byte & 31) {
            Some(SEQUENCE) => self.sequence = unit.to_vec(),
            Some(PICTURE) => self.picture = unit.to_vec(),
            _ => {
                let length = u32::try_from(unit.len()).unwrap_or(u32::MAX);
                self.units.extend(length.to_be_bytes());
                self.units.extend(unit);
            }
        }
    }
}

/// A NAL unit without the zeros and the one before it.
fn without_start_code(unit: &[u8]) -> &[u8] {
    let zeros = unit.iter().take_while(|byte| **byte == 0).count();
    unit.get(zeros + 1..).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use crate::export::video::Video;
    use crate::picture::Image;
    use openh264::decoder::Decoder;
    use openh264::formats::YUVSource as _;

    const SIZE: (u32, u32) = (162, 90);

    /// A disc that moves over a ground of two colours.
    fn scene(frame: u32) -> Image {
        let mut image = Image::filled(SIZE.0, SIZE.1, [206, 206, 202, 255]);
        image.fill(0, 0, SIZE.0, 40, [60, 110, 190, 255]);
        for y in 0..30_u32 {
            for x in 0..30_u32 {
                if x.abs_diff(15).pow(2) + y.abs_diff(15).pow(2) < 200 {
                    image.fill(10 + 4 * frame + x, 30 + y, 1, 1, [200, 60, 40, 255]);
                }
            }
        }
        image
    }

    /// 10 log10(255² / mean squared difference), dB.
    fn psnr(a: &[u8], b: &[u8]) -> f64 {
        let square = |(a, b): (&u8, &u8)| (f64::from(*a) - f64::from(*b)).powi(2);
        let mean = a.iter().zip(b).map(square).sum::<f64>() / a.len() as f64;
        10.0 * (255.0_f64.powi(2) / mean.max(1e-9)).log10()
    }

    fn rows(plane: &[u8], stride: usize, width: usize, height: usize) -> Vec<u8> {
        plane.chunks(stride).take(height).flat_map(|row| row[..width].to_vec()).collect()
    }

    #[test]
    fn an_mp4_shows_the_pictures_at_their_rate() {
        const FRAMES: u32 = 25;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("v.mp4");
        let mut video = Video::create(&path, SIZE.0, SIZE.1, 12.5).unwrap();
        let mut wanted = Vec::new();
        for frame in 0..FRAMES {
            let image = scene(frame);
            let mut planes = vec![0; (SIZE.0 * SIZE.1 * 3 / 2) as usize];
            crate::export::video::planes_from_image(&image, &mut planes);
            wanted.push(planes);
            video.push(&image).unwrap();
        }
        assert!(!path.exists());
        video.finish().unwrap();
        let bytes = std::fs::metadata(&path).unwrap().len();
        assert!((2000..200_000).contains(&bytes), "{bytes} bytes");

        let mut file = mp4::read_mp4(std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!(file.duration().as_millis(), 2000);
        let track = &file.tracks()[&1];
        assert_eq!((track.width(), track.height(), track.sample_count()), (162, 90, FRAMES));
        assert_eq!(track.box_type().unwrap(), mp4::FourCC::from(*b"avc1"));
        let clock = track.timescale();
        let mut stream = Vec::new();
        for unit in [track.sequence_parameter_set().unwrap(), track.picture_parameter_set().unwrap()] {
            stream.extend([0, 0, 0, 1]);
            stream.extend(unit);
        }
        let mut decoder = Decoder::new().unwrap();
        let mut seen = 0;
        for number in 1..=FRAMES {
            let sample = file.read_sample(1, number).unwrap().unwrap();
            assert_eq!(sample.is_sync, number == 1, "sample {number}");
            assert_eq!(
                (sample.duration * 25, sample.start_time * 25),
                (clock * 2, u64::from((number - 1) * clock * 2))
            );
            let mut rest = sample.bytes.as_ref();
            while let Some((length, more)) = rest.split_at_checked(4) {
                let length = u32::from_be_bytes(length.try_into().unwrap()) as usize;
                stream.extend([0, 0, 0, 1]);
                stream.extend(&more[..length]);
                rest = &more[length..];
            }
            if let Some(shown) = decoder.decode(&std::mem::take(&mut stream)).unwrap() {
                let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
                let (y, u, v) = shown.strides();
                let planes = [
                    rows(shown.y(), y, width, height),
                    rows(shown.u(), u, width / 2, height / 2),
                    rows(shown.v(), v, width / 2, height / 2),
                ];
                let found = psnr(&planes.concat(), &wanted[seen]);
                assert!(found > 36.0, "frame {seen}: {found} dB");
                seen += 1;
            }
        }
        assert!(seen + 1 >= FRAMES as usize, "{seen} frames");
    }

    #[test]
    fn players_can_jump_to_every_second_second() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("v.mp4");
        let mut video = Video::create(&path, 16, 16, 5.0).unwrap();
        for frame in 0..25 {
            video.push(&Image::filled(16, 16, [10 * frame, 90, 200, 255])).unwrap();
        }
        video.finish().unwrap();
        let mut file = mp4::read_mp4(std::fs::File::open(&path).unwrap()).unwrap();
        let keys: Vec<u32> =
            (1..=25).filter(|number| file.read_sample(1, *number).unwrap().unwrap().is_sync).collect();
        assert_eq!(keys, [1, 11, 21]);
    }

    #[test]
    fn a_video_is_as_long_as_its_frames_at_every_rate() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("v.mp4");
        for (rate, milliseconds) in [(30.0, 833), (29.97, 834), (60.0, 416), (12.0, 2083)] {
            let mut video = Video::create(&path, 16, 16, rate).unwrap();
            for _ in 0..25 {
                video.push(&Image::filled(16, 16, [90; 4])).unwrap();
            }
            video.finish().unwrap();
            let file = mp4::read_mp4(std::fs::File::open(&path).unwrap()).unwrap();
            let found = [file.duration(), file.tracks()[&1].duration()].map(|duration| duration.as_millis());
            assert_eq!(found, [milliseconds; 2], "25 frames at {rate} a second");
        }
    }

    #[test]
    fn what_the_encoder_cannot_take_is_refused_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        for (width, height) in [(8, 64), (4096, 64), (3840, 2162)] {
            let error = Video::create(&folder.path().join("v.mp4"), width, height, 30.0).unwrap_err();
            assert!(error.to_string().contains("16 to 3840 x 2160"), "{error}");
        }
        let mut video = Video::create(&folder.path().join("v.mp4"), 64, 64, 30.0).unwrap();
        video.push(&Image::filled(64, 64, [9; 4])).unwrap();
        drop(video);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

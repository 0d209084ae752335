//! One video per gait, as raters see them (S-03): a figure walks towards a camera in front of it, always the same one.
//!
//! Neither colours, surroundings nor names hint at the emotion. Stripes on the ground pass at the gait's speed. Drawing needs
//! no device. Names are numbers in a random order; a table beside the folder maps them to gaits.

use crate::Error;
use crate::cli::failed;
use crate::cli::figures::line;
use crate::cli::outputs::make_folder;
use crate::cli::progress::Progress;
use crate::export::video::Video;
use crate::file;
use crate::gait::{Gait, Joint, Pose};
use crate::perception::ratings::{self, KEY_HEAD};
use crate::picture::Image;
use crate::random::Random;
use crate::table::quoted;
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

const SIZE: (u32, u32) = (256, 384);
/// Frames per second.
const RATE: f64 = 30.0;
/// What the videos end in.
const ENDING: &str = if cfg!(feature = "video") { "mp4" } else { "y4m" };
/// Length, s.
const SECONDS: f32 = 4.0;
/// The camera stands here and looks along -z.
const CAMERA: Vec3 = Vec3::new(0.0, 1.1, 4.0);
/// Pixels of a metre at a metre's distance.
const FOCUS: f32 = 632.0;
/// Where the camera looks, pixels from the top left corner.
const CENTRE: Vec2 = Vec2::new(128.0, 176.0);
/// Between two stripes on the ground, m.
const STRIPES: f32 = 0.6;
const PAPER: [u8; 4] = [240, 240, 238, 255];
const GROUND: [u8; 4] = [206, 206, 202, 255];
/// Colours of the nearest and the farthest part of the body.
const BODY: [[f32; 3]; 2] = [[44.0, 48.0, 58.0], [122.0, 126.0, 136.0]];
/// Thickness of limbs and of the head, m.
const THICK: [f32; 2] = [0.07, 0.2];

/// The table that goes with a folder of videos: `DIR-key.csv`, beside it.
pub(super) fn key_of(folder: &Path) -> PathBuf {
    let mut name = folder.file_name().unwrap_or_default().to_owned();
    name.push("-key.csv");
    folder.with_file_name(name)
}

/// Makes a folder and writes a video of every gait into it, in an order drawn by `seed`, and the table beside it. Returns
/// the files, the table last.
pub(super) fn write(folder: &Path, gaits: &[Gait], seed: u64) -> Result<Vec<PathBuf>, Error> {
    make_folder(folder)?;
    let mut order: Vec<&Gait> = gaits.iter().collect();
    Random::new(seed).shuffle(&mut order);
    let digits = order.len().to_string().len().max(3);
    let mut progress = Progress::new("videos");
    let (mut files, mut table) = (Vec::with_capacity(order.len() + 1), format!("{KEY_HEAD}\n"));
    for (index, gait) in order.iter().enumerate() {
        let name = format!("clip-{:0digits$}", index + 1);
        #[allow(clippy::cast_precision_loss, reason = "a share")]
        progress.at(&name, index as f64 / order.len() as f64);
        let path = folder.join(&name).with_extension(ENDING);
        files.push(film(&path, gait).map_err(crate::export::Error::from)?);
        table += &format!("{name},{}\n", quoted(&gait.name));
    }
    let key = key_of(folder);
    file::write(&key, table.as_bytes())
        .map_err(|source| crate::export::Error::Write { path: key.clone(), source })?;
    files.push(key);
    Ok(files)
}

/// Which gait each video of a table shows.
pub(super) fn read_key(path: &Path) -> Result<HashMap<String, String>, Error> {
    ratings::read_key(path)
        .map_err(|error| failed(error.to_string(), "`gaitway gait show --videos` writes such a table"))
}

fn film(path: &Path, gait: &Gait) -> Result<PathBuf, crate::export::image::Error> {
    let mut video = Video::create(path, SIZE.0, SIZE.1, RATE)?;
    let mut time = 0.0;
    while time < SECONDS - 1e-3 {
        video.push(&picture(gait, time))?;
        time += 1.0 / 30.0;
    }
    video.finish()
}

/// Pixels of a point, and of a metre at its distance.
fn project(point: Vec3) -> (Vec2, f32) {
    let away = CAMERA - point;
    let metre = FOCUS / away.z.max(0.1);
    (CENTRE + Vec2::new(-away.x, away.y) * metre, metre)
}

/// The gait `time` seconds after the left foot struck.
fn picture(gait: &Gait, time: f32) -> Image {
    let mut image = Image::filled(SIZE.0, SIZE.1, PAPER);
    for stripe in -12_i16..=4 {
        // The walker walks towards the camera; on the spot, the ground goes away from it.
        let z = f32::from(stripe) * STRIPES - (gait.speed * time) % STRIPES;
        let (a, metre) = project(Vec3::new(-3.0, 0.0, z));
        let (b, _) = project(Vec3::new(3.0, 0.0, z));
        line(&mut image, [a, b], 0.02 * metre, GROUND);
    }
    let pose = pose_at(gait, time);
    let mut joints = Joint::ALL;
    // What is farther away first.
    let depth = |joint: Joint| pose[joint as usize].z + pose[Joint::PARENT[joint as usize]].z;
    joints.sort_by(|a, b| depth(*a).total_cmp(&depth(*b)));
    for joint in joints {
        let [from, to] = [Joint::PARENT[joint as usize], joint as usize].map(|index| project(pose[index]));
        let share = (0.5 - 0.5 * depth(joint) / 0.8).clamp(0.0, 1.0);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two bytes")]
        let [r, g, b] = std::array::from_fn(|c| (BODY[0][c] + (BODY[1][c] - BODY[0][c]) * share) as u8);
        line(&mut image, [from.0, to.0], THICK[0] * to.1, [r, g, b, 255]);
        if joint == Joint::Head {
            line(&mut image, [to.0, to.0], THICK[1] * to.1, [r, g, b, 255]);
        }
    }
    image
}

/// The pose at a time, between the frames.
fn pose_at(gait: &Gait, time: f32) -> Pose {
    let place = time * gait.frame_rate;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred frames")]
    let frame = place as usize;
    let [now, next] = [frame, frame + 1].map(|frame| gait.poses[frame % gait.poses.len()]);
    std::array::from_fn(|joint| now[joint].lerp(next[joint], place.fract()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emotion::Emotion;
    use crate::gait::walker::{Sex, person};

    #[test]
    fn a_walker_fills_the_picture_and_moves() {
        let gait = person(Emotion::Happy, Sex::Male, 1, 0).unwrap();
        let dark = |image: &Image| {
            let of = |y: u32| (0..SIZE.0).filter(|&x| image.pixel(x, y).is_some_and(|p| p[0] < 130)).count();
            (0..SIZE.1).map(of).collect::<Vec<_>>()
        };
        let [first, later] = [0.0, 0.25].map(|time| picture(&gait, time));
        let rows = dark(&first);
        let top = rows.iter().position(|&count| count > 3).unwrap();
        let bottom = rows.iter().rposition(|&count| count > 3).unwrap();
        assert!((20..120).contains(&top) && (330..384).contains(&bottom), "{top} to {bottom}");
        assert_ne!(first, later);
    }

    #[test]
    fn names_of_videos_tell_nothing_and_the_key_stands_outside() {
        let outside = tempfile::tempdir().unwrap();
        let folder = outside.path().join("videos");
        let named =
            |name: &str, emotion| Gait { name: name.into(), ..person(emotion, Sex::Male, 1, 0).unwrap() };
        let gaits = [
            named("angry/1", Emotion::Angry),
            named("sad, \"slow\"", Emotion::Sad),
            named("happy", Emotion::Happy),
        ];
        let files = write(&folder, &gaits, 3).unwrap();
        let names: Vec<_> = files.iter().map(|file| file.file_stem().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["clip-001", "clip-002", "clip-003", "videos-key"]);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 3, "no key among the videos");
        #[cfg(feature = "video")]
        for path in &files[..3] {
            let video = mp4::read_mp4(std::fs::File::open(path).unwrap()).unwrap();
            assert_eq!((video.duration().as_millis(), video.tracks()[&1].sample_count()), (4000, 120));
        }
        let key = read_key(&key_of(&folder)).unwrap();
        let mut shown: Vec<_> = key.values().map(String::as_str).collect();
        shown.sort_unstable();
        assert_eq!(shown, ["angry/1", "happy", "sad, \"slow\""]);
        let orders: std::collections::BTreeSet<_> = (0..9)
            .map(|seed| {
                write(&outside.path().join(format!("v{seed}")), &gaits[..2], seed).unwrap();
                read_key(&outside.path().join(format!("v{seed}-key.csv"))).unwrap()["clip-001"].clone()
            })
            .collect();
        assert_eq!(orders.len(), 2, "the order is drawn");
        std::fs::write(key_of(&folder), "clip-001\n").unwrap();
        assert!(read_key(&key_of(&folder)).unwrap_err().to_string().contains("first line"));
    }
}

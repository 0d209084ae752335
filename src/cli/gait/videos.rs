//! One video per gait, as raters see them (S-03): a figure walks towards a camera in front of it, always the same one.
//!
//! Neither colours nor surroundings tell anything; stripes on the ground pass at the gait's speed. Drawn without a device.

use crate::Error;
use crate::cli::figures::line;
use crate::cli::output::note;
use crate::cli::progress::Progress;
use crate::export::video::Video;
use crate::gait::{Gait, Joint, Pose};
use crate::picture::Image;
use glam::{Vec2, Vec3};
use std::path::{Path, PathBuf};

const SIZE: (u32, u32) = (256, 384);
/// Frames per second.
const RATE: f64 = 30.0;
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

/// Writes `NAME.mp4` (`NAME.y4m` without ffmpeg) for every gait into a folder, which is made; returns the files.
pub(super) fn write(folder: &Path, gaits: &[Gait]) -> Result<Vec<PathBuf>, Error> {
    let wrong = |source| crate::export::Error::Write { path: folder.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(wrong)?;
    let mut progress = Progress::new("videos");
    let mut files = Vec::with_capacity(gaits.len());
    for (index, gait) in gaits.iter().enumerate() {
        #[allow(clippy::cast_precision_loss, reason = "a share")]
        progress.at(&gait.name, index as f64 / gaits.len() as f64);
        files.push(film(folder, gait).map_err(crate::export::Error::from)?);
    }
    if files.iter().any(|file| file.extension().is_some_and(|ending| ending == "y4m")) {
        note("note: there is no ffmpeg in PATH, so the videos are uncompressed .y4m files");
    }
    Ok(files)
}

fn film(folder: &Path, gait: &Gait) -> Result<PathBuf, crate::export::image::Error> {
    let safe = |c: char| if c.is_alphanumeric() || "-_.# ".contains(c) { c } else { '_' };
    let name: String = gait.name.chars().map(safe).collect();
    let mut video = Video::create(&folder.join(format!("{name}.mp4")), SIZE.0, SIZE.1, RATE)?;
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
        let folder = tempfile::tempdir().unwrap();
        let files = write(folder.path(), &[Gait { name: "a/b".into(), ..gait }]).unwrap();
        assert!(files[0].file_stem().unwrap() == "a_b" && files[0].is_file());
    }
}

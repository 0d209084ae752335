//! One video per gait, as raters see them (S-03): [`crate::export::figure`]. Names are numbers in a random order; a table beside
//! the folder maps them to gaits.

use crate::Error;
use crate::cli::failed;
use crate::cli::outputs::make_folder;
use crate::cli::progress::Progress;
use crate::export::figure::{SIZE, picture};
use crate::export::video::Video;
use crate::file;
use crate::gait::Gait;
use crate::perception::ratings::{self, KEY_HEAD};
use crate::random::Random;
use crate::table::quoted;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Frames per second.
const RATE: f64 = 30.0;
/// What the videos end in.
const ENDING: &str = if cfg!(feature = "video") { "mp4" } else { "y4m" };
/// Length, s.
const SECONDS: f32 = 4.0;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emotion::Emotion;
    use crate::gait::walker::{Sex, person};

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

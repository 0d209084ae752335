//! What the subcommands share: gaits of a file, their table, a gait as CSV.

use super::super::output::{note, say, say_json, table};
use crate::Error;
use crate::emotion::Emotion;
use crate::export::AtomicFile;
use crate::gait::import::{Options, import_file_with};
use crate::gait::walker::Sex;
use crate::gait::{Gait, Joint, stride};
use clap::ValueEnum;
use serde::Serialize;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(super) enum SexName {
    #[default]
    Female,
    Male,
}

impl SexName {
    pub(super) const fn sex(self) -> Sex {
        match self {
            Self::Female => Sex::Female,
            Self::Male => Sex::Male,
        }
    }
}

/// A gait as it is listed.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    pub(super) name: String,
    pub(super) frames: usize,
    pub(super) rate_hz: f32,
    pub(super) cycle_time_s: f32,
    pub(super) v_des: f32,
    pub(super) stride_m: f32,
    pub(super) label: Option<&'static str>,
    pub(super) source: String,
}

#[derive(Debug, Serialize)]
struct Listing {
    gaits: Vec<Row>,
    files: Vec<PathBuf>,
    wall_seconds: f64,
}

impl Row {
    pub(super) fn of(gait: &Gait) -> Self {
        Self {
            name: gait.name.clone(),
            frames: gait.poses.len(),
            rate_hz: gait.frame_rate,
            cycle_time_s: gait.cycle_time(),
            v_des: gait.speed,
            stride_m: gait.stride_travel(),
            label: gait.label.map(Emotion::name),
            source: gait.provenance.to_string(),
        }
    }

    fn words(&self) -> Vec<String> {
        vec![
            self.name.clone(),
            self.frames.to_string(),
            format!("{:.1}", self.rate_hz),
            format!("{:.2}", self.cycle_time_s),
            format!("{:.2}", self.v_des),
            format!("{:.2}", self.stride_m),
            self.label.unwrap_or("-").to_owned(),
            self.source.chars().take(60).collect(),
        ]
    }
}

/// Prints gaits as a table.
pub(super) fn table_of_gaits(rows: &[Row]) {
    let words: Vec<Vec<String>> = rows.iter().map(Row::words).collect();
    table(&["name", "frames", "Hz", "cycle s", "m/s", "stride m", "label", "source"], &words);
}

pub(super) fn list(gaits: &[Gait], files: Vec<PathBuf>, begin: Instant, is_json: bool) -> Result<(), Error> {
    let rows = gaits.iter().map(Row::of).collect();
    let listing = Listing { gaits: rows, files, wall_seconds: begin.elapsed().as_secs_f64() };
    if is_json {
        return say_json(&listing);
    }
    table_of_gaits(&listing.gaits);
    for file in &listing.files {
        say(&format!("written    {}", file.display()));
    }
    say(&format!("wall time  {:.2} s", listing.wall_seconds));
    Ok(())
}

pub(super) fn is_glb(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb"))
}

/// All gaits of a motion file; what the importer inferred goes to standard error.
pub(super) fn strides(path: &Path) -> Result<Vec<Gait>, Error> {
    let mut gaits = Vec::new();
    for recording in import_file_with(path, &Options::default())? {
        for line in &recording.report {
            note(&format!("{}: {line}", recording.name));
        }
        gaits.extend(stride::extract(&recording)?);
    }
    Ok(gaits)
}

/// Strides of a gait written as CSV: enough to find strides in it again.
const CSV_STRIDES: u32 = 3;

/// Joint positions of a few strides over the ground, as `gaitway gait import` reads them.
pub(super) fn write_csv(gait: &Gait, path: &Path) -> Result<(), Error> {
    let wrong = |source| crate::export::Error::Write { path: path.to_owned(), source };
    let mut file = AtomicFile::create(path)?;
    let mut write = || -> std::io::Result<()> {
        // A comment ends with its line, and a name may have several.
        let origin = format!("{}: {}", gait.name, gait.provenance).replace(['\n', '\r'], " ");
        writeln!(file, "# {origin}; metres, y up, walks towards +z")?;
        write!(file, "time")?;
        for joint in Joint::ALL {
            let name = joint.name();
            write!(file, ",{name}_x,{name}_y,{name}_z")?;
        }
        writeln!(file)?;
        let frames = (0..CSV_STRIDES).flat_map(|_| &gait.poses);
        for (number, pose) in (0_u16..).zip(frames) {
            let time = f32::from(number) / gait.frame_rate;
            write!(file, "{time:.6}")?;
            for joint in pose {
                write!(file, ",{:.6},{:.6},{:.6}", joint.x, joint.y, joint.z + gait.speed * time)?;
            }
            writeln!(file)?;
        }
        Ok(())
    };
    write().map_err(wrong)?;
    Ok(file.finish()?)
}

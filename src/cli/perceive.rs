//! `gaitway perceive`: the emotions that a classifier sees in the crowd as drawn, against the wanted ones.

use super::failed;
use super::gait::{model_or_default, sources};
use super::output::{note, say, say_json, table, thousands};
use super::progress::Progress;
use super::scene::{PlaceArguments, SceneArguments, build, check_seconds, tell_place};
use crate::Error;
use crate::closed_loop::{HUMANS, MAX_TURN_DEG, Recorder, Score, Seen, Unusable, WALKING_SHARE};
use crate::closed_loop::{features, practice_alone, practice_in_crowd, record};
use crate::emotion::Emotion;
use crate::export::chart::{self, Matrix};
use crate::gait::Gait;
use crate::library::GaitLibrary;
use crate::perception::affective_svm::AffectiveSvm;
use crate::perception::features::{FEATURE_COUNT, Variant};
use crate::perception::model::{Model, Prediction, Preparation};
use crate::scenario::Condition;
use crate::scene::Scene;
use crate::sim::Simulation;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Seed of the walkers that `--train-on walker` learns from: not that of the built-in library.
const WALKER_SEED: u64 = 7001;
/// Individuals of each emotion and sex among them.
const WALKERS_PER_CLASS: u32 = 25;

/// Arguments of `gaitway perceive`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway perceive crossing --agents 1000 --condition eva-g\n  gaitway perceive garden --agents 200 \
                  --train-on egait/ --figures figures/\n  gaitway perceive crossing --agents 1000 --model default --model model.json --json\n\n\
                  The classifier sees the joints of the bodies as they are drawn, one stride of each agent, and nothing else. \
                  It learns from other walkers than the built-in gaits (seed 7001), or from labelled gaits of yours: as they were \
                  recorded, as the scene's avatars show them one by one, and as they are shown in a crowd of other people."
)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Time of the recording
    #[arg(long, default_value_t = 5.0)]
    seconds: f64,
    /// Simulated time before that
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0)]
    warm_up: f64,
    /// A trained classifier (gaitway gait train), or `default`: the built-in one, trained on people; may be given several
    /// times
    #[arg(long, value_name = "MODEL.json|default")]
    model: Vec<PathBuf>,
    /// What classifiers learn from: `walker`, or labelled motion files or a gait library; may be given several times
    /// [default: walker, unless there is a --model]
    #[arg(long, value_name = "walker|DIR|LIB.glb")]
    train_on: Vec<PathBuf>,
    /// How classifiers see the gaits that they learn from; may be given several times [default: all, one classifier each]
    #[arg(long, value_enum)]
    train_as: Vec<TrainAs>,
    /// Folder for figures (SVG and PNG)
    #[arg(long, visible_alias = "out", value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TrainAs {
    /// As they are in their files
    Recorded,
    /// As the scene's avatars show them, each walked alone and straight
    Alone,
    /// As they are shown in the scene by a crowd of other people (another seed)
    Crowd,
}

impl Arguments {
    /// Whether to list the scenes, and whether in JSON.
    pub(super) const fn lists(&self) -> (bool, bool) {
        (self.scene.list, self.json)
    }
}

/// What is printed.
#[derive(Debug, Serialize)]
struct Report {
    scene: String,
    condition: Condition,
    agents: u32,
    seed: u64,
    warm_up_seconds: f64,
    seconds: f64,
    /// Device of simulation, animation and features.
    device: String,
    /// Agents that are to show each emotion, in the order of [`Emotion::ALL`].
    wanted: [u64; 4],
    /// Agents of which a stride was judged.
    walking: u64,
    /// The others.
    not_walking: NotWalking,
    perceivers: Vec<Perceived>,
    /// The paper's raters, on the paper's own agents.
    humans: Score,
    files: Vec<PathBuf>,
    wall_seconds: f64,
}

/// Agents that were not judged, and why.
#[derive(Debug, Default, Serialize)]
struct NotWalking {
    all: u64,
    no_whole_stride: u64,
    slow: u64,
    turning: u64,
    /// By wanted emotion, in the order of [`Emotion::ALL`].
    by_emotion: [u64; 4],
}

/// What one classifier saw.
#[derive(Debug, Serialize)]
struct Perceived {
    name: String,
    /// Gaits it learned from, of each emotion.
    learned_from: [usize; 4],
    people: usize,
    settings: String,
    /// Where the features were computed.
    features: &'static str,
    /// Strides unlike those that it learned from; they are judged all the same.
    unlike: usize,
    #[serde(flatten)]
    score: Score,
}

/// A classifier and what to call it.
struct Judge {
    name: String,
    model: Model,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let seconds = check_seconds("--seconds", arguments.seconds)?;
    let warm_up = check_seconds("--warm-up", arguments.warm_up)?;
    let begin = Instant::now();
    // Joints that were not captured walk as the norm, which says nothing about the gait.
    let builder = arguments.scene.builder()?;
    builder.gaits()?.iter().try_for_each(Gait::check_whole)?;
    // a missing classifier is an error before the crowd is simulated
    let scene = build(builder, arguments.scene.library.as_deref())?;
    let (judges, is_complete) = judges(arguments, &scene)?;
    let (gaits, simulation, mut report) = watch(&scene, [warm_up, seconds])?;
    let seen: Vec<&Gait> = gaits.iter().collect();
    let on_device = features(&seen, &simulation)?;
    for judge in &judges {
        report.perceivers.push(judged(judge, &seen, &on_device));
    }
    if let Some(folder) = &arguments.figures {
        report.files = figures(folder, &report)?;
    }
    report.wall_seconds = begin.elapsed().as_secs_f64();
    if arguments.json {
        say_json(&report)?;
    } else {
        print(&report);
    }
    Ok(is_complete)
}

/// Simulates and records the crowd: one stride of every walking agent, labelled with its wanted emotion.
fn watch(scene: &Scene, [warm_up, seconds]: [f64; 2]) -> Result<(Vec<Gait>, Simulation, Report), Error> {
    let (mut simulation, _) = scene.start_with_bodies()?;
    tell_place(&simulation);
    let agents = simulation.agent_count();
    let how = Recorder::of(&scene.scenario, scene.steps(warm_up), scene.steps(seconds));
    let mut progress = Progress::new(format!("watching {} agents", thousands(u64::from(agents))));
    let tracks = record(&mut simulation, &scene.cast, &how, &mut |share| progress.at("", share))?;
    let (mut gaits, mut not_walking, mut wanted) = (Vec::new(), NotWalking::default(), [0; 4]);
    for track in &tracks {
        let emotion = track.wanted;
        wanted[emotion.index()] += 1;
        match track.stride() {
            Seen::Walk(gait) => gaits.push(Gait { label: Some(emotion), ..*gait }),
            Seen::Nothing(reason) => not_walking.count(reason, emotion),
        }
    }
    let report = Report {
        scene: scene.scenario.name.clone(),
        condition: scene.scenario.condition,
        agents,
        seed: scene.scenario.seed,
        warm_up_seconds: warm_up,
        seconds,
        device: simulation.device(),
        wanted,
        walking: gaits.len() as u64,
        not_walking,
        perceivers: Vec::new(),
        humans: Score::from_counts(HUMANS),
        files: Vec::new(),
        wall_seconds: 0.0,
    };
    Ok((gaits, simulation, report))
}

impl NotWalking {
    fn count(&mut self, reason: Unusable, wanted: Emotion) {
        self.all += 1;
        self.by_emotion[wanted.index()] += 1;
        *match reason {
            Unusable::NoWholeStride => &mut self.no_whole_stride,
            Unusable::Slow => &mut self.slow,
            Unusable::Turning => &mut self.turning,
        } += 1;
    }
}

/// The chosen classifiers, and whether every named file could be used.
fn judges(arguments: &Arguments, scene: &Scene) -> Result<(Vec<Judge>, bool), Error> {
    let (mut judges, mut is_complete) = (Vec::new(), true);
    for path in &arguments.model {
        let path = Some(path.as_path()).filter(|path| path.as_os_str() != "default");
        let (model, name) = model_or_default(path)?;
        if model.preparation() != Preparation::Repaired {
            return Err(failed(
                format!(
                    "--model {name}: it learned from gaits as published, and the crowd's are not like those"
                ),
                "train it without --as-published",
            ));
        }
        let name = if path.is_none() { "people (the built-in model)".to_owned() } else { name };
        judges.push(Judge { name, model });
    }
    let mut sources = arguments.train_on.clone();
    if sources.is_empty() && judges.is_empty() {
        sources.push("walker".into());
    }
    for source in &sources {
        let (name, gaits) = match source.to_str() {
            Some("walker") => {
                let walkers = GaitLibrary::generated(WALKER_SEED, WALKERS_PER_CLASS)?;
                (format!("other walkers (seed {WALKER_SEED})"), walkers.gaits().to_vec())
            }
            _ => {
                let found = sources::read(std::slice::from_ref(source), Preparation::Repaired)?;
                is_complete &= found.is_complete;
                (source.display().to_string(), found.gaits.into_iter().map(|(_, gait)| gait).collect())
            }
        };
        let (labelled, others): (Vec<Gait>, Vec<Gait>) =
            gaits.into_iter().partition(|gait| gait.label.is_some());
        if !others.is_empty() {
            note(&format!("note: {name}: {} gaits without a label are left out", others.len()));
        }
        let ways: &[TrainAs] = match arguments.train_as.as_slice() {
            [] => TrainAs::value_variants(),
            given => given,
        };
        for &way in ways {
            judges.push(match way {
                TrainAs::Recorded => trained(format!("{name}, as recorded"), &labelled)?,
                TrainAs::Alone | TrainAs::Crowd => {
                    shown(&name, &labelled, way, scene, &arguments.scene.place)?
                }
            });
        }
    }
    Ok((judges, is_complete))
}

/// Learns from gaits as the scene's avatars show them.
fn shown(
    name: &str,
    gaits: &[Gait],
    way: TrainAs,
    scene: &Scene,
    place: &PlaceArguments,
) -> Result<Judge, Error> {
    let avatars = scene.cast.avatars().to_vec();
    let words = if way == TrainAs::Alone { "alone" } else { "in a crowd" };
    let mut progress = Progress::new(format!("watching {name} {words}"));
    let mut at = |share| progress.at("", share);
    let practice = if way == TrainAs::Alone { practice_alone } else { practice_in_crowd };
    let seen = practice(gaits, avatars, &scene.scenario, place.get()?, &mut at)?;
    trained(format!("{name}, as shown {words}"), &seen)
}

fn trained(name: String, gaits: &[Gait]) -> Result<Judge, Error> {
    let (gaits, emotions): (Vec<&Gait>, Vec<Emotion>) =
        gaits.iter().filter_map(|gait| gait.label.map(|label| (gait, label))).unzip();
    if gaits.is_empty() {
        return Err(failed(
            format!("{name}: there is no gait with a label"),
            "labels come from a library or from a gaits.csv beside the motion files (columns key, subject, label)",
        ));
    }
    Ok(Judge { model: AffectiveSvm::default().model(&gaits, &emotions, 0)?, name })
}

/// Answers of a classifier. `on_device` holds the corrected features; classifiers with other input compute it here.
fn judged(judge: &Judge, gaits: &[&Gait], on_device: &[[f64; FEATURE_COUNT]]) -> Perceived {
    let is_on_device = judge.model.variant() == Some(Variant::Corrected);
    let predictions: Vec<Prediction> = match is_on_device {
        true => on_device.iter().filter_map(|row| judge.model.predict_features(row)).collect(),
        false => judge.model.predict_all(gaits),
    };
    let features = if is_on_device { "on the device" } else { "on the host (not the 29 corrected ones)" };
    let unlike = predictions.iter().filter(|prediction| prediction.is_unlike()).count();
    let answers = gaits
        .iter()
        .zip(&predictions)
        .filter_map(|(gait, prediction)| Some((gait.label?, prediction.emotion)));
    let on = judge.model.trained_on();
    Perceived {
        name: judge.name.clone(),
        learned_from: on.counts,
        people: on.people,
        settings: format!("{}, {}", judge.model.method(), on.settings),
        features,
        unlike,
        score: Score::of(answers),
    }
}

/// One figure for each classifier and one for the paper's people.
fn figures(folder: &Path, report: &Report) -> Result<Vec<PathBuf>, Error> {
    let labels = Emotion::ALL.map(|emotion| emotion.name().to_owned());
    let draw = |name: &str, title: &str, score: &Score| {
        let counts = score.confusion.map(Vec::from);
        chart::write(folder, name, &Matrix::confusion(title, ["wanted", "perceived"], &labels, &counts))
    };
    let mut files = Vec::new();
    for (number, seen) in (1..).zip(&report.perceivers) {
        files.extend(draw(
            &format!("perceived-{number}"),
            &format!("Perceived after {}", seen.name),
            &seen.score,
        )?);
    }
    files.extend(draw("perceived-by-people", "Perceived by the paper's people", &report.humans)?);
    Ok(files)
}

fn percent(share: f64) -> String {
    format!("{:.1}", share * 100.0)
}

fn print(report: &Report) {
    let Report { scene, agents, seed, device, not_walking, .. } = report;
    let condition = match report.condition {
        Condition::Baseline => "baseline",
        Condition::EvaO => "eva-o",
        Condition::EvaG => "eva-g",
    };
    say(&format!("scene        {scene}, {} agents, {condition}, seed {seed}", thousands(u64::from(*agents))));
    say(&format!("device       {device}"));
    say(&format!(
        "watched      {} s after {} s: one stride of each of {} agents",
        report.seconds, report.warm_up_seconds, report.walking
    ));
    say(&format!(
        "not walking  {}: {} below {:.0} % of their preferred speed, {} turning by more than {MAX_TURN_DEG} degrees, {} \
         without a whole stride",
        not_walking.all,
        not_walking.slow,
        WALKING_SHARE * 100.0,
        not_walking.turning,
        not_walking.no_whole_stride
    ));
    for seen in &report.perceivers {
        let from = Emotion::ALL.map(|emotion| format!("{emotion} {}", seen.learned_from[emotion.index()]));
        say("");
        say(&format!("classifier   learned from {}", seen.name));
        say(&format!("             {} of {} people; {}", from.join(", "), seen.people, seen.settings));
        if seen.unlike > 0 {
            let (unlike, all) = (seen.unlike, seen.score.n);
            say(&format!(
                "unlike       {unlike} of {all} strides are unlike what it has seen, and judged all the same"
            ));
        }
        print_score(&seen.score, Some(&report.humans));
    }
    let humans = &report.humans;
    say("");
    say(&format!(
        "people       of the paper saw {} % of {} (in the paper's own agents)",
        percent(humans.accuracy),
        humans.n
    ));
    for file in &report.files {
        say(&format!("written      {}", file.display()));
    }
    say(&format!("wall time    {:.2} s", report.wall_seconds));
}

/// Accuracy, and the matrix with the paper's beside it.
fn print_score(score: &Score, beside: Option<&Score>) {
    let range = |[low, high]: [f64; 2]| format!("{} to {}", percent(low), percent(high));
    say(&format!(
        "accuracy     {} % of {} (95 %: {})",
        percent(score.accuracy),
        score.n,
        range(score.interval)
    ));
    let mut head = vec!["wanted", "perceived happy", "angry", "sad", "neutral", "recall %", "95 %"];
    if beside.is_some() {
        head.extend(["| people: happy", "angry", "sad", "neutral"]);
    }
    let rows: Vec<Vec<String>> = Emotion::ALL
        .into_iter()
        .map(|emotion| {
            let i = emotion.index();
            let mut words = vec![emotion.name().to_owned()];
            words.extend(score.confusion[i].map(|count| count.to_string()));
            words.push(score.recall[i].map_or_else(|| "-".to_owned(), percent));
            words.push(range(score.recall_intervals[i]));
            if let Some(other) = beside {
                words.extend(other.confusion[i].map(|count| count.to_string()));
            }
            words
        })
        .collect();
    table(&head, &rows);
}

//! Trained models, and their file: versioned JSON.
//!
//! ```text
//! { "format": "gaitway-perception-model", "version": 2, "preparation": "repaired",
//!   "method": "phase-perceiver", "mean": [179], "deviation": [179], "emotions": [...], "planes": [[180], ...],
//!      (or "affective-svm", "features": "corrected", "scaling": { "low": [29], "high": [29] }, "svm": { ... })
//!   "novelty": { "mean": [], "directions": [[]], "variances": [], "rest": 1, "limit": 1 },
//!   "held_out": { "accuracy": 0.67, "folds": "...", "repeats": 5 }, "trained_on": { ... } }
//! ```
//! Version 1 (always `affective-svm`) lacks `preparation`, `novelty` and `held_out`; it is read as prepared like all other
//! gaits. A model that is saved and loaded answers with the same bits.
//!
//! One rule gives the emotion, whatever the method: the most probable one. The pairwise votes or decision values of
//! a support vector machine, which [`Method::train`](super::Method::train) of `affective-svm` answers by as in the paper,
//! can disagree with its calibrated probabilities; a model goes by the probabilities that it shows.

use super::novelty::Novelty;
use super::{Error, Perceiver, affective_svm, evaluate, most_probable, perceiver};
use crate::emotion::Emotion;
use crate::file;
use crate::gait::Gait;
use crate::perception::features::{FEATURE_COUNT, Variant};
use crate::perception::svm::Svm;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;

const FORMAT: &str = "gaitway-perception-model";
/// The version that is written; it and the one before are read.
pub const VERSION: u32 = 2;
/// Largest file read, bytes.
const MOST_BYTES: u64 = 256 << 20;
/// The default model, trained on people; `assets/models/README.md` is its card.
const BUILT_IN: &str = include_str!("../../assets/models/default.json");

/// How gaits are prepared before a model sees them. A model judges only gaits of its own preparation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preparation {
    /// As importers leave them: level, in metres, with travel and sides set right.
    #[default]
    Repaired,
    /// E-Gait's gaits as they were published ([`crate::gait::import::Options::as_published`]).
    AsPublished,
}

/// What a model learned from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrainedOn {
    /// Gaits of each emotion, in the order of [`Emotion::ALL`].
    pub counts: [usize; 4],
    /// Data sets.
    pub datasets: Vec<String>,
    /// Number of people.
    pub people: usize,
    /// Settings, in words.
    pub settings: String,
    /// Seed of the inner folds.
    pub seed: u64,
}

impl TrainedOn {
    pub(super) fn of(gaits: &[&Gait], emotions: &[Emotion], settings: String, seed: u64) -> Self {
        let datasets: BTreeSet<String> = gaits.iter().map(|gait| gait.provenance.dataset.clone()).collect();
        let people: BTreeSet<String> = gaits.iter().map(|gait| evaluate::person(gait)).collect();
        let counts = Emotion::ALL.map(|emotion| emotions.iter().filter(|&&other| other == emotion).count());
        Self { counts, datasets: datasets.into_iter().collect(), people: people.len(), settings, seed }
    }

    /// Words for a report, such as `232 gaits of 92 people (bml, cmu)`.
    pub fn describe(&self) -> String {
        let gaits: usize = self.counts.iter().sum();
        format!("{gaits} gaits of {} people ({})", self.people, self.datasets.join(", "))
    }
}

/// How often models like this one were right about training gaits that were held out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// Share of right answers, 0 to 1, mean over the repeats.
    pub accuracy: f64,
    /// What was held out together, in words.
    pub folds: String,
    /// Number of repeats.
    pub repeats: usize,
}

/// A trained model: predicts the emotion that people would see in a gait (S-17), and whether the gait is like those that it
/// learned from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Model {
    format: String,
    version: u32,
    #[serde(default)]
    preparation: Preparation,
    #[serde(flatten)]
    machine: Machine,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    novelty: Option<Novelty>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    held_out: Option<HeldOut>,
    trained_on: TrainedOn,
}

/// What was learned, by method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "method", rename_all = "kebab-case")]
pub(super) enum Machine {
    AffectiveSvm(affective_svm::Learned),
    PhasePerceiver(perceiver::Learned),
}

impl Machine {
    /// The numbers of a gait, scaled as novelty takes them.
    pub(super) fn point(&self, gait: &Gait) -> Vec<f64> {
        match self {
            Self::AffectiveSvm(learned) => learned.point(gait),
            Self::PhasePerceiver(learned) => learned.point(gait),
        }
    }

    /// Probability of each emotion at a point.
    fn probabilities(&self, point: &[f64]) -> [f64; 4] {
        match self {
            Self::AffectiveSvm(learned) => learned.probabilities(point),
            Self::PhasePerceiver(learned) => learned.probabilities(point),
        }
    }

    fn validate(&self) -> Result<(), String> {
        match self {
            Self::AffectiveSvm(learned) => learned.validate(),
            Self::PhasePerceiver(learned) => learned.validate(),
        }
    }

    const fn point_length(&self) -> usize {
        match self {
            Self::AffectiveSvm(_) => FEATURE_COUNT,
            Self::PhasePerceiver(_) => perceiver::DESCRIPTOR_LENGTH,
        }
    }
}

/// What a model sees in a gait.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Prediction {
    /// The most probable emotion; of equal ones the first. Not to be relied on where [`Prediction::is_unlike`].
    pub emotion: Emotion,
    /// Probability of each emotion, in the order of [`Emotion::ALL`].
    pub probabilities: [f64; 4],
    /// How much more probable it is than the next one, 0 to 1.
    pub margin: f64,
    /// Distance of the gait to those that the model learned from; above 1 it is farther from them than they are from one
    /// another (99 % of them, people apart). None if the model does not know (version 1).
    pub novelty: Option<f64>,
}

impl Prediction {
    fn of(probabilities: [f64; 4], novelty: Option<f64>) -> Self {
        let emotion = most_probable(probabilities);
        let next = Emotion::ALL.into_iter().filter(|other| *other != emotion);
        let next = next.map(|other| probabilities[other.index()]).fold(0.0, f64::max);
        Self { emotion, probabilities, margin: probabilities[emotion.index()] - next, novelty }
    }

    /// Whether the gait is unlike those that the model learned from.
    pub fn is_unlike(&self) -> bool {
        self.novelty.is_some_and(|novelty| novelty > 1.0)
    }
}

impl Model {
    /// A model that does not know what is unlike its training gaits.
    pub(super) fn new(machine: Machine, trained_on: TrainedOn) -> Self {
        let (format, preparation) = (FORMAT.to_owned(), Preparation::default());
        Self { format, version: VERSION, preparation, machine, novelty: None, held_out: None, trained_on }
    }

    /// The same model, which knows what is unlike its training gaits.
    pub(super) fn with_novelty(mut self, gaits: &[&Gait], emotions: &[Emotion]) -> Self {
        let points: Vec<Vec<f64>> = gaits.par_iter().map(|gait| self.machine.point(gait)).collect();
        let folds = evaluate::inner_folds(gaits, emotions, evaluate::NOVELTY_FOLDS, self.trained_on.seed);
        self.novelty = Novelty::fit(&points, &folds);
        self
    }

    /// The model that ships: `phase-perceiver`, trained on the people of E-Gait.
    ///
    /// # Errors
    /// [`Error::Model`] if the file in the program is damaged.
    pub fn built_in() -> Result<Self, Error> {
        Self::from_json(BUILT_IN, "the built-in model")
    }

    /// The same model with what is known of it besides.
    #[must_use]
    pub fn with(self, preparation: Preparation, held_out: Option<HeldOut>) -> Self {
        Self { preparation, held_out, ..self }
    }

    /// Name of the method.
    pub const fn method(&self) -> &'static str {
        match self.machine {
            Machine::AffectiveSvm(_) => affective_svm::NAME,
            Machine::PhasePerceiver(_) => perceiver::NAME,
        }
    }

    /// What it learned from.
    pub const fn trained_on(&self) -> &TrainedOn {
        &self.trained_on
    }

    /// How the gaits that it learned from were prepared.
    pub const fn preparation(&self) -> Preparation {
        self.preparation
    }

    /// How well models like it did on people held out, if that was found.
    pub const fn held_out(&self) -> Option<&HeldOut> {
        self.held_out.as_ref()
    }

    /// Whether it knows what is unlike the gaits that it learned from.
    pub const fn knows_novelty(&self) -> bool {
        self.novelty.is_some()
    }

    /// Which reading of the 29 features it looks at, if it looks at these alone.
    pub const fn variant(&self) -> Option<Variant> {
        match &self.machine {
            Machine::AffectiveSvm(learned) => Some(learned.variant()),
            Machine::PhasePerceiver(_) => None,
        }
    }

    /// The support vector machine, if there is one.
    pub const fn svm(&self) -> Option<&Svm> {
        match &self.machine {
            Machine::AffectiveSvm(learned) => Some(learned.svm()),
            Machine::PhasePerceiver(_) => None,
        }
    }

    /// Words for a report: method, what it learned from, how well that went.
    pub fn describe(&self) -> String {
        let mut words = format!("{}, trained on {}", self.method(), self.trained_on.describe());
        if self.preparation == Preparation::AsPublished {
            words += " as published";
        }
        if let Some(HeldOut { accuracy, folds, .. }) = &self.held_out {
            words += &format!("; {:.1} % right on gaits held out ({folds})", accuracy * 100.0);
        }
        words
    }

    /// What it sees in a gait.
    pub fn predict(&self, gait: &Gait) -> Prediction {
        self.at(&self.machine.point(gait))
    }

    /// What it sees in many gaits, on all threads.
    pub fn predict_all(&self, gaits: &[&Gait]) -> Vec<Prediction> {
        gaits.par_iter().map(|gait| self.predict(gait)).collect()
    }

    /// What it sees in a gait with these features, not yet scaled; they must be of its [`Model::variant`]. None if it
    /// looks at more than these.
    pub fn predict_features(&self, features: &[f64; FEATURE_COUNT]) -> Option<Prediction> {
        match &self.machine {
            Machine::AffectiveSvm(learned) => Some(self.at(&learned.scaled(features))),
            Machine::PhasePerceiver(_) => None,
        }
    }

    fn at(&self, point: &[f64]) -> Prediction {
        let novelty = self.novelty.as_ref().map(|novelty| novelty.of(point));
        // a number that is none says nothing: the middle of the training gaits
        let finite: Vec<f64> = point.iter().map(|v| if v.is_finite() { *v } else { 0.0 }).collect();
        Prediction::of(self.machine.probabilities(&finite), novelty)
    }

    /// Text of the file.
    ///
    /// # Errors
    /// [`Error::Model`] if a number is not finite.
    pub fn to_json(&self) -> Result<String, Error> {
        serde_json::to_string(self)
            .map_err(|error| Error::Model { file: String::new(), message: error.to_string() })
    }

    /// The model of a text; `file` names it in errors.
    ///
    /// # Errors
    /// [`Error::Model`] if the text is not a model, is of another version, or is damaged.
    pub fn from_json(text: &str, file: &str) -> Result<Self, Error> {
        let wrong = |message: String| Error::Model { file: file.to_owned(), message };
        // The header first: another version may have other fields.
        #[derive(Deserialize)]
        struct Header {
            format: Option<String>,
            version: Option<u32>,
            method: Option<String>,
        }
        let header: Header =
            serde_json::from_str(text).map_err(|error| wrong(format!("not a model in JSON: {error}")))?;
        if header.format.as_deref() != Some(FORMAT) {
            return Err(wrong(format!(
                "format is {:?}, not {FORMAT:?}; write a model with `gaitway gait train`",
                header.format.unwrap_or_default()
            )));
        }
        if !header.version.is_some_and(|version| (1..=VERSION).contains(&version)) {
            let found = header.version.map_or_else(|| "no version".to_owned(), |v| format!("version {v}"));
            return Err(wrong(format!("{found}; this program reads versions 1 to {VERSION}")));
        }
        let known = [affective_svm::NAME, perceiver::NAME];
        if !header.method.as_deref().is_some_and(|method| known.contains(&method)) {
            let found = header.method.unwrap_or_default();
            return Err(wrong(format!(
                "a model of method {found:?}; this program has {}",
                known.join(" and ")
            )));
        }
        let mut model: Self = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
        model.version = VERSION;
        model.machine.validate().map_err(wrong)?;
        if let Some(novelty) = &model.novelty {
            novelty.validate(model.machine.point_length()).map_err(wrong)?;
        }
        Ok(model)
    }

    /// Reads a model.
    ///
    /// # Errors
    /// [`Error::Read`], and as [`Model::from_json`].
    pub fn load(path: &Path) -> Result<Self, Error> {
        let failed = |source| Error::Read { path: path.to_owned(), source };
        Self::from_json(&file::read_text(path, MOST_BYTES).map_err(failed)?, &path.display().to_string())
    }

    /// Writes the model: to a neighbour of `path` first, renamed when complete.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        let failed = |source| Error::Write { path: path.to_owned(), source };
        file::write(path, (self.to_json()? + "\n").as_bytes()).map_err(failed)
    }
}

impl Perceiver for Model {
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        self.predict(gait).probabilities
    }
}

//! A trained `affective-svm`, and its file: versioned JSON.
//!
//! ```text
//! { "format": "gaitway-perception-model", "version": 1, "method": "affective-svm",
//!   "features": "corrected", "scaling": { "low": [29], "high": [29] }, "svm": { ... }, "trained_on": { ... } }
//! ```
//! A model that is saved and loaded answers with the same bits.

use super::affective_svm::NAME;
use super::features::{FEATURE_COUNT, Variant, features};
use super::scaling::Scaling;
use super::svm::Svm;
use super::{Error, Perceiver, evaluate, most_probable};
use crate::emotion::Emotion;
use crate::file;
use crate::gait::Gait;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;

const FORMAT: &str = "gaitway-perception-model";
/// The version that is written, and the only one that is read.
pub const VERSION: u32 = 1;
/// Largest file read, bytes.
const MOST_BYTES: u64 = 256 << 20;

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
        let datasets: BTreeSet<String> = gaits.iter().map(|gait| evaluate::dataset(gait)).collect();
        let people: BTreeSet<String> = gaits.iter().map(|gait| evaluate::subject(gait)).collect();
        let counts = Emotion::ALL.map(|emotion| emotions.iter().filter(|&&other| other == emotion).count());
        Self { counts, datasets: datasets.into_iter().collect(), people: people.len(), settings, seed }
    }
}

/// A trained `affective-svm`: tells the emotion that people would see in a gait (S-17).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Model {
    format: String,
    version: u32,
    method: String,
    features: Variant,
    scaling: Scaling,
    svm: Svm,
    trained_on: TrainedOn,
}

/// What a model sees in a gait.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Prediction {
    /// The emotion.
    pub emotion: Emotion,
    /// Probability of each emotion, in the order of [`Emotion::ALL`].
    pub probabilities: [f64; 4],
    /// Distance to the nearest other emotion as a decision value (see [`super::svm::Verdict::margin`]); small or negative
    /// is doubtful.
    pub margin: f64,
}

impl Model {
    pub(super) fn new(features: Variant, scaling: Scaling, svm: Svm, trained_on: TrainedOn) -> Self {
        let (format, method) = (FORMAT.to_owned(), NAME.to_owned());
        Self { format, version: VERSION, method, features, scaling, svm, trained_on }
    }

    /// What it learned from.
    pub fn trained_on(&self) -> &TrainedOn {
        &self.trained_on
    }

    /// Which features it looks at.
    pub fn variant(&self) -> Variant {
        self.features
    }

    /// The machine.
    pub fn svm(&self) -> &Svm {
        &self.svm
    }

    /// The features of a gait, scaled as the machine takes them.
    pub fn point(&self, gait: &Gait) -> Vec<f64> {
        self.scaling.apply(&features(gait, self.features))
    }

    /// What it sees in a gait.
    pub fn predict(&self, gait: &Gait) -> Prediction {
        self.predict_features(&features(gait, self.features))
    }

    /// What it sees in many gaits, on all threads.
    pub fn predict_all(&self, gaits: &[&Gait]) -> Vec<Prediction> {
        gaits.par_iter().map(|gait| self.predict(gait)).collect()
    }

    /// What it sees in a gait with these features, not yet scaled; they must be of its [`Model::variant`].
    pub fn predict_features(&self, features: &[f64; FEATURE_COUNT]) -> Prediction {
        let point = self.scaling.apply(features);
        let decisions = self.svm.decisions(&point);
        let verdict = self.svm.verdict_of(&decisions);
        let emotion = Emotion::ALL[verdict.class.min(3)];
        let mut probabilities = [0.0; 4];
        match self.svm.probabilities_of(&decisions) {
            Some(found) => {
                for (&class, p) in self.svm.classes().iter().zip(found) {
                    probabilities[class.min(3)] = p;
                }
            }
            None => probabilities[emotion.index()] = 1.0,
        }
        Prediction { emotion, probabilities, margin: verdict.margin }
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
        // The version first: another version may have other fields.
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
        if header.version != Some(VERSION) {
            let found = header.version.map_or_else(|| "no version".to_owned(), |v| format!("version {v}"));
            return Err(wrong(format!("{found}; this program reads version {VERSION}")));
        }
        if header.method.as_deref() != Some(NAME) {
            let found = header.method.unwrap_or_default();
            return Err(wrong(format!("a model of method {found:?}; expected {NAME:?}")));
        }
        let model: Self = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
        model.scaling.validate(FEATURE_COUNT).map_err(wrong)?;
        model.svm.validate().map_err(wrong)?;
        if ![0, FEATURE_COUNT].contains(&model.svm.feature_count()) {
            let found = model.svm.feature_count();
            return Err(wrong(format!("support vectors of {found} numbers; expected {FEATURE_COUNT}")));
        }
        if let Some(class) = model.svm.classes().iter().find(|&&class| class >= Emotion::ALL.len()) {
            return Err(wrong(format!("class {class}; the emotions are 0 to {}", Emotion::ALL.len() - 1)));
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

    /// By the votes of the machine, as in the paper; the most probable emotion need not be the same.
    fn emotion(&self, gait: &Gait) -> Emotion {
        let prediction = self.predict(gait);
        // a gait whose features are not numbers has no verdict
        if prediction.margin.is_nan() { most_probable(prediction.probabilities) } else { prediction.emotion }
    }
}

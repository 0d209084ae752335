//! `affective-svm`: the paper's own method, the 29 features into a support vector machine (S-11 to S-15, A-20).

use super::features::{FEATURE_COUNT, Variant, features, features_of};
use super::model::{Machine, Model, TrainedOn};
use super::scaling::Scaling;
use super::svm::{Gamma, Grid, Kernel, Scheme, Settings, Svm, search};
use super::{Error, Method, Perceiver, evaluate};
use crate::emotion::Emotion;
use crate::gait::Gait;
use serde::{Deserialize, Serialize};

/// Name in tables and on the command line.
pub const NAME: &str = "affective-svm";
/// Folds of the search for C and gamma.
const INNER_FOLDS: usize = 5;

/// The method and its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct AffectiveSvm {
    /// Which reading of the features.
    pub variant: Variant,
    /// C, kernel and scheme.
    pub settings: Settings,
    /// C and gamma are searched on inner folds of the training gaits (5, no person in two of them where there are enough
    /// people) instead of taken from the settings.
    pub grid: Option<Grid>,
    /// Ranges of the features where they are not to be fitted on the training gaits: those of the whole data set are what
    /// the paper did, see [`AffectiveSvm::with_global_scaling`].
    pub scaling: Option<Scaling>,
}

impl Default for AffectiveSvm {
    /// Corrected features, one-versus-rest, C = 1, gamma `scale`, with probabilities, no search: of the readings with
    /// C = 1 the most accurate one on E-Gait with people held out, so that what is compared with the paper's
    /// method is compared with it at its best.
    fn default() -> Self {
        let settings = Settings {
            scheme: Scheme::OneVersusRest,
            kernel: Kernel::Rbf(Gamma::Scale),
            has_probabilities: true,
            ..Settings::default()
        };
        Self { variant: Variant::Corrected, settings, grid: None, scaling: None }
    }
}

impl AffectiveSvm {
    /// The settings that reports name, each with the words for it: both schemes, C = 1 with gamma `auto` and `scale`
    /// and the search.
    pub fn presets() -> Vec<(String, Self)> {
        let mut presets = Vec::new();
        for scheme in [Scheme::OneVersusOne, Scheme::OneVersusRest] {
            for gamma in [Gamma::Auto, Gamma::Scale] {
                let kernel = Kernel::Rbf(gamma);
                let settings = Settings { scheme, kernel, ..Settings::default() };
                presets.push((settings.describe(), Self { settings, ..Self::default() }));
            }
        }
        let settings = Settings::default();
        let searched = Self { settings, grid: Some(Grid::default()), ..Self::default() };
        presets.push(("ovo, C and gamma searched on inner folds".to_owned(), searched));
        presets
    }

    /// With the features scaled by the ranges of all these gaits, whichever of them are held out later: the paper's way,
    /// in which the held-out gaits have a say.
    #[must_use]
    pub fn with_global_scaling(self, gaits: &[&Gait]) -> Self {
        let points = features_of(gaits, self.variant);
        Self { scaling: Some(Scaling::fit(points.iter().map(<[f64; FEATURE_COUNT]>::as_slice))), ..self }
    }

    /// Words for a report.
    pub fn describe(&self) -> String {
        let settings = match self.grid {
            None => self.settings.describe(),
            Some(_) => format!("{}, C and gamma searched", self.settings.describe()),
        };
        let scaling = if self.scaling.is_some() { "global scaling" } else { "scaled on training folds" };
        format!("{} features, {settings}, {scaling}", self.variant.name())
    }

    /// Trains a model that can be saved and recognises gaits unlike its training gaits. It answers with the most probable
    /// emotion, which the votes of [`Method::train`] may contradict (see [`Model`]).
    ///
    /// # Errors
    /// [`Error::Training`] if a gait has features that are not finite, or there are fewer than two emotions.
    pub fn model(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Model, Error> {
        Ok(self.bare(gaits, emotions, seed)?.with_novelty(gaits, emotions))
    }

    /// [`AffectiveSvm::model`] without novelty.
    pub(super) fn bare(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Model, Error> {
        let (learned, settings) = self.learn(gaits, emotions, seed)?;
        let trained_on = TrainedOn::of(gaits, emotions, settings.describe(), seed);
        Ok(Model::new(Machine::AffectiveSvm(learned), trained_on))
    }

    /// What is learned, and the settings that were searched or given.
    fn learn(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<(Learned, Settings), Error> {
        let failed = |message| Error::Training { method: NAME, message };
        let raw = features_of(gaits, self.variant);
        if let Some(i) = raw.iter().position(|row| !row.iter().all(|value| value.is_finite())) {
            return Err(failed(format!(
                "gait {:?} ({} frames at {} Hz) has features that are not finite; leave it out",
                gaits[i].name,
                gaits[i].poses.len(),
                gaits[i].frame_rate
            )));
        }
        let scaling = match &self.scaling {
            Some(scaling) => scaling.clone(),
            None => Scaling::fit(raw.iter().map(<[f64; FEATURE_COUNT]>::as_slice)),
        };
        let points: Vec<Vec<f64>> = raw.iter().map(|row| scaling.apply(row)).collect();
        let classes: Vec<usize> = emotions.iter().map(|emotion| emotion.index()).collect();
        let settings = match &self.grid {
            None => self.settings.clone(),
            Some(grid) => {
                let folds = inner_folds(gaits, &classes, seed);
                search(&points, &classes, &folds, &self.settings, grid)
                    .map_err(|why| failed(why.into()))?
                    .settings
            }
        };
        let svm = Svm::train(&points, &classes, &settings).map_err(|why| failed(why.into()))?;
        Ok((Learned { features: self.variant, scaling, svm }, settings))
    }
}

/// Folds of the training gaits: by person, or where there are too few people, stratified.
fn inner_folds(gaits: &[&Gait], classes: &[usize], seed: u64) -> Vec<usize> {
    let emotions: Vec<Emotion> = classes.iter().map(|&class| Emotion::ALL[class]).collect();
    let grouping = evaluate::Grouping::Subject { folds: INNER_FOLDS };
    evaluate::folds(gaits, &emotions, grouping, seed)
        .unwrap_or_else(|_few_people| evaluate::stratified(classes, INNER_FOLDS, seed))
}

/// What was learned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Learned {
    features: Variant,
    scaling: Scaling,
    svm: Svm,
}

impl Learned {
    pub(super) const fn variant(&self) -> Variant {
        self.features
    }

    pub(super) const fn svm(&self) -> &Svm {
        &self.svm
    }

    /// The features of a gait, scaled as the machine takes them.
    pub(super) fn point(&self, gait: &Gait) -> Vec<f64> {
        self.scaled(&features(gait, self.features))
    }

    /// Features scaled as the machine takes them.
    pub(super) fn scaled(&self, features: &[f64; FEATURE_COUNT]) -> Vec<f64> {
        self.scaling.apply(features)
    }

    /// Calibrated probabilities; of a machine that was trained without, all is on its decision.
    pub(super) fn probabilities(&self, point: &[f64]) -> [f64; 4] {
        let decisions = self.svm.decisions(point);
        match self.svm.probabilities_of(&decisions) {
            None => self.decision(point).weights().map(f64::from),
            Some(found) => {
                let mut probabilities = [0.0; 4];
                for (&class, p) in self.svm.classes().iter().zip(found) {
                    probabilities[class.min(3)] = p;
                }
                probabilities
            }
        }
    }

    /// The emotion that the machine decides for: by votes or by the largest decision value, as in the paper.
    fn decision(&self, point: &[f64]) -> Emotion {
        Emotion::ALL[self.svm.predict(point).min(3)]
    }

    pub(super) fn validate(&self) -> Result<(), String> {
        self.scaling.validate(FEATURE_COUNT)?;
        self.svm.validate()?;
        let found = self.svm.feature_count();
        if ![0, FEATURE_COUNT].contains(&found) {
            return Err(format!("support vectors of {found} numbers; expected {FEATURE_COUNT}"));
        }
        match self.svm.classes().iter().find(|&&class| class >= Emotion::ALL.len()) {
            Some(class) => Err(format!("class {class}; the emotions are 0 to {}", Emotion::ALL.len() - 1)),
            None => Ok(()),
        }
    }
}

/// The machine as the paper asks it: it decides, and gives no probabilities.
struct Decided(Learned);

impl Perceiver for Decided {
    /// 1 for the emotion decided for.
    fn probabilities(&self, gait: &Gait) -> [f64; 4] {
        self.0.decision(&self.0.point(gait)).weights().map(f64::from)
    }
}

impl Method for AffectiveSvm {
    fn name(&self) -> &'static str {
        NAME
    }

    /// Answers by the decision of the machine, as in the paper, whose accuracies are of decisions.
    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Box<dyn Perceiver>, Error> {
        let settings = Settings { has_probabilities: false, ..self.settings.clone() };
        let method = Self { settings, ..self.clone() };
        Ok(Box::new(Decided(method.learn(gaits, emotions, seed)?.0)))
    }
}

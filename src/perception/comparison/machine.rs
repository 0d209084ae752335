//! Numbers of a gait into an RBF support vector machine, as both methods of Crenn and others need it.

use super::of_classes;
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::perception::evaluate::{Grouping, folds, stratified};
use crate::perception::scaling::Scaling;
use crate::perception::svm::{Grid, Settings, Svm, search};
use crate::perception::{Error, most_probable};

/// Folds of the search for C and gamma.
const INNER_FOLDS: usize = 5;

/// Scaling to [-1, 1] and a support vector machine, both of the training gaits.
#[derive(Debug)]
pub(super) struct Machine {
    scaling: Scaling,
    svm: Svm,
}

impl Machine {
    /// Trains with these settings, or with the best C and gamma of a grid on inner folds (no person in two of them, where
    /// there are people enough).
    pub(super) fn train(
        raw: &[Vec<f64>],
        gaits: &[&Gait],
        emotions: &[Emotion],
        settings: &Settings,
        grid: Option<(&Grid, u64)>,
    ) -> Result<Self, String> {
        let scaling = Scaling::fit(raw.iter().map(Vec::as_slice));
        let points: Vec<Vec<f64>> = raw.iter().map(|numbers| scaling.apply(numbers)).collect();
        let classes: Vec<usize> = emotions.iter().map(|emotion| emotion.index()).collect();
        let settings = match grid {
            None => settings.clone(),
            Some((grid, seed)) => {
                let inner = folds(gaits, emotions, Grouping::Subject { folds: INNER_FOLDS }, seed)
                    .unwrap_or_else(|_few_people| stratified(&classes, INNER_FOLDS, seed));
                search(&points, &classes, &inner, settings, grid)?.settings
            }
        };
        Ok(Self { svm: Svm::train(&points, &classes, &settings)?, scaling })
    }

    /// Probabilities of the emotions; a number that is not finite counts as the middle of its range.
    pub(super) fn probabilities(&self, raw: &[f64]) -> [f64; 4] {
        let point = self.point(raw);
        of_classes(self.svm.classes(), self.svm.probabilities(&point), self.svm.predict(&point))
    }

    /// The emotion by the machine's votes, which need not be the most probable one.
    pub(super) fn emotion(&self, raw: &[f64]) -> Emotion {
        let class = self.svm.predict(&self.point(raw));
        Emotion::ALL.get(class).copied().unwrap_or_else(|| most_probable(self.probabilities(raw)))
    }

    fn point(&self, raw: &[f64]) -> Vec<f64> {
        self.scaling.apply(raw).iter().map(|v| if v.is_finite() { *v } else { 0.0 }).collect()
    }
}

/// `Error::Training` of a method.
pub(super) fn failed(method: &'static str) -> impl Fn(String) -> Error {
    move |message| Error::Training { method, message }
}

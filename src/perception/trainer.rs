//! The methods whose models can be saved.

use super::affective_svm::AffectiveSvm;
use super::model::Model;
use super::perceiver::PhasePerceiver;
use super::{Error, Method, Perceiver};
use crate::emotion::Emotion;
use crate::gait::Gait;

/// A method and its settings, for models that are saved.
///
/// As a [`Method`] it answers as its models do, by the most probable emotion: how often it is right about gaits held out is
/// how often a saved model is right about gaits that it has not seen.
#[derive(Debug, Clone)]
pub enum Trainer {
    /// The paper's: [`AffectiveSvm`].
    AffectiveSvm(AffectiveSvm),
    /// Ours: [`PhasePerceiver`].
    PhasePerceiver(PhasePerceiver),
}

impl Trainer {
    /// Words for a report.
    pub fn describe(&self) -> String {
        match self {
            Self::AffectiveSvm(method) => method.describe(),
            Self::PhasePerceiver(method) => method.describe(),
        }
    }

    /// Trains a model.
    ///
    /// # Errors
    /// [`Error::Training`] if there is nothing to learn from.
    pub fn model(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Model, Error> {
        match self {
            Self::AffectiveSvm(method) => method.model(gaits, emotions, seed),
            Self::PhasePerceiver(method) => method.model(gaits, emotions, seed),
        }
    }
}

impl Method for Trainer {
    fn name(&self) -> &'static str {
        match self {
            Self::AffectiveSvm(method) => method.name(),
            Self::PhasePerceiver(method) => method.name(),
        }
    }

    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Box<dyn Perceiver>, Error> {
        match self {
            Self::AffectiveSvm(method) => Ok(Box::new(method.bare(gaits, emotions, seed)?)),
            Self::PhasePerceiver(method) => method.train(gaits, emotions, seed),
        }
    }
}

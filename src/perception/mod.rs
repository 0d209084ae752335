//! What people see in a gait: ratings and labels, features, classifiers, and how well they agree with people.
//!
//! A [`Method`] learns from labelled gaits and yields a [`Perceiver`], which predicts the emotion of any gait. The
//! paper's own method, the five that it is compared with and ours are all [`Method`]s, so they are evaluated on
//! the same folds. Paper: sections 3.2 to 3.5; S-05 to S-17.
//!
//! ```
//! use gaitway::gait::Gait;
//! use gaitway::perception::Method as _;
//! use gaitway::perception::affective_svm::AffectiveSvm;
//! use gaitway::perception::model::Model;
//! use gaitway::{Emotion, GaitLibrary};
//!
//! # fn main() -> gaitway::Result<()> {
//! let library = GaitLibrary::built_in()?;
//! let labelled = library.gaits().iter().filter_map(|gait| Some((gait, gait.label?)));
//! let (gaits, labels): (Vec<&Gait>, Vec<Emotion>) = labelled.unzip();
//! let people = Model::built_in()?; // learned what people saw in 232 walks
//! let own = AffectiveSvm::default().train(&gaits, &labels, 1)?;
//! for gait in &gaits {
//!     println!("{}: {} to people, {} to us", gait.name, people.predict(gait).emotion, own.emotion(gait));
//! }
//! # Ok(())
//! # }
//! ```

pub mod affective_svm;
mod body;
pub mod comparison;
pub mod evaluate;
pub mod features;
#[doc(hidden)]
pub mod linear;
#[doc(hidden)]
pub mod logistic;
mod memo;
pub mod model;
#[doc(hidden)]
pub mod novelty;
pub mod perceiver;
pub mod ratings;
#[doc(hidden)]
pub mod scaling;
#[doc(hidden)]
pub mod svm;
#[doc(hidden)]
pub mod trainer;

use crate::emotion::Emotion;
use crate::gait::Gait;

/// A way of learning to tell the emotion that people see in a gait.
pub trait Method: Sync {
    /// Name in tables and on the command line, such as `affective-svm`.
    fn name(&self) -> &'static str;

    /// Learns from gaits with the emotions that people see in them; both slices have one length. The result depends
    /// on nothing but the arguments.
    ///
    /// # Errors
    /// [`Error::Training`] if there is nothing to learn from: fewer than two classes, or unusable gaits.
    fn train(&self, gaits: &[&Gait], emotions: &[Emotion], seed: u64) -> Result<Box<dyn Perceiver>, Error>;
}

/// A trained [`Method`].
pub trait Perceiver: Send + Sync {
    /// Probability of each emotion, in the order of [`Emotion::ALL`]; they add up to 1.
    fn probabilities(&self, gait: &Gait) -> [f64; 4];

    /// The most probable emotion; of equal ones the first.
    fn emotion(&self, gait: &Gait) -> Emotion {
        most_probable(self.probabilities(gait))
    }
}

/// The emotion of the largest probability; of equal ones the first.
pub fn most_probable(probabilities: [f64; 4]) -> Emotion {
    Emotion::ALL.into_iter().fold(Emotion::Happy, |best, emotion| {
        if probabilities[emotion.index()] > probabilities[best.index()] { emotion } else { best }
    })
}

/// Refuses what no method can learn from: slices of two lengths, fewer than two emotions.
fn check_training(method: &'static str, gaits: &[&Gait], emotions: &[Emotion]) -> Result<(), Error> {
    let failed = |message| Err(Error::Training { method, message });
    if gaits.len() != emotions.len() {
        return failed(format!("{} gaits with {} emotions", gaits.len(), emotions.len()));
    }
    match emotions.first() {
        None => failed("no gaits; give gaits of at least two emotions".to_owned()),
        Some(first) if emotions.iter().all(|emotion| emotion == first) => {
            failed(format!("all {} gaits are {first}; give gaits of at least two emotions", gaits.len()))
        }
        Some(_) => Ok(()),
    }
}

/// Ratings, features or a model could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Nothing can be learned from these gaits.
    #[error("cannot train {method}: {message}")]
    Training {
        /// The method.
        method: &'static str,
        /// Why, with values and the way out.
        message: String,
    },
    /// Gaits cannot be parted as an evaluation asks.
    #[error("cannot evaluate: {message}")]
    Evaluation {
        /// Why, with values and the way out.
        message: String,
    },
    /// A model file could not be used.
    #[error("{file}: {message}")]
    Model {
        /// The file.
        file: String,
        /// What was found, what was expected.
        message: String,
    },
    /// A file could not be read.
    #[error("cannot read {path:?}: {source}")]
    Read {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file could not be written.
    #[error("cannot write {path:?}: {source}")]
    Write {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is not what its format demands.
    #[error("{path}:{line}: {message}")]
    Syntax {
        /// The file.
        path: String,
        /// Line number from 1; 0 when the fault is the file as a whole.
        line: usize,
        /// What is wrong, with the value found and what was expected.
        message: String,
    },
}

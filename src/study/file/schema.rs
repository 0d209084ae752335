//! A whole study file.

use super::{Analysis, Consent, Crowd, Data, Exclude, Front, Headset, Part, Question, Recruit, Registration};
use crate::study::words::Words;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A study, as its file says it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// What it is and in which order it goes.
    pub study: Introduction,
    /// What participants agree to.
    pub consent: Consent,
    /// Where participants come from and how many may.
    #[serde(default)]
    pub recruit: Recruit,
    /// Whom the scenes are filled with; left out in studies of gaits alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crowd: Option<Crowd>,
    /// The parts that `study.flow` names.
    #[serde(default, rename = "part")]
    pub parts: BTreeMap<String, Part>,
    /// The questions that parts ask, by name.
    #[serde(default)]
    pub questions: BTreeMap<String, Question>,
    /// Wording that a licence keeps out of this program: texts by item, by questionnaire.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub wording: BTreeMap<String, BTreeMap<String, Words>>,
    /// Rules by which an analysis leaves participants out; written before the first one comes.
    #[serde(default)]
    pub exclude: Exclude,
    /// How long data is kept.
    #[serde(default)]
    pub data: Data,
    /// How the headset is answered in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub headset: Option<Headset>,
    /// The planned analysis.
    #[serde(default)]
    pub analysis: Analysis,
    /// What a registration says besides.
    #[serde(default)]
    pub registration: Registration,
}

/// What a study is and in which order it goes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Introduction {
    /// Name in addresses and files: 1 to 32 lower-case letters, digits or '-'.
    pub id: String,
    /// Counts changes of the file while the study runs, from 1.
    pub version: u32,
    /// What participants read above every page.
    pub title: Words,
    /// Seed of every draw of the plan, 0 to 2^63 - 1.
    pub seed: u64,
    /// Languages of the texts (BCP 47); the first is the one that others fall back to.
    pub languages: Vec<String>,
    /// How long the study is announced to take, min.
    pub minutes: u32,
    /// Name and address of the lab, shown on every page.
    pub contact: Words,
    /// Where participants take part.
    #[serde(rename = "where", default = "on_the_web")]
    pub fronts: Vec<Front>,
    /// `"consent"` first, then names of parts.
    pub flow: Vec<String>,
}

fn on_the_web() -> Vec<Front> {
    vec![Front::Web]
}

//! Questionnaires that others published: items and scoring. Wording is there only where its licence allows.

mod score;

use super::error::Error;
use super::load::read;
use super::words::Words;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The texts of the questionnaires that come with the program, by id.
const BUILTIN: [(&str, &str); 6] = [
    ("fms", include_str!("../../../assets/questionnaires/fms.toml")),
    ("ssq", include_str!("../../../assets/questionnaires/ssq.toml")),
    ("vrsq", include_str!("../../../assets/questionnaires/vrsq.toml")),
    ("csq-vr", include_str!("../../../assets/questionnaires/csq-vr.toml")),
    ("ipq", include_str!("../../../assets/questionnaires/ipq.toml")),
    ("sus", include_str!("../../../assets/questionnaires/sus.toml")),
];

/// Ids of the questionnaires that come with the program.
pub fn names() -> [&'static str; 6] {
    BUILTIN.map(|(name, _)| name)
}

/// A questionnaire.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Instrument {
    /// Name in study files and tables.
    pub id: String,
    /// What stands above the items.
    pub title: Words,
    /// Where it was published.
    pub source: String,
    /// What its wording may be used for.
    pub licence: String,
    /// Least answer.
    pub least: i64,
    /// Greatest answer.
    pub greatest: i64,
    /// Words for some answers.
    #[serde(default)]
    pub labels: BTreeMap<String, Words>,
    /// The items, in order.
    pub items: Vec<InstrumentItem>,
    /// The scores, in order; a later one may be made of earlier ones.
    #[serde(rename = "score")]
    pub scores: Vec<Score>,
}

/// An item of a questionnaire.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstrumentItem {
    /// Name within the questionnaire.
    pub id: String,
    /// Wording; left out where the licence does not allow it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<Words>,
    /// Whether a high answer means little.
    #[serde(default)]
    pub reversed: bool,
}

/// How items become a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScoreKind {
    /// Their sum.
    Sum,
    /// Their mean.
    Mean,
    /// Their sum above the least possible one, in percent of the range.
    Percent,
    /// How many reach `at_least`.
    Count,
}

/// A score of a questionnaire.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Score {
    /// Name within the questionnaire.
    pub id: String,
    /// How items become a number.
    pub kind: ScoreKind,
    /// Items that it is made of.
    #[serde(default)]
    pub items: Vec<String>,
    /// Earlier scores that it is made of, before their factors.
    #[serde(default)]
    pub of: Vec<String>,
    /// What the number is multiplied by.
    #[serde(default = "one")]
    pub factor: f64,
    /// Least answer that `count` counts.
    #[serde(default)]
    pub at_least: i64,
    /// Items that named variants leave out.
    #[serde(default)]
    pub without: BTreeMap<String, Vec<String>>,
}

const fn one() -> f64 {
    1.0
}

impl Instrument {
    /// A questionnaire that comes with the program; none of that name otherwise.
    ///
    /// # Errors
    /// [`Error::Syntax`] if its file is wrong, which a test excludes.
    pub fn builtin(name: &str) -> Result<Option<Self>, Error> {
        let Some((_, text)) = BUILTIN.iter().find(|(known, _)| *known == name) else { return Ok(None) };
        read(text, &format!("built-in questionnaire {name}")).map(Some)
    }

    /// Ids of the items that have no wording, neither built in nor in `written` (texts by item).
    pub fn without_wording(&self, written: Option<&BTreeMap<String, Words>>) -> Vec<&str> {
        let is_written =
            |id: &str| written.and_then(|texts| texts.get(id)).is_some_and(|text| !text.is_empty());
        let lacks = |item: &&InstrumentItem| item.text.is_none() && !is_written(&item.id);
        self.items.iter().filter(lacks).map(|item| item.id.as_str()).collect()
    }

    /// Names of all variants of scoring.
    pub fn variants(&self) -> Vec<&str> {
        self.scores.iter().flat_map(|score| score.without.keys().map(String::as_str)).collect()
    }
}

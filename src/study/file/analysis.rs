//! The planned analysis.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The planned analysis.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Analysis {
    /// Ratings of gaits become labels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ratings: Option<Ratings>,
    /// Tests, in the order of the report.
    #[serde(rename = "test", skip_serializing_if = "Vec::is_empty")]
    pub tests: Vec<Test>,
    /// How questionnaires are scored where several ways are usual, by questionnaire.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub scoring: BTreeMap<String, Scoring>,
}

/// Ratings of gaits become labels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ratings {
    /// The part whose answers are ratings.
    pub part: String,
    /// A gait looks like an emotion if its mean rating is above this (paper, section 3.3).
    pub theta: f64,
}

/// How a questionnaire is scored.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Scoring {
    /// Names of variants, such as `d_without_nausea` of `ssq`.
    pub variants: Vec<String>,
}

/// One test, or one per item that `of` covers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Test {
    /// Friedman's test over participants.
    Friedman {
        /// `PART.QUESTION.ITEM`; `*` is every item.
        of: String,
        /// What is compared: `condition` or `scene`.
        by: String,
        /// One test for each of these: `scene` or `condition`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        within: Option<String>,
        /// What follows a significant test.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        then: Option<FollowUp>,
    },
    /// A table of what was shown and what was answered.
    Confusion {
        /// `PART.QUESTION`.
        of: String,
    },
}

/// What follows a significant test.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum FollowUp {
    /// Wilcoxon's signed ranks for every pair.
    Wilcoxon {
        /// How several tests are adjusted for.
        adjust: Adjust,
        /// What becomes of pairs without a difference.
        #[serde(default)]
        zeros: Zeros,
    },
}

/// How several tests are adjusted for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Adjust {
    /// Bonferroni.
    Bonferroni,
    /// Holm.
    Holm,
}

/// What becomes of pairs without a difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Zeros {
    /// They are dropped.
    #[default]
    Wilcoxon,
    /// They are ranked and then dropped.
    Pratt,
}

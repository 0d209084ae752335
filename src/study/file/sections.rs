//! The sections of a study file beside parts and questions.

use crate::study::words::Words;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Where a participant takes part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Front {
    /// A browser.
    Web,
    /// A headset.
    Headset,
    /// No person: a simulated participant. Never mixed with people in an analysis.
    Simulated,
}

/// What participants agree to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Consent {
    /// Markdown file beside the study file, by language if there are several.
    pub text: Words,
    /// Youngest age of a participant, years, 0 to 120.
    #[serde(default = "of_age")]
    pub minimum_age: u32,
    /// What becomes of the answers of a participant who withdraws.
    #[serde(default)]
    pub on_withdrawal: OnWithdrawal,
}

const fn of_age() -> u32 {
    18
}

/// What becomes of the answers of a participant who withdraws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OnWithdrawal {
    /// They are deleted, and their places in the plan become free.
    #[default]
    Delete,
    /// They stay, without anything that leads to the participant.
    KeepAnonymous,
}

/// Where participants come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Platform {
    /// By no platform: the address is handed out.
    #[default]
    None,
    /// Prolific.
    Prolific,
    /// Amazon Mechanical Turk.
    Mturk,
    /// Sona.
    Sona,
    /// By links with a code each.
    Links,
}

/// Where participants come from and how many may.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Recruit {
    /// The platform.
    pub platform: Platform,
    /// The platform's codes of completion.
    pub codes: Codes,
    /// Sona's address that grants credit, as Sona shows it: `https://..survey_code=XXXX`. The participant's code takes the place
    /// of `XXXX`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub credit: Option<String>,
    /// Most participants that are under way or finished at a time, 1 to 1,000,000; lapsed ones do not count.
    pub most_participants: u32,
    /// Longest silence before a place is given to another participant, min, 1 to 10,080.
    pub lease_minutes: u32,
    /// Origins whose pages may show the study in a frame, such as `https://survey.example.org`; none: no page may.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub embed_in: Vec<String>,
}

impl Recruit {
    /// Whether a text is an origin as headers have it: `https://HOST[:PORT]`, or `http://` of this machine for trials.
    pub(in crate::study) fn is_origin(text: &str) -> bool {
        let is_plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-' || b == b'.';
        let is_host =
            |host: &str| host.bytes().all(is_plain) && host.bytes().any(|b| b.is_ascii_alphanumeric());
        let (scheme, rest) = text.split_once("://").unwrap_or_default();
        let (host, port) = rest.split_once(':').map_or((rest, None), |(host, port)| (host, Some(port)));
        let is_here = matches!(host, "localhost" | "127.0.0.1");
        let has_port = port.is_none_or(|port| port.parse::<u16>().is_ok_and(|port| port > 0));
        (scheme == "https" || scheme == "http" && is_here) && is_host(host) && has_port
    }
}

impl Default for Recruit {
    fn default() -> Self {
        Self {
            platform: Platform::None,
            codes: Codes::default(),
            credit: None,
            most_participants: 1000,
            lease_minutes: 30,
            embed_in: Vec::new(),
        }
    }
}

/// The platform's codes, by how a participation ended.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, rename_all = "kebab-case")]
pub struct Codes {
    /// Finished.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub complete: Option<String>,
    /// The check was failed too often.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screened_out: Option<String>,
    /// Withdrawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub withdrawn: Option<String>,
}

/// Whom the scenes are filled with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crowd {
    /// Library of rated gaits, a file beside the study file.
    pub library: String,
    /// Names or files of avatars.
    pub avatars: Vec<String>,
    /// People in a scene, 1 to 100,000; none: the scene's own number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub agents: Option<u32>,
}

/// Rules by which an analysis leaves participants out. An analysis reports with and without them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Exclude {
    /// Fewest instructed answers given wrongly, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed_catch: Option<u32>,
    /// Median time of an answer below this, ms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub median_ms_below: Option<u32>,
    /// Share of the most frequent answer above this, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub same_answer_share: Option<f64>,
    /// Share of late frames above this, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub late_frames_share: Option<f64>,
}

/// How long data is kept, days.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Data {
    /// The platform's ids, in a file of their own, 0 to 36,500.
    pub keep_links_days: u32,
    /// Answers, 0 to 36,500.
    pub keep_answers_days: u32,
}

impl Default for Data {
    fn default() -> Self {
        Self { keep_links_days: 30, keep_answers_days: 3650 }
    }
}

/// How a participant in a headset points at an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pointer {
    /// A controller's ray and its trigger.
    Laser,
    /// A controller's stick and its first button.
    Stick,
    /// The head, by dwelling.
    Gaze,
}

/// How a headset is answered in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Headset {
    /// The ways that count. A look counts where there is no controller, or always if it comes first.
    pub answer: Vec<Pointer>,
    /// Answers from which on the operator is asked whether to end, by question.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub stop_at: BTreeMap<String, i64>,
}

/// What a registration says that the rest of the file does not.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Registration {
    /// Names of the authors.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub authors: Vec<String>,
    /// The hypotheses.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hypotheses: Vec<String>,
    /// Smallest effect of interest in Friedman tests, as Kendall's W, above 0 and below 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smallest_w: Option<f64>,
}

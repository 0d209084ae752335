//! What panels say beside the study's own texts, by language.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The table of words.
const TABLE: &str = include_str!("../../../assets/headset/words.toml");
/// The language of participants whose language has no words.
const FALLBACK: &str = "en";

/// The words of one language. A table that lacks one, or has one more, cannot be read.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Phrases {
    pub(super) back: String,
    pub(super) next: String,
    progress: String,
    question: String,
    pub(super) aloud: String,
    pub(super) wait: String,
    pub(super) consent: String,
    pub(super) rest: String,
    pub(super) paused: String,
    pub(super) finished: String,
    pub(super) full: String,
    pub(super) ended: String,
}

/// All languages; none if the table is broken, which a test excludes.
static ALL: LazyLock<BTreeMap<String, Phrases>> = LazyLock::new(|| toml::from_str(TABLE).unwrap_or_default());

impl Phrases {
    /// The words of a language (BCP 47), or of English.
    pub(super) fn of(language: &str) -> Self {
        let own = language.split(['-', '_']).next().unwrap_or(language);
        let found = ALL.iter().find(|(tag, _)| tag.eq_ignore_ascii_case(own)).map(|(_, words)| words);
        found.or_else(|| ALL.get(FALLBACK)).cloned().unwrap_or_default()
    }

    /// How far the participant is in the trials.
    pub(super) fn progress(&self, trial: u32, of: u32) -> String {
        self.progress.replace("{trial}", &trial.to_string()).replace("{of}", &of.to_string())
    }

    /// Which question of a page it is.
    pub(super) fn question(&self, number: usize, count: usize) -> String {
        self.question.replace("{number}", &number.to_string()).replace("{count}", &count.to_string())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;
    use crate::xr::{MOST_CHARACTERS, Panel};

    #[test]
    fn every_language_has_every_word_and_each_fits_on_a_panel() {
        let all: BTreeMap<String, Phrases> = toml::from_str(TABLE).unwrap();
        assert_eq!(all.keys().collect::<Vec<_>>(), ["de", "en", "es", "fr"]);
        for (language, words) in all {
            let Phrases { back, next, aloud, wait, consent, rest, paused, finished, full, ended, .. } =
                words.clone();
            for text in [back, next, aloud, wait, consent, rest, paused, finished, full, ended] {
                assert!(!text.is_empty() && text.len() < MOST_CHARACTERS, "{language}: {text}");
                Panel { question: text, ..Panel::default() }.check().unwrap();
            }
            for text in [words.progress(3, 12), words.question(2, 5)] {
                assert!(!text.contains(['{', '}']), "{language}: {text}");
            }
            assert!(words.progress(3, 12).contains("12") && words.question(2, 5).contains('5'));
        }
        assert_eq!(Phrases::of("de-AT").back, "Zurück");
        assert_eq!(Phrases::of("tlh"), Phrases::of("en"));
    }
}

//! Words of what the program asks by itself, in the languages of `assets/web/words.toml`.

use super::words::{Words, primary};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The table of words.
pub(super) const TABLE: &str = include_str!("../../assets/web/words.toml");
/// The language of participants whose language has no words.
pub(super) const FALLBACK: &str = "en";

/// The words of one language.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Asked {
    pub(super) gender: String,
    pub(super) woman: String,
    pub(super) man: String,
    pub(super) another: String,
    pub(super) not_said: String,
    pub(super) age: String,
    /// With `{answer}` for the answer that is wanted.
    pub(super) instruction: String,
}

/// A language of the table, of which the rest is the pages' own.
#[derive(Debug, Deserialize)]
struct Language {
    asked: Asked,
}

static ALL: LazyLock<BTreeMap<String, Asked>> = LazyLock::new(|| {
    // a table that cannot be read is excluded by a test
    let all: BTreeMap<String, Language> = toml::from_str(TABLE).unwrap_or_default();
    all.into_iter().map(|(tag, language)| (tag, language.asked)).collect()
});

/// A text in each of a study's languages; in English where a language has no words.
pub(super) fn words(languages: &[String], text: impl Fn(&Asked) -> &String) -> Words {
    let of = |tag: &str| {
        let found = ALL.iter().find(|(known, _)| known.eq_ignore_ascii_case(primary(tag)));
        found.map(|(_, asked)| asked).or_else(|| ALL.get(FALLBACK)).map(&text).cloned().unwrap_or_default()
    };
    match languages {
        [] => Words::Same(of(FALLBACK)),
        [one] => Words::Same(of(one)),
        all => Words::By(all.iter().map(|tag| (tag.clone(), of(tag))).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_language_of_the_pages_has_all_that_is_asked() {
        let pages: BTreeMap<String, toml::Table> = toml::from_str(TABLE).unwrap();
        assert_eq!(ALL.keys().collect::<Vec<_>>(), pages.keys().collect::<Vec<_>>());
        for (language, Asked { gender, woman, man, another, not_said, age, instruction }) in ALL.iter() {
            let all = [gender, woman, man, another, not_said, age, instruction];
            assert!(all.iter().all(|text| !text.trim().is_empty()), "{language}");
            assert_eq!(instruction.matches("{answer}").count(), 1, "{language}");
            if language != FALLBACK {
                let english = &ALL[FALLBACK];
                assert!(
                    *gender != english.gender && *age != english.age && *instruction != english.instruction
                );
            }
        }
    }

    #[test]
    fn a_study_gets_its_own_languages_and_english_for_others() {
        let words = |tags: &[&str]| {
            let tags: Vec<String> = tags.iter().map(|&tag| tag.to_owned()).collect();
            words(&tags, |asked| &asked.age)
        };
        let all = words(&["fr", "de-AT", "it"]);
        let own = |tag: &str| all.find(tag, &[]).to_owned();
        assert_eq!(own("fr"), "Votre âge en années");
        assert_eq!(own("de-AT"), "Ihr Alter in Jahren");
        assert_eq!(own("it"), "Your age in years");
        assert_eq!(words(&["it"]).find("it", &[]), "Your age in years");
    }
}

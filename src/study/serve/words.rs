//! The words of the interface, by language.

use super::Error;
use crate::study::asked::{FALLBACK, TABLE};
use crate::study::words::primary;
use std::collections::BTreeMap;

/// Where the table has what the program asks by itself, which is no word of the pages.
const ASKED: &str = "asked";
/// Languages that are written from right to left.
const FROM_THE_RIGHT: [&str; 9] = ["ar", "ckb", "dv", "fa", "he", "ps", "sd", "ur", "yi"];

/// Declares the words: a language that lacks one, or has one more, cannot be read. (Derived code for so many fields takes the
/// compiler seconds.)
macro_rules! words {
    ($($name:ident)*) => {
        /// The words of one language.
        #[derive(Debug, Clone, Default)]
        pub(super) struct Interface {
            $(pub(super) $name: String,)*
        }

        impl Interface {
            /// Takes all words out of a table.
            fn of(mut table: BTreeMap<String, String>) -> Result<Self, String> {
                let mut lacking = None;
                let mut take = |name: &str| take(&mut table, name, &mut lacking);
                let words = Self { $($name: take(stringify!($name)),)* };
                let excess = table.into_keys().next().map(|name| format!("{name:?} is no word of the pages"));
                lacking.or(excess).map_or(Ok(words), Err)
            }
        }
    };
}

fn take(table: &mut BTreeMap<String, String>, name: &str, lacking: &mut Option<String>) -> String {
    table.remove(name).unwrap_or_else(|| {
        lacking.get_or_insert_with(|| format!("{name:?} is lacking"));
        String::new()
    })
}

words! {
    skip language progress contact your_code code_note code_link
    withdraw withdraw_title withdraw_delete withdraw_keep withdraw_yes withdraw_no
    minutes start start_note preview
    consent_title minimum_age agree decline
    text_title form_title check_title attempt attempt_again show_title ask_title rest_title rest_text paused_title paused_text
    next optional lacking lacking_all keys_note
    play replay loading ready playing hidden broken film_offline motion_note no_scripts
    saving saved offline refused lost
    finished_title finished_text declined_title declined_text gone_text withdrawn_title withdrawn_delete withdrawn_keep
    screened_out_title screened_out_text excluded_title excluded_text full_title full_text
    completion completion_note to_prolific to_sona credit_note try_again to_start go_on
    unavailable_title unavailable_text closed_title closed_text refused_title refused_text unknown_title unknown_text
    not_found_title not_found_text too_many_title too_many_text too_large_title too_large_text
    bad_request_title bad_request_text forbidden_title forbidden_text other_title other_text
}

/// The words of all languages.
#[derive(Debug, Clone)]
pub(super) struct Interfaces(BTreeMap<String, Interface>);

impl Interfaces {
    /// The words that are part of the program.
    ///
    /// # Errors
    /// [`Error::Words`] if a language lacks one, which a test excludes.
    pub(super) fn built_in() -> Result<Self, Error> {
        let all = read(TABLE).map_err(|message| Error::Words { message })?;
        if all.contains_key(FALLBACK) {
            return Ok(Self(all));
        }
        Err(Error::Words { message: format!("no language {FALLBACK}") })
    }

    /// The tag of the best language among those that there are words in, and its words.
    pub(super) fn find(&self, language: &str) -> (&str, &Interface) {
        let own = primary(language);
        let found = self.0.iter().find(|(tag, _)| tag.eq_ignore_ascii_case(own));
        let (tag, interface) = found.or_else(|| self.0.get_key_value(FALLBACK)).unzip();
        (tag.map_or(FALLBACK, String::as_str), interface.unwrap_or(&EMPTY))
    }
}

/// The words of the pages, out of a table that has more.
fn read(table: &str) -> Result<BTreeMap<String, Interface>, String> {
    let all: BTreeMap<String, toml::Table> = toml::from_str(table).map_err(|error| error.to_string())?;
    let pages = |(tag, mut table): (String, toml::Table)| {
        table.remove(ASKED);
        let words = table.try_into().map_err(|error| format!("{tag}: {error}"))?;
        Interface::of(words).map(|words| (tag.clone(), words)).map_err(|reason| format!("{tag}: {reason}"))
    };
    all.into_iter().map(pages).collect()
}

/// The words of a table that has none, which [`Interfaces::built_in`] excludes.
static EMPTY: std::sync::LazyLock<Interface> = std::sync::LazyLock::new(Interface::default);

/// In which direction a language is written, for the attribute `dir`.
pub(super) fn direction(language: &str) -> &'static str {
    let own = primary(language);
    if FROM_THE_RIGHT.iter().any(|tag| tag.eq_ignore_ascii_case(own)) { "rtl" } else { "ltr" }
}

/// Puts values into the braces of a text: `fill("{a} of {b}", &[("a", &1), ("b", &2)])`.
pub(super) fn fill(text: &str, values: &[(&str, &dyn std::fmt::Display)]) -> String {
    let put = |text: String, (name, value): &(&str, &dyn std::fmt::Display)| {
        text.replace(&format!("{{{name}}}"), &value.to_string())
    };
    values.iter().fold(text.to_owned(), put)
}

/// The language of a study that a browser likes best (`Accept-Language`); the study's first one if it likes none.
pub(super) fn negotiate(accepted: &str, languages: &[String]) -> String {
    let mut wanted: Vec<(f32, &str)> = accepted.split(',').take(32).filter_map(preference).collect();
    wanted.sort_by(|a, b| b.0.total_cmp(&a.0));
    let find = |tag: &str| {
        let exact = languages.iter().find(|language| language.eq_ignore_ascii_case(tag));
        let related = || languages.iter().find(|own| primary(own).eq_ignore_ascii_case(primary(tag)));
        exact.or_else(related)
    };
    let found = wanted.into_iter().find_map(|(_, tag)| find(tag));
    found.or(languages.first()).map_or(FALLBACK, String::as_str).to_owned()
}

/// Weight and tag of one entry of `Accept-Language`; none if it is refused.
fn preference(entry: &str) -> Option<(f32, &str)> {
    let (tag, rest) = entry.split_once(';').unwrap_or((entry, ""));
    let weight = rest.trim().strip_prefix("q=").map_or(Ok(1.0), |q| q.trim().parse::<f32>());
    weight.ok().filter(|q| *q > 0.0).map(|q| (q, tag.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_language_has_every_word_with_its_braces() {
        let mut all: BTreeMap<String, toml::Table> = toml::from_str(TABLE).unwrap();
        all.values_mut().for_each(|words| assert!(words.remove(ASKED).is_some()));
        assert_eq!(all.keys().collect::<Vec<_>>(), ["de", "en", "es", "fr"]);
        Interfaces::built_in().unwrap();
        let braces = |text: &str| {
            let mut found: Vec<String> =
                text.split('{').skip(1).filter_map(|rest| Some(rest.split_once('}')?.0.to_owned())).collect();
            found.sort();
            found
        };
        for (language, words) in &all {
            for (word, text) in words {
                let text = text.as_str().unwrap();
                assert!(!text.trim().is_empty(), "{language}.{word}");
                assert_eq!(braces(text), braces(all["en"][word].as_str().unwrap()), "{language}.{word}");
            }
        }
        let misspelt = TABLE.replacen("skip = ", "skap = ", 1);
        assert!(read(&misspelt).unwrap_err().ends_with("\"skip\" is lacking"));
        let doubled = TABLE.replacen("skip = ", "skap = \"\"\nskip = ", 1);
        assert!(read(&doubled).unwrap_err().ends_with("\"skap\" is no word of the pages"));
    }

    #[test]
    fn languages_are_found_by_wish_relation_and_order() {
        let own = ["en", "pt-BR", "de"].map(str::to_owned);
        assert_eq!(negotiate("fr, de;q=0.5, en;q=0.4", &own), "de");
        assert_eq!(negotiate("pt;q=0.9, de;q=0.1", &own), "pt-BR");
        assert_eq!(negotiate("de;q=0, fr", &own), "en");
        assert_eq!(negotiate("", &own), "en");
        let all = Interfaces::built_in().unwrap();
        assert_eq!([all.find("de-AT").0, all.find("fi").0], ["de", "en"]);
        assert_eq!([direction("ar-EG"), direction("de")], ["rtl", "ltr"]);
        assert_eq!(fill("{a} of {b}", &[("a", &1), ("b", &"two")]), "1 of two");
    }
}

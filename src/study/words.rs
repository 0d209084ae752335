//! Texts that participants read: one for all languages, or one a language.

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::collections::BTreeMap;
use std::fmt;

/// A text: a string, or a table of strings by language (`{ en = "sad", de = "traurig" }`).
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Words {
    /// The same in every language.
    Same(String),
    /// By the tag of the language (BCP 47), such as `en` or `pt-BR`.
    By(BTreeMap<String, String>),
}

impl Default for Words {
    fn default() -> Self {
        Self::Same(String::new())
    }
}

impl From<&str> for Words {
    fn from(text: &str) -> Self {
        Self::Same(text.to_owned())
    }
}

impl Words {
    /// The text in a language. Without it: the same language of another region, the first of `preferred` that is there, or
    /// else the first in the order of tags. Case of tags does not matter.
    pub fn find(&self, language: &str, preferred: &[String]) -> &str {
        let texts = match self {
            Self::Same(text) => return text,
            Self::By(texts) => texts,
        };
        let exact = |wanted: &str| texts.iter().find(|(tag, _)| tag.eq_ignore_ascii_case(wanted));
        let related = |wanted: &str| {
            let own = primary(wanted);
            texts.iter().find(|(tag, _)| primary(tag).eq_ignore_ascii_case(own))
        };
        exact(language)
            .or_else(|| related(language))
            .or_else(|| preferred.iter().find_map(|tag| exact(tag).or_else(|| related(tag))))
            .or_else(|| texts.iter().next())
            .map_or("", |(_, text)| text)
    }

    /// Whether no language has a text.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Same(text) => text.trim().is_empty(),
            Self::By(texts) => texts.values().all(|text| text.trim().is_empty()),
        }
    }

    /// The languages of `wanted` that lack a text of their own; none for a text that is the same everywhere.
    pub fn lacking<'a>(&self, wanted: &'a [String]) -> Vec<&'a str> {
        let Self::By(texts) = self else { return Vec::new() };
        let has = |language: &str| {
            texts.iter().any(|(tag, text)| tag.eq_ignore_ascii_case(language) && !text.trim().is_empty())
        };
        wanted.iter().map(String::as_str).filter(|language| !has(language)).collect()
    }

    /// Longest of the texts, words.
    pub fn length(&self) -> usize {
        let count = |text: &String| text.split_whitespace().count();
        match self {
            Self::Same(text) => count(text),
            Self::By(texts) => texts.values().map(count).max().unwrap_or(0),
        }
    }
}

/// The part of a tag before its region: `pt` of `pt-BR`.
pub(super) fn primary(tag: &str) -> &str {
    tag.split(['-', '_']).next().unwrap_or(tag)
}

impl Serialize for Words {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Same(text) => serializer.serialize_str(text),
            Self::By(texts) => texts.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Words {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Texts;

        impl<'de> Visitor<'de> for Texts {
            type Value = Words;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a text, or a table of texts by language such as { en = \"sad\" }")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Words, E> {
                Ok(Words::Same(text.to_owned()))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Words, A::Error> {
                let mut texts = BTreeMap::new();
                while let Some((language, text)) = map.next_entry()? {
                    texts.insert(language, text);
                }
                Ok(Words::By(texts))
            }
        }
        deserializer.deserialize_any(Texts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(pairs: &[(&str, &str)]) -> Words {
        Words::By(pairs.iter().map(|&(tag, text)| (tag.to_owned(), text.to_owned())).collect())
    }

    #[test]
    fn a_language_that_is_missing_falls_back_to_its_relatives_and_then_to_the_preferred_one() {
        let sad = words(&[("de", "traurig"), ("en", "sad"), ("pt-BR", "triste")]);
        let preferred = ["en".to_owned()];
        assert_eq!(sad.find("DE", &preferred), "traurig");
        assert_eq!(sad.find("de-AT", &preferred), "traurig");
        assert_eq!(sad.find("pt", &preferred), "triste");
        assert_eq!(sad.find("fr", &preferred), "sad");
        assert_eq!(sad.find("fr", &[]), "traurig");
        assert_eq!(Words::from("x").find("fr", &[]), "x");
        let all = ["en", "fr"].map(str::to_owned);
        assert_eq!(sad.lacking(&all), ["fr"]);
        assert!(Words::default().is_empty() && words(&[("en", " ")]).is_empty() && !sad.is_empty());
    }
}

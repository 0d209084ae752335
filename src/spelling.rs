//! Words for one of several things, and misspelt ones: the known word that was probably meant.

/// Characters of a word that are compared: a distance takes the product of two lengths.
const LONGEST: usize = 64;

/// A word that names none of the things it may name: no emotion, no sex, no variant of the features.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown {kind} {found:?}; use {}", either(known))]
pub struct UnknownName {
    /// What the word was to name, such as "emotion".
    pub kind: &'static str,
    /// The word.
    pub found: String,
    /// The words that are known.
    pub known: Vec<&'static str>,
}

/// The thing of this name among `all`; case does not matter.
pub(crate) fn by_name<T: Copy>(
    kind: &'static str,
    all: &[T],
    name: fn(T) -> &'static str,
    word: &str,
) -> Result<T, UnknownName> {
    all.iter().copied().find(|&one| name(one).eq_ignore_ascii_case(word)).ok_or_else(|| UnknownName {
        kind,
        found: word.to_owned(),
        known: all.iter().copied().map(name).collect(),
    })
}

/// `a, b or c`.
fn either(words: &[&str]) -> String {
    match words {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => words.concat(),
    }
}

/// The candidate with the fewest edits (case does not matter), if it is near enough to be what was meant.
pub(crate) fn nearest<'a>(wrong: &str, known: &[&'a str]) -> Option<&'a str> {
    let plain = |word: &str| word.chars().take(LONGEST).collect::<String>().to_ascii_lowercase();
    let own = plain(wrong);
    let near = |candidate: &&'a str| (strsim::levenshtein(&own, &plain(candidate)), *candidate);
    let (distance, candidate) = known.iter().map(near).min()?;
    (distance <= (wrong.len().max(candidate.len()) / 2).max(1)).then_some(candidate)
}

/// The way out of a name that is not known: the one that was probably meant, or else all that there are, after `all_are`.
pub(crate) fn suggestion(wrong: &str, known: &[&str], all_are: &str) -> String {
    match nearest(wrong, known) {
        Some(near) => format!("did you mean {near:?}?"),
        None => format!("{all_are} {}", known.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_with_few_edits_is_found_and_a_strange_one_is_not() {
        let known = ["happy", "angry", "sad", "neutral"];
        for (wrong, meant) in [("hapy", "happy"), ("Angri", "angry"), ("nuetral", "neutral"), ("SAAD", "sad")]
        {
            assert_eq!(nearest(wrong, &known), Some(meant));
        }
        assert_eq!(nearest("euphoric", &known), None);
        assert_eq!(nearest("", &[]), None);
        assert_eq!(suggestion("hapy", &known, "there are"), "did you mean \"happy\"?");
        assert_eq!(suggestion("euphoric", &known, "there are"), "there are happy, angry, sad, neutral");
    }
}

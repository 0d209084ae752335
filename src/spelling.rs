//! Misspelt words: the known word that was probably meant.

/// Characters of a word that are compared: a distance takes the product of two lengths.
const LONGEST: usize = 64;

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

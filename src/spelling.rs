//! Misspelt words: the known word that was probably meant.

/// The candidate with the fewest edits, if it is near enough to be what was meant.
pub(crate) fn nearest<'a>(wrong: &str, known: &[&'a str]) -> Option<&'a str> {
    let near = |candidate: &&'a str| (edit_distance(wrong, candidate), *candidate);
    let (distance, candidate) = known.iter().map(near).min()?;
    (distance <= (wrong.len().max(candidate.len()) / 2).max(1)).then_some(candidate)
}

/// Levenshtein distance over bytes of the first 64 of each word.
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b) = (&a.as_bytes()[..a.len().min(64)], &b.as_bytes()[..b.len().min(64)]);
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(!x.eq_ignore_ascii_case(y));
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
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
    }
}

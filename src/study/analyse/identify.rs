//! What was shown and what was answered.

use crate::emotion::Emotion;
use crate::statistics::confusion::{Confusion, OverPeople, accuracy_over_people, confusion};
use crate::study::error::Error;
use crate::study::tables::{Answer, ORDINARY};
use serde::Serialize;
use std::collections::BTreeMap;

/// Resamples of people, and the seed of their draws.
const DRAWS: usize = 2000;
const SEED: u64 = 20_190_919;

/// A table of emotions, shown and answered.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identified {
    /// What the study file calls it.
    pub of: String,
    /// Counts, `[shown][answered]`, in the order of [`Emotion::ALL`].
    pub counts: [[u64; 4]; 4],
    /// What they say.
    pub confusion: Confusion,
    /// Accuracy with an interval by a bootstrap over people.
    pub over_people: OverPeople,
}

/// The table of `PART.QUESTION`, whose options are the emotions in the order of `options`.
pub(super) fn identified(answers: &[&Answer], of: &str, options: &[Emotion]) -> Result<Identified, Error> {
    let wrong = |message: String| Error::Analysis { test: of.to_owned(), message };
    let (part, question) = of.split_once('.').unwrap_or((of, ""));
    let mut people: BTreeMap<&str, Vec<[usize; 2]>> = BTreeMap::new();
    let mut counts = [[0; 4]; 4];
    let counted =
        answers.iter().filter(|one| one.part == part && one.question == question && one.role == ORDINARY);
    for one in counted {
        let Some(value) = one.value else { continue };
        let shown: Emotion = one.emotion.parse().map_err(|error| wrong(format!("{error}")))?;
        let answered = usize::try_from(value).ok().and_then(|index| options.get(index));
        let answered = answered.ok_or_else(|| {
            wrong(format!("value = {value}: must be 0 to {}", options.len().saturating_sub(1)))
        })?;
        let pair = [shown.index(), answered.index()];
        let [row, column] = pair;
        counts[row][column] += 1;
        people.entry(&one.participant).or_default().push(pair);
    }
    if people.is_empty() {
        return Err(wrong("no answer to it".to_owned()));
    }
    let own: Vec<Vec<[usize; 2]>> = people.into_values().collect();
    Ok(Identified {
        of: of.to_owned(),
        counts,
        confusion: confusion(&counts)?,
        over_people: accuracy_over_people(&own, DRAWS, 0.95, SEED)?,
    })
}

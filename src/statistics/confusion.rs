//! Confusion matrices of identification tasks.
//!
//! Based on: Wilson 1927 (intervals); Cohen 1960 (kappa); Wagner 1993, "On measuring performance in category judgment
//! studies of nonverbal behavior", Journal of Nonverbal Behavior 17 (unbiased hit rate); Field and Welsh 2007, JRSS B 69
//! (bootstrap of clusters).

use super::Alternative;
use super::describe::{number, percentile_interval};
use super::error::{Error, at_least, inside_unit};
use super::interval::{binomial_test, share_interval};
use super::kappa::{Kappa, Weights, kappa, real, square};
use crate::random::Random;
use serde::Serialize;

/// What a confusion matrix says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confusion {
    /// Number of answers.
    pub answers: u64,
    /// Number of right answers.
    pub right: u64,
    /// Share of right answers.
    pub accuracy: f64,
    /// Its 95 % interval by Wilson, as if all answers were independent. Answers of one person are not: see
    /// [`accuracy_over_people`].
    pub accuracy_interval: [f64; 2],
    /// One entry a class, in the order of the rows.
    pub classes: Vec<Class>,
    /// Cohen's kappa of what was shown and answered; `None` where all is one class.
    pub kappa: Option<Kappa>,
    /// One over the number of classes.
    pub chance: f64,
    /// Exact binomial p of so many right answers or more by chance.
    pub p_above_chance: f64,
}

/// One class of a confusion matrix. A share of nothing is `None`, with the interval [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Class {
    /// How often it was shown: the row's sum.
    pub shown: u64,
    /// How often it was answered: the column's sum.
    pub answered: u64,
    /// How often both.
    pub right: u64,
    /// Share of right answers where it was shown.
    pub recall: Option<f64>,
    /// 95 % interval by Wilson.
    pub recall_interval: [f64; 2],
    /// Share of right answers where it was answered.
    pub precision: Option<f64>,
    /// 95 % interval by Wilson.
    pub precision_interval: [f64; 2],
    /// Wagner's unbiased hit rate: recall times precision.
    pub unbiased_hit_rate: Option<f64>,
}

/// Evaluates counts, `[shown][answered]`.
///
/// # Errors
/// Fewer than two classes, a table that is not square, or no answers.
pub fn confusion<R: AsRef<[u64]>>(counts: &[R]) -> Result<Confusion, Error> {
    let (total, count) = square(counts)?;
    let classes: Vec<Class> = (0..count)
        .map(|i| {
            let shown = counts[i].as_ref().iter().sum();
            let answered = counts.iter().map(|row| row.as_ref()[i]).sum();
            class(shown, answered, counts[i].as_ref()[i])
        })
        .collect();
    let (answers, right) =
        (classes.iter().map(|class| class.shown).sum(), classes.iter().map(|class| class.right).sum());
    let chance = 1.0 / number(count);
    Ok(Confusion {
        answers,
        right,
        accuracy: real(right) / total,
        accuracy_interval: share_interval(real(right) / total, answers),
        classes,
        kappa: kappa(counts, Weights::Equal).ok(),
        chance,
        p_above_chance: binomial_test(right, answers, chance, Alternative::Greater)?,
    })
}

fn class(shown: u64, answered: u64, right: u64) -> Class {
    let share = |of: u64| (of > 0).then(|| real(right) / real(of));
    let interval = |of: u64| share_interval(share(of).unwrap_or(0.0), of);
    Class {
        shown,
        answered,
        right,
        recall: share(shown),
        recall_interval: interval(shown),
        precision: share(answered),
        precision_interval: interval(answered),
        unbiased_hit_rate: share(shown)
            .zip(share(answered))
            .map(|_| real(right) * real(right) / (real(shown) * real(answered))),
    }
}

/// Accuracy with an interval that respects people.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OverPeople {
    /// Number of people.
    pub people: usize,
    /// Share of right answers of all.
    pub accuracy: f64,
    /// Percentile interval: people are drawn with replacement, each with all answers.
    pub interval: [f64; 2],
}

/// Accuracy of answers `[shown, answered]`, one slice a person, with a bootstrap over people.
///
/// # Errors
/// No people, a person without answers, no draws, or a level outside (0, 1).
pub fn accuracy_over_people<R: AsRef<[[usize; 2]]>>(
    people: &[R],
    draws: usize,
    level: f64,
    seed: u64,
) -> Result<OverPeople, Error> {
    inside_unit("level", level)?;
    at_least("people", people.len(), 1)?;
    at_least("draws", draws, 1)?;
    let mut scores = Vec::with_capacity(people.len());
    for answers in people {
        let answers = answers.as_ref();
        at_least("answers of a person", answers.len(), 1)?;
        scores.push([answers.iter().filter(|[shown, answered]| shown == answered).count(), answers.len()]);
    }
    let accuracy = |chosen: &mut dyn Iterator<Item = [usize; 2]>| -> f64 {
        let [right, all] = chosen.fold([0, 0], |sum, score| [sum[0] + score[0], sum[1] + score[1]]);
        number(right) / number(all)
    };
    let mut random = Random::new(seed);
    let found = (0..draws)
        .map(|_| accuracy(&mut (0..scores.len()).map(|_| scores[random.below(scores.len())])))
        .collect();
    Ok(OverPeople {
        people: people.len(),
        accuracy: accuracy(&mut scores.iter().copied()),
        interval: percentile_interval(found, level),
    })
}

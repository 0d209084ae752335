//! How well a method agrees with people: folds, repeats, accuracy, recall, confusion.
//!
//! Labelled gaits in. For each seed they are split into folds; a method learns from all folds but one and answers for that
//! one; the answers of all folds are counted. The meaning of the number depends on which gaits may share a fold: any
//! (stratified by emotion), never one person's in two folds, never one data set's in two folds.
//! Paper: section 3.5; S-15, A-09, A-19. The result depends on nothing but the arguments: not on threads, not on the
//! machine.

#[doc(hidden)]
pub use crate::random::Random;

use super::{Error, Method};
use crate::emotion::Emotion;
use crate::gait::Gait;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// Which gaits are held out together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "by")]
pub enum Grouping {
    /// k folds with the same share of each emotion, people and data sets mixed.
    Stratified {
        /// k, at least 2.
        folds: usize,
    },
    /// k folds with nearly the same share of each emotion and no person in two folds.
    Subject {
        /// k, at least 2.
        folds: usize,
    },
    /// One fold for each data set.
    Dataset,
}

impl Grouping {
    /// Words for a report, such as `10-fold, stratified`.
    pub fn describe(self) -> String {
        match self {
            Self::Stratified { folds } => format!("{folds}-fold, stratified by emotion"),
            Self::Subject { folds } => format!("{folds}-fold, no person in two folds"),
            Self::Dataset => "leave one data set out".to_owned(),
        }
    }
}

/// How often and on which folds a method is tried.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    /// Which gaits are held out together.
    pub grouping: Grouping,
    /// One repeat for each: it shuffles the folds and is given to the method.
    pub seeds: Vec<u64>,
}

/// How a method did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evaluation {
    /// Name of the method.
    pub method: String,
    /// Which gaits were held out together.
    pub grouping: Grouping,
    /// The seeds of the repeats.
    pub seeds: Vec<u64>,
    /// Number of gaits.
    pub gaits: usize,
    /// Share of right answers in each repeat, 0 to 1.
    pub accuracies: Vec<f64>,
    /// Their mean.
    pub accuracy_mean: f64,
    /// Their standard deviation (n - 1); 0 for one repeat.
    pub accuracy_sd: f64,
    /// Share of each emotion's gaits that were recognised, over all repeats; 0 where there are none.
    pub recall: [f64; 4],
    /// Answers over all repeats: `[emotion that people see][emotion answered]`.
    pub confusion: [[u64; 4]; 4],
    /// Share of right answers for each data set, over all repeats.
    pub by_dataset: BTreeMap<String, f64>,
}

/// Key of the person: data set and subject, so that equal subjects of two data sets are two people. Without a subject the take
/// is a person of its own, and without a take the gait.
#[doc(hidden)]
pub fn person(gait: &Gait) -> String {
    let from = &gait.provenance;
    let take = if from.take.is_empty() { &gait.name } else { &from.take };
    format!("{}/{}", from.dataset, from.subject.as_ref().unwrap_or(take))
}

/// The fold of each gait, 0 to k - 1.
///
/// # Errors
/// [`Error::Evaluation`] if there are fewer than two folds, or fewer groups than folds.
#[doc(hidden)]
pub fn folds(
    gaits: &[&Gait],
    emotions: &[Emotion],
    grouping: Grouping,
    seed: u64,
) -> Result<Vec<usize>, Error> {
    if gaits.len() != emotions.len() {
        return Err(wrong(format!("{} gaits with {} emotions", gaits.len(), emotions.len())));
    }
    let classes: Vec<usize> = emotions.iter().map(|emotion| emotion.index()).collect();
    let groups = match grouping {
        Grouping::Stratified { folds } => {
            enough(gaits.len(), folds, "gaits")?;
            return Ok(stratified(&classes, folds, seed));
        }
        Grouping::Subject { .. } => numbered(gaits.iter().map(|gait| person(gait))),
        Grouping::Dataset => numbered(gaits.iter().map(|gait| gait.provenance.dataset.clone())),
    };
    let count = groups.iter().max().map_or(0, |last| last + 1);
    match grouping {
        Grouping::Subject { folds } => {
            enough(count, folds, "people")?;
            Ok(grouped(&groups, &classes, folds, seed))
        }
        _ => {
            enough(count, 2, "data sets")?;
            Ok(groups)
        }
    }
}

/// Folds of the training gaits that novelty is measured on.
pub(super) const NOVELTY_FOLDS: usize = 10;

/// At most `most` folds of training gaits, for what is chosen or measured on them: people apart; where there is only one
/// person, gaits apart.
pub(super) fn inner_folds(gaits: &[&Gait], emotions: &[Emotion], most: usize, seed: u64) -> Vec<usize> {
    let mut numbers = BTreeMap::new();
    let people: Vec<usize> = gaits
        .iter()
        .map(|gait| {
            let next = numbers.len();
            *numbers.entry(person(gait)).or_insert(next)
        })
        .collect();
    let classes: Vec<usize> = emotions.iter().map(|emotion| emotion.index()).collect();
    if numbers.len() >= 2 {
        grouped(&people, &classes, most.min(numbers.len()), seed)
    } else {
        stratified(&classes, most.min(gaits.len()), seed)
    }
}

fn enough(found: usize, folds: usize, what: &str) -> Result<(), Error> {
    if folds < 2 {
        return Err(wrong(format!("{folds} fold(s); at least 2 are needed")));
    }
    if found < folds {
        return Err(wrong(format!(
            "{found} {what} for {folds} folds; give more gaits or ask for fewer folds"
        )));
    }
    Ok(())
}

fn wrong(message: String) -> Error {
    Error::Evaluation { message }
}

/// Names as numbers, by their order.
fn numbered(names: impl Iterator<Item = String>) -> Vec<usize> {
    let names: Vec<String> = names.collect();
    let mut distinct = names.clone();
    distinct.sort_unstable();
    distinct.dedup();
    names.iter().map(|name| distinct.binary_search(name).unwrap_or_default()).collect()
}

/// Folds with the same share of each class: every class is shuffled and dealt to the folds in turn, the next class
/// going on where the last one ended. Serves inner folds too.
#[doc(hidden)]
pub fn stratified(classes: &[usize], folds: usize, seed: u64) -> Vec<usize> {
    let mut random = Random::new(seed);
    let mut order: Vec<usize> = (0..classes.len()).collect();
    random.shuffle(&mut order);
    order.sort_by_key(|&i| classes[i]);
    let mut fold = vec![0; classes.len()];
    for (turn, i) in order.into_iter().enumerate() {
        fold[i] = turn % folds.max(1);
    }
    fold
}

/// Folds with nearly the same share of each class and no group in two of them: groups from the largest to the smallest
/// (equal ones shuffled), each to the fold that it brings closest to its share. Serves inner folds too.
#[doc(hidden)]
pub fn grouped(groups: &[usize], classes: &[usize], folds: usize, seed: u64) -> Vec<usize> {
    let folds = folds.max(1);
    let group_count = groups.iter().max().map_or(0, |last| last + 1);
    let class_count = classes.iter().max().map_or(0, |last| last + 1);
    let mut members = vec![vec![0_usize; class_count]; group_count];
    for (&group, &class) in groups.iter().zip(classes) {
        members[group][class] += 1;
    }
    let mut order: Vec<usize> = (0..group_count).collect();
    Random::new(seed).shuffle(&mut order);
    order.sort_by_key(|&group| std::cmp::Reverse(members[group].iter().sum::<usize>()));
    let mut filled = vec![vec![0_usize; class_count]; folds];
    let mut fold_of = vec![0; group_count];
    for group in order {
        // What the sum of squares over classes and folds grows by; then the emptier fold, then the first.
        let cost = |fold: usize| {
            let squares =
                members[group].iter().zip(&filled[fold]).map(|(add, has)| add * add + 2 * add * has);
            (squares.sum::<usize>(), filled[fold].iter().sum::<usize>(), fold)
        };
        let best = (0..folds).min_by_key(|&fold| cost(fold)).unwrap_or_default();
        for (has, add) in filled[best].iter_mut().zip(&members[group]) {
            *has += add;
        }
        fold_of[group] = best;
    }
    groups.iter().map(|&group| fold_of[group]).collect()
}

/// Tries a method.
///
/// # Errors
/// [`Error::Evaluation`] as [`folds`]; what the method says when it cannot learn from a fold.
pub fn evaluate(
    method: &dyn Method,
    gaits: &[&Gait],
    emotions: &[Emotion],
    plan: &Plan,
) -> Result<Evaluation, Error> {
    evaluate_with(method, gaits, emotions, plan, &|| ())
}

/// [`evaluate`], with a call after each fold of each repeat (from any thread).
///
/// # Errors
/// As [`evaluate`].
pub fn evaluate_with(
    method: &dyn Method,
    gaits: &[&Gait],
    emotions: &[Emotion],
    plan: &Plan,
    after_fold: &(dyn Fn() + Sync),
) -> Result<Evaluation, Error> {
    if plan.seeds.is_empty() {
        return Err(wrong("no seeds; give one for each repeat".to_owned()));
    }
    let parted: Result<Vec<Vec<usize>>, Error> =
        plan.seeds.iter().map(|&seed| folds(gaits, emotions, plan.grouping, seed)).collect();
    let parted = parted?;
    let jobs: Vec<(usize, usize)> = parted
        .iter()
        .enumerate()
        .flat_map(|(repeat, folds)| (0..=folds.iter().copied().max().unwrap_or(0)).map(move |f| (repeat, f)))
        .collect();
    let answers: Result<Vec<Vec<(usize, Emotion)>>, Error> = jobs
        .par_iter()
        .map(|&(repeat, fold)| {
            let found = answer(method, gaits, emotions, (&parted[repeat], fold), plan.seeds[repeat]);
            after_fold();
            found
        })
        .collect();
    let mut repeats = vec![Vec::new(); plan.seeds.len()];
    for (&(repeat, _), answers) in jobs.iter().zip(answers?) {
        repeats[repeat].extend(answers);
    }
    Ok(count(method.name(), gaits, emotions, plan, &repeats))
}

/// What a method answers for the gaits of one fold after learning from the others.
fn answer(
    method: &dyn Method,
    gaits: &[&Gait],
    emotions: &[Emotion],
    (folds, fold): (&[usize], usize),
    seed: u64,
) -> Result<Vec<(usize, Emotion)>, Error> {
    let (held, kept): (Vec<usize>, Vec<usize>) = (0..gaits.len()).partition(|&i| folds[i] == fold);
    let (kept_gaits, kept_emotions): (Vec<&Gait>, Vec<Emotion>) =
        kept.iter().map(|&i| (gaits[i], emotions[i])).unzip();
    let perceiver = method.train(&kept_gaits, &kept_emotions, seed)?;
    Ok(held.into_iter().map(|i| (i, perceiver.emotion(gaits[i]))).collect())
}

/// Counts the answers; `repeats` holds gait and answer of each repeat.
fn count(
    method: &str,
    gaits: &[&Gait],
    emotions: &[Emotion],
    plan: &Plan,
    repeats: &[Vec<(usize, Emotion)>],
) -> Evaluation {
    let mut confusion = [[0_u64; 4]; 4];
    let mut of_dataset: BTreeMap<String, [u64; 2]> = BTreeMap::new();
    let names: Vec<String> = gaits.iter().map(|gait| gait.provenance.dataset.clone()).collect();
    for &(i, emotion) in repeats.iter().flatten() {
        confusion[emotions[i].index()][emotion.index()] += 1;
        let [right, all] = of_dataset.entry(names[i].clone()).or_default();
        *right += u64::from(emotions[i] == emotion);
        *all += 1;
    }
    let accuracies: Vec<f64> = repeats
        .iter()
        .map(|answers| {
            let right = answers.iter().filter(|&&(i, emotion)| emotions[i] == emotion).count();
            share(right as u64, answers.len() as u64)
        })
        .collect();
    let repeat_count = share(accuracies.len() as u64, 1);
    let mean = accuracies.iter().sum::<f64>() / repeat_count;
    let squares: f64 = accuracies.iter().map(|a| (a - mean) * (a - mean)).sum();
    let recall = Emotion::ALL.map(|emotion| {
        let row = confusion[emotion.index()];
        share(row[emotion.index()], row.iter().sum())
    });
    Evaluation {
        method: method.to_owned(),
        grouping: plan.grouping,
        seeds: plan.seeds.clone(),
        gaits: gaits.len(),
        accuracy_mean: mean,
        accuracy_sd: if accuracies.len() > 1 { (squares / (repeat_count - 1.0)).sqrt() } else { 0.0 },
        accuracies,
        recall,
        confusion,
        by_dataset: of_dataset.into_iter().map(|(name, [right, all])| (name, share(right, all))).collect(),
    }
}

/// `part / whole`; 0 of nothing is 0.
#[allow(clippy::cast_precision_loss, reason = "counts of answers are far below 2^53")]
fn share(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

#[cfg(test)]
mod tests;

//! What was answered to each item of each scale: counts of the points, and means with intervals.

use super::common::{CONFIDENCE, DRAWS, Error, real};
use crate::random::Random;
use crate::statistics::quantile;
use crate::study::file::{Part, StudyFile, Trials};
use crate::study::plan::{Scale, prompts};
use crate::study::tables::{Answer, Tables};
use serde::Serialize;
use std::collections::BTreeMap;

/// Answers to one item after the trials of a part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ItemAnswers {
    /// The part.
    pub part: String,
    /// The item: `presence.q1`.
    pub item: String,
    /// Its statement, in the first language; empty where a licence keeps it out.
    pub text: String,
    /// Least point of the scale.
    pub least: i64,
    /// Greatest point.
    pub greatest: i64,
    /// Words for some points, in the first language.
    pub labels: Vec<(i64, String)>,
    /// Answers by scene and condition, in the order of the file; one group where neither is shown.
    pub groups: Vec<Group>,
}

/// Answers under one scene and condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// The scene, if scenes are shown.
    pub scene: Option<String>,
    /// The condition, if there is one.
    pub condition: Option<String>,
    /// Participants with an answer.
    pub people: usize,
    /// Answers by point, from the least.
    pub counts: Vec<usize>,
    /// Mean of all answers; none without one.
    pub mean: Option<f64>,
    /// 95 % interval of the mean by a bootstrap over people.
    pub interval: Option<[f64; 2]>,
}

/// Sum and number of the answers of one participant.
type Share = (i64, usize);

/// The answers to every scale after ordinary trials.
pub(super) fn answers(study: &StudyFile, tables: &Tables) -> Result<Vec<ItemAnswers>, Error> {
    let languages = &study.study.languages;
    let preferred = languages.first().map_or("", String::as_str);
    let find = |words: &crate::study::words::Words| words.find(preferred, languages).to_owned();
    let mut found = Vec::new();
    for part in &study.study.flow {
        let trials = study.parts.get(part).and_then(Part::trials).filter(|trials| trials.counted);
        let Some(trials) = trials else { continue };
        let rows: Vec<&Answer> =
            tables.answers.iter().filter(|row| row.part == *part && row.is_ordinary()).collect();
        for name in &trials.ask.0 {
            for prompt in prompts(study, name)?.into_iter().flatten() {
                let Scale::Points { least, greatest, labels } = &prompt.scale else { continue };
                let ends = (*least, *greatest);
                let own = rows.iter().filter(|row| row.question == prompt.id).copied().collect::<Vec<_>>();
                let seed = study.study.seed.wrapping_add(found.len() as u64);
                found.push(ItemAnswers {
                    part: part.clone(),
                    text: find(&prompt.text),
                    least: ends.0,
                    greatest: ends.1,
                    labels: labels.iter().map(|(point, words)| (*point, find(words))).collect(),
                    groups: groups(trials, &own, ends, seed),
                    item: prompt.id,
                });
            }
        }
    }
    Ok(found)
}

fn groups(trials: &Trials, rows: &[&Answer], ends: (i64, i64), seed: u64) -> Vec<Group> {
    let show = &trials.show;
    let names = |names: &Option<Vec<String>>| match names {
        Some(names) => names.iter().cloned().map(Some).collect(),
        None => vec![None],
    };
    let conditions = match &show.conditions {
        None => vec![show.condition.clone()],
        some => names(some),
    };
    let mut groups = Vec::new();
    for scene in names(&show.scenes) {
        for condition in &conditions {
            let fits = |row: &&&Answer| {
                let is_scene = scene.is_none() || row.shown.scene == scene;
                is_scene && (condition.is_none() || row.shown.condition == *condition)
            };
            let own: Vec<&Answer> = rows.iter().filter(fits).copied().collect();
            groups.push(group((scene.clone(), condition.clone()), &own, ends, seed));
        }
    }
    groups
}

fn group(
    (scene, condition): (Option<String>, Option<String>),
    rows: &[&Answer],
    (least, greatest): (i64, i64),
    seed: u64,
) -> Group {
    let points = usize::try_from(greatest - least + 1).unwrap_or(0);
    let mut counts = vec![0; points];
    let mut people: BTreeMap<&str, Share> = BTreeMap::new();
    for row in rows {
        let Some(value) = row.number() else { continue };
        let place = usize::try_from(value - least).ok().and_then(|index| counts.get_mut(index));
        let Some(place) = place else { continue };
        *place += 1;
        let share = people.entry(&row.participant).or_default();
        *share = (share.0 + value, share.1 + 1);
    }
    let shares: Vec<Share> = people.into_values().collect();
    let mean = mean(shares.iter().copied());
    Group {
        scene,
        condition,
        people: shares.len(),
        counts,
        mean,
        interval: mean.map(|_| interval(&shares, seed)),
    }
}

fn mean(shares: impl Iterator<Item = Share>) -> Option<f64> {
    let (sum, count) = shares.fold((0, 0), |(sum, count), one| (sum + one.0, count + one.1));
    #[allow(clippy::cast_precision_loss, reason = "sums of answers are far below 2^53")]
    (count > 0).then(|| sum as f64 / real(count))
}

/// Draws people with replacement, each with all answers; of one participant or more.
fn interval(shares: &[Share], seed: u64) -> [f64; 2] {
    let mut random = Random::new(seed);
    let mut draw = || mean((0..shares.len()).map(|_| shares[random.below(shares.len())])).unwrap_or(f64::NAN);
    let draws: Vec<f64> = (0..DRAWS).map(|_| draw()).collect();
    let outside = (1.0 - CONFIDENCE) / 2.0;
    [outside, 1.0 - outside].map(|at| quantile(&draws, at).unwrap_or(f64::NAN))
}

//! How many answered each part, against the plan.

use crate::study::file::{Design, Part, StudyFile, Trials};
use crate::study::plan::blocks::Blocks;
use crate::study::plan::square::Square;
use crate::study::tables::{Answer, Tables};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Answers of a counted part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PartCount {
    /// Name of the part.
    pub part: String,
    /// Participants with an answer to an ordinary trial.
    pub people: usize,
    /// Of them, participants that answered all of their trials.
    pub complete: usize,
    /// Answers to ordinary trials.
    pub answers: usize,
    /// Answers of each gait, where gaits are shown.
    pub gaits: Option<Gaits>,
    /// The plan's least, if it is not reached. Of a fill these are answers of each gait, of other designs complete participants.
    pub short_of: Option<usize>,
}

/// Answers of each gait. Gaits without an answer are not in the tables and do not count here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Gaits {
    /// Gaits with an answer.
    pub count: usize,
    /// Fewest answers of a gait to any of the questions.
    pub fewest: usize,
    /// Most answers of a gait to any of the questions.
    pub most: usize,
    /// Numbers of gaits by their number of answers: the fewest to any of the questions.
    pub by_answers: BTreeMap<usize, usize>,
}

/// Trials of one participant in a part, without repeated and instructed ones; none where the file alone does not tell.
fn trials_each(trials: &Trials) -> Option<usize> {
    let conditions = trials.show.conditions.as_ref().map_or(1, Vec::len);
    match (&trials.design, &trials.show.scenes, &trials.show.agents) {
        (Some(Design::Fill { each, .. }), ..) => Some(*each as usize),
        (_, Some(scenes), _) => Some(scenes.len() * conditions),
        (_, _, Some(agents)) => Some(agents.each_of.len() * agents.bodies.len()),
        _ => None,
    }
}

/// Fewest participants with whom the design of a part is complete; 1 without a design.
pub(super) fn least(trials: &Trials) -> usize {
    match (&trials.design, &trials.show.scenes) {
        (Some(Design::Blocks { .. }), Some(scenes)) => {
            let conditions = trials.show.conditions.as_ref().map_or(1, Vec::len);
            Blocks::new(scenes.len(), conditions).rows()
        }
        (Some(Design::Square), _) => trials_each(trials).map_or(1, |items| Square::new(items).rows()),
        _ => 1,
    }
}

pub(super) fn counts(study: &StudyFile, tables: &Tables) -> Vec<PartCount> {
    let counted = study.study.flow.iter().filter_map(|name| {
        let trials = study.parts.get(name).and_then(Part::trials).filter(|trials| trials.counted)?;
        Some(count(name, trials, tables))
    });
    counted.collect()
}

fn count(name: &str, trials: &Trials, tables: &Tables) -> PartCount {
    let is_ours = |row: &&Answer| row.part == name && row.is_ordinary() && row.number().is_some();
    let rows: Vec<&Answer> = tables.answers.iter().filter(is_ours).collect();
    let mut pages: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let mut gaits: BTreeMap<&str, BTreeMap<&str, usize>> = BTreeMap::new();
    for row in &rows {
        pages.entry(&row.participant).or_default().insert(&row.page);
        if let Some(gait) = &row.shown.gait {
            *gaits.entry(gait).or_default().entry(&row.question).or_default() += 1;
        }
    }
    let each = || gaits.values().flat_map(BTreeMap::values).copied();
    let mut by_answers = BTreeMap::new();
    for fewest in gaits.values().filter_map(|questions| questions.values().min()) {
        *by_answers.entry(*fewest).or_default() += 1;
    }
    let gaits = each().min().zip(each().max()).map(|(fewest, most)| Gaits {
        count: gaits.len(),
        fewest,
        most,
        by_answers,
    });
    let complete = trials_each(trials)
        .map_or(pages.len(), |each| pages.values().filter(|pages| pages.len() >= each).count());
    let (found, least) = match trials.design {
        Some(Design::Fill { at_least, .. }) => {
            (gaits.as_ref().map_or(0, |gaits| gaits.fewest), at_least as usize)
        }
        _ => (complete, least(trials)),
    };
    PartCount {
        part: name.to_owned(),
        people: pages.len(),
        complete,
        answers: rows.len(),
        gaits,
        short_of: (found < least).then_some(least),
    }
}

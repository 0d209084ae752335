//! Friedman's test of conditions, and Wilcoxon's of their pairs.

use crate::statistics::friedman::{Friedman, concordance_interval, exact_p, friedman};
use crate::statistics::wilcoxon::{self, Options, Shift, Wilcoxon, shift, wilcoxon};
use crate::statistics::{Adjustment, Description, adjust, describe};
use crate::study::error::Error;
use crate::study::file::{Adjust, FollowUp, Zeros};
use crate::study::tables::{Answer, ORDINARY};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// p below which pairs are compared.
const LEVEL: f64 = 0.05;
/// Resamples of people, and the seed of their draws.
const DRAWS: usize = 2000;
const SEED: u64 = 20_190_919;

/// What a test is of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wish<'a> {
    pub(super) of: &'a str,
    pub(super) by: &'a str,
    pub(super) within: Option<&'a str>,
    pub(super) then: Option<&'a FollowUp>,
    /// The order of what is compared, as the study file has it.
    pub(super) order: &'a [String],
}

/// A block of tests: one for each item of a question and each scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Conditions {
    /// What the study file calls it.
    pub of: String,
    /// What is compared.
    pub by: String,
    /// The conditions, in the order of the columns.
    pub levels: Vec<String>,
    /// The tests.
    pub tests: Vec<ConditionTest>,
}

/// One test of conditions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionTest {
    /// The item.
    pub item: String,
    /// The scene, if there is one test for each.
    pub within: Option<String>,
    /// Answers by condition, of participants that answered all.
    pub answers: Vec<Description>,
    /// Participants that lack an answer under some condition, and do not count.
    pub incomplete: usize,
    /// Friedman's test.
    pub friedman: Friedman,
    /// Exact p, where it can be computed.
    pub exact_p: Option<f64>,
    /// 95 % interval of Kendall's W by a bootstrap over people.
    pub w_interval: [f64; 2],
    /// p adjusted by Holm over the tests of this block.
    pub p_holm: f64,
    /// Pairs of conditions; only where p is below .05.
    pub pairs: Vec<Pair>,
}

/// Two conditions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pair {
    /// Names of the conditions.
    pub levels: [String; 2],
    /// Wilcoxon's signed ranks of the second less the first.
    pub wilcoxon: Wilcoxon,
    /// p adjusted over the pairs as the study file says.
    pub p_adjusted: f64,
    /// p adjusted over the pairs by Holm.
    pub p_holm: f64,
    /// Hodges-Lehmann estimate of the second less the first.
    pub shift: Shift,
}

/// The block of tests of a wish.
pub(super) fn conditions(answers: &[&Answer], wish: Wish<'_>) -> Result<Conditions, Error> {
    let wrong = |message: String| Error::Analysis { test: wish.of.to_owned(), message };
    let (part, question) = wish.of.split_once('.').unwrap_or((wish.of, "*"));
    let counted: Vec<&Answer> = answers
        .iter()
        .copied()
        .filter(|one| one.part == part && one.role == ORDINARY && one.value.is_some())
        .filter(|one| fits(&one.question, question))
        .collect();
    let levels: BTreeSet<&str> = counted.iter().map(|one| key(one, wish.by)).collect();
    if levels.len() < 2 {
        let message = format!("answers under {} of 2 or more needed: by = {:?}", levels.len(), wish.by);
        return Err(wrong(message));
    }
    let mut levels: Vec<String> = levels.into_iter().map(str::to_owned).collect();
    levels.sort_by_key(|level| wish.order.iter().position(|known| known == level).unwrap_or(usize::MAX));
    let mut groups: BTreeMap<(&str, Option<&str>), Vec<&Answer>> = BTreeMap::new();
    for one in &counted {
        groups.entry((&one.question, wish.within.map(|name| key(one, name)))).or_default().push(one);
    }
    let mut tests = Vec::new();
    for ((item, within), own) in groups {
        tests.push(test(&own, (item, within), &levels, wish)?);
    }
    let p: Vec<f64> = tests.iter().map(|test| test.friedman.p).collect();
    for (test, p_holm) in tests.iter_mut().zip(adjust(&p, Adjustment::Holm)?) {
        test.p_holm = p_holm;
    }
    Ok(Conditions { of: wish.of.to_owned(), by: wish.by.to_owned(), levels, tests })
}

/// Whether a question is one of `QUESTION.ITEM` or `QUESTION.*`.
fn fits(question: &str, wanted: &str) -> bool {
    let all = wanted.strip_suffix('*').map(|start| question.starts_with(start));
    all.unwrap_or(question == wanted)
}

/// What a test goes by.
fn key<'a>(answer: &'a Answer, by: &str) -> &'a str {
    if by == "scene" { &answer.scene } else { &answer.condition }
}

fn test(
    own: &[&Answer],
    (item, within): (&str, Option<&str>),
    levels: &[String],
    wish: Wish<'_>,
) -> Result<ConditionTest, Error> {
    let mut people: BTreeMap<&str, BTreeMap<&str, f64>> = BTreeMap::new();
    for one in own {
        #[allow(clippy::cast_precision_loss, reason = "points of a scale")]
        let value = one.value.unwrap_or_default() as f64;
        people.entry(&one.participant).or_default().insert(key(one, wish.by), value);
    }
    let asked = people.len();
    let whole =
        |own: &BTreeMap<&str, f64>| levels.iter().map(|level| own.get(level.as_str()).copied()).collect();
    let rows: Vec<Vec<f64>> = people.values().filter_map(whole).collect();
    let name = || format!("{} {item} {}", wish.of, within.unwrap_or_default()).trim_end().to_owned();
    if rows.is_empty() {
        let message = format!("none of {asked} participants answered under all of {}", levels.join(", "));
        return Err(Error::Analysis { test: name(), message });
    }
    let column = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<f64>>();
    let found = friedman(&rows)?;
    let pairs = match wish.then {
        Some(FollowUp::Wilcoxon { adjust, zeros }) if found.p < LEVEL => {
            pairs(&rows, levels, *adjust, *zeros)?
        }
        _ => Vec::new(),
    };
    Ok(ConditionTest {
        item: item.to_owned(),
        within: within.map(str::to_owned),
        answers: (0..levels.len()).map(|index| describe(&column(index))).collect::<Result<_, _>>()?,
        incomplete: asked - rows.len(),
        exact_p: exact_p(&rows).ok(),
        w_interval: concordance_interval(&rows, DRAWS, 0.95, SEED)?,
        p_holm: found.p,
        friedman: found,
        pairs,
    })
}

fn pairs(rows: &[Vec<f64>], levels: &[String], by: Adjust, zeros: Zeros) -> Result<Vec<Pair>, Error> {
    let zeros = match zeros {
        Zeros::Wilcoxon => wilcoxon::Zeros::Wilcoxon,
        Zeros::Pratt => wilcoxon::Zeros::Pratt,
    };
    let mut found = Vec::new();
    for (first, second) in (0..levels.len()).flat_map(|a| (a + 1..levels.len()).map(move |b| (a, b))) {
        let differences: Vec<f64> = rows.iter().map(|row| row[second] - row[first]).collect();
        let test = wilcoxon(&differences, Options { zeros, ..Options::default() })?;
        found.push(Pair {
            levels: [levels[first].clone(), levels[second].clone()],
            p_adjusted: test.p,
            p_holm: test.p,
            wilcoxon: test,
            shift: shift(&differences, 0.95)?,
        });
    }
    let p: Vec<f64> = found.iter().map(|pair| pair.wilcoxon.p).collect();
    let adjustment = match by {
        Adjust::Bonferroni => Adjustment::Bonferroni,
        Adjust::Holm => Adjustment::Holm,
    };
    for (pair, p) in found.iter_mut().zip(adjust(&p, adjustment)?) {
        pair.p_adjusted = p;
    }
    for (pair, p) in found.iter_mut().zip(adjust(&p, Adjustment::Holm)?) {
        pair.p_holm = p;
    }
    Ok(found)
}

//! The paper's published tables, and what follows from them.

mod markdown;
mod tables;

pub use markdown::markdown;
pub use tables::*;

use super::adjust::{Adjustment, adjust};
use super::confusion::{Confusion, confusion};
use super::describe::number;
use super::distribution::chi_square_sf;
use super::error::Error;
use super::power::{friedman_power, friedman_power_finite};
use serde::Serialize;

/// Everything that follows from the paper's tables.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recomputed {
    /// The 20 Friedman tests, question by question.
    pub friedman: Vec<FriedmanFact>,
    /// How many printed p follow from the printed chi-square.
    pub p_that_follow: usize,
    /// How many tests are significant at [`FRIEDMAN_LEVEL`].
    pub significant: usize,
    /// How many stay so after Holm over all 20.
    pub significant_by_holm: usize,
    /// How many stay so after Bonferroni over all 20.
    pub significant_by_bonferroni: usize,
    /// How many chi-squares no table without ties gives, if they were rounded.
    pub need_ties_if_rounded: usize,
    /// How many no table without ties gives, rounded or cut off.
    pub need_ties: usize,
    /// Number of Wilcoxon tests printed.
    pub pairs: usize,
    /// How many lie below [`WILCOXON_LEVEL`].
    pub pairs_significant: usize,
    /// How many are significant by Holm within each cell of three, at [`FRIEDMAN_LEVEL`].
    pub pairs_by_holm: usize,
    /// The pairs that Holm finds and [`WILCOXON_LEVEL`] does not.
    pub holm_adds: Vec<PairFact>,
    /// The pairs that [`WILCOXON_LEVEL`] finds and Holm does not.
    pub holm_loses: Vec<PairFact>,
    /// The confusion matrix.
    pub confusion: Confusion,
    /// Cells whose printed percentage is not the rounded share of the counts.
    pub misprinted: Vec<Misprint>,
    /// Power of Friedman's test for effects as small as those seen.
    pub power: Vec<PowerFact>,
    /// What cannot be computed.
    pub not_recoverable: Vec<&'static str>,
}

/// One Friedman test of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FriedmanFact {
    /// The question.
    pub question: &'static str,
    /// The scenario.
    pub scenario: &'static str,
    /// Chi-square as printed.
    pub chi_square: f64,
    /// p as printed.
    pub printed_p: f64,
    /// p by the chi-square distribution with two degrees of freedom.
    pub p: f64,
    /// Whether p rounds to the one printed.
    pub p_follows: bool,
    /// p after Holm over all 20 tests.
    pub p_holm: f64,
    /// Kendall's W.
    pub w: f64,
    /// Whether a table of 30 people without ties gives this chi-square, rounded to two decimals.
    pub without_ties_if_rounded: bool,
    /// The same, rounded or cut off.
    pub without_ties: bool,
}

/// One Wilcoxon test of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PairFact {
    /// The question.
    pub question: &'static str,
    /// The scenario.
    pub scenario: &'static str,
    /// The conditions.
    pub pair: &'static str,
    /// p as printed.
    pub printed_p: f64,
    /// p after Holm over the three pairs of the cell.
    pub p_holm: f64,
}

/// A percentage that is not what its counts give.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Misprint {
    /// The desired emotion.
    pub desired: &'static str,
    /// The answered emotion.
    pub answered: &'static str,
    /// Its count.
    pub count: u64,
    /// The row's sum.
    pub of: u64,
    /// The percentage printed.
    pub printed: f64,
    /// The percentage of the counts, rounded to two decimals.
    pub rounded: f64,
}

/// Power of Friedman's test with three conditions at [`FRIEDMAN_LEVEL`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PowerFact {
    /// Kendall's W.
    pub w: f64,
    /// Number of people.
    pub people: usize,
    /// Power by the noncentral chi-square distribution, the limit for small effects.
    pub power: f64,
    /// Power by the finite formula.
    pub power_finite: f64,
}

/// Recomputes what the paper's tables allow.
///
/// # Errors
/// None with the tables as they are.
pub fn recompute() -> Result<Recomputed, Error> {
    let friedman = friedman_facts()?;
    let count = |holds: &dyn Fn(&FriedmanFact) -> bool| friedman.iter().filter(|&fact| holds(fact)).count();
    let bonferroni = FRIEDMAN_LEVEL / number(friedman.len());
    let pairs = pair_facts()?;
    let by_level = |pair: &PairFact| pair.printed_p < WILCOXON_LEVEL;
    let by_holm = |pair: &PairFact| pair.p_holm <= FRIEDMAN_LEVEL;
    let chosen = |holds: &dyn Fn(&PairFact) -> bool| -> Vec<PairFact> {
        pairs.iter().filter(|&pair| holds(pair)).copied().collect()
    };
    Ok(Recomputed {
        p_that_follow: count(&|fact| fact.p_follows),
        significant: count(&|fact| fact.p < FRIEDMAN_LEVEL),
        significant_by_holm: count(&|fact| fact.p_holm < FRIEDMAN_LEVEL),
        significant_by_bonferroni: count(&|fact| fact.p < bonferroni),
        need_ties_if_rounded: count(&|fact| !fact.without_ties_if_rounded),
        need_ties: count(&|fact| !fact.without_ties),
        pairs: pairs.len(),
        pairs_significant: chosen(&by_level).len(),
        pairs_by_holm: chosen(&by_holm).len(),
        holm_adds: chosen(&|pair| by_holm(pair) && !by_level(pair)),
        holm_loses: chosen(&|pair| by_level(pair) && !by_holm(pair)),
        confusion: confusion(&CONFUSION)?,
        misprinted: misprints(),
        power: [(0.16, 24), (0.16, 30), (0.08, 24), (0.08, 30), (0.08, 48)]
            .into_iter()
            .map(|(w, people)| {
                let power = friedman_power(people, CONDITIONS, w, FRIEDMAN_LEVEL)?;
                let power_finite = friedman_power_finite(people, CONDITIONS, w, FRIEDMAN_LEVEL)?;
                Ok(PowerFact { w, people, power, power_finite })
            })
            .collect::<Result<_, Error>>()?,
        not_recoverable: NOT_RECOVERABLE.to_vec(),
        friedman,
    })
}

fn friedman_facts() -> Result<Vec<FriedmanFact>, Error> {
    let degrees = number(CONDITIONS - 1);
    let p: Vec<f64> = CHI_SQUARE.iter().flatten().map(|&x| chi_square_sf(x, degrees)).collect();
    let holm = adjust(&p, Adjustment::Holm)?;
    let possible = without_ties();
    let cells =
        QUESTIONS.iter().flat_map(|question| SCENARIOS.iter().map(move |scenario| (question, scenario)));
    let printed = CHI_SQUARE.iter().flatten().zip(FRIEDMAN_P.iter().flatten());
    let facts = cells.zip(printed).zip(p.iter().zip(holm));
    Ok(facts
        .map(|(((question, scenario), (&chi_square, &printed_p)), (&p, p_holm))| {
            let rounded = possible.iter().any(|&q| same(hundredths(q), hundredths(chi_square)));
            let cut = possible.iter().any(|&q| same((q * 100.0 + 1e-9).floor(), hundredths(chi_square)));
            FriedmanFact {
                question,
                scenario,
                chi_square,
                printed_p,
                p,
                p_follows: same(hundredths(p), hundredths(printed_p)),
                p_holm,
                w: chi_square / (number(PEOPLE) * degrees),
                without_ties_if_rounded: rounded,
                without_ties: rounded || cut,
            }
        })
        .collect())
}

/// The values of chi-square that 30 people give who rank three conditions without ties: `sum (R_j - 60)^2 / 30` with whole
/// rank sums from 30 to 90 that sum to 180.
fn without_ties() -> Vec<f64> {
    let people = i32::try_from(PEOPLE).unwrap_or(0);
    let sums = -people..=people;
    let mut found: Vec<i32> = sums
        .clone()
        .flat_map(|a| sums.clone().map(move |b| (a, b, -a - b)))
        .filter(|(_, _, c)| c.abs() <= people)
        .map(|(a, b, c)| a * a + b * b + c * c)
        .collect();
    found.sort_unstable();
    found.dedup();
    found.into_iter().map(|squares| f64::from(squares) / f64::from(people)).collect()
}

fn pair_facts() -> Result<Vec<PairFact>, Error> {
    let mut facts = Vec::new();
    for (question, row) in QUESTIONS.iter().zip(WILCOXON_P) {
        for (scenario, cell) in SCENARIOS.iter().zip(row) {
            let Some(printed) = cell else { continue };
            let holm = adjust(&printed, Adjustment::Holm)?;
            for ((pair, printed_p), p_holm) in PAIRS.iter().zip(printed).zip(holm) {
                facts.push(PairFact { question, scenario, pair, printed_p, p_holm });
            }
        }
    }
    Ok(facts)
}

fn misprints() -> Vec<Misprint> {
    let mut found = Vec::new();
    for (desired, (counts, percents)) in EMOTIONS.iter().zip(CONFUSION.iter().zip(CONFUSION_PERCENT)) {
        let of: u64 = counts.iter().sum();
        for (answered, (&count, printed)) in EMOTIONS.iter().zip(counts.iter().zip(percents)) {
            let percent = 100.0 * super::kappa::real(count) / super::kappa::real(of);
            if !same(hundredths(percent), hundredths(printed)) {
                let rounded = hundredths(percent) / 100.0;
                found.push(Misprint { desired, answered, count, of, printed, rounded });
            }
        }
    }
    found
}

/// A number as whole hundredths.
fn hundredths(value: f64) -> f64 {
    (value * 100.0).round()
}

/// Whether two whole numbers are one.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 0.5
}

//! Friedman's test of conditions that the same people judged, with Kendall's W.
//!
//! `Q = [12 / (n k (k + 1)) sum R_j^2 - 3 n (k + 1)] / [1 - sum (t^3 - t) / (n k (k^2 - 1))]` with n people, k conditions,
//! rank sums `R_j` of mid-ranks and groups of t equal answers in a row. `W = Q / (n (k - 1))`.
//!
//! Based on: Friedman 1937, JASA 32; Kendall and Babington Smith 1939, Annals of Mathematical Statistics 10 (W); Hollander
//! and Wolfe 1999, 7.1 (ties); Efron and Tibshirani 1993 (percentile interval). The exact test conditions on the ties of
//! each row, as van de Wiel 2004 does.

use super::describe::{number, percentile_interval};
use super::distribution::chi_square_sf;
use super::error::{Error, at_least, columns, inside_unit};
use super::ranks::ranks;
use crate::random::Random;
use serde::Serialize;

/// Most steps of the exact test: sums of ranks times orders of a row, over all rows. They take about a second. Three conditions
/// stay below with 300 people, four with 50.
pub const MOST_STEPS: usize = 50_000_000;

/// Result of Friedman's test.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Friedman {
    /// Number of people: rows.
    pub people: usize,
    /// Number of conditions: columns.
    pub conditions: usize,
    /// Q, corrected for ties; 0 where every row is one tie.
    pub chi_square: f64,
    /// Degrees of freedom of Q.
    pub degrees: usize,
    /// P of a Q at least as great under the null hypothesis, by the chi-square distribution.
    pub p: f64,
    /// Kendall's W in [0, 1]; 0 where every row is one tie.
    pub w: f64,
    /// Mean mid-rank of each condition; their mean is (k + 1) / 2.
    pub mean_ranks: Vec<f64>,
    /// Number of rows whose answers are all equal. Such a row tells nothing of the conditions.
    pub tied_rows: usize,
}

/// Doubled mid-ranks of each row with the ties of each row.
struct Table {
    doubled: Vec<Vec<u64>>,
    ties: Vec<u64>,
    columns: usize,
}

impl Table {
    fn new<R: AsRef<[f64]>>(rows: &[R]) -> Result<Self, Error> {
        let columns = columns("answers", rows)?;
        at_least("people", rows.len(), 1)?;
        at_least("conditions", columns, 2)?;
        let ranked: Result<Vec<_>, Error> = rows.iter().map(|row| ranks(row.as_ref())).collect();
        let (doubled, ties) = ranked?.into_iter().map(|row| (row.doubled, row.ties)).unzip();
        Ok(Self { doubled, ties, columns })
    }

    /// Q of the rows with these indices. With D the doubled rank sums less their mean,
    /// `Q = 3 (k - 1) sum D^2 / (n k (k^2 - 1) - sum (t^3 - t))`: whole numbers up to the division.
    fn chi_square(&self, chosen: impl Iterator<Item = usize> + Clone) -> f64 {
        let k = self.columns as u64;
        let rows = chosen.clone().count() as u64;
        let mut sums = vec![0; self.columns];
        for row in chosen.clone() {
            for (sum, rank) in sums.iter_mut().zip(&self.doubled[row]) {
                *sum += rank;
            }
        }
        let spread = rows * k * (k * k - 1) - chosen.map(|row| self.ties[row]).sum::<u64>();
        if spread == 0 { 0.0 } else { 3.0 * real(k - 1) * real(squares(&sums)) / real(spread) }
    }
}

/// Sum of squared distances of the doubled rank sums from their mean.
fn squares(sums: &[u64]) -> u64 {
    let mean = sums.iter().sum::<u64>() / sums.len() as u64;
    sums.iter().map(|&sum| sum.abs_diff(mean).pow(2)).sum()
}

/// Friedman's test of `[person][condition]`, any numbers of which only the order within a person counts.
///
/// # Errors
/// No people, fewer than two conditions, rows of different lengths, a number that is not finite.
pub fn friedman<R: AsRef<[f64]>>(rows: &[R]) -> Result<Friedman, Error> {
    let table = Table::new(rows)?;
    let (n, k) = (number(rows.len()), number(table.columns));
    let chi_square = table.chi_square(0..rows.len());
    let full = (table.columns as u64).pow(3) - table.columns as u64;
    let mean_rank = |j: usize| real(table.doubled.iter().map(|row| row[j]).sum()) / (2.0 * n);
    Ok(Friedman {
        people: rows.len(),
        conditions: table.columns,
        chi_square,
        degrees: table.columns - 1,
        p: chi_square_sf(chi_square, k - 1.0),
        w: chi_square / (n * (k - 1.0)),
        mean_ranks: (0..table.columns).map(mean_rank).collect(),
        tied_rows: table.ties.iter().filter(|&&ties| ties == full).count(),
    })
}

/// Percentile interval of Kendall's W: people are drawn with replacement, `draws` times.
///
/// W of a sample exceeds that of the population, the more the fewer people: by about `(1 - W) / n`. So does the interval.
///
/// # Errors
/// As [`friedman`]; no draws; a level outside (0, 1).
pub fn concordance_interval<R: AsRef<[f64]>>(
    rows: &[R],
    draws: usize,
    level: f64,
    seed: u64,
) -> Result<[f64; 2], Error> {
    inside_unit("level", level)?;
    at_least("draws", draws, 1)?;
    let table = Table::new(rows)?;
    let scale = number(rows.len()) * number(table.columns - 1);
    let mut random = Random::new(seed);
    let found = (0..draws).map(|_| {
        let chosen: Vec<usize> = rows.iter().map(|_| random.below(rows.len())).collect();
        table.chi_square(chosen.into_iter()) / scale
    });
    Ok(percentile_interval(found.collect(), level))
}

/// Exact p of Friedman's test for up to four conditions: the share of all orders of each row's mid-ranks whose Q is at least
/// the one found. Rows that are one tie change nothing.
///
/// A dynamic programme over the doubled rank sums. Conditions are exchangeable, so sums are kept sorted.
///
/// # Errors
/// As [`friedman`]; more than four conditions; more than [`MOST_STEPS`] steps.
pub fn exact_p<R: AsRef<[f64]>>(rows: &[R]) -> Result<f64, Error> {
    let table = Table::new(rows)?;
    if table.columns > 4 {
        return Err(Error::TooMany { what: "conditions of the exact test", found: table.columns, most: 4 });
    }
    if rows.len() > usize::from(u16::MAX) / 8 {
        return Err(Error::TooMany {
            what: "people of the exact test",
            found: rows.len(),
            most: usize::from(u16::MAX) / 8,
        });
    }
    let mut sums = [0; 4];
    for row in &table.doubled {
        for (sum, rank) in sums.iter_mut().zip(row) {
            *sum += rank;
        }
    }
    let found = squares(&sums[..table.columns]);
    let mut states = vec![(0_u64, 1.0_f64)];
    let mut steps = 0;
    for row in &table.doubled {
        let orders = orders(row);
        steps += states.len() * orders.len();
        if steps > MOST_STEPS {
            return Err(Error::TooMany { what: "steps of the exact test", found: steps, most: MOST_STEPS });
        }
        states = advance(&states, &orders, table.columns);
    }
    let extreme = states.iter().filter(|&&(key, _)| squares(&unpack(key)[..table.columns]) >= found);
    Ok(extreme.map(|&(_, chance)| chance).sum::<f64>().min(1.0))
}

/// The states after one more row: sums of doubled ranks, sorted and packed, with their chances.
fn advance(states: &[(u64, f64)], orders: &[[u64; 4]], columns: usize) -> Vec<(u64, f64)> {
    let share = 1.0 / number(orders.len());
    let mut next = Vec::with_capacity(states.len() * orders.len());
    for &(key, chance) in states {
        let sums = unpack(key);
        for order in orders {
            let mut sums: [u64; 4] = std::array::from_fn(|j| sums[j] + order[j]);
            sums[..columns].sort_unstable();
            next.push((sums.iter().rev().fold(0, |key, sum| key << 16 | sum), chance * share));
        }
    }
    next.sort_unstable_by_key(|&(key, _)| key);
    next.dedup_by(|later, kept| {
        let same = later.0 == kept.0;
        if same {
            kept.1 += later.1;
        }
        same
    });
    next
}

fn unpack(key: u64) -> [u64; 4] {
    std::array::from_fn(|j| key >> (16 * j) & 0xffff)
}

/// The distinct orders of up to four ranks; each stands for equally many of all orders.
fn orders(ranks: &[u64]) -> Vec<[u64; 4]> {
    let mut found = vec![[0; 4]];
    let mut used = vec![vec![false; ranks.len()]];
    for place in 0..ranks.len() {
        let (before, taken) = (std::mem::take(&mut found), std::mem::take(&mut used));
        for (order, taken) in before.iter().zip(&taken) {
            for (i, &rank) in ranks.iter().enumerate().filter(|&(i, _)| !taken[i]) {
                let mut order = *order;
                order[place] = rank;
                let mut taken = taken.clone();
                taken[i] = true;
                found.push(order);
                used.push(taken);
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

#[allow(clippy::cast_precision_loss, reason = "sums of ranks are far below 2^53")]
const fn real(count: u64) -> f64 {
    count as f64
}

//! The two-class problem, solved by sequential minimal optimisation.
//!
//! Maximise `sum a - 1/2 sum_ij a_i a_j y_i y_j K_ij` with `0 <= a_i <= C_i` and `sum a_i y_i = 0`. With
//! `e_i = y_i - sum_j a_j y_j K_ij` (target less decision without bias) a pair (i, j) may be improved by moving
//! `a_i y_i` up and `a_j y_j` down by one amount, if both bounds allow it and `e_i > e_j`. The first is the one with
//! the largest e; the second promises the largest gain by second-order information (Fan, Chen, Lin 2005, WSS 2).

use super::{count_f64, similarity};
use std::collections::VecDeque;

/// Curvature below this counts as this: two points at one place.
const LEAST_CURVATURE: f64 = 1e-12;
/// Bytes of kernel rows that are kept.
const CACHE_BYTES: usize = 256 << 20;
/// Steps after which the solution is taken as it is, at least and for each point.
const MOST_STEPS: (usize, usize) = (10_000_000, 100);

/// Points on two sides.
pub(super) struct Task<'a> {
    pub(super) points: Vec<&'a [f64]>,
    /// Whether the point is on the positive side.
    pub(super) sides: Vec<bool>,
    /// Upper bound of each dual variable.
    pub(super) bounds: Vec<f64>,
    /// Of the RBF kernel; none for the linear one.
    pub(super) gamma: Option<f64>,
}

/// Support vectors with their coefficients `a_i y_i`, and the bias: decision `sum coefficient * K + bias`.
pub(super) struct Solution {
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) bias: f64,
}

impl Task<'_> {
    /// The part of the task with these points.
    pub(super) fn part(&self, chosen: &[usize]) -> Self {
        Self {
            points: chosen.iter().map(|&i| self.points[i]).collect(),
            sides: chosen.iter().map(|&i| self.sides[i]).collect(),
            bounds: chosen.iter().map(|&i| self.bounds[i]).collect(),
            gamma: self.gamma,
        }
    }

    /// Decision value of a point.
    pub(super) fn decision(&self, solution: &Solution, point: &[f64]) -> f64 {
        let term = |&(i, weight): &(usize, f64)| weight * similarity(self.gamma, self.points[i], point);
        solution.terms.iter().map(term).sum::<f64>() + solution.bias
    }
}

/// Rows of the kernel matrix, computed when first needed; the oldest are forgotten when there are too many.
struct Rows<'a> {
    task: &'a Task<'a>,
    rows: Vec<Option<Box<[f64]>>>,
    kept: VecDeque<usize>,
    most: usize,
}

impl<'a> Rows<'a> {
    fn new(task: &'a Task<'a>, bytes: usize) -> Self {
        let count = task.points.len();
        let most = (bytes / (8 * count.max(1))).max(2);
        Self { task, rows: vec![None; count], kept: VecDeque::new(), most }
    }

    /// Makes sure that row `i` is there, without forgetting row `held`.
    fn need(&mut self, i: usize, held: usize) {
        if self.rows[i].is_some() {
            return;
        }
        if self.kept.len() >= self.most
            && let Some(place) = self.kept.iter().position(|&kept| kept != held)
            && let Some(oldest) = self.kept.remove(place)
        {
            self.rows[oldest] = None;
        }
        let point = self.task.points[i];
        let row = self.task.points.iter().map(|other| similarity(self.task.gamma, point, other)).collect();
        self.rows[i] = Some(row);
        self.kept.push_back(i);
    }

    fn row(&self, i: usize) -> &[f64] {
        self.rows[i].as_deref().unwrap_or_default()
    }
}

/// Solves the task; points of one side alone give a decision of +1 or -1 everywhere.
pub(super) fn solve(task: &Task<'_>, tolerance: f64) -> Solution {
    solve_within(task, tolerance, CACHE_BYTES)
}

/// [`solve`] with a cache of so many bytes (two rows at least); its size does not change the result.
pub(super) fn solve_within(task: &Task<'_>, tolerance: f64, cache_bytes: usize) -> Solution {
    let count = task.points.len();
    if let Some(&side) = task.sides.first()
        && task.sides.iter().all(|&other| other == side)
    {
        return Solution { terms: Vec::new(), bias: if side { 1.0 } else { -1.0 } };
    }
    let mut rows = Rows::new(task, cache_bytes);
    let diagonal: Vec<f64> = task.points.iter().map(|p| similarity(task.gamma, p, p)).collect();
    // signed dual variables a_i y_i live in [low, high]
    let (low, high): (Vec<f64>, Vec<f64>) = task
        .sides
        .iter()
        .zip(&task.bounds)
        .map(|(&side, &c)| if side { (0.0, c) } else { (-c, 0.0) })
        .unzip();
    let mut dual = vec![0.0; count];
    let mut error: Vec<f64> = task.sides.iter().map(|&side| if side { 1.0 } else { -1.0 }).collect();
    let most = MOST_STEPS.0.max(count.saturating_mul(MOST_STEPS.1));
    for _ in 0..most {
        let Some((i, j)) = pair(&mut rows, &diagonal, &dual, &error, (&low, &high), tolerance) else { break };
        rows.need(j, i);
        let (row_i, row_j) = (rows.row(i), rows.row(j));
        let curvature = (diagonal[i] + diagonal[j] - 2.0 * row_i[j]).max(LEAST_CURVATURE);
        let (room_i, room_j) = (high[i] - dual[i], dual[j] - low[j]);
        let step = ((error[i] - error[j]) / curvature).min(room_i).min(room_j);
        // a variable that reaches its bound gets exactly the bound
        dual[i] = if step >= room_i { high[i] } else { dual[i] + step };
        dual[j] = if step >= room_j { low[j] } else { dual[j] - step };
        for ((error, a), b) in error.iter_mut().zip(row_i).zip(row_j) {
            *error -= step * (a - b);
        }
    }
    let bias = bias(&dual, &error, &low, &high);
    let terms = dual.iter().copied().enumerate().filter(|&(_, weight)| weight != 0.0).collect();
    Solution { terms, bias }
}

/// The pair to improve; none when no pair violates the optimality conditions by the tolerance.
fn pair(
    rows: &mut Rows<'_>,
    diagonal: &[f64],
    dual: &[f64],
    error: &[f64],
    (low, high): (&[f64], &[f64]),
    tolerance: f64,
) -> Option<(usize, usize)> {
    let first = (0..dual.len())
        .filter(|&i| dual[i] < high[i])
        .reduce(|best, i| if error[i] > error[best] { i } else { best })?;
    rows.need(first, first);
    let row = rows.row(first);
    let (mut second, mut most_gain, mut least) = (None, 0.0, f64::INFINITY);
    for j in (0..dual.len()).filter(|&j| dual[j] > low[j]) {
        least = least.min(error[j]);
        let violation = error[first] - error[j];
        if violation > 0.0 {
            let curvature = (diagonal[first] + diagonal[j] - 2.0 * row[j]).max(LEAST_CURVATURE);
            let gain = violation * violation / curvature;
            if gain > most_gain {
                (second, most_gain) = (Some(j), gain);
            }
        }
    }
    (error[first] - least >= tolerance).then_some(())?;
    second.map(|second| (first, second))
}

/// The bias: mean of what the free variables ask for; without any, the middle of what the bounds leave.
fn bias(dual: &[f64], error: &[f64], low: &[f64], high: &[f64]) -> f64 {
    let free: Vec<f64> =
        (0..dual.len()).filter(|&i| dual[i] > low[i] && dual[i] < high[i]).map(|i| error[i]).collect();
    if !free.is_empty() {
        return free.iter().sum::<f64>() / count_f64(free.len());
    }
    let above =
        (0..dual.len()).filter(|&i| dual[i] < high[i]).map(|i| error[i]).fold(f64::NEG_INFINITY, f64::max);
    let below = (0..dual.len()).filter(|&i| dual[i] > low[i]).map(|i| error[i]).fold(f64::INFINITY, f64::min);
    f64::midpoint(above, below)
}

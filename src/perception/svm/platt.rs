//! From decision values to probabilities.
//!
//! A sigmoid is fitted to the decision values of held-out points (five inner folds), with Platt's targets, by Newton's
//! method with backtracking on the convex likelihood (Lin, Lin, Weng 2007). Pairwise probabilities are brought
//! together by the second method of Wu, Lin, Weng 2004: the p with least `sum_i sum_j (r_ji p_i - r_ij p_j)^2`.

use super::count_f64;
use super::smo::{Solution, Task, solve};

/// Inner folds.
const FOLDS: usize = 5;
/// Steps of Newton's method.
const STEPS: usize = 100;
/// Pairwise probabilities are kept this far from 0 and 1.
const LEAST: f64 = 1e-7;

/// The sigmoid of a two-class machine, from decision values of points that were held out.
///
/// A side with fewer than two points cannot be held out: then those of the whole solution are taken.
pub(super) fn calibrate(task: &Task<'_>, solution: &Solution, tolerance: f64) -> [f64; 2] {
    let count = task.points.len();
    // Every side is dealt to the folds in turn, so each fold has its share of both; the order is that of the points.
    let mut dealt = [0_usize; 2];
    let folds: Vec<usize> = task
        .sides
        .iter()
        .map(|&side| {
            let turn = &mut dealt[usize::from(side)];
            *turn += 1;
            (*turn - 1) % FOLDS
        })
        .collect();
    let mut decisions = vec![0.0; count];
    if dealt.iter().any(|&side| side < 2) {
        for (decision, point) in decisions.iter_mut().zip(&task.points) {
            *decision = task.decision(solution, point);
        }
        return fit(&decisions, &task.sides);
    }
    for fold in 0..FOLDS {
        let (held, kept): (Vec<usize>, Vec<usize>) = (0..count).partition(|&i| folds[i] == fold);
        let part = task.part(&kept);
        let solution = solve(&part, tolerance);
        for i in held {
            decisions[i] = part.decision(&solution, task.points[i]);
        }
    }
    fit(&decisions, &task.sides)
}

/// Fits `p = 1 / (1 + exp(a f + b))` to decision values and sides.
pub(super) fn fit(decisions: &[f64], sides: &[bool]) -> [f64; 2] {
    let positive = count_f64(sides.iter().filter(|&&side| side).count());
    let negative = count_f64(sides.len()) - positive;
    let (high, low) = ((positive + 1.0) / (positive + 2.0), 1.0 / (negative + 2.0));
    let targets: Vec<f64> = sides.iter().map(|&side| if side { high } else { low }).collect();
    let loss = |[a, b]: [f64; 2]| -> f64 {
        let terms = decisions.iter().zip(&targets).map(|(f, t)| {
            let z = a * f + b;
            // -t ln p - (1 - t) ln(1 - p) without overflow on either side
            if z >= 0.0 { t * z + (-z).exp().ln_1p() } else { (t - 1.0) * z + z.exp().ln_1p() }
        });
        terms.sum()
    };
    let mut sigmoid = [0.0, ((negative + 1.0) / (positive + 1.0)).ln()];
    let mut value = loss(sigmoid);
    for _ in 0..STEPS {
        // a little on the diagonal keeps the system solvable
        let (mut gradient, mut hessian) = ([0.0; 2], [1e-12, 0.0, 1e-12]);
        for (&f, t) in decisions.iter().zip(&targets) {
            let p = probability(sigmoid, f);
            let (slope, curve) = (t - p, p * (1.0 - p));
            gradient = [gradient[0] + f * slope, gradient[1] + slope];
            hessian = [hessian[0] + f * f * curve, hessian[1] + f * curve, hessian[2] + curve];
        }
        if gradient.iter().all(|g| g.abs() < 1e-9) {
            break;
        }
        let determinant = hessian[0] * hessian[2] - hessian[1] * hessian[1];
        let direction = [
            (hessian[1] * gradient[1] - hessian[2] * gradient[0]) / determinant,
            (hessian[1] * gradient[0] - hessian[0] * gradient[1]) / determinant,
        ];
        let slope = gradient[0] * direction[0] + gradient[1] * direction[1];
        let mut step = 1.0;
        let next = loop {
            let next = [sigmoid[0] + step * direction[0], sigmoid[1] + step * direction[1]];
            if loss(next) < value + 1e-4 * step * slope {
                break Some(next);
            }
            step *= 0.5;
            if step < 1e-10 {
                break None;
            }
        };
        let Some(next) = next else { break };
        (sigmoid, value) = (next, loss(next));
    }
    sigmoid
}

/// Probability of the positive side for a decision value.
pub(super) fn probability([a, b]: [f64; 2], decision: f64) -> f64 {
    let z = a * decision + b;
    if z >= 0.0 { (-z).exp() / (1.0 + (-z).exp()) } else { 1.0 / (1.0 + z.exp()) }
}

/// Probabilities of `count` classes from those of the pairs (0, 1), (0, 2), ... (1, 2), ..., each of the first.
pub(super) fn couple(count: usize, pairwise: &[f64]) -> Vec<f64> {
    let mut r = vec![vec![0.0; count]; count];
    for ((a, b), &p) in super::pairs(count).zip(pairwise) {
        let p = p.clamp(LEAST, 1.0 - LEAST);
        (r[a][b], r[b][a]) = (p, 1.0 - p);
    }
    // least p'Qp with sum p = 1: Q_ii = sum_j r_ji^2, Q_ij = -r_ji r_ij; (Q, 1; 1', 0) (p; m) = (0; 1)
    let size = count + 1;
    let mut system = vec![vec![0.0; size + 1]; size];
    for i in 0..count {
        for j in (0..count).filter(|&j| j != i) {
            system[i][i] += r[j][i] * r[j][i];
            system[i][j] = -r[j][i] * r[i][j];
        }
        (system[i][count], system[count][i]) = (1.0, 1.0);
    }
    system[count][size] = 1.0;
    let mut p = eliminate(system);
    p.truncate(count);
    // the minimum is inside the simplex; rounding may leave it by a hair
    let p: Vec<f64> = p.iter().map(|p| p.max(0.0)).collect();
    let sum: f64 = p.iter().sum();
    p.iter().map(|p| p / sum).collect()
}

/// Solves a linear system, given with its right side as last column, by elimination with pivoting.
fn eliminate(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let size = rows.len();
    for column in 0..size {
        let pivot = (column..size)
            .reduce(|best, i| if rows[i][column].abs() > rows[best][column].abs() { i } else { best })
            .unwrap_or(column);
        rows.swap(column, pivot);
        let (upper, lower) = rows.split_at_mut(column + 1);
        let Some(top) = upper.last() else { continue };
        for row in lower {
            let factor = row[column] / top[column];
            for (value, top) in row.iter_mut().zip(top).skip(column) {
                *value -= factor * top;
            }
        }
    }
    let mut solution = vec![0.0; size];
    for i in (0..size).rev() {
        let known: f64 = (i + 1..size).map(|j| rows[i][j] * solution[j]).sum();
        solution[i] = (rows[i][size] - known) / rows[i][i];
    }
    solution
}

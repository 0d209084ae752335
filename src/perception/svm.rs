//! Support vector machines for any number of classes, in f64, deterministic.
//!
//! Plain points in (`&[Vec<f64>]`, all of one length, usually scaled to [-1, 1]), class numbers in (`&[usize]`, any
//! values), a machine out that gives the class of a point, its distance to the nearest other class, and
//! (as an option) probabilities. Paper: section 3.5; S-14, A-08.
//!
//! Based on: Fan, Chen, Lin 2005 (working set by second-order information, `smo.rs`); Platt 1999 with the Newton
//! iteration of Lin, Lin, Weng 2007, and pairwise coupling by Wu, Lin, Weng 2004 (`platt.rs`); C and gamma by
//! search on inner folds (`search.rs`). Decision values equal libsvm's to the tolerance of the solution.

mod numbers;
mod platt;
mod search;
mod smo;

pub use search::{Found, Grid, search};

use numbers::{count_f64, distinct, pairs, similarity};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Similarity of two points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// Dot product.
    Linear,
    /// `exp(-gamma |a - b|^2)`.
    Rbf(Gamma),
}

/// Width of the RBF kernel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Gamma {
    /// 1 over the number of features: what `auto` was in 2019.
    Auto,
    /// 1 over the number of features times the variance of all numbers of the training points.
    Scale,
    /// This value, above 0.
    Value(f64),
}

impl Gamma {
    /// The value for these training points; 1 over the number of features where they do not vary.
    pub fn value(self, points: &[Vec<f64>]) -> f64 {
        let features = count_f64(points.first().map_or(1, Vec::len).max(1));
        match self {
            Self::Value(value) => value,
            Self::Auto => 1.0 / features,
            Self::Scale => {
                let count = count_f64(points.iter().map(Vec::len).sum::<usize>().max(1));
                let mean = points.iter().flatten().sum::<f64>() / count;
                let variance = points.iter().flatten().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
                1.0 / (features * if variance > 0.0 { variance } else { 1.0 })
            }
        }
    }
}

/// How two-class machines make one of many classes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// One machine for each pair of classes; they vote, of equal ones the first class wins (libsvm, the likely original).
    OneVersusOne,
    /// One machine for each class against all others; the largest decision value wins.
    OneVersusRest,
}

/// What is to be trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Bound of the dual variables, above 0: the price of a training point on the wrong side.
    pub c: f64,
    /// Similarity of two points.
    pub kernel: Kernel,
    /// How two-class machines make one of many classes.
    pub scheme: Scheme,
    /// Whether C is divided among the classes by their sizes: `c * count / (classes * count of the class)`.
    pub is_balanced: bool,
    /// Whether [`Svm::probabilities`] is wanted; it costs five more solutions for each machine.
    pub has_probabilities: bool,
    /// Largest violation of the optimality conditions that is left.
    pub tolerance: f64,
}

impl Default for Settings {
    /// C = 1, RBF with gamma `auto`, one-versus-one, without probabilities, tolerance 1e-6.
    fn default() -> Self {
        Self {
            c: 1.0,
            kernel: Kernel::Rbf(Gamma::Auto),
            scheme: Scheme::OneVersusOne,
            is_balanced: false,
            has_probabilities: false,
            tolerance: 1e-6,
        }
    }
}

impl Settings {
    /// Words for a report, such as `ovo, C 1, gamma auto`.
    pub fn describe(&self) -> String {
        let scheme = match self.scheme {
            Scheme::OneVersusOne => "ovo",
            Scheme::OneVersusRest => "ovr",
        };
        let kernel = match self.kernel {
            Kernel::Linear => "linear".to_owned(),
            Kernel::Rbf(Gamma::Auto) => "gamma auto".to_owned(),
            Kernel::Rbf(Gamma::Scale) => "gamma scale".to_owned(),
            Kernel::Rbf(Gamma::Value(gamma)) => format!("gamma {gamma}"),
        };
        let balanced = if self.is_balanced { ", balanced" } else { "" };
        format!("{scheme}, C {}, {kernel}{balanced}", self.c)
    }
}

/// A trained machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Svm {
    scheme: Scheme,
    /// Value of gamma; none for the linear kernel.
    gamma: Option<f64>,
    /// Class numbers, ascending.
    classes: Vec<usize>,
    /// The training points that any machine needs.
    vectors: Vec<Vec<f64>>,
    /// One-versus-one: by pair (0, 1), (0, 2), ... (1, 2), ...; one-versus-rest: by class.
    machines: Vec<Machine>,
}

/// A machine of two classes: positive on the side of the first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Machine {
    /// Support vector and its coefficient.
    terms: Vec<(usize, f64)>,
    bias: f64,
    /// `p = 1 / (1 + exp(a f + b))` for decision value f.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sigmoid: Option<[f64; 2]>,
}

/// What a machine says of one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The class.
    pub class: usize,
    /// How far the point is on the side of its class, as a decision value: one-versus-one, the smallest of the class's
    /// decisions against each other one; one-versus-rest, largest decision less the second largest. Negative where
    /// voting went against a pair.
    pub margin: f64,
}

/// What is given cannot be learned from: the value found and what is allowed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Untrainable(pub(super) String);

impl From<Untrainable> for String {
    fn from(error: Untrainable) -> Self {
        error.0
    }
}

impl Svm {
    /// Trains on points with their classes.
    ///
    /// # Errors
    /// If the points are not of one length and finite, their number is not that of the classes, there are
    /// fewer than two classes, or a setting is out of its range.
    pub fn train(points: &[Vec<f64>], classes: &[usize], settings: &Settings) -> Result<Self, Untrainable> {
        check(points, classes, settings)?;
        let gamma = match settings.kernel {
            Kernel::Linear => None,
            Kernel::Rbf(gamma) => Some(gamma.value(points)),
        };
        let names = distinct(classes);
        // of each machine: its training points and their sides
        let tasks: Vec<(Vec<usize>, Vec<bool>)> = match settings.scheme {
            Scheme::OneVersusOne => pairs(names.len())
                .map(|(a, b)| {
                    let chosen: Vec<usize> =
                        (0..classes.len()).filter(|&i| [names[a], names[b]].contains(&classes[i])).collect();
                    let sides = chosen.iter().map(|&i| classes[i] == names[a]).collect();
                    (chosen, sides)
                })
                .collect(),
            Scheme::OneVersusRest => names
                .iter()
                .map(|name| ((0..classes.len()).collect(), classes.iter().map(|c| c == name).collect()))
                .collect(),
        };
        let bound = |i: usize| {
            if !settings.is_balanced {
                return settings.c;
            }
            let same = classes.iter().filter(|&&c| c == classes[i]).count();
            settings.c * count_f64(classes.len()) / (count_f64(names.len()) * count_f64(same))
        };
        let bounds: Vec<f64> = (0..classes.len()).map(bound).collect();
        let machines: Vec<Machine> = tasks
            .par_iter()
            .map(|(chosen, sides)| {
                let task = smo::Task {
                    points: chosen.iter().map(|&i| points[i].as_slice()).collect(),
                    sides: sides.clone(),
                    bounds: chosen.iter().map(|&i| bounds[i]).collect(),
                    gamma,
                };
                let solution = smo::solve(&task, settings.tolerance);
                let sigmoid = settings
                    .has_probabilities
                    .then(|| platt::calibrate(&task, &solution, settings.tolerance));
                let terms = solution.terms.iter().map(|&(i, weight)| (chosen[i], weight)).collect();
                Machine { terms, bias: solution.bias, sigmoid }
            })
            .collect();
        Ok(Self::gather(points, names, gamma, settings.scheme, machines))
    }

    /// Keeps the points that are support vectors of any machine; `machines` refer to `points`.
    fn gather(
        points: &[Vec<f64>],
        classes: Vec<usize>,
        gamma: Option<f64>,
        scheme: Scheme,
        mut machines: Vec<Machine>,
    ) -> Self {
        let mut place = vec![usize::MAX; points.len()];
        for &(i, _) in machines.iter().flat_map(|machine| &machine.terms) {
            place[i] = 0;
        }
        let mut vectors = Vec::new();
        for (point, place) in points.iter().zip(&mut place).filter(|(_, place)| **place == 0) {
            *place = vectors.len();
            vectors.push(point.clone());
        }
        for (i, _) in machines.iter_mut().flat_map(|machine| &mut machine.terms) {
            *i = place[*i];
        }
        Self { scheme, gamma, classes, vectors, machines }
    }

    /// The class numbers that it knows, ascending; the order of [`Svm::probabilities`].
    pub fn classes(&self) -> &[usize] {
        &self.classes
    }

    /// Value of gamma; none for the linear kernel.
    pub fn gamma(&self) -> Option<f64> {
        self.gamma
    }

    /// Number of support vectors, over all machines.
    pub fn support_count(&self) -> usize {
        self.vectors.len()
    }

    /// Length of the points that it was trained on.
    pub fn feature_count(&self) -> usize {
        self.vectors.first().map_or(0, Vec::len)
    }

    /// Decision values of the machines: one-versus-one by pair of classes (0, 1), (0, 2), ... (1, 2), ..., positive on
    /// the side of the first; one-versus-rest by class. What a point lacks in length counts as 0.
    pub fn decisions(&self, point: &[f64]) -> Vec<f64> {
        let similar: Vec<f64> =
            self.vectors.iter().map(|vector| similarity(self.gamma, vector, point)).collect();
        let value = |machine: &Machine| {
            machine.terms.iter().map(|&(i, weight)| weight * similar[i]).sum::<f64>() + machine.bias
        };
        self.machines.iter().map(value).collect()
    }

    /// The class of a point and its margin.
    pub fn verdict(&self, point: &[f64]) -> Verdict {
        self.verdict_of(&self.decisions(point))
    }

    /// The class and margin that follow from [`Svm::decisions`].
    pub fn verdict_of(&self, decisions: &[f64]) -> Verdict {
        let count = self.classes.len();
        let scores: Vec<f64> = match self.scheme {
            Scheme::OneVersusRest => decisions.to_vec(),
            Scheme::OneVersusOne => {
                let mut votes = vec![0.0; count];
                for ((a, b), &decision) in pairs(count).zip(decisions) {
                    votes[if decision > 0.0 { a } else { b }] += 1.0;
                }
                votes
            }
        };
        let best = (1..count).fold(0, |best, i| if scores[i] > scores[best] { i } else { best });
        let margin = match self.scheme {
            Scheme::OneVersusRest => {
                let second = (0..count).filter(|&i| i != best).map(|i| decisions[i]);
                decisions[best] - second.fold(f64::NEG_INFINITY, f64::max)
            }
            Scheme::OneVersusOne => pairs(count)
                .zip(decisions)
                .filter(|((a, b), _)| [*a, *b].contains(&best))
                .map(|((a, _), &decision)| if a == best { decision } else { -decision })
                .fold(f64::INFINITY, f64::min),
        };
        Verdict { class: self.classes[best], margin }
    }

    /// The class of a point.
    pub fn predict(&self, point: &[f64]) -> usize {
        self.verdict(point).class
    }

    /// Probability of each of [`Svm::classes`]; they add up to 1. None unless trained with probabilities.
    ///
    /// The most probable class need not be [`Svm::predict`]: it comes from fitted sigmoids, not from votes.
    pub fn probabilities(&self, point: &[f64]) -> Option<Vec<f64>> {
        self.probabilities_of(&self.decisions(point))
    }

    /// The probabilities that follow from [`Svm::decisions`].
    pub fn probabilities_of(&self, decisions: &[f64]) -> Option<Vec<f64>> {
        let sides: Option<Vec<f64>> = self
            .machines
            .iter()
            .zip(decisions)
            .map(|(machine, &decision)| machine.sigmoid.map(|sigmoid| platt::probability(sigmoid, decision)))
            .collect();
        let sides = sides?;
        Some(match self.scheme {
            Scheme::OneVersusOne => platt::couple(self.classes.len(), &sides),
            Scheme::OneVersusRest => {
                let sum: f64 = sides.iter().sum();
                sides.iter().map(|p| p / sum).collect()
            }
        })
    }

    /// Says what is wrong with a machine that was read from a file.
    ///
    /// # Errors
    /// A message with the value and what was expected.
    pub(crate) fn validate(&self) -> Result<(), String> {
        let count = self.classes.len();
        if count < 2 || !self.classes.is_sorted_by(|a, b| a < b) {
            return Err(format!("its classes are {:?}; expected two or more, ascending", self.classes));
        }
        let machines = match self.scheme {
            Scheme::OneVersusOne => count * (count - 1) / 2,
            Scheme::OneVersusRest => count,
        };
        if self.machines.len() != machines {
            return Err(format!("{} machines for {count} classes; expected {machines}", self.machines.len()));
        }
        let length = self.feature_count();
        if let Some(vector) =
            self.vectors.iter().find(|v| v.len() != length || !v.iter().all(|x| x.is_finite()))
        {
            return Err(format!(
                "a support vector of {} numbers; all must have {length} finite ones",
                vector.len()
            ));
        }
        if self.gamma.is_some_and(|gamma| !(gamma > 0.0 && gamma.is_finite())) {
            return Err(format!("gamma is {:?}; it must be above 0", self.gamma));
        }
        for machine in &self.machines {
            let is_sound =
                machine.terms.iter().all(|(i, weight)| *i < self.vectors.len() && weight.is_finite());
            let numbers = machine.sigmoid.into_iter().flatten().chain([machine.bias]);
            if !is_sound || !numbers.into_iter().all(f64::is_finite) {
                return Err(format!(
                    "a machine refers to a support vector that is not among the {}, or holds a number that is not finite",
                    self.vectors.len()
                ));
            }
        }
        Ok(())
    }
}

fn check(points: &[Vec<f64>], classes: &[usize], settings: &Settings) -> Result<(), Untrainable> {
    check_points(points, classes, settings).map_err(Untrainable)
}

fn check_points(points: &[Vec<f64>], classes: &[usize], settings: &Settings) -> Result<(), String> {
    if points.len() != classes.len() {
        return Err(format!("{} points with {} classes; each point needs one", points.len(), classes.len()));
    }
    let length = points.first().map_or(0, Vec::len);
    if let Some(i) = points.iter().position(|p| p.len() != length || !p.iter().all(|x| x.is_finite())) {
        let found = points[i].len();
        return Err(format!("point {i} has {found} numbers; all must have {length} finite ones"));
    }
    let names = distinct(classes);
    if names.len() < 2 {
        return Err(format!(
            "{} points of {} class(es); at least two classes are needed",
            points.len(),
            names.len()
        ));
    }
    let gamma = match settings.kernel {
        Kernel::Rbf(Gamma::Value(gamma)) => gamma,
        _ => 1.0,
    };
    for (name, value) in [("C", settings.c), ("gamma", gamma), ("tolerance", settings.tolerance)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(format!("{name} is {value}; it must be above 0"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;

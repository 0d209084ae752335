//! Distributions: chi-square (central and noncentral), normal, beta, binomial, F and Student's.
//!
//! Survival functions keep their relative precision deep in the tail: 1e-12 down to 1e-300. Degrees of freedom need not be
//! whole. Outside the domain of a distribution the result is NaN.

mod beta;
mod gamma;
mod normal;

pub use beta::{
    beta_cdf, beta_sf, binomial_at_least, binomial_at_most, binomial_pmf, f_quantile, f_sf, student_cdf,
    student_quantile, student_sf,
};
pub use normal::{normal_cdf, normal_quantile, normal_sf};

/// P(X > x) of the chi-square distribution with `df` degrees of freedom; NaN unless `df` exceeds 0.
pub fn chi_square_sf(x: f64, df: f64) -> f64 {
    if df > 0.0 && !x.is_nan() { gamma::upper(df / 2.0, x / 2.0) } else { f64::NAN }
}

/// P(X <= x) of the chi-square distribution with `df` degrees of freedom; NaN unless `df` exceeds 0.
pub fn chi_square_cdf(x: f64, df: f64) -> f64 {
    if df > 0.0 && !x.is_nan() { gamma::lower(df / 2.0, x / 2.0) } else { f64::NAN }
}

/// The x with P(X > x) = `upper`, `upper` in (0, 1); NaN otherwise.
pub fn chi_square_quantile(upper: f64, df: f64) -> f64 {
    solve(upper, |x| chi_square_sf(x, df))
}

/// P(X > x) of the noncentral chi-square distribution: `df` degrees of freedom, noncentrality `lambda`.
///
/// A Poisson mixture of central distributions: `sum_j exp(-l/2) (l/2)^j / j! Q(df/2 + j, x/2)`, Patnaik 1949. NaN unless
/// `df` exceeds 0 and `lambda` is finite and at least 0.
pub fn noncentral_chi_square_sf(x: f64, df: f64, lambda: f64) -> f64 {
    mixture(df, lambda, |a| gamma::upper(a, x / 2.0))
}

/// P(X <= x) of the noncentral chi-square distribution, as [`noncentral_chi_square_sf`].
pub fn noncentral_chi_square_cdf(x: f64, df: f64, lambda: f64) -> f64 {
    mixture(df, lambda, |a| gamma::lower(a, x / 2.0))
}

/// Sums the parts of a Poisson mixture until the weights left cannot change the sum.
fn mixture(df: f64, lambda: f64, part: impl Fn(f64) -> f64) -> f64 {
    if !(df > 0.0 && lambda >= 0.0 && lambda.is_finite()) {
        return f64::NAN;
    }
    let (mean, half) = (lambda / 2.0, df / 2.0);
    if mean <= 0.0 {
        return part(half);
    }
    let (mut sum, mut j) = (0.0, 0.0);
    loop {
        let weight = if j > 0.0 { gamma::front(j, mean) } else { libm::exp(-mean) };
        sum += weight * part(half + j);
        // beyond twice the mean the weights left sum to less than twice this one, and no part exceeds 1
        if j > 2.0 * mean && weight <= 1e-17 * sum || j > 2.0 * mean + 2000.0 {
            return sum;
        }
        j += 1.0;
    }
}

/// The x of at least 0 at which a falling function has the value `upper`, by halving the set of floating-point numbers:
/// 64 steps to neighbours. NaN for `upper` outside (0, 1), or where the function is NaN.
fn solve(upper: f64, survival: impl Fn(f64) -> f64) -> f64 {
    if !(upper > 0.0 && upper < 1.0) || survival(1.0).is_nan() {
        return f64::NAN;
    }
    let (mut low, mut high) = (0_u64, f64::MAX.to_bits());
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if survival(f64::from_bits(middle)) > upper {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::from_bits(high)
}

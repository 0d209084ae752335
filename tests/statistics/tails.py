"""Distributions by mpmath with 60 digits, for yardsticks.py."""

import itertools

import mpmath
import numpy as np
from scipy import stats

mpmath.mp.dps = 60


def short(value):
    """Numbers to 15 digits, which keeps the table small."""
    if isinstance(value, float):
        return float(f"{value:.15g}")
    return [short(part) for part in value] if isinstance(value, (list, tuple)) else value


def mixture(x, df, noncentrality, lower):
    """The noncentral chi-square distribution as a Poisson mixture."""
    x, half, mean = mpmath.mpf(x) / 2, mpmath.mpf(df) / 2, mpmath.mpf(noncentrality) / 2
    total, weight, j = mpmath.mpf(0), mpmath.exp(-mean), 0
    while j < 40 or j < 3 * mean or weight > total * mpmath.mpf(10) ** -30:
        part = mpmath.gammainc(half + j, 0, x) if lower else mpmath.gammainc(half + j, x)
        total += weight * part / mpmath.gamma(half + j)
        j += 1
        weight *= mean / j
    return total


def upper_gamma(a, x):
    return mpmath.gammainc(a, x) / mpmath.gamma(a)


def lower_gamma(a, x):
    return mpmath.gammainc(a, 0, x) / mpmath.gamma(a)


def beta(a, b, low, high):
    """The regularised incomplete beta function; the substitution keeps mpmath's series in its range."""
    a, b = mpmath.mpf(a), mpmath.mpf(b)
    return mpmath.betainc(a, b, low, high, regularized=True)


def distributions():
    m = mpmath.mpf
    found, differs = [], {}

    def add(name, arguments, truth, scipy):
        truth = float(truth)
        if abs(truth) < 1e-300:
            return
        found.append([name, *arguments, truth])
        difference = abs(float(scipy) / truth - 1)
        differs[name] = max(differs.get(name, 0), difference if np.isfinite(difference) else 1e300)

    for df in [0.5, 1, 2, 3, 4, 7.5, 19, 60, 200, 1000, 10000]:
        for at in [0.01, 0.3, 0.8, 1, 1.2, 2, 5, 20]:
            x = short(float(at * df))
            add("chi2_sf", (x, df), upper_gamma(m(df) / 2, m(x) / 2), stats.chi2.sf(x, df))
            add("chi2_cdf", (x, df), lower_gamma(m(df) / 2, m(x) / 2), stats.chi2.cdf(x, df))
        for x in [100.0, 500.0, 1200.0, 1360.0]:
            add("chi2_sf", (x, df), upper_gamma(m(df) / 2, m(x) / 2), stats.chi2.sf(x, df))
    for df, noncentrality in itertools.product([1, 2, 3, 7.5, 20], [0.1, 1, 4.8, 30, 200]):
        for x in [0.1, 2.0, 5.99146454710798, 20.0, 100.0, 400.0, 900.0]:
            add("ncx2_sf", (x, df, noncentrality), mixture(x, df, noncentrality, False),
                stats.ncx2.sf(x, df, noncentrality))
            add("ncx2_cdf", (x, df, noncentrality), mixture(x, df, noncentrality, True),
                stats.ncx2.cdf(x, df, noncentrality))
    for z in [-10, -3.3, -1, -0.1, 0, 0.4, 1.95996398454005, 3, 6, 10, 20, 30, 37]:
        add("norm_sf", (z,), mpmath.erfc(m(z) / mpmath.sqrt(2)) / 2, stats.norm.sf(z))
    for p in [1e-300, 1e-100, 1e-20, 1e-6, 0.001, 0.02425, 0.1, 0.25, 0.4, 0.49, 0.501, 0.6, 0.75, 0.9, 0.999999]:
        z = mpmath.findroot(lambda z: mpmath.log(mpmath.erfc(-z / mpmath.sqrt(2)) / 2) - mpmath.log(m(p)),
                            float(stats.norm.ppf(p)))
        add("norm_ppf", (p,), z, stats.norm.ppf(p))
    for n, p in itertools.product([1, 8, 48, 192, 1000], [0.01, 0.25, 0.5, 0.9]):
        terms = [mpmath.binomial(n, i) * m(p) ** i * (1 - m(p)) ** (n - i) for i in range(n + 1)]
        for k in sorted({0, 1, n // 4, n // 2, n // 2 + 1, int(0.71 * n), n - 1, n}):
            add("binom_at_least", (k, n, p), mpmath.fsum(terms[k:]), stats.binom.sf(k - 1, n, p))
            add("binom_at_most", (k, n, p), mpmath.fsum(terms[: k + 1]), stats.binom.cdf(k, n, p))
    for a, b in itertools.product([0.5, 1, 2.5, 10, 40], [0.5, 1, 3, 25]):
        for x in [1e-6, 0.01, 0.3, 0.5, 0.77, 0.99]:
            add("beta_cdf", (x, a, b), beta(a, b, 0, m(x)), stats.beta.cdf(x, a, b))
            add("beta_sf", (x, a, b), beta(b, a, 0, 1 - m(x)), stats.beta.sf(x, a, b))
    for above, below in itertools.product([1, 2, 5, 29, 100], [1, 4, 17.3, 58, 300]):
        for x in [0.01, 0.5, 1, 3, 20, 1000]:
            share = m(below) / (m(below) + m(above) * m(x))
            add("f_sf", (x, above, below), beta(m(below) / 2, m(above) / 2, 0, share), stats.f.sf(x, above, below))
        for p in [1e-6, 0.025, 0.5, 0.975]:
            add("f_isf", (p, above, below), f_quantile(p, above, below), stats.f.isf(p, above, below))
    for df in [1, 2, 4.5, 29, 400]:
        for t in [-2, 0.1, 1, 2.045, 6, 30, 1000]:
            half = beta(m(df) / 2, m(1) / 2, 0, m(df) / (m(df) + m(t) ** 2)) / 2
            add("t_sf", (t, df), 1 - half if t < 0 else half, stats.t.sf(t, df))
        for p in [1e-9, 0.025, 0.3, 0.6, 0.975]:
            add("t_ppf", (p, df), t_quantile(p, df), stats.t.ppf(p, df))
    return found, differs


def f_quantile(p, above, below):
    """By Newton's method in the logarithm, from scipy's quantile."""
    m = mpmath.mpf

    def survival(log):
        share = m(below) / (m(below) + m(above) * mpmath.exp(log))
        return beta(m(below) / 2, m(above) / 2, 0, share) - m(p)

    return mpmath.exp(mpmath.findroot(survival, mpmath.log(m(float(stats.f.isf(p, above, below))))))


def t_quantile(p, df):
    m = mpmath.mpf
    tail = min(m(p), 1 - m(p))

    def survival(t):
        return beta(m(df) / 2, m(1) / 2, 0, m(df) / (m(df) + t**2)) / 2 - tail

    found = mpmath.findroot(survival, abs(float(stats.t.ppf(p, df))))
    return -found if p < 0.5 else found

"""Writes yardsticks.json: random tables with what published implementations make of them.

    pip install numpy==2.4.6 scipy==1.17.1 statsmodels==0.15.0 pingouin==0.7.0 krippendorff==0.9.0 mpmath==1.4.1
    python yardsticks.py > yardsticks.json

Where a yardstick is known to be wrong or rounds, another takes its place:

- scipy's exact Wilcoxon test assumes ranks without ties and zeros. Such data get all signs of up to 10 ranks enumerated, or
  counted in whole numbers beyond. Data without ties and zeros keep scipy's p (up to 50 differences).
- scipy's Wilcoxon test of zeros alone is NaN. Such data are left out; the Rust tests state what is returned.
- scipy's Friedman test is NaN where every row is one tie, and is left out likewise.
- pingouin rounds Feldt's interval to three decimals. The interval is computed by its formula with scipy's F distribution.
- pingouin rounds intervals of ICC to two decimals unless told not to, as here.
- scipy's z of a two-sided Wilcoxon test is never positive, whichever side is greater.
- scipy loses digits in some tails: its noncentral chi-square distribution by up to 1.5 % in the lower tail, its F quantile from the
  eleventh digit. Distributions are computed by mpmath with 60 digits; `scipy_differs` notes scipy's largest relative difference.
"""

import itertools
import json
import sys
import warnings
from fractions import Fraction
from importlib.metadata import version

import krippendorff
import numpy as np
import pandas as pd
import pingouin
from scipy import stats
from statsmodels.stats.inter_rater import cohens_kappa
from statsmodels.stats.multitest import multipletests
from statsmodels.stats.proportion import proportion_confint

from tails import distributions, short

pingouin.options["round.column.CI95"] = None
warnings.filterwarnings("ignore", category=RuntimeWarning)
random = np.random.default_rng(20190919)


def digits(table):
    """Rows of one-digit answers as one text."""
    return "".join(str(int(value)) for value in np.ravel(table))


def likert(shape, points, shift=None):
    """Answers 1 to points of a latent normal variable, with many ties."""
    latent = random.normal(size=shape) + (0 if shift is None else shift)
    return np.clip(np.rint((points + 1) / 2 + latent * points / 5), 1, points).astype(int)


def friedman():
    found = []
    while len(found) < 500:
        n, k = int(random.integers(2, 61)), int(random.integers(3, 7))
        points = int(random.choice([2, 5, 7, 9]))
        table = likert((n, k), points, random.normal(size=k) * random.choice([0, 0.3, 1.0]))
        result = stats.friedmanchisquare(*table.T)
        if np.isfinite(result.statistic):
            found.append([k, digits(table), float(result.statistic), float(result.pvalue)])
    return found


def friedman_exact():
    """p by enumerating the orders of all rows, in whole numbers."""
    found = []
    for k, people, count in [(3, 4, 25), (3, 5, 15), (3, 6, 5), (4, 2, 20), (4, 3, 15), (2, 9, 5)]:
        for _ in range(count):
            table = likert((people, k), int(random.choice([3, 5, 7])), random.normal(size=k))
            ranks = [[int(2 * rank) for rank in stats.rankdata(row)] for row in table]

            def spread(rows):
                sums = [sum(column) for column in zip(*rows)]
                return sum((k * value - sum(sums)) ** 2 for value in sums)

            least = spread(ranks)
            orders = [list(itertools.permutations(row)) for row in ranks]
            extreme = total = 0
            for rows in itertools.product(*orders):
                extreme += spread(rows) >= least
                total += 1
            found.append([k, digits(table), extreme / total])
    return found


def tails(p_less, p_greater, alternative):
    if alternative == "less":
        return p_less
    return p_greater if alternative == "greater" else min(1, 2 * min(p_less, p_greater))


def exact_wilcoxon(d, zeros, alternative):
    """Exact p given the ranks, and how it was found."""
    d = d[d != 0] if zeros == "wilcox" else d
    ranks = (2 * stats.rankdata(abs(d))).astype(int)[d != 0]
    signs = d[d != 0] > 0
    plain = len(set(ranks)) == len(ranks) == len(d)
    if plain and len(d) <= 50:
        return float(stats.wilcoxon(d, alternative=alternative, method="exact").pvalue), "scipy"
    found = int(ranks[signs].sum())
    if len(ranks) <= 10:
        how = "enumeration"
        sums = {}
        for chosen in itertools.product([0, 1], repeat=len(ranks)):
            total = sum(rank for rank, one in zip(ranks.tolist(), chosen) if one)
            sums[total] = sums.get(total, 0) + 1
    else:
        how = "counting"
        sums = {0: 1}
        for rank in ranks.tolist():
            later = dict(sums)
            for total, count in sums.items():
                later[total + rank] = later.get(total + rank, 0) + count
            sums = later
    less = sum(count for total, count in sums.items() if total <= found)
    greater = sum(count for total, count in sums.items() if total >= found)
    every = 2 ** len(ranks)
    return float(tails(Fraction(less, every), Fraction(greater, every), alternative)), how


def wilcoxon():
    found = []
    modes = list(itertools.product(["wilcox", "pratt", "zsplit"], [False, True]))
    while len(found) < 500:
        i = len(found)
        n = int(random.integers(1, 11) if i % 3 == 0 else random.integers(5, 61))
        if i % 5 == 4:
            d = random.permutation(np.arange(1, n + 1)) * random.choice([-1, 1], size=n)
        else:
            points = int(random.choice([3, 5, 7]))
            d = likert(n, points, random.normal() * 0.5) - likert(n, points)
        if not d.any():
            continue
        alternative = ["two-sided", "less", "greater"][i % 3 if i % 2 else 0]
        normal = []
        for zeros, correction in modes:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = stats.wilcoxon(d, zero_method=zeros, correction=correction, alternative=alternative,
                                        method="asymptotic")
            normal.append(float(result.pvalue))
            if not correction:
                normal.append(float(result.zstatistic))
        exact = [exact_wilcoxon(d, zeros, alternative) for zeros in ["wilcox", "pratt", "zsplit"]]
        found.append([d.tolist(), alternative, normal, [p for p, _ in exact], [how for _, how in exact]])
    return found


def shifts():
    """Hodges-Lehmann estimates, with intervals by the exact distribution of the signed-rank statistic."""
    found = []
    for _ in range(100):
        n = int(random.integers(1, 41))
        d = likert(n, 7, random.normal()) - likert(n, 7)
        level = float(random.choice([0.9, 0.95, 0.99]))
        averages = sorted((d[i] + d[j]) / 2 for i in range(n) for j in range(i, n))
        sums = {0: 1}
        for rank in range(1, n + 1):
            later = dict(sums)
            for total, count in sums.items():
                later[total + rank] = later.get(total + rank, 0) + count
            sums = later
        outside, below = -1, 0
        while Fraction(below + sums[outside + 1], 2**n) <= (1 - Fraction(str(level))) / 2:
            outside += 1
            below += sums[outside]
        outside = max(outside, 0)
        missed = Fraction(sum(sums[total] for total in range(outside + 1)), 2**n)
        found.append([d.tolist(), level, float(np.median(averages)), float(averages[outside]),
                      float(averages[-1 - outside]), float(1 - 2 * missed)])
    return found


def adjustments():
    found = []
    for _ in range(50):
        p = np.round(random.beta(0.4, 2, size=int(random.integers(1, 21))), 4)
        found.append([p.tolist()] + [multipletests(p, method=method)[1].tolist()
                                     for method in ["bonferroni", "holm", "fdr_bh"]])
    return found


def shares():
    wilson, binomial = [], []
    for _ in range(80):
        n = int(random.integers(1, 500))
        x, level = int(random.integers(0, n + 1)), float(random.choice([0.9, 0.95, 0.99]))
        wilson.append([x, n, level] + [float(end) for end in proportion_confint(x, n, 1 - level, "wilson")])
        chance = float(random.choice([0.25, 0.3333, 0.5, 0.9]))
        binomial.append([x, n, chance] + [float(stats.binomtest(x, n, chance, alternative).pvalue)
                                          for alternative in ["two-sided", "less", "greater"]])
    return wilson, binomial


def kappas():
    found = []
    for _ in range(60):
        k = int(random.integers(2, 8))
        table = random.poisson(random.choice([1, 5, 20]), size=(k, k)) + np.diag(random.poisson(15, size=k))
        row = [table.tolist()]
        for weights in [None, "linear", "quadratic"]:
            result = cohens_kappa(table, wt=weights)
            row += [float(result.kappa), float(result.std_kappa)]
        found.append(row)
    return found


def reliability():
    found = []
    for _ in range(60):
        n, k = int(random.integers(3, 21)), int(random.integers(2, 7))
        rows = likert((n, k), 9, random.normal(size=(n, 1)) + 0.5 * random.normal(size=k))
        data = pd.DataFrame([(i, j, float(rows[i, j])) for i in range(n) for j in range(k)],
                            columns=["target", "rater", "value"])
        icc = pingouin.intraclass_corr(data, "target", "rater", "value")
        models = [[float(icc["ICC"][i]), *map(float, icc["CI95"][i])] for i in range(6)]
        tests = [[float(icc["F"][i]), float(icc["pval"][i])] for i in (0, 2)]
        alpha, rounded = pingouin.cronbach_alpha(pd.DataFrame(rows))
        feldt = [1 - (1 - alpha) * stats.f.isf(tail, n - 1, (n - 1) * (k - 1)) for tail in (0.025, 0.975)]
        assert np.allclose(feldt, rounded, atol=6e-4)
        found.append([k, digits(rows), models, tests, [float(alpha), *map(float, feldt)]])
    return found


def alphas():
    """Krippendorff's alpha of answers 1 to 5, 0 where a rater gave none."""
    found = []
    for _ in range(60):
        raters, units = int(random.integers(2, 7)), int(random.integers(3, 25))
        rows = likert((raters, units), 5, random.normal(size=units))
        rows[random.random(rows.shape) < random.choice([0, 0.2, 0.4])] = 0
        data = np.where(rows == 0, np.nan, rows)
        paired = [set(column[column > 0]) for column in rows.T if (column > 0).sum() > 1]
        if len(set().union(*paired)) < 2:
            continue
        found.append([raters, digits(rows)] + [
            float(krippendorff.alpha(data, value_domain=[1, 2, 3, 4, 5], level_of_measurement=metric))
            for metric in ["nominal", "ordinal", "interval"]])
    return found


def descriptions():
    found = []
    for _ in range(20):
        values = np.round(random.normal(size=int(random.integers(2, 15))), 2)
        found.append([values.tolist(), float(values.mean()), float(values.std(ddof=1)),
                      *map(float, np.percentile(values, [25, 50, 75, 5, 97.5]))])
    return found


def main():
    wilson, binomial = shares()
    table, differs = distributions()
    tables = {
        "versions": {name: version(name) for name in
                     ["numpy", "scipy", "statsmodels", "pingouin", "krippendorff", "mpmath"]},
        "friedman": friedman(),
        "friedman_exact": friedman_exact(),
        "wilcoxon": wilcoxon(),
        "shifts": shifts(),
        "adjustments": adjustments(),
        "wilson": wilson,
        "binomial": binomial,
        "kappas": kappas(),
        "reliability": reliability(),
        "alphas": alphas(),
        "descriptions": descriptions(),
        "distributions": table,
        "scipy_differs": differs,
    }
    parts = []
    for name, value in tables.items():
        if isinstance(value, dict):
            parts.append(f"{json.dumps(name)}: {json.dumps(value)}")
        else:
            rows = ",\n".join(json.dumps(short(row), separators=(",", ":")) for row in value)
            parts.append(f"{json.dumps(name)}: [\n{rows}\n]")
    sys.stdout.write("{" + ",\n".join(parts) + "}\n")


if __name__ == "__main__":
    main()

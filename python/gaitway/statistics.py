"""The tests of the paper's studies. Each agrees with a published implementation: docs/statistics.md names it."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _gaitway


def _numbers(values: ArrayLike) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=np.float64)


def friedman(answers: ArrayLike) -> dict[str, Any]:
    """Friedman's test: do conditions differ? ``answers`` is ``(people, conditions)``.

    Keys: ``people``, ``conditions``, ``chi_square``, ``degrees``, ``p``, ``w`` (Kendall), ``mean_ranks``, ``tied_rows``,
    ``exact_p``.
    """
    found, exact = _gaitway.friedman(_numbers(answers))
    return {**json.loads(found), "exact_p": exact}


def wilcoxon(differences: ArrayLike) -> dict[str, Any]:
    """Wilcoxon's signed-rank test of paired ``differences`` ``(pairs,)``, two-sided.

    Keys: ``pairs``, ``zeros``, ``ranked``, ``w_plus``, ``w_minus``, ``z``, ``p``, ``exact``, ``r``, ``rank_biserial``.
    """
    return json.loads(_gaitway.wilcoxon(_numbers(differences)))


def icc(ratings: ArrayLike, level: float = 0.95) -> dict[str, Any]:
    """Intraclass correlations of Shrout and Fleiss of ``ratings`` ``(targets, raters)``, with intervals of this level.

    Keys: ``targets``, ``raters``, and the models ``one_way``, ``agreement`` and ``consistency``, each with ``single``,
    ``single_interval``, ``mean``, ``mean_interval``, ``f``, ``degrees``, ``p``. An infinite number is ``None``.
    """
    return json.loads(_gaitway.icc(_numbers(ratings), level))


def describe(values: ArrayLike) -> dict[str, Any]:
    """``count``, ``mean``, ``deviation``, ``least``, ``quartiles`` (type 7) and ``greatest`` of ``values`` ``(count,)``."""
    return json.loads(_gaitway.describe(_numbers(values)))


def adjust(p: ArrayLike, method: str = "holm") -> np.ndarray:
    """Adjusted p values ``(tests,)``: ``"bonferroni"``, ``"holm"`` or ``"benjamini-hochberg"``."""
    return np.asarray(_gaitway.adjust(_numbers(p), method))

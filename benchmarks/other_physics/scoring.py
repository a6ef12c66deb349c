"""Figures of the verdict on loops of known truth: over all, by family, and whether the draw gives the truth away.

    AUC                 chance that a loop that sticks is more probable than a sound one; 0.5 where nothing is said
    found               share of the sticky loops above the probability that 2 % of the sound ones exceed
    called, alarms      shares of the sticky and of the sound loops called "stiction"
    cleared             share of the sticky loops called "no stiction"
    calibration error   mean over ten bins of |share sticky - mean probability|, of all that were given one
    by chance           the same for probabilities that are right, from so few loops: no less can be seen

Valves that have dead travel without a jump ("play") or never move ("stands") are counted apart: they are neither.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.calibration.scoring import auc, calibration_error

Row = Mapping[str, Any]
FAMILIES = ("law", "process", "driver", "positioner", "form", "compressed")
LEAK = 0.05  # of AUC from one half
ALARMS = 0.02
SURE = 0.99  # probability that a word without one stands for
FEW = 20  # loops of either kind below which a family has no figure


def probabilities(rows: Sequence[Row], name: str = "p") -> npt.NDArray[np.float64]:
    """What was said of each loop [-]; a word without a probability is sure, a refusal says one half."""
    found = [row.get(name) if row.get(name) is not None else _of_word(row["word"]) for row in rows]
    return np.array([min(max(float(p), 0.0), 1.0) for p in found])


def _of_word(word: str) -> float:
    return SURE if word == "stiction" else 1.0 - SURE if word == "no_stiction" else 0.5


def figures(rows: Sequence[Row], name: str = "p") -> dict[str, float | None]:
    """The figures of these rows, by the probability ``name``."""
    of = [row for row in rows if row["kind"] in ("sticks", "sound")]
    sticks = np.array([row["kind"] == "sticks" for row in of])
    if sticks.sum() < FEW or (~sticks).sum() < FEW:
        return {}
    p = probabilities(of, name)
    judged = np.array([row.get(name) is not None for row in of])
    limit = float(np.quantile(p[~sticks], 1.0 - ALARMS))
    word = np.array([row["word"] for row in of])
    wrong = [
        abs(row["S_told"] / row["S"] - 1.0)
        for row in of if row["kind"] == "sticks" and row["word"] == "stiction" and row["S_told"]
    ]  # fmt: skip
    return {
        "loops": float(len(of)),
        "auc": auc(p, sticks),
        "found": float(np.mean(p[sticks] > limit)),
        "called": float(np.mean(word[sticks] == "stiction")),
        "alarms": float(np.mean(word[~sticks] == "stiction")),
        "cleared": float(np.mean(word[sticks] == "no_stiction")),
        "cleared_sound": float(np.mean(word[~sticks] == "no_stiction")),
        "calibration_error": calibration_error(p[judged], sticks[judged]) if judged.any() else None,
        "by_chance": by_chance(p[judged]) if judged.any() else None,
        "S_error": float(np.median(wrong)) if wrong else None,
    }


def by_chance(p: npt.NDArray[np.float64], draws: int = 100) -> float:
    """The calibration error that probabilities (n,) have on the mean where each is right.

    >>> round(by_chance(np.full(10_000, 0.5)), 3), round(by_chance(np.full(25, 0.5)), 2)
    (0.004, 0.09)
    """
    rng = np.random.default_rng(0)
    return float(np.mean([calibration_error(p, rng.random(len(p)) < p) for _ in range(draws)]))


def by_family(rows: Sequence[Row], name: str = "p") -> dict[str, dict[str, float | None]]:
    """The figures of each family that has enough loops of both kinds; of a law against all sound loops of that law."""
    found = {}
    for family in FAMILIES:
        for word in sorted({str(row[family]) for row in rows}):
            one = figures([row for row in rows if str(row[family]) == word], name)
            if one:
                found[f"{family} {word}"] = one
    return found


def leaks(drawn: Sequence[Mapping[str, float | str | bool]], sticks: npt.NDArray[np.bool_]) -> dict[str, float]:
    """AUC of every attribute alone, and of every word of one, for telling which loops stick.

    >>> leaks([{"a": 1.0}, {"a": 0.0}], np.array([True, False]))
    {'a': 1.0}
    """
    found: dict[str, float] = {}
    for name in drawn[0]:
        values = [one[name] for one in drawn]
        if isinstance(values[0], str):
            for word in sorted({str(value) for value in values}):
                found[f"{name} {word}"] = auc(np.array([float(value == word) for value in values]), sticks)
        else:
            found[name] = auc(np.array([float(value) for value in values]), sticks)
    return {name: value for name, value in found.items() if math.isfinite(value)}

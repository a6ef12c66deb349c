"""How the verdicts of many methods become one word: a vote with weights, and a margin that the winner needs.

    A = sum of the accusation weights of the methods that say "stiction"
    B = sum of the acquittal weights of the methods that say "no_stiction"

    stiction       if A > 0 and A >= margin B
    no_stiction    if B > 0 and B >= margin A
    inconclusive   if neither, and a method could look at the record
    not_applicable if no method could

A method that cannot tell or does not apply adds to neither sum.  The weights are data (``WEIGHTS``): 1 for every
method until it is calibrated; a method that often accuses wrongly gets a small accusation weight and may keep its
acquittal weight.  ``diagnose(record, combine=...)`` takes any other function from verdicts to a word.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from stickslip.detect.verdict import Verdict, Word

__all__ = ["WEIGHTS", "Combine", "Weight", "WeightedVote"]

Combine: TypeAlias = Callable[[Iterable[Verdict]], Word]


@dataclass(frozen=True)
class Weight:
    """The weight of one method's vote: ``accuse`` when it says stiction, ``acquit`` when it says no stiction [-].

    Raises ValueError for a weight that is negative or not finite.
    """

    accuse: float = 1.0
    acquit: float = 1.0

    def __post_init__(self) -> None:
        for name, value in (("accuse", self.accuse), ("acquit", self.acquit)):
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"{name} = {value!r}; a weight is a finite number, 0 or more")


WEIGHTS: Mapping[str, Weight] = {}
"""Weights by name of the method; one that is not listed has weight 1 on both sides."""


@dataclass(frozen=True)
class WeightedVote:
    """The rule of the module.

    weights : mapping of method name to Weight
    margin : float
        How many times the other side the winner must weigh [-]. Ours: with 3, two against one stay open and three
        against one decide.

    Raises ValueError unless margin is above 1.

    >>> said = lambda word, n: [Verdict("x", word, 1.0, 1.0, "Seen so.")] * n
    >>> WeightedVote()(said("stiction", 19) + said("no_stiction", 1))
    'stiction'
    >>> WeightedVote()(said("stiction", 2) + said("no_stiction", 1))
    'inconclusive'
    """

    weights: Mapping[str, Weight] = field(default_factory=lambda: WEIGHTS)
    margin: float = 3.0

    def __post_init__(self) -> None:
        if not self.margin > 1.0:
            raise ValueError(f"margin = {self.margin!r}; give more than 1, or both sides could win at once")

    def sums(self, verdicts: Iterable[Verdict]) -> tuple[float, float]:
        """Weight of the accusations and of the acquittals [-], the same in whatever order the methods stand."""
        said = list(verdicts)
        accusing = math.fsum(self._weight(v).accuse for v in said if v.verdict == "stiction")
        acquitting = math.fsum(self._weight(v).acquit for v in said if v.verdict == "no_stiction")
        return accusing, acquitting

    def __call__(self, verdicts: Iterable[Verdict]) -> Word:
        """The word for all verdicts together."""
        said = list(verdicts)
        accusing, acquitting = self.sums(said)
        if accusing > 0.0 and accusing >= self.margin * acquitting:
            return "stiction"
        if acquitting > 0.0 and acquitting >= self.margin * accusing:
            return "no_stiction"
        return "inconclusive" if any(v.applicable for v in said) else "not_applicable"

    def _weight(self, v: Verdict) -> Weight:
        return self.weights.get(v.method, Weight())

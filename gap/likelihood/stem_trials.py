"""Trials of the sizes of one stem by a bank, with noise, loads and gains that all trials share."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from stickslip.gap.likelihood.bank import left_by_bank
from stickslip.gap.likelihood.few_stems import FewStems, on_path
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.logs.arrays import Values

STEMS = 12  # of a bank while sizes are searched
FACTORS: Sequence[float] = (1.4, 1.2, 1.1)  # by which noise and loads are changed in turn
AFTER: Sequence[float] = (1.2,)  # the same once sizes have changed
LIKELIER = 0.5  # nats that one must gain


@dataclass(eq=False)
class Bank:
    """Trials of one stem with ``shared`` values of noise, loads, tolerances, and gains of the filter ``near``; ``few``
    says what its stems lose, where that is made up.
    """

    one: Hypothesis
    shared: dict[str, float]
    near: Innovations
    count: int = STEMS
    trials: list[Innovations] = field(default_factory=list)
    asked: dict[tuple[object, ...], Innovations | None] = field(default_factory=dict)
    few: FewStems | None = None

    def tried(self, size: dict[str, float], one: Hypothesis | None = None) -> Innovations | None:
        """Return what a bank of these sizes leaves; None where they cannot be, a run fails, or others are far ahead."""
        one = one or self.one
        key = (self.count, type(one.effect), *(float(f"{value:.9g}") for value in size.values()))
        if key not in self.asked:
            self.asked[key] = self._tried(size, one)
        return self.asked[key]

    def _tried(self, size: dict[str, float], one: Hypothesis) -> Innovations | None:
        assert one.effect is not None
        if one.effect.rules(one.frame.model, one.place, size):
            return None
        best = self.likeliest if self.trials else None
        try:
            found = left_by_bank(one, {**self.shared, **size}, self.near, self.count, best)
        except ArithmeticError:
            return None
        if not math.isfinite(found.nll):
            return None
        if self.few is not None:
            found = replace(found, charge=self.few.lost(self.one, self.count))
        self.trials.append(found)
        return found

    @property
    def likeliest(self) -> Innovations:
        """The likeliest trial of some."""
        return min(self.trials, key=nll_of)

    @property
    def least(self) -> float:
        """Negative logarithm of the likelihood of the likeliest trial [nats]."""
        return self.likeliest.nll


def with_path(
    one: Hypothesis, shared: dict[str, float], path: Values | None, few: FewStems | None, count: int = STEMS
) -> Bank | None:
    """Return a bank whose gains are those of a filter that knows the path of the stem."""
    try:
        return Bank(one, shared, on_path(one, path).filtered(shared, joined=True), count, few=few)
    except ArithmeticError:
        return None


def asked_with(bank: Bank, shared: dict[str, float], best: Innovations) -> Bank | None:
    """Return a bank with other shared values, and what it leaves with the best sizes; None if none can be."""
    found = with_path(bank.one, shared, best.stem, bank.few)
    return found if found is not None and found.tried(sizes_of(best), best.hypothesis) is not None else None


def with_likelier_noise(bank: Bank, factors: Sequence[float] = FACTORS) -> Bank:
    """Return a bank of the same sizes with noise and loads that make it likelier, each changed by a factor in turn.

    The gains of each are those in the slopes of the first bank, whose stem goes the same path.
    """
    best, first = bank.likeliest, bank
    for factor in factors:
        for name in bank.one.frame.free:
            for way in (factor, 1.0 / factor):
                while _allows(bank, name, size := bank.shared[name] * way):
                    ahead = _noisier(first, {**bank.shared, name: size}, best)
                    if ahead is None or ahead.least > bank.least - LIKELIER:
                        break
                    bank = ahead
    return bank


def _noisier(bank: Bank, shared: dict[str, float], best: Innovations) -> Bank | None:
    """Return a bank with other noise in the slopes of a known one, and what it leaves with the best sizes."""
    near = bank.near.hypothesis.noisier(bank.near, shared, joined=True)
    found = Bank(bank.one, shared, near, few=bank.few)
    return found if found.tried(sizes_of(best), best.hypothesis) is not None else None


def _allows(bank: Bank, name: str, size: float) -> bool:
    """Return whether a size of noise or a load lies within its bounds."""
    low, high = bank.one.bounds[name]
    return name in bank.one.noise_keys and low <= size <= high


def sizes_of(found: Innovations) -> dict[str, float]:
    """Return the sizes of a stem that a trial has."""
    return {name: found.values[name] for name in found.hypothesis.own}


def nll_of(found: Innovations) -> float:
    """Return the negative logarithm of the likelihood of a trial [nats]."""
    return found.nll

"""What a bank loses of a log-likelihood because its stems are few: known where the stem goes where OP sends it.

There the model alone says the same by its filter, without a bank.  What the two differ by is the bank's, and a stem of
any size loses about as much: its log-likelihood is compared with that of effects that need no bank once it is made up.
Across runs of a loop that is not linear it hardly depends on how many stems there are: it is what gains lose that know
the path of a stem that follows OP at once.  There it says only whether a stem is worth a fit.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from stickslip.gap.likelihood.bank import left_by_bank
from stickslip.gap.likelihood.fit import Fit, tried
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.known_stem import KnownStem
from stickslip.logs.arrays import Values

MOST = 0.25  # nats a row that stems may lose; a bank that loses more has lost its way, and nothing is made up


@dataclass(frozen=True, eq=False)
class FewStems:
    """A stem that goes where OP sends it beside the model ``null`` without one; ``size`` of such a stem."""

    null: Fit
    size: Mapping[str, float]
    known: dict[tuple[Frame, int], float] = field(default_factory=dict)
    paths: dict[Frame, Values | None] = field(default_factory=dict)

    def lost(self, one: Hypothesis, count: int) -> float:
        """Return what ``count`` stems lose in the record of a hypothesis, at most 0 [nats]."""
        key = one.frame, count
        if key not in self.known:
            try:
                self.known[key] = self._lost(one, count)
            except ArithmeticError:
                self.known[key] = 0.0
        return self.known[key]

    def _lost(self, one: Hypothesis, count: int) -> float:
        values = self.null.best.values
        alone = self.null.best.hypothesis
        exact = tried(alone.of(replace(alone.frame, apart=one.frame.apart)), values)
        near = on_path(one, self.path(one)).filtered(values, joined=True)
        few = left_by_bank(one, {**values, **self.size}, near, count)
        lost = few.nll - exact.nll if exact is not None else 0.0
        return -lost if 0.0 < lost < MOST * len(few.e) else 0.0

    def path(self, one: Hypothesis) -> Values | None:
        """Return where the stem would be at each stop.

        Raises ``ArithmeticError`` where no run follows the record.
        """
        if one.frame not in self.paths:
            values = self.null.best.values
            near = self.null.hypothesis.filtered(values, joined=True)
            self.paths[one.frame] = left_by_bank(one, {**values, **self.size}, near, 1).stem
        return self.paths[one.frame]


def on_path(one: Hypothesis, path: Values | None) -> Hypothesis:
    """Return the hypothesis that the stem of another went a path."""
    assert path is not None
    times, _ = one.frame.stops
    return Hypothesis(one.frame, KnownStem(times, path, "previous" if one.frame.scanned else "linear"), one.place)


def known_stem(best: Innovations) -> Hypothesis:
    """Return the hypothesis that the stem of a bank went its likeliest path."""
    return on_path(best.hypothesis, best.stem)

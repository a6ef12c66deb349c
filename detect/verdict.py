"""The verdict of a detector: yes, no, undecided, or not applicable, with its number and its reason."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from stickslip.detect.words import WORDS, Word
from stickslip.logs.arrays import Values
from stickslip.logs.shown import Shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure, FigureBase
else:
    Figure = FigureBase = Any  # matplotlib is loaded when something is drawn

__all__ = ["Code", "Draw", "Evidence", "Figure", "FigureBase", "Verdict", "VerdictError", "Word"]

Code = Literal[
    "no_oscillation", "too_few_cycles", "undersampled", "signal_missing", "op_saturated", "integrating_unknown",
    "wrong_process_type", "manual_mode", "quantised", "compressed", "constant_signal", "sp_not_constant",
    "stale_data", "frozen_pv", "pv_unresponsive", "not_in_charge", "no_valve", "not_causal", "outside_wave",
]  # fmt: skip
Evidence = Mapping[str, Values | float]
Draw = Callable[["Verdict", "FigureBase"], None]


class VerdictError(ValueError):
    """A verdict was built that contradicts itself."""


@dataclass(frozen=True, eq=False, repr=False)
class Verdict(Shown):
    """The answer of one method on one loop.

    Parameters: ``method`` (str) Name of the method, which is the name of its module in ``detect``; ``verdict``
    ({"stiction", "no_stiction", "inconclusive", "not_applicable"}); ``index`` (float or None) The method's own index on
    the scale of its paper [-]; None when not applicable; ``threshold`` (float or None) The value of ``index`` beyond
    which the method calls stiction [-]; ``reason`` (str) One or two sentences with the numbers behind the verdict;
    ``code`` (str or None) Why the method does not apply; set exactly when ``verdict`` is "not_applicable"; ``interval``
    ((low, high) or None) 90 % interval of ``index``; ``amount_percent_op`` (float or None) Size of the stiction [% of
    OP span]; None for methods that only detect; ``evidence`` (mapping of name to array or float) What the method's plot
    shows; arrays are made read-only; ``draw`` (function (verdict, figure), optional) Draws the evidence; without one
    the plot shows the reason in words; ``experimental`` (bool) Whether the method is still on trial: its answer is
    shown, marked.

    Raises ``VerdictError`` if a verdict and its fields contradict each other.

    >>> v = Verdict("area_ratio", "stiction", index=5.9, threshold=1.25, reason="R = 5.90.")
    >>> v.verdict, v.applicable
    ('stiction', True)
    >>> Verdict.not_applicable("area_ratio", "constant_signal", "PV never moves.").index is None
    True
    """

    method: str
    verdict: Word
    index: float | None
    threshold: float | None
    reason: str
    code: Code | None = None
    interval: tuple[float, float] | None = None
    amount_percent_op: float | None = None
    evidence: Evidence = field(default_factory=dict)
    draw: Draw | None = field(default=None, repr=False)
    experimental: bool = False

    @property
    def headline(self) -> str:
        """The result in one line."""
        return f"{self.method}: {WORDS[self.verdict].spoken}. {self.reason}"

    def __post_init__(self) -> None:
        if self.verdict not in WORDS:
            raise VerdictError(f"verdict = {self.verdict!r}; give one of {', '.join(WORDS)}")
        if self.code is not None and self.code not in get_args(Code):
            raise VerdictError(f"code = {self.code!r}; give one of {', '.join(get_args(Code))}")
        if (self.verdict == "not_applicable") != (self.code is not None):
            raise VerdictError(
                f"verdict = {self.verdict!r} with code = {self.code!r}; "
                "not_applicable needs a code and no other verdict has one"
            )
        if self.code is not None and (self.index is not None or self.interval is not None):
            raise VerdictError(f"index = {self.index} with not_applicable; leave index and interval None")
        if self.index is not None and not math.isfinite(self.index):
            raise VerdictError(f"index = {self.index}; give a finite number or None")
        if not self.reason.strip():
            raise VerdictError("reason is empty; say in a sentence why")
        kept: dict[str, Values | float] = {}
        for name, value in self.evidence.items():
            if isinstance(value, np.ndarray):
                value = np.array(value, dtype=np.float64)
                value.flags.writeable = False
            kept[name] = value
        object.__setattr__(self, "evidence", MappingProxyType(kept))

    def __reduce__(self) -> tuple[Any, ...]:
        # Read-only mappings cannot be pickled; process pools need verdicts that can.
        return type(self), tuple((self.__dict__ | {"evidence": dict(self.evidence)}).values())

    @classmethod
    def not_applicable(
        cls, method: str, code: Code, reason: str, threshold: float | None = None, evidence: Evidence | None = None,
        draw: Draw | None = None,
    ) -> "Verdict":  # fmt: skip
        """A refusal: the record breaks a precondition of the method, so there is no index."""
        return cls(method, "not_applicable", None, threshold, reason, code=code, evidence=evidence or {}, draw=draw)

    @property
    def applicable(self) -> bool:
        """True when the method could look at the record at all."""
        return self.verdict != "not_applicable"

    def array(self, name: str) -> Values:
        """Evidence ``name`` as an array, shape (n,); empty when the method did not get that far."""
        return np.atleast_1d(np.asarray(self.evidence.get(name, ()), dtype=np.float64))

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON: no NaN, no arrays, no evidence."""
        interval = None if self.interval is None else [_finite(bound) for bound in self.interval]
        return {
            "name": self.method, "verdict": self.verdict, "index": _finite(self.index),
            "threshold": _finite(self.threshold), "reason": self.reason, "code": self.code, "interval": interval,
            "amount_percent_op": _finite(self.amount_percent_op), "experimental": self.experimental,
        }  # fmt: skip

    def plot(self) -> Figure:
        """The evidence as the method draws it, with the reason below."""
        from stickslip.detect.figures.verdict import plot_verdict

        return plot_verdict(self)


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)

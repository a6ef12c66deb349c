"""What a diagnosis found: whether there is a gap, where it lies, which effect causes it, how far it shrinks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from stickslip.gap.answers.evidence import Evidence
from stickslip.gap.answers.seen import Seen
from stickslip.logs.arrays import Values
from stickslip.logs.chances import chance
from stickslip.logs.shown import Shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from stickslip.diagram.diagram import Diagram

VAGUE = 0.6  # width of an interval that tells nothing
UNKNOWN = "unknown"


@dataclass(frozen=True)
class Where:
    """The place of a gap: the most likely block, its probability, and the blocks that the log cannot separate from it.
    ``shares`` gives how much of the gap each block of this set explains at best.
    """

    place: str
    probability: float
    confidence_set: tuple[str, ...]
    shares: Mapping[str, float]


@dataclass(frozen=True)
class Size:
    """A parameter of an effect: its value with an interval of 90 %, in its unit.

    >>> print(Size(3.02, 2.9, 3.1, "% OP"), Size(1.2, 1.199999, 1.200001, "-"), sep="; ")
    3.02 % OP (2.9 to 3.1); 1.2
    """

    value: float
    low: float
    high: float
    unit: str

    def __str__(self) -> str:
        value, low, high = (f"{one:.4g}" for one in (self.value, self.low, self.high))
        unit = "" if self.unit == "-" else f" {self.unit}"
        return f"{value}{unit}" if low == value == high else f"{value}{unit} ({low} to {high})"


@dataclass(frozen=True)
class Cause:
    """An effect found at a place, or "unknown"; ``ambiguous_with`` the effects that would leave the same log."""

    effect: str
    place: str
    probability: float
    ambiguous_with: tuple[str, ...] = ()
    parameters: Mapping[str, Size] = field(default_factory=dict)


@dataclass(frozen=True)
class Rank:
    """An effect at a place, and how probable it is among all."""

    effect: str
    place: str
    probability: float


@dataclass(frozen=True)
class Shrinkage:
    """How far the gap shrinks on rows that the fit has not seen, as mean loss (negative log likelihood) per row and
    signal.

    ``before`` is the loss without the effects, ``after`` the loss with them, and ``floor`` the loss without any gap.
    ``fraction`` is the share of the loss above the floor that has gone, with its interval of 90 %.
    """

    before: float
    after: float
    floor: float
    fraction: float
    low: float
    high: float

    def __str__(self) -> str:
        if self.high - self.low > VAGUE:
            return "on rows that the fit has not seen the gap is too small beside the noise to tell how far it shrinks"
        by = f"{100.0 * self.fraction:.0f} % ({100.0 * self.low:.0f} to {100.0 * self.high:.0f} %)"
        return f"on rows that the fit has not seen the gap shrinks by {by}"


@dataclass(frozen=True, eq=False, repr=False)
class GapReport(Shown):
    """The outcome of ``diagnose``: words first (``print(report)``), ``plot()``, ``to_dict()``.

    ``gap`` says whether there is one; ``where``, ``causes``, ``ranking`` and ``shrinkage`` are as named; ``words`` is
    the report in sentences.  ``residuals`` gives for each signal the innovations of the model as it is and with the
    causes, (2, rows), at ``t`` (rows,) [s].  ``evidence`` is the basis of the answer.  ``seen`` lists, if there is no
    gap, the sizes from which on each effect would have shown.  ``hints`` says which mistake in units, signs, columns
    or clocks would explain an unknown gap.
    """

    gap: bool
    where: Where | None
    causes: tuple[Cause, ...]
    ranking: tuple[Rank, ...]
    shrinkage: Shrinkage | None
    words: tuple[str, ...]
    notes: tuple[str, ...]
    t: Values
    residuals: Mapping[str, Values]
    diagram: "Diagram"
    evidence: Evidence | None = None
    seen: tuple[Seen, ...] = ()
    hints: tuple[str, ...] = ()

    def __str__(self) -> str:
        sure = [f"Probability of this answer: {chance(one.probability)}." for one in self.causes[:1]]
        return "\n".join([*self.sentences, *(f"  - {note}" for note in (*sure, *self.notes))])

    @property
    def headline(self) -> str:
        """The result in one line."""
        return self.words[0]

    @property
    def sentences(self) -> tuple[str, ...]:
        """What the report says: its words, and after them its hints."""
        return (*self.words, *self.hints)

    def to_dict(self) -> dict[str, Any]:
        """Return the report as plain values for JSON."""
        return {
            "gap": self.gap,
            "where": self.where
            and {
                "place": self.where.place,
                "probability": _digits(self.where.probability),
                "confidence_set": list(self.where.confidence_set),
                "shares": {name: _digits(share) for name, share in self.where.shares.items()},
            },
            "causes": [
                {
                    "effect": cause.effect,
                    "place": cause.place,
                    "probability": _digits(cause.probability),
                    "ambiguous_with": list(cause.ambiguous_with),
                    "parameters": {
                        name: {
                            "value": _digits(size.value),
                            "low": _digits(size.low),
                            "high": _digits(size.high),
                            "unit": size.unit,
                        }
                        for name, size in cause.parameters.items()
                    },
                }
                for cause in self.causes
            ],
            "ranking": [
                {"effect": rank.effect, "place": rank.place, "probability": _digits(rank.probability)}
                for rank in self.ranking
            ],
            "hints": list(self.hints),
            "shrinkage": self.shrinkage and {key: _digits(v) for key, v in self.shrinkage.__dict__.items()},
        }

    def plot(self) -> "Figure":
        """Draw the residuals of each logged signal, of the model as it is and with the causes."""
        from stickslip.gap.answers.figures import plot_residuals

        return plot_residuals(self)

    def plot_diagram(self) -> "Figure":
        """Draw the model with the gap coloured in: the redder a block, the more of the gap an effect there explains.

        Each cause is named in its block.
        """
        from stickslip.diagram.figures.drawing import draw

        there = {block.name for block in self.diagram.blocks}
        said = {one.place: one.effect.replace("_", " ") for one in self.causes if one.place in there}
        return draw(self.diagram, self.where.shares if self.where else {}, said=said)

    def _repr_html_(self) -> str:
        from stickslip.logs.notebook import image, paragraph

        return "".join(paragraph(word) for word in self.sentences) + image(self.plot_diagram()) + image(self.plot())


def _digits(value: float) -> float | None:
    """Return a number for JSON: six digits, nothing for what is not finite."""
    return float(f"{value:.6g}") if np.isfinite(value) else None


def listed(names: Sequence[str]) -> str:
    """Return names as in a sentence.

    >>> listed(["a", "b", "c"])
    'a, b or c'
    """
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} or {names[-1]}"

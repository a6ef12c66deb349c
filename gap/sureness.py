"""How sure a name is: the share of right ones among runs with the same kind of answer, whose truth is known.

    p = (hits + A p_0) / (runs + A)          p_0 = (hits_0 + 1/2) / (runs_0 + 1) of the tuning runs of the benchmark

Runs of the user's own model (``calibrate``) count; until there are any, those of the benchmark stand alone.  No number
of runs makes a probability of 1.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from gap.evidence import Evidence

PRIOR = 6.0  # runs that the benchmark's share counts for beside runs of one's own (A)
CLOSE = 60.0  # nats between the named set and the next explanation, below which they are close
NEARLY = 0.97  # share of the gap from which on hardly anything is left
# kind of answer -> (right, of): 163 runs of the tuning seeds of ``benchmarks.gap``, ideal flow, on which the diagnosis
# was made, each with its latest answer, so that these shares are a fit and flatter; few of them are pairs or effects
# outside the catalogue
BENCHMARK: Mapping[str, tuple[int, int]] = {
    "complete, clear": (104, 104), "complete, close": (9, 9), "adequate, above 0.97": (2, 2),
    "adequate, below 0.97": (8, 8), "digits": (9, 10), "pair": (5, 6), "unknown": (17, 20),
    # site loop, 159 tuning records, of 54 the class of the effect left out of the catalogue; of six sticky stems four
    # follow LuGre's law, and are called deadband
    "filter, digits": (6, 6), "filter, white": (54, 57), "filter, nearly": (4, 5), "filter, stiction": (2, 2),
    "filter, deadband": (5, 9), "filter, unknown": (66, 66),
    # separator section and full plant, 21 tuning records of seeds 61 and 62, by the filter as it was being made
    "segments, complete": (15, 18), "segments, adequate": (3, 3),
}  # fmt: skip


def kind(evidence: Evidence) -> str:
    """Return the kind of an answer: what it rests on, coarsely.

    >>> kind(Evidence("complete", 5000.0, 1.0, 2000.0)), kind(Evidence("adequate", 5000.0, 0.95, 20.0))
    ('complete, clear', 'adequate, below 0.97')
    """
    if evidence.kind == "complete":
        return "complete, clear" if evidence.margin > CLOSE else "complete, close"
    if evidence.kind == "adequate":
        return f"adequate, {'above' if evidence.share >= NEARLY else 'below'} {NEARLY:g}"
    return evidence.kind


@dataclass(frozen=True)
class Sureness:
    """How often answers of each kind were right in ``runs`` runs of one's own: kind -> (right, of)."""

    own: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    runs: int = 0

    def probability(self, evidence: Evidence) -> float:
        """Return how probable a name is that rests on this."""
        of_kind = kind(evidence)
        right, of = BENCHMARK.get(of_kind, (1, 1))
        prior = (right + 0.5) / (of + 1.0)
        own_right, own_of = self.own.get(of_kind, (0, 0))
        return (own_right + PRIOR * prior) / (own_of + PRIOR)

    def __str__(self) -> str:
        if not self.runs:
            return (
                "Probabilities are shares of right names in the benchmark's runs, not in runs of this model; "
                "gap.calibrated(model, log), or --calibrate, counts those."
            )
        return f"Probabilities are shares of right names in {self.runs} runs of this model with known effects."


def counted(rows: Iterable[Mapping[str, Any]]) -> dict[str, tuple[int, int]]:
    """Return kind -> (right, of) of rows that have "evidence" and "right"; those without a gap are not of them."""
    found: dict[str, tuple[int, int]] = {}
    for row in rows:
        if row["evidence"] and row["evidence"]["kind"] != "none":
            of_kind = kind(Evidence(**row["evidence"]))
            right, of = found.get(of_kind, (0, 0))
            found[of_kind] = right + bool(row["right"]), of + 1
    return dict(sorted(found.items()))

"""The probability of a name: the share of right names among runs of known truth with the same kind of answer.

    p = (hits + A p_0) / (runs + A)          p_0 = (hits_0 + 1/2) / (runs_0 + 1) of the tuning runs of the benchmark

Runs of the user's own model (``calibrate``) count; until there are any, those of the benchmark stand alone.  No number
of runs makes a probability of 1.

Runs of a catalogue's effects say nothing of effects that no catalogue has, which get the same kinds of answers.  Of the
gaps one in four is taken to be such a one.  Then, with b answers of a kind that those got for each
one that the catalogue's effects got,

    p of a name = p / (1 + b)          p of "unknown": n R / 3 of them are right among n runs, R the share found
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from stickslip.gap.answers.evidence import Evidence

PRIOR = 6.0  # runs that the benchmark's share counts for beside runs of one's own (A)
# kind of answer -> (right, of): the site loop, 124 tuning records with an effect (seeds 50, 52, 60; misses of the first
# two have been worked on, so these shares flatter); "unknown" of 61 whose effect the catalogue lacks, at their share
# (``OUTSIDE``); "pair" of the ideal flow, 36 records of seeds 7500 to 7603 and those of the family "tuning"
BENCHMARK: Mapping[str, tuple[int, int]] = {
    "digits": (10, 10), "white": (76, 76), "pair": (42, 44), "unknown": (40, 42),
}  # fmt: skip


OUTSIDE = 0.25  # share of the gaps whose effect is in no catalogue
# kind of answer -> such answers to effects outside the catalogue, for each one to effects of the catalogue: one more
# than found of 61 tuning records whose effect the catalogue lacks (27 of seeds 50, 52 and 60 that no catalogue has; of
# seed 60, 34 with their class left out); two of them got a name, both with a rival near
MISTAKEN: Mapping[str, float] = {"white": 0.009}
RECALLED = 0.9  # share of effects outside the catalogue that are called unknown


@dataclass(frozen=True)
class HitRates:
    """How often answers of each kind were right in ``runs`` runs of one's own: kind -> (right, of)."""

    own: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    runs: int = 0

    def probability(self, evidence: Evidence) -> float:
        """Return how probable a name is that rests on this."""
        of_kind = evidence.kind
        right, of = BENCHMARK.get(of_kind, (1, 1))
        prior = (right + 0.5) / (of + 1.0)
        own_right, own_of = map(float, self.own.get(of_kind, (0, 0)))
        if of_kind == "unknown":
            beside = RECALLED * OUTSIDE / (1.0 - OUTSIDE) * self.runs
            own_right, own_of = own_right + beside, own_of + beside
        return (own_right + PRIOR * prior) / (own_of + PRIOR) / (1.0 + MISTAKEN.get(of_kind, 0.0))

    def __str__(self) -> str:
        if not self.runs:
            return (
                "Probabilities are shares of right names in the benchmark's runs, not in runs of this model; "
                "stickslip.gap.calibrated(model, log), or --calibrate, counts those."
            )
        return f"Probabilities are shares of right names in {self.runs} runs of this model with known effects."


def counted(rows: Iterable[Mapping[str, Any]]) -> dict[str, tuple[int, int]]:
    """Return kind -> (right, of) of rows that have "evidence" and "right"; those without a gap are not of them."""
    found: dict[str, tuple[int, int]] = {}
    for row in rows:
        if row["evidence"] and row["evidence"]["kind"] != "none":
            of_kind = row["evidence"]["kind"]
            right, of = found.get(of_kind, (0, 0))
            found[of_kind] = right + bool(row["right"]), of + 1
    return dict(sorted(found.items()))

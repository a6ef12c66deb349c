"""The calibrated judge: from what a record shows to probabilities of causes and to S and J with intervals.

    logit p(stiction) = base + learnt s / max(1, d) + evidence sign(G) ln(1 + |G| / ``NATS``)
    p(cause)          = (1 - p(stiction)) times the network's share of that cause among all others
    ln(S / OP travel) = what the network says, or a mean of that and of the likeliest S, which counts the more the more
                        dead travel gains, not if they differ by ``APART``; and to it three quantiles of its error,
                        which is the smaller the more dead travel gains; J as the network says, likewise

s is the network's log odds of a stick and G the gain of dead travel [nats], 0 where it cannot be weighed.  d is how far
the record lies from the loops that were learnt from, in samples a turn of OP, turns, and S over OP's travel (distance
of Mahalanobis), over the distance within which 95 % of these lie.  So the learnt odds fall back as the record leaves
what was learnt, and the evidence, which nothing has to learn, keeps its weight.

Stiction is called from ``accuse`` on, and from ``contested`` on where dead travel loses ``GAIN_NATS``: what is learnt
may hold in simulation only, and then the record's own likelihood has to agree or the learnt odds have to be higher.

The causes sum to one and the probability of stiction is one of them, so that the two can never disagree.  All numbers
come from ``python -m stickslip.calibration train`` (simulated loops only) and are kept in ``FILE``, plain JSON.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from stickslip.detect.likelihood.pooled import GAIN_NATS
from stickslip.logs.arrays import Indices, Values

FILE = Path(__file__).with_name("calibration.json")
SCHEMA = "stickslip.calibration.model/5"
APART = 1.7  # factor: in an even cycle without noise the likeliest S may be half or twice the true one
SHARES = (0.0, 0.44, 0.66)  # of the likelihood in S, from which on its error is another: any, 40 nats, 100 nats
NATS = 5.0  # up to which a gain counts in full; more of them tell less and less
SEEN = ("network_sticky", "dead_travel")  # features that the odds are made of
SIZE = ("network_S", "likely_S", "likely_share")  # those that S is made of
PLACE = ("samples", "turns", "network_S")  # and those that the distance is measured in


@dataclass(frozen=True)
class Opinion:
    """The output of the model for one record.

    causes : probability of each cause [-], they sum to 1, largest first
    S, J : (median, low, high) over OP's travel [-], should the valve stick; interval of 90 %
    far : distance from the loops learnt from, over that of 95 % of them [-]
    needed : probability of stiction from which on it is called [-]
    """

    causes: dict[str, float]
    S: tuple[float, float, float]
    J: tuple[float, float, float]
    far: float
    needed: float

    @property
    def probability(self) -> float:
        """Probability of stiction [-]."""
        return self.causes["stiction"]


@dataclass(frozen=True)
class Model:
    """The numbers of the judge; see the module.

    base, learnt, evidence : of the log odds
    accuse, contested, clear : stiction is called from this probability on; from that one on where dead travel loses
        ``GAIN_NATS``; no stiction only up to the last [-]
    S, J : quantiles of 5, 50 and 95 % of the error of ln S, by how sure it is (``sure``), and of ln J
    middle, spread : (3, 3) mean of ``PLACE`` and inverse of its covariance, over the square of the 95 % distance
    kinds : cause of each kind of loop that the network tells apart, but for those that stick
    about : what was fitted on what, plain values
    """

    base: float
    learnt: float
    evidence: float
    accuse: float
    contested: float
    clear: float
    S: tuple[tuple[float, float, float], ...]
    J: tuple[float, float, float]
    middle: tuple[float, ...]
    spread: tuple[tuple[float, ...], ...]
    kinds: Mapping[str, str]
    about: Mapping[str, Any]

    def far(self, place: Values) -> Values:
        """The distance d (n,) [-] of records by their features ``PLACE`` (n, 3)."""
        off = place - np.array(self.middle)
        return np.asarray(np.sqrt(np.einsum("ni,ij,nj->n", off, np.array(self.spread), off)))

    def needed(self, gain: float) -> float:
        """The probability of stiction from which on it is called [-], by what dead travel gains [nats], NaN if nothing.

        >>> [calibrated().needed(gain) > calibrated().accuse for gain in (5.0, math.nan, -40.0)]
        [False, False, True]
        """
        return self.contested if gain <= -GAIN_NATS else self.accuse

    def shares(self, found: Mapping[str, float]) -> dict[str, float]:
        """What the network and the evidence add to the log odds of one record, by the names of ``SEEN``."""
        seen = np.array([[found.get(name, math.nan) for name in SEEN]])
        learnt, evidence = weighed(seen, self.far(self._place(found)))[0]
        return dict(zip(SEEN, (self.learnt * float(learnt), self.evidence * float(evidence)), strict=True))

    def judge(self, found: Mapping[str, float]) -> Opinion:
        """The opinion on the features of one record."""
        p = 1.0 / (1.0 + math.exp(-self.base - sum(self.shares(found).values())))
        others = dict.fromkeys(self.kinds.values(), 1e-6)
        for kind, cause in self.kinds.items():
            others[cause] += math.exp(found[f"network_{kind}"])
        total = math.fsum(others.values())
        causes = {"stiction": p} | {cause: (1.0 - p) * share / total for cause, share in others.items()}
        size = [np.array([found.get(name, math.nan)]) for name in SIZE]
        S = [math.exp(float(ln_size(*size)[0]) + q) for q in self.S[int(sure(*size)[0])]]
        J = [math.exp(found["network_J"] + q) for q in self.J]
        J = [min(jump, size) for jump, size in zip(J, S, strict=True)]
        return Opinion(
            dict(sorted(causes.items(), key=lambda item: -item[1])),
            (S[1], S[0], S[2]), (J[1], J[0], J[2]), float(self.far(self._place(found))[0]),
            self.needed(found.get("dead_travel", math.nan)),
        )  # fmt: skip

    def _place(self, found: Mapping[str, float]) -> Values:
        return np.array([[found[name] for name in PLACE]])

    def write(self, file: Path) -> None:
        """Keep the model as JSON."""
        file.write_text(json.dumps({"schema": SCHEMA, **asdict(self)}, indent=1) + "\n", encoding="utf-8")

    @classmethod
    def read(cls, file: Path) -> "Model":
        """The model kept in a file; raises ValueError if it holds another kind or version."""
        kept = json.loads(file.read_text(encoding="utf-8"))
        if kept.pop("schema", None) != SCHEMA:
            raise ValueError(f"{file} holds no {SCHEMA}; fit it again: python -m stickslip.calibration train")
        return cls(**kept)


def weighed(seen: Values, far: Values) -> Values:
    """What the weights of the log odds multiply (n, 2), by the features ``SEEN`` (n, 2) and the distance (n,).

    >>> weighed(np.array([[3.0, np.nan], [3.0, -5.0]]), np.array([0.5, 2.0])).round(3).tolist()
    [[3.0, 0.0], [1.5, -0.693]]
    """
    gain = np.nan_to_num(seen[:, 1])
    return np.column_stack([seen[:, 0] / np.maximum(far, 1.0), np.sign(gain) * np.log1p(np.abs(gain) / NATS)])


def ln_size(network: Values, likely: Values, share: Values) -> Values:
    """ln of S over OP's travel (n,), by the network and, to a share, by the likelihood, NaN where it says none.

    >>> ln_size(np.full(3, -1.0), np.array([np.nan, -1.4, -2.0]), np.array([np.nan, 0.75, 0.75])).round(3).tolist()
    [-1.0, -1.3, -1.0]
    """
    off = likely - network
    return np.where(np.abs(off) < math.log(APART), network + share * off, network)


def sure(network: Values, likely: Values, share: Values) -> Indices:
    """How many of ``SHARES`` (n,) the likelihood's share in S reaches; 0 where S is the network's alone.

    >>> sure(np.full(3, -1.0), np.array([np.nan, -1.4, -2.0]), np.array([np.nan, 0.75, 0.75])).tolist()
    [0, 3, 0]
    """
    counts = np.abs(likely - network) < math.log(APART)
    return np.where(counts, np.searchsorted(SHARES, np.nan_to_num(share), side="right"), 0)


@cache
def calibrated() -> Model:
    """The model that the package ships."""
    return Model.read(FILE)

"""The calibrated model: from the features of a record to probabilities of causes and to S and J with intervals.

    p(stiction)        = 1 / (1 + exp(-(a z + b))),   z the sum of the boosted trees "sticky"
    p(cause)           = (1 - p(stiction)) softmax(z_cause),   for every other cause, from the trees "others"
    ln(S / OP travel)  what the network says, and to it quantiles of 5, 50 and 95 % of its error from the trees "S", the
                       outer two widened; J likewise

The causes sum to one and the probability of stiction is one of them, so that the two can never disagree.  Trees, a, b,
limits and widths come from ``python -m stickslip.calibration train`` (simulated loops only) and are kept in ``FILE``,
an open ``numpy`` archive; a, b, limits and widths from other seeds than the trees.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.trees import Trees

__all__ = ["FILE", "SCHEMA", "Model", "Opinion", "calibrated"]

Values = npt.NDArray[np.float64]
FILE = Path(__file__).with_name("calibration.npz")
SCHEMA = "stickslip.calibration.model/2"
TREES = ("sticky", "others", "S", "J")
FAR_SHARE = 0.2  # share of features beyond all simulated ones from which on the model knows nothing


@dataclass(frozen=True)
class Opinion:
    """The output of the model for one record.

    causes : probability of each cause [-], they sum to 1, largest first
    S, J : (median, low, high) over OP's travel [-], should the valve stick; interval of 90 %
    unlike : share of the features that lie beyond those of all simulated records [-]
    """

    causes: dict[str, float]
    S: tuple[float, float, float]
    J: tuple[float, float, float]
    unlike: float

    @property
    def probability(self) -> float:
        """Probability of stiction [-]."""
        return self.causes["stiction"]


@dataclass(frozen=True, eq=False)
class Model:
    """Trees and the numbers beside them; see the module.

    names : of the features, in order
    causes : other than stiction, in the order of the trees "others"
    trees : by name, ``TREES``
    platt : a, b
    accuse, clear : stiction is called from this probability on, no stiction only up to that one [-]
    widths : (2, 2) what is added to the outer quantiles of ln S and ln J
    seen : (2, f) range of each feature in the simulated records
    about : what was fitted on what, plain values
    """

    names: tuple[str, ...]
    causes: tuple[str, ...]
    trees: Mapping[str, Trees]
    platt: tuple[float, float]
    accuse: float
    clear: float
    widths: Values
    seen: Values
    about: Mapping[str, Any]

    def probabilities(self, x: Values) -> tuple[Values, Values]:
        """p(stiction) (n,) and p(other causes) (n, c) [-] of records with features x (n, f)."""
        a, b = self.platt
        p = 1.0 / (1.0 + np.exp(-np.clip(a * self.trees["sticky"](x)[:, 0] + b, -40.0, 40.0)))
        z = self.trees["others"](x)
        e = np.exp(z - z.max(axis=1, keepdims=True))
        return p, (1.0 - p)[:, None] * e / e.sum(axis=1, keepdims=True)

    def sizes(self, x: Values, which: str) -> Values:
        """ln of S or J over OP's travel: low, median, high, (n, 3); what the network says, set right by trees."""
        q = np.sort(self.trees[which](x) + x[:, self.names.index(f"network_{which}"), None], axis=1)
        widths = self.widths[("S", "J").index(which)]
        return np.stack([q[:, 0] - widths[0], q[:, 1], q[:, 2] + widths[1]], axis=1)

    def judge(self, features: Mapping[str, float]) -> Opinion:
        """The opinion on the features of one record; what is not there is missing (NaN)."""
        x = np.array([[features.get(name, np.nan) for name in self.names]])
        p, others = self.probabilities(x)
        causes = {"stiction": float(p[0])} | dict(zip(self.causes, others[0].tolist(), strict=True))
        beyond = float(np.mean((x[0] < self.seen[0]) | (x[0] > self.seen[1])))
        causes = _fallen_back(causes, beyond)
        low, value, high = np.exp(self.sizes(x, "S")[0]).tolist()
        low_j, value_j, high_j = np.exp(self.sizes(x, "J")[0]).tolist()
        jump = (min(value_j, value), min(low_j, low), min(high_j, high))
        return Opinion(dict(sorted(causes.items(), key=lambda item: -item[1])), (value, low, high), jump, beyond)

    def shares(self, features: Mapping[str, float]) -> dict[str, float]:
        """The share of each feature of one record in the log odds of stiction [-], by name; see ``Trees.shares``."""
        x = np.array([features.get(name, np.nan) for name in self.names])
        return dict(zip(self.names, (self.platt[0] * self.trees["sticky"].shares(x)).tolist(), strict=True))

    def write(self, file: Path) -> None:
        """Keep the model in an open archive of arrays."""
        arrays: dict[str, Any] = {f"{k}/{name}": v for k, t in self.trees.items() for name, v in t.arrays().items()}
        numbers = {
            "schema": SCHEMA, "platt": self.platt, "accuse": self.accuse, "clear": self.clear,
            "causes": self.causes, "about": dict(self.about),
        }  # fmt: skip
        np.savez_compressed(
            file, names=np.array(self.names), widths=self.widths, seen=self.seen, numbers=json.dumps(numbers), **arrays
        )

    @classmethod
    def read(cls, file: Path) -> Model:
        """The model kept in a file; raises ValueError if it holds another kind or version."""
        with np.load(file, allow_pickle=False) as kept:
            arrays = {name: kept[name] for name in kept.files}
        numbers = json.loads(str(arrays["numbers"]))
        if numbers["schema"] != SCHEMA:
            raise ValueError(
                f"{file} holds {numbers['schema']}, not {SCHEMA}; fit it again: python -m stickslip.calibration train"
            )
        trees = {
            k: Trees.read({n.removeprefix(f"{k}/"): v for n, v in arrays.items() if n.startswith(f"{k}/")})
            for k in TREES
        }
        a, b = numbers["platt"]
        return cls(
            tuple(arrays["names"].tolist()), tuple(numbers["causes"]), trees, (a, b), numbers["accuse"],
            numbers["clear"], arrays["widths"], arrays["seen"], numbers["about"],
        )  # fmt: skip


def _fallen_back(causes: dict[str, float], beyond: float) -> dict[str, float]:
    """Causes whose odds of stiction fall back to even as the features leave those of all simulated loops.

    >>> _fallen_back({"stiction": 0.75, "healthy": 0.25}, FAR_SHARE)
    {'stiction': 0.5, 'healthy': 0.5}
    """
    p = min(max(causes["stiction"], 1e-12), 1.0 - 1e-12)
    shrunk = 1.0 / (1.0 + ((1.0 - p) / p) ** max(1.0 - beyond / FAR_SHARE, 0.0))
    return {name: shrunk if name == "stiction" else q * (1.0 - shrunk) / (1.0 - p) for name, q in causes.items()}


@cache
def calibrated() -> Model:
    """The model that the package ships."""
    return Model.read(FILE)


def rounded(x: float) -> float:
    """A size to two digits, as people say it.

    >>> rounded(4.567), rounded(0.01234)
    (4.6, 0.012)
    """
    return 0.0 if x == 0.0 else round(x, 1 - math.floor(math.log10(abs(x))))

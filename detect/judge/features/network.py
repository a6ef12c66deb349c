"""Scores of networks of convolutions over OP, PV, e, what is new in PV, and what each size of stick would leave new.

    h_0 = x                  22 channels: odd ones, r and dy along the way of OP, |w| (``channels``), ``candidates``
    h   = max(W * h + b, 0)  seven layers; four double the time between two points, three add what they got to it
    p   = mean of h over time after the layers ``POOLED``, and of the last: mean, deviation and four weighted means,
          weights exp(a h) over their sum
    f   = max(W p + b, 0),   z = W f + b: one value per kind of loop,   s = W f + b: ln S and ln J over OP's travel
    score_g = ln of the share of exp(z_g) among all,   score_sticky = ln of the odds of the sticky kinds

A loop drawn upside down sticks as much, and so does a part of its record: the features are the means of six scores, of
the whole and of its first and last ``PART``, and of each with the odd channels negated.  The scores are means over
networks that began from other random numbers: where they differ, none of them knows.
Fitted on simulated loops that nothing else is fitted on (``stickslip.calibration.network``), run here in plain numpy.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.candidates import CANDIDATES, candidates
from stickslip.detect.judge.features.channels import EVEN, ODD, channels
from stickslip.detect.judge.features.view import View
from stickslip.logs.files.write import replacing

Singles = npt.NDArray[np.float32]
FILE = Path(__file__).parents[1] / "networks.npz"

CHANNELS = ODD + EVEN + CANDIDATES
FLIPPED = np.r_[np.ones(ODD), np.zeros(EVEN), np.ones(CANDIDATES)].astype(bool)  # change sign if OP and PV do
PART = 0.8  # of a record, that is looked at from either end
KERNEL = {"stem": 9}  # taps, 5 elsewhere
LAYERS = (  # name, points between two, taps spread by, whether what it finds is added to what it got
    ("stem", 2, 1, False), ("b1", 2, 1, False), ("b2", 1, 2, True), ("b3", 2, 1, False), ("b4", 1, 2, True),
    ("b5", 2, 1, False), ("b6", 1, 2, True),
)  # fmt: skip
POOLED = ("b2", "b4")
LEAST = -12.0  # a score is no further from zero
STICKY = ("cycling", "excited")  # kinds of loop whose valve sticks
STRIDE = 16  # points of x in one of the last layer
STEPS = 127  # of a weight in a file, from zero to the largest of its row


def seen_by(v: View) -> Singles:
    """What the network sees of a view, (``CHANNELS``, n)."""
    odd, even = channels(v)
    own = candidates(odd[0].astype(np.float64), odd[1].astype(np.float64))
    return np.concatenate([odd, even, own.astype(np.float32)])


@dataclass(frozen=True, eq=False)
class Network:
    """The numbers of the network.

    weights : "<layer>/w" (o, c taps) and "<layer>/b" (o,) of each of ``LAYERS``, and of "att", "fc", "out" and "size"
    kinds : of the kinds of loop
    """

    weights: Mapping[str, Singles]
    kinds: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the scores: the kinds of loop, "sticky", and the medians of ln S and ln J over OP's travel."""
        return (*self.kinds, "sticky", "S", "J")

    def pooled(self, x: Singles) -> Singles:
        """What is pooled over time (p,) of channels x (``CHANNELS``, n)."""
        h = np.zeros((len(x), -(-x.shape[1] // STRIDE) * STRIDE), dtype=np.float32)
        h[:, : x.shape[1]] = x
        every, found = 1, []
        for name, stride, spread, added in LAYERS:
            own = np.maximum(self._linear(name, _taps(h, KERNEL.get(name, 5), stride, spread)), 0.0)
            every *= stride
            own[:, -(-x.shape[1] // every) :] = 0.0  # beyond the record
            h = h + own if added else own
            if name in POOLED:
                found.append(h[:, : -(-x.shape[1] // every)].mean(axis=1))
        h = h[:, : -(-x.shape[1] // every)]
        a = self._linear("att", h)
        share = np.exp(a - a.max(axis=1, keepdims=True))
        share /= share.sum(axis=1, keepdims=True)
        spread_out = np.sqrt(h.var(axis=1) + 1e-6)
        return np.concatenate([*found, h.mean(axis=1), spread_out, (share @ h.T).ravel()])

    def scores(self, x: Singles) -> Singles:
        """The scores by ``names`` of channels x (``CHANNELS``, n)."""
        f = np.maximum(self._linear("fc", self.pooled(x)[:, None]), 0.0)
        z, size = self._linear("out", f)[:, 0], self._linear("size", f)[:2, 0]
        sticky = np.isin(self.kinds, STICKY)
        total, stuck, loose = (np.logaddexp.reduce(x) for x in (z, z[sticky], z[~sticky]))
        return np.asarray(np.clip(np.r_[z - total, stuck - loose, size], LEAST, -LEAST), dtype=np.float32)

    def _linear(self, name: str, x: Singles) -> Singles:
        return np.asarray(self.weights[f"{name}/w"] @ x + self.weights[f"{name}/b"][:, None])


def write(networks: Sequence[Network], file: Path) -> None:
    """Write networks of the same kinds of loop into a file, each weight as one byte times the unit of its row."""
    kept: dict[str, Any] = {"kinds": np.array(networks[0].kinds)}
    for k, network in enumerate(networks):
        for name, w in network.weights.items():
            if w.ndim == 1:
                kept[f"{k}/{name}"] = w
                continue
            unit = np.maximum(np.abs(w).max(axis=1, keepdims=True) / STEPS, np.finfo(np.float32).tiny)
            kept |= {f"{k}/{name}": np.rint(w / unit).astype(np.int8), f"{k}/{name}/unit": unit.astype(np.float32)}
    with replacing(file) as part, part.open("wb") as whole:
        np.savez_compressed(whole, **kept)


def read(file: Path) -> tuple[Network, ...]:
    """Return the networks that a file holds."""
    with np.load(file, allow_pickle=False) as kept:
        kinds, weights = tuple(kept["kinds"].tolist()), dict[str, dict[str, Singles]]()
        for key in kept.files:
            number, _, name = key.partition("/")
            if name and not name.endswith("/unit"):
                unit = kept[f"{key}/unit"] if f"{key}/unit" in kept.files else np.float32(1.0)
                weights.setdefault(number, {})[name] = kept[key] * unit
    return tuple(Network(own, kinds) for own in weights.values())


def _taps(x: Singles, taps: int, stride: int, spread: int) -> Singles:
    """The points (c taps, m) that each of m points sees of x (c, n), zeros beyond both ends."""
    beyond = (taps // 2) * spread
    wide = np.pad(x, ((0, 0), (beyond, beyond)))
    seen = np.lib.stride_tricks.sliding_window_view(wide, (taps - 1) * spread + 1, axis=1)[:, ::stride, ::spread]
    return np.ascontiguousarray(seen.transpose(0, 2, 1)).reshape(len(x) * taps, -1)


@cache
def shipped_networks() -> tuple[Network, ...]:
    """The networks that the package ships."""
    return read(FILE)


def one_look(v: View) -> dict[str, float]:
    """The scores of the first network alone, of the record as it is, by name [-]: to compare thousands of loops by."""
    return _named(shipped_networks()[0].scores(seen_by(v)))


def network_features(v: View) -> dict[str, float]:
    """The features of this family by name [-]: means of the scores over the whole, its parts and both signs, and the
    odds of its parts alone.
    """
    n, alone = int(PART * len(v)), []
    for part in (slice(None), slice(n), slice(-n, None)):
        look = seen_by(replace(v, u=v.u[part], y=v.y[part], e=v.e[part]))
        alone.append(0.5 * (_scores(look) + _scores(np.where(FLIPPED[:, None], -look, look))))
    first, last = (_named(scores)["network_sticky"] for scores in alone[1:])
    return _named(np.mean(alone, axis=0)) | {"network_first": first, "network_last": last}


def _scores(x: Singles) -> Singles:
    return np.asarray(np.mean([network.scores(x) for network in shipped_networks()], axis=0))


def _named(scores: Singles) -> dict[str, float]:
    return {f"network_{name}": float(value) for name, value in zip(shipped_networks()[0].names, scores, strict=True)}

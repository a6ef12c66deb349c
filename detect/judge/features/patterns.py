"""Scores of patterns in OP and PV: random convolution kernels, and a small network that reads what is pooled of them.

    x = (number - its mean) / its deviation, cut at ``EXTREME``              of each pooled number
    z = out max(inner x + b, 0) + c                                          one value per kind of loop
    score_g = ln of the share of exp(z_g) among all,  score_sticky = ln of the odds of the sticky kinds

The kernels are drawn once (``stickslip.calibration.patterns``), each over one to three channels (``channels``) and with
one of seven dilations; the network is fitted on simulated loops that nothing else is fitted on, so that its scores are
features like others.

Source: A. Dempster, F. Petitjean, G. I. Webb, ROCKET: exceptionally fast and accurate time series classification using
random convolutional kernels, Data Mining and Knowledge Discovery 34 (2020) 1454-1495; here the kernels go over several
channels, which are averaged before the taps are spread, limits are quantiles, the sign of a wave does not matter, and
the read-out is a network (linear, AUC in other physics was 0.02 lower).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.channels import channels
from stickslip.detect.judge.features.view import View

__all__ = ["DILATIONS", "FILE", "Kernels", "Readout", "pattern_features", "pooled_of", "shipped"]

Singles = npt.NDArray[np.float32]
FILE = Path(__file__).parents[1] / "patterns.npz"
DILATIONS = (1, 2, 3, 4, 6, 8, 12)  # points; kernel k has that of number k modulo their count
EXTREME = 5.0  # deviations at which a pooled number is cut
LEAST = -12.0  # a score is no further from zero
STICKY = ("cycling", "excited")  # kinds of loop whose valve sticks


@dataclass(frozen=True, eq=False)
class Kernels:
    """Kernels over odd or over even channels.

    channel : (k, 3) of each kernel, -1 where unused; weight : (k, 3, 9); limit : (k, 4) that z is held against
    """

    channel: npt.NDArray[np.int64]
    weight: Singles
    limit: Singles
    odd: bool

    def __call__(self, x: Singles) -> Singles:
        """What is pooled (6 k,) of channels x (c, n)."""
        from stickslip.detect.judge.features.convolutions import POOLED, averaged, pooled

        out = np.full((len(self.channel), POOLED), np.nan, dtype=np.float32)
        z = np.empty(x.shape[1], dtype=np.float32)
        for number, d in enumerate(DILATIONS):
            which = np.arange(number, len(self.channel), len(DILATIONS))
            if x.shape[1] > d:
                pooled(averaged(x, d), d, which, self.channel, self.weight, self.limit, self.odd, z, out)
        return out.ravel()


@dataclass(frozen=True, eq=False)
class Readout:
    """Kernels and the network that reads what is pooled of them.

    odd, even : the kernels; mean, deviation : (p,) of the pooled numbers
    inner : (p, h), b : (h,), out : (h, g), c : (g,) of the network; kinds : of the g kinds of loop
    """

    odd: Kernels
    even: Kernels
    mean: Singles
    deviation: Singles
    inner: Singles
    b: Singles
    out: Singles
    c: Singles
    kinds: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the scores: the kinds of loop, and "sticky"."""
        return (*self.kinds, "sticky")

    def standard(self, pooled: Singles) -> Singles:
        """Pooled numbers (..., p) as the network gets them."""
        told = np.clip((pooled - self.mean) / self.deviation, -EXTREME, EXTREME)
        return np.asarray(np.nan_to_num(told, nan=0.0), dtype=np.float32)

    def scores(self, pooled: Singles) -> Singles:
        """The scores (..., g + 1) of pooled numbers (..., p)."""
        z = np.maximum(self.standard(pooled) @ self.inner + self.b, 0.0) @ self.out + self.c
        sticky = np.isin(self.kinds, STICKY)
        total, stuck, loose = (
            np.logaddexp.reduce(x, axis=-1, keepdims=True) for x in (z, z[..., sticky], z[..., ~sticky])
        )
        told = np.concatenate([z - total, stuck - loose], axis=-1)
        return np.asarray(np.clip(told, LEAST, -LEAST), dtype=np.float32)

    def write(self, file: Path) -> None:
        """Keep the read-out in a file, its network in half precision; ``read`` gives an equal one."""
        arrays = {f"{kind}/{name}": getattr(getattr(self, kind), name) for kind in ("odd", "even")
                  for name in ("channel", "weight", "limit")}  # fmt: skip
        halves = {name: getattr(self, name).astype(np.float16) for name in ("inner", "b", "out", "c")}
        np.savez_compressed(
            file, kinds=np.array(self.kinds), mean=self.mean, deviation=self.deviation, **halves, **arrays
        )

    @classmethod
    def read(cls, file: Path) -> Readout:
        """The read-out kept in a file."""
        with np.load(file, allow_pickle=False) as kept:
            odd, even = (
                Kernels(kept[f"{kind}/channel"], kept[f"{kind}/weight"], kept[f"{kind}/limit"], kind == "odd")
                for kind in ("odd", "even")
            )
            mean, deviation, inner, b, out, c = (
                kept[name].astype(np.float32) for name in ("mean", "deviation", "inner", "b", "out", "c")
            )
            return cls(odd, even, mean, deviation, inner, b, out, c, tuple(kept["kinds"].tolist()))


@cache
def shipped() -> Readout:
    """The read-out that the package ships."""
    return Readout.read(FILE)


def pooled_of(v: View, odd: Kernels, even: Kernels) -> Singles:
    """All pooled numbers of a view (p,)."""
    x, along, since = channels(v)
    return np.concatenate([odd(x), even(along), since.astype(np.float32)])


def pattern_features(v: View) -> dict[str, float]:
    """The features of this family by name [-]."""
    read = shipped()
    told = read.scores(pooled_of(v, read.odd, read.even))
    return {f"pattern_{name}": float(value) for name, value in zip(read.names, told, strict=True)}

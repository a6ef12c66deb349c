"""The read-out of patterns (``detect.judge.features.patterns``), fitted on simulated loops that nothing else uses.

kernels   drawn from a seed: one to three channels, 9 weights each of mean zero, a size of the channel's own
limits    quantiles of what each kernel gives on some loops: of |z| 30, 60, 85 and 97 %, of z 10, 35, 65 and 90 %
read-out  ridge regression of one score per kind of loop, and one of stiction, on the pooled numbers
"""

import hashlib
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from calibration.drawing import draw
from calibration.simulation import simulate
from calibration.spec import Truth
from detect.judge.features.channels import EVEN, ODD, channels
from detect.judge.features.patterns import DILATIONS, Kernels, Readout, pooled_of
from detect.judge.features.view import View, view_of
from detect.prepare.prepared import Prepared
from logs.files.resumable import Kept, differences, joined, opened

__all__ = ["LIMITED", "fit", "kernels", "pooled_loops", "views"]

Singles = npt.NDArray[np.float32]
PART = 500  # loops
COUNT = {"odd": 420, "even": 180}  # kernels
SHARES = {"odd": (0.3, 0.6, 0.85, 0.97), "even": (0.1, 0.35, 0.65, 0.9)}
LIMITED = 200  # loops that limits are taken from
DRAWN = 40  # values of z from each of them
RIDGE = 2000.0
SEED = 1  # of the kernels

KEPT = Kept(
    "pooled", "stickslip.calibration.pooled/1", "number", ValueError, partial(differences, phrases_of={})
)  # fmt: skip

Say = Callable[[str], None]


def views(seed: int, workers: int | None = None) -> list[tuple[View, Truth]]:
    """The views on one part of the training law that show enough, and what is true of them."""
    found = ((view_of(Prepared(loop)), truth) for loop, truth in simulate(draw(PART, seed), workers))
    return [(view, truth) for view, truth in found if view is not None]


def kernels(looked_at: Sequence[View]) -> tuple[Kernels, Kernels]:
    """The kernels over odd and over even channels, with limits from the views given."""
    drawn = []
    for number, (name, width) in enumerate((("odd", ODD), ("even", EVEN))):
        r = np.random.default_rng((SEED, number))
        count = COUNT[name]
        channel = np.full((count, 3), -1, dtype=np.int64)
        for row in channel:
            own = r.choice(width, size=int(r.choice([1, 2, 3], p=[0.3, 0.4, 0.3])), replace=False)
            row[: len(own)] = own
        weight = r.normal(size=(count, 3, 9))
        weight -= weight.mean(axis=2, keepdims=True)
        weight *= np.exp(0.5 * r.normal(size=(count, 3, 1))) / 3.0
        bare = Kernels(channel, weight.astype(np.float32), np.zeros((count, 4), dtype=np.float32), name == "odd")
        limit = _limits(
            bare, [(channels(view)[0] if name == "odd" else channels(view)[1]) for view in looked_at], SHARES[name], r
        )
        drawn.append(Kernels(bare.channel, bare.weight, limit, bare.odd))
    return drawn[0], drawn[1]


def _limits(bare: Kernels, looked_at: Sequence[Singles], shares: Sequence[float], r: np.random.Generator) -> Singles:
    from detect.judge.features.convolutions import averaged, convolved

    values: list[list[Any]] = [[] for _ in bare.channel]
    for x in looked_at:
        z = np.empty(x.shape[1], dtype=np.float32)
        for number, d in enumerate(DILATIONS):
            smooth = averaged(x, d) if x.shape[1] > d else x[:, :0]
            for k in range(number, len(values), len(DILATIONS)):
                n = convolved(smooth, bare.channel[k], bare.weight[k], d, z)
                if n > 0:
                    values[k].append(r.choice(z[:n], DRAWN))
    joined = [np.concatenate(own) for own in values]
    return np.array([np.quantile(np.abs(z) if bare.odd else z, shares) for z in joined], dtype=np.float32)


def pooled_loops(
    folder: Path, seed: int, count: int, odd: Kernels, even: Kernels, workers: int | None = None
) -> tuple[Singles, npt.NDArray[np.str_]]:
    """Pooled numbers (n, p) and groups (n,) of ``count`` parts from ``seed`` on, those made before from the folder.

    Raises ``ValueError`` if the folder holds what other kernels have pooled.
    """
    import polars as pl

    asked = {"seed": seed, "part": PART, "kernels": _digest(odd, even)}
    with opened(folder, asked, KEPT, fresh=False) as place:
        place.note()
        there = place.firsts()
        for k in range(count):
            if k * PART not in there:
                seen = views(seed + k, workers)
                x = np.array([pooled_of(view, odd, even) for view, _ in seen])
                columns = {KEPT.key: k * PART + np.arange(len(x)), "group": [truth.group for _, truth in seen], "x": x}
                place.add(pl.DataFrame(columns))
        rows = joined(place.rows(), KEPT.key).filter(pl.col(KEPT.key) < count * PART)
    return rows["x"].to_numpy(), np.array(rows["group"].to_list())


def _digest(odd: Kernels, even: Kernels) -> str:
    parts = (array.tobytes() for own in (odd, even) for array in (own.channel, own.weight, own.limit))
    return hashlib.sha256(b"".join(parts)).hexdigest()[:16]


def fit(x: Singles, group: npt.NDArray[np.str_], odd: Kernels, even: Kernels, say: Say = print) -> Readout:
    """The read-out by the pooled numbers (n, p) and groups (n,) of loops."""
    mean, deviation = np.nanmean(x, axis=0), np.nanstd(x, axis=0) + 1e-6
    groups = sorted(set(group.tolist()))
    bare = Readout(odd, even, mean, deviation, np.eye(x.shape[1], dtype=np.float32), tuple(groups))
    told = np.concatenate([bare.scores(rows) for rows in np.array_split(x, 50)])
    sticky = np.isin(group, ("cycling", "excited"))
    target = np.column_stack([*(group == g for g in groups), sticky]).astype(np.float32)
    target -= target.mean(axis=0)
    gram = told.T @ told
    gram[np.diag_indices(len(gram))] += RIDGE
    weight = np.linalg.solve(gram, told.T @ target).astype(np.float32)
    say(f"patterns: {len(x)} loops, {x.shape[1]} pooled numbers, {target.shape[1]} scores")
    return Readout(odd, even, mean, deviation, weight, (*groups, "sticky"))

"""The read-out of patterns (``stickslip.detect.judge.features.patterns``), fitted on simulated loops that nothing else
uses.

kernels   drawn from a seed: one to three channels, 9 weights each of mean zero, a size of the channel's own
limits    quantiles of what each kernel gives on some loops: of |z| 30, 60, 85 and 97 %, of z 10, 35, 65 and 90 %
read-out  networks with ``INNER`` numbers between the pooled ones and the kinds of loop, by scikit-learn; their mean
"""

import hashlib
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.calibration.drawing import draw
from stickslip.calibration.simulation import simulate
from stickslip.calibration.spec import Kinds, Setting, Truth
from stickslip.detect.judge.features.channels import EVEN, ODD, channels
from stickslip.detect.judge.features.patterns import DILATIONS, Kernels, Readout, pooled_of
from stickslip.detect.judge.features.view import View, view_of
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs.files.resumable import Kept, differences, joined, opened

__all__ = ["LIMITED", "fit", "kernels", "pooled_loops", "views"]

Singles = npt.NDArray[np.float32]
PART = 500  # loops
COUNT = {"odd": 420, "even": 180}  # kernels
SHARES = {"odd": (0.3, 0.6, 0.85, 0.97), "even": (0.1, 0.35, 0.65, 0.9)}
LIMITED = 200  # loops that limits are taken from
DRAWN = 40  # values of z from each of them
NETWORKS, INNER, PASSES = 4, 64, 10  # fitted from different starts, inner numbers, passes over the loops
DECAY, RATE, BATCH = 1.0, 5e-4, 128
SEED = 1  # of the kernels

KEPT = Kept(
    "pooled", "stickslip.calibration.pooled/1", "number", ValueError, partial(differences, phrases_of={})
)  # fmt: skip

Say = Callable[[str], None]


def views(
    seed: int, workers: int | None = None, setting: Setting = "training", kinds: Kinds = "usual"
) -> list[tuple[View, Truth]]:
    """The views on one part of a setting that show enough, and what is true of them; ``kinds`` as in ``draw``."""
    loops = simulate(draw(PART, seed, setting, kinds=kinds), workers)
    found = ((view_of(Prepared(loop)), truth) for loop, truth in loops)
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
    from stickslip.detect.judge.features.convolutions import averaged, convolved

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
    folder: Path, seed: int, count: int, odd: Kernels, even: Kernels, workers: int | None = None,
    setting: Setting = "training", kinds: Kinds = "usual",
) -> tuple[Singles, npt.NDArray[np.str_]]:  # fmt: skip
    """Pooled numbers (n, p) and groups (n,) of ``count`` parts from ``seed`` on, those made before from the folder.

    ``kinds`` as in ``draw``.

    Raises ``ValueError`` if the folder holds what other kernels have pooled.
    """
    import polars as pl

    asked = {"setting": setting, "seed": seed, "kinds": kinds, "part": PART, "kernels": _digest(odd, even)}
    with opened(folder, asked, KEPT, fresh=False) as place:
        place.note()
        there = place.firsts()
        for k in range(count):
            if k * PART not in there:
                seen = views(seed + k, workers, setting, kinds)
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
    import warnings

    from sklearn.exceptions import ConvergenceWarning
    from sklearn.neural_network import MLPClassifier

    mean, deviation = np.nanmean(x, axis=0), np.nanstd(x, axis=0) + 1e-6
    none = np.zeros((0, 0), dtype=np.float32)
    bare = Readout(odd, even, mean, deviation, none, none, none, none, ())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # the passes are counted: it is not to learn by heart
        fitted = [
            MLPClassifier(
                (INNER,), alpha=DECAY, max_iter=PASSES, batch_size=min(BATCH, len(x)), learning_rate_init=RATE,
                random_state=SEED + k,
            ).fit(bare.standard(x), group)
            for k in range(NETWORKS)
        ]  # fmt: skip
    # the mean of what several networks give is what one gives that has all their inner numbers
    inner = np.hstack([one.coefs_[0] for one in fitted])
    first = np.concatenate([one.intercepts_[0] for one in fitted])
    out = np.vstack([one.coefs_[1] for one in fitted]) / NETWORKS
    last = np.mean([one.intercepts_[1] for one in fitted], axis=0)
    kinds = tuple(fitted[0].classes_.tolist())
    say(f"patterns: {len(x)} loops, {x.shape[1]} pooled numbers, {len(kinds)} kinds of loop")
    weights = (half(inner), half(first), half(out), half(last))
    return Readout(odd, even, mean, deviation, *weights, kinds)


def half(x: npt.NDArray[Any]) -> Singles:
    """Numbers rounded to half precision, which the file is kept small by."""
    return x.astype(np.float16).astype(np.float32)

"""Features from the likelihood of dead travel in a record: gains in nats, sizes over OP's travel.

    gain, without_best    G and G_d of the likeliest stick         at_<share>   G of that S over OP's travel
    delay_<i>             best stick less best rival at the i-th delay;   play_<i> the same without a jump
    <rival>               score of a rival less that of OP through a straight line

All of it comes from ``likelihood.pooled`` for one record.  Nothing is there where the record cannot be weighed.
"""

from __future__ import annotations

import numpy as np
from stickslip.detect.likelihood.pooled import Evidence
from stickslip.detect.likelihood.stems import Stems

__all__ = ["dead_travel_features"]

SHARES = (0.1, 0.15, 0.2, 0.3, 0.45, 0.65, 1.0)  # of OP's travel
NONE = 3.0  # times OP's travel: an excluded S beyond is none
MOST = 100.0  # of nats, turns and samples: more tells no more, and must not look like nothing ever learnt from


def dead_travel_features(found: Evidence, stems: Stems) -> dict[str, float]:
    """The features of this family by name [-]."""
    values = {
        "gain": found.gain, "without_best": found.without_best, "S": found.S / found.travel, "J": found.J / found.S,
        "jump": found.jump, "turns": float(found.turns), "delays": float(found.delays),
        "excluded": min(found.excluded / found.travel, NONE), "loss": found.loss, "answers": found.answers,
        "steady": float(found.steady), "bent": found.bent, "between": found.between, "turned": float(found.turned),
        "low": found.low / found.S, "high": found.high / found.S, "rows": float(stems.count),
        "tenths_for": float(np.mean(found.tenths > 0.0)), "least_tenth": float(np.min(found.tenths)),
        "middle_tenth": float(np.median(found.tenths)), "order": float(stems.order[0]), "tail": stems.tail,
        "latest": float(stems.ks[-1]),
    }  # fmt: skip
    curve = np.interp(np.log(np.array(SHARES) * found.travel), np.log(found.sizes), found.curve)
    values |= {f"at_{share:g}": float(value) for share, value in zip(SHARES, curve, strict=True)}
    for i, k in enumerate(stems.ks[:3]):
        gains = stems.gains(k)
        best = max(score for score, _ in gains.rivals.values())
        values[f"delay_{i}"], values[f"play_{i}"] = (
            float(gains.score.max()) - best,
            float(gains.score[:, 0].max()) - best,
        )
    rivals = stems.gains(stems.ks[0]).rivals
    line = rivals["OP"][0]
    values |= {name.replace(" ", "_"): score - line for name, (score, _) in rivals.items() if name != "OP"}
    return {f"travel_{name}": min(max(value, -MOST), MOST) for name, value in values.items()}

"""From a table of simulated loops to the calibrated judge: a line of two features, and what is read off it.

line        logit p = base + learnt s / max(1, d) + evidence g(G) by maximum likelihood (``detect.judge.model``)
accuse      the least probability at which at most ``ALARMS`` of the loops without stiction are accused
contested   the same for ``DOUBTED`` of them, where the record's own likelihood speaks against dead travel
clear       the largest probability below which at most ``CLEARED`` of the sticky loops lie
S, J        quantiles of the error of ln S, by how sure the likelihood is of it, and of ln J
d           of all loops, sticky or not; 1 where ``INSIDE`` of them lie nearer

Three numbers are fitted to some thousands of loops, so that no others are needed to calibrate on.  A deadband is dead
travel too, and its probability is of neither: it is left out.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from stickslip.calibration.drawing import OTHERS
from stickslip.calibration.records import Table
from stickslip.detect.judge.model import PLACE, SEEN, SHARES, SIZE, Model, ln_size, sure, weighed
from stickslip.logs.arrays import Values

__all__ = ["fit"]

Say = Callable[[str], None]

ALARMS = 0.015  # below the 2 % that are allowed: other physics may cost some, and nobody digs up a sound valve gladly
DOUBTED = 0.005  # where what is learnt stands alone: a third of these
CLEARED = 0.02
TAILS = (0.05, 0.5, 0.95)
INSIDE = 0.95
FEWEST = 40  # sticky loops, of which errors of S are read off; else of all


def fit(t: Table, say: Say = print) -> Model:
    """The judge of the loops of a table; ``say`` tells each step."""
    t = t.rows(t.seen)
    middle, spread = _distance(_columns(t, PLACE))
    judged = t.rows(t.truth["cause"] != "deadband")
    off = _columns(judged, PLACE) - middle
    far = np.sqrt(np.einsum("ni,ij,nj->n", off, spread, off))
    x = weighed(_columns(judged, SEEN), far)
    line = _line(np.column_stack([np.ones(len(x)), x]), judged.sticky)
    p = 1.0 / (1.0 + np.exp(-line[0] - x @ line[1:]))
    say(f"{len(judged)} loops: log odds {line[0]:.2f} + {line[1]:.2f} s + {line[2]:.2f} g")
    base, learnt, evidence = line.tolist()
    sticky = t.rows(t.sticky)
    size = _columns(sticky, SIZE).T
    ln_at, surely = ln_size(*size), sure(*size)
    alike = [own if own.sum() >= FEWEST else surely >= 0 for own in (surely == i for i in range(len(SHARES) + 1))]
    S = tuple(_errors(sticky.rows(own), "S", ln_at[own]) for own in alike)
    J = _errors(sticky, "J", _columns(sticky, ("network_J",))[:, 0])
    accuse, contested = np.quantile(p[~judged.sticky], (1.0 - ALARMS, 1.0 - DOUBTED)).tolist()
    clear = float(np.quantile(p[judged.sticky], CLEARED))
    return Model(
        base, learnt, evidence, accuse, contested, clear, S, J, tuple(middle.tolist()),
        tuple(tuple(row) for row in spread.tolist()), dict(OTHERS), {"fitted_on": len(judged)},
    )  # fmt: skip


def _columns(t: Table, names: tuple[str, ...]) -> Values:
    """Some features (n, f) by name."""
    return t.x[:, [t.names.tolist().index(name) for name in names]]


def _distance(x: Values) -> tuple[Values, Values]:
    """Mean of x (n, f), and the form that gives the square of a distance within which ``INSIDE`` of x lie."""
    middle = np.asarray(x.mean(axis=0), dtype=np.float64)
    inverse: Values = np.asarray(np.linalg.inv(np.cov(x.T)), dtype=np.float64)
    off = x - middle
    return middle, inverse / float(np.quantile(np.einsum("ni,ij,nj->n", off, inverse, off), INSIDE))


def _line(x: Values, y: npt.NDArray[np.bool_]) -> Values:
    """Weights (f,) of the logistic line through x (n, f), by Newton's method."""
    w = np.zeros(x.shape[1])
    for _ in range(50):
        p = 1.0 / (1.0 + np.exp(-np.clip(x @ w, -40, 40)))
        hessian = x.T @ (x * (p * (1 - p))[:, None]) + 1e-9 * np.eye(len(w))
        step = np.linalg.solve(hessian, x.T @ (y - p))
        w = w + step
        if np.abs(step).max() < 1e-10:
            break
    return w


def _errors(sticky: Table, which: str, ln_at: Values) -> tuple[float, float, float]:
    """Quantiles ``TAILS`` of ln of the true size over OP's travel, less ``ln_at`` (n,)."""
    low, middle, high = np.quantile(np.log(sticky.truth[which].astype(float) / sticky.unit) - ln_at, TAILS).tolist()
    return low, middle, high

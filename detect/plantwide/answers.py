"""Does any tag show that the valve answers OP at once, or only after OP has travelled through a band?

    R2_0(x)     squared correlation of tag x with OP
    R2(x)       the largest squared correlation of x with stick(OP; S, J), over S and J
    gain(x)     ln((1 - R2_0) / (1 - R2)),  for the best S of x

A log of a plant holds tags that move with the stem: the stem position itself, the flow through the valve, a pressure
behind it.  If none follows OP with R2_0 >= ``FOLLOWS_R2``, the tag with the largest gain at an S of at least
``S_MIN_PERCENT`` tells how far OP travels without an answer, and how plainly.  If one does follow, it must be beaten:
the gain is then ln((1 - R2_0 of the best follower) / (1 - R2 of the best tag)), near 0 for a valve that
answers.  Straight lines over time and a constant are free.

The loop's own PV and SP are not asked: controller and process stand between them and OP, so that a lag passes for play.
A lag between the stem and another tag does so, too; hence a gain is an order to look in, and no verdict.
Idea and limits are ours; the stick is that of ``stem.stick``.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from stickslip.detect.stem.stick import stick
from stickslip.logs.arrays import Values

FOLLOWS_R2 = 0.98  # R2 of a tag with OP itself, from which on the valve is seen to answer
S_MIN_PERCENT = 1.0  # % of OP span: a smaller band is worth no work on a valve
SKIP_SHARE = 0.2  # of the log, until the stem's place no longer depends on where it stood at first
WIDTHS = np.linspace(0.05, 0.95, 19)  # of the range of OP
JUMPS = (0.0, 0.25, 0.5, 0.75, 1.0)  # of S


class Answer(NamedTuple):
    """How plainly the valve does not answer.

    follows : str or None, the tag that follows OP at once; R2_0 [-] the largest squared correlation with OP
    gain : float [-], 0 where no tag shows a band; S [% of OP span] the band; tag that shows it
    """

    follows: str | None
    R2_0: float
    gain: float
    S: float
    tag: str | None


def answer_of(op: Values, tags: Mapping[str, Values]) -> Answer:
    """The answer of the tags (n,) to OP (n,) [% of span].

    >>> t = np.arange(2000.0)
    >>> u = 50 + 5 * np.sin(t / 20)
    >>> found = answer_of(u, {"flow": 3 * stick(u, 4.0, 1.0) + 7, "other": np.sin(t / 33)})
    >>> found.follows, found.tag, round(found.S, 1)  # in steps of 5 % of OP's travel, 0.5 here
    (None, 'flow', 4.0)
    >>> answer_of(u, {"flow": 3 * u + 7}).follows
    'flow'
    """
    travel, skip = float(np.ptp(op)), int(SKIP_SHARE * len(op))
    if travel <= 0.0 or not tags or len(op) - skip < 20:
        return Answer(None, 0.0, 0.0, 0.0, None)
    S = np.concatenate([[0.0], np.repeat(travel * WIDTHS, len(JUMPS))])
    J = np.concatenate([[0.0], np.outer(travel * WIDTHS, JUMPS).ravel()])
    R2 = without_line(np.array(list(tags.values()))[:, skip:]) @ without_line(stick(op, S, J)[skip:].T).T
    R2 = R2**2
    names, direct = list(tags), R2[:, 0]
    top = int(np.argmax(direct))
    follows = names[top] if direct[top] >= FOLLOWS_R2 else None
    wide = S >= S_MIN_PERCENT
    if not wide.any():
        return Answer(follows, float(direct[top]), 0.0, 0.0, None)
    best = np.argmax(np.where(wide, R2, -1.0), axis=1)
    reached = R2[np.arange(len(names)), best]
    gains = np.log(np.maximum(1.0 - direct, 1e-9) / np.maximum(1.0 - reached, 1e-9))
    if follows is not None:
        gains = np.log(max(1.0 - float(direct[top]), 1e-9) / np.maximum(1.0 - reached, 1e-9))
    i = int(np.argmax(gains))
    if gains[i] <= 0.0:
        return Answer(follows, float(direct[top]), 0.0, 0.0, None)
    return Answer(follows, float(direct[top]), float(gains[i]), float(S[best[i]]), names[i])


def without_line(rows: Values) -> Values:
    """Return rows (m, n) less their straight lines, of length 1; 0 for a row that does not move."""
    n = rows.shape[1]
    basis = np.linalg.qr(np.column_stack([np.ones(n), np.arange(n) / n]))[0]
    left = rows - (rows @ basis) @ basis.T
    norm = np.linalg.norm(left, axis=1, keepdims=True)
    still = norm <= 1e-9 * np.linalg.norm(rows, axis=1, keepdims=True)
    return np.asarray(np.where(still, 0.0, left / np.maximum(norm, 1e-300)))

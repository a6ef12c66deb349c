"""Slips of a valve seen in another tag: it jumps each time OP has come back by the same travel, and stands before.

    r_k    what a tag y does within two samples beyond its slopes before and after
    jump   |r| above ``SIGMAS`` of its noise, ``SHARE`` of the range of y and ``STEEP`` times the slopes on either side;
           of a tag, those of at least ``MAIN`` of its largest ones; where these say nothing, of ``LARGER`` of them:
           a valve slips by J each time, and smaller jumps are another's
    S_i    travel of OP to a jump that goes the other way than the one before: from where OP was furthest since, if the
           stem slid along with it; from where OP first turned back, if the stem stood from there on while OP came again
           by less than J; or from where OP was at that jump, if the stem stood; whichever scatters least
    stood  the part of a jump that y has covered already while OP came back

A valve that sticks lets OP travel by S and then slips, so that the flow through it, and what hangs on that flow, jump.
A valve with a deadband but no jump makes a kink. Where something outside makes y jump and the valve answers, integral
action takes the whole jump back before the next, and ``stood`` is 1. Called are slips where S is known to
``KNOWN_SHARE`` from ``REVERSALS`` reversals or more, or from ``AGREEING`` that agree, nearly all jumps go the way that
OP moves (or the other way), OP never came back by more than S without one, and y stood. A stem that slides one way and
stands the other scatters both readings of S: then S is that of the stems of some S and J whose slips and the jumps of y
meet. Of several loops, jumps at the same instants belong to that whose stem, by S and J = S / 5, tells a tag best.

Blind where OP travels by more than J in some three samples, and to jumps below ``SHARE`` of what else moves the tag.
The idea and the limits are ours.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from stickslip.detect.plantwide.answers import without_line
from stickslip.detect.stem.stick import stick
from stickslip.logs.arrays import Indices, Values
from stickslip.logs.normal import half_of_median, spread

SIDE_SAMPLES = 4  # samples of the slope on either side
SIGMAS, SHARE, STEEP = 8.0, 0.005, 2.5
MAIN, LARGER = 0.3, 0.5  # of the largest jumps of a tag; asked first with ``MAIN``, then of the larger ones alone
REVERSALS = 4
AGREEING, AGREE = 3, 0.02  # fewer reversals do where S ranges over no more than this share of it
KNOWN_SHARE = 0.03  # half of the 90 % interval of S, over S
EVEN = 1e-3  # of S: in an even cycle no reading scatters, and the first is taken
SAME_WAY_SHARE = 0.75  # share of the jumps that go the same way as OP, or against it
BEYOND, BACK = 1.2, 0.1  # of S, that OP may come back without a jump, and in which share of the cases more
SHARES = np.array([0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.65, 0.9])  # J over S of the stems that are tried
IN_TIME_SHARE = 0.9  # share of the slips of a stem, and of the jumps, that come within a sample of each other
STOOD_SHARE = 0.8  # of a jump; other signals that drift while the valve stands may move y, too
S_MIN_PERCENT = 1.0  # % of OP span
TAKEN_SHARE = 0.5  # of the jumps of a tag, that come within a sample of another loop's, from which on they are its
NEARLY = (0.85, 0.9, 0.95, 0.98)  # of S
SKIP_SHARE = 0.2  # of the log, until the stem's place no longer depends on where it stood at first


class Jumps(NamedTuple):
    """Where a tag jumps: the sample before each jump (m,), and its size (m,) [unit of the tag]."""

    at: Indices
    size: Values


class Slips(NamedTuple):
    """Slips of a sticky valve: S with its 90 % interval [% of OP span], the tag that jumps, how often it turned.

    ``correlation`` is the correlation of the tag with a stem of that S, less straight lines [-].
    """

    S: float
    low: float
    high: float
    tag: str
    reversals: int
    correlation: float

    def to_dict(self) -> dict[str, float | str]:
        """Return the slips as plain values that JSON can hold."""
        return {"S": self.S, "low": self.low, "high": self.high, "tag": self.tag, "reversals": self.reversals,
                "correlation": self.correlation}  # fmt: skip


def jumps_of(y: Values) -> Jumps:
    """Return where a tag y (n,) jumps within two samples.

    >>> t = np.arange(400.0)
    >>> jumps_of(np.sin(t / 40) + (t > 100) - (t > 300)).at.tolist()
    [100, 300]
    """
    d = np.diff(y)
    n = len(d)
    if n < 4 * SIDE_SAMPLES:
        return Jumps(np.empty(0, dtype=np.intp), np.empty(0))
    slope = np.median(np.lib.stride_tricks.sliding_window_view(d, SIDE_SAMPLES), axis=1)
    k = np.arange(SIDE_SAMPLES, n - SIDE_SAMPLES - 1)
    before, after = slope[k - SIDE_SAMPLES], slope[k + 2]
    r = d[k] + d[k + 1] - before - after
    near = np.maximum(np.maximum(np.abs(before), np.abs(after)), np.abs(d[k + 2]))
    noise = spread(r)
    high = np.flatnonzero((np.abs(r) > max(SIGMAS * noise, SHARE * float(np.ptp(y)))) & (np.abs(r) > STEEP * near))
    if not len(high):
        return Jumps(np.empty(0, dtype=np.intp), np.empty(0))
    runs = np.split(high, np.flatnonzero(np.diff(high) > 2) + 1)
    top = np.array([run[np.argmax(np.abs(r[run]))] for run in runs])
    size = r[top]
    main = np.abs(size) >= MAIN * np.percentile(np.abs(size), 90)
    top, size = top[main], size[main]
    at = k[top]
    return Jumps(at + (np.abs(d[at + 1]) > np.abs(d[at])), size)  # before the larger of the two steps


def larger(jumps: Jumps) -> Jumps:
    """Return those of the jumps of at least ``LARGER`` of the largest.

    >>> larger(Jumps(np.arange(4), np.array([1.0, -0.9, 0.4, 1.0]))).at.tolist()
    [0, 1, 3]
    """
    size = np.abs(jumps.size)
    kept = size >= LARGER * np.percentile(size, 90) if len(size) else np.empty(0, dtype=bool)
    return Jumps(jumps.at[kept], jumps.size[kept])


def slips_of(op: Values, y: Values, jumps: Jumps, tag: str) -> Slips | None:
    """Return the slips that the ``jumps`` of a tag y (n,) show for a valve of OP ``op`` (n,) [% of span], or None.

    >>> t = np.arange(3000.0)
    >>> u = 50 + 5 * np.sin(t / 60) + 2 * np.sin(t / 171)
    >>> flow = 3 * stick(u, 4.0, 1.0) + np.sin(t / 100)
    >>> found = slips_of(u, flow, jumps_of(flow), "FI1")
    >>> round(found.S, 1), found.reversals > 10
    (4.0, True)
    >>> slips_of(u, stick(u, 4.0, 0.0), jumps_of(stick(u, 4.0, 0.0)), "FI2") is None  # a deadband
    True
    """
    at, size = jumps
    if len(at) <= AGREEING:
        return None
    agree = np.sign(op[at] - op[at - SIDE_SAMPLES]) * np.sign(size)
    sign = 1.0 if agree.sum() >= 0.0 else -1.0
    if np.mean(agree == sign) < SAME_WAY_SHARE:
        return None
    at, size = at[agree == sign], size[agree == sign]  # the others have another source
    way = sign * np.sign(size)
    slid, still, paused, stood, beyond = [], [], [], [], []
    for a, b, old, new in zip(at[:-1], at[1:], way[:-1], way[1:], strict=True):
        ahead = old * op[a + 1 : b + 1]
        if new != old:
            furthest, here = int(np.argmax(ahead)), 0.5 * old * float(op[b] + op[b + 1])  # it slips between two samples
            slid.append(float(ahead[furthest]) - here)
            still.append(float(ahead[0]) - here)
            stood.append(float(new * sign * (y[b] - y[a + 1 + furthest])))
            paused.append(float(ahead[int(np.argmax(np.diff(ahead, append=ahead[-1]) < 0.0))]) - here)
        else:
            beyond.append(float(np.max(np.maximum.accumulate(ahead) - ahead)))
    ways = [np.array(each) for each in (slid, still, paused)]
    same = min(_scatter(float(np.ptp(each)), float(np.median(each))) if len(each) else 1.0 for each in ways)
    if len(slid) < (AGREEING if same <= AGREE else REVERSALS) or float(np.median(stood)) > STOOD_SHARE * float(
        np.median(np.abs(size))
    ):
        return None
    middle, half = min((_middle(each) for each in ways), key=lambda one: max(_scatter(one[1], one[0]), EVEN))
    missed = np.mean(np.array(beyond) > BEYOND * middle) if beyond else 0.0
    after = int(SKIP_SHARE * len(op))
    if half > KNOWN_SHARE * middle or missed > BACK:
        middle, half = _timed(op, at, way, _middle(np.array(slid))[0], after)
    if middle < S_MIN_PERCENT or half > KNOWN_SHARE * middle:
        return None
    stems = stick(op, *_stems(middle))[after:].T
    correlation = float(np.max(sign * (without_line(stems) @ without_line(y[None, after:])[0])))
    return Slips(middle, middle - half, middle + half, tag, len(slid), correlation) if correlation > 0.0 else None


def _stems(S: float) -> tuple[Values, float, Values]:
    """Return S (m,), J and starts (m,) of stems of about S; of all of it, or from its middle, one may never slip."""
    sizes, starts = np.meshgrid(S * np.array(NEARLY), (-1.0, 0.0, 1.0))
    return sizes.ravel(), 0.2 * S, starts.ravel()


def _timed(op: Values, at: Indices, way: Values, S: float, after: int) -> tuple[float, float]:
    """Return S and half of its range, of those stems of about S that slip when y jumps; (1, inf) where none does."""
    sizes = np.repeat(S * np.linspace(0.85, 1.15, 31), len(SHARES))
    d = np.diff(stick(op, sizes, sizes * np.tile(SHARES, 31)), axis=0)
    moves = np.abs(d) > 1e-9 * float(np.ptp(op))
    d[1:][moves[:-1]] = 0.0  # what is left are first moves after a stand
    slip = np.asarray(np.sign(d) * moves)[after:]
    seen = np.zeros(len(op) - 1)
    seen[at] = way
    near = np.zeros_like(seen)
    for k in (-1, 1, 0):
        near[at + k] = way
    near, seen = near[after:], seen[after:]
    jumps, asked = max(int(np.count_nonzero(seen)), 1), np.maximum(np.count_nonzero(slip, axis=0), 1)
    met = np.count_nonzero((slip == near[:, None]) & (slip != 0.0), axis=0)
    share = 2.0 * np.minimum(met, jumps) / (jumps + asked)
    good = sizes[share >= max(float(np.max(share)) - 0.03, IN_TIME_SHARE)]
    if not len(good):
        return 1.0, float("inf")
    return 0.5 * float(good.min() + good.max()), 0.5 * float(good.max() - good.min())


def _scatter(wide: float, middle: float) -> float:
    """Return a width over its middle, infinite where the middle is no travel back."""
    return wide / middle if middle > 0.0 else np.inf


def _middle(each: Values) -> tuple[float, float]:
    """Return the median of sizes (m,), above 0, and half of its 90 % interval, for normal scatter."""
    return max(float(np.median(each)), 1e-9), half_of_median(each)


def owners(found: Mapping[str, Mapping[str, Slips]], jumps: Mapping[str, Jumps]) -> dict[str, Slips]:
    """Return the slips of every loop (loop -> tag -> slips): a jump has one source, the loop that explains it best.

    >>> one, two = Slips(4.0, 3.9, 4.1, "FI1", 9, 0.9), Slips(7.0, 6.9, 7.1, "PI1", 9, 0.2)
    >>> at = Jumps(np.arange(0, 900, 90), np.ones(10))
    >>> list(owners({"LC1": {"FI1": one}, "PC1": {"PI1": two}}, {"FI1": at, "PI1": at}))
    ['LC1']
    """
    own: dict[str, Slips] = {}
    taken: list[tuple[str, Indices]] = []
    every = ((loop, one) for loop, by_tag in found.items() for one in by_tag.values())
    for loop, one in sorted(every, key=lambda pair: -pair[1].correlation):
        at = jumps[one.tag].at
        if any(other != loop and np.mean(np.isin(at, claimed)) > TAKEN_SHARE for other, claimed in taken):
            continue
        own.setdefault(loop, one)
        taken.append((loop, (at[:, None] + np.arange(-1, 2)).ravel()))
    return own

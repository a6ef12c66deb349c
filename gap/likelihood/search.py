"""Which effect explains a record: every effect at every place by its score, the likeliest by a fit of their own.

    gain of a size  =  (e . d)^2 / (2 |d|^2)       d: what the size changes in the innovations, less its projection on
                                                   what the free parameters of the model change

The score is that of the model's own filter, so each size costs one run.  The effects of the highest scores get filters
of their own and are fitted with all that is free in the model.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.role import Role
from stickslip.diagram.progress import Progress, reporting
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.fit import Fit, coordinate, refined, tried, value
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import FAR, Hypothesis, Innovations
from stickslip.gap.likelihood.settling import FIRST, free_names, settled
from stickslip.gap.likelihood.sizes import sizes
from stickslip.gap.likelihood.stems import fitted_stem, resting, settled_stem

Floats = NDArray[np.float64]
NOISE = "sensor_noise"
BY_DIGITS = ("quantisation",)  # effects that the digits of a log show, and no likelihood of rows does
TRIED = 10  # effects that are fitted
LAGGING = 25.0  # nats by which a first fit may lag behind the best to be fitted to the end
BAND_NATS, BAND_SHARE = 3.0, 0.25  # that a play has to gain, or of the best gain, before a jump is looked for
APPROACH = 4  # rounds of a fit with the gains of the model before it
STARTS = (0.3, 1.0, 3.0)  # of what the model states of a load, from which its fit begins
CLOSE = 1.0  # nats of scores between which the likelier size counts
WALKED, STEP = 8, 0.25  # steps towards the likeliest size, and the first of a coordinate, where no slope shows it
SECANTS = 3  # from neutral to a first size, each nearer to the likeliest
AT_BOUND = 0.01  # share of a bound, within which a parameter stands at it
GROSS = 3.0  # mean square of innovations, each at most as far as counts in full
CALM = 4.0  # standard deviations from which on innovations count less


@dataclass(frozen=True, eq=False)
class Candidate:
    """The best first size of an effect: ``looked`` with the gains of the model, the ``gain`` of its score [nats], and
    the ``direction`` of what it changes, (rows, signals), of unit length.
    """

    looked: Innovations
    gain: float
    direction: Floats


def model_alone(frame: Frame) -> Fit:
    """Return the model without an effect, all that is free in it fitted.

    Raises ``ArithmeticError`` where the model cannot be run along the record.
    """
    one = Hypothesis(frame)
    best = known = one.filtered({})
    for load in (n for n in frame.noise if n.correlation_time > 0.0):
        near = best.values
        for by_sd in STARTS:
            for by_time in STARTS:
                sd, time = f"{load.block}.sd", f"{load.block}.correlation_time"
                other = {sd: near[sd] * by_sd, time: near[time] * by_time}
                found = one.noisier(known, {**best.values, **other})
                best = found if found.nll < best.nll else best
    if best is not known:
        best = best.again()
    return refined(best, tuple(frame.free))


def legal(null: Fit, catalogue: Iterable[Effect]) -> list[Hypothesis]:
    """Return the hypotheses that a catalogue has for a record.

    Noise within the bounds of every fit is no effect: more noise is one where the model alone wants more than that.
    """
    frame = null.hypothesis.frame
    left_out: tuple[str, ...] = BY_DIGITS if at_bound(null) else (*BY_DIGITS, NOISE)
    return [
        Hypothesis(frame, resting(effect) if frame.scanned else effect, place)
        for effect in catalogue if not effect.of_log and effect.name not in left_out
        for place in effect.places(frame.model)
    ]  # fmt: skip


def candidates(null: Fit, hypotheses: Sequence[Hypothesis], progress: Progress = None) -> list[Candidate]:
    """Return the best first size of every hypothesis that the record feels, the highest score first."""
    found = []
    stated = tried(null.hypothesis, null.hypothesis.frame.stated) if gross(null) else None
    near = stated or null.best
    quiet = null.hypothesis.frame.quiet
    with reporting(progress, len(hypotheses), "effects") as tell:
        for k, one in enumerate(hypotheses):
            # what a controller computes is known so well that gains of another controller tell nothing of it
            own = stated is not None and quiet[one.place].role is Role.CONTROLLER
            best = _best_size(null, one, near, own)
            if best is not None:
                found.append(best)
            tell(k + 1, len(hypotheses))
    return sorted(found, key=lambda c: -c.gain)


def fitted(null: Fit, found: Sequence[Candidate], progress: Progress = None) -> list[Fit]:
    """Return the fits of the candidates of the highest scores, the likeliest first."""
    first: list[Fit] = []
    # scores say little of what hides a mode; a stem that jumps begins with the one that does not
    chosen = [*found[:TRIED], *(c for c in found[TRIED:] if c.looked.hypothesis.hides)]
    chosen.sort(key=lambda c: (c.looked.hypothesis.hides, bool(c.looked.hypothesis.nests)))
    with reporting(progress, len(chosen), "fits") as tell:
        for k, one in enumerate(chosen):
            fit = _first_fit(null, one, first)
            if fit is not None:
                first.append(fit)
            tell(k + 1, len(chosen))
    first.sort(key=price)
    near = [fit for fit in first if price(fit) < price(first[0]) + LAGGING] if first else []
    return sorted((settled_stem(fit) if fit.hypothesis.hides else settled(fit) for fit in near), key=price)


def _first_fit(null: Fit, one: Candidate, found: Sequence[Fit]) -> Fit | None:
    """Return the first fit of a candidate; ``found`` those before it."""
    mine = one.looked.hypothesis
    if mine.hides:
        band = next((f for f in found if _is_without_jump(f.hypothesis, mine)), None)
        most = max((null.nll - f.nll for f in found), default=0.0)
        if mine.nests and (band is None or null.nll - band.nll < max(BAND_NATS, BAND_SHARE * most)):
            return None  # what no play explains to some part no stem that jumps explains
        return fitted_stem(null, mine, band)
    start = _own_filter(null, one)
    return None if start is None else refined(start, free_names(start.hypothesis), FIRST)


def _is_without_jump(narrow: Hypothesis, wide: Hypothesis) -> bool:
    """Return whether a hypothesis is that of another stem, at the same place, without its jump."""
    return narrow.place == wide.place and narrow.effect is not None and narrow.effect.name == wide.nests


def price(fit: Fit) -> float:
    """Return the nll and what the parameters of an effect cost [nats]."""
    return fit.nll + schwarz(free_parameters(fit.best), float(np.isfinite(fit.best.judged).sum()))


def schwarz(parameters: int, values: float) -> float:
    """Return what parameters cost by Schwarz's criterion, half ln n each [nats]."""
    return 0.5 * parameters * math.log(max(values, 2.0))


def free_parameters(left: Innovations) -> int:
    """Return how many parameters of its effect a hypothesis uses."""
    effect = left.hypothesis.effect
    return sum(math.isfinite(left.values[p.name]) for p in effect.parameters) if effect else 0


def _own_filter(null: Fit, one: Candidate) -> Innovations | None:
    """Return a filter of its own of a candidate, its size fitted with the gains of the model before."""
    hypothesis = one.looked.hypothesis
    effect = hypothesis.effect
    assert effect is not None
    names = [name for name in free_names(hypothesis) if name not in hypothesis.noise_keys]
    if gross(null):
        size = _walked(one.looked, one.looked)
        return tried(hypothesis, size.values)
    near = refined(one.looked, names, APPROACH, null.best).best
    own = tried(hypothesis, near.values)
    return own if own is not None else tried(hypothesis, one.looked.values)


def _walked(start: Innovations, near: Innovations) -> Innovations:
    """Return the likeliest sizes of an effect near a start, all with the gains of ``near``, step by step."""
    one = start.hypothesis
    names = [p.name for p in one.effect.parameters if not p.nuisance and math.isfinite(start.values[p.name])] \
        if one.effect else []  # fmt: skip
    best = tried(one, start.values, near)
    if best is None:
        return start
    ends = {name: [coordinate(one, name, end) for end in one.bounds[name]] for name in names}
    step = {name: STEP * min(high - low, 1.0) for name, (low, high) in ends.items()}
    for _ in range(WALKED):
        moves = [(name, way) for name in names for way in (1.0, -1.0)]
        ahead = []
        for name, way in moves:
            at = coordinate(one, name, best.values[name]) + way * step[name]
            ahead.append(tried(one, {**best.values, name: value(one, name, at)}, near))
        found = min((x for x in ahead if x is not None), key=lambda x: x.nll, default=None)
        if found is None or found.nll >= best.nll:
            step = {name: 0.5 * size for name, size in step.items()}
        else:
            best = found
    return best


def _best_size(null: Fit, one: Hypothesis, model: Innovations, own: bool) -> Candidate | None:
    """Return the size of the highest score with the gains of the ``model`` or its ``own``; None if none is felt."""
    near = None if own else model
    best: Candidate | None = None
    at = one.frame.stated if gross(null) else {key: null.best.values[key] for key in one.frame.free}
    for size in sizes(null, one):
        looked = tried(one, {**at, **size}, near)
        scored = None if looked is None else score(null, looked)
        if looked is None or scored is None:
            continue
        if gross(null):
            scored = null.nll - looked.nll, scored[1]
        if (
            best is None
            or scored[0] > best.gain + CLOSE
            or (scored[0] > best.gain - CLOSE and looked.nll < best.looked.nll)
        ):
            best = Candidate(looked, *scored)
    if best is None or not gross(null):
        return best
    nearer = _towards_neutral(best.looked, model, near)
    scored = score(null, nearer)
    return best if scored is None else Candidate(nearer, null.nll - nearer.nll, scored[1])


def _towards_neutral(looked: Innovations, base: Innovations, near: Innovations | None) -> Innovations:
    """Return the likelier of a size and what secants from neutral, ``base``, propose: it may be far too large."""
    one, nominal = looked.hypothesis, looked.hypothesis.nominal
    names = [p.name for p in one.effect.parameters if not p.nuisance] if one.effect else []
    if len(names) != 1 or not math.isfinite(nominal[names[0]]):
        return looked
    name = names[0]
    start, weight = coordinate(one, name, nominal[name]), _less_far_from_usual(np.nan_to_num(base.e))
    for _ in range(SECANTS):
        d = np.nan_to_num(looked.e - base.e) * weight
        share = -float(np.sum(np.nan_to_num(base.e) * weight * d)) / max(float(np.sum(d**2)), 1e-300)
        at = coordinate(one, name, looked.values[name])
        ahead = tried(one, {**looked.values, name: value(one, name, start + share * (at - start))}, near)
        if ahead is None or ahead.nll >= looked.nll:
            break
        looked = ahead
    return looked


def gross(null: Fit) -> bool:
    """Return whether the model is so far from the log that its own gains say nothing of anything else.

    So are those of a model whose noise, or a load, wants to be larger than it can be.
    """
    if at_bound(null):
        return True
    return float(np.nanmean(np.minimum(np.abs(null.best.judged), FAR) ** 2)) > GROSS


def at_bound(null: Fit) -> bool:
    """Return whether noise, or a load, wants to be larger or slower than every fit lets it."""
    one, values = null.hypothesis, null.best.values
    known = [(values[name], *one.bounds[name]) for name in sorted(one.noise_keys & values.keys())]
    return any(min(now / low, high / now) < 1.0 + AT_BOUND for now, low, high in known)


def score(null: Fit, looked: Innovations) -> tuple[float, Floats] | None:
    """Return the gain that the score promises [nats], and the direction of the change; None where nothing is felt."""
    weight = trusted(null)
    d = np.nan_to_num(looked.e - null.best.e) * weight
    for slope in basis(null):
        d = d - slope * float(np.sum(slope * d))
    length = float(np.linalg.norm(d))
    if not 1e-6 < length < math.inf:
        return None
    direction = d / length
    along = -float(np.sum(np.nan_to_num(null.best.e) * weight * direction))
    return 0.5 * max(along, 0.0) ** 2, direction


def trusted(fit: Fit) -> Floats:
    """Return the weight of each innovation, (rows, signals): 1, less far from usual, 0 in rows that do not count.

    It is that of Student's law, so that the score of a model that is far from the log is not that of a few rows.
    """
    e = np.nan_to_num(fit.best.e)
    rows = fit.hypothesis.frame.counted
    return np.asarray(rows[:, None] * _less_far_from_usual(e))


def _less_far_from_usual(e: Floats) -> Floats:
    return np.asarray(1.0 / np.sqrt(1.0 + (e / CALM) ** 2))


def basis(fit: Fit) -> Floats:
    """Return an orthonormal basis of what the free parameters of a fit change, (k, rows, signals)."""
    if not len(fit.slopes):
        return fit.slopes
    flat = (fit.slopes * trusted(fit)).reshape(len(fit.slopes), -1)
    flat = flat[np.sqrt(np.sum(flat**2, axis=1)) > 1e-3]
    q, _ = np.linalg.qr(flat.T)
    return np.asarray(q.T.reshape(-1, *fit.slopes.shape[1:]))

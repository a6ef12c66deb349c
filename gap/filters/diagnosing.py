"""Diagnose a record with the filter of its model: settle, rank, check, and say what was found.

1. A gap if the model as it is leaves innovations that are not white, or an effect gains more than noise lets it.
2. Textures first: what the digits of the log tell needs no search.  Then all effects that a filter has, by likelihood.
   That a stem may stick is said by a bank of few stems, before any fit: stems that stick must be likelier than stems
   that do not.  Slower scans and stems that stick are fitted last, and only while nothing else is adequate: they cost
   most.
3. An explanation is adequate if its own innovations pass all checks; else it is "unknown".
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.progress import Progress
from stickslip.gap.answers.evidence import Evidence
from stickslip.gap.effects.compression import Compression
from stickslip.gap.effects.disturbance import Disturbance
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.effects.scan_time import ScanTime
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.effects.stiction import Stiction
from stickslip.gap.filters.adequacy import LIMIT, LIMIT_LARGEST, adequate, explained, passes, rival, white, worst
from stickslip.gap.filters.affine import NotAffine
from stickslip.gap.filters.beside import firsts, has_matrix, in_its_place, with_effect
from stickslip.gap.filters.digits import coarse_sensor, compressed
from stickslip.gap.filters.explaining import first_looks, fitted, ranked, settled, total
from stickslip.gap.filters.filtering import Explanation, Filtered
from stickslip.gap.filters.fitting import Found
from stickslip.gap.filters.hysteresis import DECIDED, Looked, fitted_stems, left, looked_at
from stickslip.gap.filters.jumping import decided
from stickslip.gap.filters.logged_stem import LoggedStem
from stickslip.gap.filters.reading import Filtering
from stickslip.gap.filters.rivals import TIE
from stickslip.gap.filters.scanned import base_period
from stickslip.gap.filters.summed import with_outputs
from stickslip.gap.floors.floor import settling_rows
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import nuisances, silenced, stated_about
from stickslip.gap.records.record import Record
from stickslip.gap.records.regular import without_unsettled
from stickslip.gap.records.start import start_values

NEEDED = 6.5  # nats that an effect must gain: noise alone gains as much in one of 300 records
CLEAR = 20.0  # nats by which the likeliest generic rival of a sure name is worse
HOPE = 0.5  # share of what a first effect leaves, that a second takes away at the first look
STEM = 0.05  # share of the best explanation's gain that few stems must gain for a bank to be fitted
STICTION = 16.0  # nats that a stem must gain where something else is wrong: a bank of stems is no more exact


@dataclass(frozen=True, eq=False)
class Outcome:
    """What was found: ``plain`` the model as it is; ``found`` explanations, the best first; ``same`` those that cannot
    be told apart from the best, none where none is adequate; ``textured`` whether digits told; ``stem`` what a logged
    stem says; ``looked`` what few stems say of each valve.
    """

    plain: Found
    found: Sequence[Found]
    same: Sequence[Found]
    gap: bool
    textured: bool = False
    stem: LoggedStem | None = None
    looked: Sequence[Looked] = ()
    firsts: Sequence[Found] = ()

    @cached_property
    def best(self) -> Filtered:
        """The best explanation, or the model as it is."""
        return self.found[0].best if self.found else self.plain.best

    @cached_property
    def evidence(self) -> Evidence:
        """What the answer rests on."""
        best = self.found[0] if self.found else None
        gained = self.plain.nll - total(best) if best else 0.0
        if not self.gap:
            return Evidence("none", max(gained, 0.0))
        if self.textured:
            return Evidence("filter, digits", gained)
        share = explained(self.plain, best) if best else 0.0
        if not self.same or best is None:
            return Evidence("filter, unknown", gained, share)
        behind = [total(one) for one in self.found if one not in self.same]
        margin = min(behind) - total(best) if behind else gained
        if self.firsts:
            return Evidence("pair" if rival(best.best).behind >= CLEAR else "filter, rivalled", gained, share, margin)
        one = best.best.explanation
        if one.sticks and one.effect is not None:
            return Evidence(f"filter, {one.effect.name}", gained, share, margin)
        return Evidence(_kind(best.best), gained, share, margin)


def _kind(best: Filtered) -> str:
    """Return what the name of an effect without a hidden mode rests on."""
    effect = best.explanation.effect
    if not passes(best):
        return "filter, nearly"
    if rival(best).behind < CLEAR:
        return "filter, rivalled"
    if isinstance(effect, Disturbance):
        return "filter, load"
    return "filter, noise" if isinstance(effect, SensorNoise) else "filter, white"


def filtering_of(diagram: Diagram, record: Record, asked: bool = True) -> Filtering | None:
    """Return the filter's view of a record; None for a diagram that has no such filter.

    ``asked``: whether the filter is run to see that there is one; who runs it anyhow sees a ``ValueError``.

    It needs a load that nobody measures, blocks that scan in step with the log's rows, and controllers, each with its
    measurement logged, and its output, itself or with logged signals added.
    """
    coloured = any(one.correlation_time > 0.0 for one in nuisances(diagram))
    period, dt = base_period(diagram), record.log.dt
    if not coloured or period <= 0.0 or abs(dt / period - round(dt / period)) > 1e-6 or round(dt / period) < 1:
        return None
    if float(np.ptp(np.diff(record.log.t))) > 1e-6 * dt:
        return None
    quiet = silenced(diagram)
    acting = [b for b in quiet.blocks if b.role is Role.CONTROLLER and b.sampled]
    if any(b.limit_params is None for b in acting):  # a program of its own: nobody knows when it bends
        return None
    outputs = tuple(str(b.output_labels[0]) for b in acting)
    record = with_outputs(quiet, record, outputs)
    settling = math.ceil(settling_rows(quiet, record))
    record = replace(record, log=without_unsettled(record.log, record.played, record.pinned, settling))
    start = start_values(quiet, record)
    leads = np.zeros((len(record.played), len(record.log)), dtype=np.int64)
    found = Filtering(Given(diagram.starting_at(start)), record, leads)
    try:
        measured = {str(quiet[name].loop_signal("PV")) for name in found.controllers}
        if not measured | set(found.ops) <= set(found.signals):
            return None
        if asked:
            Explanation(found).filtered({})
    except (NotAffine, np.linalg.LinAlgError, ValueError):
        return None
    return found


def outcome(
    f: Filtering,
    catalogue: Sequence[Effect],
    seed: int = 0,
    progress: Progress = None,
    stem: LoggedStem | None = None,
) -> Outcome:
    """Return what explains a record, one effect, or two where none is enough alone.

    ``stem`` is what a logged stem says, which decides what can be.
    """
    alone = _by_one(f, catalogue, seed, progress, stem)
    if not alone.gap or alone.same or (stem is not None and not stem.follows):
        return alone
    for first in firsts(alone.found):
        within = first.nll - HOPE * max(first.nll - white(first.best), 0.0)
        try:
            both = _explained(with_effect(first), catalogue, seed, progress, stem, within)
        except NotAffine:
            continue
        if both.same and _named_together(alone.found[0], first, both.same):
            if _stated_wrongly(first):
                return replace(both, plain=alone.plain)
            same = in_its_place(first, both.same[0], alone.found, alone.plain.nll)
            return replace(both, plain=alone.plain, firsts=same)
    return alone


def _named_together(best: Found, first: Found, second: Sequence[Found]) -> bool:
    """Return whether two effects are named: a best single one that cannot be the first has to be the second.

    No generic rival of the second may be near: two effects have sizes enough to stand for one that no catalogue has.
    """
    one = best.best.explanation
    there = has_matrix(one) or any((x.best.explanation.effect, x.best.explanation.place) == (one.effect, one.place)
                                   for x in second)  # fmt: skip
    return there and rival(second[0].best).behind >= NEEDED


def _stated_wrongly(one: Found) -> bool:
    """Return whether an effect is more or less noise of a sensor, no more than nobody knows of what a model states."""
    e = one.best.explanation
    if not isinstance(e.effect, SensorNoise):
        return False
    settings = e.effect.settings(e.filtering.model, e.place, **{name: one.best.values[name] for name in e.own})
    return all(low <= settings[key] <= high for key, (low, high) in e.filtering.given.random.items() if key in settings)


def _by_one(
    f: Filtering, catalogue: Sequence[Effect], seed: int, progress: Progress, stem: LoggedStem | None
) -> Outcome:
    """Return which single effect explains a record.

    Noise and loads are as the model states them.  Where nothing else explains the record then, or noise alone does,
    they are fitted as well: nobody knows them exactly.  That counts if the record is likelier then by Schwarz's price.
    """
    stated = _explained(f, catalogue, seed, progress, stem)
    noisy = all(isinstance(one.best.explanation.effect, SensorNoise) for one in stated.same)
    if not (stated.gap and noisy):
        return stated
    loose = _explained(replace(f, loose=True), catalogue, seed, progress, stem)
    price = 0.5 * len(stated_about(f.model)) * math.log(len(f.Y))
    other = stated.plain.nll if stated.same else stated.best.nll  # a noise that is named is one that is stated wrongly
    unexplained = loose.gap and not loose.same
    return stated if unexplained or loose.best.nll > other - price else loose


def _explained(
    f: Filtering, catalogue: Sequence[Effect], seed: int, progress: Progress, stem: LoggedStem | None,
    within: float = math.inf,
) -> Outcome:  # fmt: skip
    """Return what explains a record, with noise and loads fitted or not, as ``f`` has them.

    ``within``: nll that the likeliest first look has to come to, or nothing is fitted.
    """
    if stem is not None:
        catalogue = stem.possible(catalogue)
    elsewhere = stem is not None and not stem.follows
    plain = settled(replace(f, catalogue=tuple(catalogue)))
    f = plain.best.explanation.filtering
    legal = [(effect, place) for effect in catalogue for place in f.given.places(effect)]
    for effect, place in legal:
        if isinstance(effect, Quantisation):
            found = coarse_sensor(plain, effect, place)
            if found is not None:
                return Outcome(plain, (found,), (found,), True, True, stem)
    for effect in catalogue:
        if isinstance(effect, Compression):
            found = compressed(plain, effect, next(iter(effect.places(f.model)), "historian"), seed)
            if found is not None and passes(found.best):
                return Outcome(plain, (found,), (found,), True, True, stem)
    looked = _looked(plain, legal) if stem is None or elsewhere else []
    shown = max((one.gained for one in looked), default=0.0)
    scans = [effect for effect in catalogue if isinstance(effect, ScanTime)]
    others = [effect for effect in catalogue if effect not in scans]
    first = first_looks(plain, others, progress)
    if min([plain.nll - shown, *(one.nll for one in first)]) > within:
        return Outcome(plain, (), (), True, stem=stem, looked=looked)
    fits = fitted(plain, first, _within_reach(plain, looked))
    gained = plain.nll - total(fits[0]) if fits else 0.0
    clean = worst(plain.best)[1] <= LIMIT and not elsewhere and gained < NEEDED
    if clean and shown < NEEDED:
        return Outcome(plain, fits, (), False, stem=stem, looked=looked)
    slower = ranked(plain, scans) if scans and not (clean or (fits and adequate(plain, fits[0]))) else []
    fits = sorted([*fits, *slower], key=total)
    gained = plain.nll - total(fits[0]) if fits else 0.0
    stems: list[tuple[Found, ...]] = []
    if clean or not fits or not adequate(plain, fits[0]):
        stems = _stems(looked, legal, 0.0 if elsewhere else max(NEEDED if clean else STICTION, STEM * gained))
        sticking = [one for one, *_ in stems]
        if shown >= STICTION and not any(adequate(plain, one) for one in sticking):
            fits = sorted([*fitted(plain, first), *slower], key=total)  # a stem was no rival after all
        fits = sorted([*fits, *sticking], key=total)
    if fits and plain.nll - total(fits[0]) >= NEEDED and adequate(plain, fits[0]):
        same = [one for one in fits if total(one) <= total(fits[0]) + TIE and one.nll <= fits[0].nll + TIE]
        same += [other for one, *others in stems if one in same for other in others]
        fits = [*same, *(one for one in fits if one not in same)]
        return Outcome(plain, fits, same, True, stem=stem, looked=looked)
    return Outcome(plain, fits, (), not clean, stem=stem, looked=looked)


def _looked(plain: Found, legal: Sequence[tuple[Effect, str]]) -> list[Looked]:
    """Return what few stems say of each valve that may stick."""
    try:
        return [looked_at(plain, place) for place in dict.fromkeys(at for effect, at in legal if effect.hidden)]
    except NotAffine:
        return []


def _within_reach(plain: Found, looked: Sequence[Looked]) -> float:
    """Return the nll that a stem that sticks may come to: what a bank gains, but no less than what a bank leaves.

    Stems that do not stick may leave much more than the model as it is.
    """
    return min((max(plain.nll - one.gained, min(flat.nll for flat in one.flat)) for one in looked), default=math.inf)


def _stems(looked: Sequence[Looked], legal: Sequence[tuple[Effect, str]], needed: float) -> list[tuple[Found, ...]]:
    """Return the best deadband of each valve, or the best stiction where its jump gains enough, or both where the
    record does not tell them apart.
    """
    kept: list[tuple[Found, ...]] = []
    for one in looked:
        effects = [effect for effect, at in legal if effect.hidden and at == one.place]
        found = fitted_stems(one, effects, needed)
        flat = [fit for fit in found if len(fit.best.explanation.own) == 1]
        stuck = [fit for fit in found if fit not in flat]
        stiction = next((effect for effect in effects if isinstance(effect, Stiction)), None)
        open_still = flat and not (stuck and stuck[0].nll < flat[0].nll - DECIDED)
        if stiction is None or not open_still or min(worst(fit.best)[1] for fit in found) > LIMIT_LARGEST:
            kept += [(fit,) for fit in stuck or flat]
            continue
        best = decided(flat[0].best, stiction, [fit.best for fit in stuck])
        kept.append(tuple(Found(left(x.explanation, x.values), (), np.zeros((0, 0))) for x in best))
    return kept

"""Whether a record moves by jumps, as a stem that sticks or has play makes it: no load follows these.

    F_load(record) < SHARE F_load(model with the stem)        F_load what is left, beyond the level without a gap, by a
                                                              load that nobody measures, and its price (unmeasured)

Whatever else is in the record beside the stem makes it only harder to explain by a load.  So where a load explains a
record much better than it would with the stem, there is none, whatever the stem explains of it.
"""

from dataclasses import replace

from stickslip.gap.explanations.unmeasured import UnmeasuredLoad, unmeasured_load
from stickslip.gap.fits.search import Fit
from stickslip.gap.floors.floor import without_gap
from stickslip.gap.floors.problem import Problem, Settled

SHARE = 0.55  # 0.56 to 1.3 of tuning records with a stem beside another effect, 0.21 to 0.51 of those without one
SEED = 77  # of the run with the stem


def too_smooth(problem: Problem, stem: Fit, load: UnmeasuredLoad | None) -> bool:
    """Return whether a load explains far more of a record than it could if this stem stuck, alone or with another
    effect.

    ``load``: what explains the record; False where that is not known.
    """
    if load is None:
        return False
    sizes = {name: stem.values[name] for name in stem.candidate.own}
    logs = without_gap(stem.effect.insert(problem.model, stem.place, **sizes), problem.record, 1, SEED)
    if not logs:
        return False
    moved = replace(problem, settled=Settled({}, problem.innovations(problem.quiet, logs=logs)[0]))
    there = unmeasured_load(moved, load.limit - problem.limit)
    return there is not None and load.F - problem.level < SHARE * (there.F - moved.level)

"""A stem beside an effect of which the first part of a record feels one size only."""

from stickslip.cases.models import ideal_flow
from stickslip.gap.diagnosis import prepared
from stickslip.gap.effects import effect
from stickslip.gap.explanations.candidates import candidates
from stickslip.gap.explanations.stem_beside import stem_beside
from stickslip.gap.fits.hidden import first_part_of
from stickslip.gap.fits.search import best_of


def test_a_limit_that_op_meets_late_only_does_not_end_the_search(recorded):
    log = recorded("stiction", "valve", seed=5, S=4.0, J=1.5)
    problem = prepared(ideal_flow(), log)
    early = len(first_part_of(problem, modes=False).record.log)
    op = 100.0 * log["OP"]
    assert op.argmin() > early  # the lower limit is met behind the first part only
    (limits,) = candidates(problem, problem.quiet, [effect("controller_limits")])
    first = best_of(limits.tried([{"low": float(op.min()) + 0.3, "high": float(op[60:early].max()) - 0.3}]))
    pair = stem_beside(problem, first, None, [effect("stiction")])
    assert pair is None or {pair.first.effect.name, pair.second.effect.name} == {"stiction", "controller_limits"}

"""The evidence of dead travel in words."""

import math

from stickslip.detect.likelihood.pooled import (
    ANSWERS_NATS,
    DELAYS,
    EXCLUDED_SHARE,
    FINEST_SAMPLES,
    GAIN_NATS,
    TURNS,
    WITHOUT_BEST_NATS,
    Evidence,
)


def said(e: Evidence, percent: bool) -> str:
    """Return the evidence in words; ``percent`` says whether sizes are in % of OP or in its own unit."""
    unit = "% of OP" if percent else "in the unit of OP"
    size = f"S of {e.S:.2g} {unit} (between {e.low:.2g} and {e.high:.2g})"
    rival = (
        "the best rival (nothing moves PV but its own past)" if e.rival == "nothing" else f"the best rival ({e.rival})"
    )
    if e.accuses:
        days = f", in {e.agreeing} of {len(e.days)} records" if len(e.days) > 1 else ""
        jump = (
            f"A jump J of {e.J:.2g} {unit} tells {e.jump:.3g} nats more."
            if e.J > 0.0 else "A jump explains no more than play does, so this evidence gives S alone."
        )  # fmt: skip
        return (
            f"A stem with dead travel predicts PV better than {rival} by {e.gain:.3g} nats, by {e.without_best:.3g} "
            f"without the best tenth, over {e.turns} reversals{days}: {size}. {jump}"
        )
    if e.clears:
        return (
            f"Every dead travel from {e.claim:.2g} {unit} on is excluded by at least {e.loss:.3g} nats, and PV "
            f"answers OP by {e.answers:.3g} nats; OP travels {e.travel:.3g}."
        )
    if e.better:
        return f"Dead travel of {size} would predict PV better than {rival} by {e.gain:.3g} nats, but {_short(e)}."
    doubted = e.answers < ANSWERS_NATS or e.unpaid > 0.0 or e.bent > 0.0 or not e.steady  # what would exclude it
    least = f" From {e.excluded:.2g} {unit} on it is excluded by {e.loss:.3g} nats."
    why = "" if doubted or math.isinf(e.excluded) else least
    return (
        f"No stem with dead travel predicts PV better than {rival}, but {hides(e, unit)}, so nothing is cleared.{why}"
    )


def hides(e: Evidence, unit: str) -> str:
    """Why dead travel is not excluded."""
    if e.coarse:
        return f"{e.between:.2g} samples between two turns of OP are too few ({FINEST_SAMPLES:g} needed)"
    if e.answers < ANSWERS_NATS:
        return "PV shows no answer to OP"
    if e.turned < TURNS:
        return f"OP turns back {e.turned} times only ({TURNS} needed)"
    if e.unpaid > 0.0:
        return "at one delay dead travel of some size fits PV better, by less than one more parameter costs"
    if e.bent > 0.0:
        return f"PV answers OP by no straight line ({e.bent:.3g} nats), as where a valve sticks"
    if not e.steady:
        return "the answer of PV to OP hangs on the delay that is assumed"
    return f"one of {EXCLUDED_SHARE * e.travel:.2g} {unit} could hide"


def _short(e: Evidence) -> str:
    """Return the condition that is not met, so that dead travel is not called."""
    if e.coarse:
        return f"{e.between:.2g} samples between two turns of OP are too few ({FINEST_SAMPLES:g} needed)"
    if e.gain < GAIN_NATS:
        return f"{GAIN_NATS:g} are needed"
    if e.without_best < WITHOUT_BEST_NATS:
        return f"by {e.without_best:.3g} without the best tenth ({WITHOUT_BEST_NATS:g} needed)"
    if e.turns < TURNS:
        return f"the stem turns {e.turns} times only ({TURNS} needed), and a load that drifts looks the same"
    if e.agreeing * 2 < len(e.days):
        return f"only {e.agreeing} of {len(e.days)} records agree"
    return f"at {e.delays} of 3 delays only ({DELAYS} needed)"

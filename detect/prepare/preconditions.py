"""May a method look at this record? Its card says what it needs, the prepared record what there is."""

import math
from collections.abc import Callable

from stickslip.detect.card import Card
from stickslip.detect.health.fact import Fact
from stickslip.detect.oscillation.clock import RATIO_MAX
from stickslip.detect.prepare.logged_part import SAMPLES_MIN
from stickslip.detect.prepare.prepared import Grid, Prepared
from stickslip.detect.stem.recent import LONGEST, recent, samples_per_period
from stickslip.detect.verdict import Code, Verdict
from stickslip.logs.two_digits import rounded

ALWAYS: tuple[Code, ...] = (
    "no_valve", "manual_mode", "signal_missing", "constant_signal", "frozen_pv", "not_in_charge", "pv_unresponsive",
    "stale_data",
)  # fmt: skip
OF_PV: tuple[Code, ...] = ("frozen_pv", "not_in_charge", "pv_unresponsive")  # no matter to a method that reads no PV
BY_NEED: dict[str, Code] = {
    "constant_sp": "sp_not_constant", "unsaturated": "op_saturated", "fine_pv": "quantised", "raw_pv": "compressed",
}  # fmt: skip

FEWEST, WANTED = 5.0, 20.0  # samples a period of OP below which no shape can be judged, and to log


def refused(card: Card, loop: Prepared, threshold: float | None = None) -> Verdict | None:
    """The refusal of the first need that the record does not meet, with its number and limit; None if it meets all.

    A dead signal comes first, then the kind of process, then what else is wrong with the data, then the oscillation.

    >>> import numpy as np
    >>> from stickslip.logs import LoopRecord
    >>> card = Card("x", "X", "nobody", ("PV",), (), "nothing", (0, 1), ("self_regulating",), "no",
    ...             needs=("oscillation",))
    >>> t = np.arange(1000.0)
    >>> rest = LoopRecord.from_arrays(t, pv=np.random.default_rng(0).normal(size=1000), op=50 + np.cos(t), sp=0 * t)
    >>> refused(card, Prepared(rest)).code
    'no_oscillation'
    """

    def no(code: Code, reason: str) -> Verdict:
        return Verdict.not_applicable(card.name, code, reason, threshold)

    dead = _first(loop, set(ALWAYS) - (set() if "PV" in card.signals else set(OF_PV)))
    if dead is not None:
        return no(dead.code, dead.text)
    if "mv" in card.needs and loop.record.mv is None:
        return no("signal_missing", "The stem position MV is not logged, and this method reads nothing else.")
    if loop.integrating is not None:
        kind = "integrating" if loop.integrating else "self_regulating"
        if kind not in card.process:
            able = " and ".join(card.process).replace("_", "-")
            return no("wrong_process_type", f"The process is {kind.replace('_', '-')}; this method is for {able} ones.")
    elif "known_process" in card.needs:
        return no("integrating_unknown", "Whether the process integrates is not known, and the sign of the answer "
                                         "hangs on it: say which kind of process it is.")  # fmt: skip
    unfit = _first(loop, {BY_NEED[need] for need in card.needs if need in BY_NEED})
    if unfit is not None:
        return no(unfit.code, unfit.text)
    if "raw_op" in card.needs and loop.op_drawn.present:
        return no("compressed", loop.op_drawn.text)
    if "oscillation" not in card.needs:
        return _of_cause(card, loop, no)
    gate = loop.gate
    if not math.isfinite(loop.period):
        return no("no_oscillation", f"{gate.reason.removesuffix('.')}; this method compares cycles.")
    if gate.cycles < card.cycles:
        return no("too_few_cycles", f"The record holds {gate.cycles:.1f} cycles of {loop.period:.4g} s; "
                                    f"{card.cycles:g} are needed.")  # fmt: skip
    per_period = loop.samples_per_period
    if per_period < card.samples[0]:
        return no("undersampled", f"The period of {loop.period:.4g} s has {per_period:.1f} samples; "
                                  f"{card.samples[0]:g} are needed.")  # fmt: skip
    return _of_cause(card, loop, no)


def undersampled(loop: Prepared) -> str:
    """Why a record of few samples a period of OP shows the controller only; "" where it has enough."""
    grid = loop.whole
    if len(grid) < SAMPLES_MIN:
        return ""
    samples = samples_per_period(grid.op[recent(grid.op, LONGEST) :])
    if not samples < FEWEST:
        return ""
    return (
        f"There are {samples:.1f} samples a period of OP, and the shape of a stick shows from {FEWEST:g} on: such a "
        f"record shows the controller only. Log at {rounded(samples * grid.dt / WANTED):g} s."
    )


def too_short(card: Card, grid: Grid, samples: int, threshold: float) -> Verdict | None:
    """The refusal of a piece of fewer than so many samples; None if it has them."""
    if len(grid) >= samples:
        return None
    reason = f"The longest piece has {len(grid)} samples; {samples} are needed."
    return Verdict.not_applicable(card.name, "too_few_cycles", reason, threshold)


def _of_cause(card: Card, loop: Prepared, no: Callable[[Code, str], Verdict]) -> Verdict | None:
    """The refusal where PV does not follow OP, or where something outside keeps the time of the wave."""
    if "follows" in card.needs and loop.causality.present:
        return no("not_causal", loop.causality.text)
    if "own_cycle" in card.needs and loop.clock.keeps_time:
        ratio, cycles = loop.clock
        return no("outside_wave", f"The wave keeps time as a clock: over {cycles} cycles its phase strays by "
                                  f"{ratio:.2f} of the variance of a cycle ({RATIO_MAX:g} and more where a loop makes "
                                  "its own cycle), so something outside the loop drives it.")  # fmt: skip
    return None


def _first(loop: Prepared, forbidden: set[Code]) -> Fact | None:
    return next((fact for fact in loop.present if fact.forbids and fact.code in forbidden), None)

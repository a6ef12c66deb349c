"""How a run can end, as data: a code and a hint, never NaN and never a hang."""

from dataclasses import dataclass
from enum import IntEnum


class Status(IntEnum):
    """Outcome of a run."""

    OK = 0
    PAUSED = 1  # internal: the host empties the event buffer, looks up and resumes
    DELAY_FULL = 2  # internal: the host starts again with a longer delay line
    STEP_TOO_SMALL = 3
    NOT_FINITE = 4
    CHATTERING = 5
    TOO_MANY_STEPS = 6
    INTERRUPTED = 7
    MODEL_ENDED = 8
    TIGHT = 9  # internal: the cells hang together too tightly; the host starts again with one component

    def __str__(self) -> str:
        return self.name

    def __format__(self, spec: str) -> str:
        return format(self.name, spec)


HINTS: dict[Status, str] = {
    Status.OK: "",
    Status.PAUSED: "paused; the run can be resumed",
    Status.DELAY_FULL: "the delay line is full; start again with a longer one",
    Status.STEP_TOO_SMALL: (
        "the step size fell below what the clock can resolve: the model is singular here, or far stiffer than "
        "its tolerances; loosen rtol (--rtol), choose method='stiff' (--method stiff), or look at the last logged "
        "values"
    ),
    Status.NOT_FINITE: (
        "a rate or signal became infinite or not a number: look at the last logged values for a division by "
        "zero, a negative pressure or an unstable loop"
    ),
    Status.CHATTERING: (
        "modes switch back and forth without time passing: two transitions of a block undo each other; "
        "check its event functions, or add hysteresis"
    ),
    Status.TOO_MANY_STEPS: (
        "the step budget is spent; loosen rtol (--rtol), shorten the run (--duration), or in Python raise max_steps"
    ),
    Status.TIGHT: "the cells of the diagram hang together too tightly; start again with one component",
    Status.MODEL_ENDED: "a block's equations hold no further",
    Status.INTERRUPTED: "interrupted; what was simulated so far is kept",
}


@dataclass(frozen=True)
class Statistics:
    """The cost of one run: accepted and rejected steps, right-hand sides, Jacobians, events [-]."""

    steps: int = 0
    rejected: int = 0
    rhs: int = 0
    jacobians: int = 0
    events: int = 0
    components: int = 0

"""From the steps of a test to deadband, resolution and step response (ANSI/ISA-75.25.01; it sets no limits).

    deadband     travel of OP after a reversal until the valve moves: between the travel at the last step without an
                 answer and that at the first step with one
    resolution   the same behind a move in the same direction: the smallest travel on that the valve answers
    gain         slope of the line through places that were approached from the same side
    Td           time from a step to the first move beyond the noise
    T63, T86     time from a step to 63.2 and to 86.5 % of the final change: one and two time constants of a lag
    overshoot    largest excursion beyond the final change, share of it

A record without steps and with a logged stem is handed to the method ``stem_play``, which reads the deadband and the
jump off routine moves; moves of OP that stand alone in it (``routine``) tell the step response.
"""

import itertools
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from stickslip.detect.methods import stem_play
from stickslip.detect.valve_test.routine import routine_steps
from stickslip.detect.valve_test.steps import Step, noise_of, steps_of
from stickslip.detect.verdict import Figure
from stickslip.logs import LogError, LoopRecord
from stickslip.logs.arrays import Values
from stickslip.logs.shown import Shown

SCHEMA = "stickslip.valve-test/1"
STEPS_MIN = 4
HELD_SHARE = 0.5  # of the record: where OP is held less, it is no step test
LARGE_PERCENT = 2.0  # % of OP span: steps from this size on are timed
PLACES = stem_play.Params()  # how many reversals, and how alike, a deadband is read from
T63, T86 = 0.632, 0.865
NO_STEM = "No stem is logged: PV is taken as the answer, so the dynamics of the process count as the valve's."


@dataclass(frozen=True)
class Size:
    """A size with its bracket.

    value, low, high : [% of OP span]
    count : places in the test that it rests on
    """

    value: float
    low: float
    high: float
    count: int


@dataclass(frozen=True)
class StepResponse:
    """The answer to one large step.

    time : when OP stepped [s]
    size : step of OP [% of span]
    dead_time, T63, T86 : [s]; None where the answer did not come within the hold
    overshoot : share of the final change [-]
    place_before, place_after : where the answer rested before and after [its unit]
    """

    time: float
    size: float
    dead_time: float | None
    T63: float | None
    T86: float | None
    overshoot: float
    place_before: float
    place_after: float


@dataclass(frozen=True, eq=False, repr=False)
class ValveTest(Shown):
    """How a valve answers: the result of a step test, or of the routine moves in a record.

    answer : the signal that was measured: the stem, or PV where no stem is logged
    source : {"steps", "routine moves"}
    deadband, resolution : Size or None; None where the record does not show it
    slip_jump : Size or None; from routine moves only
    gain : change of the answer per % of OP [its unit / %]
    notes : what was assumed, and what the record does not show
    """

    name: str
    answer: str
    source: str
    deadband: Size | None
    resolution: Size | None
    slip_jump: Size | None
    gain: float | None
    responses: tuple[StepResponse, ...]
    steps: tuple[Step, ...] = field(repr=False)
    notes: tuple[str, ...]
    record: LoopRecord = field(repr=False)

    @property
    def headline(self) -> str:
        """The result in one line."""
        return f"{self.name or 'valve'}: {' '.join(self.words)}"

    @property
    def words(self) -> tuple[str, ...]:
        """The findings, one sentence each."""
        said = []
        for what, size in (("Deadband", self.deadband), ("Resolution", self.resolution), ("Slip jump", self.slip_jump)):
            if size is not None:
                places = f"{size.count} place{'s' * (size.count > 1)}"
                said.append(f"{what} {size.value:.2g} % of OP ({size.low:.2g} to {size.high:.2g}, {places}).")
        if self.responses:
            times = {
                name: _median(getattr(response, field) for response in self.responses)
                for name, field in (("Td", "dead_time"), ("T63", "T63"), ("T86", "T86"))
            }
            count = len(self.responses)
            answers = ", ".join(f"{name} {value:.3g} s" for name, value in times.items() if value is not None)
            of = f"{count} step{'s' * (count > 1)} of {LARGE_PERCENT:g} % and more" + (" (median)" if count > 1 else "")
            said.append(f"{of}: {answers}." if answers else f"{of}: the answer did not come within the hold.")
            worst = max(response.overshoot for response in self.responses)
            said.append(f"Largest overshoot {100.0 * worst:.0f} % of the step.")
        return tuple(said) or ("The record shows neither deadband nor resolution.",)

    def to_dict(self) -> dict[str, Any]:
        """The findings as plain values, schema "stickslip.valve-test/1"."""
        sizes = {"deadband": self.deadband, "resolution": self.resolution, "slip_jump": self.slip_jump}
        return {
            "schema": SCHEMA,
            "loop": self.name,
            "answer": self.answer,
            "source": self.source,
            **{name: None if size is None else vars(size) | {"unit": "% OP"} for name, size in sizes.items()},
            "gain": self.gain,
            "responses": [vars(response) for response in self.responses],
            "notes": list(self.notes),
        }

    def plot(self) -> Figure:
        """OP and the answer over time, and the answer over OP."""
        from stickslip.detect.figures.valve_test import plot_valve_test

        return plot_valve_test(self)

    def plot_responses(self) -> Figure | None:
        """The answers to the timed steps on one another; None without any."""
        from stickslip.detect.figures.valve_test import plot_responses

        return plot_responses(self)


def analyse(record: LoopRecord) -> ValveTest:
    """Analyse a step test of a valve.

    ``record`` needs OP in % or with a known span, and MV (the stem) or, failing that, PV.  Steps of both directions, of
    different sizes, each held until the answer rests, tell most.

    Raises LogError if OP's span is unknown, or if there are fewer than ``STEPS_MIN`` steps and no stem.

    >>> t = np.arange(400.0)
    >>> op = 50.0 + np.repeat([0, 1, 2, 3, 2, 1, 0, 1], 50)
    >>> stem = 50.0 + np.repeat([0.0, 1.0, 2.0, 3.0, 2.5, 1.5, 0.5, 1.0], 50)  # 0.5 % lost at each reversal
    >>> test = analyse(LoopRecord.from_arrays(t, pv=stem, op=op, mv=stem, op_span=(0, 100)))
    >>> test.gain, test.steps[0].moved
    (1.0, True)
    """
    op = record.op_percent
    if op is None:
        raise LogError("the span of OP is not known, so its steps have no size; give it (--op-span LOW HIGH)")
    named = "PV" if record.mv is None else "MV"
    answer = record.pv if record.mv is None else record.mv
    good = np.isfinite(op) & np.isfinite(answer)
    t, op, answer = record.t[good], op[good], answer[good]
    steps = steps_of(t, op, answer)
    noise = noise_of(t, answer)
    held = sum(step.stop - step.start for step in steps) / max(len(t), 1)
    if len(steps) < STEPS_MIN or held < HELD_SHARE:
        alone = routine_steps(t, op, answer, noise)
        return _from_routine(record, len(steps), tuple(_response(t, answer, step, noise) for step in alone))
    notes = [] if named == "MV" else [NO_STEM]
    brackets = _brackets(steps)
    sizes = {kind: _size(found) for kind, found in brackets.items()}
    for kind, size in sizes.items():
        if size is None:
            notes.append(f"The steps do not show the {kind}: {_wanted(kind, steps)}.")
    timed = tuple(
        _response(t, answer, step, noise)
        for step in steps
        if step.moved and abs(step.size) >= LARGE_PERCENT and _at_once(op, step)
    )
    return ValveTest(
        record.name, named, "steps", sizes["deadband"], sizes["resolution"], None, _gain(steps), timed, steps,
        tuple(notes), record,
    )  # fmt: skip


def _from_routine(record: LoopRecord, count: int, timed: tuple[StepResponse, ...]) -> ValveTest:
    """Analyse routine moves: deadband and jump from a logged stem, the step response from isolated moves."""
    few = f"Fewer than {STEPS_MIN} steps held at rest: read off the routine moves."
    if record.mv is None and timed:
        said = (few, NO_STEM, "Deadband and resolution need the stem position, or a step test.")
        return ValveTest(record.name, "PV", "routine moves", None, None, None, None, timed, (), said, record)
    if record.mv is None:
        raise LogError(
            f"the record has {count} steps of OP and no stem position; step OP at least {STEPS_MIN} times and hold "
            "each step until PV rests, or log the stem"
        )
    verdict = stem_play.detect(record)
    sizes = {name: float(verdict.array(name)[0]) for name in _READ if len(verdict.array(name))}
    notes = [f"{few} {verdict.reason}"]
    if not timed:
        notes.append(
            f"No step response: no move of OP of {LARGE_PERCENT:g} % or more stands alone, "
            "with OP steady before and after."
        )
    deadband = jump = None
    count = len(verdict.array("S_each"))
    agree = float(np.max(verdict.array("scatter"), initial=0.0)) <= PLACES.scatter
    if len(sizes) == len(_READ) and count >= PLACES.reversals and agree:
        least, most = sizes["S_low"] - sizes["J_high"], sizes["S_high"] - sizes["J_low"]
        deadband = Size(sizes["deadband"], max(least, 0.0), most, count)
        jump = Size(sizes["J"], sizes["J_low"], sizes["J_high"], count)
    return ValveTest(record.name, "MV", "routine moves", deadband, None, jump, None, timed, (), tuple(notes), record)


Bracket = tuple[float, float]
_READ = ("deadband", "S_low", "S_high", "J", "J_low", "J_high")  # of the evidence of ``stem_play``


def _brackets(steps: tuple[Step, ...]) -> dict[str, list[Bracket]]:
    """Per kind, the travel of OP without an answer and with one, at each place where the valve rested."""
    found: dict[str, list[Bracket]] = {"deadband": [], "resolution": []}
    came, travel, silent = 0.0, 0.0, 0.0  # direction of the last move; travel since; the part without an answer
    for step in steps:
        direction = float(np.sign(step.size))
        if travel * direction < 0.0:  # turned back before the valve answered: begin anew
            travel = silent = 0.0
            came = 0.0
        travel += step.size
        if not step.moved:
            silent = travel
            continue
        if came != 0.0:
            kind = "deadband" if direction != came else "resolution"
            found[kind].append((abs(silent), abs(travel)))
        came, travel, silent = direction, 0.0, 0.0
    return found


def _size(brackets: list[Bracket]) -> Size | None:
    """The tightest bracket that all places allow, or the median ones where they contradict each other."""
    if not brackets:
        return None
    low, high = max(b[0] for b in brackets), min(b[1] for b in brackets)
    if low > high:
        low, high = (float(np.median([b[k] for b in brackets])) for k in (0, 1))
    return Size(0.5 * (low + high), low, high, len(brackets))


def _wanted(kind: str, steps: tuple[Step, ...]) -> str:
    if not any(step.moved for step in steps):
        return "no step was answered; step further"
    return "step OP on after a move" if kind == "resolution" else "step OP back after a move"


def _gain(steps: tuple[Step, ...]) -> float | None:
    """Answer per % of OP over steps that go on in the direction of the move before, so that no deadband counts."""
    on = [
        step.answer / step.size
        for last, step in itertools.pairwise(steps)
        if step.moved and last.moved and step.size * last.size > 0.0
    ]
    return float(np.median(on)) if on else None


def _response(t: Values, answer: Values, step: Step, noise: float) -> StepResponse:
    part = (answer[step.start : step.stop] - step.place_before) / step.answer
    since = t[step.start : step.stop] - step.time
    band = max(3.0 * noise / abs(step.answer), 0.01)
    overshoot = max(float(np.max(part)) - 1.0 - band, 0.0)
    dead, sooner, later = (_first(since, part, level) for level in (band, T63, T86))
    return StepResponse(step.time, step.size, dead, sooner, later, overshoot, step.place_before, step.place_after)


def _at_once(op: Values, step: Step) -> bool:
    """Whether OP stepped, and did not wander from one hold to the next."""
    return abs(float(op[max(step.start - 3, 0)]) - step.before) <= 0.1 * abs(step.size)


def _median(values: Iterable[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.median(known)) if known else None


def _first(since: Values, part: Values, level: float) -> float | None:
    """When the answer first reaches a level, on the line between two samples."""
    above = np.flatnonzero(part >= level)
    if len(above) == 0:
        return None
    i = int(above[0])
    if i == 0:
        return float(since[0])
    share = (level - part[i - 1]) / (part[i] - part[i - 1])
    return float(since[i - 1] + share * (since[i] - since[i - 1]))

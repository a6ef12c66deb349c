"""The engine's run of a diagram against an oracle: do they agree in every signal, off the scans?

The oracle is the C program where it knows all blocks, else ``stickslip.diagram.reference``.  Where they differ, both
are asked again, more finely.  If they then agree, or if the oracle differs from itself, the diagram is sensitive
(chaotic, or two events whose order rounding decides) and nothing is proved: it counts as undecided.  What is left is a
finding, also where only the engine differs from itself: log rows that go with its steps are wrong.

Both locate a jump of a signal to about a microsecond.  A row that the search happens to draw nearer than ``NEAR`` to a
jump of the engine's may therefore stand on the other side of it for the oracle: it counts as equal if it lies between
what the engine has just before, at and just behind that time.
"""

import time
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from stickslip.diagram import simulate
from stickslip.diagram.reference import simulate_reference
from stickslip.logs.arrays import Values
from stickslip.logs.time_limit import time_limit

from benchmarks.torture.c_program import NoCompiler, OracleFailed, covers, program, solve
from benchmarks.torture.draw import Drawn

AGREED = 1e-5  # largest difference, as a share of 1 + the largest value of the signal
ITSELF = 0.1  # of AGREED: who differs more from itself decides nothing
STEPS = 3_000_000
REFERENCE_STEPS = 60_000
PATIENCE = 30.0  # with the reference [s]
NEAR = 1e-5  # s
ENGINE = ((1e-9, 1e-11), (1e-11, 1e-13))  # rtol, atol: first, and when asked again
SHARES = (1.0 / 30.0, 1.0 / 60.0)
REFERENCE: tuple[dict[str, Any], ...] = (
    {"method": "LSODA", "rtol": 1e-9, "atol": 1e-11}, {"method": "Radau", "rtol": 1e-10, "atol": 1e-12}
)  # fmt: skip


@dataclass(frozen=True)
class Judgement:
    """What came of one seed: "agree", "finding", "undecided" or "skipped", by which oracle, and why."""

    seed: int
    verdict: str
    oracle: str
    why: str = ""
    difference: float = 0.0
    steps: int = 0
    seconds: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return what goes into the JSON file."""
        return asdict(self)


def judge(drawn: Drawn) -> Judgement:
    """Judge the diagram of a seed; never raises for what the engine or an oracle does."""
    oracle = "reference" if covers(drawn.diagram) else "c"
    try:
        if oracle == "c":
            program()
    except NoCompiler:
        oracle = "reference"
    begin, seed = time.perf_counter(), drawn.seed
    try:
        run = simulate(
            drawn.diagram, drawn.duration, times=drawn.times, rtol=ENGINE[0][0], atol=ENGINE[0][1], max_steps=STEPS
        )
    except Exception as error:  # whatever it is, it is what we are looking for
        return Judgement(seed, "finding", oracle, f"the engine raised {type(error).__name__}: {error}")
    cost = {"steps": run.statistics.steps, "seconds": time.perf_counter() - begin}
    if not run.ok:
        return Judgement(seed, "finding", oracle, f"{run.status.name}: {run.hint}", **cost)
    ours = np.stack([run.log[s] for s in drawn.diagram.signals], axis=1)
    try:
        theirs = _asked(drawn, oracle, 0)
        size = AGREED * (1.0 + np.abs(theirs).max(axis=0))
        apart = np.abs(ours - theirs).max(axis=0) / size
        if apart.max() <= 1.0:
            return Judgement(seed, "agree", oracle, difference=float(AGREED * apart.max()), **cost)
        again = _asked(drawn, oracle, 1)
    except OracleFailed as reason:
        return Judgement(seed, "skipped", oracle, f"the oracle failed: {reason}", **cost)
    difference = _difference(drawn, again)
    apart = difference.max(axis=0) / size
    worst = float(AGREED * apart.max())
    if apart.max() <= 1.0:
        return Judgement(seed, "undecided", oracle, "asked more finely, they agree", worst, **cost)
    if (np.abs(theirs - again).max(axis=0) / size).max() > ITSELF:
        return Judgement(seed, "undecided", oracle, "the oracle differs from itself", worst, **cost)
    return Judgement(seed, "finding", oracle, _described(drawn, difference, apart), worst, **cost)


def _difference(drawn: Drawn, theirs: Values) -> Values:
    """Return how far the oracle's rows lie outside of what the engine, run finely, has around each time."""
    around = [np.clip(drawn.times + shift, 0.0, drawn.duration) for shift in (-NEAR, 0.0, NEAR)]
    times = np.unique(np.concatenate(around))
    fine = simulate(drawn.diagram, drawn.duration, times=times, rtol=ENGINE[1][0], atol=ENGINE[1][1], max_steps=STEPS)
    rows = np.stack([fine.log[s] for s in drawn.diagram.signals], axis=1)
    ours = np.stack([rows[np.searchsorted(times, at)] for at in around])
    return np.maximum(np.maximum(ours.min(axis=0) - theirs, theirs - ours.max(axis=0)), 0.0)


def _described(drawn: Drawn, difference: Values, apart: Values) -> str:
    """Say which signals differ, from when on, and whether a block with states is among them."""
    signals = drawn.diagram.signals
    wrong = [signals[i] for i in np.flatnonzero(apart > 1.0)]
    states = {
        s for block in drawn.diagram.blocks if len(block.x0) and not block.kernels.feeds for s in block.output_labels
    }
    size = difference[:, int(np.argmax(apart))]
    first = float(drawn.times[int(np.argmax(size > 0.1 * size.max()))])
    rows = int((size > 0.1 * size.max()).sum())
    with_states = [s for s in wrong if s in states]
    whose = f"states too: {', '.join(with_states[:4])}" if with_states else "outputs of states are right"
    return (
        f"{len(wrong)} of {len(signals)} signals differ, most {signals[int(np.argmax(apart))]} by {size.max():.2g} in "
        f"{rows} of {len(size)} rows, first at {first:.4g} s ({whose})"
    )


def _asked(drawn: Drawn, oracle: str, turn: int) -> Values:
    """Return the oracle's signals, (times, signals)."""
    if oracle == "c":
        return solve(drawn.diagram, drawn.duration, drawn.times, SHARES[turn])
    try:
        with time_limit(PATIENCE, f"it took longer than {PATIENCE:g} s"):
            run = simulate_reference(
                drawn.diagram, drawn.duration, times=drawn.times, max_steps=REFERENCE_STEPS, **REFERENCE[turn]
            )
    except TimeoutError as late:
        raise OracleFailed(str(late)) from None
    if not run.ok:
        raise OracleFailed(run.status.name)
    return np.stack([run.log[s] for s in drawn.diagram.signals], axis=1)

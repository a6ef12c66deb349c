"""A verdict by simulation at the record's own conditions: stage (b) of the combined verdict.

The record's conditions are measured, loops of known cause are simulated under them, and probabilities, sizes and the
detection limit are read off those that the network of convolutions sees nearest to the record.  See ``conditions``,
``alike`` and ``posterior``.  A long record is looked at in pieces, of whose scores the median counts; loops are as long
as a piece.
"""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from scipy.special import expit
from stickslip.calibration.alike import alike
from stickslip.calibration.conditions import Conditions, conditions
from stickslip.calibration.posterior import SEEN, Reading, log_odds, read
from stickslip.calibration.records import Table, row, table
from stickslip.calibration.simulation import simulate
from stickslip.calibration.spec import LoopSpec
from stickslip.detect.judge.answer import Amount
from stickslip.detect.judge.features.network import one_look
from stickslip.detect.judge.features.view import View
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord
from stickslip.logs.chances import chance
from stickslip.logs.processes import cores, one_thread, processes
from stickslip.logs.two_digits import rounded

LOOPS = 2000  # about 5 ms of one core each: some 6 s on two
PIECE, PIECES = 500, 4  # samples of a piece, and how many at most
FEWEST = 60  # loops with features below which nothing is said
OWN_PROCESS = 200  # loops that are worth a process of their own
SHARE = 50  # loops that a process makes at a time


@dataclass(frozen=True)
class AtRecord:
    """The result of simulations under a record's own conditions.

    probability : float        of stiction, where half of all loops stick [-]
    causes : mapping           probability of each of ``CAUSES`` [-], largest first
    S, J : Amount              should the valve stick, with the interval of 90 %
    limit : (float, str) or None   a stick larger than this would have shown with 90 % probability [unit of S]; None
                               where no stick up to the travel of OP would have
    conditions : Conditions    that were simulated
    loops : int                simulated loops with features
    false_alarms : float       share of them without stiction that is called sticky where the limit is read [-]
    area : float               under the curve of hits over false alarms among the simulated loops [-]
    seconds : float            it took
    """

    probability: float
    causes: Mapping[str, float]
    S: Amount
    J: Amount
    limit: tuple[float, str] | None
    conditions: Conditions
    loops: int
    false_alarms: float
    area: float
    seconds: float

    def to_dict(self) -> dict[str, Any]:
        """Return the answer as plain values that JSON can hold."""
        limit = None if self.limit is None else {"value": self.limit[0], "unit": self.limit[1]}
        return {
            "probability": self.probability, "causes": dict(self.causes),
            "amount": {"S": self.S.to_dict(), "J": self.J.to_dict()}, "detection_limit": limit,
            "conditions": asdict(self.conditions), "loops": self.loops, "false_alarms": self.false_alarms,
            "area": self.area, "seconds": self.seconds,
        }  # fmt: skip

    @property
    def sentences(self) -> tuple[str, str]:
        """The simulations, their result and the detection limit in words."""
        found = (
            f"{self.loops} loops were simulated under the conditions of this record, half of them with a sticky valve. "
            f"Among those most like it the probability of stiction is {chance(self.probability)}; if the valve sticks, "
            f"S is {self.S}."
        )
        if self.limit is None:
            return found, "No stick up to the travel of OP would have shown in this record with 90 % probability."
        size = f"{rounded(self.limit[0]):g} {self.limit[1]}"
        return found, f"A stick of more than {size} would have shown in this record with 90 % probability."


@one_thread
def at_record(record: LoopRecord, loops: int = LOOPS, seed: int = 0, workers: int | None = None) -> AtRecord:
    """Judge a record by ``loops`` simulated loops under its own conditions; equal seeds give equal answers.

    ``workers`` processes (default all cores).  Raises ``ValueError`` if the record shows too little (fewer than 40 good
    samples, OP or PV that does not move), or too few of the simulated loops do.

    See also: ``conditions`` for what is taken from the record.
    """
    begun = time.perf_counter()
    looks = [
        (seen, shown)
        for piece in split(record)
        if (seen := _measured(piece)) and (shown := row(piece, _network_scores))
    ]
    if not looks:
        conditions(record)  # says what is wrong, where it is that
        raise ValueError("the record shows too little for any feature; give a longer one in which OP and PV move")
    seen = typical([one for one, _ in looks])
    made = simulated(alike(seen, loops, seed), workers)
    known = made.rows(made.seen & (made.unit > 0.0))  # of some OP stands still but for a hundredth of the time
    enough = len(known) >= FEWEST and 10 <= int(known.sticky.sum()) <= len(known) - 10
    if not enough:
        raise ValueError(f"{len(known)} of {loops} simulated loops show enough; give more loops, or a longer record")
    found = read(known, np.array([[shown[0][name] for name in SEEN] for _, shown in looks]))
    return _result(found, record, float(np.median([shown[1] for _, shown in looks])), seen, begun)


def together(model: float, simulated: float) -> float:
    """Return the probability of stiction of the calibrated model and of simulation together: their mean log odds.

    >>> round(together(0.6, 0.9), 3), together(0.5, 0.5)
    (0.786, 0.5)
    """
    odds = log_odds(np.array([model, simulated]))
    return float(expit(odds.mean()))


def split(record: LoopRecord) -> list[LoopRecord]:
    """Return the pieces that are judged: the record itself, or up to ``PIECES`` of ``PIECE`` samples."""
    n = len(record)
    if n <= PIECE * 1.5:
        return [record]
    starts = np.linspace(0, n - PIECE, min(PIECES, n // PIECE)).astype(int).tolist()
    return [replace(record, log=record.log.samples(a, a + PIECE)) for a in starts]


def typical(seen: Sequence[Conditions]) -> Conditions:
    """Return the conditions of the piece whose period is the median."""
    return sorted(seen, key=lambda one: one.points)[len(seen) // 2]


def simulated(specs: Sequence[LoopSpec], workers: int | None = None) -> Table:
    """Return the network's scores and truth of loops, in their order, made by several processes, of which this is one.

    It takes shares from the end, while the others, which must load everything first, take theirs from the beginning.
    Where it is stopped, by Ctrl-C or an error, what waits is not begun.
    """
    count = min(workers or cores(), max(1, len(specs) // OWN_PROCESS))
    shares = [list(specs[k : k + SHARE]) for k in range(0, len(specs), SHARE)]  # so that few signals are kept at a time
    if count <= 1:
        return _joined([made_of(share) for share in shares])
    made: dict[int, Table] = {}
    with processes(count - 1) as pool:
        asked = [pool.submit(made_of, share) for share in shares]
        for k in range(len(shares) - 1, -1, -1):
            if not asked[k].cancel():  # begun, as all before it
                break
            made[k] = made_of(shares[k])
        made |= {k: one.result() for k, one in enumerate(asked) if k not in made}
    return _joined([made[k] for k in range(len(shares))])


def _joined(tables: Sequence[Table]) -> Table:
    """Return the tables as one; those of which no loop shows anything know no names, and are left out beside others."""
    named = [one for one in tables if len(one.names)]
    return Table.joined(named or tables)


def made_of(specs: Sequence[LoopSpec]) -> Table:
    """Return the network's scores and truth of loops, in this process."""
    return table(simulate(specs, workers=1), _network_scores)


def _measured(piece: LoopRecord) -> Conditions | None:
    try:
        return conditions(piece)
    except ValueError:
        return None


def _result(found: Reading, record: LoopRecord, travel: float, seen: Conditions, begun: float) -> AtRecord:
    """Return what was read, in the unit of the record; ``travel`` of OP in its unit."""
    span = record.op_span
    scale = travel if span is None else travel * 100.0 / (span[1] - span[0])
    unit = "in the unit of OP" if span is None else "% of OP"
    return AtRecord(
        probability=found.causes["stiction"],
        causes=dict(sorted(found.causes.items(), key=lambda item: -item[1])),
        S=_amount(found.S, scale, unit),
        J=_amount(found.J, scale, unit),
        limit=None if math.isnan(found.limit) else (scale * found.limit, unit),
        conditions=seen,
        loops=found.loops,
        false_alarms=found.false_alarms,
        area=found.area,
        seconds=time.perf_counter() - begun,
    )


def _amount(size: tuple[float, float, float], scale: float, unit: str) -> Amount:
    value, low, high = size
    return Amount(scale * value, scale * low, scale * high, unit)


def _network_scores(_: Prepared, view: View) -> dict[str, float]:
    """One look of the network at a view."""
    return one_look(view)

"""What a record should be like, in words: each condition once, whichever facts it is judged by."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from stickslip.detect.health.fact import Fact
from stickslip.detect.verdict import Code

_WANTED: Mapping[Code, str] = MappingProxyType({
    "no_valve": "OP moves a valve",
    "manual_mode": "the controller works in automatic",
    "signal_missing": "PV, OP and SP are there",
    "constant_signal": "PV moves",
    "frozen_pv": "the transmitter lives",
    "not_in_charge": "the controller brings PV to SP",
    "pv_unresponsive": "PV answers OP",
    "stale_data": "every sample is new",
    "op_saturated": "OP is away from its limits",
    "sp_not_constant": "SP stands still",
    "quantised": "PV has enough digits",
    "compressed": "PV is logged raw",
    "too_few_cycles": "the record holds enough cycles",
    "not_causal": "PV follows OP",
})  # fmt: skip


class Condition(NamedTuple):
    """A condition, whether it is met (None: the record does not tell), what was found, and what to do if it is not."""

    wanted: str
    met: bool | None
    found: str
    remedy: str


def met(facts: Sequence[Fact]) -> tuple[Condition, ...]:
    """The conditions that the facts judge, in their order.

    Of a condition that several facts judge, those decide that the record tells, and of them those that fail.

    >>> from stickslip.detect.health.fact import Fact
    >>> moves = Fact("manual_mode", False, 3.0, 0.0, "OP moves by 3.")
    >>> [(one.met, one.found) for one in met([Fact("manual_mode", False, 0, 0, "No mode.", judged=False), moves])]
    [(True, 'OP moves by 3.')]
    """
    together: dict[Code, list[Fact]] = {}
    for fact in facts:
        together.setdefault(fact.code, []).append(fact)
    return tuple(_condition(code, each) for code, each in together.items())


def _condition(code: Code, facts: Sequence[Fact]) -> Condition:
    failing = [fact for fact in facts if fact.present]
    judged = [fact for fact in facts if fact.judged]
    found = " ".join(fact.text for fact in failing or judged or facts)
    remedy = " ".join(dict.fromkeys(fact.remedy for fact in failing if fact.remedy))
    return Condition(_WANTED[code], not failing if judged else None, found, remedy)

"""One measured property of a record: its number, its limit, and what to log instead."""

from dataclasses import dataclass

from stickslip.detect.verdict import Code


@dataclass(frozen=True)
class Fact:
    """One measured property: ``present`` when it is beyond its limit; ``text`` is a sentence with the numbers.

    code : reason code that a method gives when it refuses because of this fact
    value, limit : on the fact's own scale, stated in its text
    remedy : what to log instead, a sentence, or nothing
    forbids : whether methods refuse a record that has it; one that does not is only noted
    judged : whether the record tells; where it does not, the text says why

    >>> Fact("quantised", True, 6.0, 10.0, "PV has 6 levels.", "Log PV with more digits.").forbids
    True
    """

    code: Code
    present: bool
    value: float
    limit: float
    text: str
    remedy: str = ""
    forbids: bool = True
    judged: bool = True

"""The thesis's plant as six cases: constant feed (1) and sinusoidal methane fraction (2), three sizes of stiction.

Parameter set B was fitted for constant feed, A for the sine; C and E serve both, and E, the nearest to the print,
stands behind the cases.  ``plant.production.parameters`` says what they are, ``cases.choice`` how E was chosen.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from cases.case import Case, Number

if TYPE_CHECKING:
    from plant.diagram import Diagram

SET = "E"  # the parameter set behind the cases
KICK = (1.019, 1.010)  # gas and liquid of separator 1 at the start of the kicked cases
KICKS_OF_A_CASE = 100  # starts behind the numbers of one case, as many as `stickslip reproduce` takes
STICTION = ("none", "normal", "high")


def diagram(F_s: str, case: int) -> "Diagram":
    """Return the plant of a case: at rest in both, but kicked where constant feed meets stiction.

    At rest nothing moves, whatever the stiction; case 1 with stiction therefore starts kicked
    (``started``).  Case 2 starts at rest for the mean feed Z_I = 0.25, where a ramp from 0.37 and a
    long hold would lead: a step to 0.25 would throw C2 into surge.

    >>> diagram("high", 2).name
    'plant_2_high'
    """
    from plant.production import production_plant

    plant = production_plant(SET, F_s=F_s, case=case, name=f"plant_{case}_{F_s}")
    return started(plant) if case == 1 and F_s != "none" else plant


def started(plant: "Diagram") -> "Diagram":
    """Return the plant kicked as the cases are: from there set E finds the cycles that are nearest to the print."""
    from plant.production import kicked

    return kicked(plant, *KICK)


def _build(F_s: str, case: int) -> Callable[[], "Diagram"]:
    return lambda: diagram(F_s, case)


def _numbers(F_s: str, case: int) -> Callable[[], Sequence[Number]]:
    def numbers() -> Sequence[Number]:
        from cases.kicks import Studies
        from cases.tables import table_5_4, table_6_1, table_6_2, table_case_2

        studies = Studies(SET, KICKS_OF_A_CASE)
        builders = (table_5_4, table_6_1) if case == 1 else (table_6_2, table_case_2)
        rows = [row for builder in builders for row in builder(studies, (F_s,))]
        return [
            Number(row.row, row.unit, row.published, None, row.reproduced, None, f"table {row.table}", row.told())
            for row in rows
        ]

    return numbers


_ABOUT = {
    1: "Constant feed, 7600 mol/s with methane fraction 0.37 (table 5.2, case 1).",
    2: "Methane fraction 0.25 + 0.1 sin(2 pi t/500 s) (table 5.2, case 2).",
}
_STUCK = {
    "none": "VLCS1 and VPCS1 have F_s = F_c, a deadband without a jump.",
    "normal": "VLCS1 and VPCS1 stick.", "high": "VLCS1 and VPCS1 stick.",
}  # fmt: skip
_START = {"none": "Starts at rest, and stays there.", "normal": "Starts kicked.", "high": "Starts kicked."}

CASES = tuple(
    Case(
        f"plant_{case}_{F_s}", f"Production plant, {'constant feed' if case == 1 else 'sine'}, "
        f"{'no' if F_s == 'none' else F_s} stiction",
        f"{_ABOUT[case]} {_STUCK[F_s]} {_START[F_s] if case == 1 else 'Starts at rest for the mean feed.'}",
        _build(F_s, case), 2000.0, 0.1, _numbers(F_s, case),
    )
    for case in (1, 2) for F_s in STICTION
)  # fmt: skip
CASES_BY_NAME = {case.name: case for case in CASES}

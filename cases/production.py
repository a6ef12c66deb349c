"""The thesis's plant as six cases: constant feed (1) and sinusoidal methane fraction (2), three sizes of stiction.

A seventh, ``plant_1_high_two_jumps``, differs from ``plant_1_high`` by its start alone, which leads to the other cycle.

Parameter set B was fitted for constant feed, A for the sine; C and E serve both, and E, the nearest to the print,
stands behind the cases.  ``stickslip.plant.parameters`` says what they are, ``stickslip.cases.choice`` how E was
chosen.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from stickslip.cases.case import Case, Number
from stickslip.plant.parameters import DEFAULT

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram

SET = DEFAULT  # the parameter set behind the cases
KICK = (1.02, 1.03)  # gas and liquid of separator 1 at the start: from here VPCS1's stem jumps once a half cycle
TWO_JUMPS = (1.019, 1.010)  # and from here, with high stiction, twice
KICKS_OF_A_CASE = 100  # starts behind the numbers of one case, as many as `stickslip reproduce` takes
STICTION = ("none", "normal", "high")


def diagram(F_s: str, case: int, kick: tuple[float, float] = KICK, name: str = "") -> "Diagram":
    """Return the plant of a case: at rest in both, but kicked where constant feed meets stiction.

    At rest nothing moves, whatever the stiction; case 1 with stiction therefore starts kicked
    (``started``).  Case 2 starts at rest for the mean feed Z_I = 0.25, where a ramp from 0.37 and a
    long hold would lead: a step to 0.25 would throw C2 into surge.

    >>> diagram("high", 2).name
    'plant_2_high'
    """
    from stickslip.plant import production_plant

    plant = production_plant(SET, F_s=F_s, case=case, name=name or f"plant_{case}_{F_s}")
    return started(plant, kick) if case == 1 and F_s != "none" else plant


def started(plant: "Diagram", kick: tuple[float, float] = KICK) -> "Diagram":
    """Return the plant kicked as the cases are.

    From ``KICK`` the stem of VPCS1 jumps once a half cycle, which draws the rectangle of figure 5.2 and, with high
    stiction, gives R near table 6.1; so it does from all starts within 0.3 % of it.
    """
    from stickslip.plant import kicked

    return kicked(plant, *kick)


def _build(F_s: str, case: int, kick: tuple[float, float] = KICK, name: str = "") -> Callable[[], "Diagram"]:
    return lambda: diagram(F_s, case, kick, name)


def own_numbers(F_s: str, kick: tuple[float, float] = KICK) -> Sequence[Number]:
    """Return what the run of a kicked case itself gives, 1000 to 2000 s, beside tables 5.4 and 6.1."""
    from stickslip.cases.kicks import DURATION, EVERY, case_1_numbers
    from stickslip.cases.tables import PUBLISHED_5_4, PUBLISHED_6_1
    from stickslip.diagram import simulate

    log = simulate(diagram(F_s, 1, kick), DURATION, every=EVERY, method="stiff").log
    found, high = case_1_numbers(log.t, log.signals), F_s == "high"
    note = "this start alone; the rows below are medians over many"
    T, A = (PUBLISHED_5_4[name][high] for name in ("pressure T", "pressure A"))
    R = PUBLISHED_6_1["pressure", F_s][0]
    return [
        Number("pressure period, this start", "s", T, None, found["pressure T"], None, "table 5.4", note),
        Number("pressure amplitude, this start", "bar", A, None, found["pressure A"], None, "table 5.4", note),
        Number(
            "R of pressure, this start", "-", R, None, found["pressure R"], found["pressure std"], "table 6.1", note
        ),
    ]


def _numbers(F_s: str, case: int, kick: tuple[float, float] = KICK) -> Callable[[], Sequence[Number]]:
    def numbers() -> Sequence[Number]:
        from stickslip.cases.kicks import Studies
        from stickslip.cases.tables import table_5_4, table_6_1, table_6_2, table_case_2

        studies = Studies(SET, KICKS_OF_A_CASE)
        builders = (table_5_4, table_6_1) if case == 1 else (table_6_2, table_case_2)
        rows = [row for builder in builders for row in builder(studies, (F_s,))]
        own = own_numbers(F_s, kick) if case == 1 and F_s != "none" else []
        return [
            *own,
            *(
                Number(
                    row.row, row.unit, row.published, None, row.reproduced, None, f"table {row.table}", row.described()
                )
                for row in rows
            ),
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
TWO_JUMP_CASE = Case(
    "plant_1_high_two_jumps", "Production plant, constant feed, high stiction, two jumps a half cycle",
    f"{_ABOUT[1]} {_STUCK['high']} As plant_1_high from another start: VPCS1 jumps twice each way, the amplitudes are "
    "nearer to table 5.4, and R falls below 1.",
    _build("high", 1, TWO_JUMPS, "plant_1_high_two_jumps"), 2000.0, 0.1, _numbers("high", 1, TWO_JUMPS),
)  # fmt: skip
CASES += (TWO_JUMP_CASE,)
CASES_BY_NAME = {case.name: case for case in CASES}

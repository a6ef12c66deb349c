"""Spans by which sizes of effects are measured: stated ones, and what becomes of them on their way (all analytic)."""

import pytest
from stickslip.blocks import FirstOrder, Gain, IdealValve, LeadLag, Lookup1D, SampledPI, SampledSensor, Sum
from stickslip.diagram import Diagram, wire
from stickslip.gap.effects import Deadband, Stiction
from stickslip.gap.insertion.scales import ends, span


def in_percent(*between: object, valve: str = "p") -> Diagram:
    """Return a loop whose OP is in per cent, with blocks between its controller and its valve."""
    return wire(
        [
            SampledPI(1.0, 9.0, dt=1.0, low=0.0, high=100.0),
            *between,  # type: ignore[list-item]
            IdealValve(inputs=valve),
            FirstOrder(0.5, 4.0, inputs="MV", outputs="flow"),
            SampledSensor(1.0, low=0.0, high=80.0, inputs="flow", outputs="PV"),
        ],
        ["SP"],
    )


@pytest.mark.parametrize(
    ("block", "expected"),
    [
        (LeadLag("p", "OP", 0.0, 2.0), (0.0, 100.0)),  # a positioner
        (Lookup1D("p", "OP", [0.0, 50.0], [100.0, 0.0]), (0.0, 100.0)),  # the falling half of a split range
        (Gain("p", "OP", 0.01), (0.0, 1.0)),  # from per cent to fractions
        (Gain("p", "OP", -2.0), (-200.0, 0.0)),
    ],
)  # fmt: skip
def test_a_span_is_that_of_the_input_at_rest(block: object, expected: tuple[float, float]) -> None:
    loop = in_percent(block)
    assert ends(loop, "p") == pytest.approx(expected, rel=1e-8)
    assert ends(loop, "MV") == pytest.approx(expected, rel=1e-8)  # what an ideal valve gives


def test_several_blocks_are_passed_one_after_the_other() -> None:
    loop = in_percent(LeadLag("a", "OP", 0.0, 2.0), Gain("p", "a", 0.04))
    assert ends(loop, "p") == pytest.approx((0.0, 4.0))


def test_a_process_and_a_sum_have_no_span_of_their_own() -> None:
    loop = in_percent(Sum("p", {"OP": 1.0, "trim": 1.0}), Gain("trim", "OP", 0.1))
    assert ends(loop, "flow") is None
    assert ends(loop, "p") is None
    assert span(loop, "p") == 1.0


def test_a_table_that_gives_one_value_has_no_span() -> None:
    assert ends(in_percent(Lookup1D("p", "OP", [0.0, 50.0], [7.0, 7.0])), "p") is None


def test_a_stated_span_comes_first() -> None:
    loop = in_percent(FirstOrder(1.0, 2.0, inputs="OP", outputs="p", spans={"PV": (0.0, 25.0)}, name="actuator"))
    assert ends(loop, "p") == (0.0, 25.0)


@pytest.mark.parametrize(
    ("effect", "sizes", "key", "expected"),
    [(Deadband(), {"width": 3.0}, "width", 3.0), (Stiction(), {"S": 4.0, "J": 1.0}, "S", 4.0)],
)
def test_a_sticky_valve_behind_a_positioner_is_measured_in_per_cent_of_op(
    effect: Deadband | Stiction, sizes: dict[str, float], key: str, expected: float
) -> None:
    loop = in_percent(LeadLag("p", "OP", 0.0, 2.0))
    assert effect.settings(loop, "valve", **sizes)[f"valve:{effect.name}.{key}"] == pytest.approx(expected)

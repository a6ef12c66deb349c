"""Effects that are a lag: the model's own where it has one, one more where it has none."""

import pytest
from stickslip.blocks import IdealValve, LeadLag, Sensor
from stickslip.diagram import Diagram, wire
from stickslip.gap.effects import effect


def path(positioner: float, element: float) -> Diagram:
    """Return a valve behind a positioner and a sensor with a lag of its own, of these time constants [s]."""
    return wire(
        [
            LeadLag("p", "OP", 0.0, positioner, name="positioner"),
            IdealValve(inputs="p", outputs="MV"),
            Sensor(element, inputs="MV", outputs="PV"),
        ],
        inputs=["OP"],
    )


@pytest.mark.parametrize(
    ("name", "place", "key"),
    [("positioner_lag", "valve", "positioner.T_lag"), ("sensor_lag", "sensor", "sensor.tau")],
)
def test_the_lag_of_the_model_is_longer_by_tau(name: str, place: str, key: str) -> None:
    still = path(1.2, 3.0)
    block, _, param = key.partition(".")
    slower = effect(name).insert(still, place, tau=2.0)
    assert [b.name for b in slower.blocks] == [b.name for b in still.blocks]
    assert slower[block].params[param] == pytest.approx(still[block].params[param] + 2.0, abs=1e-12)  # analytic
    assert effect(name).insert(still, place, tau=0.0) is still


def test_a_lag_that_others_read_is_not_the_valves() -> None:
    both = path(1.2, 3.0).insert("OP", LeadLag("OP", "OP", 0.0, 1.0, name="shared"), readers="positioner")
    assert "positioner.T_lag" in effect("positioner_lag").settings(both, "valve", tau=2.0)
    bare = wire([IdealValve(inputs="OP", outputs="MV")], inputs=["OP"])
    assert effect("positioner_lag").insert(bare, "valve", tau=2.0)["valve:positioner_lag"].params["tau"] == 2.0

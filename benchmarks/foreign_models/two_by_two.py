"""Reflux and steam of a column, each of which moves both temperatures, of ``benchmarks/foreign/two_by_two.py``.

OP and MV are in %, the loads in shares of full flow.
"""

from stickslip.blocks import FirstOrder, Historian, IdealValve, LeadLag, Noise, SampledPI, SampledSensor, Sum
from stickslip.diagram import wire

from benchmarks.foreign.trial import Wired
from benchmarks.foreign_models.as_logged import as_logged


def model(noise_factor: float = 1.0, load_factor: float = 1.0) -> Wired:
    """Return both loops; their set points ``SP1`` and ``SP2`` [degC] are open."""
    shared = {"low": 0.0, "high": 100.0, "integral": "present", "T_t": 2.0, "start_op": 50.0}
    diagram = wire(
        [
            SampledPI(9.0, 80.0, dt=2.0, name="controller_1", inputs=["SP1", "PV1"], outputs="OP1", **shared),
            SampledPI(
                8.0,
                60.0,
                dt=2.0,
                action="direct",
                name="controller_2",
                inputs=["SP2", "PV2"],
                outputs="OP2",
                **shared,
            ),
            IdealValve(name="valve_1", inputs="OP1", outputs="MV1"),
            IdealValve(name="valve_2", inputs="OP2", outputs="MV2"),
            Noise("load1", sd=0.008 * load_factor, dt=1.0, correlation_time=200.0, name="feed_1"),
            Noise("load2", sd=0.008 * load_factor, dt=1.0, correlation_time=200.0, name="feed_2"),
            Sum("u1", {"MV1": 0.01, "load1": 1.0}, offset=-0.5, name="reflux"),
            Sum("u2", {"MV2": 0.01, "load2": 1.0}, offset=-0.5, name="steam"),
            FirstOrder(20.0, 80.0, 8.0, name="process_11", inputs="u1", outputs="T11"),
            FirstOrder(-12.0, 100.0, 20.0, name="process_12", inputs="u2", outputs="T12"),
            FirstOrder(9.0, 70.0, 24.0, name="process_21", inputs="u1", outputs="T21"),
            FirstOrder(-18.0, 60.0, 10.0, name="process_22", inputs="u2", outputs="T22"),
            Sum("T1", {"T11": 1.0, "T12": 1.0}, offset=50.0, name="top"),
            Sum("T2", {"T21": 1.0, "T22": 1.0}, offset=90.0, name="bottom"),
            LeadLag("felt_1", "T1", 0.0, 4.0, start=50.0, name="element_1"),
            SampledSensor(
                2.0,
                sd=0.05 * noise_factor,
                low=0.0,
                high=150.0,
                start=50.0,
                name="sensor_1",
                inputs="felt_1",
                outputs="PV1",
            ),
            LeadLag("felt_2", "T2", 0.0, 4.0, start=90.0, name="element_2"),
            SampledSensor(
                2.0,
                sd=0.04 * noise_factor,
                low=0.0,
                high=150.0,
                start=90.0,
                name="sensor_2",
                inputs="felt_2",
                outputs="PV2",
            ),
            Historian(["SP1", "PV1", "SP2", "PV2", "OP1", "OP2"]),
        ],
        inputs=["SP1", "SP2"],
        name="two_by_two",
    )
    return as_logged(diagram, element_1="sensor_1", element_2="sensor_2")

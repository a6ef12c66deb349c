"""Models that were fitted at one operating point: their level is right there, and what is wrong shows away from it.

The logs are of plain Python.  The heated tank scans every 2 s, its rows are 5 s apart.  Before, a valve's law kept the
flow of the open valve, and a gain was one about zero: the first was an unknown effect, the second no gap at all.
"""

from collections.abc import Callable

import numpy as np
import pytest
from stickslip.blocks import Equations, FirstOrder, IdealValve, Noise, SampledPI, SampledSensor, Sum
from stickslip.diagram import wire
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.effects.valve_characteristic import flow_at
from stickslip.logs import Log

STEAM, R, LOSS, HEAT = 80.0, 30.0, 0.365, 400.0  # [kW], [-], [kW/K], [kJ/K]
DT, SCAN, ROW = 0.5, 2.0, 5.0  # [s]
GAINS = ("valve_gain", "valve_characteristic", "process_gain", "sensor_span", "controller_gain")
OTHERS = ("process_time_constant", "dead_time", "sensor_bias", "valve_leak", "step_disturbance")
RIVALS = [effect(name) for name in (*GAINS, *OTHERS)]


def logged(rate: Callable[[float, float], float], push: float, sd: float, seed: int = 3, hours: float = 2.0) -> Log:
    """Return a log of a tank that heats with ``rate`` (T, OP) [K/s]; ``push`` of a load on T [1/s], of that ``sd``."""
    rng = np.random.default_rng(seed)
    T, felt, integral, load, op, pv, rows = 60.0, 60.0, 50.0, 0.0, 50.0, 60.0, []
    keep = np.exp(-DT / 300.0)
    for k in range(int(3600.0 * hours / DT) + 1):
        t = k * DT
        sp = 62.0 if int(t // 1800.0) % 2 else 60.0
        if k % round(SCAN / DT) == 0:
            pv = felt + 0.03 * rng.standard_normal()
            integral += 4.0 * (sp - pv) * SCAN / 120.0
            op = min(max(integral + 4.0 * (sp - pv), 0.0), 100.0)
        if k % round(ROW / DT) == 0:
            rows.append((t, sp, round(pv, 3), round(op, 2)))
        load = load * keep + sd * np.sqrt(1.0 - keep**2) * rng.standard_normal()
        T += DT * (rate(T, op) + push * load)
        felt += DT * (T + (0.0 if push else load) - felt) / 4.0
    t, sp, pv, op = np.array(rows).T
    return Log(t, {"SP": sp, "PV": pv, "OP": op})


def around(process: list, load: float) -> object:
    """Return the loop around a process from MV and load to T."""
    return wire(
        [
            SampledPI(4.0, 120.0, dt=SCAN, low=0.0, high=100.0, integral="present", start_op=50.0), IdealValve(),
            Noise("load", sd=load, dt=SCAN, correlation_time=300.0, name="weather"), *process,
            FirstOrder(1.0, 4.0, start=60.0, inputs="T", outputs="felt", name="element"),
            SampledSensor(SCAN, sd=0.03, start=60.0, inputs="felt", outputs="PV"),
        ],
        inputs=["SP"],
    )  # fmt: skip


def linear_tank(T, MV, load, G, C, UA):
    return (G * MV - UA * (T - 20.0)) / C + 0.002 * load


def test_a_valve_of_equal_percentage_is_named_though_the_model_has_its_flow_at_one_opening_only():
    log = logged(lambda T, op: (STEAM * R ** (0.01 * op - 1.0) - LOSS * (T - 20.0)) / HEAT, 0.002, 0.5)
    at_rest = {"G": STEAM * R**-0.5 / 50.0, "C": HEAT, "UA": LOSS}
    process = Equations("process", der=linear_tank, states={"T": 60.0}, inputs=["MV", "load"], params=at_rest)
    (cause,) = diagnose(around([process], 0.5), log, catalogue=RIVALS).causes
    assert (cause.effect, cause.place) == ("valve_characteristic", "valve")
    found = {name: size.value for name, size in cause.parameters.items()}
    for op in (45.0, 50.0, 55.0):  # where the loop runs
        true = R ** (0.01 * op - 1.0) / R**-0.5
        assert 2.0 * found["flow"] * flow_at(0.01 * op, found["rangeability"]) == pytest.approx(true, rel=0.03)


@pytest.mark.parametrize(("gain", "named"), [(1.0, False), (0.7, True), (2.0, True)])
def test_a_gain_about_the_operating_point_is_named_with_it(gain, named):
    log = logged(lambda T, op: (60.0 + 0.4 * gain * (op - 50.0) - T) / 300.0, 0.0, 0.3)
    process = [
        FirstOrder(0.4, 300.0, start=20.0, inputs="MV", outputs="y"),
        Sum("T", {"y": 1.0, "load": 1.0}, offset=40.0),
    ]
    report = diagnose(around(process, 0.3), log, catalogue=RIVALS)
    assert report.gap == named
    if named:
        (cause,) = report.causes
        assert {"process_gain", "valve_gain"} <= {cause.effect, *cause.ambiguous_with}
    else:  # a factor of 1.04 about zero would have shown, but that moves the level as well
        shown = {(one.effect, one.place): one for one in report.seen}
        assert shown["process_gain", "process"].size - 1.0 > 0.1


def test_a_factor_leaves_the_level_where_it_is_said_to_be_right():
    loop = wire([IdealValve(), FirstOrder(0.4, 300.0, start=20.0, inputs="MV", outputs="y")], inputs=["OP"])
    for name, place, at in (("valve_gain", "valve", 50.0), ("process_gain", "process", 0.5)):
        changed = effect(name).insert(loop, place, factor=1.5, at=at)
        block = changed[f"{place}:{name}"]
        assert float(block.output(0.0, [], [0.5])[0]) == pytest.approx(0.5)
        assert float(block.output(0.0, [], [0.6])[0]) == pytest.approx(0.65)

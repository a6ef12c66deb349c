"""Models of loops whose logs are to be compared with reality: what a diagnosis of the sim-to-real gap starts from.

    ideal_flow        the thesis's loop 6.2 with an ideal valve, known exactly; the sensor's noise is the only nuisance
    site_flow         the same loop as a site gives it: a scanning controller, an unmeasured load, unsure parameters
    second_order_flow, level_loop, level_cascade
                      other loops as a site gives them: two lags and a dead time, an integrating level, a cascade
    cascaded_tanks    two tanks, the upper emptying into the lower, as the public record of the rig was made

All are diagrams without a log: the set point (``SP``), or the pump's voltage (``u``), is an open input, which a log
drives.  The cases of these names close it with a staircase.
"""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from stickslip.cases.case import Case

if TYPE_CHECKING:
    from stickslip.blocks.block import Block
    from stickslip.diagram.diagram import Diagram

K, TAU, K_P, T_I = 3.0, 10.0, 0.4, 10.0  # thesis eq. 6.2
NOISE = 0.004  # standard deviation of the sensor [unit of PV]
WITHIN = 0.1  # share within which the site's noise and load are known
LOAD, LOAD_TIME = 0.01, 60.0  # of the site's load: standard deviation [unit of the process input], time constant [s]
STAIRS = (1.5, 1.8, 1.35, 1.65, 1.2, 1.5)  # set points of the cases
DWELL = 600.0  # [s]
LEVELS = (0.5, 0.55, 0.45, 0.5)
OUTFLOW, LEVEL_NOISE = 0.5, 0.002  # of the levels: what flows out [share of full inflow], noise [unit of the level]


def ideal_flow(rest: float = 0.0) -> "Diagram":
    """Return the loop with an ideal valve: process 3/(10 s + 1), continuous PI with K_p 0.4, T_i 10 s, OP in 0 ... 1.

    ``rest`` [unit of PV]: the PV at which it stands still at the start, from 0 to 3.  The load, 0 in the model, is
    added to the valve's flow; the sensor adds white noise of standard deviation 0.004, a new value each second.

    >>> [block.name for block in ideal_flow().blocks if block.name not in ("inflow", "noise")]
    ['controller', 'valve', 'feed', 'process', 'sensor', 'historian']
    >>> ideal_flow().open_inputs
    ('SP',)
    """
    from stickslip.blocks import PI, Constant, FirstOrder, Historian, IdealValve, Noise, Sum
    from stickslip.diagram import wire

    return wire(
        [
            PI(K_P, T_I, anti_windup="conditional", start_op=rest / K),
            IdealValve(spans={"MV": (0.0, 1.0)}),
            Constant("load", 0.0, name="feed").with_role("disturbance"),
            Sum("F", {"MV": 1.0, "load": 1.0}, name="inflow"),
            FirstOrder(K, TAU, start=rest, inputs="F", outputs="y"),
            Noise("noise", sd=NOISE, dt=1.0),
            Sum("PV", {"y": 1.0, "noise": 1.0}, name="sensor").with_role("sensor"),
            Historian(["SP", "PV", "OP", "MV"]),
        ],
        inputs=["SP"],
        name="ideal_flow",
    )


def site_flow(rest: float = 0.0) -> "Diagram":
    """Return the loop as a site gives it: scanned every second, K within 5 %, tau within 10 %, an unmeasured load.

    The controller is positional, its integral takes in the present error before the output is made.  The load at the
    process input is a first-order autoregression of standard deviation 0.01 and time constant 60 s; the sensor's noise,
    0.004, is drawn at each scan.  Load and noise are known within 10 %.  ``rest`` [unit of PV] as in ``ideal_flow``.

    >>> site_flow().tolerances
    {'feed.sd': 0.1, 'feed.correlation_time': 0.1, 'process.K': 0.05, 'process.tau': 0.1, 'sensor.sd': 0.1}
    """
    from stickslip.blocks import FirstOrder

    controller = _scanning(K_P, T_I, rest / K)
    process = FirstOrder(K, TAU, start=rest, inputs="F", outputs="y")
    return _site(controller, process, rest, NOISE, "site_flow").with_tolerances({"process.K": 0.05, "process.tau": 0.1})


def second_order_flow(rest: float = 0.0) -> "Diagram":
    """Return a loop of second order with dead time: 3 exp(-2 s)/((10 s + 1)(4 s + 1)), PI of K_p 0.25, T_i 12 s.

    Scan, load, noise and rounding as in ``site_flow``; K within 5 %, the natural frequency within 10 %.  ``rest`` [unit
    of PV] as there.

    >>> second_order_flow()["process"].params["theta"]
    2.0
    """
    from stickslip.blocks import SecondOrder

    slow, fast = TAU, 4.0
    omega = 1.0 / math.sqrt(slow * fast)
    process = SecondOrder(K, omega, 0.5 * (slow + fast) * omega, 2.0, start=rest, inputs="F", outputs="y")
    controller = _scanning(0.25, 12.0, rest / K)
    model = _site(controller, process, rest, NOISE, "second_order_flow")
    return model.with_tolerances({"process.K": 0.05, "process.omega": 0.1})


def level_loop(rest: float = 0.5) -> "Diagram":
    """Return a level that integrates what flows in: hold-up 200 s, known within 10 %, PI of K_p 4, T_i 400 s.

    The outflow takes half of the full inflow; scan and load as in ``site_flow``, noise 0.002.  ``rest`` [unit of PV]:
    the level at the start.

    >>> level_loop().tolerances
    {'feed.sd': 0.1, 'feed.correlation_time': 0.1, 'process.T': 0.1, 'sensor.sd': 0.1}
    """
    from stickslip.blocks import Integrator

    process = Integrator(K=1.0, T=200.0, u_0=OUTFLOW, start=rest, inputs="F", outputs="y")
    controller = _scanning(4.0, 400.0, OUTFLOW)
    return _site(controller, process, rest, LEVEL_NOISE, "level_loop").with_tolerances({"process.T": 0.1})


def level_cascade(rest: float = 0.5) -> "Diagram":
    """Return a level whose controller moves the set point ``SP`` of a flow loop; its own is ``SP_L``, open.

    Flow: 1/(3 s + 1), PI of K_p 0.5, T_i 3 s, K within 5 %, time constant within 10 %; level: as in ``level_loop``, its
    hold-up known; ``rest`` [unit of L]: the level at the start.

    >>> level_cascade().open_inputs, level_cascade()["controller"].loop_signal("SP")
    (('SP_L',), 'SP')
    """
    from stickslip.blocks import FirstOrder, Integrator, SampledSensor
    from stickslip.diagram import wire

    process = FirstOrder(1.0, 3.0, start=OUTFLOW, inputs="F", outputs="y")
    flow = _site(_scanning(0.5, 3.0, OUTFLOW), process, OUTFLOW, NOISE, "flow")
    outer = [
        _scanning(4.0, 400.0, OUTFLOW).relabelled("level_controller", ["SP_L", "L"], ["SP"]),
        Integrator(K=1.0, T=200.0, u_0=OUTFLOW, start=rest, name="vessel", inputs="y", outputs="h"),
        SampledSensor(dt=1.0, sd=LEVEL_NOISE, start=rest, name="level_sensor", inputs="h", outputs="L"),
    ]
    cascade = wire([*outer, *flow.blocks], inputs=["SP_L"], name="level_cascade")
    return cascade.with_tolerances({"process.K": 0.05, "process.tau": 0.1})


def _scanning(K_p: float, T_i: float, opening: float) -> "Block":
    """Return a controller that scans every second and takes in the present error first, at rest with this OP."""
    from stickslip.blocks import SampledPI

    return SampledPI(K_p, T_i, dt=1.0, anti_windup="conditional", integral="present", start_op=opening)


def _site(controller: "Block", process: "Block", rest: float, noise: float, name: str) -> "Diagram":
    """Return a loop whose controller and sensor scan, with a load that nobody measures at the process input."""
    from stickslip.blocks import Historian, IdealValve, Noise, SampledSensor, Sum
    from stickslip.diagram import wire

    return wire(
        [
            controller,
            IdealValve(spans={"MV": (0.0, 1.0)}),
            Noise("load", sd=LOAD, dt=1.0, correlation_time=LOAD_TIME, name="feed").with_tolerances(
                sd=WITHIN, correlation_time=WITHIN
            ),
            Sum("F", {"MV": 1.0, "load": 1.0}, name="inflow"),
            process,
            SampledSensor(dt=1.0, sd=noise, start=rest, inputs="y", outputs="PV").with_tolerances(sd=WITHIN),
            Historian(["SP", "PV", "OP", "MV"]),
        ],
        inputs=["SP"],
        name=name,
    )


def cascaded_tanks() -> "Diagram":
    """Return the rig of two tanks without overflow: pump voltage ``u`` [V], level of the lower tank ``y`` [V].

    Torricelli's law in both (``stickslip.blocks.tank``), levels in volts of the level sensor, flows in volts of the
    pump; both outlets are taken as equal, since no level of the upper tank is logged.  Areas, outlets and the start of
    the upper tank are fitted to the whole estimation record, which leaves an error of 0.60 V (root mean square) in a
    free run.

    >>> cascaded_tanks().open_inputs, cascaded_tanks()["sensor"].output_labels
    (('u',), ['y'])
    """
    from stickslip.blocks import IdealValve, Sensor, Tank
    from stickslip.diagram import wire

    rim = {"h": (0.0, 10.0)}
    return wire(
        [
            IdealValve(name="pump", inputs="u", outputs="q", spans={"OP": (0.0, 10.0), "MV": (0.0, 10.0)}),
            Tank(37.1, 1.2014, start=5.05, name="tank_1", inputs="q", outputs=["h_1", "q_1"], spans=rim),
            Tank(13.37, 1.2014, start=5.205, name="tank_2", inputs="q_1", outputs=["h_2", "q_2"], spans=rim),
            Sensor(inputs="h_2", outputs="y", spans={"PV_m": (0.0, 10.0)}),
        ],
        inputs=["u"],
        name="cascaded_tanks",
    )


def _driven(model: "Diagram", signal: str, levels: tuple[float, ...], dwell: float) -> "Diagram":
    """Return a model whose open input is a staircase."""
    from stickslip.blocks import Staircase
    from stickslip.diagram import wire

    return wire([Staircase(signal, levels, dwell=dwell), *model.blocks], name=model.name)


def _case(
    name: str, title: str, about: str, model: "Callable[[], Diagram]", levels: tuple[float, ...], dwell: float,
    every: float = 5.0, signals: tuple[str, ...] = ("SP", "PV", "OP"),
) -> Case:  # fmt: skip
    """Return the case of a model, its open input driven by a staircase."""

    def build() -> "Diagram":
        made = model()
        return _driven(made, made.open_inputs[0], levels, dwell)

    return Case(name, title, about, build, len(levels) * dwell, every, tuple, signals)


CASES_BY_NAME = {
    case.name: case
    for case in (
        _case(
            "ideal_flow",
            "Model of a flow loop, known exactly: ideal valve, continuous PI, sensor noise",
            "The thesis's loop 6.2 with an ideal valve; what a gap to it looks like is known to the last digit.",
            lambda: ideal_flow(rest=STAIRS[0]),
            STAIRS,
            DWELL,
            every=1.0,
        ),
        _case(
            "site_flow",
            "Model of a flow loop as a site gives it: scanning PI, unmeasured load, tolerances",
            "Gain within 5 %, time constant within 10 %, a load at the process input that no sensor sees.",
            lambda: site_flow(rest=STAIRS[0]),
            STAIRS,
            DWELL,
        ),
        _case(
            "second_order_flow",
            "Model of a loop of second order with dead time, as a site gives it",
            "Two lags of 10 and 4 s and a dead time of 2 s; scan, load and noise as in site_flow.",
            lambda: second_order_flow(rest=STAIRS[0]),
            STAIRS,
            DWELL,
        ),
        _case(
            "level_loop",
            "Model of an integrating level with its PI, as a site gives it",
            "Hold-up 200 s within 10 %, half of the full inflow taken out; scan and load as in site_flow.",
            level_loop,
            LEVELS,
            1800.0,
        ),
        _case(
            "level_cascade",
            "Model of a level whose controller moves the set point of a flow loop, as a site gives it",
            "The level of level_loop over a flow loop of 3 s; scan, load and noise as in site_flow.",
            level_cascade,
            LEVELS,
            1800.0,
            signals=("SP_L", "L", "SP", "PV", "OP"),
        ),
        _case(
            "cascaded_tanks",
            "Model of two cascaded tanks without overflow: pump voltage to level of the lower tank",
            "Torricelli's law in both tanks, fitted to the public estimation record; the rig itself runs over.",
            cascaded_tanks,
            (3.0, 4.0, 2.0, 5.0),
            1000.0,
            every=4.0,
            signals=("u", "y"),
        ),
    )
}

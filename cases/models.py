"""Models of loops whose logs are to be compared with reality: what a diagnosis of the sim-to-real gap starts from.

    ideal_flow        the thesis's loop 6.2 with an ideal valve, known exactly; the sensor's noise is the only nuisance
    site_flow         the same loop as a site gives it: a scanning controller, an unmeasured load, unsure parameters
    cascaded_tanks    two tanks, the upper emptying into the lower, as the public record of the rig was made

All are diagrams without a log: the set point (``SP``), or the pump's voltage (``u``), is an open input, which a log
drives.  The cases of these names close it with a staircase.
"""

from typing import TYPE_CHECKING

from cases.case import Case

if TYPE_CHECKING:
    from blocks.block import Block
    from diagram.diagram import Diagram

K, TAU, K_P, T_I = 3.0, 10.0, 0.4, 10.0  # thesis eq. 6.2
NOISE = 0.004  # standard deviation of the sensor [unit of PV]
LOAD, LOAD_TIME = 0.01, 60.0  # of the site's load: standard deviation [unit of the process input], time constant [s]
STAIRS = (1.5, 1.8, 1.35, 1.65, 1.2, 1.5)  # set points of the cases
DWELL = 600.0  # [s]


def ideal_flow(rest: float = 0.0) -> "Diagram":
    """Return the loop with an ideal valve: process 3/(10 s + 1), continuous PI with K_p 0.4, T_i 10 s, OP in 0 ... 1.

    ``rest`` [unit of PV]: the PV at which it stands still at the start, from 0 to 3.  The load, 0 in the model, is
    added to the valve's flow; the sensor adds white noise of standard deviation 0.004, a new value each second.

    >>> [block.name for block in ideal_flow().blocks if block.name not in ("inflow", "noise")]
    ['controller', 'valve', 'feed', 'process', 'sensor', 'historian']
    >>> ideal_flow().open_inputs
    ('SP',)
    """
    from blocks import PI, Constant, Historian, Noise, Sum
    from diagram import wire

    return wire(
        [
            PI(K_P, T_I, anti_windup="conditional", start_op=rest / K),
            *_flow(rest, Constant("load", 0.0, name="feed").with_role("disturbance")),
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
    0.004, is drawn at each scan.  ``rest`` [unit of PV] as in ``ideal_flow``.

    >>> site_flow().tolerances
    {'process.K': 0.05, 'process.tau': 0.1}
    """
    from blocks import Historian, Noise, SampledPI, SampledSensor
    from diagram import wire

    return wire(
        [
            SampledPI(K_P, T_I, dt=1.0, anti_windup="conditional", integral="present", start_op=rest / K),
            *_flow(rest, Noise("load", sd=LOAD, dt=1.0, correlation_time=LOAD_TIME, name="feed")),
            SampledSensor(dt=1.0, sd=NOISE, start=rest, inputs="y", outputs="PV"),
            Historian(["SP", "PV", "OP", "MV"]),
        ],
        inputs=["SP"],
        name="site_flow",
    ).with_tolerances({"process.K": 0.05, "process.tau": 0.1})


def _flow(rest: float, feed: "Block") -> "list[Block]":
    """Return valve, feed, the sum of both and the process."""
    from blocks import FirstOrder, IdealValve, Sum

    return [
        IdealValve(spans={"MV": (0.0, 1.0)}),
        feed,
        Sum("F", {"MV": 1.0, "load": 1.0}, name="inflow"),
        FirstOrder(K, TAU, start=rest, inputs="F", outputs="y"),
    ]


def cascaded_tanks() -> "Diagram":
    """Return the rig of two tanks without overflow: pump voltage ``u`` [V], level of the lower tank ``y`` [V].

    Torricelli's law in both (``blocks.tank``), levels in volts of the level sensor, flows in volts of the pump; both
    outlets are taken as equal, since no level of the upper tank is logged.  Areas, outlets and the start of the upper
    tank are fitted to the whole estimation record, which leaves an error of 0.60 V (root mean square) in a free run.

    >>> cascaded_tanks().open_inputs, cascaded_tanks()["sensor"].output_labels
    (('u',), ['y'])
    """
    from blocks import IdealValve, Sensor, Tank
    from diagram import wire

    return wire(
        [
            IdealValve(name="pump", inputs="u", outputs="q", spans={"OP": (0.0, 10.0), "MV": (0.0, 10.0)}),
            Tank(37.1, 1.2014, start=5.05, name="tank_1", inputs="q", outputs=["h_1", "q_1", "over_1"]),
            Tank(13.37, 1.2014, start=5.205, name="tank_2", inputs="q_1", outputs=["h_2", "q_2", "over_2"]),
            Sensor(inputs="h_2", outputs="y", spans={"PV_m": (0.0, 10.0)}),
        ],
        inputs=["u"],
        name="cascaded_tanks",
    )


def _driven(model: "Diagram", signal: str, levels: tuple[float, ...], dwell: float) -> "Diagram":
    """Return a model whose open input is a staircase."""
    from blocks import Staircase
    from diagram import wire

    return wire([Staircase(signal, levels, dwell=dwell), *model.blocks], name=model.name)


CASES_BY_NAME = {
    case.name: case
    for case in (
        Case(
            name="ideal_flow",
            title="Model of a flow loop, known exactly: ideal valve, continuous PI, sensor noise",
            about="The thesis's loop 6.2 with an ideal valve; what a gap to it looks like is known to the last digit.",
            build=lambda: _driven(ideal_flow(rest=STAIRS[0]), "SP", STAIRS, DWELL),
            duration=len(STAIRS) * DWELL,
            every=1.0,
            numbers=tuple,
            signals=("SP", "PV", "OP"),
        ),
        Case(
            name="site_flow",
            title="Model of a flow loop as a site gives it: scanning PI, unmeasured load, tolerances",
            about="Gain within 5 %, time constant within 10 %, a load at the process input that no sensor sees.",
            build=lambda: _driven(site_flow(rest=STAIRS[0]), "SP", STAIRS, DWELL),
            duration=len(STAIRS) * DWELL,
            every=5.0,
            numbers=tuple,
            signals=("SP", "PV", "OP"),
        ),
        Case(
            name="cascaded_tanks",
            title="Model of two cascaded tanks without overflow: pump voltage to level of the lower tank",
            about="Torricelli's law in both tanks, fitted to the public estimation record; the rig itself runs over.",
            build=lambda: _driven(cascaded_tanks(), "u", (3.0, 4.0, 2.0, 5.0), 1000.0),
            duration=4000.0,
            every=4.0,
            numbers=tuple,
            signals=("u", "y"),
        ),
    )
}

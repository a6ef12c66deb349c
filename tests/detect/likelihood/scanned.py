"""A level loop whose controller scans several times between two logged rows, wired from blocks."""

from stickslip.blocks import Integrator, Noise, QuasiStaticStem, SampledPI, SampledSensor, Step, Sum
from stickslip.diagram import simulate, wire

ROW = 10.0  # s


def level(S, J, *, scans=10, rows=2500, seed=1):
    """OP and PV (rows + 1,) [%] of a level behind a stem of Karnopp's friction, with S and J [%], a load and noise."""
    dt = ROW / scans
    log = simulate(
        wire([
            Step("SP", 50.0),
            SampledPI(3.0, 200.0, dt=dt, high=100.0, start_op=50.0, inputs={"SP": "SP", "PV": "PV"}),
            QuasiStaticStem(S, J, high=100.0, start=50.0), Noise("load", 1.5, dt, correlation_time=300.0, seed=seed),
            Sum("in", {"MV": 1.0, "load": 1.0}), Integrator(0.004, u_0=50.0, start=50.0, inputs="in", outputs="level"),
            SampledSensor(dt, sd=0.01, seed=seed + 100, start=50.0, inputs="level", outputs="PV"),
        ]), ROW * rows, every=ROW,
    ).log  # fmt: skip
    return log["OP"], log["PV"]

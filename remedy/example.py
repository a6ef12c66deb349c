"""A sticky loop of known truth, for examples: S = 5 %, J = 1.5 %, K = 1.2, tau = 30 s, theta = 4 s, PI 0.8 and 30 s."""

from stickslip.logs import LoopRecord

__all__ = ["sticky"]


def sticky(hours: float = 1.0, S: float = 5.0, J: float = 1.5, seed: int = 1, sp: float = 50.0) -> LoopRecord:
    """Return a log of the loop every 2 s; ``S``, ``J`` [% of OP], ``sp`` [unit of PV].

    >>> record = sticky(0.1)
    >>> len(record), record.dt
    (181, 2.0)
    """
    from stickslip.blocks import FirstOrder, HeValve, Noise, SampledPI, SampledSensor, Step, Sum
    from stickslip.diagram import simulate, wire

    log = simulate(
        wire([
            Step("SP", sp), SampledPI(0.8, 30.0, dt=2.0, high=100.0, start_op=40.0, inputs={"SP": "SP", "PV": "PV"}),
            HeValve.from_bands(S, J, 2.0, high=100.0, start=40.0),
            FirstOrder(1.2, 30.0, 4.0, start=48.0, outputs="flow"),
            Noise("load", 0.8, 2.0, correlation_time=300.0, seed=seed), Sum("true", {"flow": 1.0, "load": 1.0}),
            SampledSensor(2.0, sd=0.1, seed=seed + 100, start=48.0, inputs="true", outputs="PV"),
        ]), 3600.0 * hours, every=2.0,
    ).log  # fmt: skip
    return LoopRecord.from_arrays(log.t, pv=log["PV"], op=log["OP"], sp=log["SP"], name="FIC101", unit_pv="m3/h")

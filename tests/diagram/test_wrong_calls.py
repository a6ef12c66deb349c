"""Users' mistakes, one a line: each is refused with a rule and a remedy, none by numba, numpy or Python."""

import re
import traceback
from pathlib import Path

import numpy as np
import pytest
from stickslip.blocks import BlockError, DeadTime, Equations, Gain, KanoValve
from stickslip.blocks.noise import Noise
from stickslip.blocks.sensor import SampledSensor, Sensor
from stickslip.blocks.sources import Ramp
from stickslip.diagram import drive, ensemble, simulate, wire
from stickslip.diagram.reference import simulate_reference

from stickslip import blocks

HOUSE = Path(__file__).resolve().parents[2]

CALLS = """
    simulate(P, 10.)
    simulate([P], 10.)
    simulate(None, 10.)
    simulate(simulate, 10.)
    simulate(loop, "10")
    simulate(loop, None)
    simulate(loop, -1)
    simulate(loop, float("nan"))
    simulate(loop, [1,2])
    simulate(loop, 1j)
    simulate(loop, 10, every="1")
    simulate(loop, 10, every=0)
    simulate(loop, 10, every=[1])
    simulate(loop, 10, times="abc")
    simulate(loop, 10, times=[[1,2],[3]])
    simulate(loop, 10, times=[3,2])
    simulate(loop, 10, times=[])
    simulate(loop, 10, times=5.0, every=1)
    simulate(loop, 10, times=[1j])
    simulate(loop, 10, rtol="x")
    simulate(loop, 10, rtol=0)
    simulate(loop, 10, atol=None)
    simulate(loop, 10, atol=-1)
    simulate(loop, 10, atol=[1,2])
    simulate(loop, 10, method="Radau")
    simulate(loop, 10, method=None)
    simulate(loop, 10, method=[])
    simulate(loop, 10, max_steps="x")
    simulate(loop, 10, max_steps=0)
    simulate(loop, 10, max_steps=1.5)
    simulate(loop, 10, t0="now")
    simulate(loop, 10, params=["valve.F_s"])
    simulate(loop, 10, params={"valve.F_s": "big"})
    simulate(loop, 10, params={"valve": 1})
    simulate(loop, 10, params={1: 1})
    simulate(loop, 10, params={"valve.F_s": [1,2]})
    simulate(loop, 10, params={"valve.F_s": None})
    simulate(loop, 10, params=3)
    simulate(loop, 10, start={"process.PV": "x"})
    simulate(loop, 10, start={"process": 1})
    simulate(loop, 10, start=["process.PV"])
    simulate(loop, 10, start={None: 1})
    simulate(op, 10)
    simulate(op, 10, inputs=0.5)
    simulate(op, 10, inputs={"SP": "x"})
    simulate(op, 10, inputs={"SP": None})
    simulate(op, 10, inputs={"SP": [1,2,3]})
    simulate(op, 10, inputs={"SP": ([0,1],[0])})
    simulate(op, 10, inputs={"SP": ("a","b")})
    simulate(op, 10, inputs={"SP": (1,2)})
    simulate(op, 10, inputs={"SP": np.nan})
    simulate(op, 10, inputs={"SP": 1j})
    simulate(op, 10, inputs={3: 1})
    simulate(op, 10, inputs=["SP"])
    simulate(loop, 10, signals=["nope"])
    simulate(loop, 10, signals=3)
    simulate(loop, 10, signals=[1])
    simulate(loop, 10, signals=[["PV"]])
    simulate(loop, 10, on_progress=3)
    simulate_reference(P, 10)
    simulate_reference(loop, "10")
    simulate_reference(loop, 10, method="x")
    simulate_reference(loop, 10, rtol="x")
    simulate_reference(loop, 10, rtol=-1)
    simulate_reference(loop, 10, max_step="x")
    simulate_reference(loop, 10, backend=None)
    drive(loop, 10)
    drive("x", 10)
    drive(P, "10", MV=1)
    drive(P, 10, MVV=1)
    drive(P, 10)
    ensemble(P, 10, params={"K":[1,2]})
    ensemble(loop, "10", params={"valve.F_s":[2000,2100]})
    ensemble(loop, 10)
    ensemble(loop, 10, params={"valve.F_s":["a","b"]})
    ensemble(loop, 10, params={"valve.F_s":[[1,2],[3]]})
    ensemble(loop, 10, params=[1,2])
    ensemble(loop, 10, params={"F_s":[1,2]})
    ensemble(loop, 10, seeds="x")
    ensemble(loop, 10, seeds=[1.5])
    ensemble(loop, 10, seeds=[-1])
    ensemble(loop, 10, seeds=[])
    ensemble(loop, 10, start={"process.PV":["a"]})
    ensemble(loop, 10, start=3)
    ensemble(loop, 10, params={"valve.F_s":[2000]}, workers="2")
    ensemble(loop, 10, params={"valve.F_s":[2000]}, workers=1.5)
    ensemble(loop, 10, params={"valve.F_s":[2000]}, signals=3)
    ensemble(loop, 10, params={"valve.F_s":[2000]}, summary=3)
    ensemble(loop, 10, params={"valve.F_s":[2000]}, every="1")
    FirstOrder(K="3", tau=1.)
    FirstOrder(K=None, tau=1.)
    FirstOrder(K=3, tau="x")
    FirstOrder(K=3, tau=1, start="x")
    FirstOrder(K=[1,2], tau=1)
    FirstOrder(K=3, tau=1, theta=None)
    FirstOrder(K=3, tau=1, name=None)
    FirstOrder(K=3, tau=1, name=3)
    FirstOrder(K=3, tau=1, inputs=3)
    FirstOrder(K=3, tau=1, inputs=[3])
    FirstOrder(K=3, tau=1, outputs=["a","b"])
    FirstOrder(K=3, tau=1, units="bar")
    FirstOrder(K=3, tau=1, units={"X":"bar"})
    FirstOrder(K=3, tau=1, units={"PV":3})
    FirstOrder(K=3, tau=1, spans=[0,1])
    FirstOrder(K=3, tau=1, spans={"PV": 3})
    FirstOrder(K=3, tau=1, spans={"XX": (0,1)})
    SecondOrder(K="3", omega=1, zeta=1)
    SecondOrder.from_lags(1, "x", 2)
    Integrator(K="3")
    Integrator(K=3, T=0, start="x")
    PI(K_p="3")
    PI(K_p=1, T_i="x")
    PI(K_p=1, T_i=1, low="x")
    PI(K_p=1, T_i=1, low=1, high=0)
    PI(K_p=1, T_i=1, action=3)
    PI(K_p=1, T_i=1, action=None)
    PI(K_p=1, T_i=1, anti_windup=["x"])
    PI(K_p=1, T_i=1, action=["x"])
    PI(K_p=1, T_i=1, start_op="x")
    PI(K_p=1, T_i=1, start_error="x")
    PID(K_p="1", T_i=1, T_d=1)
    PID(K_p=1, T_i=1, T_d="1")
    PID(K_p=1, T_i=1, T_d=1, b="x")
    PID(K_p=1, T_i=1, T_d=1, start_PV="x")
    SampledPI(K_p=1, T_i=1, dt="x")
    SampledPI(K_p=1, T_i=1, dt=None)
    SampledPI(K_p=1, T_i=1, dt=1, start_op="x")
    SampledPI("x", T_i=1, dt=1)
    StickSlip(F_s="x")
    StickSlip(F_s=2000, F_c="x")
    StickSlip(low="x")
    StickSlip(start="x")
    StickSlip(start=None)
    StickSlip(k=0)
    StickSlip.from_bands(S="x", J=1)
    StickSlip.from_bands(S=0.1, J=None)
    StickSlip().with_params(F_s="x")
    StickSlip().with_params(Fs=1)
    StickSlip().starting_at(x="a")
    StickSlip().in_mode(3)
    StickSlip().in_mode(None)
    QuasiStaticStem(S="x", J=0)
    QuasiStaticStem(S=0.1, J=None)
    Deadband("x")
    Deadband(0.1, start="x")
    DeadTime("x")
    DeadTime(None)
    KanoValve(S="x", J=0, dt=1)
    KanoValve(S=0.1, J=0, dt=1, start="x")
    ChoudhuryValve(S=0.1, J="x", dt=1)
    HeValve(f_s="x", f_d=0, dt=1)
    StenmanValve(d="x", dt=1)
    Sum("a", ["x","y"])
    Sum("a", "x")
    Sum("a", {})
    Sum("a", None)
    Sum("a", {"x": "y"})
    Sum("a", {"x": None})
    Sum(3, {"x": 1.})
    Sum("a", {1: 1.})
    Gain("a", "x", "y")
    Gain("a", 3, 1)
    Gain(None, "x", 1)
    Saturation("a", "x", low="x")
    Saturation("a", "x", 1, 0)
    Noise("D", sd="x", dt=1)
    Noise("D", sd=1, dt="x")
    Noise("D", sd=1, dt=1, seed="x")
    Noise(3, sd=1, dt=1)
    SampledSensor("x")
    SampledSensor(dt=1, low="x")
    SampledSensor(dt=1, start="x")
    SampledSensor(dt=1, step="x")
    Sensor(tau="x")
    Sensor(factor="x")
    Sensor(low="x")
    Sensor(start="x")
    Sensor(high=None)
    Step("SP", after="x")
    Step(3)
    Step("SP", at="x")
    Constant("SP", "x")
    Constant("SP", None)
    Constant("SP", [1,2])
    Ramp("SP", "x")
    Sine("SP", amplitude="x")
    Sine("SP", period=0)
    Recorded("SP", [0,1], [0])
    Recorded("SP", "ab", "cd")
    Recorded("SP", [0,1], ["a","b"])
    Recorded("SP", [0,1], [0,1], hold=3)
    Recorded("SP", 3, 4)
    Recorded("SP", None, None)
    wire(P)
    wire(None)
    wire([P, 3])
    wire(3)
    wire("abc")
    wire([P], inputs=3)
    wire([P], inputs=[3])
    wire([P], inputs=["MV"], outputs=3)
    wire([P], inputs=["MV"], outputs=[["PV"]])
    wire([P], inputs=["MV"], name=3)
    wire([FirstOrder, Step("MV")])
    wire([Step("MV"), P, P])
    wire([op, op])
    loop["x"]
    loop[0]
    loop.with_params("x")
    loop.with_params(3)
    loop.with_params({"valve.F_s": "x"})
    loop.starting_at(3)
    loop.starting_at({"process.PV": None})
    loop.in_mode(3)
    loop.in_mode("x")
    loop.in_mode({"valve": 3})
    loop.replace("valve", 3)
    loop.replace("x", P)
    loop.replace(3, P)
    loop.part(3)
    loop.part("x")
    loop.part([3])
    loop.without("x")
    loop.without(3)
    loop.without(["valve"])
    loop.named(3)
    loop.named("a", XX="b")
    loop.at_state([1])
    loop.at_state("x")
    op.named("a", SP=3)
    simulate(loop,1).log["x"]
    simulate(loop,1).plot(["x"])
    simulate(loop,1).plot("x")
    simulate(loop,1).plot(3)
    P.holding("x")
"""

loop = wire([blocks.Step("SP", after=0.5), blocks.PI(K_p=0.4, T_i=10.0), blocks.StickSlip(), blocks.FirstOrder(3, 10)])
NAMES = {
    **{name: getattr(blocks, name) for name in blocks.__all__},
    "Noise": Noise, "Sensor": Sensor, "SampledSensor": SampledSensor, "Ramp": Ramp, "np": np,
    "simulate": simulate, "drive": drive, "ensemble": ensemble, "wire": wire, "simulate_reference": simulate_reference,
    "loop": loop, "op": loop.without("SP"), "P": blocks.FirstOrder(K=1.0, tau=1.0),
}  # fmt: skip


@pytest.mark.parametrize("call", CALLS.split("\n")[1:-1])
def test_a_wrong_call_is_refused_with_a_rule_and_a_remedy(call):
    with pytest.raises(ValueError) as refusal:
        eval(call.strip(), dict(NAMES))
    where = traceback.extract_tb(refusal.value.__traceback__)[-1]
    message = str(refusal.value)
    assert Path(where.filename).is_relative_to(HOUSE) and "raise" in (where.line or ""), where
    assert ";" in message and len(message) > 30, message


def test_numbers_given_as_integers_are_taken():
    assert blocks.FirstOrder(3, np.int32(10)).p[:2].tolist() == [3.0, 10.0]
    assert blocks.PI(1, np.float32(10), start_op=None).params["T_i"] == 10.0


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Gain("u", K=2.0), "Gain: missing a required argument: 'source'; call it as Gain(signal, source, "),
        (lambda: DeadTime("late", "u", 5.0), "DeadTime: too many positional arguments; call it as DeadTime(theta, *, "),
        (lambda: blocks.PI(Kp=0.4, T_i=10.0), "PI: got an unexpected keyword argument 'Kp' (did you mean K_p?); call"),
        (lambda: DeadTime(5.0, signal="a"), "keyword argument 'signal'; call it as DeadTime(theta, *, start=0.0, "),
        (lambda: KanoValve(0.1, 0.0, 1.0, F_s=2.0), "keyword argument 'F_s'; call it as KanoValve(S, J, dt, "),
        (lambda: Equations("n", out=lambda u, n: (1.0, 2.0)[n] * u, inputs="u", outputs="y", params={"n": 1}),
         "block 'n': .* write int\\(n\\) where a whole number is needed"),
    ],
)  # fmt: skip
def test_a_wrong_call_says_how_the_block_is_called(call, words):
    with pytest.raises((TypeError, BlockError)) as refusal:
        wire([call()], inputs=["u"]).plan()
    assert words in str(refusal.value) or re.search(words, str(refusal.value))

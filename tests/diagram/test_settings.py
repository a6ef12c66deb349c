"""How to integrate, as one value: what it says for all that simulates, and what is refused."""

import numpy as np
import pytest
from stickslip.blocks import PI, FirstOrder, Noise, QuasiStaticStem, Sensor, Staircase, Step, Sum
from stickslip.diagram import Settings, ensemble, replay, replays, simulate, wire
from stickslip.diagram.branches import Branches
from stickslip.logs import Log
from stickslip.study import study

LAG = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)])
SHARP = Settings(rtol=1e-11, atol=1e-13, method="explicit")


def test_one_value_says_what_its_fields_say_by_name_everywhere():
    log = Log(t=np.arange(11.0), signals={"PV": np.linspace(0.0, 1.5, 11)})
    calls = (
        lambda **how: simulate(LAG, 20.0, every=1.0, **how).log["PV"],
        lambda **how: ensemble(LAG, 20.0, every=1.0, params={"process.K": [2.0]}, **how).values["PV"][0],
        lambda **how: replay(LAG, log, **how).log["PV:offset"],
        lambda **how: replays(LAG, log, params={"process.K": [2.0]}, **how).values["PV:offset"][0],
    )
    for call in calls:
        named = call(rtol=1e-11, atol=1e-13, method="explicit")
        assert np.array_equal(call(settings=SHARP), named)
        assert not np.array_equal(call(settings=Settings(method="explicit")), named)  # so the tolerances do arrive
        assert np.array_equal(call(settings=Settings(1e-3, 1e-13, "explicit"), rtol=1e-11), named)  # one field changed


def test_a_study_is_integrated_as_its_subject_says_unless_told_otherwise():
    asked = {"duration": 20.0, "every": 1.0, "signals": ["PV"]}
    assert study(LAG, {"process.K": [1.0]}, **asked).request["method"] == "auto"
    found = study(LAG, {"process.K": [1.0]}, settings=SHARP, rtol=1e-8, **asked).request
    assert (found["rtol"], found["atol"], found["method"]) == (1e-8, 1e-13, "explicit")


@pytest.mark.parametrize("call", [simulate, ensemble])
def test_a_name_that_nobody_knows_is_refused_with_the_nearest(call):
    with pytest.raises(TypeError, match=rf"{call.__name__} has no argument 'rtoll'; did you mean 'rtol'"):
        call(LAG, 20.0, rtoll=1e-8)
    with pytest.raises(TypeError, match="no argument 'evry'; did you mean 'every'"):
        call(LAG, 20.0, evry=1.0)
    with pytest.raises(ValueError, match=r"settings = 'stiff' are none; give Settings\(rtol=1e-8\)"):
        call(LAG, 20.0, settings="stiff")
    with pytest.raises(ValueError, match="1e-13 <= rtol"):
        call(LAG, 20.0, settings=Settings(rtol=0.0))


def sticky_loop(noisy):
    """Return a flow loop whose stem sticks; a model of it starts with the stem elsewhere."""
    noise = [Noise("D", sd=0.002, dt=1.0), Sum("seen", {"PV": 1.0, "D": 1.0})] if noisy else []
    return wire(
        [
            Staircase("SP", [0.3, 0.6, 0.4, 0.5], dwell=60.0), PI(0.4, 10.0, inputs={"PV": "PV_m"}),
            QuasiStaticStem(0.06, 0.02), FirstOrder(3.0, 10.0), *noise,
            Sensor(inputs="seen" if noisy else "PV", outputs="PV_m"),
        ]
    )  # fmt: skip


def test_replays_try_branches_as_a_replay_does():
    truth = simulate(sticky_loop(True), 240.0, every=1.0).log
    log = Log(truth.t, {s: truth[s] for s in ("OP", "PV_m")})
    tried = Branches("valve", changes={"PV_m": 0.012})
    gains = [2.7, 3.0, 3.3]
    many = replays(sticky_loop(False), log, params={"process.K": gains}, start={"valve.x": 0.2}, branches=tried)
    assert sum(map(len, many.taken)) > 0
    for i, gain in enumerate(gains):
        one = replay(sticky_loop(False), log, params={"process.K": gain}, start={"valve.x": 0.2}, branches=tried)
        assert np.array_equal(many.values["PV_m:offset"][i], one.log["PV_m:offset"])
        assert many.taken[i] == one.taken and many.run(i).taken == one.taken
    with pytest.raises(ValueError, match="no pin tells which branch is right"):
        replays(sticky_loop(False), log, params={"process.K": gains}, branches=Branches("valve"))

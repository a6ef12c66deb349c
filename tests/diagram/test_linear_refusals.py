"""Linear models: what is not at rest, not known or singular is refused with the reason."""

import pytest
from stickslip.blocks import PI, Constant, FirstOrder, Gain, Sum
from stickslip.diagram import WiringError, wire
from stickslip.diagram.linear import linearise, operating_point, rga
from stickslip.plant import production_plant
from stickslip.plant.loops import self_regulating_loop

PAIRED = ("LCS11", "PCS11", "LCS21", "PCS21")


def ideal(K=3.0, tau=10.0, K_p=0.4, T_i=10.0):
    """Return K/(tau s + 1) under K_p (T_i s + 1)/(T_i s), valve without dynamics."""
    return wire([Constant("SP", 0.5), PI(K_p, T_i, outputs="MV", start_op=0.2, start_error=0.5), FirstOrder(K, tau)])


def test_not_at_rest_is_said():
    loop = self_regulating_loop(setpoint=0.5)
    assert not linearise(loop).at_rest
    assert linearise(operating_point(loop).diagram).at_rest


def test_unknown_names_are_explained():
    linear = linearise(ideal())
    with pytest.raises(WiringError, match=r"no signal 'pv'; did you mean 'PV'"):
        linear.system("SP", "pv")
    with pytest.raises(WiringError, match=r"block 'process' is no controller"):
        linear.loop("process")
    with pytest.raises(WiringError, match=r"no block 'PCS99'"):
        linear.loop("PCS99")
    for frequency in (-1.0, float("nan"), float("inf")):
        with pytest.raises(ValueError, match=r"frequency = .* rad/s, but it is 0 \(steady\) or more"):
            linear.rga(frequency=frequency)
    for none in (linear.rga, linear.bode):
        with pytest.raises(ValueError, match=r"no(ne| controller)? is named or acts; name one"):
            none([])
    with pytest.raises(ValueError, match=r"t = nan, but sources stand still"):
        linearise(ideal(), float("nan"))
    with pytest.raises(ValueError, match=r"has no slopes where it starts: S1 is full"):
        linearise(production_plant("B").with_params({"S1.V_sep": 40.0}))


def test_singular_gains_are_refused():
    same = wire(
        [
            Constant("SP", 0.0), PI(1.0, 9.0, low=-9, high=9, name="C1", inputs=["SP", "PV"], outputs="u1"),
            PI(1.0, 9.0, low=-9, high=9, name="C2", inputs=["SP", "y"], outputs="u2"),
            Sum("u", {"u1": 1.0, "u2": 1.0}), FirstOrder(1.0, 5.0, inputs="u"), Gain("y", "PV", 2.0),
        ]
    )  # fmt: skip
    with pytest.raises(ValueError, match=r"gains are singular"):
        rga(same)

"""Limit cycles of the kicked plant, case 1, and its behaviour under the sine, case 2.

Published: thesis table 5.4.  Notes: table 3.1 of the plant's description, found with a program of its own at the same
kick (half of these numbers were fitted there, so agreement is agreement of two programs, not a prediction).
"""

import numpy as np
import pytest
from stickslip.diagram import simulate
from stickslip.plant import kicked, production_plant

from tests.plant.oscillation import period_and_amplitude

# (set, stiction): level T, A; p_1 T, A [bar]; p_out2 A [bar].
NOTES = {
    ("B", "normal"): (298.0, 0.289, 99.0, 0.228, 0.131),
    ("B", "high"): (153.0, 0.335, 38.0, 0.340, 0.263),
    ("A", "high"): (217.0, 0.352, 46.0, 0.330, 0.245),
}
PUBLISHED = {"normal": (101.0, 0.26, 0.12), "high": (37.0, 0.44, 0.29)}


def late(run, signal, unit=1.0):
    window = run.log.t >= 1000.0
    return period_and_amplitude(run.log.t[window], run.log[signal][window] / unit)


@pytest.mark.parametrize(("name", "F_s"), NOTES)
def test_cycles_of_case_1(name, F_s):
    run = simulate(kicked(production_plant(name, F_s=F_s)), 2000.0, every=0.1, method="stiff")
    T_V, A_V, T_p, A_p, A_out = NOTES[name, F_s]
    period, amplitude = late(run, "V_1")
    assert (period, amplitude) == pytest.approx((T_V, A_V), rel=0.05)
    period, amplitude = late(run, "p_1", 1e5)
    assert (period, amplitude) == pytest.approx((T_p, A_p), rel=0.05)
    carried, outlet = late(run, "p_out2", 1e5)
    assert outlet == pytest.approx(A_out, rel=0.05)
    assert carried == pytest.approx(period, rel=0.02)  # the oscillation travels to the compressor
    if name == "B":
        T_pub, A_pub, out_pub = PUBLISHED[F_s]
        assert period == pytest.approx(T_pub, rel=0.10)
        assert amplitude == pytest.approx(A_pub, rel=0.25)
        assert outlet == pytest.approx(out_pub, rel=0.15)


def test_level_amplitude_is_that_of_the_stem():
    """Describing function: half of S/K_p."""
    for F_s, S in (("normal", 3000.0 / 52500.0), ("high", 3500.0 / 52500.0)):
        run = simulate(kicked(production_plant("B", F_s=F_s)), 2000.0, every=0.2, method="stiff")
        assert late(run, "V_1")[1] == pytest.approx(S / 2.0 / 0.1, rel=0.10)  # analytic


@pytest.mark.parametrize(("name", "T", "A"), [("A", 149.0, 0.090), ("B", 106.0, 0.134)])
def test_deadband_alone_cycles_once_kicked(name, T, A):
    """Notes, erratum 12, only VPCS1 sticky; the thesis says it cannot, and from rest it does not."""
    run = simulate(kicked(production_plant(name, sticky=("VPCS1",), F_s="none")), 4000.0, every=0.5, method="stiff")
    window = run.log.t >= 2000.0
    found = period_and_amplitude(run.log.t[window], run.log["p_1"][window] / 1e5)
    assert found[0] == pytest.approx(T, rel=0.15) and found[1] == pytest.approx(A, rel=0.25)


@pytest.mark.parametrize("F_s", [1750.0, 2250.0])
def test_printed_gain_cannot_make_a_pressure_cycle(F_s):
    """Erratum 8: with K_p = 5E-10 /Pa the valve hardly moves."""
    slow = kicked(production_plant("B", F_s=F_s)).with_params({"PCS11.K_p": 5e-10})
    run = simulate(slow, 1000.0, every=1.0, method="stiff")
    assert np.ptp(run.log["OP_VPCS1"]) < 0.02
    assert sum(event.block == "VPCS1" for event in run.events) <= 4


@pytest.mark.parametrize("F_s", ["none", "normal", "high"])
def test_sine_saturates_the_gas_valve(F_s):
    """Case 2, set A: notes 3.2 and 5.11."""
    run = simulate(production_plant("A", F_s=F_s, case=2), 2000.0, every=0.1, method="stiff")
    log = run.log
    shut = log["OP_VPCS1"] <= 1e-9
    assert 0.30 <= shut.mean() <= 0.45  # thesis: about 40 %
    assert log["p_1"].min() < 28e5 and log["p_1"].max() < 30.6e5
    assert log["F_flare1"].max() == 0.0 and log["F_flare2"].max() == 0.0
    assert log["OP_VRVC2"].max() == pytest.approx(0.37, abs=0.02)
    assert log["OP_VLCS1"].max() == 1.0
    assert np.ptp(log["p_out2"]) == pytest.approx(2.2e5, rel=0.1)
    slips = [e.t for e in run.events if e.block == "VPCS1" and e.before == "stuck"]
    assert all(np.interp(t, log.t, log["OP_VPCS1"]) > 0.0 for t in slips)  # ripples only where OP > 0

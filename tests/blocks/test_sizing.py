"""Valve sizes: definitions of Kv and Cv, the standard's examples by hand, and the library that does the rest."""

import builtins
import math
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.control_valve_flow import ControlValveFlow
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sizing import C_v_from_Kv, Kv_from_C_v, Kv_from_Cv, Sizing, size_gas_valve, size_liquid_valve

WATER = {"density": 999.1, "p_vapour": 1.7e3, "p_critical": 220.6e5}


def test_kv_is_cubic_metres_of_water_per_hour_at_one_bar():
    """Definition of Kv, IEC 60534-1: 1 m3/h at 1 bar."""
    body = ControlValveFlow.from_Kv(1.0, 999.1)
    assert 3600.0 / 999.1 * body.output(0.0, [], [2e5, 1e5, 1.0])[0] == pytest.approx(1.0, rel=1e-6)  # analytic
    assert 3600.0 / 999.1 * body.output(0.0, [], [5e5, 1e5, 1.0])[0] == pytest.approx(2.0, rel=1e-6)
    assert 3600.0 / 999.1 * body.output(0.0, [], [2e5, 1e5, 0.5])[0] == pytest.approx(0.5, rel=1e-6)


def test_cv_is_gallons_per_minute_at_one_psi():
    # Published: Kv = 0.865 Cv (IEC 60534-1).
    assert Kv_from_Cv(1.0) == pytest.approx(0.865, abs=5e-5)
    assert Sizing(0.865).Cv == pytest.approx(1.0, abs=1e-4)
    gallon, psi = 3.785411784e-3, 6894.757293168  # definitions
    mass = 999.1 * 7.0 * gallon / 60.0  # kg/s of water through Cv = 7 at 1 psi
    assert C_v_from_Kv(Kv_from_Cv(7.0), 999.1) * math.sqrt(psi) == pytest.approx(mass, rel=1e-9)


def test_density_and_moles():
    """A heavier liquid passes less volume, by the root of its density; moles are mass over molar mass."""
    heavy, light = (C_v_from_Kv(50.0, rho) / rho for rho in (1600.0, 400.0))  # volume flows
    assert light / heavy == pytest.approx(2.0, rel=1e-12)  # analytic
    assert C_v_from_Kv(50.0, 650.0, 0.078) * 0.078 == pytest.approx(C_v_from_Kv(50.0, 650.0), rel=1e-12)
    assert ControlValveFlow.from_Kv(50.0, 650.0, 0.078).units["F"] == "mol/s"


@given(st.floats(1e-3, 1e4), st.floats(0.5, 2e3), st.one_of(st.none(), st.floats(1e-3, 0.9)))
def test_kv_and_c_v_are_inverse(Kv, density, W):
    assert Kv_from_C_v(C_v_from_Kv(Kv, density, W), density, W) == pytest.approx(Kv, rel=1e-12)


@pytest.mark.parametrize(("size", "F_L", "F_d", "Kv"), [(0.15, 0.9, 0.46, 165.0), (0.1, 0.6, 0.98, 238.0)])
def test_examples_1_and_2_of_the_standard(size, F_L, F_d, Kv):
    """Water at 363 K, 680 to 220 kPa, 360 m3/h: a globe valve that does not choke, a segmented ball that does."""
    water = {"density": 965.4, "p_vapour": 70.1e3, "p_critical": 22120e3, "viscosity": 3.1472e-4}
    duty = size_liquid_valve(96.54, 680e3, 220e3, **water, F_L=F_L, F_d=F_d, diameters=(size, size, size))
    assert duty.Kv == pytest.approx(Kv, rel=2e-3)  # published: IEC 60534-2-1, annex E
    # By hand, without fittings: dp chokes at F_L^2 (p_up - F_F p_vapour).
    F_F = 0.96 - 0.28 * math.sqrt(70.1 / 22120.0)
    most = F_L**2 * (680e3 - F_F * 70.1e3)
    assert duty.choked == (most < 460e3)
    assert duty.Kv == pytest.approx(360.0 * math.sqrt(965.4 / 999.1 / (min(most, 460e3) / 1e5)), rel=1e-4)


def test_example_3_of_the_standard():
    """Carbon dioxide at 433 K, 680 to 310 kPa, 3800 m3/h at 0 degrees and 1 atm: reducers, not choked."""
    normal = 3800.0 / 3600.0
    m = normal * 101325.0 / (8.314462618 * 273.15) * 0.04401
    fitted = size_gas_valve(
        m, 680e3, 310e3, molar_mass=0.04401, T=433.0, gamma=1.30, Z=0.988, x_T=0.60, F_L=0.85, F_d=0.42,
        viscosity=1.4665e-4, diameters=(0.08, 0.1, 0.05),
    )  # fmt: skip
    assert fitted.Kv == pytest.approx(72.6, abs=0.05) and not fitted.choked  # published: IEC 60534-2-1, annex E
    bare = size_gas_valve(m, 680e3, 310e3, molar_mass=0.04401, T=433.0, gamma=1.30, Z=0.988, x_T=0.60)
    x = 370.0 / 680.0
    Y = 1.0 - x / (3.0 * 1.30 / 1.40 * 0.60)
    assert pytest.approx(Y, rel=1e-12) == bare.Y
    # By hand: C = Q/(N9 p_1 Y) sqrt(M T Z/x), N9 = 24.6 for kPa and 0 degrees.
    by_hand = 3800.0 / (24.6 * 680.0 * Y) * math.sqrt(44.01 * 433.0 * 0.988 / x)
    assert bare.Kv == pytest.approx(by_hand, rel=1e-9)


def test_gas_chokes_beyond_its_pressure_drop_ratio():
    gas = {"molar_mass": 0.016, "T": 302.95, "gamma": 1.3067}
    most = 1.3067 / 1.4 * 0.7
    below, above, far = (
        size_gas_valve(10.0, 75e5, 75e5 * (1 - x), **gas) for x in (most - 0.01, most + 0.01, most + 0.2)
    )
    assert (below.choked, above.choked, far.choked) == (False, True, True)
    assert pytest.approx(2.0 / 3.0) == far.Y and far.Kv == pytest.approx(above.Kv, rel=1e-12)


def test_thesis_valves_are_of_real_size():
    """Table A.2 in Kv: oil 670 and 1012 m3/h, gas 3620 m3/h; docs/evidence/measured.md."""
    # Snapshot: densities and molar masses at rest, case 1.
    assert Kv_from_C_v(6.1, 650.107, 0.0777184) == pytest.approx(669.7, abs=0.1)
    assert Kv_from_C_v(8.7, 655.667, 0.0827241) == pytest.approx(1012.3, abs=0.1)
    assert Kv_from_C_v(27.4, 18.993, 0.016) == pytest.approx(3623.0, abs=1.0)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: C_v_from_Kv(0.0, 1000.0), "Kv = 0.0, but it must be positive and finite; give SI units"),
        (lambda: Kv_from_C_v(1.0, -1.0), "density = -1.0"),
        (lambda: Kv_from_Cv(math.nan), "Cv = nan"),
        (lambda: C_v_from_Kv(1.0, 1000.0, 0.0), "molar_mass = 0.0"),
        (lambda: size_liquid_valve(1.0, 1e5, 2e5, **WATER), "sized for a falling pressure"),
        (lambda: size_liquid_valve(1.0, 2e5, 1e5, **WATER, diameters=(0.1, 0.1, 0.0)), "valve = 0.0"),
        (lambda: size_gas_valve(1.0, 2e5, 1e5, molar_mass=0.016, T=300.0, gamma=1.0), "gamma = 1.0"),
        (
            lambda: size_liquid_valve(100.0, 3e5, 2.9e5, **WATER, diameters=(0.1, 0.1, 0.05)),
            "no valve passes the flow at a drop of 10000 Pa with such fittings",
        ),
        (
            lambda: size_gas_valve(1.0, 3e5, 2.9e5, molar_mass=0.016, T=300.0, gamma=1.3, diameters=(0.1, 0.1, 0.05)),
            "they alone take more",
        ),
        (
            lambda: C_v_from_Kv(1.0, 1000.0, 18.0),
            "molar_mass = 18.0, but it is positive, in kg/mol; divide g/mol by 1000",
        ),
        (lambda: size_gas_valve(1.0, 2e5, 1e5, molar_mass=16.0, T=300.0, gamma=1.3), "molar_mass = 16.0"),
        (lambda: size_gas_valve(1.0, 2e5, 1e5, molar_mass=0.016, T=300.0, gamma=1.3, x_T=2.0), "x_T = 2.0"),
        (lambda: size_liquid_valve(1.0, 2e5, 1e5, **WATER, F_L=2.0), "F_L = 2.0, but it is a share"),
        (
            lambda: size_liquid_valve(1.0, 3e5, 2e5, **{**WATER, "p_vapour": 4e5}),
            "p_vapour = 400000.0, but liquid stands before the valve, at p_up = 300000 Pa",
        ),
        (lambda: size_liquid_valve(1.0, 3e5, 2e5, **{**WATER, "p_vapour": 2e5, "p_critical": 1e5}), "below p_critical"),
        (lambda: size_liquid_valve(1.0, 2e5, 1e5, **WATER, diameters=(0.1, 0.1)), "give three, in m"),
        (lambda: size_liquid_valve(1.0, 2e5, 1e5, **WATER, diameters=(0.1, 0.1, 0.3)), "valve = 0.3"),
        (lambda: ControlValveFlow.from_Kv(1.0, 1000.0, unit="mol/s"), "unit = 'mol/s', but this size is in kg/s"),
    ],
)
def test_misuse_is_explained(call, words):
    with pytest.raises(BlockError) as error:
        call()
    assert words in str(error.value)


def test_without_the_library_the_remedy_is_named(monkeypatch):
    real = builtins.__import__

    def refuse(name, *args, **kwargs):
        if name.startswith("fluids"):
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(ImportError, match=r"pip install 'stickslip\[sizing\]'"):
        size_liquid_valve(1.0, 2e5, 1e5, **WATER)


def test_the_library_is_loaded_only_when_asked():
    code = "import sys; from stickslip import blocks; print('fluids' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"

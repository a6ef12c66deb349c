"""Every effect of the catalogue: tried, nothing at its neutral values, the same by insertion and by parameters."""

import numpy as np
import pytest
from stickslip.cases.models import CASES_BY_NAME
from stickslip.diagram import simulate
from stickslip.gap.effects import CATALOGUE, effect

from tests.gap.effect_loops import ELSEWHERE, EXACT, EXACTLY, LOGGED, SIZES, T, put, quiet


def test_every_effect_is_tried():
    of_plant = {one.name for one in CATALOGUE if not any(one.places(case.build()) for case in CASES_BY_NAME.values())}
    assert {one.name for one in CATALOGUE} == {*SIZES, *ELSEWHERE, *of_plant}
    assert len(of_plant) == 10 and len(CATALOGUE) == len({one.name for one in CATALOGUE})


@pytest.mark.parametrize("name", SIZES)
def test_it_goes_to_nothing_near_its_neutral_values_and_only_there(name):
    place, small, plain = SIZES[name]
    one = effect(name)
    coarse = {"rtol": 1e-9, "atol": 1e-11} if name in ("scan_time", "quantisation") else EXACT
    still = quiet()
    neutral = one.nominal(still, place)
    assert one.insert(still, place, **neutral) is still and one.insert(still, place) is still
    nearly = one.started(one.insert(still, place, **small), place, EXACTLY["first"])
    other = one.started(one.insert(still, place, **plain), place, EXACTLY["first"])
    assert set(still.open_inputs) == set(nearly.open_inputs) and nearly.declared_outputs == still.declared_outputs
    times = np.arange(0.5, T)  # not at the instants at which SP jumps
    base, tiny, seen = (simulate(d, T, times=times, **coarse).log for d in (still, nearly, other))
    near = max(np.abs(tiny[s] - base[s]).max() for s in LOGGED)
    away = max(np.abs(seen[s] - base[s]).max() for s in LOGGED)
    assert near < {"dead_time": 5e-3, "quantisation": 3e-3, "scan_time": 1e-4}.get(name, 5e-6) < away
    assert 3.0 * near < away and away > 1e-3


@pytest.mark.parametrize("name", [name for name in SIZES if name != "sensor_noise"])
def test_settings_are_the_insertion(name):
    place, small, plain = SIZES[name]
    still = quiet()
    once = effect(name).insert(still, place, **small)
    full = {p.name: effect(name).nominal(still, place)[p.name] for p in effect(name).parameters} | plain
    assert (
        once.with_params(effect(name).settings(still, place, **full)).params == put(name, place, still, **plain).params
    )

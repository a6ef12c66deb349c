"""Large diagrams by a filter: how a log cuts them, what jumps between rows, and what is named in a separator."""

import numpy as np
import pytest

from benchmarks.gap.plant import MODELS, PlantRun
from gap import diagnose
from gap.effects import effect
from gap.linearised.between import jumps
from gap.linearised.filtered import filter_of
from gap.linearised.parts import parts
from gap.model import read, silenced


@pytest.fixture(scope="module")
def healthy():
    return PlantRun("separator_section", seed=41).made()


def seen(log, name="separator_section"):
    model, record = read(MODELS[name][0](), log)
    return model, silenced(model), record


def test_logged_outputs_of_controllers_cut_a_plant(healthy):
    _, quiet, record = seen(healthy)
    found = parts(quiet, record)
    assert found.ruled == ("LCS11", "PCS11") and found.measured == ("p_1", "V_1")
    assert {"VLCS1", "VPCS1"} <= set(found.fed) and "S1" in found.rest and not set(found.fed) & set(found.rest)


def test_a_plant_with_an_unmeasured_feed_has_a_filter_that_knows_the_feed_as_a_load(healthy):
    model, quiet, record = seen(healthy)
    found = filter_of(model, quiet, record)
    assert found is not None
    assert list(found.filter.loads) == ["F_in"] and "F_in" in found.filter.parts.rest


def test_an_output_jumps_where_its_set_point_does(healthy):
    _, quiet, record = seen(healthy)
    moved = np.flatnonzero(np.diff(healthy["SP_PCS11"])) + 1
    np.testing.assert_array_equal(np.flatnonzero(jumps(quiet, record, healthy, "OP_VPCS1")), moved)
    assert not jumps(quiet, record, healthy, "p_1").any()


def test_scanning_loops_are_replayed_instead():
    from benchmarks.gap.generator import record as made
    from cases.models import site_flow
    from logs import Log

    one = made("site", hours=0.1)
    log = Log(one.signals["time"], {s: one.signals[s] for s in ("SP", "PV", "OP")})
    model, record = read(site_flow(), log)
    assert filter_of(model, silenced(model), record) is None


def test_nothing_is_named_where_there_is_nothing(healthy):
    assert not diagnose(MODELS["separator_section"][0](), healthy, catalogue=[effect("valve_gain")]).gap


@pytest.mark.parametrize(("name", "place"), [("controller_gain", "LCS11"), ("boil_off_rate", "S1")])
def test_an_effect_is_named_at_its_place(name, place):
    log = PlantRun("separator_section", name, place, seed=42).made()
    known = [effect(one) for one in ("valve_gain", "valve_leak", "controller_gain", "boil_off_rate", "vapour_pressure")]
    report = diagnose(MODELS["separator_section"][0](), log, catalogue=known)
    assert (report.causes[0].effect, report.where.confidence_set) == (name, (place,))

"""The documents of ``fit``, ``remedy`` and ``gap --fit``: every agreed key, and a reason beside every null."""

import json

import pytest
from stickslip.remedy import Changes

SIZE = {"value", "low", "high"}
KNOWN = {}  # what records say -> their fit


@pytest.fixture(autouse=True)
def once(monkeypatch):
    """Fit each record once, however many commands of this file ask for it."""
    from stickslip import remedy

    plain = remedy.fit

    def remembered(records, **settings):
        key = tuple(one.pv.tobytes() + one.op.tobytes() for one in records)
        if key not in KNOWN:
            KNOWN[key] = plain(records, **settings)
        return KNOWN[key]

    monkeypatch.setattr(remedy, "fit", remembered)


@pytest.fixture
def files(plant):
    return {"sticky": plant / "FIC1.csv", "sound": plant / "FIC2.csv"}


def read(result):
    return json.loads(result.stdout, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))


def is_size(one):
    """Value, low and high, numbers in order, or null with a reason."""
    assert set(one) - {"reason", "unit"} == SIZE
    if one["value"] is None:
        assert one["reason"]
    elif one["low"] is not None and one["high"] is not None:
        assert one["low"] <= one["value"] <= one["high"]
    return True


def is_fit(one):
    assert is_size(one["valve"]["S"]) and is_size(one["valve"]["J"]) and isinstance(one["valve"]["unit"], str)
    assert all(is_size(one["controller"][key]) for key in ("K_p", "T_i", "T_d", "T_f"))
    assert all(is_size(one["process"][key]) for key in ("K", "KJ", "tau", "tau_2", "theta"))
    assert isinstance(one["process"]["integrating"], bool)
    assert is_size(one["load_sd"]) and is_size(one["noise_sd"])
    assert one["one_step_error"] > 0.0 and one["free_error"] > 0.0
    return True


@pytest.mark.parametrize(("name", "sticks"), [("sticky", True), ("sound", False)])
def test_a_fit_has_every_key(call, files, name, sticks):
    result = call("fit", files[name], "--json", "-")
    found = read(result)
    assert result.exit_code == int(sticks)
    assert found["schema"] == "stickslip.fit/1" and is_fit(found) and found["valve"]["sticks"] is sticks


def test_a_remedy_has_every_key(call, files):
    result = call("remedy", files["sticky"], "--json", "-")
    found = read(result)
    assert found["schema"] == "stickslip.remedy/1" and is_fit(found["fit"])
    keys = ("pv_sd", "travel_per_h", "reversals_per_h")
    assert all(is_size(found["none"][key]) for key in keys)
    names = [one["name"] for one in found["remedies"]]
    for one in found["remedies"]:
        assert isinstance(one["settings"], dict) and all(is_size(one[key]) for key in keys)
    for when in ("until_shutdown", "at_shutdown"):
        assert found[when] is None or found[when] in names
    assert result.exit_code == int(found["until_shutdown"] is not None or found["at_shutdown"] is not None)


def test_what_changed_has_the_form_of_a_gap_report(call, files):
    result = call("gap", files["sound"], "--fit", files["sticky"], "--json", "-")
    found = read(result)
    assert result.exit_code == int(found["gap"]) and found["gap"]
    assert set(found["where"]) == {"place", "probability", "confidence_set", "shares"}
    (first, *_) = found["causes"]
    assert (first["effect"], first["place"]) == ("stiction", "valve") and found["where"]["place"] == "valve"
    assert set(first) == {"effect", "place", "probability", "ambiguous_with", "parameters"}
    assert all(is_size(first["parameters"][key]) for key in ("earlier", "later", "ratio"))
    assert {one["effect"] for one in found["ranking"]} >= {"stiction", "process_gain", "controller_gain", "disturbance"}
    nothing = Changes((), ()).to_dict()
    assert set(nothing) == set(found) - {"schema"}
    assert (nothing["gap"], nothing["where"], nothing["causes"]) == (False, None, [])

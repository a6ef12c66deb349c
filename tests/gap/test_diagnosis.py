"""The whole way from a log to a report, on short records and with a few effects."""

import json
from dataclasses import replace

import numpy as np
import pytest
from stickslip.blocks import IdealValve
from stickslip.cases.models import ideal_flow
from stickslip.gap import GapError, diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log

NAMES = ("valve_gain", "process_gain", "sensor_span", "dead_time", "controller_gain", "sensor_bias")
FEW = [effect(name) for name in NAMES]


def test_no_gap_is_said_in_the_words_of_the_document(recorded):
    report = diagnose(ideal_flow(), recorded(seed=5), catalogue=FEW, progress=False)
    assert report.to_dict() == {
        "gap": False,
        "where": None,
        "causes": [],
        "ranking": [],
        "hints": [],
        "shrinkage": None,
    }
    assert str(report).startswith("No gap of relevance")


@pytest.mark.parametrize(
    ("name", "place", "values", "places"),
    [
        ("dead_time", "process", {"theta": 0.8}, {"process"}),
        ("controller_gain", "controller", {"factor": 1.15}, {"controller"}),
        ("valve_gain", "valve", {"factor": 0.93}, {"valve", "process", "sensor"}),
    ],
)
def test_the_cause_is_named_up_to_what_the_log_tells_apart(recorded, name, place, values, places):
    report = diagnose(ideal_flow(), recorded(name, place, **values), catalogue=FEW, progress=False)
    found = report.to_dict()
    json.dumps(found, allow_nan=False)
    assert set(found) == {"gap", "where", "causes", "ranking", "hints", "shrinkage"} and found["gap"] is True
    (cause,) = found["causes"]
    assert set(cause) == {"effect", "place", "probability", "ambiguous_with", "parameters"}
    assert name in [cause["effect"], *cause["ambiguous_with"]] and set(found["where"]["confidence_set"]) == places
    assert 1 + len(cause["ambiguous_with"]) == len(places)
    assert 0.0 < cause["probability"] < 1.0
    (key,) = values
    (size,) = [size for k, size in cause["parameters"].items() if k == key]
    assert size["value"] == pytest.approx(values[key], rel=3e-3) and set(size) == {"value", "low", "high", "unit"}
    assert found["shrinkage"]["fraction"] > 0.95
    assert set(found["shrinkage"]) == {"before", "after", "floor", "fraction", "low", "high"}


@pytest.mark.usefixtures("without_hints")
def test_what_the_catalogue_lacks_is_unknown(recorded):
    without = [one for one in FEW if one.name != "dead_time"]
    log = recorded("dead_time", "process", theta=2.0)
    report = diagnose(ideal_flow(), log, catalogue=without, progress=False)
    assert [cause.effect for cause in report.causes] == ["unknown"] and report.shrinkage is None
    assert report.where is not None and {"valve", "process", "sensor"} <= set(report.where.confidence_set)
    assert "controller" not in report.where.confidence_set


def test_two_effects_are_both_named(recorded):
    one, two = effect("controller_gain"), effect("sensor_bias")
    from stickslip.diagram import ensemble

    log = recorded()
    model = two.insert(one.insert(ideal_flow(rest=1.5), "controller", factor=1.2), "sensor", offset=0.05)
    many = ensemble(
        model, log.duration, times=log.t, inputs=Log(log.t, {"SP": log["SP"]}), seeds=[2], signals=["OP", "PV"],
        progress=False,
    )  # fmt: skip
    made = Log(log.t, {"SP": log["SP"], **{s: many.values[s][0].round(6) for s in ("OP", "PV")}})
    report = diagnose(ideal_flow(), made, catalogue=[one, two, effect("dead_time")], progress=False)
    assert {cause.effect for cause in report.causes} == {"controller_gain", "sensor_bias"}


def test_the_same_seed_gives_the_same_report(recorded):
    log = recorded("sensor_bias", "sensor", offset=0.03)
    few = [effect("sensor_bias"), effect("process_gain")]
    first, second = (diagnose(ideal_flow(), log, catalogue=few, progress=False).to_dict() for _ in range(2))
    assert first == second and first["causes"][0]["effect"] == "sensor_bias"


@pytest.mark.parametrize(
    ("log", "words"),
    [
        (Log(np.arange(5.0), {"PV": np.zeros(5)}), "too few"),
        (Log(np.arange(50.0), {"PV": np.zeros(50)}), "input 'SP' is not in the log"),
        (Log(np.arange(50.0), {"SP": np.zeros(50)}), "none of the signals that the model drives"),
        (Log(np.arange(50.0), {"SP": np.zeros(50), "PV": np.zeros(50), "op": np.zeros(50)}), "column 'op'.* 'OP'"),
        ([1.0, 2.0], "give a Log"),
        ({"SP": np.zeros(50), "PV": np.zeros(50)}, "Log\\(t, "),
    ],
)
def test_what_does_not_fit_together_is_refused(log, words):
    with pytest.raises(GapError, match=words):
        diagnose(ideal_flow(), log)


def test_a_block_alone_is_no_model():
    with pytest.raises(GapError, match="the model is IdealValve; give a diagram"):
        diagnose(IdealValve(), Log(np.arange(50.0), {"OP": np.zeros(50)}))


def test_the_pictures_show_the_place(recorded):
    report = diagnose(ideal_flow(), recorded("sensor_bias", "sensor", offset=0.03), catalogue=FEW[-1:], progress=False)
    panels = report.plot().axes
    assert [ax.get_ylabel().split("\n")[0] for ax in panels] == ["residual of PV", "residual of OP"]
    assert [text.get_text() for text in panels[0].get_legend().get_texts()] == ["model as it is", "with sensor_bias"]
    assert report.plot_diagram().axes


def test_the_picture_of_an_unknown_gap_says_with_which_effect_it_is(recorded):
    # expected before: "with the cause", of which there is none
    report = diagnose(ideal_flow(), recorded("sensor_bias", "sensor", offset=0.03), catalogue=FEW[-1:], progress=False)
    unknown = replace(report, causes=(replace(report.causes[0], effect="unknown"),))
    texts = unknown.plot().axes[0].get_legend().get_texts()
    assert texts[1].get_text() == "with sensor_bias, the nearest effect"


def test_noise_may_be_one_of_two(recorded):
    few = [effect("sensor_noise"), effect("controller_gain"), effect("sensor_bias")]
    one = effect("controller_gain").insert(ideal_flow(rest=1.5), "controller", factor=1.2)
    noisy = effect("sensor_noise").insert(one, "sensor", factor=3.0)
    from stickslip.diagram import ensemble

    log = recorded()
    inputs = Log(log.t, {"SP": log["SP"]})
    many = ensemble(noisy, log.duration, times=log.t, inputs=inputs, seeds=[2], signals=["OP", "PV"], progress=False)
    made = Log(log.t, {"SP": log["SP"], **{s: many.values[s][0].round(6) for s in ("OP", "PV")}})
    report = diagnose(ideal_flow(), made, catalogue=few, progress=False)
    assert {cause.effect for cause in report.causes} == {"controller_gain", "sensor_noise"}


def test_a_slow_signal_coarsely_rounded_is_no_compression():
    from stickslip.cases.models import site_flow
    from stickslip.diagram import ensemble

    t, fine = np.arange(0.0, 7201.0, 5.0), np.arange(7201.0)
    SP = np.where(fine % 1200 < 600, 1.5, 1.6)
    log = Log(fine, {"SP": SP})
    many = ensemble(site_flow(rest=1.5), 7200.0, times=t, inputs=log, seeds=[4], signals=["OP", "PV"], progress=False)
    rounded = {s: np.round(many.values[s][0] / q) * q for s, q in (("OP", 1e-3), ("PV", 1.5e-2))}
    report = diagnose(
        site_flow(), Log(t, {"SP": SP[::5], **rounded}), catalogue=[effect("compression")], progress=False
    )
    assert not report.gap

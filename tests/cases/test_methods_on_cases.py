"""Methods are compared on every case as it is simulated: no shift, no noise, no trick; each loop decided, or a reason.

Which valves stick is known from how the cases are built: those loops must be found, the others must not be accused.
"""

import re

import pytest
from stickslip.cases import find, names
from stickslip.detect import compare, diagnose
from stickslip.detect.prepare.prepared import Prepared
from stickslip.diagram import simulate

CASES = [name for name in names() if name not in ("sine", "cascaded_tanks")]  # these have no controller
STICKY = {  # by construction: the loops whose own valve sticks and makes them cycle
    **{name: {""} for name in ("ideal_high", "ideal_normal", "ideal_half_gain", "ideal_integrating")},
    **{
        name: {"LCS11", "PCS11"}
        for name in (
            "plant_1_normal", "plant_1_high", "plant_2_normal", "plant_2_high", "plant_1_high_two_jumps",
            "plant_own_map",
        )
    },
    "cascade_flow": {"direct/LC", "cascade/FC"},
}  # fmt: skip
UNSURE = {("split_range", "")}  # sticky part of the time
NO_VALVE = re.compile(r"(?<!A)SC\d+$|cascade/LC$")  # by construction: OP is a torque, or the set point of another loop
INTEGRATE = re.compile(r"LCS|LC$|level|ideal_integrating|split_range")  # analytic: vessels without outflow of their own


def loops(case):
    records = find(case).loop_records()
    return {record.name.removeprefix(case).strip(): record for record in records}


@pytest.mark.parametrize("case", CASES)
def test_every_loop_of_a_case_is_decided_or_has_a_reason(case):
    for tag, record in loops(case).items():
        loop = Prepared(record)
        found = diagnose(loop, [])
        assert record.process == ("integrating" if INTEGRATE.search(tag or case) else "self_regulating"), tag
        codes = {fact.code for fact in loop.present}
        at_rest = codes & {"manual_mode", "constant_signal"}  # what stands still may be drawn, for all one can tell
        assert at_rest or ("compressed" not in codes and not loop.op_drawn.present), tag
        if tag in STICKY.get(case, ()):
            assert found.verdict == "stiction", tag
        elif NO_VALVE.search(tag):
            assert found.verdict == "not_applicable" and "no valve in this loop" in found.reason, tag
        elif (case, tag) not in UNSURE:
            assert found.verdict != "stiction", tag
        assert found.verdict in ("stiction", "no_stiction") or len(found.reason) > 20, tag


@pytest.mark.parametrize(
    ("case", "tag", "applicable"),
    [
        ("ideal_high", "", 9), ("ideal_integrating", "", 12), ("plant_1_normal", "LCS11", 11),
        ("plant_1_high", "LCS11", 12), ("plant_1_normal", "PCS11", 18),
        ("plant_1_high", "PCS11", 19), ("cascade_flow", "direct/LC", 12),
    ],
)  # fmt: skip
def test_methods_speak_of_noise_free_limit_cycles(case, tag, applicable):
    """Of the chapter 7 level and the plant; the counts are those measured (snapshot), before: 6, 1, 5, 7, 7, 15, 4."""
    (judged,) = compare(find(case).loop(tag)).loops
    refused = {v.code for v in judged.verdicts if v.verdict == "not_applicable"}
    assert sum(v.verdict != "not_applicable" for v in judged.verdicts) >= applicable
    assert refused <= {"wrong_process_type", "too_few_cycles", "signal_missing"}
    said = [v.verdict for v in judged.verdicts]
    assert judged.combined == "stiction" and said.count("stiction") > said.count("no_stiction") == 0


def test_the_log_of_a_diagram_gives_the_loop_as_the_diagram_knows_it():
    case = find("ideal_integrating")
    record = simulate(case.build(), 500.0, every=1.0).log.loop()
    assert (record.process, record.op_span, record.mv_name) == ("integrating", (-0.5, 0.5), "MV")
    assert simulate(case.build(), 5.0, every=1.0).log.loop(process="self_regulating").process == "self_regulating"

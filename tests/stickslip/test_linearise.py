"""`stickslip linearise`: poles, loops and gains of a case by name."""

import json

import pytest


def test_document_and_pictures(call, tmp_path):
    bode, poles = tmp_path / "bode.png", tmp_path / "poles.svg"
    result = call("linearise", "ideal_high", "--plot", bode, "--poles", poles, "--json", "-")
    assert result.exit_code == 0
    answer = json.loads(result.stdout, parse_constant=lambda word: pytest.fail(word))
    assert answer["schema"] == "stickslip.linearise/1" and answer["stable"] is True
    assert answer["signals"]["PV"] == pytest.approx(0.5, abs=1e-6)
    (loop,) = answer["loops"]
    assert (loop["PV"], loop["OP"]) == ("PV", "OP")
    assert loop["crossover"] == pytest.approx(
        0.12, rel=1e-3
    )  # analytic: K_p K/T_i; the stem is a thousand times faster
    assert loop["phase_margin"] == pytest.approx(90.0, abs=0.2)
    assert answer["relative_gains"] is None  # one loop has nothing to compare with
    assert bode.read_bytes()[:4] == b"\x89PNG" and b"<svg" in poles.read_bytes()


def test_the_plant_shows_loops_and_gains(call):
    result = call("linearise", "plant_1_high", "--loop", "PCS11", "--loop", "LCS11", "--json", "-")
    answer = json.loads(result.stdout)
    assert [loop["controller"] for loop in answer["loops"]] == ["PCS11", "LCS11"]
    gains = answer["relative_gains"]
    assert sum(gains[0]) == pytest.approx(1.0) and gains[0][0] == pytest.approx(gains[1][1])  # analytic
    assert "shaft[w]" in result.stderr and "held" in result.stderr


def test_settings_reach_the_diagram(call):
    answer = json.loads(call("linearise", "ideal_high", "--set", "controller.K_p=0.8", "--json", "-").stdout)
    assert answer["loops"][0]["crossover"] == pytest.approx(0.24, rel=1e-3)  # analytic


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["linearise", "ideal_hihg"], "did you mean 'ideal_high'"),
        (["linearise", "ideal_high", "--loop", "valve"], "block 'valve' is no controller"),
        (["linearise", "ideal_high", "--set", "K_p"], "write BLOCK.PARAM=NUMBER"),
        (["linearise", "plant_1_none", "--loop", "ASC2"], "controller 'ASC2' is at a limit here"),
        (["linearise", "ideal_high", "--set", "valve.F_s=1750", "--set", "valve.F_s=2000"], "is given twice"),
        (["linearise", "plant_1_none", "--at", "nan"], "t = nan, but sources stand still at a finite time"),
        (["linearise", "plant_1_none", "--set", "F_in.value=1e5"], "on the way S1 is full"),
        (["linearise", "sine", "--plot", "bode.png"], "there is no loop to draw"),
    ],
)
def test_requests_that_make_no_sense(call, arguments, words):
    result = call(*arguments)
    assert result.exit_code == 2 and words in result.stderr and "Traceback" not in result.stderr

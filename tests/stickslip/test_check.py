"""`stickslip check`: words, one JSON document of a fixed form, exit codes."""

import json
import os

import pytest

UNFIT = [  # readable, but nothing to judge
    ("constant", "time,SP,PV,OP\n" + "".join(f"{i},5,5,50\n" for i in range(300))),
    ("PV never good", "time,SP,PV,OP\n" + "".join(f"{i},5,nan,{50 + i % 3}\n" for i in range(300))),
    ("nothing ever good", "time,SP,PV,OP\n" + "".join(f"{i},nan,nan,nan\n" for i in range(300))),
    ("PV infinite", "time,SP,PV,OP\n" + "".join(f"{i},5,inf,{50 + i % 3}\n" for i in range(300))),
    ("negative times", "time,PV,OP\n" + "".join(f"{i - 500},{4 + i % 9},{50 + i % 5}\n" for i in range(300))),
    ("byte order mark", "\ufefftime,PV,OP\n" + "".join(f"{i},5,{50 + i % 3}\n" for i in range(100))),
    ("huge times", "time,PV,OP\n" + "".join(f"{i}e300,{4 + i % 9},{50 + i % 5}\n" for i in range(300))),
    ("huge values", "time,PV,OP\n" + "".join(f"{i},{4 + i % 9}e300,{50 + i % 5}\n" for i in range(300))),
    ("tiny values", "time,PV,OP\n" + "".join(f"{i},{4 + i % 9}e-310,{50 + i % 5}\n" for i in range(300))),
]


def document(text):
    """JSON as the standard has it: no NaN, no Infinity."""

    def refuse(word):
        raise AssertionError(f"{word} is not JSON")

    return json.loads(text, parse_constant=refuse)


def assert_form(content):
    keys = [
        "schema", "loop", "verdict", "probability", "period_s", "amplitude", "causes", "amount", "detection_limit",
        "reason", "because", "action", "assumptions", "methods",
    ]  # fmt: skip
    assert list(content)[: len(keys)] == keys
    assert content["schema"] == "stickslip.check/2"
    assert content["verdict"] in ("stiction", "no_stiction", "inconclusive", "not_applicable")
    assert content["probability"] is None or 0 <= content["probability"] <= 1
    assert len(content["reason"]) > 20 and all(isinstance(line, str) for line in content["assumptions"])
    assert content["methods"]
    for method in content["methods"]:
        assert {"name", "verdict", "index", "threshold", "reason"} <= set(method)
        assert method["reason"]
        if method["verdict"] == "not_applicable":
            assert method["index"] is None


@pytest.mark.parametrize("content", [c for _, c in UNFIT], ids=[name for name, _ in UNFIT])
def test_unfit_data_is_a_verdict_not_an_error(call, tmp_path, content):
    path = tmp_path / "loop.csv"
    path.write_text(content, encoding="utf-8")
    result = call("check", path, "--json", "-")
    assert result.exit_code == 0
    answer = document(result.stdout)
    assert_form(answer)
    assert answer["verdict"] in ("not_applicable", "inconclusive")
    assert "NOT APPLICABLE" in result.stderr or "INCONCLUSIVE" in result.stderr
    assert "Warning" not in result.stderr


def test_stiction_is_exit_code_1_and_verdict_comes_first(call, exports):
    result = call("check", exports / "FIC101_pi_export.csv")
    assert result.exit_code == 1
    assert result.stdout.startswith("FIC101: STICTION\nThe valve looks sticky.")
    assert "Bad Input" in result.stdout  # what was read is said


def test_a_record_that_does_not_tell_is_exit_code_0(call, exports):
    result = call("check", next(exports.glob("TIC204*")))
    assert result.exit_code == 0
    assert result.stdout.startswith("TIC-204: INCONCLUSIVE\n")
    assert "tight tuning" in result.stdout and "control engineer" in result.stdout


def test_json_alone_on_standard_output_of_a_process(shell, exports):
    done = shell("check", exports / "FIC101_pi_export.csv", "--json", "-")
    assert done.returncode == 1
    answer = document(done.stdout.decode())
    assert_form(answer)
    assert (answer["loop"], answer["verdict"]) == ("FIC101", "stiction")
    assert answer["methods"][0]["index"] > answer["methods"][0]["threshold"]
    assert done.stderr.decode().startswith("FIC101: STICTION\n")


def test_json_file_and_report_are_what_they_say(call, exports, tmp_path):
    target, page = tmp_path / "answer.json", tmp_path / "report.html"
    target.write_text("old")
    result = call("check", exports / "LIC410_level.csv", "--json", target, "--html", page)
    assert result.exit_code == 1
    answer = document(target.read_text(encoding="utf-8"))
    assert_form(answer)
    assert answer["verdict"] == "stiction" and answer["methods"][0]["code"] == "wrong_process_type"
    assert answer["causes"]["stiction"] == answer["probability"] > 0.5
    assert answer["amount"]["S"]["low"] < answer["amount"]["S"]["value"] < answer["amount"]["S"]["high"]
    shown = page.read_text(encoding="utf-8")
    assert "STICTION" in shown and "a sticky valve" in shown and "valve maintenance" in shown
    assert sorted(path.name for path in tmp_path.iterdir()) == ["answer.json", "report.html"]


def test_words_and_json_agree(call, exports, tmp_path):
    aside, kept = call("check", exports / "FIC101_pi_export.csv", "--json", "-"), tmp_path / "x.json"
    call("check", exports / "FIC101_pi_export.csv", "--json", kept)
    assert kept.read_bytes() == aside.stdout_bytes


def test_names_from_the_file_are_not_markup(call, good, tmp_path):
    odd = tmp_path / "[red]<b>lööp — 回路.csv"
    odd.write_bytes(good.read_bytes())
    page = tmp_path / "page.html"
    result = call("check", odd, "--html", page)
    assert "[red]<b>lööp — 回路: " in result.stdout
    assert "<b>" not in page.read_text(encoding="utf-8")


def test_the_readers_options_reach_the_reader(call, tmp_path):
    path = tmp_path / "trend.csv"
    path.write_text("Zeit;FT1;FCV1\n" + "".join(f"{i},5;{4 + i % 3},5;{50 + i % 2},0\n" for i in range(100)))
    result = call("check", path, "--time", "Zeit", "--pv", "FT1", "--op", "FCV1", "--decimal", ",", "--separator", ";")
    assert result.exit_code == 0
    assert "NOT APPLICABLE" in result.stdout


@pytest.mark.skipif(not os.path.exists("/dev/stdout"), reason="no device files on this system")
def test_json_into_a_pipe(shell, good):
    done = shell("check", good, "--json", "/dev/stdout")
    assert done.returncode == 0
    assert b'"schema": "stickslip.check/2"' in done.stdout


def sticky_with_stem(tmp_path, exports, *, stem):
    """The sticky example as a table, with the stem under the valve's own tag."""
    from stickslip.logs import read_loop

    loop = read_loop(exports / "FIC101_pi_export.csv")
    held = loop.op.copy()
    for i in range(1, len(held)):  # a stem that moves once OP is 1 % away
        held[i] = held[i - 1] if abs(loop.op[i] - held[i - 1]) < 1 else loop.op[i]
    rows = zip(loop.t, loop.sp, loop.pv, loop.op, held, strict=True)
    path = tmp_path / "export.csv"
    path.write_text(
        f"time [s],FIC101.SP,FIC101.PV,FIC101.OP,{stem},TI9.PV\n"
        + "".join(f"{t},{sp},{pv},{op},{mv},20\n" for t, sp, pv, op, mv in rows)
    )
    return path


def test_a_logged_stem_is_not_asked_for_and_unused_columns_are_named(call, exports, tmp_path):
    plain = call("check", exports / "FIC101_pi_export.csv").stdout
    assert "log the stem position" in " ".join(plain.split()), "the advice is there without a stem"
    said = " ".join(call("check", sticky_with_stem(tmp_path, exports, stem="ZT101.PV")).stdout.split())
    assert "log the stem position" not in said and "The stem is logged" in said
    assert "Columns not used: 'TI9.PV' (PV of TI9)." in said


def test_time_unit_reaches_the_reader(call, tmp_path):
    path = tmp_path / "export.csv"
    path.write_text("time,PV,OP\n" + "".join(f"{250 * i},{4 + i % 3},{50 + i % 2}\n" for i in range(100)))
    assert "read as seconds, 250 s apart" in " ".join(call("check", path).stdout.split())
    assert "Time is read in milliseconds" in " ".join(call("check", path, "--time-unit", "ms").stdout.split())
    refused = call("check", path, "--time-unit", "fortnight")
    assert refused.exit_code == 2 and "'fortnight' is not known" in refused.stderr


def test_simulate_adds_what_loops_like_this_one_say(call, exports, monkeypatch):
    from functools import partial

    from stickslip import calibration

    monkeypatch.setattr(calibration, "at_record", partial(calibration.at_record, loops=120, workers=1))
    result = call("check", exports / "FIC101_pi_export.csv", "--simulate", "--json", "-")
    content = document(result.stdout)
    assert_form(content)
    simulated = content["simulation"]
    assert 60 <= simulated["loops"] <= 120 and sum(simulated["causes"].values()) == pytest.approx(1.0)
    assert simulated["amount"]["S"]["low"] < simulated["amount"]["S"]["value"] < simulated["amount"]["S"]["high"]
    plain = document(call("check", exports / "FIC101_pi_export.csv", "--no-simulate", "--json", "-").stdout)
    assert {name: content[name] for name in plain} == plain  # simulation stands beside and changes nothing
    plain = document(call("check", exports / "FIC101_pi_export.csv", "--json", "-").stdout)
    assert "simulation" not in plain and plain["verdict"] == content["verdict"]


@pytest.mark.parametrize("option, asked", [((), True), (("--no-simulate",), False)])
def test_an_unsure_record_is_simulated_by_default(call, exports, monkeypatch, option, asked):
    """The record is one whose probability a model of the test puts between the limits; what is simulated is real."""
    from dataclasses import replace
    from functools import partial

    from stickslip.calibration.by_simulation import together

    from stickslip import calibration
    from stickslip.commands import one_loop

    plain = one_loop.diagnosed
    monkeypatch.setattr(
        one_loop, "diagnosed", lambda loop: replace(plain(loop), verdict="inconclusive", probability=0.6)
    )
    monkeypatch.setattr(calibration, "at_record", partial(calibration.at_record, loops=120, workers=1))
    done = call("check", exports / "FIC101_pi_export.csv", *option, "--json", "-")
    content = document(done.stdout)
    assert ("simulation" in content) is asked and done.exit_code == 0
    if asked:
        simulated = content["simulation"]
        assert simulated["together"] == pytest.approx(together(0.6, simulated["probability"]))


@pytest.mark.parametrize(
    "verdict, p", [("stiction", 0.95), ("inconclusive", 0.1), ("inconclusive", None), ("no_stiction", 0.3)]
)
def test_a_record_that_needs_no_simulation_is_not_simulated(verdict, p):
    from types import SimpleNamespace

    from stickslip.detect import Diagnosis

    def unsure(verdict, p):
        return Diagnosis.unsure.fget(SimpleNamespace(verdict=verdict, probability=p))

    assert not unsure(verdict, p)
    assert unsure("inconclusive", 0.5) and unsure("stiction", 0.8)


def test_simulate_of_a_record_that_shows_nothing_is_not_applicable(call, tmp_path):
    (tmp_path / "flat.csv").write_text("time,SP,PV,OP\n" + "".join(f"{i},5,5,50\n" for i in range(300)))
    result = call("check", tmp_path / "flat.csv", "--simulate", "--json", "-")
    assert result.exit_code == 0 and document(result.stdout)["simulation"] is None


def test_what_the_user_says_of_pv_is_used(call, exports):
    file = exports / "FIC101_pi_export.csv"
    stated = document(call("check", file, "--measurement", "level", "--json", "-").stdout)
    plain = document(call("check", file, "--json", "-").stdout)
    by_area, by_area_plain = (next(m for m in said["methods"] if m["name"] == "area_ratio") for said in (stated, plain))
    assert (
        by_area["code"] == "wrong_process_type" and by_area_plain["code"] != "wrong_process_type"
    )  # a level integrates
    narrow = document(call("check", file, "--span", "0", "1", "--json", "-").stdout)
    assert narrow["verdict"] == "inconclusive" and "end of its span" in narrow["reason"]
    wrong = call("check", file, "--span", "5", "1")
    assert wrong.exit_code == 2 and "--span 5 1" in wrong.stderr

"""Counting verdicts on simulated loops: every loop is counted once a method, alarms come at checks."""

import json

import pytest
from stickslip.calibration import draw, simulate
from stickslip.detect import METHODS, diagnose
from stickslip.detect.rates import COMBINED, STICKY, of_counts

from benchmarks import rates, resumed
from benchmarks.rates import CHECKS, SETTING, WORDS, Counted, again, figures, measure


@pytest.fixture(scope="module")
def specs():
    return draw(4, seed=6, setting=SETTING)


@pytest.fixture(scope="module")
def counted(specs):
    return measure(specs, streamed=0)


def test_every_loop_is_counted_once_a_method(counted):
    kept = counted.kept(6, 4)
    assert set(kept["counts"]) == {COMBINED, *(method.CARD.name for method in METHODS)}
    for groups in kept["counts"].values():
        assert sum(map(sum, groups.values())) == 4 and all(len(row) == len(WORDS) for row in groups.values())
    rates = of_counts(kept)
    assert all(rate.sticky == rate.others == 2 for rate in rates.values())
    assert figures(kept)["loops"] == 4.0 and rates["play_fit"].us_per_sample > 0.0


def test_an_alarm_comes_at_a_check_and_once():
    specs = [spec for spec in draw(40, seed=2) if spec.group in STICKY and spec.samples < 900][:2]
    counted = Counted()
    for record, truth in simulate(specs):
        counted.follow(record, truth)
    assert counted.streamed == 2
    assert all(len(times) <= 2 and set(times) <= set(CHECKS) for times in counted.periods.values())


def test_the_combined_row_is_the_verdict_and_not_the_vote(specs, counted):
    said = {}
    for record, truth in simulate(specs):
        said.setdefault(truth.group, []).append(diagnose(record).verdict)
    for group, words in said.items():
        assert sorted(counted.words[COMBINED][group].elements()) == sorted(words)


def test_one_row_counted_again_is_the_row_that_was_counted(counted):
    kept = counted.kept(6, 4)
    spoiled = {**kept, "counts": {**kept["counts"], COMBINED: {}, "stem_play": {}}}
    assert again(spoiled, [COMBINED, "stem_play"])["counts"] == kept["counts"]
    with pytest.raises(ValueError, match="did you mean 'play_fit'"):
        again(kept, ["playfit"])


def test_counts_survive_the_file(counted):
    again_counted = Counted()
    again_counted.join(json.loads(json.dumps(counted.row())))
    assert again_counted.kept(6, 4) == counted.kept(6, 4)


def test_a_stopped_count_goes_on_and_streams_the_first_loops_alone(tmp_path, monkeypatch):
    """What was counted is not counted again; the loops that are streamed are those of one run."""
    specs, file, made = draw(6, seed=6), tmp_path / "parts" / "counts.jsonl", []

    def counted(part, streamed):
        made.append(streamed)
        if len(made) == stop:
            raise KeyboardInterrupt
        one = Counted(streamed=min(streamed, 1))
        for spec in part:
            one.words["play_fit"][spec.group]["stiction"] += 1
        return one

    monkeypatch.setattr(rates, "BATCH", 2)
    monkeypatch.setattr(rates, "_counted", counted)
    stop = 3
    with pytest.raises(KeyboardInterrupt):
        measure(specs, 2, file)
    assert len(file.read_text().splitlines()) == 2
    stop = 99
    found = measure(specs, 2, file)
    assert made == [2, 1, 0, 0]  # the third batch was begun twice, and the streamed loops had been the first two
    assert found.streamed == 2 and sum(sum(words.values()) for words in found.words["play_fit"].values()) == 6


def test_rows_of_another_version_are_in_another_file(tmp_path, monkeypatch):
    (tmp_path / "detect").mkdir()
    (tmp_path / "detect" / "a.py").write_text("1")
    monkeypatch.setattr(resumed, "HERE", tmp_path)
    before = resumed.code_of("detect")
    (tmp_path / "detect" / "a.py").write_text("2")
    assert resumed.code_of("detect") != before

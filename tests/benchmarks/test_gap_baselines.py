"""The baselines of the gap benchmark: how far they get is known for a gain, which is a parameter, and a dead time."""

import json
from types import SimpleNamespace

import numpy as np
from stickslip.logs import Log

from benchmarks.gap.baselines import shrinkages, without_what_is_predicted
from benchmarks.gap.generator import record
from benchmarks.gap.leaving_out import leaving_out, table
from benchmarks.gap.models import model
from benchmarks.gap.runs import Run


def reached(name, **values):
    made = record("ideal", (name,), seed=9, hours=0.6, given={name: values})
    signals = {s: v for s, v in made.signals.items() if s not in ("time", "MV")}
    return shrinkages(model("ideal"), Log(made.signals["time"], signals))


def test_other_parameters_explain_a_gain_and_not_a_dead_time():
    gain, late = reached("process_gain", factor=1.2), reached("dead_time", theta=2.0)
    assert gain["parameters_only"] > 0.95  # analytic: it is one of the parameters
    assert late["parameters_only"] < 0.8
    assert 0.0 < late["flexible_residual"] < 1.0


def test_a_flexible_residual_takes_away_what_follows_from_earlier_rows():
    rng = np.random.default_rng(0)
    t, op = np.arange(800.0), rng.normal(size=800)

    e = (np.sin(np.roll(op, 1)) * 3.0 + 0.1 * rng.normal(size=800))[:, None]
    frame = SimpleNamespace(record=SimpleNamespace(log=Log(t, {"OP": op}), played=()), skipped=100)
    left = without_what_is_predicted(frame, e)
    assert left[500:].std() < 0.4 < 1.5 < e[500:].std()


def test_what_was_left_out_is_kept_and_counted(tmp_path):
    row = {"key": Run("tuning", "ideal", ("dead_time",)).key, "severity": "gross", "visible": 1.0, "said": [],
           "probability": None}  # fmt: skip
    file = tmp_path / "rows.jsonl"
    file.write_text(json.dumps(row) + "\n")
    runs = [Run("tuning", "ideal", ("dead_time",)), Run("tuning", "ideal", ("slug",))]
    assert list(leaving_out(runs, file, 0.0)) == [row]  # made earlier; no time for the other
    assert table([row]).endswith("| gross | 0 | 1 | 0 | 0 | 1 | 0.00 to 0.79 |")

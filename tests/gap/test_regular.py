"""Logs as historians leave them: set points kept at changes, rows that are missing, rows at uneven times."""

import numpy as np
import pytest
from stickslip.cases.models import site_flow
from stickslip.gap.records.model import read
from stickslip.gap.records.record import GapError
from stickslip.gap.records.regular import with_inputs_held, with_rows_filled
from stickslip.logs import Log


def test_a_set_point_kept_at_its_changes_is_held_in_between(site_record):
    log = site_record()
    changes = np.concatenate([[True], np.diff(log["SP"]) != 0.0])
    sparse = Log(log.t, {**log.signals, "SP": np.where(changes, log["SP"], np.nan)})
    _, record = read(site_flow(rest=1.5), sparse)
    assert np.array_equal(record.log["SP"], log["SP"])  # analytic: nothing else holds it
    assert "taken as held" in record.log.notes[0]


def test_missing_rows_are_rows_of_nothing(site_record):
    log = site_record()
    kept = np.ones(len(log), dtype=bool)
    kept[200:230] = kept[500] = False
    holed = Log(log.t[kept], {s: log[s][kept] for s in log.names})
    _, record = read(site_flow(rest=1.5), holed)
    assert np.array_equal(record.log.t, log.t)
    assert np.array_equal(record.log.good("PV"), kept) and np.array_equal(record.log["PV"][kept], log["PV"][kept])
    assert np.isfinite(record.log["SP"]).all()


def test_uneven_rows_lie_on_the_scans_of_the_model():
    t = np.cumsum([0.0, 2.0, 4.0, 2.0, 6.0])
    log = with_rows_filled(Log(t, {"PV": t}), [], period=1.0)
    assert log.dt == 2.0 and np.array_equal(log["PV"][log.good("PV")], t)
    uneven = Log(t + 0.3 * np.arange(5.0) ** 2, {"PV": t})
    assert with_rows_filled(uneven, [], period=1.0) is uneven


def test_an_even_log_is_left_as_it_is():
    log = Log(np.arange(5.0), {"SP": np.arange(5.0)})
    assert with_rows_filled(with_inputs_held(log, ["SP"]), ["SP"]) is log


def test_an_input_without_any_value_is_refused(site_record):
    log = site_record()
    with pytest.raises(GapError, match="'SP' has no good value"):
        read(site_flow(), Log(log.t, {**log.signals, "SP": np.full(len(log), np.nan)}))

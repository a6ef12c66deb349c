"""A log as a data frame, and as a notebook shows it."""

import sys

import numpy as np
import pytest
from stickslip.logs import Log
from stickslip.logs.notebook import ROWS

LOG = Log(t=[0.0, 1.0, 2.5], signals={"OP": [50, 51, 52], "PV": [4, float("nan"), 5]}, units={"OP": "%"})


def test_polars():
    frame = LOG.to_polars()
    assert frame.columns == ["time", "OP", "PV"]
    assert frame["time"].to_list() == [0.0, 1.0, 2.5] and frame["OP"].to_list() == [50.0, 51.0, 52.0]


def test_pandas():
    pytest.importorskip("pandas")
    frame = LOG.to_pandas()
    assert list(frame.columns) == ["OP", "PV"] and frame.index.name == "time" and frame.attrs["units"] == {"OP": "%"}
    np.testing.assert_array_equal(frame.index, LOG.t)
    np.testing.assert_array_equal(frame["PV"], LOG["PV"])


def test_pandas_says_what_to_install_if_it_is_not_there(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"pip install pandas, or use to_polars\(\)"):
        LOG.to_pandas()


def test_a_notebook_shows_a_table_with_units():
    shown = LOG._repr_html_()
    assert shown.count("<tr>") == 4 and "<th>OP [%]</th>" in shown and "<td>2.5</td>" in shown and "nan" in shown


def test_a_long_log_is_shown_by_its_ends_and_names_are_escaped():
    log = Log(t=np.arange(5000.0), signals={f"<b>{i}": np.zeros(5000) for i in range(40)})
    shown = log._repr_html_()
    assert shown.count("<tr>") == 2 * ROWS + 2 and "4999" in shown and len(shown) < 10_000
    assert "&lt;b&gt;0" in shown and "<b>" not in shown and "28 more signals" in shown

"""The picture of remedies: each has a line of its own, named at its side, the calmest on top."""

from datetime import datetime
from types import SimpleNamespace

import numpy as np
from stickslip.remedy.figures import plot_advice


def tried(name, sd, travel):
    outcome = SimpleNamespace(pv=np.sin(np.arange(600) / 9.0), pv_rms=sd * np.linspace(0.9, 1.1, 11), travel=travel)
    return SimpleNamespace(name=name, outcome=outcome)


def test_names_stand_in_the_order_of_their_points_without_a_line_through_them():
    class Found(SimpleNamespace):
        def __getitem__(self, name):
            return next(one for one in self.tried if one.name == name)

    t = np.arange(600.0)
    day = SimpleNamespace(t=t, pv=np.sin(t / 9.0), op=np.cos(t / 9.0), sp=None)
    fit = SimpleNamespace(days=(day,), pv_unit="bar", op_unit="% of OP", start=datetime(2025, 3, 11, 6))
    none, half, repaired = (
        tried(name, sd, np.full(11, sd)) for name, sd in (("none", 3), ("half", 2), ("repaired", 1))
    )
    found = Found(fit=fit, none=none, tried=(half, repaired), until_shutdown="half", at_shutdown="repaired")
    *left, spread, travel = plot_advice(found).axes
    assert [label.get_text() for label in spread.get_yticklabels()] == ["repaired", "half", "none"]
    assert not spread.texts and not travel.texts, "no name is led to its point by a line"
    assert spread.get_ylim()[0] > spread.get_ylim()[1], "the calmest on top"
    assert left[-1].get_xlabel().startswith("clock time, from 2025-03-11"), "as on every other page"
    assert len(left) == 3 and sum(tick > 0.0 for tick in travel.get_xticks()) >= 2


def test_a_fit_counts_time_by_the_clock():
    from dataclasses import replace

    from stickslip.remedy import fit
    from stickslip.remedy.example import sticky

    record = sticky()
    found = fit(replace(record, log=replace(record.log, start=datetime(2025, 3, 11, 6))))
    assert found.plot().axes[-1].get_xlabel().startswith("clock time, from 2025-03-11")

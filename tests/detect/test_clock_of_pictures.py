"""The pictures that a page shows count time by the clock where the file has one, as its trend does."""

from dataclasses import replace
from datetime import datetime

import pytest
from stickslip.detect.figures.deciding import draw_deciding
from stickslip.detect.methods import dead_travel
from stickslip.logs.picture import Picture

START = datetime(2025, 3, 11, 6)


@pytest.mark.parametrize("start", [START, None])
def test_dead_travel(sticky, start):
    record = sticky(noise=0.1)
    verdict = dead_travel.detect(replace(record, log=replace(record.log, start=start)))
    assert verdict.applicable
    verdict.draw(verdict, figure := Picture())
    name = figure.axes[0].get_xlabel()
    assert name.startswith("clock time, from 2025-03-11") if start else name.startswith("time [")


def test_a_stem_that_stands(sticky):
    from types import SimpleNamespace

    record = sticky(noise=0.1)
    record = replace(record, log=replace(record.log, start=START))
    answer = SimpleNamespace(record=record, period=None, picture="slips")
    draw_deciding(answer, figure := Picture())
    assert figure.axes[-1].get_xlabel().startswith("clock time, from 2025-03-11")

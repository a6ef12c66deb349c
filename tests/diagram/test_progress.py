"""What is told while many runs are made."""

import io
import sys

import pytest
from stickslip.diagram.progress import reporting


def test_the_callers_function_is_told():
    heard = []
    with reporting(lambda done, total: heard.append((done, total)), 3, "runs") as tell:
        tell(1, 3)
    assert heard == [(1, 3)]


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(
    ("progress", "stderr", "drawn"),
    [(True, Terminal, True), (False, Terminal, False), (None, Terminal, True), (None, io.StringIO, False)],
)
def test_a_bar_is_drawn_where_it_is_asked_for_or_somebody_looks(monkeypatch, progress, stderr, drawn):
    stream = stderr()
    monkeypatch.setattr(sys, "stderr", stream)
    with reporting(progress, 4, "variants") as tell:
        tell(4, 4)
    assert ("variants" in stream.getvalue()) == drawn


def test_a_bar_says_what_is_worked_at_now(monkeypatch):
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    with reporting(True, 4, "effects") as tell:
        tell(1, 4, "valve_gain at valve")
    assert "valve_gain at valve" in stream.getvalue()


@pytest.mark.parametrize("even", [True, False])
def test_a_bar_foretells_the_rest_only_of_even_work(monkeypatch, even):
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    with reporting(True, 4, "effects", even) as tell:
        tell(2, 4)
    assert ("to go" in stream.getvalue()) == even

"""Span of OP and kind of process: what is assumed and what is said."""

import numpy as np
import pytest
from stickslip.logs import read_loop
from stickslip.logs.spans import guess_op_span
from stickslip.logs.tags import measurement_of


@pytest.mark.parametrize(
    ("values", "unit", "span"),
    [
        ((36.0, 37.0), "", (0, 100)),
        ((-4.9, 104.9), "", (0, 100)),
        ((0.0, 100.0), "", (0, 100)),
        ((0.36, 0.37), "", (0, 1)),
        ((0.0, 1.0), "", (0, 1)),
        ((0.0, 1.01), "", (0, 100)),
        ((-6.0, 50.0), "", None),
        ((36.0, 106.0), "", None),
        ((36.0, 520.0), "", None),
        ((-1.0, 1.1), "", None),  # spread about zero: standardised
        ((4.0, 12.0), "mA", (4, 20)),
        ((3.0, 9.0), "psi", (3, 15)),
        ((36.0, 37.0), "%", (0, 100)),
        ((36.0, 400.0), "%", None),
        ((36.0, 37.0), "rpm", None),
        ((), "", None),
    ],
)
def test_span_of_op(values, unit, span):
    assert guess_op_span(np.array(values, dtype=float), unit)[0] == span


def test_fraction_in_percent_of_span(write):
    loop = read_loop(write("time,PV,OP\n0,1,0.25\n1,2,0.5\n"))
    assert loop.op_percent.tolist() == [25.0, 50.0]
    assert any("fraction" in note for note in loop.notes)


def test_unknown_span_gives_no_percent(write):
    loop = read_loop(write("time,PV,OP\n0,1,250\n1,2,500\n"))
    assert loop.op_percent is None
    assert "OP has no known span (values 250 to 500): amounts in % are not given." in loop.notes


def test_told_span_wins(write):
    loop = read_loop(write("time,PV,OP\n0,1,250\n1,2,500\n"), op_span=(0, 1000))
    assert loop.op_percent.tolist() == [25.0, 50.0]
    assert not any("span" in note for note in loop.notes)


@pytest.mark.parametrize(
    ("file", "measurement", "process"),
    [
        ("LIC106.csv", "level", "integrating"),
        ("12-FIC-211 trend.csv", "flow", "self_regulating"),
        ("PIC_3.csv", "pressure", "self_regulating"),
        ("TC153.csv", "temperature", "self_regulating"),
        ("AIC9.csv", "analyser", "self_regulating"),
        ("CHEM1.csv", "", "unknown"),
        ("trend.csv", "", "unknown"),
    ],
)
def test_tag_tells_the_process(write, file, measurement, process):
    loop = read_loop(write("time,PV,OP\n0,1,50\n1,2,51\n", file))
    assert (loop.measurement, loop.process) == (measurement, process)
    assert sum("process is taken as" in note for note in loop.notes) == 1


def test_told_process_wins(write):
    loop = read_loop(write("time,PV,OP\n0,1,50\n1,2,51\n", "LIC106.csv"), process="self_regulating")
    assert loop.process == "self_regulating"
    assert not any("process" in note for note in loop.notes)


@pytest.mark.parametrize("text", ["PAP2", "PID1", "TAG1", "LOOP1", "AI101", "LIST5", "TIME0", "FILE2024", "first_half"])
def test_words_that_are_no_tags(text):
    assert measurement_of(text) == ""

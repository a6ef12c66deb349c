"""The systems of docs/examples.md give the numbers of python-control and PathSim."""

import pytest

from benchmarks.examples import QUICK, compare, last_run, peers, sections, short


def test_every_example_but_the_last_has_a_peer():
    headings = [heading for heading, code in sections().items() if last_run(code)]
    known = {heading for examples in peers().values() for heading in examples}
    if "pathsim" in peers():
        assert set(headings[:-1]) <= known and len(headings) >= 10
    assert known <= set(headings), "a peer is named after no heading"


def test_numbers_agree():
    figures = compare(quick=True, repeats=1)
    differences = {name: value for name, value in figures.items() if name.endswith("_difference")}
    assert len(differences) >= len(QUICK) - 1  # PathSim may not be installed
    for name, value in differences.items():
        assert value < 1e-5, name
    assert all(f"{short(heading)}_ms" in figures for heading in QUICK)


def test_the_statement_that_is_timed_is_the_run():
    assert last_run("a = 1\nrun = simulate(loop, 3.0)\nprint(run)") == "run = simulate(loop, 3.0)"
    assert last_run("log = simulate(loop, 3.0).log") is None


@pytest.mark.parametrize("heading", [h for h, code in sections().items() if last_run(code)])
def test_the_table_of_the_page_lists_it(heading):
    from benchmarks.examples import PAGE

    table = PAGE.read_text().rpartition("## Measured")[2]
    assert f"| {heading} |" in table

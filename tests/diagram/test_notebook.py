"""What is shown of diagrams, blocks, runs and ensembles: short texts, and pictures in a notebook."""

import base64
import re

import numpy as np
import pytest
from stickslip.blocks import PI, Recorded, StateSpace
from stickslip.diagram import ensemble, simulate, wire
from stickslip.engine.status import Status
from stickslip.plant import production_plant
from stickslip.plant.loops import self_regulating_loop

SCREEN = 24 * 80
PNG = b"\x89PNG"


@pytest.fixture(scope="module")
def run():
    return simulate(self_regulating_loop(), 100.0, every=1.0)


def pictures(html):
    return [base64.b64decode(text) for text in re.findall(r'src="data:image/png;base64,([^"]+)"', html)]


def test_a_repr_is_at_most_a_screen(run):
    plant = production_plant()
    tables = [Recorded("PV", np.arange(9999.0), np.zeros(9999)), StateSpace(-np.eye(40), np.eye(40), np.eye(40))]
    runs = [simulate(plant, 1.0, every=1.0), ensemble(self_regulating_loop(), 1.0, seeds=[1, 2])]
    big = [plant, *plant.blocks, *tables, *runs]
    for shown in big:
        assert 0 < len(repr(shown)) <= SCREEN, type(shown)


def test_a_repr_says_what_matters(run):
    loop = self_regulating_loop()
    assert repr(loop) == (
        "<Diagram 'self_regulating_loop' of 4 blocks: Step 'SP', PI 'controller', StickSlip 'valve', "
        "FirstOrder 'process'; signals SP, OP, MV, PV>"
    )
    assert "open inputs SP" in repr(loop.without("SP"))
    assert repr(PI(0.4, 10.0)).startswith("<PI 'controller': SP, PV -> OP; K_p = 0.4, T_i = 10, ")
    assert f"{len(run.events)} events" in repr(run) and "101 samples" in repr(run)
    failed = simulate(loop, 100.0, max_steps=3)
    assert "TOO_MANY_STEPS" in repr(failed) and failed.hint in repr(failed)


def test_a_status_prints_its_name(run):
    assert (str(run.status), f"{run.status}", f"{Status.CHATTERING:>12}") == ("OK", "OK", "  CHATTERING")
    assert run.status == 0 and int(Status.CHATTERING) == 5


def test_a_notebook_shows_a_run_and_a_diagram(run):
    for shown, count in ((run, 1), (self_regulating_loop(), 1)):
        found = pictures(shown._repr_html_())
        assert len(found) == count and all(picture.startswith(PNG) for picture in found)
    html = run._repr_html_()
    assert "&lt;Run of" in html and "<table>" in html and "<th>PV</th>" in html
    assert PI(0.4, 10.0)._repr_html_() is None, "a block is shown by its repr, not by python-control"


def test_a_run_goes_to_data_frames(run):
    assert run.to_polars().columns == ["time", *run.log.names]
    np.testing.assert_array_equal(run.to_polars()["PV"].to_numpy(), run.log["PV"])
    pytest.importorskip("pandas")
    np.testing.assert_array_equal(run.to_pandas()["PV"], run.log["PV"])


def test_a_diagram_without_signals_worth_a_picture_is_still_shown():
    assert pictures(wire([PI(0.4, 10.0)], inputs=["SP", "PV"])._repr_html_())


def test_a_plot_appears_in_a_notebook_without_a_magic_command(run):
    from stickslip.logs import Log

    log = Log(t=[0.0, 1.0], signals={"PV": [1.0, 2.0]})
    for figure in (run.plot(), self_regulating_loop().plot(), log.plot()):
        assert figure._repr_png_().startswith(PNG)

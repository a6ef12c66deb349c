"""What results show of themselves: one line each, and a picture in a notebook."""

import base64
import re

import pytest
from stickslip.cases.stories import EXPORTS
from stickslip.detect import area_ratio, compare, diagnose, survey
from stickslip.diagram import simulate
from stickslip.diagram.ensembles import ensemble
from stickslip.diagram.linear import linearise
from stickslip.logs import read_loop
from stickslip.plant.loops import self_regulating_loop

PNG = b"\x89PNG"


@pytest.fixture(scope="module")
def results():
    record = read_loop(EXPORTS / "FIC101_pi_export.csv")
    linear = linearise(self_regulating_loop().in_mode("ideal"))
    return [
        record,
        diagnose(record, [area_ratio]),
        area_ratio.detect(record),
        compare(record, [area_ratio]),
        survey(simulate(self_regulating_loop(), 600.0, every=1.0).log),
        linear,
        linear.loop("controller"),
        ensemble(self_regulating_loop(), 10.0, seeds=[1, 2]),
    ]


def test_a_repr_is_one_line(results):
    for shown in results:
        assert "\n" not in repr(shown) and len(repr(shown)) < 300, type(shown)
        assert repr(shown).startswith(f"<{type(shown).__name__}: "), type(shown)


def test_a_notebook_shows_the_line_and_the_picture(results):
    for shown in results:
        pictures = re.findall(r'src="data:image/png;base64,([^"]+)"', shown._repr_html_())
        assert len(pictures) >= 1 and all(base64.b64decode(one).startswith(PNG) for one in pictures), type(shown)

"""A probability is never said to be 0 % or 100 %, and a report on a plainly sticky valve says so."""

import re
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st
from stickslip.cases.stories import EXPORTS
from stickslip.detect import diagnose
from stickslip.logs import read_loop
from stickslip.logs.chances import chance


@given(st.floats(0.0, 1.0))
def test_whole_percent_and_never_certain(p):
    said = chance(p)
    number = float(re.search(r"\d+", said)[0])
    assert 1 <= number <= 99  # analytic: what lies strictly between 0 and 100
    assert abs(number - 100.0 * p) <= (0.5 if said[0].isdigit() else 1.0) + 1e-9


def test_the_answer_and_the_page_do_not_claim_certainty():
    from stickslip.commands.loop_page import loop_page

    diagnosis = diagnose(read_loop(EXPORTS / "FIC101_pi_export.csv"))
    # snapshot: as clear as any; 140 of 140 fresh crossed loops above 99 % that had no deadband stick
    assert diagnosis.probability >= 0.975
    assert "Probability of stiction over 99 %" in diagnosis.reason
    certain = replace(diagnosis, probability=0.9999)
    page = loop_page(certain)
    assert "over 99 %" in page and not re.search(r"stiction (<[^>]*>)*100 ?%", page)

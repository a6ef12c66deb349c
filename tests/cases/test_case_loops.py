"""The loops of a case: one by its name, several by their controllers."""

import pytest
from stickslip.cases import find


def test_one_loop_has_the_name_of_its_case():
    (record,) = find("ideal_high").loop_records()
    assert record.name == find("ideal_high").loop().name == "ideal_high"


def test_all_loops_of_the_plant():
    records = find("plant_1_high").loop_records()
    assert {record.name for record in records} >= {"plant_1_high PCS11", "plant_1_high LCS11"}
    pressure = find("plant_1_high").loop("PCS11")
    assert (pressure.pv_name, pressure.op_name, pressure.mv_name) == ("p_1", "OP_VPCS1", "MV_VPCS1")
    assert pressure.op_span == (0.0, 1.0) and pressure.measurement == "pressure"


@pytest.mark.parametrize("tag, piece", [("", "has 8 loops; name one of LCS11"), ("PCS99", "has no loop 'PCS99'")])
def test_a_loop_that_is_not_there(tag, piece):
    with pytest.raises(ValueError, match=piece):
        find("plant_1_high").loop(tag)


def test_a_case_without_a_controller():
    with pytest.raises(ValueError, match="case 'sine' has no controller"):
        find("sine").loop_records()

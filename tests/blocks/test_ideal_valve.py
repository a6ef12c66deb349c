"""The valve without friction."""

import numpy as np
from stickslip.blocks.ideal_valve import IdealValve
from stickslip.blocks.periodic import Sine
from stickslip.blocks.stick_slip import StickSlip
from stickslip.diagram import drive


def test_passes_op_and_takes_a_place():
    valve = IdealValve.instead_of(StickSlip(name="VPCS1", inputs="OP1", outputs="x1", units={"OP": "1"}))
    assert (valve.name, list(valve.input_labels), list(valve.output_labels)) == ("VPCS1", ["OP1"], ["x1"])
    assert valve.units["OP"] == "1"
    run = drive(valve, 10.0, OP1=Sine("OP1", 0.3, 7.0, mean=0.5))
    np.testing.assert_array_equal(run.log["x1"], run.log["OP1"])  # analytic

"""The continuous twin of a sampled block is made once, and two diagrams do not feel that they share it."""

import pickle

import control as ct
import numpy as np
from stickslip.blocks import FirstOrder, HeValve, SampledPI, SampledSensor
from stickslip.diagram import wire


def loop():
    return wire([SampledPI(2.0, 10.0, dt=0.5), FirstOrder(1.5, 10.0, inputs="OP")], inputs=["SP"], outputs=["PV"])


def test_a_changed_diagram_shares_the_twins_of_what_has_not_changed():
    first = loop()
    other = first.with_params({"process.K": 2.0})
    assert other.syslist[0] is first.syslist[0] and first.syslist[0] is not first.blocks[0]
    slower = first.with_params({"controller.T_i": 20.0})
    assert slower.syslist[0] is not first.syslist[0] and slower.syslist[0].params["T_i"] == 20.0


def test_parameters_that_python_control_gives_one_diagram_are_not_those_of_another():
    first = loop()
    other = first.with_params({"process.K": 2.0})
    t = np.linspace(0.0, 30.0, 61)
    alone = ct.input_output_response(other, t, np.ones(61)).outputs
    ct.input_output_response(first, t, np.ones(61), params={"controller.K_p": 5.0})
    assert np.array_equal(ct.input_output_response(other, t, np.ones(61)).outputs, alone)


def test_a_twin_does_not_travel_with_its_block():
    sensor = SampledSensor(1.0)
    size = len(pickle.dumps(sensor))
    assert sensor.seen() is sensor.seen()
    assert len(pickle.dumps(sensor)) == size


def test_samples_that_one_diagram_has_taken_are_not_those_of_another():
    valve = HeValve(4.0, 2.0, 1.0, high=100.0, start=50.0)
    first, other = valve.seen(), valve.seen()
    assert first.samples_kept
    none = np.zeros(0)
    for t, view, op in ((0.0, first, 50.0), (0.0, other, 50.0), (1.5, first, 90.0), (3.0, other, 51.0)):
        stem = float(view.out_now(t, none, np.array([op]))[0])
    assert stem == 50.0  # 1 % is less than it sticks by, unless it has been at 90 %

"""Names of ports, parameters and states never hide each other."""

import pytest
from stickslip.blocks import FirstOrder, Plenum
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import BlockError, Port, nearest


def _out(t, x, d, u, p, y):
    y[0] = u[0]


class Twice(Block):
    """A block whose port names, states and memories a test chooses."""

    ports_out = (Port("y"),)
    kernels = Kernels(out=_out)

    def __init__(self, inputs=(), outputs=ports_out, **given):
        self.ports_in, self.ports_out = inputs, outputs
        super().__init__(name="twice", params={}, **given)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Twice([Port("u"), Port("u")]), "two ports called 'u'"),
        (lambda: Twice([Port("y", "Pa")], [Port("y", "bar")]), "two ports called 'y'"),
        (lambda: Plenum(1.0, start=1e5, inflows=["p"], outflows=["m"]), "two ports called 'p'"),
        (lambda: Twice(states={"z": 0.0}, memory={"z": 0.0}), "a state and a memory called 'z'"),
        (lambda: Twice(start_output=[0.0, 1.0]), r"start_output = \[0.0, 1.0\], but the block has 1 outputs"),
        (lambda: Twice().holding([0.0, 1.0]), "one value per output"),
    ],
)
def test_names_that_hide_each_other_are_refused(make, words):
    with pytest.raises(BlockError, match=words):
        make()


def test_units_are_stated_in_a_copy():
    process = FirstOrder(K=1.0, tau=1.0, units={"PV": "bar"})
    both = process.with_units({"MV": "%"})
    assert both.units == {"MV": "%", "PV": "bar"} and process.units["MV"] == ""
    with pytest.raises(BlockError, match="no port 'PVV'; did you mean 'PV'"):
        process.with_units({"PVV": "bar"})


@pytest.mark.parametrize(
    ("wrong", "known", "right"),
    [
        ("PV", ["SP", "OP", "MV", "PW"], "PW"),
        ("PW", ["SP", "OP", "MV", "PV"], "PV"),
        ("Kp", ["T_i", "K_p", "K"], "K_p"),
        ("tua", ["K", "theta", "tau"], "tau"),
    ],
)
def test_the_nearest_name_takes_the_fewest_edits_and_then_has_the_same_first_letter(wrong, known, right):
    assert nearest(wrong, known).startswith(f"did you mean '{right}'?")

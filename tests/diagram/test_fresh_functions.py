"""A user's function is taken as it is when a run begins, whatever it reaches and wherever it was compiled before.

Every law is a lag, dy/dt = k u - y, which rests at the gain k times the input: an analytic number.
"""

import control as ct
import numpy as np
import pytest
from stickslip.blocks import Equations
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.diagram import drive, ensemble, simulate, wire
from stickslip.engine.call import address

K = 1.0
GAINS = np.array([1.0])
NESTED = (np.array([1.0]), 0.0)


class Settings:
    """A class whose attribute is read."""

    k = 1.0


def helper(u):
    return K * u


def outer(u):
    return helper(u)


def replaced(u):
    return u


def by_global(y, u):
    return K * u - y


def by_helper(y, u):
    return outer(u) - y


def by_replaced_helper(y, u):
    return replaced(u) - y


def by_array(y, u):
    return GAINS[0] * u - y


def by_nested_array(y, u):
    return NESTED[0][0] * u - y


def by_attribute(y, u):
    return Settings.k * u - y


def by_default(y, u):
    return with_default(u) - y


def with_default(u, k=1.0):
    return k * u


def in_python(y, u):
    return sum(k for k in [K]) * u - y  # the compiler knows no generators


def around():
    """Return a function, and one that changes what it reaches from around it."""
    k, gains = 1.0, np.array([1.0])

    def law(y, u):
        return k * gains[0] * u - y

    def change(value, in_place):
        nonlocal k
        if in_place:
            gains[0] = value
        else:
            k = value

    return law, change


def changed_global(value, monkeypatch):
    monkeypatch.setitem(globals(), "K", value)


def changed_array(value, monkeypatch):
    GAINS[0] = NESTED[0][0] = value


def changed_helper(value, monkeypatch):
    made = {1.0: lambda u: 1.0 * u, 2.0: lambda u: 2.0 * u, 3.0: lambda u: 3.0 * u}
    monkeypatch.setitem(globals(), "replaced", made[value])


LAWS = {
    "a global": (by_global, changed_global),
    "a global of a helper of a helper": (by_helper, changed_global),
    "a redefined helper": (by_replaced_helper, changed_helper),
    "an array": (by_array, changed_array),
    "an array in a tuple": (by_nested_array, changed_array),
    "an attribute": (by_attribute, lambda value, monkeypatch: monkeypatch.setattr(Settings, "k", value)),
    "a default": (by_default, lambda value, monkeypatch: monkeypatch.setattr(with_default, "__defaults__", (value,))),
    "in Python": (in_python, changed_global),
}
ORDER = (1.0, 2.0, 3.0, 1.0)


def lag(law):
    return Equations("lag", der=law, states={"y": 0.0}, inputs="u")


def system(law):
    return ct.nlsys(
        lambda t, x, u, params: law(x[0], u[0]), None, inputs=["u"], outputs=["y"], states=["y"], name="lag"
    )


def rests(what):
    diagram = what if hasattr(what, "blocks") else wire([what], inputs=["u"])
    return simulate(diagram, 30.0, every=30.0, rtol=1e-9, inputs={"u": 1.0}).log["y"][-1]


@pytest.mark.parametrize("what", LAWS)
def test_what_a_function_reaches_is_taken_as_it_is_now(what, monkeypatch):
    law, change = LAWS[what]
    change(1.0, monkeypatch)
    block, diagram = lag(law), wire([lag(law)], inputs=["u"])
    theirs, again = wire([system(law)], inputs=["u"]), []
    for k in ORDER:
        change(k, monkeypatch)
        again.append([rests(block), rests(diagram), rests(lag(law)), rests(theirs), rests(system(law))])
    change(1.0, monkeypatch)
    np.testing.assert_allclose(again, np.repeat(ORDER, 5).reshape(4, 5), atol=1e-6)  # analytic


@pytest.mark.parametrize("in_place", [False, True])
def test_what_stands_around_a_function_is_taken_as_it_is_now(in_place):
    law, change = around()
    diagram, found = wire([lag(law)], inputs=["u"]), []
    for k in ORDER:
        change(k, in_place)
        found.append(rests(diagram))
    np.testing.assert_allclose(found, ORDER, atol=1e-6)  # analytic


def test_blocks_made_in_a_loop_see_what_the_loop_has_left(monkeypatch):
    made = []
    for k in (1.0, 2.0, 3.0):
        monkeypatch.setitem(globals(), "K", k)
        made.append(lag(lambda y, u: K * u - y))
        assert rests(made[-1]) == pytest.approx(k, abs=1e-6)  # analytic
    found = [rests(block) for block in made]
    np.testing.assert_allclose(found, [3.0, 3.0, 3.0], atol=1e-6)  # as Python has it: they share one global


def test_a_system_with_parameters_looks_its_globals_up_at_each_run(monkeypatch):
    theirs = ct.nlsys(
        lambda t, x, u, params: K * u - params["a"] * x, None, inputs=["u"], outputs=["y"], states=["y"],
        params={"a": 2.0}, name="lag",
    )  # fmt: skip
    diagram = wire([theirs], inputs=["u"])
    for k in ORDER:
        monkeypatch.setitem(globals(), "K", k)
        run = simulate(diagram, 30.0, every=30.0, inputs={"u": 1.0})
        assert run.log["y"][-1] == pytest.approx(k / 2.0, abs=1e-5)  # analytic: k / a
        assert run.in_python == ()


def test_blocks_of_a_class_and_ensembles_follow_too(monkeypatch):
    law = {"ports_in": (Port("u"),), "ports_out": (Port("y"),), "kernels": Kernels(der=by_global)}
    block = type("Lag", (Block,), law)(name="lag", params={}, states={"y": 0.0})
    diagram = wire([block], inputs=["u"])
    for k in ORDER:
        monkeypatch.setitem(globals(), "K", k)
        assert rests(diagram) == pytest.approx(k, abs=1e-6)  # analytic
        many = ensemble(diagram, 30.0, inputs={"u": 1.0}, start={"lag.y": [0.0, 1.0]}, every=30.0)
        assert many.values["y"][:, -1] == pytest.approx([k, k], abs=1e-5)  # analytic


def test_what_is_the_same_again_is_not_compiled_again(monkeypatch):
    block = lag(by_helper)
    places = []
    for k in ORDER:
        monkeypatch.setitem(globals(), "K", k)
        places.append(address(block.kernels.der))
    assert places[0] == places[3] and len(set(places)) == 3
    assert drive(block, 1.0, u=1.0).ok

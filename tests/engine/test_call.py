"""Compiled kernels follow every source they reach, and none that could go back into Python is accepted."""

import os
import re
import subprocess
import sys
import textwrap
from functools import partial
from pathlib import Path

import pytest
from stickslip.engine.call import KernelError, address
from stickslip.engine.reach import Reached

ROOT = Path(__file__).resolve().parents[2]

FILES = {
    "far/numbers.py": "RATE = 1.0\nOTHER = 1.0\nTABLE = (1.0, 1.0)\nclass Plant:\n    rate = 1.0\n",
    "far/helpers.py": """
        from far.numbers import RATE
        def rate(x):
            return RATE * x
        def inner(x):
            return x
    """,
    "near/decay.py": """
        from stickslip.blocks.block import Block, Kernels
        from stickslip.blocks.ports import Port
        from far import numbers
        from far.helpers import inner, rate
        from far.numbers import RATE, TABLE
        from stickslip.diagram import simulate, wire

        def scaled(x, by=1.0):
            return x * by

        def _y(t, x, d, u, p, y):
            y[0] = x[0]

        def _constant(t, x, d, u, p, dx):
            dx[0] = -RATE * x[0]

        def _attribute(t, x, d, u, p, dx):
            dx[0] = -numbers.OTHER * x[0]

        def _item(t, x, d, u, p, dx):
            dx[0] = -TABLE[1] * x[0]

        def _constant_of_a_helper(t, x, d, u, p, dx):
            dx[0] = -rate(x[0])

        def _helper(t, x, d, u, p, dx):
            dx[0] = -inner(x[0])

        def _default(t, x, d, u, p, dx):
            dx[0] = -scaled(x[0])

        def main():
            for der in (_constant, _attribute, _item, _constant_of_a_helper, _helper, _default):
                law = {"ports_out": (Port("y"),), "kernels": Kernels(out=_y, der=der, feeds=False)}
                block = type("Decay", (Block,), law)(name="decay", params={}, states={"y": 1.0})
                print(round(float(simulate(wire([block], outputs=["y"]), 1.0, rtol=1e-9).log["y"][-1]), 6))
    """,
}
CHANGES = [  # file, what stands there at first, what stands there then: every rate of decay is doubled
    ("far/numbers.py", "= 1.0", "= 2.0"),
    ("far/numbers.py", "(1.0, 1.0)", "(1.0, 2.0)"),
    ("far/helpers.py", "return x", "return 2 * x"),
    ("near/decay.py", "by=1.0", "by=2.0"),
]
ONE, TWO = 6 * ["0.367879"], 6 * ["0.135335"]  # analytic: exp(-1), exp(-2)


def decays(folder):
    """Return what a fresh process makes of the files now."""
    environment = os.environ | {"PYTHONPATH": f"{ROOT}{os.pathsep}{folder}", "PYTHONDONTWRITEBYTECODE": "1"}
    code = "from near.decay import main; main()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_a_changed_source_changes_the_result_in_the_next_process(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(textwrap.dedent(text))
    assert decays(tmp_path) == ONE
    for name, old, new in CHANGES:
        text = (tmp_path / name).read_text()
        assert old in text
        (tmp_path / name).write_text(text.replace(old, new))
    assert decays(tmp_path) == TWO


def _helper(x):
    return FACTOR * x


FACTOR = 2.0


def _plain(t, x, d, u, p, y):
    y[0] = _helper(u[0])


def test_a_fingerprint_follows_constants_and_helpers_and_nothing_else(monkeypatch):
    before = Reached(_plain).fingerprint
    monkeypatch.setitem(globals(), "ONE", "not reached")
    assert Reached(_plain).fingerprint == before
    monkeypatch.setitem(globals(), "FACTOR", 3.0)
    changed = Reached(_plain).fingerprint
    assert changed != before
    monkeypatch.setitem(globals(), "_helper", lambda x: x)
    assert Reached(_plain).fingerprint not in (before, changed)


def test_a_second_process_compiles_nothing(tmp_path):
    (tmp_path / "law.py").write_text("def rate(x):\n    return -x\n")
    code = (
        "from law import rate; from stickslip.blocks import Equations, FirstOrder; from stickslip.engine import call;"
        "der = [b.kernels.der for b in (FirstOrder(1.0, 1.0), Equations('e', der=rate, states={'x': 1.0}))];"
        "print(*[call.address(one) and call._known[one].made.cache_hits for one in der])"
    )
    run = partial(subprocess.run, [sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    runs = [run(env=os.environ | {"PYTHONPATH": str(tmp_path)}) for _ in range(2)]
    assert runs[1].stdout == "1 1\n", runs[1].stderr


def _raises(t, x, d, u, p, y):
    if u[0] > 1.0:
        raise ValueError("too much")
    y[0] = 1.0


def _prints(t, x, d, u, p, y):
    print(u[0])
    y[0] = 1.0


def _picks(t, x, d, u, p, y):
    y[0] = (1.0, 2.0, 3.0)[int(u[0])]


def _fails_in_a_helper(t, x, d, u, p, y):
    y[0] = _strict(u[0])


def _strict(x):
    if x < 0.0:
        raise ValueError("negative")
    return x


@pytest.mark.parametrize("kernel", [_raises, _prints, _picks, _fails_in_a_helper])
def test_a_kernel_that_could_go_back_into_python_is_refused(kernel):
    words = f"kernel '{kernel.__name__}' .*test_call.py.* could raise an error or print"
    for _ in range(2):  # the second time too: nothing refused is kept
        with pytest.raises(KernelError, match=words):
            address(kernel)


def _text(t, x, d, u, p, y):
    y[0] = "high"


def _unknown(t, x, d, u, p, y):
    y[0] = nowhere  # noqa: F821


def _too_few(t, x, d, u):
    pass


@pytest.mark.parametrize(("kernel", "words"), [(_text, "high"), (_unknown, "nowhere"), (_too_few, "6|arguments")])
def test_a_kernel_that_cannot_be_compiled_says_why_in_one_line(kernel, words):
    with pytest.raises(KernelError, match="cannot be compiled") as error:
        address(kernel)
    assert "\n" not in str(error.value) and re.search(words, str(error.value))
